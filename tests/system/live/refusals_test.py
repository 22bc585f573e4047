# SPDX-License-Identifier: Apache-2.0
"""Who is refused, by a raw socket, http.client and, where it is there, curl: DNS rebinding, foreign pages, other users,
too much of anything; and what every answer carries."""
import json
import os
import pathlib
import shutil
import socket
import stat
import subprocess
import tempfile
import time
import unittest

from live import NONIO, SAMPLES, Server, nonio

HEADERS = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cross-Origin-Resource-Policy": "same-origin",
           "Cross-Origin-Opener-Policy": "same-origin"}


class Refusals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server(SAMPLES / "02-constant-reversal", "--host", "nonio.example.org")
        cls.server.opened()

    @classmethod
    def tearDownClass(cls):
        rest = cls.server.end()
        assert rest == "", f"stdout has one line, the address; found also {rest!r}"

    def ask(self, method="GET", path="/api/state", fields=(), body=b"", host=None, token=True):
        """Status and text of the answer to these bytes."""
        s = self.server
        head = [f"{method} {path} HTTP/1.1", f"Host: {host or f'127.0.0.1:{s.port}'}"]
        head += [f"X-Nonio-Token: {s.token}"] if token else []
        head += [f"{name}: {value}" for name, value in fields]
        answer = s.raw("\r\n".join(head).encode() + b"\r\n\r\n" + body).decode(errors="replace")
        self.assertTrue(answer, f"no answer: {method} {path} {fields}")
        return int(answer.split(" ")[1]), answer

    def refused(self, status, words, **asked):
        got, answer = self.ask(**asked)
        self.assertEqual(got, status, answer)
        if words:
            self.assertIn(words, json.loads(answer.split("\r\n\r\n", 1)[1])["error"])
        self.assertNotIn("Access-Control", answer)
        for name, value in HEADERS.items():
            self.assertIn(f"{name}: {value}", answer)

    def test_only_loopback_is_bound(self):
        line = next(l for l in pathlib.Path("/proc/net/tcp").read_text().splitlines()[1:]
                    if l.split()[1].endswith(f":{self.server.port:04X}") and l.split()[3] == "0A")
        self.assertTrue(line.split()[1].startswith("0100007F:"), line)
        if pathlib.Path("/proc/net/tcp6").exists():
            self.assertNotIn(f":{self.server.port:04X} ", "".join(
                l for l in pathlib.Path("/proc/net/tcp6").read_text().splitlines() if " 0A " in l))

    def test_hosts(self):
        port = self.server.port
        for host in (f"127.0.0.1:{port}", f"localhost:{port}", f"LocalHost:{port}", f"localhost.:{port}", "nonio.example.org", "NONIO.Example.org",
                     "nonio.example.org:443", "nonio.example.org."):
            self.assertEqual(self.ask(host=host)[0], 200, host)
        for host in ("evil.example", f"evil.example:{port}", "127.0.0.1", "localhost", f"127.0.0.1:{port + 1}", f"[::1]:{port}", f"127.0.0.1.:{port}",
                     f"127.0.0.2:{port}", f"0.0.0.0:{port}", f"127.1:{port}", f"a@127.0.0.1:{port}", f"127.0.0.1:{port}.evil.example",
                     f"evil.nonio.example.org", "nonio.example.org:8443", "nonio.example.org.evil.example", f"2130706433:{port}"):
            with self.subTest(host):
                self.refused(421, f"open http://127.0.0.1:{port}/", host=host)
        self.assertEqual(int(self.server.raw(f"GET / HTTP/1.1\r\nX-Nonio-Token: {self.server.token}\r\n\r\n".encode()).split()[1]), 421)
        self.refused(421, "", fields=[("Host", f"127.0.0.1:{port}")])  # two of them

    def test_foreign_pages(self):
        port = self.server.port
        own = f"http://127.0.0.1:{port}"
        for fields in ([("Origin", own)], [("Sec-Fetch-Site", "same-origin")], [("Sec-Fetch-Site", "none")], [("Origin", "https://nonio.example.org")]):
            self.assertEqual(self.ask(fields=fields)[0], 200, fields)
        for origin in ("http://evil.example", "null", f"http://127.0.0.1:{port + 1}", f"https://127.0.0.1:{port}", "http://127.0.0.1", f"http://127.0.0.1:{port}.evil.example",
                       "file://", "https://nonio.example.org.evil.example", f"{own}, http://evil.example"):
            with self.subTest(origin):
                self.refused(403, "another page", fields=[("Origin", origin)])
        for site in ("cross-site", "same-site", "", "same-origin, none"):
            with self.subTest(site):
                self.refused(403, "another site", fields=[("Sec-Fetch-Site", site)])
        # Also for paths without a token: no other site can embed the page's script.
        self.refused(403, "another site", path="/app.js", fields=[("Sec-Fetch-Site", "same-site")], token=False)

    def test_token(self):
        token = self.server.token
        wrong = ("0" if token[0] != "0" else "1") + token[1:]
        for given in ("", wrong, token[:-1], token + "0", token.upper() if token.upper() != token else wrong, f" {wrong}", "x" * 200):
            with self.subTest(given):
                self.refused(403, "open the address", fields=[("X-Nonio-Token", given)], token=False)
        self.refused(403, "open the address", fields=[("X-Nonio-Token", token)])  # two of them
        self.refused(403, "open the address", token=False)
        self.refused(403, "", path=f"/api/state?t={token}", token=False)
        self.refused(403, "", path=f"/?t={token}#t={token}" if False else f"/api/state?token={token}", token=False)
        self.refused(403, "", fields=[("Cookie", f"t={token}; X-Nonio-Token={token}")], token=False)
        # Without a token the answer does not show which paths exist.
        for path in ("/api/state", "/api/nothing", "/etc/passwd", "/api/parts/Z/fit"):
            self.refused(403, "", path=path, token=False)
        self.assertNotIn(token, self.server.words())

    def test_methods(self):
        for method in ("OPTIONS", "PUT", "DELETE", "HEAD", "TRACE", "PATCH", "CONNECT", "get"):
            with self.subTest(method):
                status, answer = self.ask(method=method)
                self.assertEqual(status, 405, answer)
                self.assertIn("Allow: GET, POST", answer)
                self.assertNotIn("Access-Control", answer)
        self.refused(405, "", method="POST", path="/api/state", fields=[("Content-Type", "application/json"), ("Content-Length", "2")], body=b"{}")
        self.refused(405, "", path="/api/model")

    def test_paths_are_of_a_fixed_table(self):
        for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/app.js/", "//api/state", "/api/state/", "/api/parts/Z/fit/../explain",
                     "/api/parts//fit", "/index.html", "/api", "/api/parts/%00/fit", "/api/parts/%zz/fit"):
            with self.subTest(path):
                self.assertIn(self.ask(path=path)[0], (400, 404))
        self.assertEqual(self.ask(path="/api/parts/NONE/fit")[0], 404)

    def test_sizes(self):
        self.refused(414, "", path="/api/state?" + "x" * 3000)
        self.refused(431, "", fields=[("X-Much", "x" * 17000)])
        self.refused(431, "", fields=[(f"X-{i}", "1") for i in range(80)])
        status, answer = self.ask(fields=[("X-Much", "x" * 200000)])
        self.assertEqual(status, 431, answer[:200])
        json_type = ("Content-Type", "application/json")
        self.refused(413, "", method="POST", path="/api/model", fields=[json_type, ("Content-Length", "2000000")])
        self.refused(400, "", method="POST", path="/api/model", fields=[json_type, ("Content-Length", "9" * 30)])
        self.refused(413, "", method="POST", path="/api/model", fields=[json_type, ("Content-Length", "2000000")], body=b"x" * 2000000)
        chunks = b"".join(b"10000\r\n" + b"x" * 0x10000 + b"\r\n" for _ in range(20)) + b"0\r\n\r\n"
        self.refused(413, "", method="POST", path="/api/model", fields=[json_type, ("Transfer-Encoding", "chunked")], body=chunks)

    def test_bodies(self):
        json_type = ("Content-Type", "application/json")
        self.refused(415, "application/json", method="POST", path="/api/model", fields=[("Content-Type", "text/plain"), ("Content-Length", "2")], body=b"{}")
        self.refused(415, "", method="POST", path="/api/model", fields=[("Content-Length", "2")], body=b"{}")
        for body in (b"", b"[]", b"{", b"\xff\xfe", b'{"add":7}', b'{"model":"x"}', b'{"model":[1]}', b"[" * 100000, b'{"nothing":1}'):
            with self.subTest(body[:20]):
                status, answer = self.ask("POST", "/api/model", [json_type, ("Content-Length", len(body))], body)
                self.assertEqual(status, 400, answer)
        self.refused(400, "", method="POST", path="/api/model", fields=[json_type, ("Content-Length", "2"), ("Transfer-Encoding", "chunked")], body=b"0\r\n\r\n")
        self.refused(400, "", method="POST", path="/api/model", fields=[json_type, ("Content-Length", "2"), ("Content-Length", "3")], body=b"{}")

    def test_garbage_ends_the_connection_only(self):
        for data in (b"\r\n\r\n", b"\0" * 100 + b"\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"\x16\x03\x01\x02\r\n\r\n", b"GET  HTTP/1.1\r\n\r\n"):
            self.assertNotIn(b" 200 ", self.server.raw(data, wait=10)[:20], data)
        self.assertEqual(self.ask()[0], 200)

    def test_what_every_answer_carries(self):
        for path, token in (("/", False), ("/app.js", False), ("/app.css", False), ("/uplot.js", False), ("/uplot.css", False), ("/api/state", True), ("/none", True)):
            status, headers, body = self.server.request("GET", path, token=token)
            self.assertEqual(status, 404 if path == "/none" else 200, path)
            policy = headers["Content-Security-Policy"]
            for part in ("default-src 'none'", "script-src 'self'", "style-src 'self'", "connect-src 'self'", "base-uri 'none'", "form-action 'none'",
                         "frame-ancestors 'none'", "require-trusted-types-for 'script'", "trusted-types 'none'"):
                self.assertIn(part, policy)
            self.assertNotIn("unsafe", policy)
            for name, value in HEADERS.items():
                self.assertEqual(headers[name], value)
            self.assertNotIn("Set-Cookie", headers)
            self.assertIn(headers["Cache-Control"], ("no-store", "no-cache") if not token else ("no-store",))
            self.assertNotIn(self.server.token.encode(), body)
        status, headers, _ = self.server.request("GET", "/app.js", token=False)
        self.assertEqual(self.server.request("GET", "/app.js", headers={"If-None-Match": headers["ETag"]}, token=False)[0], 304)

    def test_the_shell_has_no_data(self):
        _, _, shell = self.server.request("GET", "/", token=False)
        self.assertNotIn(b"02-constant-reversal", shell)
        self.assertNotIn(b"Esempio", shell)

    def test_without_edit_nothing_is_written(self):
        state = self.server.opened()
        before = (SAMPLES / "02-constant-reversal/campaign.toml").read_bytes()
        self.server.post("/api/model", {"add": "backlash:Z"})
        answer = self.server.post("/api/save", expect=403, headers={"If-Match": f'"{state["campaign"]["manifest_sha256"]}"'})
        self.assertEqual("read_only", answer["id"])
        self.assertEqual((SAMPLES / "02-constant-reversal/campaign.toml").read_bytes(), before)
        self.server.post("/api/undo")

    def test_slow_heads_delay_no_other_request(self):
        """Slowloris: more connections than threads that send a byte now and then, or nothing at all."""
        slow = [socket.create_connection(("127.0.0.1", self.server.port)) for _ in range(60)]
        try:
            for s in slow[:40]:
                s.sendall(b"GET / HTTP/1.1\r\nX-Slow: ")
            begun = time.monotonic()
            self.assertEqual(self.ask()[0], 200)
            self.assertLess(time.monotonic() - begun, 3)
            slow[0].settimeout(12)
            answer = slow[0].recv(4096)
            self.assertIn(b"408", answer[:20])
            self.assertLess(time.monotonic() - begun, 11)
        finally:
            for s in slow:
                s.close()
        self.assertEqual(self.ask()[0], 200)

    def test_a_flood_of_connections_is_borne(self):
        many = [socket.create_connection(("127.0.0.1", self.server.port)) for _ in range(300)]
        try:
            self.assertEqual(self.ask()[0], 200)
        finally:
            for s in many:
                s.close()

    @unittest.skipUnless(shutil.which("curl"), "curl is not installed")
    def test_curl(self):
        def curl(*args):
            url = f"http://127.0.0.1:{self.server.port}/api/state"
            done = subprocess.run(["curl", "-s", "-o", "/dev/null", "-w", "%{http_code}", *args, url], capture_output=True, text=True, timeout=60)
            return int(done.stdout)
        token = ("-H", f"X-Nonio-Token: {self.server.token}")
        self.assertEqual(curl(*token), 200)
        self.assertEqual(curl(), 403)
        self.assertEqual(curl(*token, "-H", "Host: evil.example"), 421)
        self.assertEqual(curl(*token, "-H", "Origin: http://evil.example"), 403)
        self.assertEqual(curl(*token, "-X", "OPTIONS"), 405)


class Tokens(unittest.TestCase):
    def test_a_token_file_keeps_the_address(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "token"
            with Server(SAMPLES / "02-constant-reversal", "--token-file", file) as one:
                first, port = one.token, one.port
            self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o600)
            with Server(SAMPLES / "02-constant-reversal", "--token-file", file, "--port", port) as two:
                self.assertEqual((two.token, two.port), (first, port))
            file.chmod(0o644)
            done = nonio("serve", "--token-file", file, SAMPLES / "02-constant-reversal", expect=2)
            self.assertIn("no other user can read", done.stderr)
            file.write_text("short\n")
            file.chmod(0o600)
            self.assertIn("32 hexadecimal", nonio("serve", "--token-file", file, SAMPLES / "02-constant-reversal", expect=2).stderr)

    def test_each_start_has_its_own(self):
        with Server(SAMPLES / "02-constant-reversal") as one, Server(SAMPLES / "02-constant-reversal") as two:
            self.assertNotEqual(one.token, two.token)
            self.assertRegex(one.line, r"^http://127\.0\.0\.1:\d+/#t=[0-9a-f]{32}\n$")
            self.assertEqual(one.request("GET", "/api/state", headers={"X-Nonio-Token": two.token})[0], 403)

    def test_the_token_is_on_no_command_line(self):
        with Server(SAMPLES / "02-constant-reversal") as one:
            for pid, _ in [(one.process.pid, 0), *one.pids()]:
                for what in ("cmdline", "environ"):
                    self.assertNotIn(one.token.encode(), pathlib.Path(f"/proc/{pid}/{what}").read_bytes())

    def test_what_is_no_campaign(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("campaign.toml", nonio("serve", folder, expect=2).stderr)
        with Server(SAMPLES / "02-constant-reversal") as one:
            self.assertIn(str(one.port), nonio("serve", "--port", one.port, SAMPLES / "02-constant-reversal", expect=2).stderr)


if __name__ == "__main__":
    unittest.main()
