# SPDX-License-Identifier: Apache-2.0
"""Event streams: what they tell, eight at once, resume, the end of the server."""
import http.client
import pathlib
import signal
import socket
import time
import unittest

from live import SAMPLES, LiveTest, Server

CAMPAIGN = "02-constant-reversal"


class Streams(unittest.TestCase):
    def test_a_change_is_sent_to_all_who_listen(self):
        with Server(SAMPLES / CAMPAIGN) as s:
            s.opened()
            s.fit("Z")
            streams = [s.stream() for _ in range(7)]
            self.assertEqual({t.status for t in streams}, {200})
            told = [t.events() for t in streams]
            version = s.post("/api/model", {"add": "backlash:Z"})["version"]
            for events in told:
                for number, kind, data in events:
                    if kind == "fit" and number >= version:
                        self.assertEqual(data["part"], "Z")
                        break
            self.assertEqual(s.request("GET", "/api/state")[0], 200)
            for t in streams:
                t.close()

    def test_the_ninth_is_refused_with_words_and_others_go_on(self):
        with Server(SAMPLES / CAMPAIGN) as s:
            s.opened()
            streams = [s.stream() for _ in range(9)]
            self.assertEqual([t.status for t in streams], [200] * 8 + [503])
            self.assertIn(b"8 pages", streams[8].answer.read())
            s.get("/api/state")
            for t in streams:
                t.close()

    def test_who_comes_back_gets_what_was_missed(self):
        with Server(SAMPLES / CAMPAIGN) as s:
            s.opened()
            s.fit("Z")
            since = s.get("/api/state")["version"]
            version = s.post("/api/model", {"add": "backlash:Z"})["version"]
            s.fit("Z")
            stream = s.stream(since)
            seen = set()
            for number, kind, _ in stream.events():
                self.assertGreaterEqual(number, since)
                seen.add(kind)
                if {"state", "fit"} <= seen:
                    break
            self.assertGreaterEqual(version, since + 1)
            # A version of an earlier server: everything.
            later = s.stream(10 ** 9)
            self.assertIn(next(later.events())[1], ("state", "fit", "explain", "progress"))
            stream.close()
            later.close()

    def test_a_listener_that_left_makes_room(self):
        with Server(SAMPLES / CAMPAIGN) as s:
            s.opened()
            for _ in range(8):
                gone = s.stream()
                gone.answer.close()
                gone.close()
            deadline = time.monotonic() + 40  # noticed at the next writes
            streams = []
            while len(streams) < 8:
                self.assertLess(time.monotonic(), deadline, "the streams of pages that left were kept")
                s.post("/api/name", {"n": 0, "name": str(time.monotonic())})
                one = s.stream()
                if one.status == 200:
                    streams.append(one)
                else:
                    one.close()
                    time.sleep(0.3)
            for one in streams:
                one.close()

    def test_ten_events_a_second_at_most(self):
        with Server(SAMPLES / CAMPAIGN) as s:
            s.opened()
            s.explained("Z")
            stream = s.stream(s.get("/api/state")["version"])
            for i in range(60):
                s.post("/api/name", {"n": 0, "name": f"step {i}"})
            last = s.get("/api/state")["version"]
            states = 0
            for number, kind, _ in stream.events():
                states += kind == "state"
                if number == last:
                    break
            self.assertLess(states, 60)
            stream.close()


class Ends(unittest.TestCase):
    def end_with(self, number):
        s = Server(SAMPLES / CAMPAIGN)
        s.opened()
        streams = [s.stream() for _ in range(5)]
        below = [pid for pid, _ in s.pids()]
        self.assertTrue(below)
        begun = time.monotonic()
        self.assertEqual(s.end(number), "")
        self.assertLess(time.monotonic() - begun, 5)
        self.assertEqual(s.process.returncode, 0)
        for t in streams:
            t.close()
        deadline = time.monotonic() + 10
        while any(pathlib.Path(f"/proc/{pid}/exe").exists() and "nonio" in pathlib.Path(f"/proc/{pid}/cmdline").read_text() for pid in below):
            self.assertLess(time.monotonic(), deadline, "a process was left behind")
            time.sleep(0.05)

    def test_sigterm_with_open_streams(self):
        self.end_with(signal.SIGTERM)

    def test_sigint_with_open_streams(self):
        self.end_with(signal.SIGINT)

    def test_kill_leaves_no_process_behind(self):
        s = Server(SAMPLES / CAMPAIGN)
        s.opened()
        below = [pid for pid, _ in s.pids()]
        s.process.kill()
        s.process.wait()
        s.process.stdout.close()
        deadline = time.monotonic() + 10
        while any(pathlib.Path(f"/proc/{pid}").exists() and pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX"
                  for pid in below):
            self.assertLess(time.monotonic(), deadline, "a process was left behind")
            time.sleep(0.05)


if __name__ == "__main__":
    unittest.main()
