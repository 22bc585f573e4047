# SPDX-License-Identifier: Apache-2.0
"""What the tests of `nonio serve` share: a server with a campaign, requests, raw sockets, event streams."""
import http.client
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest
import urllib.parse

NONIO = os.environ["NONIO"]
ROOT = pathlib.Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples/site"
WAIT = float(os.environ.get("NONIO_LIVE_WAIT", "90"))


class Server:
    """`nonio serve` on a folder; ended at the end of the with block."""

    def __init__(self, folder, *args, env=None):
        self.folder = pathlib.Path(folder)
        self.errors = tempfile.TemporaryFile()
        self.process = subprocess.Popen([NONIO, "serve", *map(str, args), str(folder)], stdout=subprocess.PIPE,
                                        stderr=self.errors, env={**os.environ, **(env or {})})
        self.line = self.process.stdout.readline().decode()
        if not self.line:
            self.process.wait(30)
            raise AssertionError("no address: " + self.words())
        self.address, _, self.token = self.line.strip().partition("#t=")  # no token where people sign in
        self.port = int(self.address.rsplit(":", 1)[1].strip("/"))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def words(self):
        self.errors.seek(0)
        return self.errors.read().decode()

    def end(self, number=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(number)
            try:
                self.process.wait(60)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
                raise AssertionError("the server did not end") from None
        rest = self.process.stdout.read().decode()
        self.process.stdout.close()
        return rest

    def request(self, method, path, body=None, headers=None, token=True, timeout=WAIT):
        """Status, headers, bytes."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        fields = {"X-Nonio-Token": self.token} if token else {}
        if method == "POST":
            fields["Content-Type"] = "application/json"
            body = json.dumps({} if body is None else body) if not isinstance(body, (bytes, str)) else body
        fields.update(headers or {})
        try:
            connection.request(method, path, body, fields)
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read()
        finally:
            connection.close()

    def get(self, path, expect=200):
        status, _, body = self.request("GET", path)
        if expect is not None and status != expect:
            raise AssertionError(f"GET {path}: {status} {body[:500]!r}\n{self.words()}")
        return json.loads(body)

    def post(self, path, body=None, expect=200, headers=None):
        status, _, data = self.request("POST", path, body, headers)
        if expect is not None and status != expect:
            raise AssertionError(f"POST {path}: {status} {data[:500]!r}\n{self.words()}")
        return json.loads(data)

    def raw(self, data, wait=10.0, then=b""):
        """All that comes back for these bytes."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=wait) as s:
            s.sendall(data)
            if then:
                s.sendall(then)
            out = b""
            try:
                while part := s.recv(65536):
                    out += part
            except (ConnectionResetError, socket.timeout):
                pass
            return out

    def until(self, path, holds, what=""):
        """Asks again until the answer is as wanted."""
        deadline = time.monotonic() + WAIT
        while True:
            answer = self.get(path, expect=None)
            if holds(answer):
                return answer
            if time.monotonic() > deadline:
                raise AssertionError(f"{path}: never {what}: {str(answer)[:800]}\n{self.words()}")
            time.sleep(0.05)

    def opened(self):
        return self.until("/api/state", lambda s: s.get("bench") == "open", "open")

    def fit(self, part):
        return self.until(f"/api/parts/{urllib.parse.quote(part, safe='')}/fit", lambda a: a.get("status") != 409, "fitted")

    def explained(self, part):
        return self.until(f"/api/parts/{urllib.parse.quote(part, safe='')}/explain", lambda a: a.get("status") != 409, "explained")

    def stream(self, since=0):
        return Stream(self, since)

    def pids(self):
        """All processes below the server: [(pid, parent)]."""
        parents = {}
        for entry in pathlib.Path("/proc").iterdir():
            if entry.name.isdigit():
                try:
                    fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
                    parents[int(entry.name)] = int(fields[1])
                except (OSError, IndexError):
                    pass
        found, grew = {self.process.pid}, True
        while grew:
            more = {p for p, parent in parents.items() if parent in found} - found
            found |= more
            grew = bool(more)
        return [(p, parents[p]) for p in sorted(found - {self.process.pid})]

    def programs(self, word):
        """Processes below the server that have the argument `word`."""
        found = []
        for pid, _ in self.pids():
            try:
                if word.encode() in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0"):
                    found.append(pid)
            except OSError:
                pass
        return found


class Stream:
    """An open event stream; a socket of its own."""
    path = "/api/events"

    def __init__(self, server, since=0):
        self.connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=WAIT)
        self.connection.request("GET", f"{self.path}?since={since}", headers={"X-Nonio-Token": server.token})
        self.answer = self.connection.getresponse()
        self.status = self.answer.status

    def events(self):
        """(id, type, data), one after the other, comments left out."""
        one = {}
        while line := self.answer.readline():
            text = line.decode().rstrip("\n")
            if not text:
                if "event" in one:
                    yield int(one["id"]), one["event"], json.loads(one["data"])
                one = {}
            elif not text.startswith(":"):
                name, _, value = text.partition(": ")
                one[name] = value

    def close(self):
        self.connection.close()


def nonio(*args, expect=0):
    done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=300)
    if expect is not None and done.returncode != expect:
        raise AssertionError(f"{args}: {done.returncode}\n{done.stderr}{done.stdout}")
    return done


def json_of(*args, expect=0):
    return json.loads(nonio(*args, "--json", expect=expect).stdout)


class LiveTest(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="nonio-live-")
        self.site = pathlib.Path(self._folder.name) / "site"
        shutil.copytree(SAMPLES, self.site, symlinks=True)

    def tearDown(self):
        self._folder.cleanup()

    def campaign(self, name):
        return self.site / name
