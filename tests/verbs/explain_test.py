# SPDX-License-Identifier: Apache-2.0
"""nonio explain: the JSON of the contract, verdicts, --auto."""
import json
import pathlib
import random
import shutil
import unittest

from verbs import VerbTest, manifest, readings


class Explain(VerbTest):
    def check(self, e):
        """The fields that other programs rely on."""
        self.assertEqual(e["schema"], "nonio-explain/1")
        self.assertEqual(e["campaign"], "c")
        self.assertIsInstance(e["observations"], int)
        self.assertIsInstance(e["model"]["effects"], list)
        self.assertIsInstance(e["model"]["rms_um"], float)
        for failed in e["fails"]:
            self.assertTrue(failed["where"] and failed["says"], failed)
            self.assertTrue(0 <= failed["share"] <= 1, failed)
        scores = []
        for c in e["candidates"]:
            self.assertTrue(c["effect"].endswith(":" + e["axis"]) and c["says"], c)
            self.assertNotIn(c["effect"], e["model"]["effects"])
            self.assertIsInstance(c["aliases"], list)
            self.assertTrue(0 <= c["p"] <= 1 and c["rms_um"] >= 0, c)
            for p in c["parameters"]:
                self.assertTrue(p["name"], p)
                self.assertIsInstance(p["value"], (int, float))
                self.assertIn("unit", p)
            scores.append(c["score"])
        self.assertEqual(scores, sorted(scores, reverse=True))
        self.assertIn(e["verdict"]["kind"], ("missing", "nothing", "unknown", "unrepeatable"))
        self.assertEqual("effect" in e["verdict"], e["verdict"]["kind"] == "missing")
        return e

    def explain(self, *args, **kwargs):
        return self.check(self.json_of("explain", self.folder, *args, **kwargs))

    def test_names_the_missing_effect(self):
        self.campaign(manifest(["scale:X"]), x=readings(scale=20, backlash=-6))
        e = self.explain()
        self.assertEqual(e["verdict"]["kind"], "missing")
        self.assertEqual(e["verdict"]["effect"], "backlash:X")
        best = e["candidates"][0]
        self.assertEqual(best["effect"], "backlash:X")
        b = best["parameters"][0]
        self.assertEqual((b["name"], b["unit"]), ("b", "um"))
        self.assertLess(abs(b["value"] + 6), 4 * b["u"])
        self.assertLess(best["rms_um"], e["model"]["rms_um"] / 3)
        self.assertIn("cv_rms_um", best)
        self.assertIn("cv_rms_um", e["model"])
        self.assertGreater(e["noise_floor_um"], 0)
        self.assertGreater(e["lack_of_fit"]["F"], 10)
        self.assertIn("direction", [f["where"] for f in e["fails"]])
        self.assertTrue(0 <= e["false_alarm_rate"] <= 0.1)
        self.assertGreaterEqual(e["false_alarm_trials"], 1)
        self.assertIn("backlash:X", e["together"])
        shown = self.nonio("explain", self.folder).stdout
        self.assertIn("verdict: missing backlash:X", shown)
        self.assertIn("#####", shown)

    def test_a_complete_model_misses_nothing(self):
        self.campaign(manifest(["scale:X", "backlash:X"]), x=readings(scale=20, backlash=-6))
        e = self.explain()
        self.assertEqual(e["verdict"]["kind"], "nothing")

    def test_the_same_seed_gives_the_same_bytes(self):
        self.campaign(manifest([]), x=readings(backlash=-3))
        first = self.nonio("explain", self.folder, "--json", "--seed", "7").stdout
        self.assertEqual(first, self.nonio("explain", self.folder, "--json", "--seed", "7").stdout)
        self.assertEqual(json.loads(first)["seed"], 7)

    def test_several_axes_lead_with_the_most_severe(self):
        self.campaign(manifest([], axes="XY"), x=readings(1), y=readings(2, backlash=-6))
        e = self.explain()
        self.assertEqual((e["axis"], e["verdict"].get("effect")), ("Y", "backlash:Y"))
        self.assertEqual([p["axis"] for p in e["parts"]], ["X", "Y"])
        self.assertEqual(e["parts"][1]["verdict"], e["verdict"])
        self.assertEqual(e["parts"][0]["verdict"]["kind"], "nothing")

    def test_auto_adds_until_nothing_is_missing(self):
        text = "# mine\n" + manifest(None)
        self.campaign(text, x=readings(scale=30, backlash=-6))
        e = self.explain("--auto")
        self.assertEqual(sorted(e["model"]["effects"]), ["backlash:X", "scale:X"])
        self.assertEqual(e["verdict"]["kind"], "nothing")
        self.assertEqual(len(e["steps"]), 2)
        for step in e["steps"]:
            self.assertLess(step["rms_after_um"], step["rms_before_um"])
        self.assertTrue(self.text().startswith(text))
        history = (self.folder / "model-history.jsonl").read_text().splitlines()
        self.assertEqual([json.loads(line) for line in history], e["steps"])

    def test_auto_shows_each_step(self):
        self.campaign(manifest([]), x=readings(backlash=-6))
        shown = self.nonio("explain", self.folder, "--auto").stdout
        self.assertIn("step 1: backlash:X added", shown)
        self.assertIn("verdict: nothing", shown)

    def grouped(self, **effects):
        """As spreadsheets list them: all runs towards +, then all towards -, ascending, without times."""
        rows = readings(times=False, runs=5, **effects).splitlines()
        head, rows = rows[0], [row.split(",") for row in rows[1:]]
        rows.sort(key=lambda r: (r[1], int(r[0]), float(r[2])))  # "+" sorts before "-"
        return "\n".join([head] + [",".join(r) for r in rows]) + "\n"

    def test_rows_that_no_machine_runs_through_are_no_times(self):
        self.campaign(manifest([]), x=self.grouped(backlash=-6))
        e = self.explain()
        self.assertEqual(e["verdict"].get("effect"), "backlash:X")
        self.assertEqual(e["together"], ["backlash:X"])  # not a drift, nor a jump in the middle of the file
        self.assertIn("there and back", " ".join(e["warnings"]))
        self.campaign(manifest([]), x=self.grouped(drift=8))
        self.assertEqual(self.explain()["verdict"].get("effect"), "zero-drift:X")

    def test_the_order_is_said_in_the_manifest(self):
        text = manifest([])
        said = text.replace('file = "x.csv"', 'file = "x.csv"\norder = "{}"')
        self.campaign(said.format("pendulum"), x=self.grouped(drift=8))
        e = self.explain()
        self.assertEqual((e["verdict"].get("effect"), e["warnings"]), ("zero-drift:X", []))
        self.campaign(said.format("as-listed"), x=self.grouped(drift=8))
        self.assertNotEqual(self.explain()["together"], ["zero-drift:X"])
        self.campaign(said.format("unknown"), x=self.grouped(drift=8))
        e = self.explain()
        names = [c["effect"] for c in e["candidates"]]
        for timely in ("zero-drift:X", "growth-drift:X", "warm-up:X", "run-jump:X"):
            self.assertNotIn(timely, names)
        self.assertIn("nothing is concluded from time", " ".join(e["warnings"]))
        self.campaign(said.format("sideways"), x=self.grouped())
        self.assertIn('"sideways"', self.nonio("explain", self.folder, expect=2).stderr)

    def test_rows_in_another_order_say_the_same_where_they_have_times(self):
        text = readings(scale=20, backlash=-6, drift=4)
        self.campaign(manifest([]), x=text)
        first = self.explain()
        rows = text.splitlines()
        self.campaign(manifest([]), x="\n".join(rows[:1] + sorted(rows[1:])) + "\n")
        self.assertEqual(self.explain(), first)

    def uneven_reversal(self):
        """Five targets, each with a reversal of its own: no effect of the catalogue."""
        rng = random.Random(5)
        rows = ["run,direction,target_mm,deviation_um"]
        reversal = {0: 0, 100: 9, 200: -7, 300: 8, 400: -6}
        for run in range(1, 6):
            for way in (1, -1):
                for target in list(reversal)[::way]:
                    value = reversal[target] * way / 2 + rng.gauss(0, 0.4)
                    rows.append(f"{run},{'+' if way > 0 else '-'},{target},{value:.4f}")
        return "\n".join(rows) + "\n"

    def test_what_no_effect_explains_is_described(self):
        self.campaign(manifest([]), x=self.uneven_reversal())
        e = self.explain()
        self.assertEqual(e["verdict"]["kind"], "unknown")
        described = e["descriptions"]
        self.assertEqual(described[0]["effect"], "free-reversal:X")
        self.assertLess(described[-1]["rms_um"], 1.1 * e["noise_floor_um"])
        self.assertNotIn("free-reversal:X", [c["effect"] for c in e["candidates"]])
        self.assertIn("a description, not a cause", self.nonio("explain", self.folder).stdout)
        for d in described:
            self.nonio("model", "add", self.folder, d["effect"])
        e = self.explain()
        self.assertEqual((e["verdict"]["kind"], e["descriptions"]), ("nothing", []))
        # Beside a description an effect says what it says alone, wherever it stands in the list.
        self.nonio("model", "add", self.folder, "backlash:X")
        self.assertIn("backlash:X", self.explain()["model"]["effects"])

    def test_what_is_certain_is_named_beside_what_is_not(self):
        rows = self.uneven_reversal().splitlines()
        drift = [rows[0]]
        for k, row in enumerate(rows[1:]):
            *cells, value = row.split(",")
            drift.append(",".join(cells + [f"{float(value) + 0.8 * k:.4f}"]))
        self.campaign(manifest([]), x="\n".join(drift) + "\n")
        e = self.explain()
        self.assertIn("zero-drift:X", e["certain"] + [e["verdict"].get("effect")])
        e = self.explain("--auto")
        self.assertIn("zero-drift:X", e["model"]["effects"])
        self.assertEqual(e["verdict"]["kind"], "unknown")
        self.assertEqual(e["descriptions"][0]["effect"], "free-reversal:X")

    def test_one_misread_value_of_15_is_no_contradiction(self):
        rows = readings(runs=3, targets=[0, 100, 200, 300, 400], directions="+").splitlines()
        rows[8] = ",".join(rows[8].split(",")[:3] + ["60", rows[8].split(",")[4]])
        self.campaign(manifest([]), x="\n".join(rows) + "\n")
        e = self.explain()
        self.assertEqual([s["line"] for s in e["suspects"]], [9])
        self.assertEqual(e["verdict"]["kind"], "nothing")

    def test_without_repeats_it_does_not_speak_of_noise(self):
        sample = pathlib.Path(__file__).parents[2] / "samples" / "site" / "06-long-axis"
        shutil.copytree(sample, self.folder, dirs_exist_ok=True)
        shown = self.nonio("explain", self.folder, "--auto").stdout
        self.assertIn("verdict: unknown", shown)  # a wave of 2.6 m that no effect of the catalogue says
        self.assertIn("Nothing was repeated", shown)
        self.assertNotIn("in every run", shown)

    def test_a_mistake_in_the_model_names_line_and_nearest(self):
        text = manifest(["backlsh:X"])
        self.campaign(text, x=readings())
        done = self.nonio("explain", self.folder, expect=2)
        line = next(i for i, t in enumerate(text.splitlines(), 1) if t.startswith("effects"))
        self.assertIn(f"campaign.toml:{line}: ", done.stderr)
        self.assertIn('nearest: "backlash:X"', done.stderr)
        for wrong in ("backlash", "backlash:Q", ":X", "backlash:"):
            self.campaign(manifest([wrong]))
            self.nonio("explain", self.folder, expect=2)

    def test_help_teaches(self):
        for verb in ("compare", "explain"):
            shown = self.nonio(verb, "--help").stdout
            self.assertIn("Example", shown)
        self.nonio("explain", expect=2)
        self.nonio("explain", self.site / "nowhere", expect=2)
        self.nonio("explain", self.site, expect=2)


if __name__ == "__main__":
    unittest.main()
