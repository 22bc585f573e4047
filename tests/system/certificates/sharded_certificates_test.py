# SPDX-License-Identifier: Apache-2.0
"""Certificates of a night in shards: no shard has key or register; the merge draws and signs."""
import json
import shutil
import subprocess
import unittest

from nightly import NONIO, tree
from signing import AUTOMATIC, SigningTest, run


class ShardedCertificates(SigningTest):
    def setUp(self):
        super().setUp()
        self.key = self.keys()
        self.parts = self.root / "parts"
        for i in range(4):
            self.signed_campaign(f"c{i}")
        self.campaign("plain", run='[run]\noutputs = ["json", "csv"]\n')
        (self.campaign("wrong") / "x.csv").write_text("run,direction,target_mm,deviation_um\n1,+,a,b\n")

    def settings(self, certificate):
        self.site_toml(self.key, key='pkcs12 = "keys/ada.p12"', password='password_file = "keys/password"',
                       extra="[certificate]\n" + certificate + 'numbering = "N-{number:3}"\n')
        text = (self.site / "site.toml").read_text().replace('["pdf-report", "dcc"]\n', '["json", "certificate"]\n')
        (self.site / "site.toml").write_text(text.replace('trust = "' + str(self.key.folder), 'trust = "keys'))
        shutil.copytree(self.key.folder, self.site / "keys")
        self.other = self.root / "other"  # the same site, with a register of its own
        shutil.copytree(self.site, self.other)

    def night_in_parts(self, shards, *args):
        run(NONIO, "night", "plan", self.other, "--out", self.parts, "--shards", shards, *args)
        node = self.root / "node"  # as a node sees the site
        shutil.copytree(self.other, node, ignore=shutil.ignore_patterns("keys", "*.sqlite*", "register*"))
        left = 0
        for i in range(shards):
            done = run(NONIO, "run", node, "--out", self.parts, "--shard", f"{i}/{shards}", "--json", check=False)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            left += json.loads(done.stdout.splitlines()[-1])["left_to_merge"]
        self.assertFalse(list(node.glob("*.sqlite*")), "a shard makes no register")
        shutil.rmtree(node)
        self.merged = run(NONIO, "night", "merge", self.parts, "--wait", "0", "--jobs", "2", check=False)
        self.assertEqual(self.merged.returncode, 1, self.merged.stderr)  # of the campaign that fails
        return left

    def numbers(self, site):
        listed = json.loads(run(NONIO, "certificates", site, "--json").stdout)["certificates"]
        return [(c["number"], c["state"], c["campaign"]) for c in listed]

    def test_drafts(self):
        self.settings('release = "person"\n')
        self.run_nonio("--date", "2026-11-04", expect=1)
        self.assertEqual(self.night_in_parts(3, "--date", "2026-11-04"), 4)
        one, parts = tree(self.out), tree(self.parts)
        # The folder of the site stands in it.
        for state in (one, parts):
            self.assertIn(b'"site"', state.pop(".nonio/night.json"))
        self.assertEqual(sorted(k for k in one.keys() | parts.keys() if one.get(k) != parts.get(k)), [])
        self.assertEqual([d["campaign"] for d in json.loads(parts["summary.json"])["drafts"]], ["c0", "c1", "c2", "c3"])
        # The next night sends what is known to need the register to the merge at once.
        self.assertEqual(self.night_in_parts(2, "--date", "2026-11-05", "--force"), 0)
        self.run_nonio("--date", "2026-11-05", "--force", expect=1)
        self.assertEqual(tree(self.out)["summary.json"], tree(self.parts)["summary.json"])
        done = run(NONIO, "release", self.other / "c2", "--by", "B. Sample", "--reason", "reversal.lost-motion=as found")
        self.assertIn("N-001", done.stdout)
        self.assertEqual(self.numbers(self.other), [("N-001", "issued", "c2")])

    def test_numbers_by_the_rules(self):
        self.settings(AUTOMATIC.split("\n", 1)[1])
        self.run_nonio("--date", "2026-11-04", "--jobs", "1", expect=1)
        self.assertEqual(self.night_in_parts(3, "--date", "2026-11-04"), 4)
        self.assertEqual(self.numbers(self.other), [(f"N-00{i + 1}", "issued", f"c{i}") for i in range(4)])
        self.assertEqual(self.numbers(self.other), self.numbers(self.site))
        one, parts = tree(self.out), tree(self.parts)
        self.assertEqual(sorted(one), sorted(parts))
        self.assertEqual(json.loads(one["summary.json"])["issued"], json.loads(parts["summary.json"])["issued"])
        for name in ("c0/certificate.pdf", "c3/certificate.pdf"):
            done = subprocess.run([NONIO, "verify", "--site", self.other, "--quiet", self.parts / name],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        # Merged again, or planned again: no number more.
        run(NONIO, "night", "merge", self.parts, check=False)
        self.assertEqual(self.night_in_parts(3, "--date", "2026-11-05"), 0)
        self.assertEqual(len(self.numbers(self.other)), 4)


if __name__ == "__main__":
    unittest.main(verbosity=2)
