# SPDX-License-Identifier: Apache-2.0
"""Local accounts of a site: passwords, sessions, delays; approvals by persons who give their password again; two persons are two accounts."""
import http.client
import json
import shutil
import subprocess
import time
import tomllib
import unittest

from live import NONIO, ROOT, WAIT, LiveTest, Server, nonio

PASSWORDS = {"view-1": "a long password 1", "bianchi": "pässword of bianchi", "sample": "another long one", "admin": "administers it all"}
PERSONS = {"view-1": ("V. Sample", "view"), "bianchi": ("A. Bianchi", "approve"), "sample": ("B. Sample", "approve"), "admin": ("C. Verdi", "administer")}
HASHES = {}


def hashed(password, expect=0):
    done = subprocess.run([NONIO, "serve", ROOT, "--hash-password"], input=password + "\n", capture_output=True, text=True, timeout=60)
    assert done.returncode == expect, done.stderr
    return done


def line_of(account):
    if account not in HASHES:
        HASHES[account] = hashed(PASSWORDS[account]).stdout
    return HASHES[account]


def users(*accounts):
    return "format = 1\n" + "".join(f'[[user]]\naccount = "{a}"\nname = "{PERSONS[a][0]}"\nrole = "{PERSONS[a][1]}"\n{line_of(a)}' for a in accounts)


class Person:
    """A browser with its cookie."""

    def __init__(self, server, account=None, expect=200):
        self.server, self.cookie = server, None
        if account:
            status, fields, body = self.ask("POST", "/api/sign-in", {"account": account, "password": PASSWORDS[account]}, all_=True)
            assert status == expect, body
            self.line = fields["Set-Cookie"]
            self.cookie = self.line.split(";")[0]

    def ask(self, method, path, body=None, headers=None, all_=False):
        status, fields, data = self.server.request(method, path, body, {**({"Cookie": self.cookie} if self.cookie else {}), **(headers or {})}, token=False)
        answer = json.loads(data) if data[:1] in (b"{", b"[") else data
        return (status, fields, answer) if all_ else (status, answer)


class SignIn(LiveTest):
    def setUp(self):
        super().setUp()
        shutil.rmtree(self.site)
        shutil.copytree(ROOT / "samples/certificates", self.site)
        self.out = self.site.parent / "out"
        self.users("view-1", "bianchi", "sample", "admin")

    def users(self, *accounts):
        (self.site / "users.toml").write_text(users(*accounts))

    def serve(self):
        return Server(self.site, "--out", self.out, "--edit", "--host", "nonio.example.org")

    def log(self):
        return [json.loads(line) for line in (self.site / "audit.jsonl").read_text().splitlines()]

    def test_a_hash_is_a_line_of_the_file(self):
        line = line_of("bianchi")
        value = tomllib.loads(line)["password"]
        self.assertTrue(value.startswith("$argon2id$v=19$m=65536,t=3,p=1$"), value)
        self.assertNotEqual(line, hashed(PASSWORDS["bianchi"]).stdout, "another salt")
        for wrong in ("", "too short", "x" * 201, "a tab\tin the password"):
            self.assertEqual("", hashed(wrong, expect=2).stdout)
        text = users("bianchi")
        for other in (text.replace("$argon2id$v=19", "$argon2i$v=19"), text.replace("m=65536", "m=99999999"), text.replace("t=3", "t=17"), text.replace(value, "secret password"), text.replace("t=3", "t=0"), text.replace(value, value.rsplit("$", 1)[0])):
            (self.site / "users.toml").write_text(other)
            error = nonio("serve", self.site, expect=2).stderr
            self.assertIn("users.toml", error)
            self.assertIn("--hash-password", error)
            self.assertNotIn("secret password", error)
        (self.site / "users.toml").write_text('format = 1\n[[user]]\naccount = "a"\nname = "A"\nrole = "view"\n')
        self.assertIn("--hash-password", nonio("serve", self.site, expect=2).stderr, "no person could sign in")

    def test_only_its_owner_may_write_the_file(self):
        file, other = self.site / "users.toml", self.site.parent / "users.toml"
        for mode in (0o660, 0o646):
            file.chmod(mode)
            self.assertIn(f"{file}: other users can write it; expected chmod 640", nonio("serve", self.site, expect=2).stderr)
        file.chmod(0o640)
        with self.serve() as s:
            person = Person(s, "sample")
            file.chmod(0o664)
            self.assertEqual((503, "users"), (lambda r: (r[0], r[1]["id"]))(person.ask("GET", "/api/site/state")))
            file.chmod(0o640)
            self.assertEqual(200, person.ask("GET", "/api/site/state")[0])
            file.rename(other)
            file.symlink_to(other)
            self.assertEqual(503, person.ask("GET", "/api/site/state")[0])
        self.assertIn(f"{file}: it is a symbolic link", nonio("serve", self.site, expect=2).stderr)
        other.unlink()
        self.assertIn(f"{file}: it is a symbolic link", nonio("serve", self.site, expect=2).stderr, "one that leads nowhere does not open the site")

    def test_without_a_session_there_is_nothing(self):
        with self.serve() as s:
            self.assertNotIn("#", s.line)
            stranger = Person(s)
            for method, path in (("GET", "/api/site/state"), ("GET", "/api/campaigns"), ("GET", "/api/audit"), ("GET", "/api/site/events"), ("GET", "/c/adjusted/api/state"), ("GET", "/site/index.html"),
                                 ("POST", "/api/run"), ("POST", "/api/release"), ("POST", "/api/open"), ("POST", "/api/sign-out")):
                for cookie in (None, "nonio-00000000=" + "0" * 32, "nonio-00000000="):
                    stranger.cookie = cookie
                    self.assertEqual((403, "signed_out"), (lambda r: (r[0], r[1]["id"]))(stranger.ask(method, path, {} if method == "POST" else None)), path)
            self.assertEqual(403, stranger.ask("POST", "/api/sign-in", {"account": "sample", "password": PASSWORDS["sample"]}, {"Origin": "http://evil.example"})[0], "not for another page")
            self.assertEqual(403, stranger.ask("POST", "/api/sign-in", {"account": "sample", "password": PASSWORDS["sample"]}, {"Sec-Fetch-Site": "cross-site"})[0])
            self.assertEqual(415, stranger.ask("POST", "/api/sign-in", "account=sample", {"Content-Type": "application/x-www-form-urlencoded"})[0])
            for body in ({}, [], {"account": "", "password": "x"}, {"account": 1}, {"account": "x" * 500, "password": "x"}):
                self.assertEqual(400, stranger.ask("POST", "/api/sign-in", body)[0], body)
            self.assertEqual(413, stranger.ask("POST", "/api/sign-in", {"account": "sample", "password": "x" * 5000})[0])
            # Who is not signed in is refused before the body has come.
            connection = http.client.HTTPConnection("127.0.0.1", s.port, timeout=WAIT)
            connection.putrequest("POST", "/api/run", skip_host=True)
            for name, value in (("Host", f"127.0.0.1:{s.port}"), ("Content-Type", "application/json"), ("Content-Length", "900000")):
                connection.putheader(name, value)
            connection.endheaders(b"{")
            self.assertEqual(403, connection.getresponse().status)
            connection.close()

    def test_users_that_are_new_since_the_start_are_not_passed_over(self):
        (self.site / "users.toml").unlink()
        with self.serve() as s:
            self.assertEqual(200, s.request("GET", "/api/site/state")[0])
            self.users("sample")
            status, _, body = s.request("GET", "/api/site/state")
            self.assertEqual((503, "users_new"), (status, json.loads(body)["id"]))

    def test_wrong_passwords_of_others_stop_no_approval(self):
        with self.serve() as s:
            signed_in, stranger = Person(s, "sample"), Person(s)
            self.assertEqual(403, stranger.ask("POST", "/api/sign-in", {"account": "sample", "password": "not this one"})[0])
            status, answer = signed_in.ask("POST", "/api/release", {"campaign": "adjusted", "password": PASSWORDS["sample"]})
            self.assertNotEqual(429, status, answer)

    def test_a_refused_request_leaves_little_in_the_log(self):
        with self.serve() as s:
            person = Person(s, "view-1")
            before = len((self.site / "audit.jsonl").read_text())
            self.assertEqual(403, person.ask("POST", "/api/event", {"text": "x" * 100_000})[0])
            self.assertLess(len((self.site / "audit.jsonl").read_text()) - before, 2000)

    def test_a_session(self):
        with self.serve() as s:
            one = Person(s, "sample")
            for part in ("HttpOnly", "SameSite=Strict", "Path=/", "Max-Age=43200"):
                self.assertIn(part, one.line)
            self.assertNotIn("Secure", one.line, "this computer, without TLS")
            state = one.ask("GET", "/api/site/state")[1]
            self.assertEqual(("sample", "B. Sample", "approve", "password", True), tuple(state["user"][k] for k in ("account", "name", "role", "confirms", "signs_out")))
            self.assertEqual(403, one.ask("GET", "/api/audit")[0])
            self.assertEqual(403, one.ask("GET", "/api/site/state", headers={"Origin": "http://evil.example"})[0])
            _, fields, _ = Person(s).ask("POST", "/api/sign-in", {"account": "admin", "password": PASSWORDS["admin"]}, {"Host": "nonio.example.org"}, all_=True)
            self.assertTrue(fields["Set-Cookie"].endswith("; Secure"), "by the proxy's name")
            # The same cookie twice is none.
            self.assertEqual(403, one.ask("GET", "/api/site/state", headers={"Cookie": f"{one.cookie}; {one.cookie}"})[0])
            self.assertEqual(200, one.ask("GET", "/api/site/state", headers={"Cookie": f"a=b; {one.cookie}; c=d"})[0])
            other = Person(s, "sample")
            status, fields, _ = one.ask("POST", "/api/sign-out", {}, all_=True)
            self.assertEqual((200, True), (status, "Max-Age=0" in fields["Set-Cookie"]))
            self.assertEqual(403, one.ask("GET", "/api/site/state")[0])
            self.assertEqual([("sample", "B. Sample", "done")], [(e["account"], e["name"], e["state"]) for e in self.log() if e["request"] == "/api/sign-out"])
            self.assertEqual(200, other.ask("GET", "/api/site/state")[0], "of another browser")
            # Another password ends it, and so does the end of the user.
            (self.site / "users.toml").write_text(users("bianchi", "sample").replace(line_of("sample"), hashed(PASSWORDS["sample"]).stdout))
            self.assertEqual(403, other.ask("GET", "/api/site/state")[0])
            third = Person(s, "bianchi")
            self.users("sample")
            self.assertEqual(403, third.ask("GET", "/api/site/state")[0])
            self.users("bianchi", "sample")
            self.assertEqual(403, third.ask("GET", "/api/site/state")[0], "it does not come back")
            kept = Person(s, "sample")
        with self.serve() as s:
            kept.server = s
            self.assertEqual(403, kept.ask("GET", "/api/site/state")[0], "of an earlier start")

    def test_wrong_passwords_are_delayed(self):
        with self.serve() as s:
            stranger = Person(s)
            right = {"account": "sample", "password": PASSWORDS["sample"]}
            for account in ("sample", "stranger"):
                for _ in range(5):  # the first delay is 1 s: a loaded machine may need longer between two requests
                    status, answer = stranger.ask("POST", "/api/sign-in", {"account": account, "password": "not this one"})
                    self.assertIn((status, answer["id"]), ((403, "password"), (429, "wait")), "whether there is such a user is not shown")
                    status, answer = stranger.ask("POST", "/api/sign-in", {**right, "account": account})
                    if status == 429:
                        break
                self.assertEqual((429, "wait"), (status, answer["id"]), "not even the right one is checked now")
            deadline = time.monotonic() + WAIT
            while (answer := stranger.ask("POST", "/api/sign-in", right))[0] == 429 and time.monotonic() < deadline:
                time.sleep(0.2)
            self.assertEqual(200, answer[0], answer)
            self.assertEqual({("sample", "refused"), ("stranger", "refused"), ("sample", "done")}, {(e["account"], e["state"]) for e in self.log()})
            self.assertNotIn(PASSWORDS["sample"], (self.site / "audit.jsonl").read_text())

    def test_a_removed_user_hears_nothing_more(self):
        with self.serve() as s:
            person = Person(s, "view-1")
            connection = http.client.HTTPConnection("127.0.0.1", s.port, timeout=WAIT)
            connection.request("GET", "/api/site/events?since=0", headers={"Cookie": person.cookie})
            stream = connection.getresponse()
            self.assertEqual(200, stream.status)
            self.users("sample")
            while stream.readline():
                pass  # until its end; the time limit of the connection fails the test
            connection.close()

    def test_the_second_save_of_two_people_is_refused(self):
        manifest = self.site / "adjusted/campaign.toml"
        save = lambda person, sha: person.ask("POST", "/c/adjusted/api/save", {"why": "seen"}, {"If-Match": f'"{sha}"'})
        with self.serve() as s:
            people = Person(s, "bianchi"), Person(s, "sample")
            state = lambda person: person.ask("GET", "/c/adjusted/api/state")[1]
            deadline = time.monotonic() + WAIT
            while any(state(p).get("bench") != "open" for p in people) and time.monotonic() < deadline:
                time.sleep(0.05)
            read = [state(p)["campaign"]["manifest_sha256"] for p in people]
            before = state(people[0])["model"]
            self.assertEqual(200, people[0].ask("POST", "/c/adjusted/api/model", {"add": "scale:X"})[0])
            self.assertEqual(200, save(people[0], read[0])[0])
            kept = manifest.read_bytes()
            self.assertEqual(200, people[1].ask("POST", "/c/adjusted/api/model", {"add": "backlash:X"})[0])
            status, answer = save(people[1], read[1])
            self.assertEqual((412, "changed", sorted([*before, "scale:X", "backlash:X"]), sorted([*before, "scale:X"])), (status, answer["id"], sorted(answer["yours"]), sorted(answer["on_disk"])))
            self.assertEqual(kept, manifest.read_bytes(), "nothing of the first is lost")
            self.assertEqual(200, save(people[1], state(people[1])["campaign"]["manifest_sha256"])[0], "once it was read")
            # Who may only look changes nothing, and the page says so.
            viewer = Person(s, "view-1")
            self.assertFalse(state(viewer)["edit"])
            self.assertTrue(state(people[0])["edit"])
            self.assertEqual((403, "role"), (lambda r: (r[0], r[1]["id"]))(save(viewer, state(viewer)["campaign"]["manifest_sha256"])))

    def test_two_persons_are_two_accounts(self):
        subprocess.run([self.site / "make-key.sh"], check=True, capture_output=True)
        settings = (self.site / "site.toml").read_text().replace('authoriser = "B. Sample"', 'authoriser = "B. Sample; A. Bianchi"').replace("[certificate]", "[certificate]\ntwo_persons = true")
        (self.site / "site.toml").write_text(settings)
        nonio("run", self.site, "--out", self.out, "--quiet", expect=None)
        folder = self.site / "adjusted"
        drafts = json.loads(nonio("certificate", "approve", self.site, "--list", "--json").stdout)["drafts"]
        reasons = {(f["measurement"] + ": " if f["measurement"] else "") + f["id"]: "as found" for f in drafts[0]["findings"] if f["severity"] == "attention"}
        with self.serve() as s:
            first, second = Person(s, "bianchi"), Person(s, "sample")
            body = {"campaign": "adjusted", "by": "Another Person", "reasons": reasons}
            for wrong in ({}, {"password": "not this one"}):
                status, answer = first.ask("POST", "/api/release", {**body, **wrong})
                self.assertIn((status, answer["id"]), ((403, "password"), (429, "wait")))
            deadline = time.monotonic() + WAIT
            while (answer := first.ask("POST", "/api/release", {**body, "password": PASSWORDS["bianchi"]}))[0] == 429 and time.monotonic() < deadline:
                time.sleep(0.2)
            self.assertEqual((200, "approved"), (answer[0], answer[1].get("state")), answer)
            authoriser = {**body, "as": "authoriser"}
            status, answer = first.ask("POST", "/api/release", {**authoriser, "password": PASSWORDS["bianchi"]})
            self.assertEqual(422, status, "the author is not the authoriser")
            # On a terminal: a name is no second account, a password of another person is wrong, a role is missing.
            for arguments, given in ((["--by", "B. Sample"], ""), (["--user", "sample"], PASSWORDS["bianchi"]), (["--user", "view-1"], PASSWORDS["view-1"]), (["--user", "stranger"], ""), (["--user", "sample", "--by", "B. Sample"], PASSWORDS["sample"])):
                done = subprocess.run([NONIO, "certificate", "approve", folder, "--as", "authoriser", *arguments], input=given + "\n", capture_output=True, text=True, timeout=WAIT)
                self.assertEqual(2, done.returncode, f"{arguments} {done.stdout}{done.stderr}")
            status, answer = second.ask("POST", "/api/release", {**authoriser, "password": PASSWORDS["sample"]})
            self.assertEqual((200, "issued"), (status, answer.get("state")), answer)
            self.assertNotIn(PASSWORDS["sample"], json.dumps(answer))
        entry = json.loads(nonio("certificate", "list", self.site, "--json").stdout)["certificates"][0]
        self.assertEqual(("B. Sample", "sample"), (entry["released_by"], entry["released_user"]))
        self.assertIn("@", entry["released_account"], "the account of the operating system, too")
        self.assertIn("user sample, account ", nonio("certificate", "list", self.site).stdout)
        approvals = [(e["account"], e["state"], e.get("result", e.get("error", ""))) for e in self.log() if e["request"] == "/api/release" and e["state"] != "begins"]
        self.assertEqual(("bianchi", "done", "approved"), next(a for a in approvals if a[1] == "done"))
        self.assertEqual(("sample", "done", "issued"), approvals[-1])
        self.assertIn(("bianchi", "failed", "refused.password"), approvals)


if __name__ == "__main__":
    unittest.main()
