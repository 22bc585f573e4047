# SPDX-License-Identifier: Apache-2.0
"""Certificates under numbers: each once, none twice, none lost; what was issued stays as it was."""
import os
import re
import shutil
import sqlite3
import subprocess
import time
import unittest
import unittest.mock

from numbered import NumberedTest, number
from signing import NONIO, run
from nightly import readings
from signing import NONIO, SIGNER, run


class Certificates(NumberedTest):
    def test_what_did_not_change_is_not_issued_anew(self):
        for name in ("c1", "c2", "c3"):
            self.signed_campaign(name)
        self.night()
        self.assertEqual(sorted(self.printed(c, "number") for c in ("c1", "c2", "c3")), [number(n) for n in (1, 2, 3)])
        self.assertEqual(sorted(i["number"] for i in self.summary()["issued"]), [number(n) for n in (1, 2, 3)])
        self.assertIn("issued 3 certificates: " + number(1), (self.out / "summary.txt").read_text())
        answers = self.assert_holds(*self.out.glob("*/*.pdf"), *self.out.glob("*/*.xml"))
        self.assertEqual({self.state(a, "content.printed") for a in answers if a["file"].endswith("pdf")}, {"holds"})
        c = self.results("c1")["certificate"]
        self.assertEqual((c["plugin"], c["number"], c["date"]), ("numbered", self.printed("c1", "number"), time.strftime("%Y-%m-%d")))
        self.assertEqual(c["readings_sha256"], run("sha256sum", self.site / "c1" / "x.csv").stdout.split()[0])
        before = self.issued_files()
        self.night()
        self.assertEqual(self.ids("unchanged"), ["c1", "c2", "c3"])
        self.assertEqual(self.summary()["issued"], [])
        for again in (["--force"], ["--force", "--jobs", "3"]):
            self.night(*again)
            self.assertEqual(self.issued_files(), before)
        shutil.rmtree(self.out)
        self.night(how="want more")  # a version that asks for more than was asked then
        self.assertEqual(self.issued_files(), before)
        # Other templates make other pages, of certificates to come.
        templates = self.site / "templates" / "words" / "en"
        templates.mkdir(parents=True)
        (templates / "more.toml").write_text('x = "y"\n')
        self.night()
        self.assertEqual(len(self.ids("done")), 3)
        self.assertEqual(self.issued_files(), before)
        self.assertEqual(set(self.states().values()), {"issued"})
        # Its own words travel in the file: it is drawn with them, and the verdict says so.
        done, answers = self.verify(self.pdf("c1"))
        self.assertEqual((done.returncode, answers[0]["verdict"]), (8, "other-words"))
        self.assertEqual(self.state(answers[0], "content.printed"), "holds")
        self.assertEqual(self.state(answers[0], "content.words"), "fails")

    def test_other_readings_are_an_amendment(self):
        self.signed_campaign("c1")
        self.night()
        first = self.pdf("c1").read_bytes()
        self.change("c1", "other")
        self.night()
        self.assertEqual(self.printed("c1", "number"), number(2))
        self.assertEqual(self.printed("c1", "replaces"), number(1))
        changes, = self.results("c1")["certificate"]["changes"]
        self.assertEqual(changes["file"], "x.csv")
        before, after = readings("c1").splitlines(), readings("other").splitlines()
        differ = [(i + 1, a, b) for i, (a, b) in enumerate(zip(before, after)) if a != b]
        self.assertEqual([(p["line"], p["before"], p["after"]) for p in changes["places"]], differ[:40])
        self.assertEqual(changes["more"], len(differ) - 40)
        self.assertEqual(self.results("c1")["certificate"]["why"], "readings other")
        self.assertIn(b"why readings other changes x.csv [%d: %s > %s]" % (differ[0][0], differ[0][1].encode(), differ[0][2].encode()),
                      self.pdf("c1").read_bytes())
        self.assertIn(f"{number(2)} (c1, replaces {number(1)})", (self.out / "summary.txt").read_text())
        self.assert_holds(self.pdf("c1"))
        self.assertEqual(self.states(), {number(1): "amended", number(2): "issued"})
        self.certificates("--out", self.root / "all")
        self.assertEqual((self.root / "all" / f"{number(1)}.pdf").read_bytes(), first)
        self.assertEqual((self.root / "all" / f"{number(2)}.pdf").read_bytes(), self.pdf("c1").read_bytes())
        self.assertIn("amended, replaced by " + number(2), self.certificates().stdout)
        # A key without effect on the results changes nothing; one with effect makes an amendment.
        self.site_with(extra='[limits]\nseconds = 100\n')
        self.night()
        self.assertEqual(self.printed("c1", "number"), number(2))
        self.site_with(extra='[options.dcc]\nlocation = "laboratory"\n')
        self.amend("c1", "made in the laboratory")
        self.night()
        self.assertEqual(self.results("c1")["certificate"]["changes"],
                         [{"file": "site.toml", "places": [{"key": "options.dcc.location", "after": "laboratory"}]}])
        # A rule of decision decides anew what conforms.
        self.site_with(extra='[options.dcc]\nlocation = "laboratory"\n[certificate]\ndecision_rule = "ilac-g8-simple"\n')
        self.amend("c1", "the customer wants another rule")
        self.night()
        self.assertEqual(self.printed("c1", "number"), number(4))

    def test_what_is_missing_is_said_at_once_and_no_number_is_drawn(self):
        self.campaign("c1")
        (self.site / "site.toml").write_text((self.site / "site.toml").read_text().replace(', "dcc"', ""))
        self.night()
        self.assertEqual(self.finding("c1", "certificate.incomplete")["evidence"]["missing"],
                         "campaign.customer, machine.serial")
        self.assertEqual(self.ids("attention"), ["c1"])
        self.assertFalse(self.pdf("c1").exists())
        self.assertEqual(self.entries(), [])
        self.assertFalse((self.site / "certificates.sqlite").exists())
        self.signed_campaign("c1")
        self.night("--dry-run")
        self.assertFalse((self.site / "certificates.sqlite").exists())
        self.night()
        self.assertEqual(self.states(), {number(1): "issued"})

    def test_days_that_cannot_be_stop_the_certificate(self):
        """What makes a measurement traceable has to hold on the day on which it was made: 2026-11-03."""
        instrument = '[instrument]\nserial = "L-1"\n%s\n'
        sensor = '[[sensor]]\nmeasures = "pressure"\nserial = "P-7"\n%s\n'
        later = time.strftime("%Y-%m-%d", time.localtime(time.time() + 3 * 86400))
        cases = {
            "later": (instrument % "calibrated = 2026-11-04", "", "traceability.calibrated-later"),
            "ago": (instrument % "calibrated = 2015-11-02", "", "traceability.calibrated-long-ago"),
            "expired": (instrument % "calibrated = 2026-01-02\nvalid_until = 2026-11-02", "", "traceability.calibration-expired"),
            "during": (instrument % "calibrated = 2026-01-02\nvalid_until = 2026-11-04", "end_date = 2026-11-05\n",
                       "traceability.calibration-expired"),
            "sensor": (sensor % "calibrated = 2026-11-04", "", "traceability.calibrated-later"),
            "sensor-ago": (sensor % "calibrated = 2021-11-04", "", "traceability.calibrated-long-ago"),
            "received": ("", "received = 2026-11-04\n", "traceability.received-later"),
            "future": ("", f"end_date = {later}\n", "certificate.incomplete"),
        }
        good = {
            "day": (instrument % "calibrated = 2026-11-03\nvalid_until = 2026-11-03", ""),
            "two-years": (instrument % "calibrated = 2024-11-03", ""),
            "stated": (instrument % "calibrated = 2015-11-02\nvalid_until = 2027-01-01" + sensor % "calibrated = 2026-01-02",
                       "received = 2026-11-03\n"),
        }
        for name, (tables, keys, *_) in (cases | good).items():
            folder = self.signed_campaign(name)
            text = (folder / "campaign.toml").read_text("utf-8").replace("date =", keys + "date =", 1)
            (folder / "campaign.toml").write_text(text + tables, encoding="utf-8")
        self.night()
        self.assertEqual(sorted(e["campaign"] for e in self.entries()), sorted(good))
        self.assertEqual(self.ids("failed"), [])
        for name, (_, _, finding) in cases.items():
            self.assertFalse(self.pdf(name).exists(), name)
            self.assertIn(name, self.ids("attention"))
            if "ago" in finding or "expired" in finding:  # may be issued for a reason, not by rules
                found = [f["id"] for a in self.results(name)["analyses"] for f in a["findings"]]
                self.assertIn(finding, found, name)
                continue
            self.assertIsNotNone(self.finding(name, finding), name)
            self.assertIsNotNone(self.finding(name, "certificate.incomplete"), name)
        evidence = self.finding("sensor", "traceability.calibrated-later")["evidence"]
        self.assertEqual((evidence["instrument"], evidence["calibrated"], evidence["measured"]),
                         ("sensor pressure P-7", "2026-11-04", "2026-11-03"))
        self.assertIn(f"campaign.end_date ({later} is still to come", self.finding("future", "certificate.incomplete")["evidence"]["missing"])

    def test_a_number_that_was_not_issued_says_why_and_is_used_again(self):
        self.signed_campaign("c1")
        for how, why in (("crash", "signal 11"), ("fail", "an error on purpose"), ("leave unsigned", "nothing that is signed")):
            self.night(expect=1, how=how)
            self.assertFalse(self.pdf("c1").exists())
            self.assertFalse((self.out / "c1" / "dcc.xml").exists())
            entry, = self.entries()
            self.assertEqual((entry["number"], entry["state"]), (number(1), "drawn"))
            self.assertIn(why, entry["reason"])
            self.assertNotIn("certificate", self.results("c1"))
            self.site_with(extra=f"# {how}\n")  # so that the failed campaign is done again
        key = self.key.p12.read_bytes()
        self.key.p12.write_bytes(b"")
        self.night(expect=1)
        self.assertFalse((self.out / "c1" / "dcc.xml").exists())
        self.assertEqual(self.states(), {number(1): "drawn"})
        self.key.p12.write_bytes(key)
        self.night()
        self.assertEqual(self.states(), {number(1): "issued"})
        # With what was issued no key is needed.
        before = self.issued_files()
        (self.site / "site.toml").write_text((self.site / "site.toml").read_text().split("[signing]")[0] + "# no key\n")
        self.night()
        self.assertEqual(self.issued_files(), before)

    def test_a_version_with_other_numbers_says_so_and_changes_nothing(self):
        self.signed_campaign("c1")
        self.night()
        before = self.pdf("c1").read_bytes()
        with sqlite3.connect(self.site / "certificates.sqlite") as register:
            results, = register.execute("SELECT results FROM certificates").fetchone()
            other = re.sub(rb'("E": \{\s*"value": )[-0-9.e]+', rb"\g<1>123.5", bytes(results), count=1)
            self.assertNotEqual(other, results)
            register.execute("UPDATE certificates SET results = ?", (other,))
        register.close()
        self.night("--force")
        self.assertEqual(self.pdf("c1").read_bytes(), before)
        self.assertIn("123.5", self.finding("c1", "certificate.differs")["evidence"]["why"])
        self.assertEqual(self.ids("attention"), ["c1"])

    def test_one_number_for_one_campaign(self):
        self.signed_campaign("c1")
        (self.site / "site.toml").write_text((self.site / "site.toml").read_text().replace('"dcc"]', '"numbered-too"]'))
        self.assertIn("expected one of them", self.night(expect=1).stderr)
        self.assertEqual(self.entries(), [])

    def test_what_is_withdrawn_is_issued_anew(self):
        self.signed_campaign("c1")
        self.signed_campaign("c2")
        self.night("--jobs", "1")
        for args in (["--withdraw", number(1)], ["--why", "x"], ["--withdraw", number(9), "--why", "x"]):
            self.assertEqual(self.certificates(*args, check=False).returncode, 2)
        def is_marked(campaign, mark):
            shown = run(NONIO, "show", self.out / campaign).stdout
            return mark in next(line for line in shown.splitlines() if line.startswith("  certificate "))
        self.assertFalse(is_marked("c1", "not in force"))
        self.assertIn("wrong stamp", self.certificates("--withdraw", number(1), "--why", "wrong stamp").stdout)
        self.assertTrue(is_marked("c1", "not in force"))
        self.assertFalse(is_marked("c2", "not in force"))
        self.night()
        self.assertEqual(self.ids("done"), ["c1"])
        self.assertIn("withdrawn", self.reason("done", "c1"))
        self.assertEqual(self.printed("c1", "number"), number(3))
        self.assertEqual(self.printed("c1", "replaces"), number(1))
        self.assertEqual(self.states(), {number(1): "withdrawn", number(2): "issued", number(3): "issued"})
        self.night()
        self.assertEqual(self.ids("done"), [])

    def test_the_missing_time_stamp_of_an_issued_certificate_stays_said(self):
        server = self.key.time_server()
        self.site_with(extra=f'time_stamp = "{server.url}"\ntime_stamp_missing = "sign"\n')
        server.close()
        self.signed_campaign("c1")
        self.night()
        before = self.issued_files()
        self.assertIsNotNone(self.finding("c1", "signature.no-time-stamp"))
        self.night("--force")
        self.assertEqual(self.issued_files(), before)
        self.assertEqual(self.ids("attention"), ["c1"])

    def test_a_register_that_is_lost_stops_the_run(self):
        self.signed_campaign("c1")
        self.night()
        register = self.site / "certificates.sqlite"
        register.rename(self.root / "kept")
        identity = self.site / "certificates.sqlite.identity"
        for content in (None, b""):  # lost, or emptied; also where the output folder is another one
            if content is not None:
                register.write_bytes(content)
            for out in (self.out, self.root / "new"):
                self.assertIn("restore it from the backup", self.night(expect=2, out=out).stderr)
        register.unlink()
        identity.rename(self.root / "kept.identity")
        self.assertIn("does not know the number " + number(1), self.night(expect=2).stderr)
        self.assertIn("does not know the number " + number(1), self.night("--force", expect=2).stderr)
        register.write_text("no register")
        self.night(expect=2)
        (self.root / "kept").replace(register)
        (self.root / "kept.identity").replace(identity)
        self.night()
        for place in ("../numbers.sqlite", "/tmp/numbers.sqlite"):
            self.site_with(extra=f'[certificate]\nregister = "{place}"\n')
            self.assertIn("inside the site", self.night(expect=2).stderr)
        self.site_with(extra='[certificate]\nregister = "out/numbers.sqlite"\n')
        self.assertIn("output folder", self.night(expect=2, out=self.site / "out").stderr)
        self.site_with(extra='[certificate]\nnumbering = "{month}"\n')
        self.assertIn("numbering", self.night(expect=2).stderr)

    def test_two_runs_at_once_issue_each_certificate_once(self):
        names = [f"c{i}" for i in range(8)]
        for name in names:
            self.signed_campaign(name)
        outs = [self.root / "a", self.root / "b"]
        runs = [subprocess.Popen(self.command("--jobs", "2", out=out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                 env=self.environment)
                for out in outs]
        self.assertEqual([r.wait(120) for r in runs], [0, 0])
        self.assertEqual(self.states(), {number(n): "issued" for n in range(1, 9)})
        for name in names:
            for file in ("numbered.pdf", "dcc.xml", "results.json"):
                self.assertEqual((outs[0] / name / file).read_bytes(), (outs[1] / name / file).read_bytes(), (name, file))
        self.assert_holds(*outs[0].glob("*/*.pdf"))

    def test_a_page_that_says_otherwise_is_found(self):
        self.signed_campaign("c1")
        self.night(how="lie")
        done, answer = self.verify(self.pdf("c1"))
        self.assertEqual(done.returncode, 1)
        self.assertEqual(self.state(answer[0], "content.values"), "holds")
        self.assertEqual(self.state(answer[0], "content.printed"), "fails")
        done, answer = self.verify(self.pdf("c1"), how="lie")
        self.assertEqual(done.returncode, 3)
        self.plugins_are_loaded_where_a_signature_holds(self.pdf("c1"))

    def test_each_verdict_has_its_words_and_its_status(self):
        """A customer must be able to distinguish a forged file, one whose signer is not known, and one that is not a certificate."""
        self.signed_campaign("c1")
        self.night()
        honest = self.pdf("c1")
        def made(name, data):
            path = self.root / name
            path.write_bytes(data)
            return path
        whole = honest.read_bytes()
        changed = bytearray(whole)
        changed[len(whole) // 3] ^= 1
        trusted = {"site": False, "args": ["--trust", self.key.ca, "--signer", SIGNER]}
        xml = (self.out / "c1" / "dcc.xml").read_bytes()
        self.assertIn(b"<dcc:", xml)
        foreign = re.sub(rb"<[A-Za-z:]*Signature .*</[A-Za-z:]*Signature>", b"", xml, flags=re.S)
        for path, kwargs, verdict, words, status in (
                (honest, {}, "incomplete", "VALID (2 checks not made: time stamp, revocation)", 3),
                (honest, trusted, "incomplete", "VALID (3 checks not made: time stamp, revocation, register)", 3),
                (honest, {"site": False}, "untrusted", "SIGNER NOT TRUSTED BY YOU", 4),
                (honest, {"site": False, "args": ["--trust", self.key.ca]}, "untrusted", "SIGNER NOT TRUSTED BY YOU", 4),
                (honest, {"site": False, "args": ["--trust", self.key.ca, "--signer", "CN=Eve"]}, "untrusted", "SIGNER NOT TRUSTED BY YOU", 4),
                (made("changed.pdf", bytes(changed)), {}, "altered", "ALTERED OR BROKEN", 1),
                (made("short.pdf", whole[:-300]), {}, "altered", "ALTERED OR BROKEN", 1),
                (made("longer.pdf", whole + b"% more\n"), {}, "altered", "ALTERED OR BROKEN", 1),
                (made("dcc.xml", xml.replace(b"</dcc:value>", b"1</dcc:value>", 1).replace(b"<dcc:name>", b"<dcc:name> ", 1)), {}, "altered", "ALTERED OR BROKEN", 1),
                (made("unsigned.pdf", b"%PDF-1.7\n%%EOF\n"), {}, "no-certificate", "NOT A CERTIFICATE", 6),
                (made("unsigned.xml", foreign), {}, "no-certificate", "NOT A CERTIFICATE", 6),
                (made("note.txt", b"hello"), {}, "no-certificate", "NOT A CERTIFICATE", 6),
                (self.root / "absent.pdf", {}, "no-file", "NO SUCH FILE", 7)):
            with self.subTest(file=path.name, **{k: str(v) for k, v in kwargs.items()}):
                done, (answer,) = self.verify(path, **kwargs)
                self.assertEqual((answer["verdict"], done.returncode), (verdict, status), done.stdout)
                whom = ["--site", str(self.site)] if kwargs.get("site", True) else []
                shown = run(NONIO, "certificate", "verify", "--quiet", *whom, *kwargs.get("args", ()), path, check=False, env=self.environment)
                self.assertEqual((shown.stdout, shown.returncode), (f"{path}: {words}\n", status))
                self.assertEqual(answer["holds"], status in (0, 3))
        # The gravest of several.
        self.assertEqual(self.verify(honest, self.root / "note.txt", self.root / "changed.pdf")[0].returncode, 1)
        self.certificates("--withdraw", number(1), "--why", "wrong stamp")
        done, (answer,) = self.verify(honest)
        self.assertEqual((answer["verdict"], done.returncode), ("not-in-force", 5))

    def plugins_are_loaded_where_a_signature_holds(self, honest):
        broken = self.site.parent / "broken.pdf"
        broken.write_bytes(honest.read_bytes()[:-200])
        files = [broken, honest, self.site.parent / "none.pdf", honest, broken]
        with unittest.mock.patch.dict(os.environ, {"LD_DEBUG": "files"}):
            done, refused = self.verify(broken, broken)
            self.assertEqual([a["holds"] for a in refused], [False] * 2)
            self.assertNotIn("plugins/", done.stderr)
            done, answers = self.verify(*files)
            self.assertIn("plugins/", done.stderr)
        self.assertEqual([a["file"] for a in answers], list(map(str, files)))  # each once, in this order

    def test_the_record_of_the_machine_is_in_its_certificate(self):
        self.signed_campaign("c1")
        manifest = self.site / "c1" / "campaign.toml"
        manifest.write_text(manifest.read_text().replace("[machine]\n", '[machine]\nasset = "S-0042"\n', 1))
        (self.site / "machines").mkdir()
        record = self.site / "machines" / "S-0042.toml"
        text = 'format = 1\nasset = "S-0042"\ncontrol = "siemens-840d"\n[axes.X]\nnumber = 3\nreference_mm = 100\n'
        record.write_text(text)
        self.night()
        self.assertEqual(self.states(), {number(1): "issued"})
        if shutil.which("pdfdetach"):
            self.assertIn("machine-record.json", run("pdfdetach", "-list", self.pdf("c1")).stdout)
        self.assert_holds(self.pdf("c1"))
        # What is in the control by now makes no other data of these readings: the number stays, and so does the record.
        before = self.pdf("c1").read_bytes()
        record.write_text(text.replace("number = 3", "number = 4"))
        self.night()
        self.assertEqual(self.states(), {number(1): "issued"})
        self.assertEqual(self.pdf("c1").read_bytes(), before)
        self.assert_holds(self.pdf("c1"))
        # Of an amendment's files none is "gone": the record was never a file of the campaign.
        self.change("c1", "other")
        self.night()
        self.assertEqual(self.states(), {number(1): "amended", number(2): "issued"})
        self.assertEqual([c["file"] for c in self.results("c1")["certificate"]["changes"]], ["x.csv"])
        self.assert_holds(self.pdf("c1"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
