# SPDX-License-Identifier: Apache-2.0
"""What goes wrong in the processes that calculate costs one answer: a plugin that crashes, one that never ends, a process
that is killed; a newer request cancels an older one."""
import json
import os
import pathlib
import signal
import time
import unittest

from live import LiveTest, Server

PLUGINS = pathlib.Path(os.environ["NONIO_LIVE_PLUGINS"])
CAMPAIGN = "02-constant-reversal"


class Crashes(LiveTest):
    def test_a_plugin_that_crashes_costs_one_answer(self):
        with Server(self.campaign(CAMPAIGN), "--plugin-path", PLUGINS / "crashes") as s:
            s.opened()
            good = s.fit("Z")["compare"]
            said = s.explained("Z")
            self.assertIn("signal 11", said["error"])
            s.post("/api/model", {"add": "crashing:Z"})
            bad = s.fit("Z")
            self.assertEqual(bad["status"], 422)
            self.assertIn("signal 11", bad["error"])
            state = s.get("/api/state")
            self.assertEqual(state["parts_state"]["Z"]["fit"], "failed")
            self.assertIn("signal 11", state["parts_state"]["Z"]["error"])
            self.assertEqual(state["bench"], "open")
            s.post("/api/undo")
            self.assertEqual(s.fit("Z")["compare"], good)
            self.assertIn("error", s.post("/api/suggest", expect=None) | {"error": ""})

    def test_a_plugin_that_never_ends_is_cancelled_by_a_newer_request(self):
        with Server(self.campaign(CAMPAIGN), "--plugin-path", PLUGINS / "hangs") as s:
            s.opened()
            good = s.fit("Z")["compare"]
            processes = len(s.pids())
            for _ in range(5):
                s.post("/api/model", {"add": "hanging:Z"})
                s.until("/api/state", lambda state: state["parts_state"]["Z"]["fit"] == "running", "running")
                s.post("/api/undo")
                self.assertEqual(s.fit("Z")["compare"], good)
            deadline = time.monotonic() + 10
            while len(s.pids()) > processes + 1:
                self.assertLess(time.monotonic(), deadline, "cancelled work goes on")
                time.sleep(0.1)

    def test_one_that_takes_too_long_is_ended(self):
        site = self.site / "site.toml"
        text = site.read_text()
        self.assertIn("seconds = 60\n", text)
        site.write_text(text.replace("seconds = 60\n", "seconds = 2\n"))
        with Server(self.campaign(CAMPAIGN), "--plugin-path", PLUGINS / "hangs") as s:
            s.opened()
            s.fit("Z")
            s.post("/api/model", {"add": "hanging:Z"})
            bad = s.fit("Z")
            self.assertEqual(bad["status"], 422)
            self.assertIn("within 2 s", bad["error"])

    def test_what_the_server_starts_has_a_limit_of_time(self):
        (self.site / "site.toml").write_text("[limits]\nseconds = 2\n")
        with Server(self.site, "--plugin-path", PLUGINS / "hangs") as s:
            status, _, answer = s.request("POST", "/api/preview", json.dumps({"name": "x.csv"}) + "\nHANGS\n", {"Content-Type": "application/octet-stream"})
            self.assertEqual(422, status, answer)
            self.assertIn("within 2 s", json.loads(answer)["error"])
            deadline = time.monotonic() + 10  # the plugin's own process dies with its parent, a moment later
            while s.programs("check"):
                self.assertLess(time.monotonic(), deadline, "it goes on")
                time.sleep(0.02)

    def test_the_bench_process_is_made_anew(self):
        with Server(self.campaign(CAMPAIGN)) as s:
            s.opened()
            good = s.fit("Z")["compare"]
            s.post("/api/model", {"add": "backlash:Z"})
            s.fit("Z")
            s.explained("Z")
            time.sleep(2.5)
            launcher = next(pid for pid, parent in s.pids() if parent == s.process.pid)
            for _ in range(2):
                bench = next(pid for pid, parent in s.pids() if parent == launcher)
                inner = next(pid for pid, parent in s.pids() if parent == bench)
                os.kill(inner, signal.SIGKILL)
                deadline = time.monotonic() + 20
                while pathlib.Path(f"/proc/{inner}").exists() and time.monotonic() < deadline:
                    time.sleep(0.02)
                s.opened()
                self.assertEqual(s.get("/api/state")["model"], ["backlash:Z"])
                s.post("/api/undo")
                self.assertEqual(s.fit("Z")["compare"], good)
                s.post("/api/redo")
                s.explained("Z")
                # The server may learn of the death this late; it says so, and the next answer is whole.
                s.until("/api/parts/Z/readings?rows=0", lambda a: a.get("n") == 130, "read again")
                time.sleep(2.5)

    def test_a_fit_that_is_killed_fails_alone(self):
        with Server(self.campaign(CAMPAIGN), "--plugin-path", PLUGINS / "hangs") as s:
            s.opened()
            s.fit("Z")
            before = {pid for pid, _ in s.pids()}
            s.post("/api/model", {"add": "hanging:Z"})
            s.until("/api/state", lambda state: state["parts_state"]["Z"]["fit"] == "running", "running")
            for pid in {pid for pid, _ in s.pids()} - before:
                os.kill(pid, signal.SIGKILL)
            self.assertIn("signal 9", s.fit("Z")["error"])
            s.post("/api/undo")
            self.assertIn("compare", s.fit("Z"))

    def test_newer_zooms_replace_older_ones(self):
        with Server(self.campaign(CAMPAIGN)) as s:
            s.opened()
            s.fit("Z")
            for i in range(30):
                self.assertEqual(s.get(f"/api/parts/Z/series?px=20&x0={i}")["version"], s.get("/api/state")["version"])


if __name__ == "__main__":
    unittest.main()
