# SPDX-License-Identifier: Apache-2.0
"""The page's numbers are those of `nonio model compare --json` and `nonio model explain --json`, for every sample that has readings
of an axis, a line in space or balls: as it is, with a model, with excluded readings and with another period."""
import pathlib
import random
import re
import shutil
import tempfile
import unittest
import urllib.parse

from live import ROOT, SAMPLES, LiveTest, Server, json_of, nonio

# Sentences are in the language of the site on the page and in English in JSON; the samples' site is English.
CAMPAIGNS = sorted(p.parent.name for p in SAMPLES.glob("*/campaign.toml"))


def parts_of(document):
    return {p["axis"]: p for p in document.get("parts", [document])}


class Numbers(LiveTest):
    def same(self, server, folder, explain=True):
        compared = nonio("model", "compare", folder, "--json", expect=None)
        state = server.opened()
        if not compared.stdout.startswith("{"):
            self.assertEqual(state["parts"], [], compared.stderr)
            return 0
        parts = parts_of(json_of("compare", folder, expect=compared.returncode))
        self.assertTrue(set(parts) <= {p["name"] for p in state["parts"]})
        explained = parts_of(json_of("explain", folder, expect=None)) if explain and parts else {}
        for name, wanted in parts.items():
            got = server.fit(name)
            self.assertEqual(got["compare"], wanted, name)
            self.assertEqual(len(got["page"]["residual"]), wanted["observations"])
            # The server may meanwhile notice a file that was changed by another program.
            self.assertGreaterEqual(got["version"], state["version"])
            self.assertLessEqual(got["version"], server.get("/api/state")["version"])
            if name in explained:
                said = server.explained(name)
                mine = {k: v for k, v in said["explain"].items() if k not in ("axis", "measurements")}
                theirs = {k: v for k, v in explained[name].items() if k in mine}
                self.assertEqual(mine, theirs, name)
        return len(parts)

    def test_every_sample(self):
        seen = 0
        for name in CAMPAIGNS:
            with self.subTest(name), Server(self.campaign(name)) as server:
                seen += self.same(server, self.campaign(name))
        self.assertGreater(seen, 12)

    def test_a_model_that_is_tried_is_as_one_that_is_written(self):
        folder = self.campaign("02-constant-reversal")
        with Server(folder) as server:
            server.opened()
            server.post("/api/model", {"add": "backlash:Z"})
            server.post("/api/model", {"add": "scale:Z"})
            nonio("model", "add", folder, "backlash:Z")
            nonio("model", "add", folder, "scale:Z")
            self.same(server, folder)

    def test_what_suggest_and_finish_find_is_what_auto_finds(self):
        for name in ("02-constant-reversal", "03-opposed-sinusoids"):
            folder = self.campaign(name)
            with Server(folder) as server:
                server.opened()
                answer = server.post("/api/finish", expect=None)
                self.assertIn("command", answer)
                state = server.until("/api/state", lambda s: "job" not in s, "finished")
                nonio("model", "explain", folder, "--auto", expect=None)
                self.assertEqual(state["model"], json_of("compare", folder, expect=None)["model"]["effects"])
                self.same(server, folder)

    def test_suggest_takes_one_step(self):
        folder = self.campaign("02-constant-reversal")
        with Server(folder) as server:
            server.opened()
            server.post("/api/suggest", expect=None)
            state = server.until("/api/state", lambda s: "job" not in s, "done")
            self.assertEqual(len(state["steps"]), 2)
            self.assertEqual(state["model"], [json_of("explain", folder)["verdict"]["effect"]])

    def test_excluded_readings_are_as_in_campaign_toml(self):
        folder = self.campaign("02-constant-reversal")
        with Server(folder) as server:
            server.opened()
            server.post("/api/model", {"add": "backlash:Z"})
            server.post("/api/exclude", {"part": "Z", "rows": [3, 17, 64], "why": "hit by a chip"})
            state = server.get("/api/state")
            self.assertEqual([e["row"] for e in state["excluded"]], [3, 17, 64])
            lines = [e["line"] for e in state["excluded"]]
            self.assertIn(f"/02-constant-reversal Z {','.join(map(str, lines))} --why 'hit by a chip'", state["command"])
            text = (folder / "campaign.toml").read_text()
            (folder / "campaign.toml").write_text(text.replace('file = "z.csv"\n', f'file = "z.csv"\nexclude = {lines}\nexclude_reason = "hit by a chip"\n'))
            nonio("model", "add", folder, "backlash:Z")
            self.same(server, folder)
            fit = server.fit("Z")
            self.assertEqual(fit["page"]["row"], [i for i in range(130) if i not in (3, 17, 64)])
            readings = server.get("/api/parts/Z/readings?rows=2,3")["readings"]
            self.assertEqual([r["excluded"] for r in readings], [False, True])
            server.post("/api/include", {"part": "Z", "rows": [3]})
            self.assertEqual(server.fit("Z")["compare"]["observations"], 128)

    def test_another_period_is_as_in_campaign_toml(self):
        folder = self.campaign("02-constant-reversal")
        with Server(folder) as server:
            server.opened()
            server.post("/api/period", {"axis": "Z", "period_mm": 12.5})
            server.post("/api/model", {"add": "periodic:Z"}, expect=None)
            self.assertEqual(server.get("/api/state")["period_mm"], {"Z": 12.5})
            text = (folder / "campaign.toml").read_text()
            (folder / "campaign.toml").write_text(text.replace("screw_pitch_mm = 10.0", "screw_pitch_mm = 12.5"))
            model = server.get("/api/state")["model"]
            for effect in model:
                nonio("model", "add", folder, effect)
            self.same(server, folder)

    def test_series_keep_every_extreme(self):
        folder = self.campaign("02-constant-reversal")
        with Server(folder) as server:
            server.opened()
            page = server.fit("Z")["page"]
            for x, px in (("target", 4), ("run", 3), ("order", 7), ("phase", 5)):
                got = server.get(f"/api/parts/Z/series?x={x}&px={px}")
                self.assertFalse(got["each"])
                self.assertEqual(got["n"], 130)
                self.assertLessEqual(len(got["x"]), px)
                self.assertAlmostEqual(min(got["min"]), min(page["residual"]), 6)
                self.assertAlmostEqual(max(got["max"]), max(page["residual"]), 6)
                for low, row in zip(got["min"], got["min_row"]):
                    self.assertAlmostEqual(low, page["residual"][row], 6)
            each = server.get("/api/parts/Z/series?y=deviation&px=800")
            self.assertTrue(each["each"])
            for y, row in zip(each["max"], each["max_row"]):
                self.assertAlmostEqual(y, page["deviation"][row], 6)
            part = server.get("/api/parts/Z/series?x0=100&x1=400&px=800")
            self.assertEqual(part["n"], sum(100 <= t <= 400 for t in page["target"]))
            self.assertTrue(all(100 <= x <= 400 for x in part["x"]))
            for wrong in ("x=colour", "y=", "px=many", "x0=abc"):
                self.assertIn(server.request("GET", f"/api/parts/Z/series?{wrong}")[0], (400, 422), wrong)

    def long_table(self, runs=5, targets=700):
        """A campaign of more readings than places are looked for in: 7,000, backlash -4 um, seed 20261123."""
        folder, noise = self.site / "long", random.Random(20261123)
        folder.mkdir()
        rows = ["run,direction,target_mm,deviation_um"]
        for run in range(1, runs + 1):
            for way, order in (("+", range(targets)), ("-", reversed(range(targets)))):
                rows += [f"{run},{way},{t * 0.5},{-4 * (way == '-') + 0.01 * t + noise.gauss(0, 0.5):.3f}" for t in order]
        (folder / "x.csv").write_text("\n".join(rows) + "\n")
        (folder / "campaign.toml").write_text(
            'format = 1\n[campaign]\nid = "long"\ncustomer = "Test"\ndate = 2026-11-03\n[machine]\nmodel = "M"\n[machine.axes.X]\n'
            'kind = "linear"\n[model]\neffects = ["scale:X"]\n[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n')
        return folder

    def test_of_many_readings_the_picture_comes_first(self):
        folder = self.long_table()
        with Server(folder) as server:
            server.opened()
            look = server.get("/api/parts/X/look")["page"]
            self.assertEqual(look["residual"], look["deviation"])
            self.assertEqual(look["effects"], [])
            self.same(server, folder)
            since = server.get("/api/state")["version"]
            server.post("/api/model", {"add": "backlash:X"})
            picture = server.until("/api/parts/X/picture", lambda a: a.get("status") != 409, "drawn")
            fit = server.fit("X")
            kinds = []
            for _, kind, data in server.stream(since).events():
                kinds.append(kind)
                if kind == "fit" and data["version"] > since:
                    break
            self.assertIn("picture", kinds)
            # The first answer is final: the whole answer contains all of it.
            self.assertEqual(picture["page"], fit["page"])
            for name in ("rms_um", "cv_rms_um", "noise_floor_um", "model"):
                self.assertEqual(picture["compare"][name], fit["compare"][name], name)
            without_page = server.get("/api/parts/X/fit?page=0")
            self.assertNotIn("page", without_page)
            self.assertEqual(without_page["compare"], fit["compare"])
            nonio("model", "add", folder, "backlash:X")
            self.same(server, folder)

    def test_a_step_back_needs_no_fit(self):
        with Server(self.long_table()) as server:
            server.opened()
            before = server.fit("X")["page"]["residual"]
            server.post("/api/model", {"add": "backlash:X"})
            server.fit("X")
            server.post("/api/undo")
            self.assertEqual(server.fit("X")["page"]["residual"], before)
            series = server.get("/api/parts/X/series?x=order&px=4000&x0=100&x1=199")
            self.assertEqual(series["n"], 100)
            for y, row in zip(series["max"], series["max_row"]):
                self.assertAlmostEqual(y, before[row], 6)

    def test_without_and_fingerprints(self):
        folder = self.campaign("02-constant-reversal")
        nonio("model", "add", folder, "backlash:Z")
        nonio("model", "add", folder, "scale:Z")
        with Server(folder) as server:
            server.opened()
            server.fit("Z")
            without = {w["effect"]: w for w in server.get("/api/parts/Z/without")["without"]}
            self.assertEqual(set(without), {"backlash:Z", "scale:Z"})
            server.post("/api/model", {"drop": "scale:Z"})
            less = server.fit("Z")
            self.assertEqual(without["scale:Z"]["rms_um"], less["compare"]["rms_um"])
            self.assertEqual(without["scale:Z"]["cv_rms_um"], less["compare"]["cv_rms_um"])
            for mine, theirs in zip(without["scale:Z"]["residual"], less["page"]["residual"]):
                self.assertAlmostEqual(mine, theirs, 6)
            server.explained("Z")
            says = {f["effect"]: f["says"] for f in server.get("/api/parts/Z/fingerprints")["fingerprints"]}
            server.post("/api/model", {"add": "scale:Z"})
            page = server.fit("Z")["page"]
            scale = next(e for e in page["effects"] if e["name"] == "scale:Z")["says"]
            for mine, theirs in zip(says["scale:Z"], scale):
                self.assertAlmostEqual(mine, theirs, delta=0.02)  # explain weighs by the noise it has found

    def test_page_and_report_are_those_of_a_run(self):
        folder = self.campaign("02-constant-reversal")
        nonio("model", "add", folder, "backlash:Z")
        site = self.site.parent / "alone"
        (site / "c").mkdir(parents=True)
        shutil.copy(self.site / "site.toml", site)
        for file in folder.iterdir():
            shutil.copy(file, site / "c")
        manifest = site / "c/campaign.toml"
        manifest.write_text(manifest.read_text())
        nonio("run", site, "--out", site.parent / "out", "--quiet", expect=None)
        wanted = sorted((site.parent / "out").rglob("model-Z.html"))
        with Server(site / "c") as server:
            server.opened()
            status, headers, page = server.request("GET", "/api/page/Z")
            self.assertEqual(status, 200, page[:300])
            self.assertIn("attachment", headers["Content-Disposition"])
            if wanted:
                self.assertEqual(page, wanted[0].read_bytes())
            self.assertIn(b"backlash:Z", page)
            status, _, report = server.request("GET", "/api/report")
            self.assertEqual((status, report[:5]), (200, b"%PDF-"))


if __name__ == "__main__":
    unittest.main()
