# SPDX-License-Identifier: Apache-2.0
"""The store of results is updated by each run: the same rows as when made from nothing, however a run ends."""
import json
import os
import shutil
import sqlite3
import subprocess
import unittest

from nightly import NONIO, NightTest

TABLES = ("machine", "campaign", "evaluation", "result", "common_part", "covariance", "finding", "control_table", "certificate",
          "machine_alias", "event", "acknowledgement", "forgotten", "due_rule", "store")
KILLS = int(os.environ.get("NONIO_KILLS", "8"))
SEED = int(os.environ.get("NONIO_SEED", "19"))


class HistoryTest(NightTest):
    def store(self):
        return self.out / "history.sqlite"

    def rows(self):
        database = sqlite3.connect(self.store())
        try:
            return {table: sorted(database.execute(f"SELECT * FROM {table}"), key=repr) for table in TABLES}
        finally:
            database.close()

    def ask(self, sql):
        database = sqlite3.connect(self.store())
        try:
            return database.execute(sql).fetchall()
        finally:
            database.close()

    def made_again(self):
        """The rows of a store that is made from nothing, in a copy of the output folder."""
        grown = self.out
        copy = self.out.parent / "copy"
        shutil.copytree(self.out, copy, symlinks=True)
        (copy / "history.sqlite").unlink()
        self.out = copy
        try:
            self.run_nonio("--date", "2026-04-01")
            return self.rows()
        finally:
            self.out = grown
            shutil.rmtree(copy)

    def test_runs_leave_the_rows_of_a_store_made_again(self):
        for name in ("a", "b", "c"):
            self.campaign(name)
        self.run_nonio("--date", "2026-03-01", expect=0)
        self.assertEqual(self.ask("SELECT campaign, night, why FROM evaluation ORDER BY evaluation"),
                         [("a", 1, ""), ("b", 1, ""), ("c", 1, "")])
        first = self.rows()
        self.run_nonio("--date", "2026-03-02")
        self.assertEqual(self.rows(), first, "a night on which nothing changed")
        # Other readings, other options, and a campaign that no longer exists.
        self.campaign("a", seed=9.0)
        self.campaign("b", extra="[options.iso230-2]\nedition = 2006\n")
        shutil.rmtree(self.site / "c")
        self.run_nonio("--date", "2026-03-03", expect=1)
        self.assertEqual(self.ask("SELECT campaign, supersedes, why FROM evaluation WHERE evaluation > 3 ORDER BY evaluation"),
                         [("a", 1, "files"), ("b", 2, "files")])
        self.assertEqual(len(self.ask("SELECT 1 FROM latest")), 3, "what is gone stays")
        nothing_new = self.rows()
        self.run_nonio("--date", "2026-03-04", "--force", expect=1)
        self.assertEqual(self.rows(), nothing_new, "evaluated again to the same numbers")
        subprocess.run([NONIO, "machine", "remove", self.site, "c", "--by", "B", "--why", "sold", "--date", "2026-03-05"], check=True)
        self.run_nonio("--date", "2026-03-05")
        self.assertEqual(self.ask("SELECT campaign, why FROM forgotten"), [("c", "sold")])
        self.assertEqual(self.made_again(), self.rows())
        for (value,) in self.ask("SELECT COUNT(*) FROM result"):
            self.assertGreater(value, 30)

    def test_what_results_say_is_what_is_kept(self):
        self.campaign("a")
        self.run_nonio()
        for analysis in self.results("a")["analyses"]:
            kept = dict(self.ask(f"SELECT quantity, value FROM result WHERE source = '{analysis['plugin']}'"))
            self.assertEqual(kept, {name: v["value"] for name, v in analysis["values"].items()})

    def test_a_run_that_cannot_write_the_store_reports_it_and_loses_nothing(self):
        self.campaign("a")
        self.run_nonio()
        before = self.rows()
        self.campaign("b")
        (self.site / "events.toml").write_text("format = 1\n[[event]]\ndate = 2026-01-01\nkind = \"crsh\"\n")
        done = self.run_nonio(expect=1)
        self.assertIn("events.toml:4", done.stderr)
        self.assertIn("crsh", done.stderr)
        self.assertIn("not in the history", (self.out / "summary.txt").read_text())
        line, = (x for x in json.loads(subprocess.run([NONIO, "status", "--actions", "--json", self.out], capture_output=True).stdout)["lines"] if x["id"].startswith("worklist.history"))
        self.assertIn("events.toml:4", json.dumps(line))
        self.assertEqual(self.results("b")["status"], self.results("a")["status"])
        self.assertEqual(self.rows(), before)
        (self.site / "events.toml").unlink()
        self.run_nonio()
        self.assertEqual(self.ask("SELECT campaign, night FROM evaluation ORDER BY evaluation"), [("a", 1), ("b", 2)])
        self.assertEqual(self.made_again(), self.rows())

    def test_a_locked_or_wrong_store(self):
        self.campaign("a")
        self.run_nonio()
        before = self.rows()
        self.store().write_bytes(b"not a database at all" * 100)
        self.run_nonio()
        self.assertEqual(self.rows(), before)
        self.store().unlink()
        self.store().mkdir()
        (self.store() / "x").write_text("")
        self.assertIn("history.sqlite", self.run_nonio(expect=1).stderr)
        shutil.rmtree(self.store())
        self.run_nonio()
        self.assertEqual(self.rows(), before)

    def test_a_campaign_has_no_name_of_an_output_file(self):
        self.campaign("a")
        for k, name in enumerate(("machines", "index.html", "history.sqlite", "history.sqlite-journal")):
            self.campaign(f"wrong{k}", name)
        done = self.run_nonio(expect=1)
        for k, name in enumerate(("machines", "index.html", "history.sqlite", "history.sqlite-journal")):
            self.assertRegex(done.stderr, rf'wrong{k}: .*campaign\.toml:3.*found "{name}"')
        self.assertFalse((self.out / "machines" / "results.json").exists())
        for name in ("index.html", "history.sqlite"):
            self.assertTrue((self.out / name).is_file())
        self.assertEqual(self.ask("SELECT campaign FROM evaluation WHERE status <> 'failed'"), [("a",)])
        self.run_nonio()
        self.assertEqual(self.rows(), self.made_again())

    def test_killed_runs(self):
        """At any moment: the run after it leaves the rows of a store that is made from nothing."""
        def check(what):
            self.assertEqual(self.ask("PRAGMA integrity_check"), [("ok",)])
            self.run_nonio()
            self.assertEqual(self.rows(), self.made_again(), what)

        nights = self.kill_nights(KILLS, SEED, check)
        self.assertEqual(len(self.ask("SELECT 1 FROM evaluation")), 6 + 3 * nights)


if __name__ == "__main__":
    unittest.main()
