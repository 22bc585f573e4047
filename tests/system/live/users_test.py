# SPDX-License-Identifier: Apache-2.0
"""Users of a site behind a reverse proxy: each role does what it may and nothing else, under its own name; whatever was tried is
in the audit log."""
import email
import email.policy
import json
import shutil
import unittest

from live import LiveTest, Server, nonio
import campaigns_test
from sign_in_test import hashed

HEADER, HOST = "X-Remote-User", "nonio.example.org"
ROLES = ("view", "measure", "approve", "administer")
USERS = "format = 1\n" + "".join(f'[[user]]\naccount = "{role}-1"\nname = "Person {role}"\nrole = "{role}"\n' for role in ROLES)


class Users(LiveTest):
    def setUp(self):
        super().setUp()
        shutil.rmtree(self.site)
        self.site.mkdir()
        (self.site / "site.toml").write_text('[laboratory]\nname = "Sample"\n')
        (self.site / "users.toml").write_text(USERS)
        self.out = self.site.parent / "out"

    def serve(self, *more):
        return Server(self.site, "--out", self.out, "--host", HOST, "--user-header", HEADER, *more)

    def ask(self, server, method, path, account, body=None, headers=None):
        fields = {"Host": HOST, **({HEADER: account} if account is not None else {}), **(headers or {})}
        status, _, answer = server.request(method, path, body, fields)
        return status, answer

    def log(self):
        path = self.site / "audit.jsonl"
        return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []

    def campaign(self):
        form = {"name": "x.csv", "axis": "X", "values": campaigns_test.VALUES}
        return json.dumps(form).encode() + b"\n" + campaigns_test.text_of(campaigns_test.readings()).encode()

    def test_each_role_does_what_it_may(self):
        file = {"Content-Type": "application/octet-stream"}
        event = {"machine": "M 1", "kind": "other", "text": "seen", "by": "Another Person", "date": "2026-01-01"}
        # What a request needs, and its status where it is allowed.
        requests = [("GET", "/api/site/state", None, None, "view", (200,)), ("GET", "/api/campaigns", None, None, "view", (200,)), ("GET", "/api/records", None, None, "view", (200,)),
                    ("POST", "/api/preview", self.campaign(), file, "view", (200,)), ("POST", "/api/campaigns", self.campaign(), file, "measure", (200,)),
                    ("POST", "/api/event", event, None, "measure", (200,)), ("POST", "/api/run", {"campaign": "none"}, None, "measure", (404,)),
                    ("POST", "/api/release", {"campaign": "none", "by": "Person approve"}, None, "approve", (404,)), ("GET", "/api/audit", None, None, "administer", (200,)),
                    ("POST", "/c/none/api/exclude", {}, None, "measure", (404,)), ("POST", "/c/none/api/model", {}, None, "measure", (404,))]
        with self.serve("--edit") as s:
            for role in ROLES:
                for method, path, body, headers, least, allowed in requests:
                    status, answer = self.ask(s, method, path, f"{role}-1", body, headers)
                    may = ROLES.index(role) >= ROLES.index(least)
                    self.assertIn(status, allowed if may else (403,), f"{role} {path}: {answer[:300]!r}")
                    if not may:
                        self.assertEqual("role", json.loads(answer)["id"])
                state = json.loads(self.ask(s, "GET", "/api/site/state", f"{role}-1")[1])
                self.assertEqual((role, f"Person {role}", role != "view", role in ("approve", "administer")), (state["user"]["role"], state["user"]["name"], state["edit"], state["approve"]))
            self.assertEqual(3, len(list(self.site.glob("*/campaign.toml"))))
            text = (self.site / "events.toml").read_text()
            self.assertNotIn("Another Person", text, "entries have the name of the user")
            for role in ROLES[1:]:
                self.assertIn(f"Person {role}", text)
            self.ask(s, "POST", "/api/event", "measure-1", {**event, "campaign": "never-touched"})
            self.assertTrue(all("campaign" not in e and e["machine"] == "M 1" for e in self.log() if e["request"] == "/api/event" and e["state"] != "refused"))
            log = self.log()
            self.assertEqual({"view-1", "measure-1", "approve-1", "administer-1"}, {e["account"] for e in log})
            self.assertEqual(7, sum(e["state"] == "refused" for e in log if e["account"] == "view-1"))
            done = [e for e in log if e["request"] == "/api/campaigns" and e["state"] == "done"]
            self.assertEqual(sorted(p.parent.name for p in self.site.glob("*/campaign.toml")), sorted(e["campaign"] for e in done))
            exported = self.ask(s, "GET", "/api/audit", "administer-1")[1].decode()
            self.assertEqual((self.site / "audit.jsonl").read_text(), exported)

    def test_who_is_no_user_gets_nothing(self):
        with self.serve("--edit") as s:
            for account in (None, "", "stranger", "approve-1 ", "Approve-1", "Person approve"):
                for method, path in (("GET", "/api/site/state"), ("GET", "/api/campaigns"), ("GET", "/api/audit"), ("POST", "/api/run"), ("GET", "/c/x/api/state")):
                    status, answer = self.ask(s, method, path, account, {} if method == "POST" else None)
                    if account == "approve-1 " and status != 403:  # blanks around a value belong to no value (RFC 9110)
                        continue
                    self.assertEqual(403, status, f"{account!r} {path} {answer[:200]!r}")
            answer = s.raw(f"GET /api/site/state HTTP/1.1\r\nHost: {HOST}\r\nX-Nonio-Token: {s.token}\r\n{HEADER}: view-1\r\n{HEADER}: administer-1\r\n\r\n".encode())
            self.assertEqual(403, int(answer.split()[1]), "two accounts are none")
            # The file counts as it is now; a broken one opens nothing.
            (self.site / "users.toml").write_text(USERS.replace('"approve-1"\nname = "Person approve"\nrole = "approve"', '"approve-1"\nname = "Person approve"\nrole = "view"'))
            self.assertEqual(403, self.ask(s, "POST", "/api/release", "approve-1", {"campaign": "none", "by": "x"})[0])
            for wrong in ("", "format = 1\n", "format = 1\n[[user]]\naccount = \"a\"\n", USERS.replace('role = "view"', 'role = "all"'), USERS + USERS[11:], USERS.replace("[[user]]", "[[users]]"), USERS + 'x = 1\n'):
                (self.site / "users.toml").write_text(wrong)
                self.assertEqual(503, self.ask(s, "GET", "/api/site/state", "administer-1")[0], wrong)
            (self.site / "users.toml").write_text(USERS)
            (self.site / "audit.jsonl").unlink(missing_ok=True)
            (self.site / "audit.jsonl").symlink_to("/dev/null")
            status, answer = self.ask(s, "POST", "/api/event", "measure-1", {"machine": "M", "kind": "other", "text": "x", "date": "2026-01-01"})
            self.assertEqual((503, "audit"), (status, json.loads(answer)["id"]), "what cannot be recorded is not done")
            self.assertFalse((self.site / "events.toml").exists())

    def test_a_user_without_a_password_is_not_one_of_two_persons(self):
        with self.serve("--edit") as s:
            made = json.loads(self.ask(s, "POST", "/api/campaigns", "measure-1", self.campaign(), {"Content-Type": "application/octet-stream"})[1])["campaign"]
            approve = lambda: (lambda r: (r[0], json.loads(r[1]).get("id")))(self.ask(s, "POST", "/api/release", "approve-1", {"campaign": made, "by": "x", "confirmed": "Person approve", "as": "authoriser"}))
            self.assertEqual((422, None), approve(), "one person: the name is enough, and there is no draft")
            with (self.site / "site.toml").open("a") as site:
                site.write("[certificate]\ntwo_persons = true\n")
            self.assertEqual((403, "two_persons"), approve())
            (self.site / "users.toml").write_text(USERS.replace('role = "approve"\n', f'role = "approve"\n{hashed("a long password 1").stdout}'))
            self.assertEqual((403, "password"), approve(), "the remedy: with a password it is asked for")

    def test_a_certificate_is_sent_to_an_address_of_the_site(self):
        letter, program = self.site.parent / "letter", self.site.parent / "sendmail"
        program.write_text(f'#!/bin/sh\necho "$@" > {letter}.to\ncat > {letter}\n')
        program.chmod(0o755)
        (self.out / "c1").mkdir(parents=True)
        (self.out / "c1/certificate.pdf").write_bytes(content := bytes(range(256)) * 50)
        (self.out / "secret").write_text("x")
        post = lambda s, role, **more: (lambda r: (r[0], json.loads(r[1])))(self.ask(s, "POST", "/api/mail", f"{role}-1", {"campaign": "c1", "file": "certificate.pdf", "to": "lab@example.org", **more}))
        with self.serve("--edit") as s:
            self.assertIn("[mail]", post(s, "approve")[1]["error"])
            with (self.site / "site.toml").open("a") as site:
                site.write(f'[mail]\nto = ["other@example.org", "lab@example.org"]\nfrom = "nonio@example.org"\nsendmail = "{program}"\n')
            self.assertEqual((403, "role"), (lambda r: (r[0], r[1]["id"]))(post(s, "measure")))
            self.assertEqual(422, post(s, "approve", to="evil@example.org")[0])
            for wrong in ({"file": "../secret"}, {"file": "run.json"}, {"campaign": "../c1"}, {"campaign": "c2"}):
                self.assertEqual((404, "no_result"), (lambda r: (r[0], r[1]["id"]))(post(s, "approve", **wrong)), wrong)
            self.assertFalse(letter.exists())
            self.assertEqual(200, post(s, "approve")[0])
            program.write_text("#!/bin/sh\nexit 1\n")
            self.assertEqual(1, post(s, "approve")[1].get("exit_status", 1))
        self.assertTrue(letter.with_suffix(".to").read_text().endswith(" -- lab@example.org\n"), "to the chosen address only")
        parts = list(email.message_from_bytes(letter.read_bytes(), policy=email.policy.default).iter_attachments())
        self.assertEqual([("c1-certificate.pdf", content)], [(p.get_filename(), p.get_content()) for p in parts])
        log = [(e["account"], e["state"], e.get("to"), e.get("file")) for e in self.log() if e["request"] == "/api/mail" and e["state"] != "begins"]
        self.assertIn(("approve-1", "done", "lab@example.org", "certificate.pdf"), log)
        self.assertEqual(("approve-1", "failed", "lab@example.org", "certificate.pdf"), log[-1])

    def test_the_option_is_for_a_proxy(self):
        self.assertIn("--host", nonio("serve", self.site, "--user-header", HEADER, expect=2).stderr)
        (self.site / "users.toml").unlink()
        self.assertIn("users.toml", nonio("serve", self.site, "--host", HOST, "--user-header", HEADER, expect=2).stderr)


if __name__ == "__main__":
    unittest.main()
