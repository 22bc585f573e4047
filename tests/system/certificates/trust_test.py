# SPDX-License-Identifier: Apache-2.0
"""Whom a verification trusts: signers and time servers by roots of their own, keys that were replaced, lists that are none."""
import json
import os
import re
import shutil
import subprocess
import unittest

from numbered import NumberedTest, number
from signing import NONIO, PASSWORD, SIGNER, run


class Trust(NumberedTest):
    def authority(self, name):
        self.key.new(name, "Other Root", "P-256")
        self.key.sign(name, "ca", None, 3650)
        return self.key.folder / f"{name}.pem"

    def holder(self, name, subject, by):
        """A key file with a certificate of this subject."""
        self.key.new(name, subject, "P-256")
        self.key.sign(name, "leaf", by, 400)
        p12 = self.key.folder / f"{name}.p12"
        run("openssl", "pkcs12", "-export", "-inkey", self.key.folder / f"{name}.key", "-in", self.key.folder / f"{name}.pem",
            "-out", p12, "-passout", f"pass:{PASSWORD}")
        return p12

    def edit(self, before, after):
        file = self.site / "site.toml"
        self.assertIn(before, file.read_text())
        file.write_text(file.read_text().replace(before, after))

    def verdict(self, *files, **kwargs):
        done, answers = self.verify(*files, **kwargs)
        return done.returncode, [a["verdict"] for a in answers]

    def test_a_root_of_time_servers_makes_no_signer(self):
        self.signed_campaign("c1")
        self.night()
        honest = [self.pdf("c1"), self.out / "c1" / "dcc.xml"]
        servers = self.authority("servers")
        # The same name, certified by the root of the time servers.
        self.holder("eve", "Ada Bianchi", "servers")
        shutil.copytree(self.site, self.root / "copy", ignore=shutil.ignore_patterns("certificates.*"))
        self.site, honest_site = self.root / "copy", self.site
        self.edit("ada.p12", "eve.p12")
        honest_out, self.out = self.out, self.root / "forged"
        self.night()
        forged = [self.pdf("c1"), self.out / "c1" / "dcc.xml"]
        self.site, self.out = honest_site, honest_out
        apart = {"site": False, "args": ["--signer-roots", self.key.ca, "--time-stamp-roots", servers, "--signer", SIGNER]}
        self.assertEqual(self.verdict(*honest, **apart), (3, ["incomplete"] * 2))
        self.assertEqual(self.verdict(*forged, **apart), (4, ["untrusted"] * 2))
        both = self.root / "roots.pem"
        both.write_text(self.key.ca.read_text() + servers.read_text())
        done, answers = self.verify(*forged, site=False, args=["--trust", both, "--signer", SIGNER])
        self.assertEqual((done.returncode, answers), (2, []))
        for wanted in ("--signer-roots", "--time-stamp-roots", "signer_roots", "time_stamp_roots"):
            self.assertIn(wanted, done.stderr)
        self.assertEqual(self.verdict(*honest, site=False, args=["--trust", self.key.ca, "--signer", SIGNER]), (3, ["incomplete"] * 2))
        # site.toml likewise.
        self.edit(f'trust = "{self.key.ca}"', f'trust = "{both}"')
        self.assertEqual(self.verdict(*honest)[0], 2)
        self.edit(f'trust = "{both}"', f'signer_roots = "{self.key.ca}"\ntime_stamp_roots = "{servers}"')
        self.assertEqual(self.verdict(*honest), (3, ["incomplete"] * 2))
        self.assertEqual(self.verdict(*forged), (4, ["untrusted"] * 2))

    def test_time_stamps_lead_to_the_roots_of_time_servers_only(self):
        server = self.key.time_server()
        self.addCleanup(server.close)
        others = self.authority("others")
        self.edit("[signing]\n", f'[signing]\ntime_stamp = "{server.url}"\n')
        self.signed_campaign("c1")
        self.night()
        roots = ["--signer-roots", self.key.ca, "--signer", SIGNER, "--time-stamp-roots"]
        self.assertEqual(self.verdict(self.pdf("c1"), site=False, args=[*roots, self.key.ca])[1], ["incomplete"])
        done, answers = self.verify(self.pdf("c1"), site=False, args=[*roots, others])
        self.assertEqual(self.state(answers[0], "signature.time"), "fails")
        self.assertEqual(done.returncode, 1)

    def test_a_key_is_replaced_and_what_the_old_one_signed_stays_valid(self):
        self.signed_campaign("c1")
        self.night()
        old = [self.pdf("c1"), self.out / "c1" / "dcc.xml"]
        self.holder("bruno", "Bruno Verdi", "ca")
        self.edit("ada.p12", "bruno.p12")
        self.edit(f'signer = "{SIGNER}"', 'signer = "CN=Bruno Verdi,O=Laboratorio di Prova"')
        self.signed_campaign("c2")
        self.night()
        new = [self.pdf("c2"), self.out / "c2" / "dcc.xml"]
        self.assertEqual(self.verdict(*old, *new), (3, ["incomplete"] * 4))
        ada = run("openssl", "x509", "-in", self.key.folder / "ada.pem", "-noout", "-fingerprint", "-sha256").stdout
        entries = self.entries()
        self.assertEqual([e["signer"]["subject"] for e in entries], [SIGNER, "CN=Bruno Verdi,O=Laboratorio di Prova"])
        self.assertEqual(entries[0]["signer"]["sha256"], re.sub("[^0-9a-f]", "", ada.split("=")[1].lower()))
        # Only what the register contains is valid: the same old key signs nothing new.
        done = run(NONIO, "certificate", "extend", "--site", self.site, "--no-time-stamp", "--no-fetch", "--revoked", self.key.revocation_list(),
                   "--out", self.root / "kept", old[0], check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.verdict(self.root / "kept" / old[0].name)[1], ["incomplete"])
        self.edit("bruno.p12", "ada.p12")
        self.signed_campaign("c3")
        outside, self.out = self.out, self.root / "elsewhere"
        shutil.copytree(self.site, self.root / "copy", ignore=shutil.ignore_patterns("certificates.*"))
        self.site, own = self.root / "copy", self.site
        self.night()
        forged = self.pdf("c3")
        self.site, self.out = own, outside
        self.assertEqual(self.verdict(forged), (4, ["untrusted"]))

    def test_a_list_of_signers_with_their_days(self):
        self.signed_campaign("c1")
        self.night()
        file = self.pdf("c1")
        (self.site / "certificates.sqlite").rename(self.root / "away")
        for identity in self.site.glob("certificates.*"):
            identity.unlink()
        for days, expected in (("", "not-in-force"), ("until = 2020-01-01", "untrusted"), ("from = 2090-01-01", "untrusted"),
                               ("from = 2020-01-01\nuntil = 2090-01-01", "not-in-force")):
            text = (self.site / "site.toml").read_text()
            self.edit(f'signer = "{SIGNER}"\n', "")
            (self.site / "site.toml").write_text((self.site / "site.toml").read_text() + f'[[signing.signers]]\nwho = "{SIGNER}"\n{days}\n')
            self.assertEqual(self.verdict(file)[1], [expected], days)
            (self.site / "site.toml").write_text(text)

    def test_a_revocation_list_that_is_none_is_an_error(self):
        self.signed_campaign("c1")
        self.night()
        empty = self.root / "empty.pem"
        for content in ("", "\n", "# nothing\n", "-----BEGIN X509 CRL-----\nx\n-----END X509 CRL-----\n"):
            empty.write_text(content)
            for how in ({"args": ["--revoked", empty]}, {"site": False, "args": ["--trust", self.key.ca, "--signer", SIGNER, "--revoked", empty]}):
                done, answers = self.verify(self.pdf("c1"), **how)
                self.assertEqual((done.returncode, answers), (2, []), content)
                self.assertIn("revocation list", done.stderr)
        for option in ("--signer-roots", "--trust"):
            empty.write_text("")
            self.assertEqual(self.verify(self.pdf("c1"), site=False, args=[option, empty, "--signer", SIGNER])[0].returncode, 2)

    def test_other_words_are_a_verdict_of_their_own(self):
        words = self.site / "templates" / "words" / "en"
        words.mkdir(parents=True)
        (words / "more.toml").write_text('x = "y"\n')
        self.signed_campaign("c1")
        self.night()
        file = self.pdf("c1")
        self.assertEqual(self.verdict(file), (3, ["incomplete"]))
        whom = ["--trust", self.key.ca, "--signer", SIGNER]
        done, answers = self.verify(file, site=False, args=whom)
        self.assertEqual((done.returncode, answers[0]["verdict"], answers[0]["holds"]), (8, "other-words", False))
        self.assertEqual(self.state(answers[0], "content.words"), "fails")
        self.assertEqual(self.state(answers[0], "content.printed"), "holds")
        said = subprocess.run([NONIO, "certificate", "verify", *map(str, whom), str(file)], capture_output=True, text=True, env=self.environment)
        self.assertEqual(said.returncode, 8)
        self.assertTrue(said.stdout.startswith(f"{file}: OTHER WORDS THAN INSTALLED; signed by \"{SIGNER}\"\n"), said.stdout)

    def test_a_pipe_is_no_certificate(self):
        pipe = self.root / "pipe.pdf"
        os.mkfifo(pipe)
        done = subprocess.run([NONIO, "certificate", "verify", "--trust", self.key.ca, str(pipe)], capture_output=True, text=True, timeout=10)
        self.assertEqual(done.returncode, 7, done.stdout)

    def test_what_is_said_of_many_files_is_said_once(self):
        names = [f"c{i}" for i in range(4)]
        for name in names:
            self.signed_campaign(name)
        self.night()
        with open(self.root / "log", "w") as log:
            subprocess.run([NONIO, "certificate", "verify", "--site", str(self.site), *(str(self.pdf(n)) for n in names)], stdout=log, stderr=subprocess.STDOUT,
                           env=self.environment, timeout=300)
        said = (self.root / "log").read_text().splitlines()
        self.assertEqual(len([line for line in said if "VALID (" in line]), len(names))
        self.assertEqual(len(said), len(set(said)))

    def test_a_file_that_another_program_saved_is_called_so(self):
        if shutil.which("qpdf") is None:
            self.skipTest("no qpdf")
        self.signed_campaign("c1")
        self.night()
        saved = self.root / "saved.pdf"
        subprocess.run(["qpdf", str(self.pdf("c1")), str(saved)], check=False)
        done, answers = self.verify(saved)
        self.assertEqual(done.returncode, 1)
        self.assertIn("another program", "".join(c["says"] for c in answers[0]["checks"] if c["state"] == "fails"))

    def test_a_password_that_others_can_read_opens_no_key(self):
        password = self.key.folder / "password"
        password.chmod(0o644)
        self.signed_campaign("c1")
        self.night(expect=1)
        self.assertIn("chmod 600", (self.out / "summary.txt").read_text())
        password.chmod(0o600)
        self.night()
        self.assertEqual(self.states(), {number(1): "issued"})

    def test_a_time_server_that_is_away_is_asked_once(self):
        """One that takes a connection and says nothing: the run waits for it once, not for each certificate."""
        import socket
        import time
        listening = socket.socket()
        self.addCleanup(listening.close)
        listening.bind(("127.0.0.1", 0))
        listening.listen(50)
        url = f"http://127.0.0.1:{listening.getsockname()[1]}/tsa"
        self.edit("[signing]\n", f'[signing]\ntime_stamp = "{url}"\ntime_stamp_seconds = 3\ntime_stamp_missing = "sign"\n')
        for i in range(4):
            self.signed_campaign(f"c{i}")
        begun = time.monotonic()
        self.night(expect=None)
        self.assertLess(time.monotonic() - begun, 10.0, "8 files, 3 s each")
        self.assertEqual(set(self.states().values()), {"issued"})
        # A closed port is known at once.
        listening.close()
        self.edit("time_stamp_seconds = 3", "time_stamp_seconds = 60")
        self.signed_campaign("c5")
        begun = time.monotonic()
        self.night(expect=None)
        self.assertLess(time.monotonic() - begun, 20.0)
        self.assertIn("refused", json.dumps(self.results("c5")))


if __name__ == "__main__":
    unittest.main()
