# SPDX-License-Identifier: Apache-2.0
"""`nonio live SITE`: the morning, entries, certificates, runs, and the workbench of each campaign."""
import json
import pathlib
import shutil
import urllib.parse

import unittest

from live import LiveTest, SAMPLES, Server, json_of, nonio


class Sites(LiveTest):
    def setUp(self):
        super().setUp()
        self.small = self.site.parent / "small"
        self.small.mkdir()
        shutil.copy(SAMPLES / "site.toml", self.small)
        for name in ("02-constant-reversal", "03-opposed-sinusoids"):
            shutil.copytree(SAMPLES / name, self.small / name)
        shutil.copytree(SAMPLES / "machines", self.small / "machines")
        self.out = self.site.parent / "out"

    def test_the_morning_is_that_of_the_terminal(self):
        nonio("run", self.small, "--out", self.out, "--quiet", "--date", "2026-11-23", expect=None)
        with Server(self.small, "--out", self.out) as s:
            got = s.get("/api/site")
            wanted = json_of("morning", self.out, expect=None)
            self.assertEqual({k: got[k] for k in wanted}, wanted)
            self.assertIn("nonio morning", got["command"])
            state = s.get("/api/site/state")
            self.assertEqual(state["campaigns"], ["02-constant-reversal", "03-opposed-sinusoids"])
            status, headers, page = s.request("GET", "/site/index.html")
            self.assertEqual((status, page), (200, (self.out / "index.html").read_bytes()))
            self.assertEqual(headers["Content-Type"], "application/octet-stream")
            for name in ("..%2Fsummary.json", "summary.json", "%2Fetc%2Fpasswd", "none.html", "..%2F..%2Fsmall%2Fsite.toml"):
                self.assertEqual(s.request("GET", f"/site/{name}")[0], 404, name)
            self.assertEqual(s.request("GET", "/site/index.html", token=False)[0], 403)

    def test_the_workbench_of_a_campaign(self):
        with Server(self.small) as s:
            self.assertIn("open", s.get("/api/state", expect=409)["error"])
            answer = s.post("/api/open", {"campaign": "02-constant-reversal"})
            self.assertEqual(answer["path"], "/c/02-constant-reversal/")
            self.assertEqual(s.request("GET", answer["path"], token=False)[0], 200)
            self.assertEqual(s.opened()["campaign"]["id"], "02-constant-reversal")
            at = "/c/03-opposed-sinusoids/api/"
            s.until(at + "state", lambda state: state.get("bench") == "open", "open")
            s.post(at + "model", {"model": []})
            self.assertEqual(s.get(at + "state")["campaign"]["id"], "03-opposed-sinusoids")
            self.assertEqual(s.fit("Z")["compare"], json_of("compare", self.small / "02-constant-reversal")["parts"][0])
            for wrong in ("none", "../site", "", ".", "02-constant-reversal/..", "/etc"):
                self.assertEqual(s.post("/api/open", {"campaign": wrong}, expect=404)["status"], 404)
                self.assertEqual(s.request("GET", f"/c/{urllib.parse.quote(wrong, safe='')}/api/state")[0], 404, wrong)

    def test_entries_need_edit_and_are_those_of_the_verbs(self):
        event = {"machine": "S-0102", "axis": "Z", "kind": "crash", "text": "--help; $(rm -rf /) 'hit'", "date": "2026-11-01", "by": "-x"}
        with Server(self.small) as s:
            for path, body in (("event", event), ("ack", {}), ("run", {}), ("release", {"campaign": "c", "by": "x"})):
                self.assertIn("--edit", s.post("/api/" + path, body, expect=403)["error"])
        self.assertFalse((self.small / "events.toml").exists())
        with Server(self.small, "--edit") as s:
            answer = s.post("/api/event", event)
            self.assertIn("nonio event", answer["command"])
            told = json_of("event", self.small)["events"]
            self.assertEqual({k: told[0][k] for k in event}, event)
            s.post("/api/ack", {"finding": "reversal.constant", "machine": "S-0102", "until": "2027-01-01", "by": "B. Sample", "why": "nut is ordered"})
            self.assertIn("nut is ordered", (self.small / "acknowledged.toml").read_text())
            self.assertIn("YYYY-MM-DD", s.post("/api/ack", {"finding": "f", "machine": "m", "until": "soon", "by": "b", "why": "w"}, expect=422)["error"])
            self.assertEqual(s.post("/api/event", {"machine": 7}, expect=400)["status"], 400)
            self.assertIn("error", s.post("/api/release", {"campaign": "02-constant-reversal", "by": "B. Sample"}, expect=None) | {"error": ""})

    def test_a_run_with_progress(self):
        with Server(self.small, "--edit", "--out", self.out) as s:
            begun = s.post("/api/run", expect=202)
            self.assertIn("nonio run", begun["command"])
            state = s.until("/api/site/state", lambda state: not state["running"], "done")
            self.assertEqual(state["version"] > 1, True)
            self.assertTrue((self.out / "02-constant-reversal/results.json").exists())
            self.assertEqual(s.get("/api/site")["schema"], "nonio-morning/1")

    def test_the_end_of_the_server_ends_a_run(self):
        s = Server(self.site, "--edit", "--out", self.out)
        s.post("/api/run", expect=202)
        s.end()
        self.assertEqual(s.process.returncode, 0)

    def test_a_dropped_file_is_verified(self):
        with Server(self.small) as s:
            status, _, body = s.request("POST", "/api/verify", b"%PDF-1.7 no certificate", {"Content-Type": "application/pdf"})
            answer = json.loads(body)
            self.assertIn(status, (200, 422), body)
            self.assertFalse(answer.get("holds", False), answer)
            self.assertEqual(s.request("POST", "/api/verify", b"%PDF", {"Content-Type": "application/json"})[0], 415)
        self.assertEqual(list(pathlib.Path("/tmp").glob("nonio-live-??????/certificate")), [])


if __name__ == "__main__":
    unittest.main()
