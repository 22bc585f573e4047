# SPDX-License-Identifier: Apache-2.0
"""nonio compare: figures, places, suspects and their exclusion."""
import csv
import pathlib
import re
import shutil
import statistics
import unittest

from verbs import VerbTest, manifest, readings


SITE = pathlib.Path(__file__).resolve().parents[3] / "samples/site"


class Compare(VerbTest):
    def part(self, *args, **kwargs):
        return self.json_of("compare", self.folder, *args, **kwargs)["parts"][0]

    def test_the_figures_of_a_good_model(self):
        self.campaign(manifest(["scale:X", "backlash:X"]), x=readings(scale=20, backlash=-6))
        whole = self.json_of("compare", self.folder)
        self.assertEqual(whole["schema"], "nonio-compare/1")
        self.assertEqual(whole["model"]["effects"], ["scale:X", "backlash:X"])
        part = whole["parts"][0]
        self.assertEqual(part["axis"], "X")
        self.assertEqual(part["observations"], 66)
        self.assertEqual(part["redundancy"], 63)
        self.assertTrue(0.3 < part["rms_um"] < 0.7, part)
        self.assertTrue(part["rms_um"] < part["cv_rms_um"] < 0.9, part)
        self.assertTrue(0.3 < part["noise_floor_um"] < 0.7, part)
        self.assertGreater(part["noise_floor_u_um"], 0)
        self.assertGreater(part["lack_of_fit"]["p"], 1e-4)
        values = {(p["effect"], p["name"]): p for p in part["model"]["parameters"]}
        for name, truth in ((("backlash:X", "b"), -6), (("scale:X", "a"), 20)):
            p = values[name]
            self.assertLess(abs(p["value"] - truth), 4 * p["u"], p)
        self.assertEqual(values["backlash:X", "b"]["unit"], "um")
        self.assertEqual(part["fails"], [])
        self.assertEqual([w for w in part["warnings"] if not w.startswith("u of scale:X is that of the readings")], [])

    def test_a_fixed_value_is_known_and_the_others_are_fitted_with_it(self):
        """As if the effect had been taken off the readings by hand."""
        data = readings(scale=20, backlash=-6)
        self.campaign(manifest(["backlash:X = -5 um", "scale:X"]), x=data)
        part = self.part()
        self.assertEqual(part["model"]["effects"], ["scale:X", "backlash:X = -5 um"])
        values = {p["effect"]: p for p in part["model"]["parameters"]}
        self.assertEqual((values["backlash:X"]["value"], values["backlash:X"]["u"], values["backlash:X"]["held"]), (-5, 0, True))
        shown = self.nonio("compare", self.folder).stdout
        self.assertRegex(shown, r"backlash:X +b +-5 um  \(held\)")
        off = []
        for line in data.splitlines():
            f = line.split(",")
            if f[0].isdigit():
                f[3] = f"{float(f[3]) + (2.5 if f[1] == '+' else -2.5):.4f}"
            off.append(",".join(f))
        self.campaign(manifest(["scale:X"]), x="\n".join(off) + "\n")
        by_hand = self.part()
        scale = by_hand["model"]["parameters"][0]
        for name in ("value", "u"):
            self.assertAlmostEqual(values["scale:X"][name], scale[name], 6)
        self.assertAlmostEqual(part["rms_um"], by_hand["rms_um"], 6)
        self.campaign(manifest(["backlash:X = -0.005 mm", "scale:X"]), x=data)
        self.assertAlmostEqual(self.part()["rms_um"], part["rms_um"], 9)
        explained = self.json_of("explain", self.folder)
        self.assertNotIn("backlash:X", [c["effect"] for c in explained["candidates"]])
        self.assertGreater(explained["lack_of_fit"]["F"], 1)

    def test_only_a_single_value_can_be_held_and_in_its_unit(self):
        for entry, says in (("backlash:X = -5 kg", "expected a number in um or mm"),
                            ("backlash:X =", "expected a number in um or mm"),
                            ("pitch-curve:X = 3 um", "only an effect with a single value can be held"),
                            ("warm-up:X = 3 um", "only an effect with a single value can be held")):
            self.campaign(manifest([entry]), x=readings())
            self.assertIn(says, self.nonio("compare", self.folder, expect=2).stderr)
        self.campaign(manifest(["backlash:X", "backlash:X = 3 um"]), x=readings())
        self.assertIn('"backlash:X" is given twice', self.nonio("compare", self.folder, expect=2).stderr)

    def test_a_held_value_is_added_and_dropped_by_name(self):
        self.campaign(manifest(["scale:X"]), x=readings(scale=20, backlash=-6))
        self.nonio("model", "add", self.folder, "backlash:X=-6um")
        self.assertIn('effects = ["scale:X", "backlash:X = -6 um"]', self.text())
        self.assertIn("in the model already", self.nonio("model", "add", self.folder, "backlash:X", expect=2).stderr)
        self.nonio("model", "drop", self.folder, "backlash:X")
        self.assertIn('effects = ["scale:X"]', self.text())

    def test_every_reading_with_its_model(self):
        text = manifest(["scale:X", "backlash:X = -6 um"], axes="XC").replace(
            '[machine.axes.C]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm', '[machine.axes.C]\nkind = "rotary"\nactive_table = "none"\nactive_backlash_deg')
        turn = readings(seed=3, axis="deg").replace("deviation_um", "deviation_arcsec")
        self.campaign(text, x=readings(scale=20, backlash=-6), c=turn)
        file = self.folder / "all.csv"
        parts = self.json_of("compare", self.folder, "--csv", file)["parts"]
        rows = list(csv.DictReader(file.open()))
        self.assertEqual(list(rows[0]), ["part", "measurement", "file_line", "target_mm", "target_deg", "run", "direction", "time_s",
                                         "reading_um", "reading_arcsec", "model_um", "model_arcsec", "residual_um", "residual_arcsec", "weight"])
        for name, unit, target in (("X", "um", "mm"), ("C", "arcsec", "deg")):
            read = {(f[0], f[1], float(f[2])): (float(f[3]), float(f[4]), line) for line, f in
                    enumerate((l.split(",") for l in (self.folder / f"{name.lower()}.csv").read_text().splitlines()), 1) if f[0].isdigit()}
            own = [r for r in rows if r["part"] == name]
            self.assertEqual(len(own), len(read))
            for r in own:
                value, time, line = read[r["run"], r["direction"], float(r[f"target_{target}"])]
                self.assertEqual((float(r[f"reading_{unit}"]), float(r["time_s"]), int(r["file_line"])), (value, time, line))
                self.assertAlmostEqual(float(r[f"model_{unit}"]) + float(r[f"residual_{unit}"]), value, 5)
            weight = [float(r["weight"]) for r in own]
            rms = (sum(w * float(r[f"residual_{unit}"]) ** 2 for w, r in zip(weight, own)) / sum(weight)) ** 0.5
            self.assertAlmostEqual(rms, next(p for p in parts if p["axis"] == name)[f"rms_{unit}"], 5)

    def test_what_a_table_would_leave_is_calculated_here_too(self):
        """E, A and R of ISO 230-2 of the readings less scale and backlash, from the file alone."""
        data = readings(seed=7, scale=20, backlash=-6)
        self.campaign(manifest(["scale:X", "backlash:X"]), x=data)
        part = self.part()
        values = {p["name"]: p["value"] for p in part["model"]["parameters"]}
        lines = [line.split(",") for line in data.splitlines() if line and line[0].isdigit()]
        rows = [(1 if f[1] == "+" else -1, float(f[2]), float(f[3])) for f in lines]
        middle = (min(r[1] for r in rows) + max(r[1] for r in rows)) / 2

        def positioning(taken):
            at = {}
            for way, target, deviation in rows:
                at.setdefault(target, {}).setdefault(way, []).append(deviation - taken(way, target))
            mean = {(t, w): statistics.mean(v) for t, ways in at.items() for w, v in ways.items()}
            s = {(t, w): statistics.stdev(v) for t, ways in at.items() for w, v in ways.items()}
            R = [max(2 * s[t, 1] + 2 * s[t, -1] + abs(mean[t, 1] - mean[t, -1]), 4 * s[t, 1], 4 * s[t, -1]) for t in at]
            return {"E_um": max(mean.values()) - min(mean.values()), "A_um": max(mean[k] + 2 * s[k] for k in mean) - min(mean[k] - 2 * s[k] for k in mean), "R_um": max(R)}

        predicted = part["after_table"]
        self.assertEqual(predicted["takes"], ["scale:X", "backlash:X"])
        (test,) = predicted["tests"]
        for name, wanted in (("before", positioning(lambda way, target: 0.0)), ("after", positioning(lambda way, target: values["a"] * (target - middle) / 1000 + values["b"] * way / 2))):
            for key, value in wanted.items():
                self.assertAlmostEqual(test[name][key], value, delta=2e-5 * abs(wanted["E_um"]) + 1e-5, msg=f"{name} {key}")
        self.assertGreater(test["before"]["E_um"], 3 * test["after"]["E_um"])
        left = [d - values["a"] * (t - middle) / 1000 - values["b"] * w / 2 for w, t, d in rows]
        self.assertAlmostEqual(predicted["rms_um"], statistics.pstdev(left), delta=1e-4)
        self.assertAlmostEqual(predicted["rms_before_um"], statistics.pstdev([d for _, _, d in rows]), delta=1e-4)
        shown = self.nonio("model", "compare", self.folder).stdout
        self.assertRegex(shown, r"compensated +RMS [\d.]+ um -> [\d.]+ um, predicted, if a table compensates scale:X, backlash:X\n +X: E [\d.]+ um -> ")

    def test_after_a_table_the_error_of_diagonals_falls(self):
        """Every line has its own zero, before and after: a complete model for a table leaves what its fit leaves."""
        for source, effects in ((SITE / "17-straight-or-square", None), (SITE / "13-gantry-diagonals", ["squareness:XY"])):
            folder = self.site / source.name
            shutil.copytree(source, folder)
            if effects:
                for effect in effects:
                    self.nonio("model", "add", folder, effect)
            for part in self.json_of("compare", folder)["parts"]:
                if "after_table" not in part:
                    continue
                told = part["after_table"]
                with self.subTest(campaign=source.name, effects=told["takes"]):
                    self.assertLess(told["rms_um"], told["rms_before_um"])
                    if set(told["takes"]) == set(part["model"]["effects"]):
                        self.assertAlmostEqual(told["rms_um"], part["rms_um"], delta=0.002 * part["rms_um"])

    def test_the_error_before_a_table_does_not_depend_on_the_model(self):
        """A part is placed anew in the readings that a table would leave: its placement is no error of the machine."""
        folder = self.site / "50-turned-plates"
        shutil.copytree(SITE / "50-turned-plates", folder)
        before, left = [], []
        for effect in (None, "yaw:X", "straightness:EYX"):
            if effect:
                self.nonio("model", "add", folder, effect)
            part, = self.json_of("compare", folder)["parts"]
            before.append(part["after_table"]["rms_before_um"])
            left.append(part["after_table"]["rms_um"])
            if effect:
                self.nonio("model", "drop", folder, effect)
        self.assertAlmostEqual(before[1], before[0], delta=0.001 * before[0])
        self.assertAlmostEqual(before[2], before[0], delta=0.001 * before[0])
        self.assertLess(left[0], before[0])

    def test_no_place_of_a_large_error_is_not_the_absence_of_an_error(self):
        folder = SITE / "49-spindle-sensors"
        part = next(p for p in self.json_of("compare", folder)["parts"] if not p["fails"] and p["rms_um"] > 10 * p["noise_floor_um"])
        printed = self.nonio("model", "compare", folder).stdout
        times = [float(t) for t in re.findall(r"where it fails +no single place: the RMS is ([\d.]+) times the noise floor", printed)]
        self.assertTrue(any(abs(t / (part["rms_um"] / part["noise_floor_um"]) - 1) < 0.005 for t in times), times)

    def test_without_anything_for_a_table_it_says_nothing_of_one(self):
        self.campaign(manifest(["zero-drift:X"]), x=readings())
        self.assertNotIn("after_table", self.part())
        self.assertNotIn("compensated", self.nonio("model", "compare", self.folder).stdout)

    def test_a_campaign_without_parts_says_why(self):
        for verb in ("compare", "explain"):
            told = self.json_of(verb, SITE / "43-spindle", expect=1)
            self.assertEqual(told["parts"], [])
            self.assertRegex(told["errors"][0]["message"], "^effects explain runs of an axis.*: spindle$")

    def test_each_remaining_dependence_is_reported_once_in_addition_to_those_before_it(self):
        self.campaign(manifest([]), x=readings(runs=4, drift=6, wave=3, backlash=-4))
        part = self.part()
        self.assertGreater(sum(place["share"] for place in part["fails"]), 1)  # run and time are nearly one
        self.assertLessEqual(sum(place["rms_um"] ** 2 for place in part["left"]), part["rms_um"] ** 2)
        self.assertGreater(len(part["left"]), 1)
        shown = self.nonio("model", "compare", self.folder).stdout
        self.assertNotIn("%", shown)
        self.assertRegex(shown, r"lack of fit +The residuals far exceed the noise, by [\d.]+ um\.")
        for place in part["left"]:
            self.assertGreaterEqual(place["share"], 0.02)
            self.assertIn(place["says"], shown)

    def test_largest_residual_is_found_again_in_the_file(self):
        data = readings(scale=20).splitlines()
        fields = data[30].split(",")
        fields[3] = f"{float(fields[3]) + 1.9:.4f}"
        data[30] = ",".join(fields)
        self.campaign(manifest(["scale:X"]), x="\n".join(data) + "\n")
        largest = self.part()["largest"]
        self.assertEqual((largest["file"], largest["line"]), ("x.csv", 31))
        self.assertEqual((largest["run"], largest["direction"]), (int(fields[0]), fields[1]))
        self.assertEqual(largest["target_mm"], float(fields[2]))

    def test_what_is_left_changes_sign_with_the_direction(self):
        self.campaign(manifest(["scale:X"]), x=readings(scale=20, backlash=-6))
        fails = self.part()["fails"]
        self.assertEqual(fails[0]["where"], "direction")
        self.assertGreater(fails[0]["share"], 0.9)
        self.assertIn("changes sign with the direction of approach", fails[0]["says"])
        self.assertLess(fails[0]["p"], 0.01)
        shown = self.nonio("model", "compare", self.folder).stdout
        self.assertIn("changes sign with the direction of approach", shown)

    def test_a_value_below_its_uncertainty_is_warned_of(self):
        self.campaign(manifest(["scale:X", "backlash:X"]), x=readings(seed=4, scale=20, backlash=0.0))
        part = self.part()
        b = next(p for p in part["model"]["parameters"] if p["effect"] == "backlash:X")
        self.assertEqual(abs(b["value"]) < 2 * b["u"], bool(part["warnings"]))
        self.assertTrue(part["warnings"][0].startswith("backlash:X"), part["warnings"])

    def test_a_suspect_is_kept_until_it_is_excluded(self):
        data = readings(scale=20).splitlines()
        fields = data[40].split(",")
        fields[3] = "88.0"
        data[40] = ",".join(fields)
        self.campaign(manifest(["scale:X"]), x="\n".join(data) + "\n")
        part = self.part()
        self.assertEqual([s["line"] for s in part["suspects"]], [41])
        self.assertGreater(part["suspects"][0]["minimal_detectable_um"], 0)
        self.assertIn("exclude = [41]", part["suspects"][0]["says"])
        self.assertEqual(part["observations"], 66)
        text = manifest(["scale:X"]).replace('file = "x.csv"\n', 'file = "x.csv"\nexclude = [41]\n')
        self.campaign(text)
        part = self.part()
        self.assertEqual((part["observations"], part["suspects"]), (65, []))
        self.assertIn("x.csv line 41 (88.0 um) is excluded", self.nonio("model", "compare", self.folder).stderr)

    def test_excluding_a_line_without_a_reading_is_an_error(self):
        for line, found in (("[1]", "line 1 of x.csv holds no reading"), ("[999]", "line 999"),
                            ("[0]", "expected line numbers"), ("[2.5]", "expected line numbers")):
            text = manifest([]).replace('file = "x.csv"\n', f'file = "x.csv"\nexclude = {line}\n')
            self.campaign(text, x=readings())
            done = self.nonio("model", "compare", self.folder, expect=None)
            self.assertIn(done.returncode, (1, 2))
            number = text.splitlines().index(f"exclude = {line}") + 1
            self.assertIn(f"campaign.toml:{number}: ", done.stderr)
            self.assertIn(found, done.stderr)

    def test_inseparable_effects_are_an_error_that_names_them(self):
        self.campaign(manifest(["scale:X", "pitch-curve:X", "zero-drift:X", "run-jump:X"]),
                      x=readings(runs=1, targets=[0.0, 50.0]))
        done = self.nonio("model", "compare", self.folder, expect=1)
        self.assertIn(":X", done.stderr)

    def test_every_axis_has_its_part(self):
        self.campaign(manifest(["scale:X", "backlash:Y"], axes="XY"), x=readings(1, scale=9), y=readings(2, backlash=3))
        parts = self.json_of("compare", self.folder)["parts"]
        self.assertEqual([(p["axis"], p["model"]["effects"]) for p in parts],
                         [("X", ["scale:X"]), ("Y", ["backlash:Y"])])


if __name__ == "__main__":
    unittest.main()
