# SPDX-License-Identifier: Apache-2.0
"""Every verb that asks a register, with the register in a file, on a server, and on a server that is away."""
import json
import os
import shutil
import subprocess
import unittest

from numbered import AUTOMATIC, KNOWN, NumberedTest, number
from signing import NONIO, SIGNER, run

URL = os.environ["NONIO_TEST_DATABASE"]
CTL = os.environ["NONIO_TEST_PG_CTL"]
FIRST_RUNS = int(os.environ.get("NONIO_FIRST_RUNS", "6"))


def server(*args):
    subprocess.run([CTL, *args], check=True)


class RegisterOnAServer(NumberedTest):
    def setUp(self):
        super().setUp()
        self.schema = f"r{os.getpid()}_{self._testMethodName}"[:60].lower()

    def choose(self, place, extra="", schema=None):
        """The register in a file, or in a schema of the server."""
        database = f'[database]\nurl = "{URL}"\nschema = "{schema or self.schema}_h"\nregister = "{schema or self.schema}"\n' if place == "server" else ""
        self.site_with(extra=extra + database)
        if not self.release:  # not the beginning of what it was: that would be a file that was cut
            file = self.site / "site.toml"
            file.write_text(file.read_text() + "two_persons = false  # a person releases\n")

    def verbs(self, file, campaign):
        """Of a site with one certificate and one draft: what each verb says, and its status."""
        def verb(*args):
            done = run(NONIO, *args, check=False, env=self.environment)
            return done.returncode, done.stdout + done.stderr
        return {"verify": verb("certificate", "verify", "-v", "--site", self.site, file),
                "verify as JSON": verb("certificate", "verify", "--json", "--site", self.site, file.parent / "dcc.xml"),
                "list": verb("certificate", "approve", self.site, "--list"),
                "audit": verb("certificate", "audit", self.site),
                "certificates": verb("certificate", "list", self.site),
                "restamp": verb("certificate", "extend", "--site", self.site, "--no-time-stamp", "--no-fetch", "--revoked", self.key.revocation_list(),
                                "--out", self.root / "kept", file),
                "release": verb("certificate", "approve", self.site / campaign, "--by", "Bruno Verdi", "--reason", KNOWN + "=ordered"),
                "withdraw": verb("certificate", "withdraw", self.site, number(1), "--why", "wrong serial number"),
                "verify withdrawn": verb("certificate", "verify", "-v", "--site", self.site, file)}

    def each_verb_asks_the_register(self, place):
        wanted = {"verify": 3, "verify as JSON": 3, "list": 0, "audit": 0, "certificates": 0, "restamp": 0, "release": 0, "withdraw": 0,
                  "verify withdrawn": 5}
        self.choose(place)
        self.signed_campaign("c1")
        self.night()
        self.release = ""
        self.choose(place)
        self.signed_campaign("c2")
        self.night()
        said = self.verbs(self.pdf("c1"), "c2")
        self.assertEqual({verb: status for verb, (status, _) in said.items()}, wanted, said)
        self.assertIn("is in force", said["verify"][1])
        self.assertIn("was withdrawn: wrong serial number", said["verify withdrawn"][1])
        self.assertNotIn("plugin", said["verify"][1])

    def test_each_verb_asks_the_register_in_a_file(self):
        self.each_verb_asks_the_register("file")

    def test_each_verb_asks_the_register_on_a_server(self):
        self.each_verb_asks_the_register("server")

    def test_a_server_that_is_away_is_called_so(self):
        self.choose("server")
        self.signed_campaign("c1")
        self.night()
        self.release = ""
        self.choose("server")
        self.signed_campaign("c2")
        self.night()
        server("stop", "-m", "fast")
        try:
            said = self.verbs(self.pdf("c1"), "c2")
        finally:
            server("start")
        for verb, (status, words) in said.items():
            if verb == "restamp":  # needs the register only for an earlier signer
                self.assertEqual(status, 0, words)
                continue
            self.assertEqual(status, 2, (verb, words))
            self.assertIn("register", words, verb)
            self.assertNotIn("plugin", words, verb)
            self.assertNotIn("VALID", words, verb)
        # By itself, without the register, the same file is checked as before.
        done, _ = self.verify(self.pdf("c1"), site=False, args=["--trust", self.key.ca, "--signer", SIGNER])
        self.assertEqual(done.returncode, 3)
        done, answers = self.verify(self.pdf("c1"))
        self.assertEqual((done.returncode, answers[0]["verdict"]), (3, "incomplete"))

    def test_the_first_run_of_several_workers(self):
        """They make the schema and its tables at once: one does, and the others find them."""
        for run_number in range(FIRST_RUNS):
            shutil.rmtree(self.out, ignore_errors=True)
            for identity in self.site.glob("certificates.*"):
                identity.unlink()
            self.choose("server", schema=f"{self.schema}_{run_number}")
            for name in ("c1", "c2", "c3", "c4"):
                self.signed_campaign(name)
            self.night("--jobs", "4")
            self.assertEqual(self.states(), {number(n): "issued" for n in (1, 2, 3, 4)}, run_number)

    def test_a_state_without_the_last_entries_draws_no_number(self):
        """A standby that took over, or a backup: the site has seen more than it has."""
        self.choose("server")
        self.signed_campaign("c1")
        self.night()
        entries = json.loads(self.certificates("--audit", "--json").stdout)["entries"]
        psql = subprocess.run(["psql", URL, "-v", "ON_ERROR_STOP=1", "-q", "-c",
                               f'DELETE FROM "{self.schema}".journal WHERE place = {entries}'], capture_output=True, text=True)
        self.assertEqual(psql.returncode, 0, psql.stderr)
        self.signed_campaign("c2")
        shutil.rmtree(self.out)
        done = self.night(expect=2)
        self.assertIn("older state", done.stderr)


if __name__ == "__main__":
    unittest.main()
