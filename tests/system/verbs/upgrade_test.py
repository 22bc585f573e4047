# SPDX-License-Identifier: Apache-2.0
"""`nonio upgrade`: former names of keys become present ones, and nothing else changes. Until then they are accepted with
a warning that names file, line and both names."""
import json
import os
import unittest

from verbs import VerbTest, manifest, readings

# As they were written by hand: comments, spaces, CRLF, a name in Latin letters beyond ASCII.
AXIS = '[machine.axes.X]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm = "none"\n'
OLD_AXIS = '[machine.axes.X]  # Größe: table_on\nkind   = "linear"\ntable_on = "none"   # table_on\nbacklash_on_mm = "none"\n'
NEW_AXIS = '[machine.axes.X]  # Größe: table_on\nkind   = "linear"\nactive_table = "none"   # table_on\nactive_backlash_mm = "none"\n'
OLD_SITE = 'format = 1\n# may_stand\n[certificate]\nrelease = "automatic"\nmay_stand = [ { finding = "tolerance.*", reason = "ordered" } ]\n'


class Upgrade(VerbTest):
    def setUp(self):
        super().setUp()
        self.campaign(manifest(), x=readings(backlash=-6.0))
        present = (self.folder / "campaign.toml").read_text()
        self.assertIn(AXIS, present)
        self.old = present.replace(AXIS, OLD_AXIS).replace("\n", "\r\n").encode()
        self.new = present.replace(AXIS, NEW_AXIS).replace("\n", "\r\n").encode()
        self.path = self.folder / "campaign.toml"
        self.path.write_bytes(self.old)
        (self.site / "site.toml").write_text(OLD_SITE)

    def test_every_file_of_a_site_once(self):
        os.chmod(self.path, 0o640)
        (self.site / "notes.txt").write_text("table_on = 1")
        shown = self.nonio("upgrade", self.site).stdout
        self.assertEqual(self.new, self.path.read_bytes())
        self.assertEqual(OLD_SITE.replace("may_stand = [", "accept = ["), (self.site / "site.toml").read_text())
        self.assertEqual(0o640, self.path.stat().st_mode & 0o777)
        self.assertIn(f'{self.path}:6\n- table_on = "none"   # table_on\n+ active_table = "none"   # table_on\n', shown)
        self.assertIn("2 files changed", shown)
        before = {p: (p.read_bytes(), p.stat().st_mtime_ns) for p in self.site.rglob("*") if p.is_file()}
        self.assertEqual("no file changed\n", self.nonio("upgrade", self.site).stdout)
        self.assertEqual(before, {p: (p.read_bytes(), p.stat().st_mtime_ns) for p in self.site.rglob("*") if p.is_file()})

    def test_one_campaign_as_json(self):
        said = json.loads(self.nonio("upgrade", self.folder, "--json").stdout)
        self.assertEqual([6, 7], [c["line"] for c in said["changes"]])
        self.assertEqual(self.new, self.path.read_bytes())
        self.assertEqual(OLD_SITE, (self.site / "site.toml").read_text())

    def test_a_broken_file_is_reported_and_the_others_are_changed(self):
        other = self.site / "d"
        other.mkdir()
        (other / "campaign.toml").write_text("[machine\ntable_on = 1\n")
        done = self.nonio("upgrade", self.site, expect=1)
        self.assertIn("d/campaign.toml:1", done.stderr)
        self.assertEqual("[machine\ntable_on = 1\n", (other / "campaign.toml").read_text())
        self.assertEqual(self.new, self.path.read_bytes())

    def test_former_names_are_warnings_and_give_the_same_results(self):
        out = self.site.parent / "out"
        done = self.nonio("run", self.site, "--out", out)
        for where, old, new in (("c/campaign.toml:6", "machine.axes.X.table_on", "machine.axes.X.active_table"),
                                ("site.toml:5", "certificate.may_stand", "certificate.accept")):
            warning = [line for line in done.stderr.split("\n") if where in line]
            self.assertEqual(1, len(warning), done.stderr)
            self.assertIn(old, warning[0])
            self.assertIn(new, warning[0])
        self.assertIn("c/campaign.toml:7: warning", self.nonio("check", self.site).stdout)
        self.assertIn("table_on", "".join(json.loads(self.nonio("check", self.site, "--json").stdout)["warnings"]))
        before = json.loads((out / "c/results.json").read_text())
        self.nonio("upgrade", self.site)
        done = self.nonio("run", self.site, "--out", out)
        self.assertNotIn("is now named", done.stderr)
        after = json.loads((out / "c/results.json").read_text())
        self.assertEqual(2, len([note for note in before.pop("notes") if "is now named" in note]))
        self.assertNotIn("notes", after)
        for part in ("status", "analyses", "tables"):
            self.assertEqual(before[part], after[part])


if __name__ == "__main__":
    unittest.main()
