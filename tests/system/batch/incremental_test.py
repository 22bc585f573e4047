# SPDX-License-Identifier: Apache-2.0
"""What has not changed is not done again; what has is, and says why."""
import json
import os
import shutil
import subprocess
import unittest

from nightly import NONIO, PLUGINS, NightTest, tree


class Incremental(NightTest):
    def setUp(self):
        super().setUp()
        for name in "abc":
            self.campaign(name)

    def changed_after(self, change, *args):
        """Reasons of the campaigns that are done after a change to an evaluated site."""
        self.run_nonio(expect=0)
        change()
        self.run_nonio(*args)
        summary = self.summary()
        return {e["id"]: e["reason"] for e in summary["done"] + summary["failed"]
                if e["id"] not in self.ids("unchanged")}

    def test_second_run_does_nothing_and_leaves_every_byte(self):
        self.run_nonio(expect=0)
        before = {k: v for k, v in tree(self.out).items() if not k.startswith((".nonio", "summary", "index.html"))}
        self.run_nonio(expect=0)
        self.assertEqual(self.ids("unchanged"), ["a", "b", "c"])
        self.assertEqual(self.summary()["new_findings"], [])
        after = {k: v for k, v in tree(self.out).items() if not k.startswith((".nonio", "summary", "index.html"))}
        self.assertEqual(before, after)

    def test_same_input_same_bytes_elsewhere(self):
        self.run_nonio("--jobs", "1", expect=0)
        other = self.root / "other"
        self.run_nonio("--jobs", "3", out=other, expect=0)
        self.assertEqual(tree(self.out), tree(other))

    def test_an_output_folder_is_of_one_site(self):
        """Otherwise campaigns of two sites would be mixed up, and the summary covers one site only."""
        self.run_nonio(expect=0)
        before = tree(self.out)
        other = self.root / "other-site"
        shutil.copytree(self.site, other)
        for more in ([], ["--force"], ["--dry-run"]):
            done = subprocess.run([NONIO, "run", str(other), "--out", str(self.out), *more], capture_output=True,
                                  text=True, check=False)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("holds the results of the site " + str(self.site.resolve()), done.stderr)
            self.assertEqual(tree(self.out), before)
        # The same site by another name, or moved, is no other one.
        link = self.root / "link"
        link.symlink_to(self.site)
        for site in (link, self.site):
            done = subprocess.run([NONIO, "run", str(site), "--out", str(self.out)], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
        shutil.rmtree(other)
        link.unlink()
        self.site.rename(other)
        done = subprocess.run([NONIO, "run", str(other), "--out", str(self.out)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.ids("unchanged"), ["a", "b", "c"])

    def test_reasons(self):
        a = self.site / "a"
        rows = (
            (lambda: (a / "x.csv").write_text((a / "x.csv").read_text() + "# more\n"),
             {"a": "file x.csv changed"}),
            (lambda: (a / "campaign.toml").write_text((a / "campaign.toml").read_text() + "# more\n"),
             {"a": "campaign.toml changed"}),
            (lambda: shutil.rmtree(self.out / "b"), {"b": "no earlier result"}),
            (lambda: (self.out / "b" / "values.csv").unlink(), {"b": "values.csv is missing from the output"}),
            (lambda: (values := self.out / "b" / "values.csv").write_text(values.read_text().replace("um", "mm")),
             {"b": "values.csv was changed in the output"}),
            (lambda: os.truncate(self.out / "c" / "results.json", 100),
             {"c": "results.json was changed in the output"}),
            (lambda: (self.out / "a" / "values.csv").touch(), {}),
            (lambda: (self.site / "site.toml").write_text("[limits]\nseconds = 60\n"),
             dict.fromkeys("abc", "site.toml changed")),
        )
        for change, expected in rows:
            shutil.rmtree(self.out, ignore_errors=True)
            (self.site / "site.toml").unlink(missing_ok=True)
            self.assertEqual(self.changed_after(change), expected)

    def test_another_plugin_does_all_again(self):
        reasons = self.changed_after(lambda: None, "--plugin-path", str(PLUGINS / "bad"))
        self.assertEqual(reasons, dict.fromkeys("abc", "plugins changed"))

    def test_another_template_does_all_again(self):
        def change():
            (self.site / "templates").mkdir()
            (self.site / "templates" / "mine.toml").write_text("x = 1\n")
        self.assertEqual(self.changed_after(change), dict.fromkeys("abc", "templates changed"))

    def test_force(self):
        self.assertEqual(self.changed_after(lambda: None, "--force"), dict.fromkeys("abc", "--force"))

    def test_the_reason_is_stored_with_the_result(self):
        self.run_nonio(expect=0)
        self.assertEqual(json.loads((self.out / "a" / "run.json").read_text())["reason"], "no earlier result")

    def test_dry_run_says_and_does_nothing(self):
        done = self.run_nonio("--dry-run", expect=0)
        self.assertIn("to do  a: no earlier result", done.stdout)
        self.assertFalse(self.out.exists())
        self.run_nonio(expect=0)
        before = tree(self.out)
        (self.site / "a" / "x.csv").write_text("changed")
        done = self.run_nonio("--dry-run", expect=0)
        self.assertIn("to do  a: file x.csv changed", done.stdout)
        self.assertIn("unchanged  b: nothing changed", done.stdout)
        self.assertEqual(before, tree(self.out))

    def test_failed_stays_failed_and_mends(self):
        good = (self.site / "a" / "x.csv").read_text()
        (self.site / "a" / "x.csv").unlink()
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("failed"), ["a"])
        self.run_nonio(expect=1)  # unchanged, and still failed
        self.assertEqual(self.ids("failed"), ["a"])
        (self.site / "a" / "x.csv").write_text(good)
        self.run_nonio(expect=0)
        self.assertEqual(self.ids("done"), ["a"])
        self.assertEqual(self.reason("done", "a"), "file x.csv changed")

    def test_files_of_an_earlier_result_do_not_stay(self):
        self.run_nonio(expect=0)
        self.assertTrue((self.out / "a" / "values.csv").exists())
        (self.out / "a" / "note.txt").write_text("by a person")
        (self.site / "a" / "x.csv").write_text("run,direction\n")
        self.run_nonio(expect=1)
        self.assertFalse((self.out / "a" / "values.csv").exists())
        self.assertEqual((self.out / "a" / "note.txt").read_text(), "by a person")

    def test_new_findings(self):
        self.run_nonio(expect=0)
        first = {(f["campaign"], f["id"]) for f in self.summary()["new_findings"]}
        self.assertIn(("a", "reversal.lost-motion"), first)
        rows = (self.site / "a" / "x.csv").read_text().splitlines()
        only_up = [rows[0]] + [r for r in rows[1:] if ",+," in r]
        (self.site / "a" / "x.csv").write_text("\n".join(only_up) + "\n")
        self.run_nonio(expect=0)
        second = {(f["campaign"], f["id"]) for f in self.summary()["new_findings"]}
        self.assertIn(("a", "direction.missing"), second)
        self.assertFalse({c for c, _ in second} - {"a"})

    def test_json_events(self):
        done = self.run_nonio("--json", expect=0)
        events = [json.loads(line) for line in done.stdout.splitlines()]
        stages = [e["name"] for e in events if e["event"] == "stage"]
        self.assertEqual(stages, ["survey", "campaigns", "history", "pages"])
        events = [e for e in events if e["event"] != "stage"]
        self.assertEqual([e["event"] for e in events], ["planned"] + 3 * ["campaign"] + ["end"])
        self.assertEqual(events[-1]["done"], 3)

    def test_two_runs_at_once(self):
        import fcntl
        self.run_nonio(expect=0)
        with open(self.out / ".nonio" / "lock") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertIn("another run is using", self.run_nonio(expect=2).stderr)

    def test_usage_errors(self):
        for args in (["run"], ["run", "/nonexistent", "--out", "x"], ["rum"], ["run", str(self.site)]):
            done = subprocess.run([NONIO, *args], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, args)
        self.assertEqual(subprocess.run([NONIO, "--help"], capture_output=True).returncode, 0)


if __name__ == "__main__":
    unittest.main()
