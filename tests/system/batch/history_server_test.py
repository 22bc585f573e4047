# SPDX-License-Identifier: Apache-2.0
"""The store of results on a PostgreSQL server: the same rows, even if the server or the run is stopped."""
import csv
import io
import json
import os
import shutil
import subprocess
import unittest

from nightly import NONIO, NightTest, manifest

URL = os.environ["NONIO_TEST_DATABASE"]
CTL = os.environ["NONIO_TEST_PG_CTL"]
KILLS = int(os.environ.get("NONIO_KILLS", "4"))
SEED = int(os.environ.get("NONIO_SEED", "22"))
TABLES = ("machine", "campaign", "evaluation", "result", "common_part", "covariance", "finding", "control_table", "certificate",
          "machine_alias", "event", "acknowledgement", "forgotten", "due_rule", "store")


def server(*args):
    subprocess.run([CTL, *args], check=True)


class HistoryServerTest(NightTest):
    def setUp(self):
        super().setUp()
        self.schema = f"t{os.getpid()}_{self._testMethodName}"[:63].lower()
        self.copies = 0
        self.choose(URL)

    def campaign(self, name, **how):
        """Of a machine that has a history."""
        super().campaign(name, text=manifest(name).replace('model = "M"', 'model = "M"\nasset = "S-1"'), **how)

    def choose(self, url, extra=""):
        (self.site / "site.toml").write_text(
            "format = 1\n" + (f'[database]\nurl = "{url}"\nschema = "{self.schema}"\n{extra}' if url else "# the history is a file\n"))

    def query(self, *args, out=None):
        done = subprocess.run([NONIO, "machine", "list", out or self.out, "--csv", *args], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def said(self):
        """What each command says that reads the history; not which night it was."""
        out = [self.query("--superseded")]
        for command in (["machine", "history", self.out], ["status", self.out, "--actions"]):
            done = subprocess.run([NONIO, *command, "--json"], capture_output=True, text=True, timeout=60)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            self.assertEqual(done.stderr, "")
            out.append({k: v for k, v in json.loads(done.stdout).items() if k not in ("night", "date")})
        return out

    def in_sqlite(self):
        """What the same results say through a file."""
        self.choose(None)
        self.run_nonio("--date", "2026-04-01")
        self.assertTrue((self.out / "history.sqlite").is_file())
        said = self.said()
        self.choose(URL)
        self.run_nonio("--date", "2026-04-01")
        self.assertFalse((self.out / "history.sqlite").exists(), "it would grow old")
        return said

    def test_runs_are_stored_and_sqlite_has_the_same_rows(self):
        for name in ("a", "b"):
            self.campaign(name)
        self.run_nonio("--date", "2026-03-01", expect=0)
        self.campaign("a", seed=9.0)
        self.run_nonio("--date", "2026-03-02", expect=0)
        said = self.said()
        self.assertGreater(len(said[0].splitlines()), 30)
        self.assertGreater(len(said[1]["machines"]), 0)
        self.assertFalse((self.out / "history.sqlite").exists())
        self.assertEqual(self.in_sqlite(), said)
        self.assertEqual(self.said(), said)

    def test_a_server_that_is_away_costs_no_result(self):
        self.campaign("a")
        self.run_nonio("--date", "2026-03-01", expect=0)
        server("-m", "fast", "stop")
        try:
            self.campaign("b")
            done = self.run_nonio("--date", "2026-03-02", expect=1)
            self.assertIn("not in the history", done.stderr + (self.out / "summary.txt").read_text())
            self.assertEqual(self.results("b")["status"], self.results("a")["status"])
            asked = subprocess.run([NONIO, "machine", "list", self.out], capture_output=True, text=True)
            self.assertNotEqual(asked.returncode, 0)
            self.assertIn("schema " + self.schema, asked.stderr)
            self.assertNotEqual(subprocess.run([NONIO, "status", "--actions", self.out], capture_output=True).returncode, 0)
            self.assertIn("pages of the worklist were not made", (self.out / "summary.txt").read_text())
        finally:
            server("start")
        self.run_nonio("--date", "2026-03-03", expect=0)
        rows = list(csv.DictReader(io.StringIO(self.query("--quantity", "A"))))
        self.assertEqual(sorted((r["campaign"], r["evaluation"]) for r in rows), [("a", "1"), ("b", "2")])

    def test_another_output_folder_does_not_write_over_it(self):
        self.campaign("a")
        self.run_nonio(expect=0)
        said = self.query()
        done = self.run_nonio(out=self.root / "other", expect=1)
        self.assertIn("another output folder", done.stderr)
        self.assertEqual(self.query(), said)

    def test_a_password_in_the_address_is_refused_and_never_shown(self):
        self.campaign("a")
        for url in ("postgresql://u:Geheim77@h/d", "postgresql://u@h/d?password=Geheim77", "Geheim77"):
            self.choose(url)
            done = self.run_nonio(expect=2)
            self.assertIn("site.toml:3", done.stderr.replace(", line ", ":"))
            self.assertNotIn("Geheim77", done.stderr + done.stdout)
        password = self.site / "db.password"
        password.write_text("Geheim77\n")
        password.chmod(0o644)
        self.choose(URL, 'password_file = "db.password"\n')
        self.assertIn("chmod 600", self.run_nonio(expect=1).stderr)
        password.chmod(0o600)
        self.run_nonio(expect=0)
        for path in self.out.rglob("*"):
            if path.is_file():
                self.assertNotIn(b"Geheim77", path.read_bytes(), path)

    def rows(self, schema=None):
        """Of all tables, as the server's own client reads them."""
        sql = "".join(f'COPY (SELECT t FROM "{schema or self.schema}".{t} t ORDER BY CAST(t AS TEXT)) TO STDOUT;\n' for t in TABLES)
        done = subprocess.run(["psql", "-X", "-q", "-v", "ON_ERROR_STOP=1", URL], input=sql, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def made_again(self):
        """The rows of a store that is made from nothing: of a copy of the output folder, in another schema."""
        own, grown, copy = self.schema, self.out, self.root / f"copy{self.copies}"
        self.copies += 1
        shutil.copytree(grown, copy, symlinks=True)
        self.schema, self.out = f"{own}_{self.copies}"[-63:], copy
        try:
            self.choose(URL)
            self.run_nonio("--date", "2026-04-01")
            return self.rows()
        finally:
            self.schema, self.out = own, grown
            self.choose(URL)
            shutil.rmtree(copy)

    def test_killed_runs(self):
        def check(what):
            self.query()
            self.run_nonio()
            self.assertEqual(self.rows(), self.made_again(), what)

        self.kill_nights(KILLS, SEED, check)
        self.run_nonio("--date", "2026-04-01")
        said = self.said()
        self.assertEqual(self.in_sqlite(), said)

    def test_two_sites_of_one_database_at_once(self):
        for i in range(4):
            self.campaign(f"c{i}")
        sites = [self.site, self.root / "other-site"]
        shutil.copytree(sites[0], sites[1])
        text = (sites[1] / "site.toml").read_text()
        (sites[1] / "site.toml").write_text(text.replace(self.schema, "b_" + self.schema[:60]))
        nights = [subprocess.Popen([NONIO, "run", s, "--out", self.root / f"out{i}", "--date", "2026-03-01"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                  for i, s in enumerate(sites)]
        for night in nights:
            said = night.communicate(timeout=120)[1]
            self.assertEqual(night.returncode, 0, said)
        first, second = self.rows(), self.rows("b_" + self.schema[:60])
        self.assertEqual(first, second)
        self.assertEqual(first.count("2026-03-01"), 4)


if __name__ == "__main__":
    unittest.main()
