# SPDX-License-Identifier: Apache-2.0
"""Certificates under numbers: each once, none twice, none lost; what was issued stays as it was."""
import json
import os
import pathlib
import random
import re
import shutil
import sqlite3
import subprocess
import sys
import time
import unittest
import unittest.mock

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "real" / "signing"))
from nightly import PLUGINS, readings, tree  # noqa: E402
from signing import NONIO, SIGNER, SigningTest, run  # noqa: E402

KILLS = int(os.environ.get("NONIO_KILLS", "50"))
SEED = int(os.environ.get("NONIO_SEED", str(random.randrange(10**6))))
YEAR = time.strftime("%Y")


def number(n):
    return f"{YEAR}-{n:04}"


class Certificates(SigningTest):
    def setUp(self):
        super().setUp()
        self.key = self.keys()
        self.held = {}  # files that were verified
        self.site_with()
        self.environment = {**os.environ, "NONIO_PLUGIN_PATH": str(PLUGINS / "numbered")}

    def site_with(self, keys=None, extra=""):
        self.site_toml(keys or self.key, extra=extra)
        text = (self.site / "site.toml").read_text()
        (self.site / "site.toml").write_text(text.replace('["pdf-report", "dcc"]', '["numbered", "dcc"]'))

    def night(self, *args, expect=0, how=None, **kwargs):
        environment = {**self.environment, **({"NONIO_TEST_NUMBERED": how} if how else {})}
        return self.run_nonio(*args, expect=expect, env=environment, **kwargs)

    def verify(self, *files, how=None, **kwargs):
        with unittest.mock.patch.dict(os.environ, {**self.environment, "NONIO_TEST_NUMBERED": how or ""}):
            return super().verify(*files, **kwargs)

    def certificates(self, *args, check=True):
        return run(NONIO, "certificates", self.site, *args, check=check)

    def entries(self):
        return json.loads(self.certificates("--json").stdout)["certificates"]

    def states(self):
        return {e["number"]: e["state"] for e in self.entries()}

    def pdf(self, campaign, out=None):
        return (out or self.out) / campaign / "numbered.pdf"

    def printed(self, campaign, what):
        text = self.pdf(campaign).read_bytes().decode("latin-1")
        return re.search(rf"[( ]{what} (\S*)", text).group(1)

    def change(self, campaign, seed):
        (self.site / campaign / "x.csv").write_text(readings(seed), encoding="utf-8")

    def finding(self, campaign, wanted):
        for table in self.results(campaign).get("tables", []):
            for f in table["findings"]:
                if f["id"] == wanted:
                    return f
        return None

    def issued_files(self, out=None):
        """What must not change: certificates, their signatures, the results that speak of them."""
        return {k: v for k, v in tree(out or self.out).items() if k.endswith((".pdf", ".xml", "results.json"))}

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
        answers = self.assert_holds(self.pdf("c1"))
        self.assertEqual(self.state(answers[0], "content.printed"), "not checked")

    def test_other_readings_are_an_amendment(self):
        self.signed_campaign("c1")
        self.night()
        first = self.pdf("c1").read_bytes()
        self.change("c1", "other")
        self.night()
        self.assertEqual(self.printed("c1", "number"), number(2))
        self.assertEqual(self.printed("c1", "replaces"), number(1))
        self.assertEqual(self.printed("c1", "changes"), "x.csv")
        self.assertEqual(self.results("c1")["certificate"]["changes"], ["x.csv"])
        self.assertIn(f"{number(2)} (c1, replaces {number(1)})", (self.out / "summary.txt").read_text())
        self.assert_holds(self.pdf("c1"))
        self.assertEqual(self.states(), {number(1): "amended", number(2): "issued"})
        self.certificates("--out", self.root / "all")
        self.assertEqual((self.root / "all" / f"{number(1)}.pdf").read_bytes(), first)
        self.assertEqual((self.root / "all" / f"{number(2)}.pdf").read_bytes(), self.pdf("c1").read_bytes())
        self.assertIn("amended by " + number(2), self.certificates().stdout)
        # What has no say in the results changes nothing, what has changes it.
        self.site_with(extra='[limits]\nseconds = 100\n')
        self.night()
        self.assertEqual(self.printed("c1", "number"), number(2))
        self.site_with(extra='[options.dcc]\nlanguage = "en"\n')
        self.night()
        self.assertEqual(self.results("c1")["certificate"]["changes"], ["site.toml"])

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
        (self.site / "site.toml").write_text((self.site / "site.toml").read_text().split("[signing]")[0])
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
        self.assertIn("wanted one of them", self.night(expect=1).stderr)
        self.assertEqual(self.entries(), [])

    def test_what_is_withdrawn_is_issued_anew(self):
        self.signed_campaign("c1")
        self.signed_campaign("c2")
        self.night("--jobs", "1")
        for args in (["--withdraw", number(1)], ["--why", "x"], ["--withdraw", number(9), "--why", "x"]):
            self.assertEqual(self.certificates(*args, check=False).returncode, 2)
        self.assertIn("wrong stamp", self.certificates("--withdraw", number(1), "--why", "wrong stamp").stdout)
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

    def test_a_register_that_is_lost_stops_the_night(self):
        self.signed_campaign("c1")
        self.night()
        register = self.site / "certificates.sqlite"
        register.rename(self.root / "kept")
        self.assertIn("does not know the number " + number(1), self.night(expect=2).stderr)
        self.assertIn("does not know the number " + number(1), self.night("--force", expect=2).stderr)
        register.write_text("no register")
        self.night(expect=2)
        (self.root / "kept").replace(register)
        self.night()
        for place in ("../numbers.sqlite", "/tmp/numbers.sqlite"):
            self.site_with(extra=f'[certificate]\nregister = "{place}"\n')
            self.assertIn("inside the site", self.night(expect=2).stderr)
        self.site_with(extra='[certificate]\nregister = "out/numbers.sqlite"\n')
        self.assertIn("output folder", self.night(expect=2, out=self.site / "out").stderr)
        self.site_with(extra='[certificate]\nnumbering = "{month}"\n')
        self.assertIn("numbering", self.night(expect=2).stderr)

    def test_two_nights_at_once_issue_each_certificate_once(self):
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
        self.assertEqual(done.returncode, 0)

    def test_kill_9_at_random_moments(self):
        print(f"seed {SEED}, {KILLS} kills", flush=True)
        rng = random.Random(SEED)
        names = [f"c{i}" for i in range(12)]
        for name in names:
            self.signed_campaign(name)
        began = time.monotonic()
        self.night("--jobs", "4")
        longest, kills, nights = time.monotonic() - began, 0, 2
        self.give_new_readings(names, nights)
        while kills < KILLS:
            began = time.monotonic()
            process = subprocess.Popen(self.command("--jobs", "4"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                       env=self.environment)
            try:
                code = process.wait(rng.uniform(0.0, longest))
                self.assertEqual(code, 0)
                longest = time.monotonic() - began
                nights += 1
                self.give_new_readings(names, nights)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                kills += 1
            self.assert_all_hold()
        self.night("--jobs", "4")
        self.assert_all_hold()
        entries = self.entries()
        self.assertEqual([e["number"] for e in entries], [number(n + 1) for n in range(len(entries))])
        for e in entries:
            self.assertIn(e["state"], ("issued", "amended", "drawn"))
            self.assertTrue(e["state"] != "drawn" or e["reason"], e)
        in_force = {e["campaign"]: e["number"] for e in entries if e["state"] == "issued"}
        self.assertEqual({name: self.printed(name, "number") for name in names}, in_force)
        self.assertEqual(len(set(in_force.values())), len(names))
        answers = self.assert_holds(*self.out.glob("*/*.pdf"))
        self.assertEqual({self.state(a, "content.printed") for a in answers}, {"holds"})
        self.certificates("--out", self.root / "all")
        for e in entries:
            if e["state"] != "drawn":
                text = (self.root / "all" / (e["number"] + ".pdf")).read_bytes()
                self.assertIn(f"(number {e['number']} of".encode(), text)
        print(f"{kills} kills in {nights} nights, {len(entries)} numbers", flush=True)

    def give_new_readings(self, names, night):
        for name in names:
            self.change(name, f"{name} {night}")

    def assert_all_hold(self):
        """Whatever bears a final name is whole and signed."""
        now = {p: p.read_bytes() for kind in ("*.pdf", "*.xml") for p in self.out.glob("*/" + kind)
               if not p.name.startswith(".")}
        fresh = [p for p, text in now.items() if self.held.get(p) != text]
        if fresh:
            self.assert_holds(*fresh)
        self.held = now


if __name__ == "__main__":
    unittest.main(verbosity=2)
