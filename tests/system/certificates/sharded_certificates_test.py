# SPDX-License-Identifier: Apache-2.0
"""Certificates of a run in shards: no shard has key or register; the merge draws and signs."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "batch"))
from nightly import NONIO, NightTest, tree  # noqa: E402
from signing import run  # noqa: E402

SAMPLE = pathlib.Path(os.environ["NONIO_SAMPLES"]).parent / "certificates"
RULES = ('release = "automatic"\naccept = [{ finding = "reversal.*", reason = "as found" }, '
         '{ finding = "tolerance.*", reason = "as found" }]\n')


class ShardedCertificates(NightTest):
    def setUp(self):
        super().setUp()
        self.parts = self.root / "parts"
        shutil.copy(SAMPLE / "make-key.sh", self.site)
        run(self.site / "make-key.sh")
        manifest = (SAMPLE / "adjusted" / "campaign.toml").read_text()
        for i in range(3):
            shutil.copytree(SAMPLE / "adjusted", self.site / f"c{i}")
            text = manifest.replace('id = "adjusted"', f'id = "c{i}"')
            self.assertNotEqual(text, manifest)
            (self.site / f"c{i}" / "campaign.toml").write_text(text)
            for readings in (self.site / f"c{i}").glob("*.csv"):  # of its own, not those of another campaign
                readings.write_text(readings.read_text() + f"# {i}\n")
        self.campaign("plain", run='[run]\noutputs = ["json", "csv"]\n')
        (self.campaign("wrong") / "x.csv").write_text("run,direction,target_mm,deviation_um\n1,+,1O8.9,1.0\n")

    def settings(self, more):
        text = (SAMPLE / "site.toml").read_text()
        (self.site / "site.toml").write_text(text.replace("[signing]", more + "[signing]"))
        self.other = self.root / "other"  # the same site, with a register of its own
        shutil.copytree(self.site, self.other)

    def night_in_parts(self, shards, *args):
        run(NONIO, "run", "plan", self.other, "--out", self.parts, "--shards", shards, *args)
        node = self.root / "node"  # as a node sees the site
        shutil.copytree(self.other, node, ignore=shutil.ignore_patterns("keys", "*.sqlite*", "register*"))
        left = 0
        for i in range(shards):
            done = run(NONIO, "run", node, "--out", self.parts, "--shard", f"{i}/{shards}", "--json", check=False)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            left += json.loads(done.stdout.splitlines()[-1])["left_to_merge"]
        self.assertFalse(list(node.glob("*.sqlite*")), "a shard makes no register")
        shutil.rmtree(node)
        self.merged = run(NONIO, "run", "merge", self.parts, "--wait", "0", "--jobs", "2", check=False)
        self.assertEqual(self.merged.returncode, 1, self.merged.stderr)  # of the campaign that fails
        return left

    def numbers(self, site):
        listed = json.loads(run(NONIO, "certificate", "list", site, "--json").stdout)["certificates"]
        return [(c["number"], c["state"], c["campaign"]) for c in listed]

    def test_drafts(self):
        self.settings("")
        self.run_nonio("--date", "2026-11-04", expect=1)
        self.assertEqual(self.night_in_parts(3, "--date", "2026-11-04"), 3)
        one, parts = tree(self.out), tree(self.parts)
        # The file contains the path of the site, which differs.
        for state in (one, parts):
            self.assertIn(b'"site"', state.pop(".nonio/night.json"))
        self.assertEqual(sorted(k for k in one.keys() | parts.keys() if one.get(k) != parts.get(k)), [])
        self.assertEqual([d["campaign"] for d in json.loads(parts["summary.json"])["drafts"]], ["c0", "c1", "c2"])
        # The next run sends campaigns that need the register to the merge at once.
        self.assertEqual(self.night_in_parts(2, "--date", "2026-11-05", "--force"), 0)
        self.run_nonio("--date", "2026-11-05", "--force", expect=1)
        self.assertEqual(tree(self.out)["summary.json"], tree(self.parts)["summary.json"])
        done = run(NONIO, "certificate", "approve", self.other / "c2", "--by", "B. Sample", "--reason", "reversal.lost-motion=as found",
                   "--reason", "tolerance.X.A.iso230-2=as found", "--reason", "tolerance.X.B.iso230-2=adjusted since")
        self.assertIn("S-0001", done.stdout)
        self.assertEqual(self.numbers(self.other), [("S-0001", "issued", "c2")])

    def test_numbers_by_the_rules(self):
        self.settings(RULES)
        self.run_nonio("--date", "2026-11-04", "--jobs", "1", expect=1)
        self.assertEqual(self.night_in_parts(3, "--date", "2026-11-04"), 3)
        self.assertEqual(self.numbers(self.other), [(f"S-000{i + 1}", "issued", f"c{i}") for i in range(3)])
        self.assertEqual(self.numbers(self.other), self.numbers(self.site))
        one, parts = tree(self.out), tree(self.parts)
        self.assertEqual(sorted(one), sorted(parts))
        self.assertEqual(json.loads(one["summary.json"])["issued"], json.loads(parts["summary.json"])["issued"])
        for name in ("c0/certificate.pdf", "c2/certificate.pdf"):
            done = subprocess.run([NONIO, "certificate", "verify", "--site", self.other, "--quiet", self.parts / name],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        # Merged again, or planned again: no number more.
        run(NONIO, "run", "merge", self.parts, check=False)
        self.assertEqual(self.night_in_parts(3, "--date", "2026-11-05"), 0)
        self.assertEqual(len(self.numbers(self.other)), 3)


if __name__ == "__main__":
    unittest.main(verbosity=2)
