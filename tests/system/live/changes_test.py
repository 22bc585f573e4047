# SPDX-License-Identifier: Apache-2.0
"""Steps, undo, names; saving with If-Match; a file that another program changes."""
import json
import math
import random
import shlex
import time
import unittest

from live import LiveTest, Server, json_of, nonio

CAMPAIGN = "02-constant-reversal"


class Changes(LiveTest):
    def setUp(self):
        super().setUp()
        self.folder = self.campaign(CAMPAIGN)
        self.manifest = self.folder / "campaign.toml"

    def match(self, server):
        return {"If-Match": f'"{server.get("/api/state")["campaign"]["manifest_sha256"]}"'}

    def test_steps_undo_redo_name_goto(self):
        with Server(self.folder) as s:
            s.opened()
            s.fit("Z")  # one that is left before it is fitted has no figures
            self.assertIn("before", s.post("/api/undo", expect=422)["error"])
            first = s.post("/api/model", {"add": "backlash:Z"})
            self.assertIn("nonio model add", first["command"])
            self.assertIn("backlash:Z", first["command"])
            s.post("/api/model", {"add": "scale:Z"})
            s.post("/api/name", {"n": 2, "name": "both"})
            self.assertIn("nonio model drop", s.post("/api/undo")["command"])
            state = s.get("/api/state")
            self.assertEqual((state["model"], state["at"], state["can_redo"]), (["backlash:Z"], 1, True))
            s.post("/api/redo")
            s.post("/api/goto", {"n": 0})
            self.assertEqual(s.get("/api/state")["model"], [])
            s.post("/api/goto", {"n": 2})
            state = s.get("/api/state")
            self.assertEqual([step["name"] for step in state["steps"]], ["", "", "both"])
            self.assertEqual(state["model"], ["backlash:Z", "scale:Z"])
            s.post("/api/goto", {"n": 1})
            s.post("/api/model", {"model": ["scale:Z"]})
            self.assertEqual([step["model"] for step in s.get("/api/state")["steps"]], [[], ["backlash:Z"], ["scale:Z"]])
            s.fit("Z")
            state = s.get("/api/state")
            self.assertTrue(all("rms_um" in step["parts"]["Z"] for step in state["steps"] if step["n"] in (0, 2)), state["steps"])
            for wrong in ({"add": "backlash:Q"}, {"add": "nothing:Z"}, {"add": "scale:Z"}, {"drop": "backlash:Z"}, {"model": ["scale:Z", "scale:Z"]}):
                self.assertIn("error", s.post("/api/model", wrong, expect=422))
            self.assertEqual(s.post("/api/goto", {"n": 99}, expect=422)["status"], 422)
            self.assertEqual(s.post("/api/exclude", {"part": "Z", "rows": [1], "why": ""}, expect=422)["status"], 422)
            self.assertEqual(s.post("/api/exclude", {"part": "Z", "rows": [100000], "why": "x"}, expect=422)["status"], 422)
            self.assertEqual(s.post("/api/exclude", {"part": "Q", "rows": [1], "why": "x"}, expect=404)["status"], 404)
            self.assertEqual(s.post("/api/cancel", {"job": 77}, expect=404)["status"], 404)
            self.assertEqual(nonio("model", "compare", self.folder, "--json").stdout, nonio("model", "compare", self.folder, "--json").stdout)

    def test_refusals_are_in_the_language_of_the_site(self):
        told, plain = {}, (self.site / "site.toml").read_text()
        for language in ("en", "de", "it"):
            (self.site / "site.toml").write_text(f'language = "{language}"\n' + plain)
            with Server(self.folder) as s:
                self.assertEqual(s.opened()["language"], language)
                s.fit("Z")
                answers = [s.post("/api/undo", expect=422), s.post("/api/redo", expect=422), s.post("/api/model", {"drop": "backlash:Z"}, expect=422),
                           s.post("/api/model", {"add": "nothing:Z"}, expect=422), s.post("/api/goto", {"n": 99}, expect=422),
                           s.post("/api/name", {"n": 0, "name": "x" * 201}, expect=422), s.post("/api/include", {"part": "Z", "rows": [3]}, expect=422),
                           s.post("/api/period", {"axis": "Z", "period_mm": -1}, expect=422), s.post("/api/period", {"axis": "C", "period_mm": 1}, expect=422)]
                s.post("/api/model", {"add": "scale:Z"})
                answers.append(s.post("/api/model", {"add": "scale:Z"}, expect=422))
                told[language] = {a["id"]: a["error"] for a in answers}
                self.assertTrue(all("lang" not in a for a in answers))
        self.assertEqual(len(told["en"]), 10)
        for language in ("de", "it"):
            self.assertEqual(set(told[language]), set(told["en"]))
            self.assertEqual([], [k for k, v in told[language].items() if v == told["en"][k]])

    def test_versions_only_grow(self):
        with Server(self.folder) as s:
            s.opened()
            versions = [s.get("/api/state")["version"]]
            for path, body in (("/api/model", {"add": "scale:Z"}), ("/api/undo", {}), ("/api/redo", {}), ("/api/name", {"n": 0, "name": "x"})):
                versions.append(s.post(path, body)["version"])
            self.assertEqual(versions, sorted(set(versions)))

    def test_saving_is_model_add(self):
        twin = self.site / "twin"
        twin.mkdir()
        for file in self.folder.iterdir():
            (twin / file.name).write_bytes(file.read_bytes())
        nonio("model", "add", twin, "backlash:Z")
        nonio("model", "add", twin, "scale:Z")
        with Server(self.folder, "--edit") as s:
            s.opened()
            s.post("/api/model", {"add": "backlash:Z"})
            s.post("/api/model", {"add": "scale:Z"})
            shown = s.get("/api/save")
            self.assertIn('+effects = ["backlash:Z", "scale:Z"]', shown["diff"])
            self.assertNotIn("effects", self.manifest.read_text())
            self.assertEqual(s.post("/api/save", expect=428)["status"], 428)
            saved = s.post("/api/save", {"why": "nut is worn"}, headers=self.match(s))
            self.assertIn("nonio model add", saved["command"])
            self.assertEqual(self.manifest.read_bytes(), (twin / "campaign.toml").read_bytes())
            mine = [json.loads(l) for l in (self.folder / "model-history.jsonl").read_text().splitlines()]
            theirs = [json.loads(l) for l in (twin / "model-history.jsonl").read_text().splitlines()]
            self.assertEqual([step.pop("why") for step in mine], ["nut is worn"] * 2)
            self.assertEqual(mine, theirs)
            nonio("model", "show", self.folder)  # the history reads well
            state = s.get("/api/state")
            self.assertEqual(state["saved_model"], ["backlash:Z", "scale:Z"])
            self.assertFalse(state["campaign"]["changed_on_disk"])
            self.assertIn("already", s.post("/api/save", expect=422, headers=self.match(s))["error"])
            s.post("/api/undo")
            s.post("/api/save", headers=self.match(s))
            self.assertIn('effects = ["backlash:Z"]', self.manifest.read_text())
            time.sleep(2.5)
            self.assertFalse(s.get("/api/state")["campaign"]["changed_on_disk"])

    def test_a_cause_of_the_library_is_described_added_and_saved(self):
        folder = self.site / "dent"
        folder.mkdir()
        rng = random.Random(7)
        rows = [f"{run},{way},{x},{8 * math.exp(-((x - 320) / 90) ** 2 / 2) + 1.5 * (way == '+') + rng.gauss(0, 0.4):.3f}"
                for run in range(1, 6) for way in "+-" for x in (range(0, 801, 40) if way == "+" else range(800, -1, -40))]
        (folder / "x.csv").write_text("run,direction,target_mm,deviation_um\n" + "\n".join(rows) + "\n")
        manifest = folder / "campaign.toml"
        manifest.write_text('format = 1\n[campaign]\nid = "dent"\ndate = 2026-11-03\n[machine]\nmodel = "M"\n[machine.axes.X]\n'
                            'travel = [0, 800]\n[model]\neffects = ["scale:X", "backlash:X"]\n'
                            '[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n')
        with Server(folder, "--edit") as s:
            s.opened()
            s.fit("X")
            named = s.explained("X")["explain"]["candidates"][0]["effect"]
            self.assertEqual(named, "worn-section:X")
            entry, = [e for e in s.get("/api/state")["catalogue"] if e["effect"] == named]
            self.assertTrue(entry["compensable"], "as its remedy states")
            self.assertEqual(entry["card"]["title"], "Error in one section")
            before = s.fit("X")["compare"]["rms_um"]
            s.post("/api/model", {"add": named})
            self.assertLess(s.fit("X")["compare"]["rms_um"], 0.3 * before)
            s.post("/api/save", headers=self.match(s))
        self.assertIn('"worn-section:X"', manifest.read_text())

    def test_exclusions_and_a_period_are_saved_as_the_verbs_write_them(self):
        twin = self.site / "twin"
        twin.mkdir()
        for file in self.folder.iterdir():
            (twin / file.name).write_bytes(file.read_bytes())
        with Server(self.folder, "--edit") as s:
            s.opened()
            s.post("/api/exclude", {"part": "Z", "rows": [3, 17], "why": "hit by a chip"})
            told = s.post("/api/exclude", {"part": "Z", "rows": [64], "why": "beam # \"interrupted\""})["command"]
            self.assertIn("nonio model exclude", told)
            s.post("/api/period", {"axis": "Z", "period_mm": 7.5})
            s.post("/api/model", {"add": "backlash:Z"})
            command = s.get("/api/state")["command"]
            tried = s.fit("Z")["compare"]
            shown = s.get("/api/save")
            self.assertIn("+exclude = [", shown["diff"])
            self.assertIn("screw_pitch_mm = 7.5", shown["diff"])
            self.assertNotIn("exclude", self.manifest.read_text())
            s.post("/api/save", {"why": "seen on Monday"}, headers=self.match(s))
            # The command that the page has shown does the same on a terminal, byte by byte.
            for one in command.split(" && "):
                words = shlex.split(one)
                self.assertEqual(words[0], "nonio")
                nonio(*[str(twin) if w == self.folder.name or w == str(self.folder) else w for w in words[1:]])
            self.assertEqual(self.manifest.read_text(), (twin / "campaign.toml").read_text())
            history = [json.loads(l) for l in (self.folder / "model-history.jsonl").read_text().splitlines()]
            theirs = [json.loads(l) for l in (twin / "model-history.jsonl").read_text().splitlines()]
            self.assertEqual([step["action"] for step in history], ["exclude", "period", "add"])
            self.assertEqual([step.pop("why") for step in history[1:]], ["seen on Monday"] * 2)
            self.assertEqual(history, theirs)
            self.assertIn("period of Z: 7.50 mm", nonio("model", "show", self.folder).stdout)
            state = s.until("/api/state", lambda state: state["bench"] == "open" and state["excluded"] == [], "read again")
            self.assertEqual((state["model"], state["period_mm"], state["campaign"]["changed_on_disk"]), (["backlash:Z"], {}, False))
            self.assertEqual(state["command"].split()[1:3], ["model", "compare"])
            now = s.fit("Z")["compare"]
            self.assertEqual((now["rms_um"], now["observations"]), (tried["rms_um"], tried["observations"]))
            self.assertEqual(json_of("compare", self.folder)["parts"][0]["rms_um"], tried["rms_um"])
            # A second time: the list grows, the reasons are joined.
            s.post("/api/exclude", {"part": "Z", "rows": [0], "why": "tap"})
            diff = s.get("/api/save")["diff"]
            self.assertIn('interrupted\\"; tap"', diff)
            # Another program changes the manifest: its change is not overwritten.
            self.manifest.write_text(self.manifest.read_text() + "# mine\n")
            self.assertEqual(s.post("/api/save", expect=412, headers=self.match(s))["status"], 412)
            self.assertIn("# mine", self.manifest.read_text())

    def test_a_file_that_changed_is_not_overwritten(self):
        with Server(self.folder, "--edit") as s:
            s.opened()
            old = self.match(s)
            s.post("/api/model", {"add": "backlash:Z"})
            nonio("model", "add", self.folder, "scale:Z")
            text = self.manifest.read_bytes()
            answer = s.post("/api/save", expect=412, headers=old)
            self.assertEqual((answer["yours"], answer["on_disk"]), (["backlash:Z"], ["scale:Z"]))
            self.assertEqual(self.manifest.read_bytes(), text)
            # Nor with the digest of the new file: the page has not read it.
            self.assertEqual(s.post("/api/save", expect=412, headers={"If-Match": f'"{answer["manifest_sha256"]}"'})["status"], 412)
            s.post("/api/save", expect=412, headers={"If-Match": "*"})
            self.assertEqual(self.manifest.read_bytes(), text)
            s.until("/api/state", lambda state: state["campaign"]["changed_on_disk"], "changed on disk")
            s.post("/api/reload", expect=202)
            state = s.until("/api/state", lambda state: state["bench"] == "open" and state["saved_model"] == ["scale:Z"], "read again")
            self.assertEqual((state["model"], state["campaign"]["changed_on_disk"]), (["scale:Z"], False))
            self.assertEqual(s.fit("Z")["compare"]["rms_um"], json_of("compare", self.folder)["parts"][0]["rms_um"])
            s.post("/api/model", {"add": "backlash:Z"})
            s.post("/api/save", headers=self.match(s))
            self.assertEqual(json_of("compare", self.folder)["model"]["effects"], ["scale:Z", "backlash:Z"])

    def test_readings_that_change_are_reported_and_content_decides(self):
        file = self.folder / "z.csv"
        with Server(self.folder) as s:
            s.opened()
            s.fit("Z")
            data = file.read_bytes()
            file.write_bytes(data)  # as it was
            time.sleep(2.5)
            self.assertFalse(s.get("/api/state")["campaign"]["changed_on_disk"])
            stream = s.stream(s.get("/api/state")["version"])
            file.write_bytes(data.replace(b"0.463", b"9.463"))
            for _, kind, told in stream.events():
                if kind == "changed":
                    self.assertTrue(told["changed_on_disk"])
                    break
            stream.close()
            before = s.fit("Z")["compare"]["rms_um"]
            s.post("/api/exclude", {"part": "Z", "rows": [5], "why": "x"})
            s.post("/api/reload", expect=202)
            state = s.until("/api/state", lambda state: state["bench"] == "open" and not state["campaign"]["changed_on_disk"], "read again")
            self.assertEqual(state["excluded"], [])
            self.assertNotEqual(s.fit("Z")["compare"]["rms_um"], before)

    def test_a_broken_file_says_where_and_can_be_mended(self):
        text = self.manifest.read_text()
        with Server(self.folder) as s:
            s.opened()
            self.manifest.write_text(text + "\nnonsense = = 3\n")
            s.until("/api/state", lambda state: state["campaign"]["changed_on_disk"], "changed on disk")
            s.post("/api/reload", expect=202)
            state = s.until("/api/state", lambda state: state["bench"] == "failed", "failed")
            self.assertIn("campaign.toml:", state["bench_error"])
            self.assertEqual(s.get("/api/parts/Z/fit", expect=503)["status"], 503)
            self.manifest.write_text(text)
            s.post("/api/reload", expect=202)
            s.opened()
            s.fit("Z")


if __name__ == "__main__":
    unittest.main()
