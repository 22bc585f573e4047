# SPDX-License-Identifier: Apache-2.0
"""nonio plan: the planner, the programs, and both in a campaign."""
import json
import math
import re
import subprocess
import unittest

from verbs import VerbTest, readings

NAMES = ["a", "b", "c", "q", "n", "step_x", "step_y", "step_d", "length_x", "length_y", "length_d", "cover_x", "cover_y"]
CAMPAIGN = """format = 1
[campaign]
id = "c"
[machine.axes.X]
kind = "linear"
travel = [0, 12000]
[machine.axes.Y]
kind = "linear"
travel = [-9000, 0]
"""


class Triples(VerbTest):
    def rows(self, *args, expect=0):
        whole = self.json_of("plan", "triples", *args, expect=expect)
        self.assertEqual(whole["schema"], "nonio-triples/1")
        return whole["rows"]

    def first(self, *args):
        r = self.rows(*args)[0]
        return (r["a"], r["b"], r["c"], r["q"], r["n"])

    def test_known_plans(self):
        for args, plan in (
                (["--x", 4000, "--y", 4000, "--max-step", 250], (119, 120, 169, 1, 33)),
                (["--x", 4000, "--y", 4000, "--max-step", 250, "--resolution", 0.1], (696, 697, 985, 3, 19)),
                (["--x", 19760, "--y", 7680, "--max-step", 500], (247, 96, 265, 2, 40)),
                (["--x", 20000, "--y", 12000, "--max-step", 500], (299, 180, 349, 1, 66)),
                (["--x", 20000, "--y", 12000, "--max-step", 250], (56, 33, 65, 3, 119)),
                (["--x", 20000, "--y", 12000, "--max-step", 250, "--over-travel", 100, "--max-points", 100,
                  "--pitch-x", 20, "--pitch-y", 20, "--even"], (56, 33, 65, 4, 88)),
                (["--x", 14500, "--y", 9000, "--max-step", 500, "--max-points", 41], (45, 28, 53, 10, 32)),
                (["--x", 12000, "--y", 9000, "--max-step", 500, "--max-points", 31], (4, 3, 5, 125, 24))):
            self.assertEqual(self.first(*args), plan, args)

    def test_plans_of_the_sources_to_the_millimetre(self):
        """Steps and lengths as the sources print them, and the ratio of the second machine's legs."""
        for args, steps, lengths, n, q in (
                (["--x", 12000, "--y", 9000, "--max-step", 400], (400, 300, 500), (12000, 9000, 15000), 30, 100),
                (["--x", 19760, "--y", 7680, "--max-step", 500], (494, 192, 530), (19760, 7680, 21200), 40, 2),
                (["--x", 4000, "--y", 4000, "--max-step", 250], (119, 120, 169), (3927, 3960, 5577), 33, 1),
                (["--x", 20000, "--y", 12000, "--max-step", 500, "--hypotenuse", 299], (392, 231, 455),
                 (19992, 11781, 23205), 51, 7)):
            row = self.rows(*args)[0]
            self.assertEqual(tuple(row["step_" + k] for k in "xyd"), steps)
            self.assertEqual(tuple(row["length_" + k] for k in "xyd"), lengths)
            self.assertEqual((row["n"], row["q"]), (n, q))
            if q == 2:
                self.assertEqual(row["q"] * row["n"], 80)  # the whole multiple of 247-96-265
                self.assertEqual("%.3f" % (row["step_x"] / row["step_y"]), "2.573")
            if q == 7:  # of the triple that covers the machine whose ratio is 1.667
                self.assertEqual("%.3f" % (row["step_x"] / row["step_y"]), "1.697")

    def test_names_units_and_reasons(self):
        whole = self.json_of("plan", "triples", "--x", 12000, "--y", 9000, "--max-step", 500, "--max-points", 31)
        row = whole["rows"][0]
        for name in NAMES:
            self.assertIn(name, row)
        self.assertEqual(whole["row_units"]["step_x"], "mm")
        self.assertEqual((row["step_x"], row["step_y"], row["step_d"]), (500, 375, 625))
        self.assertEqual((row["length_x"], row["length_y"], row["length_d"]), (12000, 9000, 15000))
        self.assertEqual((row["cover_x"], row["cover_y"]), (1, 1))
        self.assertIn("best", row["reasons"])
        self.assertEqual(len(whole["rows"]), 5)
        for r in whole["rows"]:
            self.assertTrue(r["why"] and r["gives_up"], r)

    def test_count_and_even(self):
        self.assertEqual(len(self.rows("--x", 4000, "--y", 3000, "--count", 3)), 3)
        for words in (["--even"], ["--even=require"]):
            for r in self.rows("--x", 4000, "--y", 4000, "--max-step", 250, *words):
                self.assertEqual(r["n"] % 2, 0)

    def test_the_table_for_people(self):
        shown = self.nonio("plan", "triples", "--x", 20000, "--y", 2000).stdout
        for words in ("EYX", "why: best coverage of the worse axis", "disadvantage: ", "warning: "):
            self.assertIn(words, shown)

    def test_tables_fit_100_columns(self):
        for words in (("triples", "--x", 20000, "--y", 2000), ("triples", "--x", 123456.789, "--y", 98765.432, "--resolution", 0.001),
                      ("table", "--x", 12000, "--y", 9000), ("rotary", "--axis", "C", "--balls", 5, "--radius", 250, "--probe-u", 1.5)):
            for language in ("en", "de", "it"):
                shown = self.nonio("plan", *words, "--language", language).stdout
                self.assertEqual([], [line for line in shown.split("\n") if len(line) > 100], words)
                numbers = re.findall(r"(?<![\w.,])\d+[.,]\d+(?![\w.,])", shown)
                self.assertEqual(language == "en", any("." in number for number in numbers), words)
                self.assertEqual(language != "en", any("," in number for number in numbers), words)
                self.assertNotIn("triples.", shown)
                self.assertNotIn("rotary.", shown)

    def test_nothing_fits(self):
        done = self.nonio("plan", "triples", "--x", 4000, "--y", 4000, "--max-step", 2, expect=1)
        self.assertIn("--max-step", done.stderr)
        whole = self.json_of("plan", "triples", "--x", 4000, "--y", 4000, "--max-step", 2, expect=1)
        self.assertEqual(whole["rows"], [])
        self.assertIn("--max-step", whole["nothing_fits"])

    def test_bad_input(self):
        for args, words in (
                (["--x", "0", "--y", "4000"], "travel of X: expected"),
                (["--x=-5", "--y", "4000"], "travel of X: expected"),
                (["--x", "nan", "--y", "4000"], "travel of X: expected"),
                (["--x", "inf", "--y", "4000"], "travel of X: expected"),
                (["--x", "4000,5", "--y", "4000"], "with a point for decimals; found \"4000,5\""),
                (["--x", "", "--y", "4000"], "--x: expected a number"),
                (["--x", "four", "--y", "4000"], "--x: expected a number"),
                (["--x", "400", "--y", "400", "--resolution", "0"], "resolution: expected"),
                (["--x", "400", "--y", "400", "--resolution", "1e-9"], "resolution: expected"),
                (["--x", "400", "--y", "400", "--over-travel", "200"], "leave nothing of"),
                (["--x", "400", "--y", "400", "--over-travel", "900"], "leave nothing of"),
                (["--x", "400", "--y", "400", "--over-travel=-1"], "over-travel: expected"),
                (["--x", "400", "--y", "400", "--pitch-x", "0"], "pitch of X: expected"),
                (["--x", "400", "--y", "400", "--max-points", "3"], "points of the table: expected"),
                (["--x", "400", "--y", "400", "--count", "0"], "--count: expected"),
                (["--x", "400", "--y", "400", "--count", "q"], "--count"),
                (["--x", "400", "--y", "400", "--even=odd"], "even"),
                (["--x", "400", "--y", "400", "--hypotenuse", "1"], "hypotenuse: expected"),
                (["--x", "20000", "--y", "20000", "--resolution", "0.000001", "--max-points", "100000",
                  "--hypotenuse", "1000000"], "coarser resolution"),
                (["--x", "400"], "--y"),
                (["--x", "400", "--y", "400", "--program", "p"], "--control"),
                (["--x", "400", "--y", "300", "--program", "p", "--control", "gcode", "--choose", "99"], "--choose")):
            done = self.nonio("plan", "triples", *args, expect=2)
            self.assertIn(words, done.stderr, args)



class LookUpTable(VerbTest):
    def test_it_is_every_primitive_triple_below_300_to_the_third_decimal(self):
        wanted = set()
        for a in range(1, 300):  # every pair of legs, not Euclid's formula
            for b in range(a, 300):
                c = math.isqrt(a * a + b * b)
                if c * c == a * a + b * b and c < 300 and math.gcd(a, b) == 1:
                    wanted.add((a, b, c, f"{b / a:.3f}"))
        self.assertEqual(len(wanted), 47)
        for sort, key in (("ratio", lambda r: r[1] / r[0]), ("c", lambda r: r[2])):
            shown = self.nonio("plan", "table", "--sort", sort).stdout.splitlines()
            self.assertEqual(shown[0].split(), ["a", "b", "c", "b/a"])
            rows = [(int(a), int(b), int(c), ratio) for a, b, c, ratio in map(str.split, shown[1:])]
            self.assertEqual(set(rows), wanted)
            self.assertEqual(len(rows), 47)
            self.assertEqual([key(r) for r in rows], sorted(key(r) for r in rows))

    def test_rows_that_fit_go_by_their_cost(self):
        whole = self.json_of("plan", "table", "--x", 20000, "--y", 12000, "--max-step", 500, "--feed", 5000,
                             "--dwell", 3, "--runs", 2)
        self.assertEqual((whole["schema"], whole["sort"]), ("nonio-triple-table/1", "minutes"))
        cost = []
        for r in whole["rows"]:
            self.assertEqual(r["a"] ** 2 + r["b"] ** 2, r["c"] ** 2)
            for step, leg, travel, cover in (("step_x_mm", "a", 20000, "cover_x"), ("step_y_mm", "b", 12000, "cover_y")):
                self.assertAlmostEqual(r[step], r[leg] * r["q"], places=6)
                self.assertLessEqual(r[step], 500)
                self.assertAlmostEqual(r[cover], r["n"] * r[step] / travel, places=9)
                self.assertGreaterEqual(r[cover], 0.9)
            way = r["n"] * (r["step_x_mm"] + r["step_y_mm"] + 2 * r["step_d_mm"])
            cost.append(4 * (way / 5000 + 4 * (r["n"] + 1) * 3 / 60))
            self.assertAlmostEqual(r["minutes"], cost[-1], places=6)
        self.assertGreater(len(cost), 3)
        self.assertEqual(cost, sorted(cost))

    def test_programs_of_every_row(self):
        table = ["plan", "table", "--x", 4000, "--y", 3000, "--max-step", 400, "--least-cover", 0.99, "--over-travel", 10]
        rows = self.json_of(*table)["rows"]
        self.assertGreater(len(rows), 2)
        visited = {}
        for control, end in (("gcode", "ngc"), ("siemens", "mpf"), ("heidenhain", "h")):
            out = self.site / control
            self.nonio(*table, "--program", out, "--control", control, "--set", "runs=1")
            folders = sorted(p.name for p in out.iterdir())
            self.assertEqual(folders, [f"{i + 1:02}-{r['a']}-{r['b']}-{r['c']}" for i, r in enumerate(rows)])
            for folder, r in zip(folders, rows):
                found = visited.setdefault(folder, {})
                for name in ("X", "Y", "D1", "D2"):
                    text = (out / folder / f"program-{control}-{name}.{end}").read_text()
                    at, stops = {}, []
                    for line in text.splitlines():
                        if re.match(r"(G1|\d+ L) ", line):
                            at.update({axis: float(v) for axis, v in re.findall(r" ([XY])([+-]?[\d.]+)", line)})
                            stops.append(dict(at))
                    self.assertEqual(found.setdefault(name, stops), stops, (control, folder, name))
                last = [{"X": 10 + r["n"] * r["step_x_mm"], "Y": 10 + y * r["n"] * r["step_y_mm"]} for y in (1, 0)]
                for name, end_of_line in zip(("D1", "D2"), last):
                    self.assertIn({k: round(v, 6) for k, v in end_of_line.items()}, found[name])

    def text_of(self, pdf):
        return subprocess.run(["pdftotext", "-layout", str(pdf), "-"], capture_output=True, text=True, check=True).stdout

    def test_the_sheet_has_the_table_and_the_stops_of_the_programs(self):
        for language, title in (("en", "Right triangles"), ("de", "Rechtwinklige"), ("it", "Triangoli")):
            sheet = self.site / f"{language}.pdf"
            self.nonio("plan", "table", "--pdf", sheet, "--language", language)
            text = self.text_of(sheet)
            self.assertIn(title, text)
            point = "." if language == "en" else ","
            numbers = " ".join(text.split())
            for a, b, c in ((3, 4, 5), (119, 120, 169), (23, 264, 265), (96, 247, 265)):
                self.assertIn(f"{a} {b} {c} {b / a:.3f}".replace(".", point), numbers)
        sheet, out = self.site / "plans.pdf", self.site / "programs"
        self.nonio("plan", "table", "--x", 4000, "--y", 3000, "--max-step", 400, "--least-cover", 0.99, "--over-travel", 10,
                   "--pdf", sheet, "--stops", 1, "--program", out, "--control", "gcode", "--set", "runs=1")
        first = sorted(out.iterdir())[0]
        rows = {}
        for line in self.text_of(sheet).splitlines():  # two blocks of i, X, Y of D1, Y of D2, D side by side
            words = line.split()
            if len(words) in (5, 10) and all(re.fullmatch(r"[\d.]+", w) for w in words):
                for at in range(0, len(words), 5):
                    rows[int(words[at])] = [float(w) for w in words[at + 1:at + 5]]
        self.assertEqual(sorted(rows), list(range(len(rows))))
        self.assertGreater(len(rows), 5)
        for name, column in (("D1", 1), ("D2", 2)):
            stops, at = [], {}
            for line in (first / f"program-gcode-{name}.ngc").read_text().splitlines():
                if line.startswith("G1"):
                    at.update({w[0]: float(w[1:]) for w in line.split()[1:]})
                elif line.startswith("G4"):
                    stops.append((at["X"], at["Y"]))
            self.assertEqual(stops[:len(rows)], [(row[0], row[column]) for _, row in sorted(rows.items())])

    def test_the_cheapest_plan_of_each_triple(self):
        asked = ["plan", "table", "--x", 2000, "--y", 1500, "--max-step", 300, "--hypotenuse", 60, "--least-cover", 0.93]
        rows = self.json_of(*asked, "--cheapest")["rows"]
        best = {}
        for a in range(1, 60):  # every triple, q and n, not the planner's
            for b in range(1, 60):
                c = math.isqrt(a * a + b * b)
                if c * c != a * a + b * b or c > 60 or math.gcd(a, b) != 1:
                    continue
                for n in range(4, 1500):
                    q = min(2000 // (a * n), 1500 // (b * n), 300 // a, 300 // b)
                    if q < 1 or min(n * q * a / 2000, n * q * b / 1500) < 0.93:
                        continue
                    minutes = 10 * (n * q * (a + b + 2 * c) / 2000 + 4 * (n + 1) * 5 / 60)
                    best[a, b] = min(best.get((a, b), 1e9), minutes)
        self.assertEqual({(r["a"], r["b"]): round(r["minutes"], 6) for r in rows},
                         {key: round(value, 6) for key, value in best.items()})
        covered = {(r["a"], r["b"]): r["minutes"] for r in self.json_of(*asked)["rows"]}
        self.assertTrue(any(best[key] < minutes - 1e-6 for key, minutes in covered.items()))

    def test_axes_with_scale_factors_of_their_own(self):
        rows = self.json_of("plan", "table", "--x", 9000, "--y", 7000, "--max-step", 400, "--resolution-x", 0.4,
                            "--resolution-y", 0.3, "--resolution", 1)["rows"]
        self.assertGreater(len(rows), 1)
        for r in rows:
            for name, unit in (("step_x_mm", 0.4), ("step_y_mm", 0.3), ("step_d_mm", 1.0)):
                self.assertAlmostEqual(r[name] / unit, round(r[name] / unit), places=6, msg=r)
            self.assertAlmostEqual(r["step_x_mm"] ** 2 + r["step_y_mm"] ** 2, r["step_d_mm"] ** 2, places=4)
        self.assertIn("resolution of X", self.nonio("plan", "triples", "--x", 400, "--y", 300, "--resolution-x=-1",
                                                   expect=2).stderr)

    def test_what_cannot_be(self):
        for args, status, words in ((["--x", 4000], 2, "expected both"), (["--sort", "minutes"], 2, "--x and --y"),
                                    (["--program", "p"], 2, "--x and --y"),
                                    (["--x", 4000, "--y", 3000, "--program", "p"], 2, "--control"),
                                    (["--x", 4000, "--y", 4000, "--max-step", 2], 1, "--max-step"),
                                    (["--x", 4000, "--y", 100, "--least-cover", 1], 1, "--least-cover")):
            self.assertIn(words, self.nonio("plan", "table", *args, expect=status).stderr, args)


class Probing(VerbTest):
    MACHINE = ["--axis", "X=0:700", "--axis", "Y=0:500", "--axis", "Z=-400:200", "--axis", "C=-5:365", "--axis", "B=-100:100"]
    BALL = {"centre_mm": "350,250,0", "ball_mm": "530,250,-60", "radius_mm": 15, "places": 4, "approach_mm": 4, "beyond_mm": 2}

    def wrote(self, expect=0, **settings):
        out = self.site / "probing"
        words = []
        for key, value in {**self.BALL, **settings}.items():
            words += ["--set", f"{key}={value}"]
        done = self.nonio("plan", "program", *self.MACHINE, "--control", "probing", "--out", out, *words, expect=expect)
        return done.stderr, {p.name: p.read_text().splitlines() for p in out.iterdir()} if out.exists() else {}

    def test_a_touch_in_each_dialect(self):
        at = {"linuxcnc": ["G1 X549.0 Y250.0 F1000", "G1 Z-60.0 F1000", "G38.2 X543.0 F100", "G1 X549.0 F1000",
                           "G1 Z-37.0 F1000"],
              "fanuc": ["G1 X549.0 Y250.0 F1000", "G1 Z-60.0 F1000", "G31 X543.0 F100",
                        "IF [ABS[#5061-[543.0]] LT 0.002] THEN #3000=1(NO CONTACT)",
                        "DPRNT[#5061[44]*#5062[44]*#5063[44]*0*0*0.0*0*0*0]", "G1 X549.0 F1000"],
              "siemens": ["G1 X549.0 Y250.0 F1000", "G1 Z-60.0 F1000", "MEAS=1 G1 X543.0 Y250.0 Z-60.0 F100", "STOPRE",
                          "IF $AC_MEA[1]==0 GOTOF NO_CONTACT",
                          'WRITE(RC,"NONIO_C",""<<$AA_MM[X]<<" "<<$AA_MM[Y]<<" "<<$AA_MM[Z]<<" 0 0 0.0 0 0 0")',
                          "G1 X549.0 F1000"]}
        for dialect, wanted in at.items():
            _, files = self.wrote(dialect=dialect)
            lines = files["program-probing-C." + ("mpf" if dialect == "siemens" else "ngc")]
            first = lines.index(wanted[0])
            self.assertEqual(lines[first:first + len(wanted)], wanted)
            touches = [line for line in lines if re.match(r"G38.2|G31|MEAS", line)]
            self.assertEqual(len(touches), 4 * 5)
            turns = [line for line in lines if line.startswith("G1 C")]
            self.assertEqual(turns, [f"G1 C{90 * i}.0 F720" for i in range(4)])

    def test_the_ball_goes_round_as_it_is_said(self):
        for turns, y in (("right-handed", "430.0"), ("left-handed", "70.0")):
            _, files = self.wrote(turns=turns)
            lines = files["program-probing-C.ngc"]
            self.assertEqual(lines[lines.index("G1 C90.0 F720") + 1], f"G1 X350.0 Y{y} F1000")
        _, files = self.wrote(axis="B", centre_mm="350,0,-100", ball_mm="350,250,-20", from_deg=-90, to_deg=90, places=3)
        lines = files["program-probing-B.ngc"]
        self.assertEqual([lines[lines.index(f"G1 B{a} F720") + 1] for a in ("-90.0", "0.0", "90.0")],
                         [f"G1 X{x} Y250.0 F1000" for x in ("270.0", "350.0", "430.0")])  # +Z turns towards +X

    def test_two_axes(self):
        """C on B, the ball 180 mm from C and 60 mm below it: with B at 90 C is parallel to X, so that the ball, at C 90, is at
        X = 350 + (-60 + 100), Y = 250 + 180, Z = -100. Its stem points to -X then: no touch comes from there."""
        two = {"carried_by": "B", "carrier_centre_mm": "350,0,-100", "carrier_deg": "0,90"}
        _, files = self.wrote(**two)
        lines = files["program-probing-BC.ngc"]
        self.assertEqual([line for line in lines if re.match("G1 B", line)],
                         [f"G1 B{b}.0 C{90 * i}.0 F720" for b in (0, 90) for i in range(4)])
        at = lines.index("G1 B90.0 C90.0 F720")
        end = lines.index("G1 B90.0 C180.0 F720")
        self.assertEqual(lines[at + 1:at + 4], ["G1 X390.0 Y430.0 F1000", "G1 Z-81.0 F1000", "G38.2 Z-87.0 F100"])
        touches = [line for line in lines[at:end] if line.startswith("G38.2")]
        self.assertEqual(touches, ["G38.2 Z-87.0 F100", "G38.2 X403.0 F100", "G38.2 Y443.0 F100", "G38.2 Y417.0 F100",
                                   "G38.2 X399.1924 Y439.1924 F100", "G38.2 X399.1924 Y420.8076 F100"])
        for dialect, ending, words in (("fanuc", "ngc", "DPRNT[#5061[44]*#5062[44]*#5063[44]*0*90.0*180.0*0*0*0]"),
                                       ("siemens", "mpf", '<<$AA_MM[Z]<<" 0 90.0 180.0 0 0 0")')):
            _, files = self.wrote(dialect=dialect, **two)
            self.assertIn(words, "\n".join(files["program-probing-BC." + ending]))
        _, files = self.wrote(**{**two, "carrier_turns": "left-handed"})
        self.assertIn("G1 X310.0 Y430.0 F1000", files["program-probing-BC.ngc"])

    def test_what_two_axes_cannot_be(self):
        two = {"carried_by": "B", "carrier_centre_mm": "350,0,-100", "carrier_deg": "0,90"}
        for settings, words in (({"carried_by": "C"}, "another rotary axis of the machine than C"),
                                ({"carried_by": "A"}, "another rotary axis"), ({"carrier_centre_mm": "1,2"}, "carrier_centre_mm"),
                                ({"carrier_deg": ""}, "carrier_deg"), ({"carrier_deg": "0,120"}, "axis B would go to 120"),
                                ({"stem": "+X", "carrier_deg": "-90"}, "the stem is above the ball")):
            said, files = self.wrote(expect=2, **{**two, **settings})
            self.assertIn(words, said)
            self.assertEqual(files, {}, settings)

    def test_what_cannot_be(self):
        for settings, words in (({"dialect": "heidenhain"}, "no public text"), ({"centre_mm": "350,250"}, "X, Y, Z of a point"),
                                ({"ball_mm": "1,2,x"}, "ball_mm"), ({"beyond_mm": 15}, "less than radius_mm"),
                                ({"from_deg": 10, "to_deg": 10}, "at most 360"), ({"from_deg": -90, "to_deg": 90}, "axis C would go"),
                                ({"ball_mm": "690,250,-60"}, "axis X would go to 709"), ({"axis": "A"}, "no rotary axis A"),
                                ({"heights_mm": "0,300"}, "axis Z would go to")):
            said, files = self.wrote(expect=2, **settings)
            self.assertIn(words, said)
            self.assertEqual(files, {}, settings)


class RotaryPlan(VerbTest):
    def test_its_figures_are_those_of_the_theory(self):
        whole = self.json_of("plan", "rotary", "--axis", "C", "--balls", 6, "--radius", 300, "--probe-u", 10,
                             "--trials", 4000, "--seed", 7)
        self.assertEqual(whole["schema"], "nonio-rotary-plan/1")
        self.assertAlmostEqual(whole["U_two_points_um"], 20 / math.sqrt(2), places=9)
        asked = [(r["balls"], round(r["radius_mm"], 6)) for r in whole["plans"]]
        self.assertEqual(asked[0], (6, 300))
        for radius in (300, 500, 50):
            for balls in (3, 4, 5, 10):
                self.assertIn((balls, radius), asked)
        for r in whole["plans"]:  # an rms of 4,000 has 1.1 % in each coordinate: 5 of them
            N, R = r["balls"], r["radius_mm"]
            for name, theory in (("U_across_um", 20 * math.sqrt(2 / N)), ("U_along_um", 20 / math.sqrt(N)),
                                 ("centre_rms_um", 10 * math.sqrt(5 / N)), ("U_tilt_urad", 2e4 * math.sqrt(2 / N) / R),
                                 ("direction_rms_urad", 2e4 / (R * math.sqrt(N)))):
                self.assertAlmostEqual(r[name] / theory, 1, delta=0.055, msg=(name, N, R))
        self.assertEqual(whole, self.json_of("plan", "rotary", "--axis", "C", "--balls", 6, "--radius", 300,
                                             "--probe-u", 10, "--trials", 4000, "--seed", 7))

    def test_the_fewest_balls(self):
        plan = ["plan", "rotary", "--axis", "C", "--radius", 250, "--probe-u", 1.5, "--trials", 100]
        self.assertEqual(self.json_of(*plan, "--want-centre", 2)["fewest_balls"], 5)  # 3 sqrt(2/5) = 1.90
        self.assertEqual(self.json_of(*plan, "--want-direction", 4)["fewest_balls"], 18)  # 12 sqrt(2/18) = 4
        self.assertIn("balls reach", self.nonio(*plan, "--want-centre", 0.01, expect=1).stderr)

    def test_what_cannot_be(self):
        for args, words in ((["--axis", "X", "--radius", 250], "rotary axis"),
                            (["--axis", "C", "--radius", 0.1], "radius"),
                            (["--axis", "C", "--radius", 250, "--balls", 2], "--balls"),
                            (["--axis", "C", "--radius", 250, "--arc", 361], "--arc")):
            done = self.nonio("plan", "rotary", "--probe-u", 2, *args, expect=2)
            self.assertIn(words, done.stderr, args)


class Programs(VerbTest):
    def program(self, *args, expect=0):
        out = self.site / "programs"
        done = self.nonio("plan", *args, expect=expect)
        return done, {p.name: p.read_text() for p in out.iterdir()} if out.exists() else {}

    def test_of_a_plan(self):
        for control, ending in (("gcode", "ngc"), ("siemens", "mpf"), ("program-heidenhain", "h")):
            _, files = self.program("triples", "--x", 4000, "--y", 3000, "--over-travel", 2, "--program",
                                    self.site / "programs", "--control", control)
            name = control.removeprefix("program-")
            for line in ("X", "Y", "D1", "D2"):
                self.assertIn(f"program-{name}-{line}.{ending}", files)
        for text in files.values():
            self.assertIn("DRY RUN FIRST", text)

    def test_the_dialects(self):
        for control in ("gcode", "siemens", "heidenhain"):
            self.program("program", "--axis", "X=0:100", "--axis", "Y=0:75", "--n", 4, "--step-x", 20, "--step-y", 15,
                         "--control", control, "--out", self.site / "programs", "--machine", "FP (12); \u00fc",
                         "--set", "runs=1", "--set", "dwell_s=2.5", "--set", "programs=diagonals",
                         "--set", "feed_mm_per_min=1500")
        folder = self.site / "programs"
        lines = {c: (folder / f).read_text(encoding="ascii").splitlines() for c, f in
                 (("gcode", "program-gcode-D2.ngc"), ("siemens", "program-siemens-D2.mpf"),
                  ("heidenhain", "program-heidenhain-D2.h"))}
        self.assertIn("(machine: FP  12   ??)", lines["gcode"])
        at = lines["gcode"].index("G1 X1.0 Y61.0")
        self.assertEqual(lines["gcode"][at - 2:at + 3], ["F1500", "G1 X0.0 Y61.75", "G1 X1.0 Y61.0", "G4 P2.5", "G1 X21.0 Y46.0"])
        self.assertEqual(lines["gcode"][-1], "M30")
        at = lines["siemens"].index("G1 X1.0 Y61.0 F1500")
        self.assertEqual(lines["siemens"][at + 1:at + 3], ["G4 F2.5", "G1 X21.0 Y46.0 F1500"])
        h = lines["heidenhain"]
        self.assertEqual(h[0], "0 BEGIN PGM NONIO_D2 MM")
        self.assertEqual(h[-1].split(" ", 1)[1], "END PGM NONIO_D2 MM")
        self.assertEqual([int(line.split()[0]) for line in h], list(range(len(h))))
        bare = [line.split(" ", 1)[1] for line in h]
        at = bare.index("L X+1.0 Y+61.0 R0 F1500 M91")
        self.assertEqual(bare[at + 1:at + 4], ["CYCL DEF 9.0 DWELL TIME", "CYCL DEF 9.1 DWELL 2.5", "L X+21.0 Y+46.0 R0 F1500 M91"])

    def test_the_files_as_json(self):
        whole = self.json_of("plan", "program", "--axis", "X=0:100", "--axis", "C=0:360", "--control", "gcode", "--out",
                             self.site / "programs")
        self.assertEqual(whole["schema"], "nonio-programs/1")
        self.assertEqual([p.rsplit("/", 1)[1] for p in whole["files"]], ["program-gcode-X.ngc", "program-gcode-C.ngc"])

    def test_a_long_name_of_an_axis(self):
        _, files = self.program("program", "--axis", "X1=0:100", "--axis", "X2=0:100", "--control", "siemens", "--out",
                                self.site / "programs", "--set", "axes=X2", "--set", "targets=even")
        self.assertEqual(list(files), ["program-siemens-X2.mpf"])
        self.assertIn("\nG1 X2=1.0 F2000\n", files["program-siemens-X2.mpf"])

    def test_a_rotary_axis_is_measured_as_the_findings_require(self):
        """The plan of every travel, measured as written, gets no plan.* finding: one run over all of them."""
        made = {}
        for travel in ((0, 360), (-5, 365), (0, 90), (-100, 100), (-30, 120), (10, 370)):
            for setting in ("seed=1", "seed=2", "interval_deg=120"):
                _, files = self.program("program", "--axis", "C=%d:%d" % travel, "--control", "gcode", "--out",
                                        self.site / "programs", "--set", setting)
                moves = re.findall(r"G1 C(\S+)\n(G4)?", files["program-gcode-C.ngc"])
                stops = [(float(now) > float(before), float(now))
                         for (before, _), (now, rest) in zip(moves, moves[1:]) if rest]
                targets = sorted({p for _, p in stops})
                lines = ["run,direction,target_deg,deviation_arcsec"]
                lines += ["%d,%s,%.6f,%.3f" % (1 + i // (2 * len(targets)), "+" if up else "-", p, (i * 7919 % 13) / 10)
                          for i, (up, p) in enumerate(stops)]
                name = f"c{len(made)}"
                made[name] = (travel, setting, targets)
                (self.site / name).mkdir()
                (self.site / name / "c.csv").write_text("\n".join(lines) + "\n")
                (self.site / name / "campaign.toml").write_text(
                    'format = 1\n[campaign]\nid = "%s"\n[machine.axes.C]\nkind = "rotary"\ntravel = [%d, %d]\n'
                    '[[measurement]]\nid = "C"\nkind = "axis"\naxis = "C"\nfile = "c.csv"\n[run]\n'
                    'analyses = ["iso230-2"]\noutputs = []\n' % (name, *travel))
                beyond = min(targets) - 1 < travel[0] or max(targets) + 1 > travel[1]
                self.assertEqual("whole turn" in files["program-gcode-C.ngc"], beyond)
                self.assertTrue(not beyond or travel[1] - travel[0] >= 360)
        out = self.site.parent / "out"
        self.nonio("run", self.site, "--out", out)
        for name, what in made.items():
            analysis = json.loads((out / name / "results.json").read_text())["analyses"][0]
            found = [f["id"] for f in analysis["findings"]]
            self.assertEqual([f for f in found if f.startswith(("plan.", "targets.", "direction."))], [], what)

    def test_the_unit_of_the_rest(self):
        for word, wanted in (("P-s", "G4 P2.5"), ("P-ms", "G4 P2500"), ("X", "G4 X2.5")):
            _, files = self.program("program", "--axis", "X=0:100", "--control", "gcode", "--out", self.site / "programs",
                                    "--set", "dwell_s=2.5", "--set", f"dwell_word={word}")
            self.assertIn(f"\n{wanted}\n", files["program-gcode-X.ngc"])

    def test_the_seed_gives_the_targets(self):
        texts = []
        for seed in (7, 7, 8):
            _, files = self.program("program", "--axis", "X=0:1000", "--control", "gcode", "--out",
                                    self.site / "programs", "--set", f"seed={seed}")
            texts.append(files["program-gcode-X.ngc"])
            self.assertIn(f"random offsets, seed {seed}", texts[-1])
        self.assertEqual(texts[0], texts[1])
        self.assertNotEqual(texts[0], texts[2].replace("seed 8", "seed 7"))

    def test_bad_input(self):
        out = ["--out", self.site / "programs"]
        base = ["program", "--axis", "X=0:100", "--control", "gcode", *out]
        for args, words in (
                (["program", "--axis", "X=100:0", "--control", "gcode", *out], "FROM below TO"),
                (["program", "--axis", "X=0:nan", "--control", "gcode", *out], "FROM below TO"),
                (["program", "--axis", "X=0:1,5", "--control", "gcode", *out], "FROM below TO"),
                (["program", "--axis", "X", "--control", "gcode", *out], "FROM below TO"),
                (base + ["--axis", "X=0:5"], "is given twice"),
                (["program", "--axis", "X=0:100", "--control", "gcodes", *out], "control \"gcodes\" (nearest: \"gcode\")"),
                (["program", "--axis", "X=0:100", *out], "--control"),
                (base + ["--set", "dwell_s"], "NAME=VALUE"),
                (base + ["--set", "dwel_s=1"], "nearest: \"dwell_s\""),
                (base + ["--set", "dwell_s=0"], "expected at least"),
                (base + ["--set", "dwell_s=1,5"], "expected a number"),
                (base + ["--set", "runs=0"], "expected at least 1"),
                (base + ["--set", "programs=axis"], "expected axes, diagonals"),
                (base + ["--set", "programs=diagonals"], "there is none"),
                (base + ["--set", "programs=step-diagonals"], "axis Y: expected a linear axis"),
                (["program", "--axis", "X1=0:100", "--control", "gcode", *out], "a single letter"),
                (["program", "--axis", "X1=0:100", "--control", "heidenhain", *out], "a single letter"),
                (base + ["--set", "axes=Y"], "has no axis \"Y\""),
                (base + ["--set", "interval_mm=0.003"], "expected at most 100000"),
                (base + ["--set", "over_travel_mm=50"], "closer than"),
                (base + ["--set", "over_travel_mm=80"], "closer than"),
                (base + ["--n", "0", "--step-x", "1", "--step-y", "1"], "--n: expected"),
                (base + ["--n", "4", "--step-x", "0", "--step-y", "1"], "--step-x: expected more than 0"),
                (base + ["--n", "4", "--step-x", "1"], "--step-y: expected a number"),
                (base + ["--axis", "Y=0:100", "--n", "4", "--step-x", "25", "--step-y", "20"], "the travel is 100 mm"),
                (base + ["--axis", "Y=0:100", "--n", "3", "--step-x", "25", "--step-y", "20",
                         "--set", "programs=half-diagonal"], "wants an even number of steps")):
            done, files = self.program(*args, expect=2)
            self.assertIn(words, done.stderr, args)
            self.assertEqual(files, {}, args)


class Campaigns(VerbTest):
    def results(self, text, expect=0, **files):
        self.campaign(text, **files)
        out = self.site.parent / "out"
        done = self.nonio("run", self.site, "--out", out, expect=expect)
        return json.loads((out / "c" / "results.json").read_text()), out / "c", done

    def test_rows_in_the_results(self):
        results, folder, _ = self.results(CAMPAIGN + """
[run]
analyses = ["triple-planner"]
outputs = ["csv", "program-gcode", "pdf-report"]
[options.triple-planner]
max_step_mm = 500
max_points = 31
over_travel_mm = 10
[options.program-gcode]
over_travel_mm = 10
""")
        self.assertEqual(results["status"], "ok", results["errors"])
        analysis = results["analyses"][0]
        self.assertEqual(analysis["plugin"], "triple-planner")
        self.assertNotIn("measurement", analysis)
        for name in NAMES:
            self.assertIn(name, analysis["rows"][0])
        self.assertEqual(analysis["row_units"]["length_d"], "mm")
        self.assertLessEqual(analysis["rows"][0]["length_x"], 11980)
        self.assertTrue((folder / "rows-triple-planner.csv").exists())
        x = (folder / "program-gcode-X.ngc").read_text().splitlines()
        row = analysis["rows"][0]
        self.assertIn(f"G1 X{10 + row['step_x']:g}".split(".")[0], " ".join(x))
        self.assertEqual(len({line for line in x if line.startswith("G1")}), row["n"] + 3)
        self.assertIn("G1 X10.0 Y-8990.0", (folder / "program-gcode-D1.ngc").read_text())

    def test_only_on_request(self):
        text = CAMPAIGN + '[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n'
        results, folder, _ = self.results(text, x=readings())
        self.assertNotIn("triple-planner", [a["plugin"] for a in results["analyses"]])
        self.assertEqual(list(folder.glob("program-*")), [])
        results, folder, _ = self.results(text + "[options.triple-planner]\n", x=readings())
        self.assertIn("triple-planner", [a["plugin"] for a in results["analyses"]])

    def test_nothing_fits_is_a_finding(self):
        results, _, _ = self.results(CAMPAIGN + """
[run]
analyses = ["triple-planner"]
outputs = []
[options.triple-planner]
max_step_mm = 2
""")
        self.assertEqual(results["status"], "attention")
        finding = results["analyses"][0]["findings"][0]
        self.assertEqual(finding["id"], "triples.nothing-fits")
        self.assertIn("max_step_mm", finding["advice"])

    def test_errors_have_their_place(self):
        for options, words in (("x = \"U\"", "no axis \"U\""), ("over_travel_mm = 5000", "leave nothing of"),
                               ("resolution_mm = nan", "expected at least"), ("max_step_m = 3", "max_step_mm")):
            results, _, _ = self.results(
                CAMPAIGN + '[run]\nanalyses = ["triple-planner"]\noutputs = []\n[options.triple-planner]\n' + options,
                expect=1)
            self.assertEqual(results["status"], "failed", options)
            self.assertIn(words, results["errors"][0]["message"])
            self.assertEqual(results["errors"][0]["file"], "campaign.toml")

    def test_a_campaign_without_measurements_must_say_what_it_is_for(self):
        results, _, _ = self.results(CAMPAIGN, expect=1)
        self.assertIn("[[measurement]]", results["errors"][0]["message"])


if __name__ == "__main__":
    unittest.main()
