# SPDX-License-Identifier: Apache-2.0
"""Bad input gets an error that names its place; one bad campaign never stops the others."""
import os
import unittest

from nightly import NightTest, manifest


class Input(NightTest):
    def errors(self, campaign_id):
        return self.results(campaign_id)["errors"]

    def test_two_campaigns_with_one_id(self):
        self.campaign("first", campaign_id="same")
        self.campaign("second", campaign_id="same")
        self.campaign("other")
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("failed"), ["same", "same"])
        message = self.errors("same")[0]["message"]
        self.assertIn("first", message)
        self.assertIn("second", message)
        self.assertEqual(self.ids("done"), ["other"])

    def test_broken_manifest_names_the_line(self):
        self.campaign("bad", text=manifest("bad").replace("kind = \"linear\"", "kind = linear"))
        self.campaign("good")
        self.run_nonio(expect=1)
        self.assertEqual(self.errors("bad")[0]["file"], "campaign.toml")
        self.assertEqual(self.errors("bad")[0]["line"], 8)
        self.assertEqual(self.ids("done"), ["good"])

    def test_files_outside_the_campaign(self):
        (self.root / "secret.csv").write_text("run,direction,target_mm,deviation_um\n1,+,0,1\n")
        for name, file in (("up", "../../secret.csv"), ("root", "/etc/hostname"), ("link", "link.csv")):
            folder = self.campaign(name, text=manifest(name).replace("x.csv", file))
            if name == "link":
                os.symlink(self.root / "secret.csv", folder / "link.csv")
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("failed"), ["link", "root", "up"])

    def test_unknown_plugin_and_option_name_the_nearest(self):
        self.campaign("analysis", run='[run]\nanalyses = ["iso230-3"]\n')
        self.campaign("option", extra="[options.iso230-2]\nediton = 2006\n")
        self.campaign("owner", extra="[options.iso-230]\nedition = 2006\n")
        self.run_nonio(expect=1)
        self.assertIn('nearest: "iso230-2"', self.errors("analysis")[0]["message"])
        self.assertIn('nearest: "edition"', self.errors("option")[0]["message"])
        self.assertIn("there is no plugin of that name", self.errors("owner")[0]["message"])

    def test_a_kind_that_nobody_reads_leaves_the_others(self):
        ball = '[[measurement]]\nid = "C"\nkind = "ball-centres"\naxis = "C"\nfile = "x.csv"\n'
        self.campaign("a", extra=ball)
        self.run_nonio(expect=0)
        results = self.results("a")
        self.assertEqual(results["status"], "attention")
        self.assertIn("ball-centres", results["notes"][0])
        self.assertEqual(results["analyses"][0]["measurement"], "X")

    def test_without_uncertainty_nothing_conforms(self):
        tolerance = "[machine.axes.X.tolerance_um]\nA = 1000.0\nQ = 1.0\n"
        self.campaign("a", extra=tolerance)
        self.run_nonio(expect=0)
        results = self.results("a")
        iso = next(a for a in results["analyses"] if a["plugin"] == "iso230-2")
        self.assertEqual(iso["values"]["A"]["decision"], "cannot be decided")
        reasons = {c["name"]: c["reason"] for c in results["conformity"]}
        self.assertEqual(reasons, {"A": "no-uncertainty", "Q": "no-value"})

    def test_broken_site_file_stops_before_anything_is_written(self):
        self.campaign("a")
        (self.site / "site.toml").write_text("[limits]\nsecond = 5\n")
        done = self.run_nonio(expect=2)
        self.assertIn('site.toml:2: unknown key limits.second (nearest: "seconds")', done.stderr)
        self.assertFalse(self.out.exists())

    def test_empty_site(self):
        self.run_nonio(expect=0)
        self.assertEqual(self.summary()["counts"]["campaigns"], 0)


if __name__ == "__main__":
    unittest.main()
