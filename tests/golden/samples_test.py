#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The samples are what their generator makes, and evaluate to the figures that they promise.

The evaluation here knows nothing of the program: the formulas of ISO 230-2:2014 (k = 2) and
VDI/DGQ 3441 written down once more.
"""
import csv
import filecmp
import importlib.util
import io
import math
import os
import re
import statistics
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SAMPLES = os.path.normpath(os.path.join(ROOT, "samples"))
SITE = os.path.join(SAMPLES, "site")


def files_below(folder):
    return sorted(os.path.relpath(os.path.join(base, name), folder)
                  for base, _, names in os.walk(folder) for name in names)


def readings(campaign, file):
    """{target: {"+": [...], "-": [...]}} in the order of the runs; missing ones left out."""
    with open(os.path.join(SITE, campaign, file), encoding="utf-8-sig", newline="") as opened:
        lines = [line for line in opened.read().splitlines() if not line.startswith("#")]
    separator = ";" if ";" in lines[0] else ","
    out = {}
    for row in csv.DictReader(io.StringIO("\n".join(lines)), delimiter=separator):
        target = row.get("target_mm") or row.get("target_deg")
        deviation = row.get("deviation_um", row.get("deviation_arcsec"))
        point = out.setdefault(float(target.replace(",", ".")), {"+": [], "-": []})
        if deviation not in ("", "n/a") and abs(float(deviation.replace(",", "."))) < 1e19:
            point[row["direction"]].append(float(deviation.replace(",", ".")))
    return dict(sorted(out.items()))


def evaluated(campaign, file):
    points = readings(campaign, file).values()
    mean = {d: [statistics.fmean(p[d]) for p in points] for d in "+-"}
    s = {d: [statistics.stdev(p[d]) for p in points] for d in "+-"}
    B_i = [a - b for a, b in zip(mean["+"], mean["-"])]
    S_j = [(a + b) / 2.0 for a, b in zip(s["+"], s["-"])]
    both = mean["+"] + mean["-"]
    upper = [m + 2.0 * x for d in "+-" for m, x in zip(mean[d], s[d])]
    lower = [m - 2.0 * x for d in "+-" for m, x in zip(mean[d], s[d])]
    return {"R+": 4.0 * max(s["+"]), "R-": 4.0 * max(s["-"]),
            "B": max(abs(b) for b in B_i), "B_mean": statistics.fmean(B_i),
            "E": max(both) - min(both), "A": max(upper) - min(lower),
            "Ps_max": 6.0 * max(S_j), "Ps_mean": 6.0 * statistics.fmean(S_j),
            "U_max": max(abs(b) for b in B_i), "U_mean": statistics.fmean(abs(b) for b in B_i)}


def expected(campaign):
    """{(analysis, measurement, value): number} of what golden.program has stored."""
    out = {}
    with open(os.path.join(ROOT, "tests", "golden", "expected", campaign, "results.txt"), encoding="utf-8") as opened:
        for line in opened:
            found = re.match(r"analyses\[(.+?)/(.+?)#1\]\.values\.(.+?)\.value = (.+)", line)
            if found:
                out[found.group(1, 2, 3)] = float(found.group(4))
    return out


def pass_means(campaign, file):
    """Mean deviation of each pass over the targets, in the order in which they were taken."""
    points = readings(campaign, file)
    runs = len(next(iter(points.values()))["+"])
    return [statistics.fmean(p[d][run] for p in points.values()) for run in range(runs) for d in "+-"]


class Samples(unittest.TestCase):
    def expect(self, found, wanted, decimals):
        for name, text in wanted.items():
            self.assertEqual("%.*f" % (decimals, found[name] + 0.0), text, name)

    def test_generator_gives_the_same_bytes(self):
        path = os.path.join(SAMPLES, "make_samples.py")
        spec = importlib.util.spec_from_file_location("make_samples", path)
        maker = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(maker)
        with tempfile.TemporaryDirectory() as folder:
            argv, sys.argv = sys.argv, [path, folder]
            try:
                maker.main()
            finally:
                sys.argv = argv
            self.assertEqual(files_below(os.path.join(folder, "site")), files_below(SITE))
            for name in files_below(folder):
                self.assertTrue(filecmp.cmp(os.path.join(folder, name), os.path.join(SAMPLES, name),
                                            shallow=False), name)

    def test_every_file_says_that_it_is_constructed(self):
        for name in files_below(SITE):
            with open(os.path.join(SITE, name), encoding="utf-8-sig") as opened:
                first = opened.readline().lower()
            word = "costruite" if "esportazione" in name else "constructed"
            if name == "site.toml":
                word = "sample"
            self.assertIn(word, first, name)

    def test_asymmetric_repeatability(self):
        self.expect(evaluated("01-asymmetric-repeatability", "x.csv"),
                    {"R+": "4.516", "R-": "1.756", "Ps_max": "4.275", "Ps_mean": "3.195"}, 3)

    def test_constant_reversal(self):
        self.expect(evaluated("02-constant-reversal", "z.csv"),
                    {"B_mean": "-8.143", "B": "8.943", "U_mean": "8.143", "U_max": "8.943"}, 3)

    def test_opposed_sinusoids(self):
        found = evaluated("03-opposed-sinusoids", "c.csv")
        self.expect(found, {"B": "5.58", "U_mean": "2.47", "U_max": "5.58"}, 2)
        self.assertLess(abs(found["B_mean"]), 0.005)

    def test_parallel_drift_moves_every_pass_up(self):
        means = pass_means("04-drift-parallel", "y.csv")
        for direction in (means[0::2], means[1::2]):
            steps = [b - a for a, b in zip(direction, direction[1:])]
            self.assertGreater(min(steps), 1.0)
            self.assertLess(max(steps) - min(steps), 0.8)

    def test_wedge_grows_along_the_travel(self):
        points = list(readings("05-drift-wedge", "x.csv").values())
        near = points[0]["+"][4] - points[0]["+"][0]
        far = points[-1]["+"][4] - points[-1]["+"][0]
        self.assertLess(abs(near), 4.0)
        self.assertGreater(far, 20.0)

    def test_long_axis_has_one_run_and_250_mm_between_targets(self):
        points = readings("06-long-axis", "x.csv")
        self.assertTrue(all(len(p["+"]) == 1 and len(p["-"]) == 1 for p in points.values()))
        places = list(points)
        self.assertGreater(places[-1] - places[0], 14000.0)
        self.assertAlmostEqual((places[-1] - places[0]) / (len(places) - 1), 250.0, delta=5.0)

    def test_italian_export(self):
        with open(os.path.join(SITE, "07-italian-spreadsheet", "esportazione.csv"), "rb") as opened:
            data = opened.read()
        self.assertTrue(data.startswith(b"\xef\xbb\xbf"))
        self.assertEqual(data.count(b"\n"), data.count(b"\r\n"))
        self.assertGreater(data.count(b"\r\n"), 90)
        rows = [line for line in data.splitlines()[1:] if not line.startswith(b"#")]
        self.assertTrue(all(b";" in row and b"." not in row for row in rows))

    def test_broken_file_is_broken_in_one_place(self):
        with open(os.path.join(SITE, "08-broken-file", "x.csv"), encoding="utf-8") as opened:
            lines = opened.read().split("\n")
        self.assertEqual([i + 1 for i, line in enumerate(lines[3:], 3) if "O" in line], [17])

    def test_tolerances_give_three_answers(self):
        found = evaluated("09-tolerances", "x.csv")
        self.assertLess(found["A"], 22.0 - 3.0)
        self.assertGreater(found["B"], 3.0 + 1.0)
        self.assertLess(abs(found["E"] - 12.0), 1.0)

    def test_step_diagonals_have_their_largest_error(self):
        for campaign, steps, travel, step, largest in (
                ("15-step-diagonal", 40, (800, 600, 600), (20, 15, 15), ("60.000", "6.800")),
                ("16-step-diagonal", 30, (900, 720, 720), (30, 24, 24), ("58.000", "8.700"))):
            self.assertEqual(tuple(t / steps for t in travel), step)
            with open(os.path.join(SITE, campaign, "campaign.toml"), encoding="utf-8") as opened:
                self.assertIn("to = { X = %d, Y = %d, Z = %d }" % travel, opened.read())
            for occasion, wanted in zip(("00", "final"), largest):
                program = expected(campaign)[("step-diagonal", "SD " + occasion, "D_max")]
                self.assertEqual("%.3f" % program, wanted)
                with open(os.path.join(SITE, campaign, "sd-%s.csv" % occasion), encoding="utf-8") as opened:
                    rows = list(csv.DictReader(line for line in opened if not line.startswith("#")))
                self.assertEqual(len(rows), 4 * 3 * steps)
                whole = [abs(float(row["deviation_um"])) for row in rows if int(row["step"]) % 3 == 0]
                self.assertEqual("%.3f" % max(whole), wanted, campaign + " " + occasion)

    def test_one_direction_has_no_other(self):
        self.assertTrue(all(len(p["+"]) == 5 and not p["-"]
                            for p in readings("10-one-direction", "z.csv").values()))

    def test_missing_and_misread(self):
        points = readings("11-missing-and-misread", "x.csv").values()
        self.assertEqual(sum(5 - len(p[d]) for p in points for d in "+-"), 3)
        far = [x for p in points for d in "+-" for x in p[d] if abs(x - statistics.median(p[d])) > 5.0]
        self.assertEqual(len(far), 1)

    def test_straightness_bows(self):
        points = list(readings("12-straightness", "x-in-y.csv").values())
        middle = statistics.fmean(points[len(points) // 2]["+"])
        self.assertGreater(middle - statistics.fmean(points[0]["+"]), 4.0)
        self.assertGreater(middle - statistics.fmean(points[-1]["+"]), 4.0)

    def test_gantry_diagonals_close_and_the_third_one_separates_the_axes(self):
        def mean(file):
            return [(statistics.fmean(p["+"]) + statistics.fmean(p["-"])) / 2.0
                    for p in readings("13-gantry-diagonals", file).values()]

        x1, x2, y = mean("x1.csv"), mean("x2.csv"), mean("y.csv")
        n, c, s = 30, 0.8, 0.6

        def x_error(i, j):  # on the line y_j, from the two lines at 300 and 8700 mm
            second = (300.0 * j - 300.0) / 8400.0
            return (1.0 - second) * (x1[i] - x1[0]) + second * (x2[i] - x2[0])

        def less_pitch(file, rising):
            d = mean(file)
            def part(i):
                j = i if rising else n - i
                return d[i] - c * x_error(i, j) - (s if rising else -s) * y[j]
            return [part(i) - part(0) for i in range(n + 1)]

        for when, square in (("00", 8.0), ("final", 0.3)):
            d1 = less_pitch("d1-%s.csv" % when, True)
            d2 = less_pitch("d2-%s.csv" % when, False)
            self.assertLess(abs(d1[n] + d2[n]), 4.0 * 2.45 * 0.5)
            self.assertAlmostEqual(-(d1[n] - d2[n]) * 15.0 / (2.0 * 12.0 * 9.0), square, delta=0.2)
        # Larger than what positioning leaves, at points that do not correspond.
        before = [less_pitch("d1-00.csv", True), less_pitch("d2-00.csv", False)]
        shapes = [[v - d[n] * i / n for i, v in enumerate(d)] for d in before]
        worst = [max(range(n + 1), key=lambda i: abs(d[i])) for d in shapes]
        self.assertGreater(abs(worst[0] - worst[1]), 4)
        self.assertGreater(max(map(abs, before[0])), 3.0 * max(map(abs, x1 + x2 + y)))

    def test_gantry_tables_keep_both_sides_together(self):
        """The tables of X and X2, read here: what is left of each side, of racking, and of the squareness."""
        def mean(file):
            values = [(statistics.fmean(p["+"]) + statistics.fmean(p["-"])) / 2.0
                      for p in readings("13-gantry-diagonals", file).values()]
            return [v - values[0] for v in values]

        def table(axis):
            with open(os.path.join(ROOT, "tests", "golden", "expected", "13-gantry-diagonals",
                                   "siemens-840d-%s-EEC.ini" % axis), encoding="utf-8") as opened:
                entries = re.findall(r"^\$AA_ENC_COMP\[0,(\d+),AX\d+\]=(\S+)$", opened.read(), re.M)
            self.assertEqual([int(i) for i, _ in entries], list(range(31)))
            return [1000.0 * float(value) for _, value in entries]

        x1, x2 = mean("x1.csv"), mean("x2.csv")
        apart = [b - a for a, b in zip(x1, x2)]
        left = [[x - t for x, t in zip(side, table(axis))] for side, axis in ((x1, "X"), (x2, "X2"))]
        for side in left:
            self.assertLess(max(map(abs, side)), 0.01)
        program = expected("13-gantry-diagonals")
        self.assertAlmostEqual(program[("diagonal-straightness", "D1 00", "racking")], max(apart) - min(apart), delta=1e-6)
        self.assertLess(max(b - a for a, b in zip(*left)) - min(b - a for a, b in zip(*left)), 0.02)
        self.assertEqual("%.2f" % program[("diagonal-straightness", "D1 00", "slave_shift")], "67.20")
        self.assertAlmostEqual(program[("diagonal-straightness", "D1 00", "slave_shift")] / 8.4,
                               program[("diagonal-straightness", "D1 00", "C0Y")], delta=1e-6)

    def test_gantry_cross_tables_move_both_sides_and_the_diagonals_fall(self):
        """All tables of the sample, read here: what they do to a rigid beam with X at 300 mm and X2 at 8700 mm of Y."""
        folder = os.path.join(ROOT, "tests", "golden", "expected", "13-gantry-diagonals")
        tables = {}
        for name in sorted(os.listdir(folder)):
            with open(os.path.join(folder, name), encoding="utf-8") as opened:
                text = opened.read()
            if name.endswith("-CEC.ini"):
                axes = {k: (out, of) for (k, of), (_, out) in zip(
                    re.findall(r"^\$AN_CEC_INPUT_AXIS\[(\d+)\]=\(AX(\d+)\)$", text, re.M),
                    re.findall(r"^\$AN_CEC_OUTPUT_AXIS\[(\d+)\]=\(AX(\d+)\)$", text, re.M))}
                for k, key in axes.items():
                    tables[key] = [-1000.0 * float(v) for v in re.findall(r"^\$AN_CEC\[%s,\d+\]=(\S+)$" % k, text, re.M)]
            elif name.endswith("-EEC.ini"):
                axis = re.search(r"^\$AA_ENC_COMP\[0,0,AX(\d+)\]", text, re.M).group(1)
                tables[(axis, axis)] = [-1000.0 * float(v) for v in re.findall(r"^\$AA_ENC_COMP\[0,\d+,AX\d+\]=(\S+)$", text, re.M)]
        self.assertEqual(set(tables), {("1", "1"), ("2", "2"), ("4", "4"), ("2", "1"), ("1", "2"), ("4", "2")})
        self.assertEqual(tables[("1", "2")], tables[("4", "2")])
        n, c, s = 30, 0.8, 0.6
        for file, rising, name in (("d1-00.csv", True, "D1"), ("d2-00.csv", False, "D2")):
            left = []
            for i, p in enumerate(readings("13-gantry-diagonals", file).values()):
                j = i if rising else n - i
                share = 1.0 - (300.0 * j - 300.0) / 8400.0
                one, other = (tables[(side, side)][i] + tables[(side, "2")][j] for side in "14")
                x = share * one + (1.0 - share) * other
                y = tables[("2", "2")][j] + tables[("2", "1")][i]
                left.append((statistics.fmean(p["+"]) + statistics.fmean(p["-"])) / 2.0 + c * x + (s if rising else -s) * y)
            self.assertLess(max(left) - min(left), 3.0, name)

    def test_rotary_table_turns_about_its_lines(self):
        for file, count, point, lean in (
                ("c.csv", 8, (412.300, 305.120, -148.600), (0.00012, -0.00008, 1.0)),
                ("b.csv", 11, (412.286, 0.0, -310.045), (0.00015, 1.0, -0.00007))):
            with open(os.path.join(SITE, "14-rotary-table", file), encoding="utf-8") as opened:
                rows = list(csv.DictReader(line for line in opened if not line.startswith("#")))
            self.assertEqual(len(rows), count)
            size = math.sqrt(sum(v * v for v in lean))
            for row in rows:
                arm = [float(row[k + "_mm"]) - p for k, p in zip("xyz", point)]
                along = sum(a * v for a, v in zip(arm, lean)) / size
                radius = math.sqrt(sum(a * a for a in arm) - along * along)
                # 1 um of noise; the first place of B is 20 um nearer to its inclined axis line.
                self.assertAlmostEqual(radius, 261.0, delta=0.03)
            self.assertEqual(len({row["angle_deg"] for row in rows}), count)

    def test_square_turned_over(self):
        def slope(name):
            points = readings("19-square-turned-over", name + ".csv").items()
            x = [p for p, _ in points]
            y = [(statistics.fmean(r["+"]) + statistics.fmean(r["-"])) / 2.0 for _, r in points]
            return 1000.0 * statistics.linear_regression(x, y).slope  # um/m
        stands, turned = slope("qx") + slope("qy"), slope("qx-turned") + slope("qy-turned")
        self.assertAlmostEqual(-(stands + turned) / 2.0, 22.0, delta=0.01)
        self.assertAlmostEqual((stands - turned) / 2.0, -14.0, delta=0.01)
        program = expected("19-square-turned-over")
        self.assertAlmostEqual(program[("square", "QX", "C0Y_LSQ")], -(stands + turned) / 2.0, delta=1e-6)
        self.assertAlmostEqual(program[("square", "QX", "square_error")], (stands - turned) / 2.0, delta=1e-6)

    def test_every_rule(self):
        found = {name: value for (_, _, name), value in expected("21-every-rule").items()}
        points = readings("21-every-rule", "x.csv")
        mean = {(x, d): statistics.fmean(p[d]) for x, p in points.items() for d in "+-"}
        s = {(x, d): statistics.stdev(p[d]) for x, p in points.items() for d in "+-"}
        high = {k: max(mean[x, d] + k * s[x, d] for x in points for d in "+-") for k in (2, 3)}
        low = {k: min(mean[x, d] - k * s[x, d] for x in points for d in "+-") for k in (2, 3)}
        offset = statistics.fmean(mean.values())
        every = [x for p in points.values() for d in "+-" for x in p[d]]
        wanted = {"iso-2014:A": high[2] - low[2], "gb-10931:A": high[3] - low[3],
                  "upr:UPR": min(max(4 * s[x, d] for x in points) for d in "+-"),
                  "nmtba:+-accuracy": max(abs(m) + 3 * s[at] for at, m in mean.items()),
                  "nmtba-no-offset:+-accuracy": max(abs(m - offset) + 3 * s[at] for at, m in mean.items()),
                  "b5.54-1992:A'": max(every) - min(every),
                  "jis-6330:accuracy": max(p["+"][0] for p in points.values()) - min(p["+"][0] for p in points.values())}
        self.expect(found, {name: "%.4f" % value for name, value in wanted.items()}, 4)
        self.assertEqual(len({name.split(":")[0] for name in found if ":" in name}), 20)

    def test_body_diagonals(self):
        """What the program makes of each diagonal is what this file makes of it; the machine's is the largest."""
        program = expected("20-body-diagonals")
        for when in ("00", "final"):
            names = ["%s %s" % (d, when) for d in ("PPP", "NPP", "PNP", "PPN")]
            here = [evaluated("20-body-diagonals", n.lower().replace(" ", "-") + ".csv") for n in names]
            for name, values in zip(names, here):
                for value in ("E", "B", "R+", "R-", "A"):
                    self.assertAlmostEqual(program[("iso230-6", name, value)], values[value], delta=1e-6)
            for value in "EB":
                self.assertAlmostEqual(program[("iso230-6", names[0], value + "_d")], max(v[value] for v in here), delta=1e-6)
        self.assertGreater(program[("iso230-6", "PPP final", "E_d")], program[("iso230-6", "PPP 00", "E_d")])
        self.assertAlmostEqual(program[("before-after", "X final", "left_share")], 0.0, delta=0.05)
        self.assertAlmostEqual(program[("before-after", "Y final", "left_share")], 2.0, delta=0.1)

    def test_the_map_of_the_volume_is_that_of_the_machine(self):
        """The errors that the generator put in, at the nodes of the map; good body diagonals do not show them."""
        sys.path.insert(0, SAMPLES)
        from in_volumes import Rolling
        machine, rows = Rolling(), {}
        with open(os.path.join(ROOT, "tests", "golden", "expected", "23-whole-volume", "results.txt"), encoding="utf-8") as opened:
            for found in re.finditer(r"^analyses\[rigid-body/X1#1\]\.rows\[#(\d+)\]\.(\w+) = (.+)$", opened.read(), re.M):
                rows.setdefault(int(found.group(1)), {})[found.group(2)] = float(found.group(3))
        self.assertEqual(len(rows), 27)
        zero = machine.error(*(v / 2.0 for v in machine.travel))
        inside, largest = 0, 0.0
        for row in rows.values():
            true = [e - z for e, z in zip(machine.error(row["X"], row["Y"], row["Z"]), zero)]
            largest = max(largest, math.hypot(*true))
            inside += sum(abs(row["e_" + k] - e) <= row["U_" + k] for k, e in zip("xyz", true))
        self.assertGreater(inside, 0.9 * 81)
        program = expected("23-whole-volume")
        self.assertAlmostEqual(program[("rigid-body", "X1", "V_max")], largest, delta=1.1)
        self.assertGreater(largest, 2.5 * program[("iso230-6", "PPP", "E_d")])


if __name__ == "__main__":
    unittest.main()
