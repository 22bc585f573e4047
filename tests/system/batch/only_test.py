# SPDX-License-Identifier: Apache-2.0
"""`nonio run --only`: one campaign of the last run again. The other campaigns of that run do not change."""
import fcntl
import json
import pathlib
import shutil
import sqlite3
import tempfile
import unittest

from nightly import NightTest


class OnlyTest(NightTest):
    """Each test begins after the same first night."""

    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory(prefix="nonio-only-")
        cls.kept = None

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def setUp(self):
        super().setUp()
        # The output folder knows its site by name: the same place each time.
        root = pathlib.Path(self.place.name)
        self.site, self.out = root / "site", root / "out"
        for folder in (self.site, self.out, root / "other"):
            shutil.rmtree(folder, ignore_errors=True)
        if not self.kept:
            self.site.mkdir()
            for name in ("a", "b", "c"):
                self.campaign(name)
            self.run_nonio("--date", "2026-03-01", expect=0)
            type(self).kept = root / "kept"
            for folder in (self.site, self.out):
                shutil.copytree(folder, self.kept / folder.name)
        else:
            for folder in (self.site, self.out):
                shutil.copytree(self.kept / folder.name, folder)

    def whole(self):
        """Every file of the output folder but the databases, which keep times of pages."""
        return {str(p.relative_to(self.out)): p.read_bytes() for p in sorted(self.out.rglob("*"))
                if p.is_file() and ".sqlite" not in p.name and p.name != "lock"}

    def state(self):
        return json.loads((self.out / ".nonio/night.json").read_text())

    def record(self, campaign):
        return json.loads((self.out / campaign / "run.json").read_text())

    def rows(self):
        database = sqlite3.connect(self.out / "history.sqlite")
        try:
            return {table: sorted(database.execute(f"SELECT * FROM {table}"), key=repr)
                    for table in ("campaign", "evaluation", "result", "finding")}
        finally:
            database.close()

    def spoil(self, campaign):
        """Another reading, so that the results are others."""
        file = next(f for f in sorted((self.site / campaign).glob("*.csv")))
        lines = file.read_text().splitlines(keepends=True)
        lines[-1] = lines[-1].rstrip("\n") + "1\n"
        file.write_text("".join(lines))

    def test_unchanged_it_leaves_the_same_bytes_but_for_the_reason(self):
        before, rows = self.whole(), self.rows()
        self.run_nonio("--only", "b", expect=0)
        after = self.whole()
        self.assertEqual(set(before), set(after))
        changed = {name for name in before if before[name] != after[name]}
        self.assertLessEqual(changed, {"b/run.json", "summary.json", "summary.txt", ".nonio/night.json"}, changed)
        self.assertEqual(self.record("b")["reason"], "--only")
        self.assertEqual(self.record("b")["night"], 1)
        self.assertEqual(self.rows(), rows)
        self.assertEqual((self.state()["state"], self.state()["night"], self.state()["date"]), ("complete", 1, "2026-03-01"))

    def test_only_that_campaign_is_done_and_the_run_keeps_its_number(self):
        self.spoil("a"), self.spoil("b")
        self.campaign("d")
        before = self.whole()
        self.run_nonio("--only", "b")
        after = self.whole()
        self.assertNotEqual(before["b/results.json"], after["b/results.json"])
        self.assertEqual(before["a/results.json"], after["a/results.json"])
        self.assertIn("changed", self.record("b")["reason"])
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertEqual((summary["night"], summary["counts"]["campaigns"]), (1, 3), "d came after the night")
        self.assertFalse((self.out / "d").exists())
        # For b it leaves what a complete run would have left; the next run does the rest.
        self.run_nonio("--date", "2026-03-02")
        self.assertEqual(self.state()["night"], 2)
        self.assertEqual((self.record("a")["night"], self.record("b")["night"], self.record("d")["night"]), (2, 1, 2))
        other = self.out.parent / "other"
        out, self.out = self.out, other
        self.run_nonio("--date", "2026-03-02")
        self.assertEqual((other / "b/results.json").read_bytes(), (out / "b/results.json").read_bytes())
        self.out = out

    def test_what_was_entered_into_the_history_is_what_is_made_again(self):
        self.spoil("b")
        self.run_nonio("--only", "b")
        rows = self.rows()
        (self.out / "history.sqlite").unlink()
        self.run_nonio("--only", "b")
        again = self.rows()
        self.assertEqual({t: len(r) for t, r in rows.items()}, {t: len(r) for t, r in again.items()})
        self.assertEqual(rows["result"], again["result"])

    def test_it_is_refused(self):
        for wanted in ("none", "../b"):
            done = self.run_nonio("--only", wanted, expect=None)
            self.assertEqual(done.returncode, 2)
            self.assertIn("no campaign", done.stderr)
        self.assertEqual(self.run_nonio("--only", "b", "--force", expect=None).returncode, 2)
        with open(self.out / ".nonio/lock") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            done = self.run_nonio("--only", "b", expect=None)
            self.assertEqual(done.returncode, 2)
            self.assertIn("another run", done.stderr)
        state = self.state()
        (self.out / ".nonio/night.json").write_text(json.dumps({**state, "state": "running"}))
        done = self.run_nonio("--only", "b", expect=None)
        self.assertEqual(done.returncode, 2)
        self.assertIn("complete run", done.stderr)
        shutil.rmtree(self.out)
        self.assertIn("complete run", self.run_nonio("--only", "b", expect=None).stderr)


if __name__ == "__main__":
    unittest.main()
