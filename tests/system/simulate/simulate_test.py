# SPDX-License-Identifier: Apache-2.0
"""nonio model simulate, then nonio run: what was put in comes out."""
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

NONIO, SAMPLE = os.environ["NONIO"], pathlib.Path(os.environ["SAMPLE"])


def nonio(*words):
    return subprocess.run([NONIO, *map(str, words)], capture_output=True, text=True, check=False)


class Simulate(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        self.campaign = self.root / "site" / "worn-screw"
        self.addCleanup(self.folder.cleanup)

    def simulate(self, *words, spec=SAMPLE, expect=0):
        done = nonio("model", "simulate", spec, "--out", self.campaign, *words)
        self.assertEqual(done.returncode, expect, done.stderr)
        return done

    def spec(self, old, new):
        path = self.root / "spec.toml"
        text = SAMPLE.read_text(encoding="utf-8")
        self.assertIn(old, text)
        path.write_text(text.replace(old, new, 1), encoding="utf-8")
        return path

    def contents(self):
        return {p.name: p.read_bytes() for p in self.campaign.iterdir()}

    def test_it_can_be_run(self):
        self.simulate(spec=self.spec('[[effect]]\nname = "run-jump:X"\nj_um = 3.0\ninstant_s = 700.0\n', ""))
        self.assertEqual(set(self.contents()), {"campaign.toml", "x.csv"})
        done = nonio("run", self.root / "site", "--out", self.root / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        results = json.loads((self.root / "out" / "worn-screw" / "results.json").read_text("utf-8"))
        values = next(a for a in results["analyses"] if a["plugin"] == "iso230-2")["values"]
        # 0.6 um of noise, 20 targets x 5 runs a direction: u = 0.6 sqrt(2/100); misreadings of up
        # to 24 um in 2 % of the readings add as much again.
        self.assertAlmostEqual(values["B_mean"]["value"], -6.0, delta=1.2)

    def test_same_seed_same_bytes(self):
        self.simulate()
        first = self.contents()
        truth = self.root / "site" / "worn-screw.truth.json"
        told = truth.read_bytes()
        self.simulate()
        self.assertEqual(self.contents(), first)
        self.assertEqual(truth.read_bytes(), told)
        self.simulate(spec=self.spec("seed = 7", "seed = 8"))
        self.assertNotEqual(self.contents()["x.csv"], first["x.csv"])

    def test_the_truth_is_apart(self):
        done = self.simulate("--truth", self.campaign / "truth.json", expect=2)
        self.assertIn("truth would lie in the campaign", done.stderr)
        self.assertFalse(self.campaign.exists())
        self.simulate("--truth", self.root / "truth.json", "--json")
        truth = json.loads((self.root / "truth.json").read_text(encoding="utf-8"))
        self.assertEqual([e["effect"] for e in truth["effects"]], ["backlash:X", "warm-up:X", "run-jump:X"])
        self.assertEqual(truth["effects"][0]["parameters"], [{"name": "b", "value": -6.0, "unit": "um"}])
        lines = (self.campaign / "x.csv").read_text(encoding="utf-8").splitlines()
        self.assertTrue(truth["measurements"][0]["misread"])
        for misread in truth["measurements"][0]["misread"]:
            self.assertGreater(abs(float(lines[misread["line"] - 1].split(",")[3])), 0.6)
        for text in self.contents().values():
            self.assertNotIn(b"backlash", text)

    FORMULA = """
[[{table}.formula]]
name = "sag"
axis = "X"
expression = "a*cos(2*_pi*p/P)"
parameters = [{{ name = "a", unit = "um" }},
              {{ name = "P", unit = "mm", start = 700, range = [500, 1500] }}]
[[effect]]
name = "sag:X"
a_um = 4.5
P_mm = 730.0
"""

    def with_formula(self, table, old="", new=""):
        path = self.root / "formula.toml"
        text = SAMPLE.read_text(encoding="utf-8") + self.FORMULA.format(table=table)
        self.assertIn(old, text)
        path.write_text(text.replace(old, new) if old else text, encoding="utf-8")
        return path

    def test_a_formula_of_the_users_is_an_effect(self):
        self.simulate("--truth", self.root / "truth.json", spec=self.with_formula("model"))
        truth = json.loads((self.root / "truth.json").read_text(encoding="utf-8"))
        self.assertEqual(truth["effects"][-1]["parameters"], [{"name": "a", "value": 4.5, "unit": "um"},
                                                              {"name": "P", "value": 730.0, "unit": "mm"}])
        self.assertIn(b"expression", self.contents()["campaign.toml"])
        found = json.loads(nonio("model", "explain", self.campaign, "--auto", "--json").stdout)
        of_it = {p["name"]: p for p in found["model"]["parameters"] if p["effect"] == "sag:X"}
        for name, value in (("a", 4.5), ("P", 730.0)):
            self.assertLess(abs(of_it[name]["value"] - value), 4 * of_it[name]["u"], of_it)

    def test_a_formula_of_the_simulation_stays_hidden(self):
        self.simulate(spec=self.with_formula("model"))
        shown = self.contents()
        self.simulate(spec=self.with_formula("simulation"))
        self.assertEqual(self.contents()["x.csv"], shown["x.csv"])
        self.assertNotIn(b"expression", self.contents()["campaign.toml"])

    def test_a_wrong_formula_is_refused(self):
        for old, new, says in (('"sag:X"', '"sg:X"', 'nearest: "sag"'), ("P_mm", "P_um", "P_um"),
                               ("a_um = 4.5", "", "a_um is missing"), ("cos(2*_pi*p/P)", "cos(p)", "simulation.formula"),
                               ('name = "sag"', 'name = "scale"', "there is an effect of this name")):
            done = self.simulate(spec=self.with_formula("simulation", old, new), expect=2)
            self.assertIn(says, done.stderr)
            self.assertRegex(done.stderr, r"formula.toml, line \d+: ")
        self.assertFalse(self.campaign.exists())

    def test_a_measured_campaign_is_left_alone(self):
        self.campaign.mkdir(parents=True)
        (self.campaign / "campaign.toml").write_text("format = 1\n", encoding="utf-8")
        done = self.simulate(expect=2)
        self.assertIn("not simulated", done.stderr)
        self.assertEqual(self.contents(), {"campaign.toml": b"format = 1\n"})

    def test_a_wrong_specification_leaves_nothing(self):
        done = self.simulate(spec=self.spec("backlash:X", "backlsh:X"), expect=2)
        self.assertRegex(done.stderr, r'spec.toml, line \d+: effect.name: .*nearest: "backlash"')
        self.assertFalse(self.campaign.exists())

    def test_help_teaches(self):
        done = nonio("model", "simulate", "--help")
        self.assertEqual(done.returncode, 0)
        for word in ("[[effect]]", "[[cycle]]", "--truth", "Example"):
            self.assertIn(word, done.stdout)


class EveryKind(unittest.TestCase):
    """A machine with every kind of measurement: what the truth holds comes out, within U."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.root = pathlib.Path(cls.folder.name)
        spec = SAMPLE.with_name("machining-centre.toml")
        done = nonio("model", "simulate", spec, "--out", cls.root / "site" / "all")
        assert done.returncode == 0, done.stderr
        cls.run_ = nonio("run", cls.root / "site", "--out", cls.root / "out")
        cls.results = json.loads((cls.root / "out" / "machining-centre" / "results.json").read_text("utf-8"))
        cls.truth = json.loads((cls.root / "site" / "all.truth.json").read_text("utf-8"))

    def values(self, plugin, measurement):
        found = [a["values"] for a in self.results["analyses"]
                 if (a["plugin"], a["measurement"]) == (plugin, measurement)]
        self.assertEqual(len(found), 1, [(a["plugin"], a["measurement"]) for a in self.results["analyses"]])
        return found[0]

    def near(self, value, truth, delta):
        self.assertAlmostEqual(value["value"], truth, delta=delta)

    def test_nothing_failed(self):
        self.assertEqual(self.run_.returncode, 0, self.run_.stderr)
        self.assertEqual(self.results["errors"], [])
        self.assertEqual({m["id"] for m in self.truth["measurements"]},
                         {"X", "EYX", "S1", "S2", "D1", "D2", "SD", "C", "RTCP", "RTCP-probe"})

    def test_ball_centres(self):
        v = self.values("rotary-kinematics", "C")
        self.near(v["centre_x"], 400.018 + 80.0 * 0.00008, 0.003)  # at the height of the ball
        self.near(v["centre_y"], 299.991 - 80.0 * 0.00005, 0.003)
        self.near(v["direction_i"], 0.00008, 1.5e-5)

    def test_tool_centre_point_control(self):
        for measurement, height in (("RTCP", 180.0), ("RTCP-probe", 80.0)):
            v = self.values("rtcp", measurement)
            self.near(v["centre_error_x"], 18.0 + height * 0.08, 2.0)
            self.near(v["centre_error_y"], -9.0 - height * 0.05, 2.0)
            self.near(v["direction_error_i"], 80.0, 12.0)
            self.near(v["direction_error_j"], -50.0, 12.0)

    def test_square(self):
        # The least-squares slope of the bent X is in it; the set-up is not, the error is.
        self.near(self.values("square", "S1")["C0Y_LSQ"], 12.0, 25.0)

    def test_step_diagonals_show_the_squareness(self):
        self.near(self.values("step-diagonal", "SD")["C0Y"], 12.0, 20.0)

    def test_diagonals(self):
        d1, d2 = ([line.split(",") for line in (self.root / "site" / "all" / name).read_text("utf-8").splitlines()[2:]]
                  for name in ("d1.csv", "d2.csv"))
        ends = [sum(float(r[3]) for r in d if r[2] == "1000" and r[1] == "+") / 3 -
                sum(float(r[3]) for r in d if r[2] == "0" and r[1] == "+") / 3 for d in (d1, d2)]
        # D1 - D2 = -2 Lx Ly C0Y / L, and the ends of the bent X.
        self.assertAlmostEqual((ends[0] - ends[1]) * 1e-3 / (-2 * 0.8 * 0.6) * 1e3, 12.0, delta=25.0)

    def test_refusals_name_line_and_key(self):
        spec = self.root / "spec.toml"
        text = SAMPLE.with_name("machining-centre.toml").read_text("utf-8")
        for old, new, says in (('sensor = "probe"', "", "sensor: is missing"),
                               ('ball_mm = [550.0, 300.0, 80.0]\nnoise_um = 1.0', "noise_um = 1.0", "ball_mm: is missing"),
                               ('"mirror-tilt:SD PPP"', '"mirror-tilt:SD QQQ"', "no measurement shows it"),
                               ("steps = 10\nruns = 1", "runs = 1", "steps: is missing"),
                               ('carries = "table"', "", "carries is missing"),
                               ('kind = "straightness"\naxis = "X"\nlateral = "Y"', 'kind = "angle"\nabout = "Z"\naxis = "X"', "found angle")):
            self.assertIn(old, text)
            spec.write_text(text.replace(old, new, 1), "utf-8")
            done = nonio("model", "simulate", spec, "--out", self.root / "site" / "none")
            self.assertEqual(done.returncode, 2, says)
            self.assertIn(says, done.stderr)
            self.assertRegex(done.stderr, r"line \d+")
        self.assertFalse((self.root / "site" / "none").exists())


class TwoRotaryAxes(unittest.TestCase):
    """A ball on C, which B carries: both lines come back."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.text = SAMPLE.with_name("two-rotary-axes.toml").read_text("utf-8")

    def made(self, text):
        spec = self.root / "spec.toml"
        spec.write_text(text, "utf-8")
        return nonio("model", "simulate", spec, "--out", self.root / "site" / "bc")

    def test_both_lines(self):
        self.assertEqual(self.made(self.text).returncode, 0)
        rows = (self.root / "site" / "bc" / "bc.csv").read_text("utf-8").splitlines()[1:]
        self.assertEqual(rows[0], "run,direction,angle_deg,B_deg,x_mm,y_mm,z_mm,time_s")
        self.assertEqual([tuple(r.split(",")[2:4]) for r in rows[1:]],
                         [(f"{60 * i}", f"{b}") for b in (-60, -30, 0, 30, 60) for i in range(6)])
        done = nonio("run", self.root / "site", "--out", self.root / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        results = json.loads((self.root / "out" / "two-rotary-axes" / "results.json").read_text("utf-8"))
        v = {name: value["value"] for name, value in results["analyses"][0]["values"].items()}
        for name, truth, near in (("distance", 0.04, 0.003), ("angle", 89.9971, 0.002), ("centre_x_C", 400.06, 0.003),
                                  ("centre_x_B", 400.02, 0.003), ("centre_z_B", -100.0, 0.003), ("direction_i_B", 1e-4, 3e-5),
                                  ("direction_j_C", 5e-5, 3e-5)):
            self.assertAlmostEqual(v[name], truth, delta=near, msg=name)

    def test_heads(self):
        """As seen from the tip, which is at the ball with both at 0; C of the table as before."""
        text = self.text.replace('tables = ["B", "C"]', 'heads = ["B", "C"]').replace('carries = "table"', 'carries = "head"')
        one = self.text.replace('tables = ["B", "C"]', 'tables = ["C"]\nheads = ["B"]').replace('carries = "table"', 'carries = "head"', 1)
        for spec, C in ((text, 400.06 - 540.0), (one, 400.06)):
            with self.subTest(C=C):
                self.assertEqual(self.made(spec).returncode, 0)
                done = nonio("run", self.root / "site", "--out", self.root / "out")
                self.assertEqual(done.returncode, 0, done.stderr)
                results = json.loads((self.root / "out" / "two-rotary-axes" / "results.json").read_text("utf-8"))
                v = {name: value["value"] for name, value in results["analyses"][0]["values"].items()}
                for name, truth in (("centre_x_B", 400.02 - 540.0), ("centre_z_B", -160.0), ("centre_x_C", C)):
                    self.assertAlmostEqual(v[name], truth, delta=0.003, msg=name)
                self.assertAlmostEqual(v["direction_i_B"], 1e-4, delta=3e-5)
                shutil.rmtree(self.root / "site")

    def test_refusals_name_the_key(self):
        for old, new, says in (('carrier = "B"', 'carrier = "C"', "another rotary axis of the machine than C"),
                               ('carrier = "B"', 'carrier = "X"', "another rotary axis"), ('carrier = "B"\n', "", "carrier: is missing"),
                               ("carrier_deg = [-60.0, -30.0, 0.0, 30.0, 60.0]\n", "", "carrier_deg: is missing"),
                               ("[-60.0, -30.0, 0.0, 30.0, 60.0]", "[]", "found 0"),
                               ('axis = "B"\ncentre_mm', 'axis = "A"\ncentre_mm', 'no rotary axis "A"'),
                               (self.text[self.text.index("[[simulation.rotary]]"):self.text.index("[[simulation.rotary]]            #")],
                                "", "expected a [[simulation.rotary]] of axis B")):
            self.assertIn(old, self.text)
            done = self.made(self.text.replace(old, new, 1))
            self.assertEqual(done.returncode, 2, says)
            self.assertIn(says, done.stderr)
        self.assertFalse((self.root / "site").exists())


class Circles(unittest.TestCase):
    """A ball bar on a machine with known errors: each cause comes back within its U."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.text = SAMPLE.with_name("ball-bar.toml").read_text("utf-8")

    def made(self, text, expect=0):
        spec = self.root / "spec.toml"
        spec.write_text(text, "utf-8")
        done = nonio("model", "simulate", spec, "--out", self.root / "site" / "bar")
        self.assertEqual(done.returncode, expect, done.stderr)
        return done

    def results(self):
        done = nonio("run", self.root / "site", "--out", self.root / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((self.root / "out" / "ball-bar" / "results.json").read_text("utf-8"))

    def test_what_was_put_in_comes_out(self):
        self.made(self.text)
        results = self.results()
        values = next(a["values"] for a in results["analyses"] if a["plugin"] == "circle")
        truth = {"C0Y": 30.0, "scale_mismatch": 25.0, "B_X": -5.0, "B_Y": -1.5, "servo_mismatch": 6e-3 / (1000 / 60),
                 "cyclic_X": 1.0, "lateral_X": 0.0, "lateral_Y": 0.0, "bow_EYX": 0.0, "bow_EXY": 0.0}
        for name, wanted in truth.items():
            self.assertLess(abs(values[name]["value"] - wanted), values[name]["U"], name)
            self.assertLess(values[name]["U"], 4.0, name)  # of any size it would be within it
        # The history follows what is linear in the readings, with the same values and U.
        followed = {(f["axis"], f["quantity"]): f for f in results["followed"]}
        for key, name in ((("XY", "squareness:XY.circle"), "C0Y"), (("XY", "scale_mismatch:XY"), "scale_mismatch"),
                          (("XY", "servo_mismatch:XY"), "servo_mismatch"), (("X", "B_circle"), "B_X"),
                          (("Y", "B_circle"), "B_Y"), (("X", "lateral"), "lateral_X"), (("X", "bow:EYX"), "bow_EYX")):
            f, v = followed.pop(key), values[name]
            self.assertEqual(f["value"], v["value"], name)
            u = (f["u"] ** 2 + sum(c["u"] ** 2 for c in f["common"])) ** 0.5
            self.assertAlmostEqual(u * v["k"] / v["U"], 1.0, places=3, msg=name)
            self.assertEqual(f["conditions"], {"radius": 150.0, "feed": 1000.0, "at": "X=400.000000 Y=250.000000 Z=120.000000"})
        # A wave of 1 um along X, none along Y: as cosine and sine, which are linear in the readings.
        wave = {axis: sum(followed.pop((axis, f"cyclic_circle_{part}"))["value"] ** 2 for part in ("cos", "sin")) ** 0.5
                for axis in "XY"}
        self.assertAlmostEqual(wave["X"], values["cyclic_X"]["value"], places=3)
        self.assertNotIn("cyclic_Y", values)
        self.assertLess(wave["Y"], values["cyclic_X"]["U"])
        self.assertEqual(set(followed), {("Y", "lateral"), ("Y", "bow:EXY")})

    def test_explain_names_the_causes_and_no_curves_that_imitate_them(self):
        """Curves of straightness and yaw that cancel each other imitate squareness and scale."""
        self.made(self.text)
        done = nonio("model", "explain", self.root / "site" / "bar", "--auto", "--json", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        named = {step["effect"] for step in found["steps"]}
        scale = named & {"scale:X", "scale:Y"}  # a circle shows only their difference
        self.assertEqual(len(scale), 1, named)
        self.assertEqual(named - scale, {"backlash:X", "backlash:Y", "servo-mismatch:XY", "squareness:XY", "periodic:X"})
        self.assertEqual(found["verdict"]["kind"], "nothing")

    def test_a_servo_mismatch_is_one_lag_at_every_feed(self):
        """Two feeds in one campaign: the analysis, which fits each circle on its own, gives one time, and the model one value."""
        first = self.text[self.text.index("[[measurement]]"):self.text.index("[run]")]
        cycle = self.text[self.text.index("[[cycle]]"):self.text.index("[[effect]]")]

        def other(text):
            return text.replace("C1", "C2").replace("feed_mm_per_min = 1000", "feed_mm_per_min = 3000").replace("circle.csv", "fast.csv")
        self.made(self.text.replace(first, first + other(first)).replace(cycle, cycle + other(cycle)))
        each = [a["values"]["servo_mismatch"] for a in self.results()["analyses"] if a["plugin"] == "circle"]
        self.assertEqual(len(each), 2)
        for value in each:
            self.assertLess(abs(value["value"] - 6e-3 / (1000 / 60)), value["U"])
        done = nonio("model", "explain", self.root / "site" / "bar", "--auto", "--json", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertIn("servo-mismatch:XY", {step["effect"] for step in found["steps"]})
        self.assertEqual(found["verdict"]["kind"], "nothing", found["verdict"])

    def test_one_direction_and_the_lines_of_the_file(self):
        one_way = self.text.replace("runs = 2", 'runs = 1\norder = "unidirectional"\ndirection = "-"')
        self.made(one_way)
        lines = (self.root / "site" / "bar" / "circle.csv").read_text("utf-8").splitlines()[1:]
        self.assertEqual(lines[0], "run,direction,angle_deg,deviation_um,time_s")
        rows = [line.split(",") for line in lines[1:]]
        self.assertEqual((len(rows), {r[1] for r in rows}), (720, {"-"}))
        self.assertEqual((rows[0][2], rows[-1][2]), ("359.7500", "0.2500"))
        self.assertAlmostEqual(float(rows[-1][4]), 2 * 3.14159265 * 150 / 1000 * 60 * 719 / 720, delta=0.01)
        # Squareness and servo mismatch have one column and are not identifiable; B_X is.
        values = next(a["values"] for a in self.results()["analyses"] if a["plugin"] == "circle")
        self.assertNotIn("C0Y", values)
        self.assertLess(abs(values["B_X"]["value"] + 5.0), values["B_X"]["U"])
        done = nonio("model", "explain", self.root / "site" / "bar", "--json", "--quiet")
        found = json.loads(done.stdout)
        squareness, = (c for c in found["candidates"] if c["effect"] == "squareness:XY")
        self.assertIn("servo-mismatch:XY", squareness["aliases"])
        self.assertNotIn("opposed", json.dumps(self.results()["analyses"]))

    def test_refusals(self):
        for old, new, says in (("feed_mm_per_min = 1000\n", "", "feed_mm_per_min"), ("readings = 720", "readings = 5", "24 to 100000"),
                               ("readings = 720", "targets_mm = [0, 1]", "targets_mm"), ("c_urad", "c_um", "c_um")):
            self.assertIn(old, self.text)
            self.assertIn(says, self.made(self.text.replace(old, new), expect=2).stderr)


if __name__ == "__main__":
    unittest.main()
