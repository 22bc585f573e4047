# SPDX-License-Identifier: Apache-2.0
"""A run makes drafts, a person approves them: who, why, and the text of an amendment."""
import json
import os
import sqlite3
import subprocess
import unittest

from numbered import AUTOMATIC, KNOWN, NumberedTest, number
from nightly import readings
from signing import NONIO, run


OTHER = "nobody"  # an account that every system has


class Releases(NumberedTest):
    def by_hand(self, extra="", more=""):
        self.release = more
        self.site_with(extra=extra)

    def release_verb(self, *args, expect=None, campaign="c1", known=("--reason", KNOWN + "=it is what was ordered"), user=None):
        if user:  # another account, to which site, output and key belong now
            subprocess.run(["chown", "-R", user, self.root], check=True)
        done = run(NONIO, "certificate", "approve", self.site / campaign, *args, *known, check=False, env=self.environment, user=user)
        if user:
            subprocess.run(["chown", "-R", str(os.getuid()), self.root], check=True)
        if expect is not None:
            self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done

    def draft(self, campaign="c1", out=None):
        return (out or self.out) / campaign / "numbered-draft.pdf"

    def out_of_tolerance(self, campaign="c1"):
        manifest = self.site / campaign / "campaign.toml"
        manifest.write_text(manifest.read_text().replace('kind = "linear"\n', 'kind = "linear"\ntolerance_um = { E = 0.2 }\n', 1))

    def journal(self):
        with sqlite3.connect(self.site / "certificates.sqlite") as register:
            entries = register.execute("SELECT what, number, says FROM journal ORDER BY place").fetchall()
        register.close()
        return [(what, n, json.loads(says)) for what, n, says in entries]

    def test_of_persons_at_once_one_approves_and_the_others_learn_who(self):
        self.by_hand()
        self.signed_campaign("c1")
        self.night()
        people = ["A. Bianchi", "Bruno Verdi", "Ada Neri", "B"]
        racing = [subprocess.Popen([NONIO, "certificate", "approve", self.site / "c1", "--by", p, "--reason", f"{KNOWN}=reason of {p}"], env=self.environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for p in people]
        ended = {p: (*r.communicate(timeout=300), r.returncode) for p, r in zip(people, racing)}
        first = [p for p, (_, _, status) in ended.items() if status == 0]
        self.assertEqual(len(first), 1, ended)
        self.assertEqual([e["released_by"] for e in self.entries()], first)
        for person, (said, why, status) in ended.items():
            if person != first[0]:
                self.assertIn(status, (1, 2))
                self.assertNotIn("issued for", said)
                self.assertIn(f"approved by {first[0]} at ", why)

    def test_names_are_what_they_look_like(self):
        self.by_hand(more="two_persons = true\n")
        self.signed_campaign("c1")
        self.night()
        for name in ("Ada\u202e", "A\u200bda", "Ad\u0430", "\uff21da", "Ada\u00a0Neri", "e\u0301va", "\u0410da", ""):
            self.release_verb("--by", name, expect=2)
        for name in ("Ren\u00e9e O'Hara-M\u00fcller", "\u0410\u0434\u0430 Neri", "\u5c71\u7530 \u592a\u90ce"):
            self.release_verb("--by", name, expect=0)
        self.release_verb("--by", "Ada Neri", expect=0)
        for name in ("Ada Neri", "ada neri.", "AdaNeri"):
            self.assertEqual(self.release_verb("--by", name, "--as", "authoriser").returncode, 2)

    def test_a_run_makes_a_draft_and_a_person_approves_it(self):
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
        self.assertIn("1 draft waits for approval (nonio certificate approve): c1", (self.out / "summary.txt").read_text())
        for folder in (self.site, self.site / "c1"):
            listed = json.loads(run(NONIO, "certificate", "approve", folder, "--list", "--json").stdout)["drafts"]
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
        manifest = self.site / "c1/campaign.toml"
        manifest.write_text(manifest.read_text().replace('id = "X"', 'id = "X=0"', 1))
        self.out_of_tolerance()
        self.night()
        done = self.release_verb("--by", "B", expect=1, known=())
        self.assertIn("X=0: " + KNOWN + " requires a reason", done.stderr)
        done = self.release_verb("--by", "B", expect=1)
        self.assertIn("X=0: tolerance.X.E.iso230-2 requires a reason", done.stderr)
        self.assertNotIn("X=0: " + KNOWN + " requires a reason", done.stderr)
        self.assertEqual(self.entries(), [])
        for wrong in (["--reason", "nonsense=x"], ["--reason", "x"], ["--reason", "tolerance.X.E.iso230-2= "]):
            self.release_verb("--by", "B", *wrong, expect=2)
        self.release_verb(expect=2)
        for nobody in (" ", "-", "\u2014", "?"):
            self.release_verb("--by", nobody, expect=2)
        self.release_verb("--by", "B", "--reason", "tolerance.X.E.iso230-2=-", expect=2)
        self.assertEqual(self.entries(), [])
        self.release_verb("--by", "B", "--reason", f"X=0: {KNOWN}=it is what was ordered",
                          "--reason", "X=0: tolerance.X.E.iso230-2=as found, the customer knows", known=(), expect=0)
        issued, = [says for what, _, says in self.journal() if what == "issued"]
        self.assertEqual(issued["released"]["released"]["reasons"],
                         {"X=0: " + KNOWN: "it is what was ordered", "X=0: tolerance.X.E.iso230-2": "as found, the customer knows"})
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
        self.assertIn("under this account", self.release_verb("--by", "Bruno Verdi", "--as", "authoriser", expect=2).stderr)
        self.assertEqual(self.entries(), [], "two names typed by one account are one person")
        if os.getuid() != 0:
            self.skipTest("only root can take another account")
        self.release_verb("--by", "Bruno Verdi", "--as", "authoriser", expect=0, user=OTHER)
        self.assertEqual(self.states(), {number(1): "issued"})
        self.assertIn(b"by Bruno Verdi author Ada Neri", self.pdf("c1").read_bytes())
        self.assertEqual([what for what, _, _ in self.journal()], ["made", "approved", "drawn", "issued"])
        # Other readings are another draft, which the author has not seen.
        self.change("c1", "later")
        self.night()
        self.release_verb("--by", "Ada Neri", *reason, expect=0)
        self.change("c1", "later still")
        self.night()
        self.release_verb("--by", "Bruno Verdi", "--as", "authoriser", *reason, expect=2, user=OTHER)

    def test_only_a_person_whom_the_laboratory_names_releases(self):
        self.by_hand()
        self.signed_campaign("c1")
        self.night()
        for stranger in ("Topolino", "Bruno Verdi 2", "A. Bianchi; Bruno Verdi"):
            done = self.release_verb("--by", stranger, expect=2)
            self.assertIn("is not an authoriser of this laboratory", done.stderr)
        self.assertEqual(self.entries(), [])
        self.release_verb("--by", "bruno  verdi", expect=0)
        self.assertEqual(self.states(), {number(1): "issued"})

    def test_an_expired_calibration_wants_a_reason(self):
        self.by_hand()
        for line, finding in (("calibrated = 2019-01-12", "traceability.calibrated-long-ago"),
                              ("calibrated = 2025-01-12\nvalid_until = 2025-06-01", "traceability.calibration-expired")):
            name = finding.split(".")[1]
            self.signed_campaign(name)
            manifest = self.site / name / "campaign.toml"
            manifest.write_text(manifest.read_text() + f'[instrument]\nserial = "L-1"\n{line}\n')
            (self.site / name / "x.csv").write_text(readings(name))
            self.night()
            results = json.loads((self.out / name / "results.json").read_text())
            self.assertEqual(results["status"], "attention")
            self.assertIn(finding, [f["id"] for a in results["analyses"] for f in a["findings"]])
            shown = run(NONIO, "show", self.out / name, "--quiet", check=False, env=self.environment)
            self.assertRegex(shown.stdout, "Calibration expired|calibrated long ago")
            self.assertIn(finding, self.release_verb("--by", "Bruno Verdi", campaign=name, expect=1).stderr)
            self.release_verb("--by", "Bruno Verdi", "--reason", finding + "=compared with a second laser", campaign=name, expect=0)

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
        site = (self.site / "site.toml").read_text()
        self.assertIn("[laboratory]\n", site)
        (self.site / "site.toml").write_text(site.replace("[laboratory]\n", '[laboratory]\naccreditation = "LAT 999"\n'))
        self.assertIn("[laboratory]", self.release_verb("--by", "B", expect=1).stderr)  # this page was not read
        self.assertEqual(self.entries(), [])
        (self.site / "site.toml").write_text(site)
        draft = self.draft().read_bytes()
        self.draft().write_bytes(draft + b"x")
        self.assertIn("has changed since the last run", self.release_verb("--by", "B", expect=2).stderr)
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
        # Another output folder had the draft too; its next run stores the issued certificate.
        self.night()
        self.assertEqual(self.pdf("c1").read_bytes(), self.pdf("c1", out=moved).read_bytes())

    def test_a_draft_in_a_hashed_folder_is_approved(self):
        self.by_hand(extra='[results]\nfolders = "hashed"\n')
        self.signed_campaign("c1")
        self.night()
        listed, = json.loads(run(NONIO, "certificate", "approve", self.site, "--list", "--json").stdout)["drafts"]
        self.assertNotEqual(listed["file"], str(self.draft()))
        self.assertNotIn("stale", listed)
        self.release_verb("--by", "Bruno Verdi", expect=0)
        issued, = self.out.glob("??/c1/numbered.pdf")
        self.assert_holds(issued)

    def test_an_automatic_release_needs_rules(self):
        self.release = 'release = "automatic"\n'
        self.site_with()
        self.signed_campaign("c1")
        self.assertIn("accept", self.night(expect=2).stderr)
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
            draft, = json.loads(run(NONIO, "certificate", "approve", self.site / "c1", "--list", "--json").stdout)["drafts"]
            findings = sorted({f["id"] for f in draft["findings"] if f["severity"] == "attention"})
            self.assertTrue(any(f.startswith("plausibility.") for f in findings), findings)
            return run(NONIO, "certificate", "approve", self.site / "c1", "--by", "Bruno Verdi", *(f"--reason={f}=the same test" for f in findings),
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


if __name__ == "__main__":
    unittest.main(verbosity=2)
