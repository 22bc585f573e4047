# SPDX-License-Identifier: Apache-2.0
"""[webhook]: new lines reach a server of this test's own, signed; one that fails delays no result."""
import hashlib
import hmac
import http.server
import json
import os
import pathlib
import ssl
import subprocess
import tempfile
import threading
import time
import unittest

NONIO = os.environ["NONIO"]
SECRET = b"secret of the laboratory"


class Server(http.server.ThreadingHTTPServer):
    """`status` of the next answers; None: no answer."""

    def __init__(self, certificate=None):
        super().__init__(("127.0.0.1", 0), Handler)
        self.got, self.status, self.over = [], 204, threading.Event()
        if certificate:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            context.load_cert_chain(*certificate)
            self.socket = context.wrap_socket(self.socket, server_side=True)
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def url(self, scheme="http", host="127.0.0.1"):
        return f"{scheme}://{host}:{self.server_address[1]}/hook?of=lab"

    def handle_error(self, *_):
        pass

    def end(self):
        self.over.set()
        self.shutdown()
        self.server_close()


class Handler(http.server.BaseHTTPRequestHandler):
    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.server.got.append((self.path, dict(self.headers), body, time.time()))
        if self.server.status is None:
            self.server.over.wait(60)
            return
        self.send_response(self.server.status)
        if self.server.status == 302:
            self.send_header("Location", "/elsewhere")
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, *_):
        pass


class Webhook(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-webhook-")
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.site, self.out = self.root / "site", self.root / "out"
        self.site.mkdir()
        self.secret = self.root / "secret"
        self.secret.write_bytes(SECRET + b"\n")
        self.secret.chmod(0o600)

    def server(self, **kwargs):
        server = Server(**kwargs)
        self.addCleanup(server.end)
        return server

    def hook(self, url, more=""):
        (self.site / "site.toml").write_text(f'[webhook]\nurl = "{url}"\nsecret_file = "{self.secret}"\n{more}')

    def campaign(self, name):
        """One that requires action: the deviation grows as a wrong unit makes it."""
        folder = self.site / name
        folder.mkdir()
        (folder / "campaign.toml").write_text(
            f'format = 1\n[campaign]\nid = "{name}"\ndate = 2026-11-03\n[machine]\nasset = "{name}"\n[machine.axes.X]\n'
            '[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n')
        (folder / "x.csv").write_text("run,direction,target_mm,position_mm\n" + "".join(
            f"{run},{way},{50 * k},{0.05 * k + 1e-6 * run}\n" for run in (1, 2) for way in "+-" for k in range(6)))

    def run_site(self, expect=0):
        done = subprocess.run([NONIO, "run", self.site, "--out", self.out, "--quiet"], capture_output=True, text=True, check=False, timeout=300)
        self.assertEqual(done.returncode, expect, done.stderr)
        self.said = done.stderr
        return (self.out / "summary.txt").read_text() if expect == 0 else done.stderr

    def refused(self):
        """What a run reports that the webhook did not take its lines."""
        self.run_site()
        self.assertIn("the webhook did not take", self.said)
        return self.said

    def taken(self, server):
        """The last message, whose signature is compared with an independent one."""
        path, headers, body, _ = server.got[-1]
        self.assertEqual(path, "/hook?of=lab")
        self.assertEqual(headers["Content-Type"], "application/json")
        self.assertEqual(headers["X-Nonio-Signature"], "sha256=" + hmac.new(SECRET, body, hashlib.sha256).hexdigest())
        self.assertNotIn(SECRET, body)
        message = json.loads(body)
        self.assertEqual(message["schema"], "nonio-webhook/1")
        return message["run"], sorted({line["campaign"] for line in message["lines"]})

    def test_new_lines_once_and_what_was_not_taken_again(self):
        server = self.server()
        self.hook(server.url())
        self.campaign("a")
        self.assertNotIn("webhook", self.run_site())
        self.assertEqual(self.taken(server), (1, ["a"]))
        lines = json.loads(server.got[-1][2])["lines"]
        known = {line["id"]: line for line in json.loads((self.out / "summary.json").read_text())["lines"]}
        for line in lines:
            self.assertEqual(line, known[line["id"]])
        self.run_site()
        self.assertEqual(len(server.got), 1, "nothing is new")
        for number, (status, name) in enumerate(((500, "b"), (302, "c")), 3):
            server.status = status
            self.campaign(name)
            self.assertIn(f"answered {status}", self.refused())
            self.assertEqual(self.taken(server)[0], number)
        server.status = 204
        self.campaign("d")
        self.assertIn("after run 4: " + server.url() + " answered 302", self.run_site(), "the summary names the failure of the run before")
        self.assertNotIn("webhook", self.said)
        self.assertEqual(self.taken(server), (5, ["b", "c", "d"]))
        self.assertEqual([one for one in server.got if one[0] == "/elsewhere"], [])
        count = len(server.got)
        self.assertNotIn("webhook", self.run_site())
        self.assertEqual(len(server.got), count)

    def test_a_server_that_is_away_or_silent_fails_no_run(self):
        server = self.server()
        server.status = None
        self.hook(server.url())
        self.campaign("a")
        self.refused()
        # Everything was stored before the server was called, and the run states how long it took without it.
        called = server.got[-1][3]
        stored = [p.stat().st_mtime for p in (self.out / "summary.json", self.out / "summary.txt", self.out / ".nonio/night.json", self.out / "a/results.json")]
        self.assertLess(max(stored), called)
        ended = (self.out / ".nonio/webhook-failed").stat().st_mtime
        self.assertLess(ended - called, 20.0, "5 s, and what a loaded machine adds")
        server.end()
        self.campaign("b")
        self.refused()
        other = self.server()
        self.hook(other.url(host="localhost"))
        self.run_site()
        self.assertEqual(self.taken(other), (3, ["a", "b"]))
        readings = self.site / "b/x.csv"
        wrong, count = readings.read_text(), len(other.got)
        readings.write_text("run,direction,target_mm,position_mm\n" + "".join(
            f"{run},{way},{50 * k},{50 * k + 1e-4 * (k * k % 5) + 1e-5 * run}\n" for run in (1, 2) for way in "+-" for k in range(6)))
        self.run_site()
        self.assertEqual(len(other.got), count)
        readings.write_text(wrong)  # what ended and is back is sent again
        self.run_site()
        self.assertEqual(self.taken(other)[1], ["b"])

    def test_only_to_a_server_whose_certificate_is_valid(self):
        def openssl(*args):
            subprocess.run(["openssl", *map(str, args)], check=True, capture_output=True, cwd=self.root)
        for name, subject in (("good", "localhost"), ("other", "elsewhere")):
            openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2", "-keyout", name + ".key",
                    "-out", name + ".pem", "-subj", "/CN=" + subject, "-addext", "subjectAltName=DNS:" + subject)
        self.campaign("a")
        other = self.server(certificate=(self.root / "other.pem", self.root / "other.key"))
        good = self.server(certificate=(self.root / "good.pem", self.root / "good.key"))
        for server, trust in ((good, ""), (good, "other.pem"), (other, "other.pem")):
            self.hook(server.url("https", "localhost"), f'trust = "{self.root / trust}"\n' if trust else "")
            if self.out.exists():  # a line that is new in each run
                self.campaign(f"more{trust.split('.')[0]}{len(list(self.site.iterdir()))}")
            self.refused()
            self.assertEqual(server.got, [])
        self.hook(good.url("https", "localhost"), f'trust = "{self.root / "good.pem"}"\n')
        self.run_site()
        self.assertNotIn("webhook", self.said)
        self.assertIn("a", self.taken(good)[1])

    def test_what_is_refused(self):
        self.campaign("a")
        for url in ("http://lab.example/hook", "http://127.0.0.1.lab.example/", "http://localhost.lab.example/", "http://127.0.0.1@lab.example/",
                    "ftp://127.0.0.1/", "httpx://127.0.0.1/"):
            self.hook(url)
            self.assertIn("expected an address that begins with https://", self.run_site(expect=2), url)
        server = self.server()
        self.hook(server.url())
        self.secret.chmod(0o644)
        self.assertIn("chmod 600", self.refused())
        self.assertEqual(server.got, [])


if __name__ == "__main__":
    unittest.main()
