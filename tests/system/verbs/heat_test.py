# SPDX-License-Identifier: Apache-2.0
"""Displacements over time: the effects of channels in compare, explain and model add."""
import json
import math
import pathlib
import random
import re
import shutil
import sys
import tempfile
import unittest

from verbs import NONIO, VerbTest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "bench"))
import heat_stories  # noqa: E402

MANIFEST = """format = 1
[campaign]
id = "{id}"
date = 2026-11-03
[machine]
maker = "M"
model = "T"
serial = "1"
structure = "other"
[[measurement]]
id = "warm"
kind = "thermal"
file = "warm.csv"
{more}"""
STEP, ROWS = 30.0, 1500
SAMPLES = pathlib.Path(__file__).resolve().parents[3] / "samples/site"
# The bearing follows the speed and the displacement the bearing.
CAUSES = ("heat:bearing", "heat-slow:bearing", "heat-source:spindle", "heat-source-slow:spindle")


def follow(values, tau):
    """A body that is heated by its surroundings, in small steps: no formula of the program."""
    y, last, out = values[0], values[0], []
    for v in values:
        for k in range(10):
            y += STEP / 10 / tau * (last + (v - last) * (k + 0.5) / 10 - y)
        out.append(y)
        last = v
    return out


def record(seed, sizes):
    """time, displacement, a cause that is recorded, another channel, a speed."""
    rng = random.Random(seed)
    speed, level = [], 0
    while len(speed) < ROWS:
        level = rng.choice([0, 3000, 6000, 9000])
        speed += [level] * rng.randint(80, 200)
    speed = speed[:ROWS]
    bearing = follow([20 + 12 * (s / 9000) ** 2 for s in speed], 700.0)
    hall = [21 + 1.5 * math.sin(2 * math.pi * i / 1100 + 1) + 0.6 * math.sin(2 * math.pi * i / 370) for i in range(ROWS)]
    late = follow(bearing, 1500.0)
    rows = []
    for i in range(ROWS):
        d = [size * (late[i] - late[0]) + rng.gauss(0, 0.05) for size in sizes]
        rows.append([i * STEP, *d, bearing[i] + rng.gauss(0, 0.01), hall[i] + rng.gauss(0, 0.01), speed[i]])
    return rows


def table(rows, displacements):
    head = ["time_s", *[f"{d}_um" for d in displacements], "bearing_c", "hall_c", "spindle_rpm"]
    return "\n".join([",".join(head), *[",".join(f"{v:.4f}" for v in row) for row in rows]]) + "\n"


class Heat(VerbTest):
    def campaign(self, name, rows, displacements=("z",), more=""):
        return self.write(name, MANIFEST.format(id=name, more=more), **{"warm.csv": table(rows, displacements)})

    def write(self, name, manifest, **files):
        folder = self.site / name
        folder.mkdir()
        (folder / "campaign.toml").write_text(manifest)
        for file, text in files.items():
            (folder / file).write_text(text)
        return folder

    def json(self, *arguments, status=0):
        return json.loads(self.nonio(*arguments, "--json", expect=status).stdout)

    def test_the_cause_is_named_added_and_predicts_what_it_has_not_seen(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            rows = record(seed, [3.0])
            half = rows[ROWS * 6 // 10][0]
            seen = self.campaign("seen", rows, more=f"period = [0, {half}]\n")
            unseen = self.campaign("unseen", rows, more=f"period = [{half}, 1e9]\n")
            first = self.json("explain", seen)
            self.assertEqual(first["part"], "warm/z")
            self.assertEqual(first["verdict"]["kind"], "missing")
            self.assertIn(first["verdict"]["effect"], CAUSES)
            before = first["model"]["rms_um"]
            after = self.json("explain", seen, "--auto")
            self.assertLess(after["model"]["rms_um"], 0.1 * before)
            self.assertEqual(after["verdict"]["kind"], "nothing", after["verdict"])
            predicted = self.json("compare", unseen, "--model-of", seen)
            self.assertEqual(predicted["schema"], "nonio-predict/1")
            part, = predicted["parts"]
            self.assertEqual(part["part"], "warm/z")
            self.assertLess(part["rms_um"], 0.1 * part["sd_um"])
            self.assertEqual(part["terms"], len(after["model"]["effects"]))
            kept = self.json("compare", unseen, "--model-of", seen, "--zero", "kept")
            self.assertGreaterEqual(kept["parts"][0]["rms_um"], part["rms_um"] - 1e-9)

    def test_a_tilt_is_modelled_as_a_displacement_is(self):
        """The same numbers in arcsec instead of um; with both in one file each has a measurement."""
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            rows = record(seed, [3.0])
            model = '[model]\neffects = ["heat:bearing", "heat-source:spindle"]\n'
            moved = self.campaign("moved", rows, more=model)
            tilted = self.write("tilted", MANIFEST.format(id="tilted", more=model),
                                **{"warm.csv": table(rows, ("z",)).replace("z_um", "z_arcsec")})
            (um,), (arcsec,) = (self.json("compare", c)["parts"] for c in (moved, tilted))
            self.assertAlmostEqual(arcsec["rms_arcsec"], um["rms_um"], delta=0.01 * um["rms_um"])
            self.assertNotIn("rms_um", arcsec)
            for one, other in zip(um["model"]["parameters"], arcsec["model"]["parameters"]):
                self.assertEqual(other["unit"], one["unit"].replace("um", "arcsec"))
                self.assertLess(abs(other["value"] - one["value"]), 0.02 * abs(one["value"]) + one.get("u", 0))
            self.assertEqual(self.json("explain", tilted)["verdict"]["kind"], self.json("explain", moved)["verdict"]["kind"])
            predicted, = self.json("compare", tilted, "--model-of", tilted)["parts"]
            self.assertLess(predicted["rms_arcsec"], 0.2 * predicted["sd_arcsec"])
            both = [[*row[:2], row[1] / 3, *row[2:]] for row in rows]
            second = '[[measurement]]\nid = "tilt"\nkind = "thermal"\nfile = "warm.csv"\nunit = "arcsec"\n'
            file = {"warm.csv": table(both, ("z", "roll")).replace("roll_um", "roll_arcsec")}
            alone = self.write("alone", MANIFEST.format(id="alone", more=model), **file)
            mixed = self.write("mixed", MANIFEST.format(id="mixed", more=second + model), **file)
            self.assertEqual([p["part"] for p in self.json("compare", alone)["parts"]], ["warm/z"])
            self.assertIn('unit = "arcsec"', self.nonio("show", alone, "--all").stdout)
            z, roll = self.json("compare", mixed)["parts"]
            self.assertEqual(roll["part"], "tilt/roll")
            self.assertAlmostEqual(roll["rms_arcsec"], z["rms_um"] / 3, delta=0.02 * z["rms_um"])
            self.assertNotIn('unit = "arcsec"', self.nonio("show", mixed, "--all").stdout)
            results = self.json("show", mixed)
            values = {name: v for a in results["analyses"] for name, v in a["values"].items()}
            self.assertEqual(values["range_roll"]["unit"], "arcsec")
            self.assertAlmostEqual(values["range_roll"]["value"], values["range_Z"]["value"] / 3, delta=0.01)

    def test_noise_of_a_thermometer_is_no_lag(self):
        """A lag smooths the noise of its channel. Without a lag of the machine the readings fit best without one."""
        seed = random.randrange(10**6)
        rng = random.Random(seed)
        column = [20 + 1.5 * math.sin(i / 170) + 0.8 * math.sin(i / 61) + 2.0 * i / ROWS for i in range(ROWS)]
        rows = [[i * STEP, 5.2 * t + rng.gauss(0, 0.05), t + rng.gauss(0, 0.004)] for i, t in enumerate(column)]
        for lag in (0.0, 600.0):
            late = follow(column, lag) if lag else column
            text = "time_s,y_um,column_c\n" + "".join(f"{a:g},{b + 5.2 * (l - c):.4f},{t:.4f}\n"
                                                      for (a, b, t), l, c in zip(rows, late, column))
            folder = self.write(f"c{lag:g}", MANIFEST.format(id="c", more='[model]\neffects = ["heat:column"]\n'), **{"warm.csv": text})
            part, = self.json("compare", folder)["parts"]
            tau, = (p["value"] for p in part["model"]["parameters"] if p["name"] == "tau")
            self.assertLess(abs(tau - lag), 0.05 * lag + 25, f"seed {seed}")

    def test_several_sensors_do_not_replace_the_one_that_shows_the_cause(self):
        """The nose of a rod: other sensors together follow it nearly, with less noise."""
        seed, runs = random.randrange(10**6), 8
        with tempfile.TemporaryDirectory() as top:
            named = [heat_stories.explain(NONIO, pathlib.Path(top) / str(k), "nose", seed * 1000 + k, False)
                     for k in range(runs)]
        right = sum(answer["verdict"].get("effect") in causes for answer, causes in named)
        self.assertGreaterEqual(right, 6, f"seed {seed}: {[answer['verdict'] for answer, _ in named]}")

    def test_effects_found_predict_left_out_blocks_better_and_are_not_below_their_uncertainty(self):
        """Channels that wander alike, each with a lag of its own, and a cause that was not recorded."""
        for seed in [random.randrange(10**6) for _ in range(4)]:
            rng = random.Random(seed)
            bodies = [follow([row[2] for row in record(seed, [0.0])], tau) for tau in (400, 1500, 2600, 5000)]
            hidden = follow(bodies[3], 9000)
            y = [2.5 * (b - 20) - 1.5 * (c - 20) + 0.8 * (h - 20) for b, c, h in zip(bodies[0], follow(bodies[1], 1800), hidden)]
            text = "time_s,y_um," + ",".join(f"t{k}_c" for k in range(4)) + "\n" + "".join(
                f"{i * STEP:g},{v + rng.gauss(0, 0.05):.4f}," + ",".join(f"{b[i] + rng.gauss(0, 0.02):.4f}" for b in bodies) + "\n"
                for i, v in enumerate(y))
            folder = self.write(f"d{seed}", MANIFEST.format(id="d", more=""), **{"warm.csv": text})
            before = self.json("compare", folder)["parts"][0]["cv_rms_um"]
            together = self.json("explain", folder)["parts"][0]["together"]
            self.write(f"e{seed}", MANIFEST.format(id="e", more=f"[model]\neffects = {json.dumps(together)}\n"), **{"warm.csv": text})
            part, = self.json("compare", self.site / f"e{seed}")["parts"]
            with self.subTest(seed=seed):
                self.assertTrue(together)
                self.assertLess(part["cv_rms_um"], before)
                self.assertFalse([w for w in part["warnings"] if "below its uncertainty" in w], part["warnings"])

    def test_displacements_that_move_together_share_their_effects_and_others_do_not(self):
        rows = record(5, [3.0, -1.5])
        rng = random.Random(6)
        for row in rows:
            row.insert(3, rng.gauss(0, 0.05))
        folder = self.campaign("nest", rows, ("x", "y", "z"))
        entry = self.json("explain", folder)["verdict"]["entry"]
        self.assertIn("/x+y", entry)
        self.assertIn(f"nonio model add {folder} {entry}", self.nonio("explain", folder).stdout)
        answer = self.json("explain", folder, "--auto")
        kinds = {p["part"]: p["verdict"]["kind"] for p in answer["parts"]}
        self.assertEqual(kinds, {"warm/x": "nothing", "warm/y": "nothing", "warm/z": "nothing"})
        text = (folder / "campaign.toml").read_text()
        self.assertIn("/x+y", text)
        self.assertEqual(answer["parts"][0]["cv"]["kind"], "blocks")
        z, = [p for p in answer["parts"] if p["part"] == "warm/z"]
        self.assertEqual(z["model"]["effects"], [])

    def test_a_gain_that_no_body_has_is_said(self):
        rows = record(11, [3.0])
        for row in rows:
            row[2] = 20.0 + (row[2] - 20.0) / 60.0  # a sensor whose scale is wrong: 180 um/K
        folder = self.campaign("gain", rows, more='[model]\neffects = ["heat:bearing"]\n')
        said = self.json("compare", folder)["parts"][0]["warnings"]
        self.assertTrue([s for s in said if "heat:bearing" in s and "aluminium" in s], said)
        usual = self.campaign("usual", record(11, [3.0]), more='[model]\neffects = ["heat:bearing"]\n')
        self.assertFalse([s for s in self.json("compare", usual)["parts"][0]["warnings"] if "aluminium" in s])

    def test_a_temperature_that_no_machine_has_is_refused(self):
        rows = record(12, [3.0])
        for row in rows[700:]:
            row[2] = -273.15  # a broken wire
        folder = self.campaign("broken", rows)
        self.assertIn("warm.csv:1 (bearing_c): expected -60 to 150 degC, or nothing where it was not measured; found -273.15 at "
                      "time_s = 21000", self.nonio("check", folder, expect=1).stdout)

    def test_a_lag_of_a_tenth_of_a_short_test_is_found(self):
        """Four hours are usual, and time constants of half an hour too."""
        seed = random.randrange(10**6)
        rng = random.Random(seed)
        speed = []
        while len(speed) < 480:
            speed += [9000 if len(speed) % 2 == 0 else 0] * (2 * rng.randint(30, 60) + 1)
        body = follow([20 + 12 * (n / 9000) ** 2 for n in speed[:480]], 600.0)
        late = follow(body, 1500.0)
        text = "time_s,y_um,body_c\n" + "".join(f"{i * STEP:g},{3 * (v - late[0]) + rng.gauss(0, 0.05):.4f},{b + rng.gauss(0, 0.01):.4f}\n"
                                               for i, (v, b) in enumerate(zip(late, body)))
        folder = self.write("short", MANIFEST.format(id="short", more='[model]\neffects = ["heat:body"]\n'), **{"warm.csv": text})
        part, = self.json("compare", folder)["parts"]
        found = {p["name"]: p["value"] for p in part["model"]["parameters"]}
        self.assertLess(abs(found["tau"] - 1500), 100, f"seed {seed}")
        self.assertLess(abs(found["g"] - 3), 0.2, f"seed {seed}")

    def test_noise_is_complete_and_an_unrecorded_cause_unknown(self):
        noise = self.campaign("noise", record(7, [0.0]))
        self.assertEqual(self.json("explain", noise)["verdict"]["kind"], "nothing")
        rows = record(8, [0.0])
        for i, row in enumerate(rows):
            row[1] += 4 * math.sin(i / 9.0)
        wave = self.campaign("wave", rows)
        self.assertEqual(self.json("explain", wave)["verdict"]["kind"], "unknown")

    def test_which_channels_matter_and_where_a_thermometer_is_missing(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            rows = record(seed, [3.0])
            answer = self.json("explain", self.campaign("all", rows), "--auto")
            sensors = answer["sensors"]
            self.assertEqual(sensors["recorded"], 3)
            self.assertLessEqual(set(sensors["smallest"]), {"bearing", "spindle"})
            self.assertLessEqual(sensors["cv_rms_smallest_um"], 1.1 * sensors["cv_rms_um"] + 1e-12)
            best = sensors["used"][0]
            self.assertGreater(best["cv_rms_without_um"], 2 * sensors["cv_rms_um"])
            # Without the thermometer the speed takes its place, and the thermometer is missed.
            text = table([[t, z, hall, speed] for t, z, _, hall, speed in rows], ("z",)).replace("bearing_c,", "")
            bare = self.write("bare", MANIFEST.format(id="bare", more=""), **{"warm.csv": text})
            answer = self.json("explain", bare, "--auto")
            self.assertEqual(answer["sensors"]["no_thermometer_for"], "spindle")
            self.assertTrue(any("place one" in says for says in answer["next"]), answer["next"])

    def test_every_confused_pair_has_a_further_test_or_is_said_to_have_none(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            rows = record(seed, [3.0])
            folder = self.campaign("all", rows)
            answer = self.json("explain", folder)
            named = {answer["verdict"]["effect"], *answer["significant"]}
            confused = {(c["effect"], a) for c in answer["candidates"] if c["effect"] in named for a in c["aliases"]}
            self.assertEqual({tuple(p["separates"]) for p in answer["plans"]}, confused)
            whole = rows[-1][0]
            for plan in answer["plans"]:
                if plan["power"] < 4:
                    self.assertEqual((plan["plan"], plan["readings"]), ("none", 0))
                    continue
                self.assertEqual((plan["plan"], plan["of"]), ("other-speeds", "spindle"))
                self.assertAlmostEqual(plan["readings"], plan["duration_s"] / STEP, delta=2)
                self.assertLessEqual(plan["duration_s"], 2 * whole + 60)
                self.assertIn(f"every {plan['every_s'] / 60:.0f} min", plan["says"])
            # Without a speed that could be chosen, no test can be planned.
            text = table([row[:-1] for row in rows], ("z",)).replace(",spindle_rpm", "")
            bare = self.write("bare", MANIFEST.format(id="bare", more=""), **{"warm.csv": text})
            other = self.json("explain", bare)
            self.assertEqual({p["plan"] for p in other["plans"]} - {"no-source"}, set())
            # Several campaigns: one list of all pairs.
            both = self.json("explain", folder, bare)
            self.assertEqual(both["alone"], ["all warm/z", "bare warm/z"])
            self.assertNotIn("left_out", both)
            listed = [(n["campaign"], n["plan"], *n["separates"]) for n in both["next"]]
            expected = [(a["campaign"], p["plan"], *p["separates"]) for a in (answer, other) for p in a["plans"]]
            self.assertCountEqual(listed, expected)

    def test_what_is_known_of_channels(self):
        rows, air = record(21, [2.0]), '[[measurement.channel]]\nname = "hall"\nrole = "air"\n'
        names = lambda folder: {c["effect"] for c in self.json("explain", folder)["candidates"]}
        self.assertIn("heat-difference:bearing-hall", names(self.campaign("open", rows)))
        self.assertNotIn("heat-difference:bearing-hall", names(self.campaign("stated", rows, more=air)))
        wrong = self.campaign("wrong", rows, more=air.replace("hall", "halle"))
        self.assertIn('warm.csv has no channel "halle"; it has bearing, hall, spindle (nearest: "hall")',
                      self.nonio("compare", wrong, expect=1).stderr)
        place = self.campaign("place", rows, more='[[measurement.channel]]\nname = "bearing"\nplace = "front bearing"\n'
                              '[model]\neffects = ["heat:bearing"]\n')
        self.assertTrue(any("bearing (front bearing)" in says for says in self.json("explain", place)["next"]))

    HEAD = "run,direction,target_mm,deviation_um,time_s,bed_c,screw_c,hall_c"

    def runs(self, seed, growth, head=HEAD, warmer=0.0, wander=1.0):
        """Runs of an axis whose screw grows 5 min after its thermometer, which wanders as two others do."""
        rng, late, t, rows = random.Random(seed), None, 0, [head]
        phase = [rng.uniform(0, 6) for _ in range(3)]
        targets = [37.0 * i for i in range(11)]
        for run in range(1, 6):
            for direction in "+-":
                for x in targets if direction == "+" else targets[::-1]:
                    t += 30
                    bed, screw, hall = (20 + warmer + wander * (1.5 * math.sin(t / 900 * (0.5 + 0.4 * k) + phase[k])
                                        + 0.7 * math.sin(t / 333 * (1 + 0.2 * k) + 2 * phase[k])) for k in range(3))
                    late = screw if late is None else late + (screw - late) * -math.expm1(-30 / 300)
                    value = growth * (x - 185) / 1000 * (late - 20) + (1 if direction == "+" else -1) + rng.gauss(0, 0.3)
                    rows.append(f"{run},{direction},{x:g},{value:.4f},{t},{bed:.3f},{screw:.3f},{hall:.3f}")
        return "\n".join(rows) + "\n"

    AXIS = ('format = 1\n[campaign]\nid = "%s"\n[machine.axes.X]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm = "none"\n'
            '[machine.axes.Y]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm = "none"\n')
    ONE = '[[measurement]]\nid = "%s"\nkind = "axis"\naxis = "X"\nfile = "%s.csv"\n'

    def axis(self, name, seed, growth, head=HEAD):
        return self.write(name, self.AXIS % name + self.ONE % ("X", "x"), **{"x.csv": self.runs(seed, growth, head)})

    def two(self, name, first, second, more=""):
        return self.write(name, self.AXIS % name + self.ONE % ("one", "x1") + self.ONE % ("two", "x2") + more,
                          **{"x1.csv": first, "x2.csv": second})

    def part(self, verb, folder):
        answer = self.json(verb, folder)
        return answer["parts"][0] if "parts" in answer else answer

    def test_two_measurements_of_an_axis_have_their_thermometers(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            both = self.two("both", self.runs(seed, 8.0), self.runs(seed + 1, 8.0, warmer=2.0))
            # Each measurement may have a growth of its own: @measurement.
            together = {e.split("@")[0] for e in self.part("explain", both)["together"]}
            self.assertIn("heat-growth:screw", together)
            # A difference of two days is a growth too, even where nothing changed within a day.
            day = self.two("day", self.runs(seed, 8.0, wander=0.05), self.runs(seed + 1, 8.0, warmer=4.0, wander=0.05),
                           '[model]\neffects = ["backlash:X", "heat-growth:screw"]\n')
            model = self.part("compare", day)["model"]["parameters"]
            w, = [p for p in model if p["effect"] == "heat-growth:screw" and p["name"] == "w"]
            self.assertAlmostEqual(w["value"], 8.0, delta=max(4 * w["u"], 0.4))

    def test_a_thermometer_that_one_measurement_lacks_is_refused_by_name(self):
        whole = self.runs(3, 8.0)
        less = "\n".join(",".join(r.split(",")[:6] + r.split(",")[7:]) for r in self.runs(4, 8.0).split("\n"))
        partly = self.two("partly", whole, less)
        self.assertTrue([w for w in self.part("compare", partly)["warnings"] if "screw" in w and "measurement two" in w])
        self.assertFalse([c for c in self.part("explain", partly)["candidates"] if "screw" in c["effect"]])
        self.assertIn("measurement two has no channel screw", self.nonio("model", "add", partly, "heat-growth:screw", expect=2).stderr)
        bare = "\n".join(",".join(r.split(",")[:4]) for r in self.runs(4, 8.0).split("\n"))
        untimed = self.part("compare", self.two("untimed", whole, bare))["warnings"]
        self.assertTrue([w for w in untimed if "time_s" in w and "measurement two" in w], untimed)
        speed = self.axis("speed", 5, 8.0, self.HEAD.replace("hall_c", "hall_rpm"))
        self.assertTrue([w for w in self.part("compare", speed)["warnings"] if "hall" in w and "thermal" in w])

    def circles(self, name, seed, growth, head="direction,angle_deg,deviation_um,run,time_s,screw_c,hall_c"):
        """A ball bar in XY, once in ten minutes; X grows with its screw."""
        rng, rows, radius = random.Random(seed), [head], 150.0
        phase = rng.uniform(0, 6)
        for run in range(1, 13):
            start = 600.0 * run
            for direction in "+-":
                for k in range(72):
                    t = start + k + (100 if direction == "-" else 0)
                    angle = 5.0 * k if direction == "+" else 355.0 - 5.0 * k
                    screw, hall = 22 + 2.5 * math.sin(t / 1500 + phase), 21 + 1.5 * math.sin(t / 900 + 2 * phase)
                    a = math.radians(angle)
                    value = growth * radius * 1e-3 * math.cos(a) ** 2 * (screw - 22) + 2.0 * math.cos(a) + rng.gauss(0, 0.15)
                    rows.append(f"{direction},{angle:g},{value:.4f},{run},{t:g},{screw:.3f},{hall:.3f}")
        text = self.AXIS % name + ('[[measurement]]\nid = "bar"\nkind = "circle"\nplane = "XY"\nradius_mm = 150\n'
                                   'centre = { X = 400, Y = 300 }\nfile = "bar.csv"\n')
        return self.write(name, text, **{"bar.csv": "\n".join(rows) + "\n"})

    def test_a_circle_follows_a_thermometer(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            grows = self.circles("circle", seed, 9.0)
            answer = self.part("explain", grows)
            self.assertIn("heat-growth:screw/X", answer["together"])
            self.nonio("model", "add", grows, "scale:X")  # it was not 22 degC when the first circle was run
            self.nonio("model", "add", grows, "heat-growth:screw/X")
            model = self.part("compare", grows)["model"]["parameters"]
            w, = [p for p in model if p["effect"] == "heat-growth:screw/X" and p["name"] == "w"]
            self.assertAlmostEqual(w["value"], 9.0, delta=max(4 * w["u"], 0.4))
            still = self.part("explain", self.circles("still", seed, 0.0))["together"]
            self.assertFalse([e for e in still if e.startswith("heat")], still)
        head = "direction,angle_deg,deviation_um,run,time_s,materal_c,hall_c"
        self.assertIn('did you mean "material_c"', self.nonio("compare", self.circles("slip", 1, 9.0, head), expect=1).stderr)
        head = "direction,angle_deg,deviation_um,run,humidity_pct,screw_c,hall_c"
        self.assertIn('expected "time_s" next to it', self.nonio("compare", self.circles("no-time", 1, 9.0, head), expect=1).stderr)

    def test_lines_across_the_motion_follow_a_thermometer(self):
        """The general table: Y moves with the hall while X moves."""
        rng = random.Random(7)
        rows = ["X_mm,X_dir,nx,ny,nz,deviation_um,line,run,time_s,hall_c"]
        for i in range(240):
            t, x = 40.0 * i, 50.0 * abs(i % 24 - 12)
            hall = 21 + 1.2 * math.sin(t / 1100) + 0.5 * math.sin(t / 400)
            rows.append(f"{x:g},{'-' if i % 24 < 12 else '+'},0,1,0,{4.0 * (hall - 21) + rng.gauss(0, 0.2):.4f},a,{i // 24 + 1},{t:g},{hall:.3f}")
        text = self.AXIS % "across" + '[[measurement]]\nid = "EYX"\nkind = "observations"\nfile = "eyx.csv"\n'
        folder = self.write("across", text, **{"eyx.csv": "\n".join(rows) + "\n"})
        self.assertIn("heat:hall/Y", self.part("explain", folder)["together"])

    def test_several_deviations_in_a_row_are_refused_by_name(self):
        several = self.axis("several", 1, 8.0, self.HEAD.replace("deviation_um", "one_um").replace("hall_c", "two_um"))
        self.assertIn("a row has one deviation", self.nonio("compare", several, expect=1).stderr)
        stated = (several / "campaign.toml").read_text() + '[options.csv]\ncolumns = ["one_um = deviation_um", "two_um = ignore"]\n'
        (several / "campaign.toml").write_text(stated)
        self.assertIn("heat-growth:screw", self.part("explain", several)["together"])
        wide = self.AXIS % "wide" + (self.ONE % ("X", "x")) + ('reader = "wide-table"\n[options.wide-table]\n'
                                                               'columns = ["target", "1 +", "1 -", "bed_c"]\n')
        folder = self.write("wide", wide, **{"x.csv": "0,0.1,0.2,20.1\n100,0.3,0.5,20.2\n200,0.4,0.2,20.3\n"})
        self.assertIn("row for each reading", self.nonio("compare", folder, expect=1).stderr)

    def test_an_axis_follows_a_thermometer_that_was_recorded_next_to_it(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            together = set(self.json("explain", self.axis("grows", seed, 8.0))["together"])
            self.assertIn("heat-growth:screw", together)
            self.assertIn("backlash:X", together)
            still = self.json("explain", self.axis("still", seed, 0.0))["together"]
            self.assertFalse([e for e in still if e.startswith("heat")], still)

    def test_columns_of_channels_in_runs(self):
        head = "run,direction,target_mm,deviation_um,time_s,bed_c,screw_c,hall_c"
        self.nonio("compare", self.axis("good", 1, 8.0))
        for name, columns, says in (
                ("slip", head.replace("hall_c", "materal_c"), 'unknown column "materal_c"; did you mean "material_c"?'),
                ("twice", head.replace("hall_c", "bed_c"), 'column "bed_c" occurs twice'),
                ("untimed", head.replace("time_s", "run_c").replace("hall_c", "material_c"), 'expected "time_s" next to it')):
            self.assertIn(says, self.nonio("compare", self.axis(name, 1, 8.0, columns), expect=1).stderr)

    def test_a_model_is_edited_and_its_mistakes_are_named(self):
        folder = self.campaign("edit", record(9, [2.0]))
        self.nonio("model", "add", folder, "heat:bearing")
        wrong = self.nonio("model", "add", folder, "heat:bering", expect=2)
        self.assertIn("heat:bearing", wrong.stderr)
        wrong = self.nonio("model", "add", folder, "heat:hall/q", expect=2)
        self.assertIn("no measurement over time has this channel and these displacements", wrong.stderr)

    def test_files_with_gaps_and_without_displacements(self):
        rows = record(10, [2.0])
        text = table(rows, ("z",)).split("\n")
        for i in range(100, 160):
            cells = text[i].split(",")
            cells[2] = ""
            text[i] = ",".join(cells)
        gaps = self.write("gaps", MANIFEST.format(id="gaps", more=""), **{"warm.csv": "\n".join(text)})
        self.assertIn(self.json("explain", gaps)["verdict"]["effect"], CAUSES)
        bare = self.write("bare", MANIFEST.format(id="bare", more=""),
                          **{"warm.csv": "time_s,bearing_c\n0,20\n30,21\n"})
        done = self.nonio("compare", bare, expect=1)
        self.assertIn("a column whose name ends with _um or _arcsec", done.stderr)

    def warnings(self, folder):
        return self.json("compare", folder)["parts"][0]["warnings"]

    def test_interruptions_are_stated_and_not_explained_as_heat(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            whole = record(seed, [3.0])
            gap = self.campaign("gap", whole[:700] + whole[780:], more='[model]\neffects = ["heat:bearing"]\n')
            stated = [w for w in self.warnings(gap) if f"no readings from {700 * STEP - STEP:g} s" in w]
            self.assertEqual(len(stated), 1, stated)
            self.assertIn("longer than the time constant of heat:bearing", stated[0])
            # A speed that changes can move a machine at once.
            steady = [i for i in range(10, ROWS - 10) if len({row[-1] for row in whole[i - 9:i + 9]}) == 1]
            first, second = (min(i for i in steady if i >= after) for after in (650, ROWS * 8 // 10))
            touched = [row[:1] + [row[1] + (12 if i >= first else 0)] + row[2:] for i, row in enumerate(whole)]
            jump = self.campaign("jump", touched)
            self.assertTrue([w for w in self.warnings(jump) if re.match(r"z jumps by 1[123](\.\d)? um between", w)])
            self.assertIn(self.json("explain", jump)["verdict"]["effect"], CAUSES)
            # Unseen readings: each segment has a zero of its own.
            half = whole[ROWS * 6 // 10][0]
            seen = self.campaign("seen", touched, more=f"period = [0, {half}]\n")
            self.nonio("explain", seen, "--auto")
            for i in range(second, ROWS):
                touched[i][1] += 9
            unseen = self.campaign("unseen", touched, more=f"period = [{half}, 1e9]\n")
            part, = self.json("compare", unseen, "--model-of", seen)["parts"]
            self.assertLess(part["rms_um"], 0.1 * part["sd_um"])
            self.assertLess(part["sd_um"], 14)

    def test_a_thermometer_that_fails_is_named_and_no_candidate(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            rng, rows = random.Random(seed), record(seed, [3.0])
            wall = follow([20 + 6 * math.sin(i / 150 + 2) for i in range(ROWS)], 3000.0)
            text = "time_s,z_um,bearing_c,hall_c,spindle_rpm,wall_c,floor_c\n"
            for i, row in enumerate(rows):
                frozen = rows[min(i, 400)][3] + 5
                value = 85.0 if i in (0, 500) else -127.0 if i == 900 else wall[i] + rng.gauss(0, 0.02)
                text += ",".join(f"{v:.4f}" for v in [*row[:3], frozen, row[4], value, 25 - wall[i] / 9 - i / 300]) + "\n"
            folder = self.write("failed", MANIFEST.format(id="failed", more=""), **{"warm.csv": text})
            stated = self.warnings(folder)
            self.assertTrue([w for w in stated if w.startswith("hall keeps the value") and "12000 s" in w], stated)
            self.assertTrue([w for w in stated if w.startswith("wall reads -127") and "in 3 readings" in w], stated)
            answer = self.json("explain", folder)
            names = [c["effect"] for c in answer["candidates"]]
            self.assertFalse([n for n in names if "hall" in n], names)
            self.assertIn("heat:wall", names)
            self.assertIn("the thermometer hall fails", self.nonio("model", "add", folder, "heat:hall", expect=2).stderr)

    def test_the_parameter_of_a_source_relates_to_the_largest_speed_of_its_own_day(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            rng, days = random.Random(seed), []
            for name, levels in (("fast", [0, 3000, 9000]), ("slow", [0, 1500, 3000])):
                speed = [n for _ in range(40) for n in [rng.choice(levels)] * rng.randint(60, 120)][:ROWS]
                speed[:3], speed[200:300] = [0] * 3, [levels[-1]] * 100
                late = follow([(n / 9000) ** 2 for n in speed], 900.0)
                rows = [[i * STEP, 20 * late[i] + rng.gauss(0, 0.05), 20 + rng.gauss(0, 0.01), 20 + rng.gauss(0, 0.01),
                         speed[i]] for i in range(ROWS)]
                days.append(self.campaign(name, rows, more='[model]\neffects = ["heat-source:spindle"]\n'))
            for zero in ("free", "kept"):
                part, = self.json("compare", days[1], "--model-of", days[0], "--zero", zero)["parts"]
                self.assertLess(part["rms_um"], 0.1, zero)
                self.assertGreater(part["inside_U"], 0.9, zero)

    def test_a_model_no_longer_holds_from_its_change_on(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            rows, rng = record(seed, [3.0]), random.Random(seed)
            model = '[model]\neffects = ["heat:bearing"]\n'
            seen = self.campaign("seen", rows, more=model)
            from_row = rng.randint(500, 1100)
            later = [[*row[:1], row[1] + 0.02 * max(0, i - from_row), *row[2:]] for i, row in enumerate(record(seed + 1, [3.0]))]
            part, = self.json("compare", self.campaign("later", later, more=model), "--model-of", seen)["parts"]
            self.assertLess(abs(part["holds_until_s"] - from_row * STEP), 0.06 * ROWS * STEP, part)
            # After an error that ends, the model holds.
            start = [[*row[:1], row[1] + 6 * math.exp(-i / 60), *row[2:]] for i, row in enumerate(record(seed + 2, [3.0]))]
            part, = self.json("compare", self.campaign("start", start, more=model), "--model-of", seen)["parts"]
            self.assertIsNone(part["holds_until_s"], part)
            self.assertLess(part["holds_from_s"], 0.3 * ROWS * STEP, part)

    def test_displacements_that_move_together_have_causes_of_their_own(self):
        seed = random.randrange(10**6)
        with self.subTest(seed=seed):
            rng, rows = random.Random(seed), record(seed, [3.0])
            head = [row[2] for row in rows]  # a bearing, and a housing that it and the hall warm
            housing = [b + 1.5 * (row[3] - rows[0][3]) for b, row in zip(follow(head, 500.0), rows)]
            text = "time_s,x_um,z_um,bearing_c,hall_c,housing_c,spindle_rpm\n"
            for i, row in enumerate(rows):
                d = [1.2 * (housing[i] - housing[0]) + rng.gauss(0, 0.05), 5 * (head[i] - head[0]) + rng.gauss(0, 0.05)]
                text += ",".join(f"{v:.4f}" for v in [row[0], *d, row[2], row[3], housing[i] + rng.gauss(0, 0.01), row[4]]) + "\n"
            folder = self.write("both", MANIFEST.format(id="both", more=""), **{"warm.csv": text})
            found = {p["part"]: p for p in self.json("explain", folder)["parts"]}
            for name, effect in (("warm/x", "heat:housing"), ("warm/z", "heat:bearing")):
                self.assertEqual(found[name]["verdict"]["effect"], effect)
                own = {c["effect"]: c["rms_um"] for c in found[name]["candidates"]}
                self.assertEqual(min(own, key=own.get), effect)

    def test_a_model_predicts_its_own_runs_as_compare_describes_them(self):
        """Groups and channels of both campaigns are in the columns of the prediction."""
        rng, rows, i = random.Random(5), ["time_s,run,direction,target_mm,deviation_um,screw_c"], 0
        screw = follow([20 + 8 * (k > 20) for k in range(400)], 2000.0)
        for run in range(1, 6):
            for sign, targets in (("+", range(0, 801, 80)), ("-", range(800, -1, -80))):
                for x in targets:
                    d = 11 * (screw[i] - screw[0]) * (x - 400) / 1000 - (2 if sign == "-" else 0) + rng.gauss(0, 0.1)
                    rows.append(f"{i * STEP:.0f},{run},{sign},{x},{d:.3f},{screw[i]:.3f}")
                    i += 1
        axis = '[machine.axes.X]\nkind = "linear"\n[[measurement]]\nid = "{0}"\nkind = "axis"\naxis = "X"\nfile = "{0}.csv"\n'
        head = MANIFEST.split("[[measurement]]", maxsplit=1)[0]
        model = '[model]\neffects = [{}]\n'
        grown = self.write("grown", head.format(id="grown") + axis.format("x") + model.format('"backlash:X", "heat-growth:screw"'),
                           **{"x.csv": "\n".join(rows) + "\n"})
        adjusted, text = self.site / "adjusted", '"backlash:X@adjustment", "scale:X"'
        shutil.copytree(SAMPLES.parent / "certificates/adjusted", adjusted)
        file = adjusted / "campaign.toml"
        file.write_text(file.read_text().split("[model]")[0] + model.format(text))
        for campaign in (grown, adjusted):
            described, = self.json("compare", campaign)["parts"]
            predicted, = self.json("compare", campaign, "--model-of", campaign)["parts"]
            self.assertLess(abs(predicted["rms_um"] - described["rms_um"]), 0.03 * described["rms_um"], campaign)
        done = self.nonio("compare", grown, "--model-of", adjusted, expect=2)
        self.assertIn("not grouped by adjustment", done.stderr)

    def test_campaigns_without_a_common_displacement(self):
        one = self.campaign("one", record(11, [2.0]))
        other = self.campaign("other", record(12, [2.0]), ("q",))
        done = self.nonio("compare", other, "--model-of", one, expect=2)
        self.assertIn("one has warm/z, other has warm/q", done.stderr)


if __name__ == "__main__":
    unittest.main()
