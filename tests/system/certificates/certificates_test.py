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

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "batch"))
from nightly import PLUGINS, readings, tree  # noqa: E402
from signing import NONIO, SIGNER, SigningTest, run  # noqa: E402

KILLS = int(os.environ.get("NONIO_KILLS", "50"))
SEED = int(os.environ.get("NONIO_SEED", str(random.randrange(10**6))))
YEAR = time.strftime("%Y")


def number(n):
    return f"{YEAR}-{n:04}"


KNOWN = "reversal.lost-motion"  # all campaigns here have it
AUTOMATIC = f'release = "automatic"\nmay_stand = [{{ finding = "{KNOWN}", reason = "it is what was ordered" }}]\n'


class Certificates(SigningTest):
    def setUp(self):
        super().setUp()
        self.key = self.keys()
        self.held = {}  # files that were verified
        self.release = AUTOMATIC
        self.site_with()
        self.environment = {**os.environ, "NONIO_PLUGIN_PATH": str(PLUGINS / "numbered")}

    def site_with(self, keys=None, extra=""):
        if "[certificate]\n" in extra:
            extra = extra.replace("[certificate]\n", "[certificate]\n" + self.release)
        else:
            extra += "[certificate]\n" + self.release
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

    def change(self, campaign, seed, why=None):
        """Other readings, and the reason for the amendment that comes of it."""
        (self.site / campaign / "x.csv").write_text(readings(seed), encoding="utf-8")
        self.amend(campaign, why or f"readings {seed}")

    def amend(self, campaign, why):
        manifest = self.site / campaign / "campaign.toml"
        text = re.sub(r'\n\[certificate\]\namendment = .*\n', "", manifest.read_text())
        manifest.write_text(text + (f'\n[certificate]\namendment = "{why}"\n' if why else ""))

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
        # Its own words travel in the file: it is drawn with them, and the verdict says so.
        answers = self.assert_holds(self.pdf("c1"))
        self.assertEqual(self.state(answers[0], "content.printed"), "holds")
        self.assertEqual(self.state(answers[0], "content.templates"), "not checked")
        self.assertEqual(answers[0]["verdict"], "holds, with other words than are installed")

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
        self.assertIn("amended by " + number(2), self.certificates().stdout)
        # What has no say in the results changes nothing, what has changes it.
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
        self.assertIn("expected one of them", self.night(expect=1).stderr)
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
        self.plugins_are_loaded_where_a_signature_holds(self.pdf("c1"))

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

    # A person releases.

    def by_hand(self, extra="", more=""):
        self.release = more
        self.site_with(extra=extra)

    def release_verb(self, *args, expect=None, campaign="c1", known=("--reason", KNOWN + "=it is what was ordered")):
        done = run(NONIO, "release", self.site / campaign, *args, *known, check=False, env=self.environment)
        if expect is not None:
            self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done

    def draft(self, campaign="c1", out=None):
        return (out or self.out) / campaign / "numbered-draft.pdf"

    def out_of_tolerance(self, campaign="c1"):
        manifest = self.site / campaign / "campaign.toml"
        manifest.write_text(manifest.read_text().replace('kind = "linear"\n', 'kind = "linear"\ntolerance_um = { E = 0.01 }\n', 1))

    def journal(self):
        with sqlite3.connect(self.site / "certificates.sqlite") as register:
            entries = register.execute("SELECT what, number, says FROM journal ORDER BY place").fetchall()
        register.close()
        return [(what, n, json.loads(says)) for what, n, says in entries]

    def change_register(self, *statements):
        with sqlite3.connect(self.site / "certificates.sqlite") as register:
            for sql in statements:
                register.execute(*([sql] if isinstance(sql, str) else sql))
        register.close()

    def test_a_night_makes_a_draft_and_a_person_releases_it(self):
        self.by_hand()
        self.signed_campaign("c1")
        self.night()
        self.assertFalse(self.pdf("c1").exists())
        self.assertFalse((self.out / "c1" / "dcc.xml").exists(), "signed with the number, not before")
        self.assertIn(b"DRAFT", self.draft().read_bytes())
        self.assertNotIn(b"/ByteRange", self.draft().read_bytes())
        self.assertEqual(self.entries(), [], "no number is drawn for a draft")
        self.assertIs(self.results("c1")["certificate"]["draft"], True)
        self.assertEqual([d["campaign"] for d in self.summary()["drafts"]], ["c1"])
        self.assertIn("1 draft waits for release (nonio release): c1", (self.out / "summary.txt").read_text())
        for folder in (self.site, self.site / "c1"):
            listed = json.loads(run(NONIO, "release", folder, "--list", "--json").stdout)["drafts"]
            self.assertEqual([(d["campaign"], d["file"]) for d in listed], [("c1", str(self.draft()))])
        first = self.draft().read_bytes()
        self.night("--force")
        self.assertEqual(self.draft().read_bytes(), first, "the same draft on every night")
        self.assertEqual(self.entries(), [])
        done = self.release_verb("--by", "Bruno Verdi", expect=0)
        self.assertIn(number(1), done.stdout)
        self.assertEqual(self.states(), {number(1): "issued"})
        self.assertFalse(self.draft().exists())
        self.assertIn(b"by Bruno Verdi", self.pdf("c1").read_bytes())
        self.assert_holds(self.pdf("c1"), self.out / "c1" / "dcc.xml")
        issued, = [says for what, _, says in self.journal() if what == "issued"]
        self.assertEqual(issued["released"]["released"]["by"], "Bruno Verdi")
        self.assertRegex(issued["released"]["released"]["at"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        before = self.issued_files()
        self.night()
        self.assertEqual(self.ids("unchanged"), ["c1"])
        self.assertEqual([i["number"] for i in self.summary()["issued"]], [number(1)], "released since the last night")
        self.assertEqual(self.summary()["drafts"], [])
        self.night("--force")
        self.assertEqual(self.issued_files(), before)
        self.assertEqual(self.summary()["issued"], [])
        self.assertIn(number(1), self.release_verb("--by", "Bruno Verdi", expect=2).stderr)

    def test_a_release_wants_a_reason_for_each_finding(self):
        self.by_hand()
        self.signed_campaign("c1")
        self.out_of_tolerance()
        self.night()
        done = self.release_verb("--by", "B", expect=1, known=())
        self.assertIn("X: " + KNOWN + " asks for attention", done.stderr)
        done = self.release_verb("--by", "B", expect=1)
        self.assertIn("X: tolerance.X.E.iso230-2 asks for attention", done.stderr)
        self.assertNotIn("X: " + KNOWN + " asks for attention", done.stderr)
        self.assertEqual(self.entries(), [])
        for wrong in (["--reason", "nonsense=x"], ["--reason", "x"], ["--reason", "tolerance.X.E.iso230-2= "]):
            self.release_verb("--by", "B", *wrong, expect=2)
        self.release_verb(expect=2)
        for nobody in (" ", "-", "\u2014", "?"):
            self.release_verb("--by", nobody, expect=2)
        self.release_verb("--by", "B", "--reason", "tolerance.X.E.iso230-2=-", expect=2)
        self.assertEqual(self.entries(), [])
        self.release_verb("--by", "B", "--reason", "tolerance.X.E.iso230-2=as found, the customer knows", expect=0)
        issued, = [says for what, _, says in self.journal() if what == "issued"]
        self.assertEqual(issued["released"]["released"]["reasons"],
                         {"X: " + KNOWN: "it is what was ordered", "X: tolerance.X.E.iso230-2": "as found, the customer knows"})
        self.assertEqual(self.states(), {number(1): "issued"})

    def test_author_and_authoriser_may_have_to_differ(self):
        self.by_hand(more="two_persons = true\n")
        self.signed_campaign("c1")
        self.out_of_tolerance()
        self.night()
        reason = ["--reason", "X: tolerance.X.E.iso230-2=known"]
        self.assertIn("author", self.release_verb("--by", "B", "--as", "authoriser", *reason, expect=2).stderr)
        self.release_verb("--by", "Ada Neri", *reason, expect=0)
        self.assertEqual(self.entries(), [], "approved is not issued")
        for same in ("Ada Neri", "ada  neri "):
            self.assertIn("another person", self.release_verb("--by", same, "--as", "authoriser", expect=2).stderr)
        self.night("--force")  # the same draft: the author need not be asked again
        self.release_verb("--by", "Bruno Verdi", "--as", "authoriser", expect=0)
        self.assertEqual(self.states(), {number(1): "issued"})
        self.assertIn(b"by Bruno Verdi author Ada Neri", self.pdf("c1").read_bytes())
        self.assertEqual([what for what, _, _ in self.journal()], ["made", "approved", "drawn", "issued"])
        # Other readings are another draft, which the author has not seen.
        self.change("c1", "later")
        self.night()
        self.release_verb("--by", "Ada Neri", *reason, expect=0)
        self.change("c1", "later still")
        self.night()
        self.release_verb("--by", "Bruno Verdi", "--as", "authoriser", *reason, expect=2)

    def test_only_the_draft_itself_is_released(self):
        self.by_hand()
        self.signed_campaign("c1")
        self.assertIn("nonio run", self.release_verb("--by", "B", expect=2).stderr)
        self.night()
        (self.site / "c1" / "x.csv").write_text(readings("other"))
        done = self.release_verb("--by", "B", expect=1)
        self.assertIn("x.csv", done.stderr)
        self.assertEqual(self.entries(), [])
        self.assertTrue(self.draft().exists(), "a release that fails leaves the draft")
        (self.site / "c1" / "x.csv").write_text(readings("c1"))
        draft = self.draft().read_bytes()
        self.draft().write_bytes(draft + b"x")
        self.assertIn("is not what the night left", self.release_verb("--by", "B", expect=2).stderr)
        self.draft().write_bytes(draft)
        moved = self.root / "moved"
        self.out.rename(moved)
        self.assertIn("--out", self.release_verb("--by", "B", expect=2).stderr)
        key = self.key.p12.read_bytes()
        self.key.p12.write_bytes(b"")
        self.release_verb("--by", "B", "--out", moved, expect=2)
        self.key.p12.write_bytes(key)
        self.release_verb("--by", "B", "--out", moved, expect=0)
        self.assert_holds(self.pdf("c1", out=moved))
        # Another output folder had the draft too; its next night gives what was issued.
        self.night()
        self.assertEqual(self.pdf("c1").read_bytes(), self.pdf("c1", out=moved).read_bytes())

    def test_an_automatic_release_needs_rules(self):
        self.release = 'release = "automatic"\n'
        self.site_with()
        self.signed_campaign("c1")
        self.assertIn("may_stand", self.night(expect=2).stderr)
        self.release = AUTOMATIC
        self.site_with()
        self.out_of_tolerance()
        self.night()
        self.assertTrue(self.draft().exists(), "a finding that no rule lets stand")
        self.assertEqual(self.entries(), [])
        self.release = AUTOMATIC.replace("[{", '[{ finding = "tolerance.*", reason = "the result itself" }, {')
        self.site_with()
        self.night()
        self.assertEqual(self.states(), {number(1): "issued"})
        issued, = [says for what, _, says in self.journal() if what == "issued"]
        self.assertEqual(issued["released"]["rules"],
                         {"X: " + KNOWN: "it is what was ordered", "X: tolerance.X.E.iso230-2": "the result itself"})
        self.assertNotIn(b"the result itself", self.pdf("c1").read_bytes(), "what the laboratory thinks is not the customer's")

    def test_an_amendment_says_why(self):
        self.signed_campaign("c1")
        self.night()
        self.change("c1", "other", why="")
        self.amend("c1", "")
        self.night()
        missing = self.finding("c1", "certificate.incomplete")["evidence"]["missing"]
        self.assertIn(f"certificate.amendment (why {number(1)} is replaced", missing)
        self.assertEqual(self.states(), {number(1): "issued"})
        self.amend("c1", "the file was that of another machine")
        self.night()
        self.assertEqual(self.states(), {number(1): "amended", number(2): "issued"})
        # The reason of an earlier amendment is none for the next.
        (self.site / "c1" / "x.csv").write_text(readings("third"))
        self.night()
        self.assertIn("was there for " + number(2), self.finding("c1", "certificate.incomplete")["evidence"]["missing"])
        # Values of keys, before and after; what is only a comment is no change.
        manifest = self.site / "c1" / "campaign.toml"
        manifest.write_text("# looked at\n" + manifest.read_text().replace('serial = "17"', 'serial = "18"'))
        (self.site / "c1" / "x.csv").write_text(readings("other"))
        self.amend("c1", "another serial number")
        self.night()
        self.assertEqual(self.results("c1")["certificate"]["changes"],
                         [{"file": "campaign.toml", "places": [{"key": "machine.serial", "before": "17", "after": "18"}]}])

    def test_readings_that_another_campaign_has_too_can_be_amended(self):
        self.by_hand()
        for name in ("c1", "c2"):
            self.signed_campaign(name)
            (self.site / name / "x.csv").write_text(readings("both"))

        def release():
            draft, = json.loads(run(NONIO, "release", self.site / "c1", "--list", "--json").stdout)["drafts"]
            findings = sorted({f["id"] for f in draft["findings"] if f["severity"] == "attention"})
            self.assertTrue(any(f.startswith("plausibility.") for f in findings), findings)
            return run(NONIO, "release", self.site / "c1", "--by", "Bruno Verdi", *(f"--reason={f}=the same test" for f in findings),
                       check=False, env=self.environment)
        self.night()
        self.assertEqual(release().returncode, 0)
        manifest = self.site / "c1" / "campaign.toml"
        manifest.write_text(manifest.read_text().replace('serial = "17"', 'serial = "18"'))
        self.amend("c1", "another serial number")
        self.night()
        self.assertTrue(self.draft("c1").exists(), (self.out / "summary.txt").read_text())
        self.assertEqual(release().returncode, 0)
        self.assertEqual(self.states(), {number(1): "amended", number(2): "issued"})
        self.assertEqual([c["file"] for c in self.results("c1")["certificate"]["changes"]], ["campaign.toml"])

    def test_the_reason_of_a_withdrawal_is_carried_over(self):
        self.signed_campaign("c1")
        self.night()
        self.certificates("--withdraw", number(1), "--why", "wrong stamp", "--by", "Ada Neri")
        self.night()
        certificate = self.results("c1")["certificate"]
        self.assertEqual((certificate["number"], certificate["why"], certificate["changes"]), (number(2), "wrong stamp", []))
        self.assertIn(b"why wrong stamp", self.pdf("c1").read_bytes())
        said, = (says for _, _, says in self.journal() if says.get("by") == "Ada Neri")
        self.assertEqual(said["reason"], "wrong stamp")
        self.assertIn("@", said["account"])

    def test_an_amendment_of_readings_that_another_campaign_has_too(self):
        self.by_hand()
        reasons = ("--reason", KNOWN + "=it is what was ordered", "--reason", "plausibility.file-of-another-campaign=one test, two papers")
        for name in ("c1", "c2"):
            self.signed_campaign(name)
            (self.site / name / "x.csv").write_text(readings("one"))
        self.night()
        for name in ("c1", "c2"):
            self.release_verb("--by", "Ada Neri", campaign=name, known=reasons, expect=0)
        self.assertEqual(self.states(), {number(1): "issued", number(2): "issued"})
        manifest = self.site / "c2" / "campaign.toml"
        manifest.write_text(manifest.read_text().replace('serial = "17"', 'serial = "18"'))
        self.amend("c2", "another serial number")
        self.night()
        self.assertEqual(self.ids("failed"), [])
        self.release_verb("--by", "Ada Neri", campaign="c2", known=reasons, expect=0)
        self.assertEqual(self.states(), {number(1): "issued", number(2): "amended", number(3): "issued"})
        self.assertEqual(self.results("c2")["certificate"]["changes"],
                         [{"file": "campaign.toml", "places": [{"key": "machine.serial", "before": "17", "after": "18"}]}])
        self.assert_holds(self.pdf("c1"), self.pdf("c2"))

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

    # What the register says.

    def register_says(self, file, site=None):
        done = run(NONIO, "verify", "--json", "--site", site or self.site, file, check=False, env=self.environment)
        check = [c for c in json.loads(done.stdout)["checks"] if c["id"] == "register.state"]
        return done.returncode, check[0]["state"], check[0]["says"]

    def test_verify_asks_the_register(self):
        self.signed_campaign("c1")
        self.night()
        kept = {}
        for n, name in ((1, "numbered.pdf"), (1, "dcc.xml")):
            kept[name] = self.root / name
            shutil.copy(self.out / "c1" / name, kept[name])
            self.assertEqual(self.register_says(kept[name])[:2], (0, "holds"))
        self.assertEqual(self.verify(kept["numbered.pdf"], site=False,
                                     args=["--trust", self.key.ca, "--signer", SIGNER])[0].returncode, 0)
        self.change("c1", "other")
        self.night()
        for file in kept.values():
            code, state, says = self.register_says(file)
            self.assertEqual((code, state), (1, "fails"), says)
            self.assertIn("replaced by " + number(2), says)
        self.certificates("--withdraw", number(2), "--why", "wrong stamp")
        code, state, says = self.register_says(self.pdf("c1"))
        self.assertEqual((code, state), (1, "fails"))
        self.assertIn("withdrawn: wrong stamp", says)
        (self.site / "certificates.sqlite").rename(self.root / "away")
        code, state, says = self.register_says(self.pdf("c1"))
        self.assertEqual((code, state), (1, "not checked"))

    def test_a_copied_site_is_found(self):
        self.signed_campaign("c1")
        self.signed_campaign("c2")
        self.night("--jobs", "1")
        copy, out = self.root / "copy", self.root / "out of copy"
        shutil.copytree(self.site, copy)
        self.change("c1", "here")
        self.night()
        original = self.site
        self.site = copy
        self.change("c1", "there")
        self.night(out=out)
        self.site = original
        here, there = self.pdf("c1"), self.pdf("c1", out=out)
        self.assertEqual(self.printed("c1", "number"), number(3))
        self.assertIn(f"number {number(3)} of".encode(), there.read_bytes())
        self.assertEqual(self.register_says(here)[0], 0)
        self.assertEqual(self.register_says(there, site=copy)[0], 0)
        for file, site in ((here, copy), (there, self.site)):
            code, state, says = self.register_says(file, site=site)
            self.assertEqual((code, state), (1, "fails"))
            self.assertIn("another certificate as " + number(3), says)
        # A number that only the copy has issued; and a register that was made anew.
        self.site = copy
        self.change("c2", "there too")
        self.night(out=out)
        self.site = original
        self.assertIn("never issued " + number(4), self.register_says(self.pdf("c2", out=out))[2])
        (self.site / "certificates.sqlite").unlink()
        self.night(out=self.root / "fresh")
        self.assertIn("was issued by the register", self.register_says(here)[2])

    def test_only_what_needs_a_number_waits_for_a_locked_register(self):
        self.site_with(extra="[certificate]\nregister_seconds = 2\n")
        self.signed_campaign("issued")
        self.night()
        self.signed_campaign("needs")
        self.campaign("plain", run='[run]\noutputs = ["json"]\n')
        before = self.issued_files()
        lock = sqlite3.connect(self.site / "certificates.sqlite", isolation_level=None)
        lock.execute("BEGIN EXCLUSIVE")
        self.night(expect=1)
        self.assertEqual(self.ids("failed"), ["needs"])
        self.assertIn("locked", self.summary()["failed"][0]["reason"])
        self.assertNotEqual(self.results("plain")["status"], "failed")
        self.assertEqual({k: v for k, v in self.issued_files().items() if k.startswith("issued/")},
                         {k: v for k, v in before.items() if k.startswith("issued/")})
        lock.execute("ROLLBACK")
        self.night()
        self.assertEqual(self.ids("done"), ["needs"])
        self.assertEqual(self.states(), {number(1): "issued", number(2): "issued"})
        # A lock that ends meanwhile costs nothing but time.
        self.site_with(extra="[certificate]\nregister_seconds = 60\n")
        self.signed_campaign("later")
        lock.execute("BEGIN EXCLUSIVE")
        process = subprocess.Popen(self.command(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=self.environment)
        time.sleep(8)
        self.assertIsNone(process.poll(), "it waits")
        lock.execute("ROLLBACK")
        _, said = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(self.states()[number(3)], "issued")
        self.assertEqual([i["number"] for i in self.summary()["issued"]], [number(3)])
        lock.close()

    def test_what_was_changed_in_the_register_is_not_given_out(self):
        self.signed_campaign("c1")
        self.night()
        self.change_register("UPDATE files SET bytes = bytes || 'x' WHERE name = 'numbered.pdf'")
        done = self.certificates("--out", self.root / "all", check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("is not what was issued", done.stderr)
        self.assertFalse((self.root / "all").exists())
        shutil.rmtree(self.out)
        self.assertIn("is not what was issued", self.night(expect=1).stderr)
        self.assertFalse(self.pdf("c1").exists())

    def audit(self):
        done = self.certificates("--audit", "--json", check=False)
        answer = json.loads(done.stdout)
        self.assertEqual(done.returncode == 0, answer["sound"])
        return answer

    def rechained(self):
        """What somebody can do who knows how the chain is made."""
        import hashlib
        with sqlite3.connect(self.site / "certificates.sqlite") as register:
            before = ""
            for new, (old, *row) in enumerate(register.execute(
                    "SELECT place, at, what, number, says FROM journal ORDER BY place").fetchall(), 1):
                digest = hashlib.sha256("".join(f"{part}\n" for part in (before, new, *row)).encode()).hexdigest()
                register.execute("UPDATE journal SET place = ?, sha256 = ? WHERE place = ?", (new, digest, old))
                before = digest
        register.close()

    def test_the_audit_finds_what_was_taken_out_or_changed(self):
        for name in ("c1", "c2", "c3"):
            self.signed_campaign(name)
        self.night("--jobs", "1")
        self.certificates("--withdraw", number(2), "--why", "wrong stamp")
        self.night()
        sound = self.audit()
        self.assertEqual((sound["wrong"], sound["certificates"]), ([], 4))
        register = self.site / "certificates.sqlite"
        kept = register.read_bytes()
        take_out = [f"DELETE FROM files WHERE certificate = (SELECT id FROM certificates WHERE number = '{number(3)}')",
                    f"DELETE FROM inputs WHERE certificate = (SELECT id FROM certificates WHERE number = '{number(3)}')",
                    f"DELETE FROM certificates WHERE number = '{number(3)}'"]
        forget = f"DELETE FROM journal WHERE number = '{number(3)}'"
        cases = {"row": take_out,
                 "row and journal": [*take_out, forget],
                 "entry": ["DELETE FROM journal WHERE place = 3"],
                 "first entry": ["DELETE FROM journal WHERE place = 1"],
                 "word": ["UPDATE journal SET says = replace(says, 'wrong stamp', 'no reason')"],
                 "reason": [f"UPDATE certificates SET reason = 'none' WHERE number = '{number(2)}'"],
                 "state": [f"UPDATE certificates SET state = 'issued', reason = '' WHERE number = '{number(2)}'"],
                 "file": ["UPDATE files SET bytes = bytes || 'x' WHERE rowid = 1"],
                 "results": ["UPDATE certificates SET results = results || ' ' WHERE issued = 1"],
                 "date": ["UPDATE certificates SET date = '2020-01-01' WHERE issued = 1"],
                 "identity": ["UPDATE site SET id = '00000000-0000-4000-8000-000000000000'"]}
        for name, statements in cases.items():
            self.change_register(*statements)
            self.assertTrue(self.audit()["wrong"], name)
            register.write_bytes(kept)
        # With the chain written anew the certificates behind it tell: they carry its digest, signed.
        self.change_register(*take_out, forget)
        self.rechained()
        self.assertIn("another journal", " ".join(self.audit()["wrong"]))
        register.write_bytes(kept)
        self.rechained()
        self.assertEqual(self.audit(), sound)

    def test_a_register_of_the_version_before_is_carried_over(self):
        self.signed_campaign("c1")
        self.night()
        self.certificates("--withdraw", number(1), "--why", "wrong stamp")
        self.night()
        before = self.issued_files()
        self.change_register("DROP TABLE journal", "DROP TABLE site", "DROP TABLE drafts", "PRAGMA user_version = 1")
        self.assertEqual(self.register_says(self.pdf("c1"))[1], "holds")
        self.night("--force")
        self.assertEqual(self.issued_files(), before)
        self.assertEqual(self.states(), {number(1): "withdrawn", number(2): "issued"})
        self.signed_campaign("c2")
        self.night()
        self.assertEqual(self.states()[number(3)], "issued")

    def test_a_clock_that_was_set_back_draws_no_number(self):
        self.signed_campaign("c1")
        self.night()
        self.change_register("UPDATE certificates SET date = '2999-01-01'")
        self.signed_campaign("c2")
        self.night(expect=1)
        self.assertIn("the clock was set back", self.summary()["failed"][0]["reason"])

    def test_kill_9_at_random_moments(self):
        print(f"seed {SEED}, {KILLS} kills", flush=True)
        rng = random.Random(SEED)
        names = [f"c{i}" for i in range(12)]
        # Of so many readings drawn at random some look misread, some adrift: no reason here for a draft.
        kinds = ("reversal.*", "reading.*", "drift.*", "scatter.*", "plan.*", "repeatability.*")
        self.release = 'release = "automatic"\nmay_stand = [%s]\n' % ", ".join(
            f'{{ finding = "{kind}", reason = "readings are drawn at random" }}' for kind in kinds)
        self.site_with()
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
        if fresh:  # in force or, after a kill, replaced in the register already
            self.assert_holds(*fresh, site=False, args=["--trust", self.key.ca, "--signer", SIGNER])
        self.held = now


if __name__ == "__main__":
    unittest.main(verbosity=2)
