# SPDX-License-Identifier: Apache-2.0
"""A run that signs: its output files, the result of `nonio certificate verify`, and what happens without a key, without a
time server, and when the run is killed."""
import json
import os
import pathlib
import random
import subprocess
import time
import unittest

from signing import AUTOMATIC, NONIO, PASSWORD, SigningTest, readings

TEMPLATES = pathlib.Path(__file__).resolve().parents[3] / "templates"
KILLS = int(os.environ.get("NONIO_KILLS", "6"))
SEED = int(os.environ.get("NONIO_SEED", "20261121"))


class SignedNight(SigningTest):
    def test_what_is_signed_holds_and_is_recomputed(self):
        for kind in ("P-256", "RSA-3072"):
            with self.subTest(kind):
                self.site_toml(self.keys(kind=kind))
                self.signed_campaign("c1")
                self.run_nonio("--force", expect=0)
                report, dcc = self.out / "c1" / "report.pdf", self.out / "c1" / "dcc.xml"
                answer = self.assert_holds(report, dcc)[0]
                self.assertEqual(self.state(answer, "content.values"), "holds")
                self.assertEqual(self.state(answer, "dcc.values"), "holds")
                self.assertEqual(self.state(answer, "dcc.signer"), "holds")
                self.assertEqual(self.state(answer, "certificate.revocation"), "not checked")

    def test_verify_says_no_without_trust_or_signer(self):
        keys = self.keys()
        self.site_toml(keys)
        self.signed_campaign("c1")
        self.run_nonio(expect=0)
        report = self.out / "c1" / "report.pdf"
        self.assertEqual(self.verify(report, site=False)[0].returncode, 4)
        self.assertEqual(self.verify(report, site=False, args=["--trust", keys.ca])[0].returncode, 4)
        self.assert_holds(report, site=False, args=["--trust", keys.ca, "--signer", "CN=Ada Bianchi,O=Laboratorio di Prova"])
        self.assertEqual(self.verify(self.root / "absent.pdf")[0].returncode, 7)
        self.assertEqual(self.verify(report, args=["--trust", self.root / "absent.pem"])[0].returncode, 2)

    def test_a_wrong_password_fails_what_is_signed_and_nothing_else_and_is_not_shown(self):
        keys = self.keys()
        self.site_toml(keys, password='password_env = "NONIO_TEST_KEY"')
        self.signed_campaign("c1")
        self.signed_campaign("c2").joinpath("campaign.toml").write_text(
            (self.site / "c2" / "campaign.toml").read_text() + '[run]\noutputs = ["csv"]\n')
        environment = {**os.environ, "NONIO_TEST_KEY": "hunter2"}
        done = self.run_nonio(expect=1, env=environment)
        self.assertEqual(self.results("c1")["status"], "failed")
        self.assertNotEqual(self.results("c2")["status"], "failed")
        self.assertIn("wrong password", json.dumps(self.summary()["notes"]))
        self.assertEqual([p.name for p in (self.out / "c1").iterdir() if p.suffix in (".pdf", ".xml")], [])
        for text in [done.stdout, done.stderr, *(p.read_text(errors="replace") for p in self.out.rglob("*") if p.is_file())]:
            self.assertNotIn("hunter2", text)
        # The next run has the right password: it signs although nothing in the site has changed.
        self.run_nonio(expect=0, env={**os.environ, "NONIO_TEST_KEY": PASSWORD})
        self.assert_holds(self.out / "c1" / "report.pdf")

    def test_a_run_signs_nothing_that_was_not_approved(self):
        keys = self.keys()
        for extra in ("[certificate]\nrelease = \"by-hand\"\n", '[certificate]\nrelease = "automatic"\naccept = []\n'):
            with self.subTest(extra):
                self.site_toml(keys, extra=extra)
                self.signed_campaign("c1")
                self.run_nonio("--force", expect=0)
                self.assertEqual([p.name for p in (self.out / "c1").iterdir() if p.suffix in (".pdf", ".xml")], [])
                self.assertIn("signature.not-released", (self.out / "c1" / "results.json").read_text())
                self.assertEqual(self.results("c1")["status"], "attention")

    def test_the_password_may_come_from_systemd(self):
        keys = self.keys()
        self.site_toml(keys, password='password_credential = "password"')
        self.signed_campaign("c1")
        self.run_nonio(expect=0, env={**os.environ, "CREDENTIALS_DIRECTORY": str(keys.folder)})
        self.assert_holds(self.out / "c1" / "report.pdf")

    def test_without_a_key_nothing_unsigned_is_left(self):
        self.signed_campaign("c1")
        (self.site / "site.toml").write_text("[options.pdf-report]\nsign = true\n" + AUTOMATIC)
        self.run_nonio(expect=1)
        self.assertIn("[signing]", json.dumps(self.results("c1")["errors"]))
        self.assertFalse((self.out / "c1" / "report.pdf").exists())

    def test_a_certificate_about_to_run_out_is_said(self):
        self.site_toml(self.keys(days=20))
        self.signed_campaign("c1")
        self.run_nonio(expect=0)
        self.assertIn("expires on", json.dumps(self.summary()["notes"]))

    def test_that_no_time_server_is_named_is_said(self):
        self.site_toml(self.keys())
        self.signed_campaign("c1")
        self.run_nonio(expect=0)
        self.assertIn("no time-stamp server is configured", json.dumps(self.summary()["notes"]))

    def test_the_first_line_says_what_was_compared(self):
        self.site_toml(self.keys())
        self.signed_campaign("c1")
        self.run_nonio(expect=0)
        report = self.out / "c1" / "report.pdf"

        def first_line(*args):
            done = subprocess.run([NONIO, "certificate", "verify", "--site", str(self.site), *map(str, args), str(report)], capture_output=True,
                                  text=True, timeout=300)
            return done.stdout.splitlines()[0].split("; signed by ")[0]
        self.assertEqual(first_line(), f"{report}: VALID (2 checks not made: time stamp, revocation)")
        words = self.site / "templates" / "words" / "en" / "report.toml"
        words.parent.mkdir(parents=True)
        words.write_text((TEMPLATES / "words" / "en" / "report.toml").read_text() + "# other\n")
        self.assertEqual(first_line(), f"{report}: OTHER WORDS THAN INSTALLED")

    def test_unchanged_data_are_not_signed_anew(self):
        self.site_toml(self.keys())
        self.signed_campaign("c1")
        self.run_nonio(expect=0)
        before = (self.out / "c1" / "report.pdf").read_bytes()
        self.run_nonio(expect=0)
        self.assertEqual(before, (self.out / "c1" / "report.pdf").read_bytes())

    def test_the_time_stamp_of_a_run_is_extended(self):
        keys = self.keys()
        server = keys.time_server()
        self.site_toml(keys, extra=f'time_stamp = "{server.url}"\n')
        self.signed_campaign("c1")
        self.run_nonio(expect=0)
        issued = self.out / "c1" / "report.pdf"
        archive = self.root / "archive"
        restamp = [NONIO, "certificate", "extend", "--site", str(self.site), "--no-fetch", "--revoked", str(keys.revocation_list())]
        done = subprocess.run([*restamp, str(issued)], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1)
        self.assertIn("as it was issued", done.stderr)
        done = subprocess.run([*restamp, str(issued), "--out", str(archive), "--json"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        answer = json.loads(done.stdout)
        self.assertEqual((answer["schema"], answer["written"]), ("nonio-restamp/1", str(archive / "report.pdf")))
        self.assertEqual(len(answer["added"]), 4, answer)  # two certificates, one list for both, the time stamp
        self.assertTrue((archive / "report.pdf").read_bytes().startswith(issued.read_bytes()))
        answer = self.assert_holds(archive / "report.pdf")[0]
        for check in ("file.updates", "updates.needed", "signature.time", "certificate.revocation", "content.printed", "dcc.time"):
            self.assertEqual(self.state(answer, check), "holds", check)
        server.close()

    def test_time_stamps(self):
        keys = self.keys()
        server = keys.time_server()
        self.site_toml(keys, extra=f'time_stamp = "{server.url}"\n')
        self.signed_campaign("c1")
        self.run_nonio(expect=0)
        answer = self.assert_holds(self.out / "c1" / "report.pdf")[0]
        self.assertEqual(self.state(answer, "signature.time"), "holds")
        self.assertEqual(self.state(answer, "dcc.time"), "holds")
        self.assertEqual(self.state(self.assert_holds(self.out / "c1" / "dcc.xml")[0], "xml.time"), "holds")
        self.assertNotIn("no time-stamp server", json.dumps(self.summary()["notes"]))
        server.close()
        self.run_nonio("--force", expect=1)
        self.assertIn("no time stamp", json.dumps(self.results("c1")["errors"]))
        self.site_toml(keys, extra=f'time_stamp = "{server.url}"\ntime_stamp_missing = "sign"\n')
        self.run_nonio("--force", expect=0)
        answer = self.assert_holds(self.out / "c1" / "report.pdf")[0]
        self.assertEqual(self.state(answer, "signature.time"), "not checked")
        self.assertEqual(self.ids("attention"), ["c1"])

    def test_mistakes_in_the_configuration(self):
        keys = self.keys()
        self.signed_campaign("c1")
        for key, password, extra, word in [
                (" ", None, "", "either pkcs12"), (None, " ", "", "one of password_file"),
                (None, None, 'time_stamp = "https://x"\n', "http://"), (None, None, "colour = 1\n", "colour"),
                ('pkcs11 = "pkcs11:token=x"', None, "", "module")]:
            self.site_toml(keys, key=key, password=password, extra=extra)
            self.assertIn(word, self.run_nonio(expect=2).stderr)

    def unsigned(self):
        """Files under a final name that are not whole and signed."""
        return [p for p in self.out.rglob("report*.pdf") if not p.name.startswith(".") and
                (b"/Contents <30" not in p.read_bytes() or not p.read_bytes().endswith(b"%%EOF\n"))]

    def test_kill_9_at_random_moments(self):
        print(f"seed {SEED}, {KILLS} kills", flush=True)
        rng = random.Random(SEED)
        self.site_toml(self.keys())
        for i in range(12):
            self.signed_campaign(f"c{i:02}")
        began = time.monotonic()
        self.run_nonio("--jobs", "4", out=self.root / "reference", expect=0)
        seconds = time.monotonic() - began
        for k in range(KILLS):
            self.out = self.root / f"out-{k}"
            process = subprocess.Popen(self.command("--jobs", "4"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                process.wait(rng.uniform(0.0, seconds))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            self.assertEqual(self.unsigned(), [])
            self.run_nonio("--jobs", "4", expect=0)
            self.assert_holds(*self.out.glob("*/report.pdf"), *self.out.glob("*/dcc.xml"))
            self.assertEqual(len(list(self.out.glob("*/report.pdf"))), 12)

    def test_kill_of_the_signer_costs_no_campaign(self):
        self.site_toml(self.keys())
        for i in range(12):
            self.signed_campaign(f"c{i:02}")
        process = subprocess.Popen(self.command("--jobs", "2"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while not (children := self.children(process.pid)):
            time.sleep(0.001)
        os.kill(children[0], 9)  # the signer is made first
        process.wait(120)
        self.run_nonio(expect=0)
        self.assertEqual(self.unsigned(), [])
        self.assert_holds(*self.out.glob("*/report.pdf"))

    @staticmethod
    def children(pid):
        try:
            with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
                return [int(c) for c in file.read().split()]
        except OSError:
            return []


if __name__ == "__main__":
    unittest.main(verbosity=2)
