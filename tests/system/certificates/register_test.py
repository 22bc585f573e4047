# SPDX-License-Identifier: Apache-2.0
"""The register of numbers: what it says, what was changed in it, locks, kills."""
import json
import os
import random
import shutil
import sqlite3
import subprocess
import time
import unittest

from numbered import NumberedTest, number
from signing import NONIO, SIGNER, run

KILLS = int(os.environ.get("NONIO_KILLS", "50"))
SEED = int(os.environ.get("NONIO_SEED", str(random.randrange(10**6))))


class Register(NumberedTest):
    def change_register(self, *statements):
        with sqlite3.connect(self.site / "certificates.sqlite") as register:
            for sql in statements:
                register.execute(*([sql] if isinstance(sql, str) else sql))
        register.close()

    def register_says(self, file, site=None):
        done = run(NONIO, "certificate", "verify", "--json", "--site", site or self.site, file, check=False, env=self.environment)
        check = [c for c in json.loads(done.stdout)["checks"] if c["id"] == "register.state"]
        return done.returncode, check[0]["state"], check[0]["says"]

    def test_verify_asks_the_register(self):
        self.signed_campaign("c1")
        self.night()
        kept = {}
        for n, name in ((1, "numbered.pdf"), (1, "dcc.xml")):
            kept[name] = self.root / name
            shutil.copy(self.out / "c1" / name, kept[name])
            self.assertEqual(self.register_says(kept[name])[:2], (3, "holds"))
        self.assertEqual(self.verify(kept["numbered.pdf"], site=False,
                                     args=["--trust", self.key.ca, "--signer", SIGNER])[0].returncode, 3)
        self.change("c1", "other")
        self.night()
        for file in kept.values():
            code, state, says = self.register_says(file)
            self.assertEqual((code, state), (5, "fails"), says)
            self.assertIn("replaced by " + number(2), says)
        self.certificates("--withdraw", number(2), "--why", "wrong stamp")
        code, state, says = self.register_says(self.pdf("c1"))
        self.assertEqual((code, state), (5, "fails"))
        self.assertIn("withdrawn: wrong stamp", says)
        (self.site / "certificates.sqlite").rename(self.root / "away")
        done, answers = self.verify(self.pdf("c1"))
        self.assertEqual((done.returncode, answers), (2, []))
        self.assertIn("restore it from the backup", done.stderr)
        (self.site / "certificates.sqlite.identity").unlink()
        code, state, says = self.register_says(self.pdf("c1"))
        self.assertEqual((code, state), (5, "not checked"))

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
        self.assertEqual(self.register_says(here)[0], 3)
        self.assertEqual(self.register_says(there, site=copy)[0], 3)
        for file, site in ((here, copy), (there, self.site)):
            code, state, says = self.register_says(file, site=site)
            self.assertEqual((code, state), (5, "fails"))
            self.assertIn("another certificate as " + number(3), says)
        # A number that only the copy has issued; and a register that was made anew.
        self.site = copy
        self.change("c2", "there too")
        self.night(out=out)
        self.site = original
        self.assertIn("never issued " + number(4), self.register_says(self.pdf("c2", out=out))[2])
        (self.site / "certificates.sqlite").unlink()
        (self.site / "certificates.sqlite.identity").unlink()
        self.night(out=self.root / "fresh")
        self.assertIn("was issued by the register", self.register_says(here)[2])

    def test_an_older_state_draws_no_number(self):
        """Register and output folder from one backup: the site has seen more."""
        self.signed_campaign("c1")
        self.night()
        register = self.site / "certificates.sqlite"
        shutil.copy(register, self.root / "backup")
        shutil.copytree(self.out, self.root / "out of the backup")
        self.signed_campaign("c2")
        self.night()
        shutil.copy(self.root / "backup", register)
        shutil.rmtree(self.out)
        shutil.copytree(self.root / "out of the backup", self.out)
        self.assertIn("older state", self.night(expect=2).stderr)
        with sqlite3.connect(register) as database:
            self.assertEqual(database.execute("SELECT count(*) FROM certificates").fetchall(), [(1,)])
        database.close()
        done = run(NONIO, "certificate", "audit", self.site, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("older state", done.stdout)

    def test_nothing_is_issued_from_a_journal_that_was_changed(self):
        self.signed_campaign("c1")
        self.night()
        self.change_register("UPDATE journal SET says = replace(says, 'c1', 'c9') WHERE what = 'drawn'")
        self.signed_campaign("c2")
        self.assertIn("is not what was written", self.night(expect=2).stderr)
        self.assertEqual(len(self.entries()), 1)

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
        """A forgery by a person who knows how the chain of digests is made."""
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
        (self.site / "certificates.sqlite.identity").unlink()
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
        self.release = 'release = "automatic"\naccept = [%s]\n' % ", ".join(
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
            errors = self.root / "errors"
            with errors.open("w") as file:
                process = subprocess.Popen(self.command("--jobs", "4"), stdout=subprocess.DEVNULL, stderr=file,
                                           env=self.environment)
            try:
                code = process.wait(rng.uniform(0.0, longest))
                self.assertEqual(code, 0, errors.read_text())
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
