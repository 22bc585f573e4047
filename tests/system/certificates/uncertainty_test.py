# SPDX-License-Identifier: Apache-2.0
"""Every uncertainty has its whole budget, or there is none and no certificate: the program on samples."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "batch"))
from signing import NONIO, SigningTest  # noqa: E402

SAMPLES = pathlib.Path(os.environ["NONIO_SAMPLES"])
GANTRY, TABLE, STEPS, AXIS = "13-gantry-diagonals", "14-rotary-table", "15-step-diagonal", "09-tolerances"
CIRCLE = "40-circles"
PROBE = ('sphere_um = 0.5\nprobe_um = 1.0\n\n[environment]\ntemperature_range_K = 0.2\ntemperature_difference_K = 0.8\n'
         'expansion_range_um_per_m_K = 1.0\ndrift_um = 0.6\n')
LINEAR = "".join(f'[machine.axes.{a}]\nkind = "linear"\nexpansion_um_per_m_K = 11.5\n\n' for a in "XYZ")


def stated(text):
    """The rotary table with everything that its budget needs."""
    text = re.sub(r"sphere_um.*\n|probe_um.*\n|\[environment\]\n(?:.+\n)+|linear_axes_urad.*\n", "", text)
    text = re.sub(r"\[machine\.axes\.[XYZ]\]\n(?:.+\n)+\n?", "", text)
    text = text.replace("U_per_m_um = 1.0\n", "U_per_m_um = 1.0\n" + PROBE, 1)
    text = text.replace("[instrument]", LINEAR + "[instrument]", 1)
    return text.replace("[options.rotary-kinematics]", "[options.rotary-kinematics]\nlinear_axes_urad = 5.0", 1)


def without(key):
    return lambda text: re.sub(rf"(?m)^{key} = .*\n", "", text)


def put(key, value):
    def change(text):
        assert re.search(rf"(?m)^{key} = ", text), key
        return re.sub(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
    return change


class Uncertainty(SigningTest):
    def sample(self, sample, name, *changes):
        folder = self.site / name
        shutil.copytree(SAMPLES / sample, folder)
        path = folder / "campaign.toml"
        text = path.read_text("utf-8").replace(f'id = "{sample}"', f'id = "{name}"', 1)
        for change in changes:
            text = change(text)
        path.write_text(text, "utf-8")
        return folder

    def evaluation(self, name, plugin, measurement=None):
        return next(a for a in self.results(name)["analyses"]
                    if a["plugin"] == plugin and measurement in (None, a["measurement"]))

    def night(self):
        self.run_nonio("--jobs", "2")

    def U(self, name, plugin, value, measurement=None):
        return self.evaluation(name, plugin, measurement)["values"][value].get("U")

    def test_every_contribution_is_in_the_uncertainty(self):
        """Instrument times 100, 5 K, drift 20 um: each changes U of squareness and of the curves."""
        louder = {"instrument": [put("U_fixed_um", 10.0), put("U_per_m_um", 50.0)],
                  "warm": [put("temperature_difference_K", 5.0)],
                  "sensor": [put("temperature_range_K", 5.0)], "coefficient": [put("expansion_range_um_per_m_K", 20.0)],
                  "drift": [put("drift_um", 20.0)], "askew": [put("misalignment_mm", 50.0)]}
        for sample in (GANTRY, STEPS):
            self.sample(sample, sample)
            for name, changes in louder.items():
                self.sample(sample, f"{sample}-{name}", *changes)
        self.night()
        for sample, plugin, curve in ((GANTRY, "diagonal-straightness", "EYX"), (STEPS, "step-diagonal", "EYX")):
            plain = self.evaluation(sample, plugin)
            self.assertGreater(plain["values"]["C0Y"]["U"], 0.1)  # urad; the scatter alone gave 0.05
            for name in louder:
                loud = self.evaluation(f"{sample}-{name}", plugin)
                self.assertGreater(loud["values"]["C0Y"]["U"], 1.02 * plain["values"]["C0Y"]["U"], (sample, name))
                if name in ("instrument", "drift"):  # of a drift, what the scatter shows already counts once
                    self.assertGreater(max(loud["series"][curve]["U"]), 1.05 * max(plain["series"][curve]["U"]), name)
                self.assertEqual(loud["values"]["C0Y"]["value"], plain["values"]["C0Y"]["value"])

    def test_the_budget_gives_the_uncertainty(self):
        self.sample(GANTRY, "d")
        self.sample(STEPS, "s")
        self.sample(AXIS, "a")
        self.sample(TABLE, "t", stated)
        self.night()
        for name in "dsat":
            for a in self.results(name)["analyses"]:
                if not any("U" in v for v in a.get("values", {}).values()):
                    continue
                budget = a["budget"]
                ids = {c["id"] for c in budget["contributions"]}
                for c in budget["contributions"]:
                    self.assertTrue(c["source"], c)
                    self.assertIn(c["correlation"], ("readings", "walk", "lines", "device"))
                for value, v in a["values"].items():
                    if "U" not in v:
                        continue
                    of = budget["results"][value]
                    self.assertEqual((of["k"], of["unit"]), (v["k"], v["unit"]))
                    self.assertEqual(set(of["u"]), ids)
                    whole = of["k"] * sum(u * u for u in of["u"].values()) ** 0.5
                    self.assertAlmostEqual(whole / v["U"], 1.0, places=6, msg=(name, a["plugin"], value))

    def test_ball_centres(self):
        self.sample(TABLE, "whole", stated)
        self.sample(TABLE, "loud", stated, put("probe_um", 20.0))
        self.night()
        for k in "xyz":
            whole = self.evaluation("whole", "rotary-kinematics", "C")["values"]["centre_" + k]
            # In mm: an instrument of 2 um + 1 um/m cannot place a centre to 1.4 um.
            self.assertGreater(whole["U"], 0.002)
            loud = self.evaluation("loud", "rotary-kinematics", "C")["values"]["centre_" + k]
            self.assertGreater(loud["U"], 3.0 * whole["U"])
            self.assertEqual(loud["value"], whole["value"])
        # What probe and frame have in common for both axes is no distance between them.
        of = [self.evaluation(n, "rotary-kinematics", "B")["values"]["distance_C"]["U"] for n in ("whole", "loud")]
        self.assertAlmostEqual(of[0], of[1], places=9)

    def test_a_contribution_that_was_not_stated(self):
        """Only the repeatability of the fit, under its own name; and no certificate."""
        self.site_toml(self.keys())
        site = self.site / "site.toml"
        site.write_text(site.read_text().replace('outputs = ["pdf-report", "dcc"]', 'outputs = ["certificate"]')
                        .replace('analyses = ["iso230-2"]', ""))
        for name, sample, key in (("d", GANTRY, "drift_um"), ("s", STEPS, "misalignment_mm"), ("t", TABLE, "drift_um")):
            self.sample(sample, name, *([stated] if sample == TABLE else []), without(key))
        self.night()
        for name, plugin, value, key in (("d", "diagonal-straightness", "C0Y", "environment.drift_um"),
                                         ("s", "step-diagonal", "C0Y", "environment.misalignment_mm"),
                                         ("t", "rotary-kinematics", "centre_x", "environment.drift_um")):
            a = self.evaluation(name, plugin)
            self.assertNotIn("U", a["values"][value])
            self.assertGreater(a["values"][value]["repeatability"], 0.0)
            self.assertNotIn("budget", a)
            for s in a["series"].values():
                self.assertNotIn("U", s)
            self.assertTrue(any("repeatability" in s for s in a["series"].values()), name)
            missing = next(f for f in a["findings"] if f["id"] == "uncertainty.no-data")
            self.assertEqual(missing["evidence"]["missing"], key)
            self.assertFalse(list((self.out / name).glob("certificate*")), name)
            self.assertIn(key, (self.out / "summary.txt").read_text() + (self.out / name / "results.json").read_text())

    def test_a_budget_of_zeros_decides_nothing(self):
        zeros = [put(k, "0.0") for k in ("U_fixed_um", "U_per_m_um", "misalignment_mm", "temperature_range_K",
                                         "temperature_difference_K", "expansion_range_um_per_m_K", "drift_um")]
        self.sample(AXIS, "zeros", *zeros)
        self.sample(AXIS, "exact", *zeros[:2])
        self.sample(AXIS, "still", zeros[-1])
        self.night()
        for name in ("zeros", "exact"):
            for a in self.results(name)["analyses"]:
                for v in a["values"].values():
                    self.assertNotIn("U", v)
            for c in self.results(name)["conformity"]:
                self.assertEqual((c["decision"], c["reason"]), ("cannot be decided", "no-uncertainty"))
        still = self.evaluation("still", "iso230-2")
        self.assertIn("U", still["values"]["A"])
        self.assertNotIn("U", still["values"]["B"])
        self.assertIn("uncertainty.zero", [f["id"] for f in still["findings"]])

    def test_limits_are_held_against_the_readings(self):
        folder = self.sample(AXIS, "hot")
        self.sample(AXIS, "cool")
        path = folder / "x.csv"
        rows = path.read_text("utf-8").split("\n")
        head = next(i for i, row in enumerate(rows) if row.startswith("run"))
        columns = rows[head].split(",")
        if "material_c" not in columns:
            rows[head] += ",material_c"
        for i in range(head + 1, len(rows)):
            cells = rows[i].split(",")
            if len(cells) < 3:
                continue
            if "material_c" in columns:
                cells[columns.index("material_c")] = "34.3"
            else:
                cells.append("34.3")
            rows[i] = ",".join(cells)
        path.write_text("\n".join(rows), "utf-8")
        self.night()
        self.assertGreater(self.U("hot", "iso230-2", "A"), 2.0 * self.U("cool", "iso230-2", "A"))
        found = next(f for f in self.evaluation("hot", "iso230-2")["findings"] if f["id"] == "uncertainty.limit-exceeded")
        self.assertEqual(found["evidence"], {"stated_K": 1.5, "found_K": 14.3, "key": "environment.temperature_difference_K"})
        self.assertEqual(found["severity"], "attention")

    def test_the_floor_of_an_accredited_laboratory(self):
        for name, accreditation in (("with", 'accreditation = "LAT 000"\n'), ("none", "")):
            site, out = self.root / name, self.root / f"out-{name}"
            site.mkdir()
            (site / "site.toml").write_text(f'[laboratory]\nname = "L"\n{accreditation}'
                                            '[laboratory.cmc]\nfixed_um = 50.0\nper_m_um = 10.0\n')
            for sample in (AXIS, CIRCLE):
                shutil.copytree(SAMPLES / sample, site / sample)
            subprocess.run([NONIO, "run", str(site), "--out", str(out)], capture_output=True, timeout=300)
            a = next(a for a in self.results(AXIS, out)["analyses"] if a["plugin"] == "iso230-2")
            length = a["budget"]["length_mm"] / 1000.0
            raised = a["values"]["A"]["U"]
            if accreditation:
                self.assertAlmostEqual(raised, 50.0 + 10.0 * length, places=6)
                self.assertIn("uncertainty.cmc", [f["id"] for f in a["findings"]])
                self.assertTrue(all(u >= raised - 1e-9 for u in a["point_U"].values()))
                circle = next(a for a in self.results(CIRCLE, out)["analyses"] if a["plugin"] == "circle")
                self.assertAlmostEqual(circle["values"]["scale_mismatch"]["U"], 50.0 / 0.3 + 10.0, delta=1.0)  # radius 150 mm
            else:
                self.assertLess(raised, 20.0)


if __name__ == "__main__":
    unittest.main()
