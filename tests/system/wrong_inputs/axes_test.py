#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Axes whose readings look like a mistake and are none, and axes of which no table may be made: elastic drives are not
accused of a turned sign and get their two columns, drift of two runs is found and no table is written, and a positive
reversal is reported with the causes that the manifest allows."""
import json
import math
import os
import pathlib
import random
import subprocess
import tempfile
import unittest

NONIO = os.environ["NONIO"]
SEED = 20261128
LINEAR = [6.0, 91.0, 205.0, 311.0, 398.0, 502.0, 607.0, 715.0, 794.0]
ROTARY = [0.0, 33.1, 61.4, 90.0, 121.9, 149.3, 180.0, 213.1, 241.4, 270.0, 301.9, 329.3]
HEAD = """format = 1
[campaign]
id = "{id}"
customer = "C"
date = 2026-05-04
[machine]
maker = "M"
model = "X"
serial = "S-{id}"
control = "{control}"
[machine.axes.{axis}]
kind = "{kind}"
travel = [0, {travel}]
active_table = "none"
{more}
[instrument]
U_fixed_um = 0.1
U_per_m_um = 0.5
U_arcsec = 0.2
[environment]
misalignment_mm = 0.5
temperature_range_K = 0.2
temperature_difference_K = 0.2
expansion_range_um_per_m_K = 1.0
drift_um = 0.6
drift_arcsec = 0.2
[[measurement]]
id = "{axis}"
kind = "axis"
axis = "{axis}"
file = "r.csv"
[run]
analyses = ["iso230-2"]
[options.{control}]
{directions}
[options.{control}.axes.{axis}]
{number}
"""
NUMBERED = ("siemens-840d", "fanuc")


class Axes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-axes-")
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.random = random.Random(SEED)
        print("seed", SEED)

    def results(self, name, curve, *, control="siemens-840d", rotary=False, runs=5, scatter=0.25, drift=None, more="",
                directions=False):
        """curve(x, direction), in um or arcsec; drift(share of the test, x). The results, and the files written."""
        targets, axis = (ROTARY, "C") if rotary else (LINEAR, "X")
        number = ("number = 1" if control in NUMBERED else "")
        text = HEAD.format(id=name, control=control, axis=axis, kind="rotary" if rotary else "linear",
                           travel=360 if rotary else 800, number=number,
                           more=("" if rotary else "expansion_um_per_m_K = 11.5\n") + more,
                           directions="directions = true" if directions else "")
        if not number:
            text = text.replace(f"[options.{control}.axes.{axis}]\n", "")
        campaign = self.root / name
        campaign.mkdir()
        (campaign / "campaign.toml").write_text(text)
        rows, taken, of = [], 0, 2 * runs * len(targets)
        for run in range(1, runs + 1):
            for sign in "+-":
                for x in targets if sign == "+" else reversed(targets):
                    value = curve(x, 1 if sign == "+" else -1) + self.random.gauss(0, scatter)
                    rows.append(f"{run},{sign},{x:.4f},{value + (drift(taken / of, x) if drift else 0):.4f}")
                    taken += 1
        head = "run,direction,target_deg,deviation_arcsec" if rotary else "run,direction,target_mm,deviation_um"
        (campaign / "r.csv").write_text(head + "\n" + "\n".join(rows) + "\n")
        out = self.root / "out" / name
        done = subprocess.run([NONIO, "run", str(campaign), "--out", str(out), "--quiet"], capture_output=True, text=True,
                              timeout=300)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        results = next(out.rglob("results.json"))
        return json.loads(results.read_text()), sorted(f.name for f in results.parent.iterdir())

    @staticmethod
    def findings(results):
        return {f["id"] for a in results["analyses"] for f in a["findings"]}

    def tables(self, files, control):
        return [f for f in files if f.startswith(control)]

    def test_elastic_rotary_axes_are_not_accused(self):
        for control in ("heidenhain-tnc", "siemens-840d"):
            for amplitude, mean in ((2.8, 0.0), (2.8, -4.0), (4.0, 0.0)):
                with self.subTest(control=control, amplitude=amplitude, mean=mean):
                    results, files = self.results(
                        f"opposed-{control}-{amplitude}-{-mean}", rotary=True, control=control, directions=True,
                        curve=lambda x, d: d * (amplitude * math.sin(math.radians(x)) + mean / 2), more="active_backlash_deg = 0.0")
                    found = self.findings(results)
                    self.assertNotIn("plausibility.pass-sign-turned", found)
                    self.assertNotIn("plausibility.pass-order-turned", found)
                    self.assertIn("reversal.elastic", found)
                    self.assertTrue(self.tables(files, control), files)

    def test_elastic_linear_axes_are_not_accused(self):
        shapes = {"both-ends": lambda x: 8 * x * (800 - x) / 160000, "sine": lambda x: 2.8 * math.sin(2 * math.pi * x / 800)}
        for shape, half in shapes.items():
            for slope in (0.0, 5.0):
                with self.subTest(shape=shape, slope=slope):
                    results, _ = self.results(f"{shape}-{slope}", more="active_backlash_mm = 0.0",
                                              curve=lambda x, d: slope * x / 800 + d * half(x))
                    wrong = {i for i in self.findings(results) if i.startswith("plausibility.pass-")}
                    self.assertEqual(wrong, set())
                    self.assertNotIn("table.withheld", json.dumps(results))
                    if slope:  # in common to both directions: no file with a turned sign has it
                        self.assertNotIn("plausibility.directions-opposed", self.findings(results))

    def test_local_lost_motion_on_a_good_pitch_is_not_called_a_wrong_file(self):
        results, files = self.results("local", lambda x, d: d * (6 * math.exp(-((x - 300) / 120) ** 2) + 1), more="active_backlash_mm = 0.0")
        found = self.findings(results)
        self.assertIn("plausibility.direction-turned", found)
        self.assertEqual({i for i in found if i.startswith("plausibility.pass-")}, set())
        self.assertEqual(self.tables(files, "siemens-840d"), [])

    def test_one_pass_with_the_other_sign_is_found(self):
        odd = [0]

        def curve(x, d):
            odd[0] += 1
            turned = 2 * len(LINEAR) < odd[0] <= 3 * len(LINEAR)
            return (-1 if turned else 1) * (12 * math.exp(-((x - 300) / 120) ** 2) + 4 * d)
        results, files = self.results("one-pass", curve, more="active_backlash_mm = 0.0")
        self.assertIn("plausibility.pass-sign-turned", self.findings(results))
        self.assertEqual(self.tables(files, "siemens-840d"), [])

    def test_no_table_from_two_runs_that_drift(self):
        for control in ("siemens-840d", "heidenhain-tnc", "fanuc", "linuxcnc"):
            for name, drift in (("parallel", lambda t, x: 10 * t), ("wedge", lambda t, x: 10 * t * x / 800)):
                with self.subTest(control=control, drift=name):
                    results, files = self.results(f"{name}-{control}", control=control, runs=2, scatter=0.3, drift=drift,
                                                  curve=lambda x, d: 10 * x / 800 - d, more="active_backlash_mm = 0.0")
                    self.assertIn("drift." + name, self.findings(results))
                    self.assertEqual(self.tables(files, control), [])
                    B = results["analyses"][0]["values"]["B_mean"]
                    self.assertLessEqual(abs(B["value"] - -2.0), B["U"])

    def test_no_backlash_value_of_two_runs_whose_passes_shift(self):
        shifts = (0.0, 3.3, 6.7, 10.0)
        for control in ("siemens-840d", "heidenhain-tnc", "fanuc", "linuxcnc"):
            with self.subTest(control=control):
                results, files = self.results(f"steps-{control}", control=control, runs=2, scatter=0.3,
                                              drift=lambda t, x: shifts[int(4 * t)], more="active_backlash_mm = 0.0",
                                              curve=lambda x, d: 10 * math.sin(x / 150) - d)
                B = results["analyses"][0]["values"]["B_mean"]
                self.assertLessEqual(abs(B["value"] - -2.0), B["U"])
                found = {f["id"]: f for t in results["tables"] for f in t.get("findings", [])}
                held = found["table.backlash-not-identifiable"]
                self.assertEqual(held["severity"], "attention")
                self.assertAlmostEqual(held["evidence"]["mean_um"], B["value"], places=6)
                self.assertAlmostEqual(held["evidence"]["U_um"], B["U"], places=6)
                self.assertTrue(self.tables(files, control), files)  # the pitch
                for p in (p for t in results["tables"] for p in t.get("predictions", []) if p["name"] == "B"):
                    self.assertAlmostEqual(p["before"], p["predicted"], places=3)
                left = [f["evidence"]["left_um"] for f in results["analyses"][0]["findings"] if "left_um" in f["evidence"]]
                self.assertTrue(all(v >= B["U"] - 1e-6 for v in left), (left, B))

    def test_positive_reversal(self):
        for name, more, wanted in (("none", "active_backlash_mm = 0.0", "reversal.positive-uncompensated"),
                                   ("active", "active_backlash_mm = 0.02", "reversal.over-compensated"),
                                   ("unknown", "", "reversal.positive")):
            with self.subTest(active=name):
                results, _ = self.results("positive-" + name, lambda x, d: 5 * x / 800 + 4 * d, more=more)
                self.assertEqual({f for f in self.findings(results) if f.startswith("reversal.")}, {wanted})


if __name__ == "__main__":
    unittest.main()
