# SPDX-License-Identifier: Apache-2.0
"""Random requests to `nonio serve SITE --edit`: broken request lines, fields and bodies of every route. Each answer carries the
security headers, none is a mistake of the server (500), limits hold, and the server is still there at the end.

NONIO_SEED, NONIO_FUZZ_REQUESTS: other ones, more of them. What a site does by verbs costs a process, so those are few."""
import json
import os
import random
import re
import shutil
import socket
import time
import unittest

from live import LiveTest, SAMPLES, Server

SEED = int(os.environ.get("NONIO_SEED", str(random.SystemRandom().randrange(1 << 32))))
REQUESTS = int(os.environ.get("NONIO_FUZZ_REQUESTS", "700"))
HEADERS = ("Content-Security-Policy: default-src 'none'", "X-Content-Type-Options: nosniff", "X-Frame-Options: DENY", "Referrer-Policy: no-referrer",
           "Cross-Origin-Resource-Policy: same-origin", "Cross-Origin-Opener-Policy: same-origin")
CAMPAIGN = "/c/02-constant-reversal"
GETS = ["/", "/site.js", "/api/site/state", "/site/{}", "/site/machines/{}", "/site/results/{}/{}", "/c/{}/", "/c/{}/api/state",
        "/api/campaigns?search={}&state={}&page={}&size={}", "/api/machines", "/api/records"] + \
    [CAMPAIGN + "/api/" + p for p in ("state", "parts/{}/fit", "parts/{}/explain", "parts/{}/series?x={}&y={}&x0={}&px={}", "parts/{}/readings?rows={}",
                                      "parts/{}/readings?from={}&count={}", "page/{}", "save")]
POSTS = [CAMPAIGN + "/api/" + p for p in ("model", "undo", "redo", "name", "goto", "exclude", "include", "period", "cancel")] + ["/api/open", "/api/run/cancel"]
VERBS = ["/api/ack", "/api/event", "/api/release"]
FILES = ["/api/preview", "/api/campaigns"]
KEYS = ["add", "drop", "model", "n", "name", "part", "rows", "why", "axis", "period_mm", "job", "campaign", "finding", "machine", "until", "by", "kind", "text",
        "reasons", "as", "withdraw", "date", "value", "columns", "values", "axis.from", "campaign.date", "machine.maker"]


class Fuzz(LiveTest):
    def setUp(self):
        super().setUp()
        self.small = self.site.parent / "small"
        self.small.mkdir()
        shutil.copy(SAMPLES / "site.toml", self.small)
        shutil.copytree(SAMPLES / "02-constant-reversal", self.small / "02-constant-reversal")
        self.random = random.Random(SEED)

    def text(self, longest=12):
        r = self.random
        return r.choice(["", "Z", "X", "0", "-1", "1e9", "nan", "..", "%2e%2e", "--help", "\u202e", "'", "<b>", "02-constant-reversal", "x" * r.randrange(1, 300),
                         "".join(chr(r.choice([r.randrange(32, 127), r.randrange(1, 0x2fff)])) for _ in range(r.randrange(longest)))])

    def value(self, depth=0):
        r = self.random
        kind = r.randrange(9 if depth < 3 else 6)
        if kind == 0:
            return self.text()
        if kind == 1:
            return r.choice([0, -1, 1, 2 ** 63, 2 ** 64, -2 ** 63, 1e308, 0.5, 10])
        if kind < 6:
            return r.choice([None, True, False, "scale:Z", "Z", [], {}])
        if kind < 8:
            return [self.value(depth + 1) for _ in range(r.randrange(4))]
        return {r.choice(KEYS): self.value(depth + 1) for _ in range(r.randrange(4))}

    def body(self):
        r = self.random
        kind = r.randrange(8)
        if kind == 0:
            return bytes(r.randrange(256) for _ in range(r.randrange(60)))
        if kind == 1:
            return b"[" * r.randrange(1, 5000)
        data = json.dumps({r.choice(KEYS): self.value() for _ in range(r.randrange(5))}).encode()
        return data[:r.randrange(len(data) + 1)] if kind == 2 else data

    def file(self):
        """A line of JSON and bytes, most of them as a page would send them."""
        r = self.random
        form = {"name": r.choice(["x.csv", "x.xlsx", self.text()]), "axis": r.choice(["X", "C", self.text()]), "columns": self.value(), "values": {r.choice(KEYS): self.value() for _ in range(4)}}
        rows = b"run,direction,target_mm,deviation_um\n1,+,0,1\n1,-,0,2\n"
        for _ in range(r.randrange(3)):
            form.pop(r.choice(list(form)), None) if form else None
        return json.dumps(form if r.random() < 0.9 else self.value()).encode("utf-8", "replace") + b"\n" + r.choice([rows, b"", b"PK\x03\x04" + bytes(r.randrange(256) for _ in range(40))])

    def place(self, path):
        r = self.random
        escape = lambda text: "".join(c if c.isalnum() or (r.random() < 0.1 and " " < c < "\x7f") else "".join(f"%{b:02X}" for b in c.encode("utf-8", "replace")) for c in text)
        return re.sub(r"\{\}", lambda _: escape(self.text()), path)

    def request(self):
        """Bytes, and whether the head is as it should be."""
        r, s = self.random, self.server
        post = r.random() < 0.5
        path = r.choice(VERBS + FILES) if r.random() < 0.03 else self.place(r.choice(POSTS if post else GETS))
        post = post or path in VERBS + FILES
        body = self.file() if path in FILES else self.body() if post else b""
        fields = [f"Host: 127.0.0.1:{s.port}", f"X-Nonio-Token: {s.token}"]
        if post:
            fields += ["Content-Type: application/" + ("octet-stream" if path in FILES else "json"), f"Content-Length: {len(body)}"]
        head = "\r\n".join([f"{'POST' if post else 'GET'} {path} HTTP/1.1", *fields]).encode("utf-8", "replace") + b"\r\n\r\n"
        if r.random() < 0.35:  # spoiled, but for the empty line at its end
            head = bytearray(head[:-4])
            for _ in range(r.randrange(1, 5)):
                at = r.randrange(len(head))
                r.choice([lambda: head.__setitem__(at, r.randrange(256)), lambda: head.insert(at, r.choice(b"\0\r\n \t:;%\x7f\xff")), lambda: head.__delitem__(slice(at, at + r.randrange(9)))])()
                head = head or bytearray(b"x")
            head = bytes(head) + b"\r\n\r\n"
        return head + body

    def answer_to(self, data):
        """All that comes back; nothing more is sent."""
        with socket.create_connection(("127.0.0.1", self.server.port), timeout=30) as s:
            s.sendall(data)
            s.shutdown(socket.SHUT_WR)
            out = b""
            try:
                while part := s.recv(65536):
                    out += part
            except ConnectionResetError:
                pass
            return out

    def test_random_requests(self):
        print(f"seed {SEED}", flush=True)
        began = time.monotonic()
        with Server(self.small, "--edit") as self.server:
            s = self.server
            s.until(CAMPAIGN + "/api/state", lambda state: state.get("bench") == "open", "open")
            seen = {}
            for k in range(REQUESTS):
                data = self.request()
                answer = self.answer_to(data).decode("latin-1")
                at = f"seed {SEED}, request {k}: {data[:300]!r}"
                self.assertTrue(answer.startswith("HTTP/1."), f"{at}: {answer[:200]!r}")
                status, head = int(answer[9:12]), answer.split("\r\n\r\n", 1)[0]
                seen[status] = seen.get(status, 0) + 1
                self.assertNotEqual(status, 500, at + s.words())
                for name in HEADERS:
                    self.assertIn(name, head, at)
                if status >= 400:
                    self.assertIn("error", json.loads(answer.split("\r\n\r\n", 1)[1]), at)
            print(f"{REQUESTS} requests in {time.monotonic() - began:.1f} s: {dict(sorted(seen.items()))}", flush=True)
            self.assertGreater(len(seen), 3, "nothing but refusals was tried")
            self.assertEqual(s.get("/api/site/state")["schema"], "nonio-live-site/1")
            self.assertNotIn("mistake", s.words())
            # What was made is an ordinary campaign; nothing else was.
            names = {p.name for p in self.small.iterdir()} - {"site.toml", "02-constant-reversal", "acknowledged.toml", "events.toml", "history.sqlite", "certificates.sqlite", "audit.jsonl"}
            self.assertEqual([], [n for n in names if not (self.small / n / "campaign.toml").is_file()])

    def test_bodies_have_a_limit_on_every_route(self):
        with Server(self.small, "--edit") as self.server:
            s = self.server
            token = f"Host: 127.0.0.1:{s.port}\r\nX-Nonio-Token: {s.token}\r\n"
            for path in (*POSTS, *VERBS, "/api/run"):
                for length, expected in (("1048577", (413,)), ("99999999999999999999", (400, 413))):
                    answer = s.raw(f"POST {path} HTTP/1.1\r\n{token}Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n".encode())
                    self.assertIn(int(answer.split()[1]), expected, path)
            answer = s.raw(f"POST /api/verify HTTP/1.1\r\n{token}Content-Type: application/pdf\r\nContent-Length: {(32 << 20) + 1}\r\n\r\n".encode())
            self.assertEqual(int(answer.split()[1]), 413)
            chunk = b"10000\r\n" + b"x" * 0x10000 + b"\r\n"
            answer = s.raw(f"POST /api/open HTTP/1.1\r\n{token}Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n".encode() + chunk * 20 + b"0\r\n\r\n")
            self.assertEqual(int(answer.split()[1]), 413, "counted as it comes")


if __name__ == "__main__":
    unittest.main()
