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

    def test_results_are_never_written_among_the_readings(self):
        folder = self.campaign("a", run='[run]\noutputs = ["csv"]\n')
        (folder / "values.csv").write_text("mine")
        for out in (self.site, folder, folder / "below"):
            done = self.run_nonio(out=out, expect=2)
            self.assertIn("wanted another folder", done.stderr)
        self.run_nonio(out=self.site.parent, expect=0)  # beside it is fine
        self.assertEqual((folder / "values.csv").read_text(), "mine")

    def test_a_pipe_does_not_stop_the_night(self):
        for name in ("x.csv", "campaign.toml"):
            folder = self.campaign("bad-" + name[0])
            (folder / name).unlink()
            os.mkfifo(folder / name)
        self.campaign("good")
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("done"), ["good"])
        self.assertIn("not a file", self.errors("bad-x")[0]["message"])
        self.run_nonio(expect=1)

    def test_a_folder_without_an_id_gives_way(self):
        self.campaign("A B", text="nonsense")
        self.campaign("one", campaign_id="a-b")
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("done"), ["a-b"])
        self.assertEqual(self.ids("failed"), ["a-b.2"])

    def test_unknown_control_names_the_nearest(self):
        self.campaign("a", text=manifest("a").replace('model = "M"', 'control = "siemens-840"'))
        self.run_nonio(expect=1)
        self.assertIn('nearest: "siemens-840d"', self.errors("a")[0]["message"])

    def test_a_linked_campaign_is_not_passed_over_in_silence(self):
        self.campaign("a")
        (self.root / "elsewhere").mkdir()
        (self.root / "elsewhere" / "campaign.toml").write_text(manifest("linked"))
        os.symlink(self.root / "elsewhere", self.site / "link")
        self.assertIn("the campaign link is a link", self.run_nonio(expect=0).stderr)

    def test_quiet_still_names_a_campaign_that_stays_failed(self):
        self.campaign("a", text="nonsense")
        self.run_nonio("--quiet", expect=1)
        self.assertIn("failed    a", self.run_nonio("--quiet", expect=1).stderr)

    def test_empty_output_name(self):
        import subprocess
        from nightly import NONIO
        done = subprocess.run([NONIO, "run", str(self.site), "--out", ""], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        done = subprocess.run([NONIO, "run", "--plugin-path", str(self.root), str(self.site), "--out",
                               str(self.out)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_empty_site(self):
        self.run_nonio(expect=0)
        self.assertEqual(self.summary()["counts"]["campaigns"], 0)


if __name__ == "__main__":
    unittest.main()
