#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tables of every control, read back by parsers that know the makers' words and not our code.

With e = actual - nominal, what a table adds to the position must be -e (plus a constant).
"""
import math
import random
import re
import unittest

from bench import BenchTest, axis_csv, interpolate, wave
from parsers import TABLE, cec

TARGETS = [25.0 * i for i in range(17)]  # mm, 0 to 400
LOST = 3.0  # um: the axis stays behind by as much when it comes from above


def numbers(line, separator=None):
    return [float(word) for word in line.split(separator)]


def points_of(text, mark="#"):
    """rows of numbers behind the comments"""
    return [numbers(line) for line in text.splitlines() if line and not line.startswith(mark)]


class Axis(BenchTest):
    def write(self, control, name, options="", targets=TARGETS, plus=wave, minus=None, **more):
        minus = minus or (lambda x: plus(x) + LOST)
        self.one_axis(targets, plus, minus, options, control, **more)
        results = self.run_site()
        self.assertEqual([o["plugin"] for o in results["outputs"] if o["file"] == name], [control])
        return self.file(name)

    def expect_correction(self, points, wanted, tolerance):
        """points: (mm, um that is added); a constant is free"""
        for x in TARGETS:
            found = interpolate(points, x) - interpolate(points, TARGETS[0])
            self.assertAlmostEqual(found, wanted(x) - wanted(TARGETS[0]), delta=tolerance, msg="at %g" % x)

    def test_fagor_8055(self):
        for sign in ("error", "correction"):
            text = self.write("fagor-8055", "fagor-8055-X.txt", '[options.fagor-8055]\nsign = "%s"\n' % sign)
            rows = points_of(text)
            self.assertTrue(all(r[3] == 0.0 for r in rows))
            of = -1.0 if sign == "error" else 1.0
            self.expect_correction([(r[1], of * r[2] * 1e3) for r in rows], lambda x: -wave(x), 0.11)

    def test_fagor_8055_in_both_directions(self):
        self.write("fagor-8055", "fagor-8055-X.txt",
                   '[options.fagor-8055]\nsign = "error"\ndirections = true\n')
        rows = points_of(self.file("fagor-8055-X.txt"))
        self.expect_correction([(r[1], -r[2] * 1e3) for r in rows], lambda x: -wave(x), 0.11)
        for r in rows:
            self.assertAlmostEqual((r[3] - r[2]) * 1e3, LOST, delta=0.11)

    def test_nothing_without_a_known_sign(self):
        for control in ("fagor-8055", "haas-classic", "twincat-volumetric"):
            self.one_axis([-12.7 * i for i in range(10)][::-1], wave, control=control)
            results = self.run_site(expect=1)
            self.assertEqual(results["status"], "failed")
            self.assertIn("sign probe", results["errors"][0]["message"])

    def test_haas_classic(self):
        targets = [-25.4 * i for i in range(12)][::-1]
        self.write("haas-classic", "haas-classic-X.txt", '[options.haas-classic]\nsign = "correction"\n', targets)
        rows = points_of(self.file("haas-classic-X.txt"))
        self.assertEqual([r[1] for r in rows], [-0.5 * i for i in range(23)])
        self.assertEqual(rows[0][2], 0.0)  # machine zero
        for _, x, value in rows:
            mm = x * 25.4
            e = interpolate([(t, wave(t)) for t in targets], mm)
            self.assertAlmostEqual(value * 25.4e3, -(e - wave(0.0)), delta=1.3)

    def test_mitsubishi(self):
        # (division interval - way moved) x 2, in um, for each interval
        text = self.write("mitsubishi", "mitsubishi-X.txt", '[options.mitsubishi]\naxes = ["X reference_mm=100"]\n')
        rows = points_of(text)
        self.assertEqual([int(r[0]) for r in rows], [-4, -3, -2, -1] + list(range(1, 13)))
        total = {0: 0}
        for k in range(1, 13):
            total[k] = total[k - 1] + [r[2] for r in rows if r[0] == k][0]
        for k in range(-1, -5, -1):  # feeding from k + 1 to k takes the number of k back
            total[k] = total[k + 1] - [r[2] for r in rows if r[0] == k][0]
        for k, pulses in total.items():
            self.assertAlmostEqual(pulses / 2.0, -(wave(100.0 + 25.0 * k) - wave(100.0)), delta=0.2501)

    def test_mitsubishi_by_hand(self):
        # 100 mm come out 3 um too long, then 5 um too short: -6 and +10
        text = self.write("mitsubishi", "mitsubishi-X.txt", targets=[0.0, 100.0, 200.0],
                          plus=lambda x: {0.0: 0.0, 100.0: 3.0, 200.0: -2.0}[x])
        self.assertEqual([r[2] for r in points_of(text) if r[0] > 0], [-6.0, 10.0])

    def test_twincat_nc_ptp(self):
        text = self.write("twincat-nc-ptp", "twincat-nc-ptp-X.st")
        found = re.findall(r"\(Position := ([-\d.]+), Compensation := ([-\d.]+)\)", text)
        self.assertEqual(len(found), 17)
        self.assertIn("ARRAY[1..17] OF ST_PositionCompensationTableElement", text)
        self.assertIn("MinPosition := 0.0, MaxPosition := 400.0, NoOfTableElements := 17", text)
        self.expect_correction([(float(x), float(c) * 1e3) for x, c in found], lambda x: -wave(x), 0.002)

    def ssfk(self, text):
        keys = dict(line.split(None, 1) for line in text.splitlines() if line and not line.startswith("#"))
        step, start = int(keys["kw.ssfk.interval"]), int(keys["kw.ssfk.kw_startpos"])
        n = int(keys["kw.ssfk.kw_nr_max"])
        side = lambda s: [(1e-4 * (start + step * i), 0.1 * int(keys["kw.ssfk.table[%d].%s" % (i, s)]))
                          for i in range(n)]
        return keys, side

    def test_twincat_cnc(self):
        keys, side = self.ssfk(self.write("twincat-cnc", "twincat-cnc-X.lis"))
        self.assertEqual((keys["kopf.achs_nr"], keys["kw.ssfk.unit"], keys["kw.ssfk.bilateral"]), ("1", "1", "0"))
        self.expect_correction([(x, -v) for x, v in side("pos")], lambda x: -wave(x), 0.11)
        self.assertRegex(self.file("twincat-cnc-X.lis"), r"getriebe\[0\]\.lose = 30 \(a whole number of 0\.1 um: 0\.003 mm\)")

    def test_twincat_cnc_bilateral_replaces_backlash(self):
        # 10 um were in the parameter, and 3 um were still lost: 13 um come into the two columns
        self.active_backlash = "0.010"
        keys, side = self.ssfk(self.write(
            "twincat-cnc", "twincat-cnc-X.lis", "[options.twincat-cnc]\ndirections = true\n"))
        self.assertEqual(keys["kw.ssfk.bilateral"], "1")
        self.expect_correction([(x, -v) for x, v in side("pos")], lambda x: -wave(x), 0.11)
        for (_, up), (_, down) in zip(side("pos"), side("neg")):
            self.assertAlmostEqual(down - up, 13.0, delta=0.11)

    def test_ecmc(self):
        for release, of in ((10, 1.0), (9, -1.0)):  # 9: the value was added to the reading
            text = self.write("ecmc", "ecmc-X.corr", "[options.ecmc]\nrelease = %d\n" % release)
            self.assertIn("mean reversal B = -3.0 um: it stays", text)
            rows = points_of(text)
            mean = lambda x: wave(x) + LOST / 2
            self.expect_correction([(x, of * v * 1e3) for x, v in rows], lambda x: -mean(x), 0.002)
            # reading - value is the truth: the axis goes on until that is the target
            for target in TARGETS:
                reading = target
                for _ in range(5):
                    reading = target + of * interpolate(rows, reading)
                actual = reading + mean(reading) * 1e-3
                self.assertAlmostEqual(actual, target, delta=1e-5)

    def aerotech(self, text):
        head, values = [], []
        for line in text.splitlines():
            line = re.split("[;']", line)[0].strip()
            if line.startswith(":START"):
                head += line.split()[1:]
            elif line == ":END":
                return head, values
            elif line:
                values.append(numbers(line))
        self.fail("no :END")

    def test_aerotech(self):
        head, values = self.aerotech(self.write("aerotech", "aerotech-X.cal"))
        self.assertEqual(head[:2], ["1", "SAMPLEDIST=25.0"])
        self.expect_correction([(25.0 * i, v[0] * 1e3) for i, v in enumerate(values)], lambda x: -wave(x), 0.002)

    def test_aerotech_below_home(self):
        targets = [-25.0 * i for i in range(17)][::-1]
        head, values = self.aerotech(self.write("aerotech", "aerotech-X.cal", targets=targets))
        self.assertEqual(head[1], "SAMPLEDIST=-25.0")
        self.assertEqual(values[0], [0.0])
        for i, v in enumerate(values):
            self.assertAlmostEqual(v[0] * 1e3, -(wave(-25.0 * i) - wave(0.0)), delta=0.002)

    def pmac(self, text):
        words = re.match(r"#(\d+) DEFINE COMP (\d+),(\d+)\n([-\d\s]+)$", text)
        motor, entries, span = (int(words[i]) for i in (1, 2, 3))
        values = [int(word) for word in words[4].split()]
        self.assertEqual(len(values), entries)
        return motor, span, values

    def test_pmac_by_the_printed_numbers(self):
        # The maker's example: the load is at these counts when the motor is at 500, 1000, ...
        load = [0, 510, 995, 1492.5, 1994, 2497.5, 3003.5, 3500.5]
        e = {0.5 * i: load[i] - 500.0 * i for i in range(8)}  # counts = um at 1000 counts/mm
        self.travel = "travel = [0.0, 3.5]\n"  # no entries that hold the ends
        text = self.write("pmac", "pmac-X.pmc", '[options.pmac]\naxes = ["X number=3 counts_per_mm=1000"]\n',
                          [0.5 * i for i in range(8)], lambda x: e[x])
        self.assertEqual(self.pmac(text), (3, 4000, [-160, 80, 120, 96, 40, -56, -8, 0]))
        self.assertIn("I51 = 1", self.file("pmac-X.txt"))

    def test_pmac_rolls_over(self):
        targets = [-100.0 + 25.0 * i for i in range(13)]
        self.travel = "travel = [-100.0, 200.0]\n"
        motor, span, values = self.pmac(self.write(
            "pmac", "pmac-X.pmc", '[options.pmac]\naxes = ["X counts_per_mm=2000"]\n', targets))
        self.assertEqual((motor, span, len(values)), (1, 13 * 50000, 13))
        self.assertEqual(values[-1], 0)
        for x in targets:  # entry k is that of (k + 1) spacings, negative positions from above
            index = (round(x / 25.0) - 1) % 13
            self.assertAlmostEqual(values[index] / 16.0 / 2.0, -(wave(x) - wave(0.0)), delta=0.032)

    def test_pmac_holds_its_ends_over_the_travel(self):
        targets = [-100.0 + 25.0 * i for i in range(13)]
        self.travel = "travel = [-160.0, 230.0]\n"
        motor, span, values = self.pmac(self.write(
            "pmac", "pmac-X.pmc", '[options.pmac]\naxes = ["X counts_per_mm=2000"]\n', targets))
        self.assertEqual((span, len(values)), (18 * 50000, 18))  # 2 points above, 3 below
        at = lambda x: values[(round(x / 25.0) - 1) % 18] / 16.0 / 2.0
        for x, end in ((225.0, 200.0), (250.0, 200.0), (-125.0, -100.0), (-175.0, -100.0)):
            self.assertEqual(at(x), at(end))
        self.assertIn("from -175.0 mm to 250.0 mm the value of the nearest end holds", self.file("pmac-X.txt"))

    def test_turns_close(self):
        targets = [15.0 * i for i in range(24)]
        turn = lambda x: 5.0 * math.sin(math.radians(x))  # arcsec
        for control, name, options in (("twincat-cnc", "twincat-cnc-C.lis", ""),
                                       ("ecmc", "ecmc-C.corr", ""),
                                       ("pmac", "pmac-C.pmc", '[options.pmac]\naxes = ["C counts_per_deg=10000"]\n'),
                                       ("fagor-8055", "fagor-8055-C.txt", '[options.fagor-8055]\nsign = "error"\n'),
                                       ("twincat-nc-ptp", "twincat-nc-ptp-C.st", "")):
            text = self.write(control, name, options, targets, turn, unit="deg", axis="C")
            if control == "twincat-cnc":
                keys, side = self.ssfk(text)
                self.assertEqual((keys["kw.ssfk.modulo"], keys["kw.ssfk.kw_nr_max"]), ("1", "25"))
                ends = [side("pos")[0][1], side("pos")[-1][1]]
            elif control == "pmac":
                motor, span, values = self.pmac(text)
                self.assertEqual(span, 3600000)
                self.assertAlmostEqual(values[5] / 16 / 10000 * 3600, -5.0, delta=0.02)  # at 90 deg
                ends = [0, values[-1]]
            elif control == "twincat-nc-ptp":
                self.assertIn("Modulo := TRUE", text)
                found = re.findall(r"Position := ([-\d.]+), Compensation := ([-\d.]+)", text)
                self.assertEqual((found[0][0], found[-1][0]), ("0.0", "360.0"))
                ends = [found[0][1], found[-1][1]]
            else:
                rows = points_of(text)
                self.assertEqual((rows[0][-3 if control == "fagor-8055" else 0], rows[-1][-3 if control == "fagor-8055" else 0]), (0.0, 360.0))
                ends = [rows[0][1 if control == "ecmc" else 2], rows[-1][1 if control == "ecmc" else 2]]
            self.assertEqual(ends[0], ends[1], control)


def columns_of(text):
    """(output, input): points in um over mm, of a .COM of Heidenhain, with listed or with even positions."""
    lines = text.splitlines()
    heads = [(m[0], m.start()) for m in re.finditer(r"\S+", lines[1])] + [("", None)]
    even = re.search(r"DATUM:(\S+) DISTANCE:(\S+)", lines[0])
    at = lambda line: float(even[1]) + float(even[2]) * int(line.split()[0]) if even else float(line.split()[1])
    out = {}
    for (axis, start), (_, end) in list(zip(heads, heads[1:]))[1 if even else 3:]:
        points = [(at(l), 1e3 * float(l[start:end])) for l in lines[2:] if l[:1].isdigit() and l[start:end].strip()]
        if points:
            out[axis, re.match(r"BEGIN AXIS[_-]([A-Z])", lines[0])[1]] = points
    return out


class CrossWords(BenchTest):
    """What texts and messages state about cross tables is what the files contain."""

    def assert_true(self, text, tables, results, control):
        said = re.findall(r"(\w+) over (\w+): zero at (\S+) mm of \w+(?:, taken as reference point)?; "
                          r"largest entry (\S+) um at (\S+) mm, steepest (\S+) um/m", text)
        self.assertEqual({(o, i) for o, i, *_ in said}, set(tables), control)
        digit = 0.000501
        true = {}
        for output, by, zero, largest, where, steep in said:
            points = sorted(tables[output, by])
            case = "%s: %s over %s" % (control, output, by)
            true[output, by] = float(largest), float(steep)
            self.assertAlmostEqual(interpolate(points, float(zero)), 0.0, delta=0.051, msg=case)
            self.assertAlmostEqual(max(abs(v) for _, v in points), float(largest), delta=digit, msg=case)
            self.assertAlmostEqual(abs(interpolate(points, float(where))), float(largest), delta=digit, msg=case)
            slopes = [abs(v - u) / (b - a) * 1e3 for (a, u), (b, v) in zip(points, points[1:])]
            self.assertAlmostEqual(max(slopes), float(steep), delta=digit, msg=case)
        notes = [n for t in results["tables"] for n in t["notes"]]
        found = [m for n in notes for m in re.findall(r"(\w+) over (\w+): .*largest entry is (\S+) um, its steepest change (\S+) um/m", n)]
        self.assertEqual({(o, i) for o, i, *_ in found}, set(tables), notes)
        for output, by, largest, steep in found:
            for one, other in zip((float(largest), float(steep)), true[output, by]):
                self.assertAlmostEqual(one, other, delta=0.0051 * max(other, 0.1), msg="%s %s" % (control, notes))


class Planes(CrossWords):
    """A gantry with straightness and squareness, from its diagonals."""

    L = {"X": 1200.0, "Y": 900.0}  # mm; diagonals of 1500
    SQUARE = 8e-6  # C0Y, rad: +Y turns towards -X

    def setUp(self):
        super().setUp()
        self.ranges = {}

    def y_over_x(self, x):
        return 12.0 * math.sin(math.pi * x / self.L["X"])

    def x_over_y(self, y):
        return -7.0 * math.sin(2.0 * math.pi * y / self.L["Y"]) - self.SQUARE * y * 1e3

    def gantry(self, control, extra="", size=1.0, old=None, active=None):
        """`old`: what the active cross tables add to X and Y, um; `active`: their files by axis."""
        old = old or {"X": lambda y: 0.0, "Y": lambda x: 0.0}
        x_over_y = lambda y: size * self.x_over_y(y) + old["X"](y)
        y_over_x = lambda x: size * self.y_over_x(x) + old["Y"](x)
        files = {}
        for name, axis, more in (("X1", "X", "at = { Y = 100 }"), ("X2", "X", "at = { Y = 800 }"), ("Y", "Y", "")):
            targets = [self.L[axis] * i / 30 for i in range(31)]
            files[name] = ("axis", axis_csv(targets, lambda x: 0.0, lambda x: 0.0),
                           'axis = "%s"\n%s' % (axis, more))
        for name, start, end, n in (("D1", 0, 900, 30), ("D2", 900, 0, 30), ("D3", 0, 450, 15)):
            length = math.hypot(1200.0, end - start)

            def along(d, start=start, end=end, length=length):
                x, y = 1200.0 * d / length, start + (end - start) * d / length
                return (1200.0 * (x_over_y(y) - x_over_y(start)) + (end - start) * (y_over_x(x) - y_over_x(0.0))) / length
            self.ranges[name] = [along(length * i / n) for i in range(n + 1)]
            files[name] = ("diagonal", axis_csv([length * i / n for i in range(n + 1)], along, along),
                           "from = { X = 0, Y = %d }\nto = { X = 1200, Y = %d }" % (start, end))
        for finding in ("readings-all-equal", "file-twice"):
            extra += '[[tables.accept]]\nfinding = "plausibility.%s"\nreason = "positioning is made perfect"\n' % finding
        self.campaign(files, extra, (("X", "linear"), ("Y", "linear")), control)
        path = self.folder / "campaign.toml"
        for axis, names in (active or {}).items():
            path.write_text(path.read_text().replace('[machine.axes.%s]\nkind = "linear"\nactive_table = "none"' % axis,
                                                     '[machine.axes.%s]\nkind = "linear"\nactive_table = "%s"' % (axis, names)))
        return self.run_site(expect=None if active else 0)

    def added(self, control):
        """What the cross tables in the output add to X over Y and to Y over X, um over mm."""
        if control == "aerotech":
            rows = [numbers(l) for l in self.file("aerotech-plane-D1.cal").splitlines() if l and l[0] not in ":;"]
            return {"X": [(30.0 * j, row[0]) for j, row in enumerate(rows)], "Y": [(40.0 * i, v) for i, v in enumerate(rows[0][1::2])]}
        out = {}
        for axis in "XY":
            keys = dict(line.split(None, 1) for line in self.file("twincat-cnc-cross-%s.lis" % axis).splitlines() if not line.startswith("#"))
            row = lambda i, what: int(keys["kw.crosscomp.table[%d].%s" % (i, what)])
            out[axis] = [(row(i, "setpoint") * 1e-4, row(i, "correction") * 0.1) for i in range(int(keys["kw.crosscomp.last_index"]) + 1)]
        return out

    def test_a_cross_table_over_an_active_one(self):
        """The new one is complete, and the diagonals are predicted over the old one."""
        for control, extra, names in (("aerotech", "", {a: "aerotech-plane-D1.cal" for a in "XY"}),
                                      ("twincat-cnc", '[options.twincat-cnc]\ncross_sign = "correction"\n',
                                       {a: "twincat-cnc-cross-%s.lis" % a for a in "XY"})):
            with self.subTest(control=control):
                self.gantry(control, extra)
                old = {a: (lambda x, p=p: interpolate(p, x)) for a, p in self.added(control).items()}
                for name in set(names.values()):
                    (self.folder / name).write_text(self.file(name))
                results = self.gantry(control, extra, 1.5, old, names)
                self.assertEqual(results["errors"], [])
                for axis, true in (("X", self.x_over_y), ("Y", self.y_over_x)):
                    for x, c in self.added(control)[axis]:
                        self.assertAlmostEqual(c, -1.5 * (true(x) - true(0.0)), delta=0.15)
                predicted = {p["name"]: p for t in results["tables"] for p in t["predictions"] if p["name"] in ("D1", "D2")}
                self.assertEqual(sorted(predicted), ["D1", "D2"])
                for name, p in predicted.items():
                    self.assertAlmostEqual(p["before"], max(self.ranges[name]) - min(self.ranges[name]), delta=0.1)
                    self.assertLess(p["predicted"], 0.3)

    def test_the_words_about_cross_tables_are_true(self):
        seed = random.SystemRandom().randrange(1, 10**9)
        print("seed %d" % seed)
        rng = random.Random(seed)
        for control, extra in (("siemens-840d", ""), ("heidenhain-tnc", ""), ("heidenhain-tnc", '[options.heidenhain-tnc]\nlayout = "itnc530"\n'),
                               ("aerotech", ""), ("twincat-cnc", '[options.twincat-cnc]\ncross_sign = "error"\n')):
            self.tearDown(), self.setUp()
            results = self.gantry(control, extra, rng.uniform(0.3, 2.0))
            files = {p.name: p.read_text() for p in (self.out / "c").iterdir() if p.name.startswith(control)}
            if control == "siemens-840d":
                tables = {("XY"[o - 1], "XY"[i - 1]): t.plus for n, f in files.items() if "CEC" in n for i, o, t in cec(f)}
            elif control == "heidenhain-tnc":
                tables = {}
                for f in files.values():
                    if f.startswith("BEGIN AXIS"):
                        tables |= {k: v for k, v in columns_of(f).items() if k[0] != k[1]}
            else:
                tables = {("X", "Y"): self.added(control)["X"], ("Y", "X"): self.added(control)["Y"]}
            self.assertTrue(tables, control)
            self.assert_true("\n".join(files.values()), tables, results, control)

    def test_crosscomp_needs_a_sign(self):
        results = self.gantry("twincat-cnc")
        self.assertFalse([o for o in results["outputs"] if "cross" in o["file"]])
        for sign, of in (("error", -1.0), ("correction", 1.0)):
            results = self.gantry("twincat-cnc", '[options.twincat-cnc]\ncross_sign = "%s"\n' % sign)
            text = self.file("twincat-cnc-cross-X.lis")
            keys = dict(line.split(None, 1) for line in text.splitlines() if not line.startswith("#"))
            self.assertEqual((keys["kopf.achs_nr"], keys["kw.crosscomp.master_ax_nr"]), ("1", "2"))
            n = int(keys["kw.crosscomp.last_index"]) + 1
            for i in range(n):
                y = int(keys["kw.crosscomp.table[%d].setpoint" % i]) * 1e-4
                c = int(keys["kw.crosscomp.table[%d].correction" % i]) * 0.1
                self.assertAlmostEqual(of * c, -self.x_over_y(y), delta=0.12)

    def test_volumetric_csv(self):
        self.gantry("twincat-volumetric", '[options.twincat-volumetric]\nsign = "error"\n')
        rows = {}
        names = None
        for line in self.file("twincat-volumetric-XY.csv").splitlines():
            line = line.split("//")[0].strip()
            if line.startswith("#"):
                names = None
            elif line and names is None:
                names = line.split()
            elif line:
                for name, value in zip(names[1:], numbers(line)[1:]):
                    rows.setdefault(name, []).append((numbers(line)[0], value * 1e3))
        self.assertEqual(sorted(rows), ["EXY", "EYX", "EYY"])  # X was measured on two lines
        for x, v in rows["EYX"]:
            self.assertAlmostEqual(v, self.y_over_x(x), delta=0.03)
        for y, v in rows["EXY"]:
            self.assertAlmostEqual(v, self.x_over_y(y), delta=0.03)

    def test_aerotech_plane(self):
        self.gantry("aerotech")
        lines = [l for l in self.file("aerotech-plane-D1.cal").splitlines() if not l.startswith(";")]
        head = lines[0].split()
        self.assertEqual(head, [":START2D", "2", "1", "1", "2", "30.0", "40.0", "31"])
        self.assertIn("CORUNIT=METRIC/1000", lines[1])
        self.assertEqual(lines[-1], ":END")
        for j, line in enumerate(lines[2:-1]):
            values = numbers(line)
            for i in range(31):
                self.assertAlmostEqual(values[2 * i], -self.x_over_y(30.0 * j), delta=0.03)
                self.assertAlmostEqual(values[2 * i + 1], -self.y_over_x(40.0 * i), delta=0.03)

    def factor(self, ac, bd, ad):  # the formula of both firmwares
        side = math.sqrt(2 * ac * ac + 2 * bd * bd - 4 * ad * ad) / 2
        return math.tan(math.pi / 2 - math.acos((ac * ac - side * side - ad * ad) / (2 * side * ad)))

    def test_klipper(self):
        self.gantry("klipper")
        lengths = re.match(r"SET_SKEW XY=([\d.]+),([\d.]+),([\d.]+)\n", self.file("klipper-skew.cfg"))
        ac, bd, ad = (float(lengths[i]) for i in (1, 2, 3))
        self.assertEqual(ad, 1200.0)  # A to D is parallel to X
        xy = self.factor(ac, bd, ad)
        # +Y leans towards -X by C0Y: going up by y moves by -C0Y y in X, and -xy y must undo it
        self.assertAlmostEqual(-xy * 900.0 - self.SQUARE * 900.0, 0.0, delta=3e-5)
        self.assertLess(ac, bd)  # the rising diagonal is the shorter one

    def test_marlin(self):
        self.gantry("marlin")
        of = dict(re.findall(r"#define XY_(\w+) ([\d.]+)", self.file("marlin-skew.cfg")))
        xy = self.factor(*(float(of[k]) for k in ("DIAG_AC", "DIAG_BD", "SIDE_AD")))
        self.assertAlmostEqual(xy, -self.SQUARE, delta=2e-8)
        self.assertNotIn("FOR_Z", self.file("marlin-skew.cfg"))

    def test_reprapfirmware(self):
        """x moves by y X/S, which must undo -C0Y y; the firmware changes X and nothing else."""
        self.gantry("reprapfirmware")
        text = self.file("reprapfirmware-skew.cfg")
        found = re.fullmatch(r"M556 S(\d+) X(-?[\d.]+)\n", text)
        self.assertAlmostEqual(float(found[2]) / float(found[1]), self.SQUARE, delta=2e-8)
        path = self.site / "reprapfirmware-config.g"
        for line, why in (("M556 S100 X0.1 P1", "M556 with P1"), ("M556 X0.1", "without a positive S"), ("M557 S1", "no M556"),
                          ("M556 S100 X", "M556 with X"), ("M556 S100", "without X, Y or Z")):
            path.write_text("G21\n" + line + " ; skew\n")
            self.assertIn(why, self.nonio("table", "diff", path, path, "--control", "reprapfirmware", expect=2).stderr)
        # An edge of 100 mm: each pair in its own axes.
        path.write_text("M556 S100 X0.1 Y-0.2 Z0.3\n")
        (self.site / "zero.g").write_text("M556 S100 X0 Y0 Z0\n")
        tables = self.json_of("table", "diff", self.site / "zero.g", path, "--control", "reprapfirmware")["tables"]
        self.assertEqual({(t["output"], *t["by"]): t["new"]["largest_slope_um_per_m"] for t in tables},
                         {("X", "Y"): 1000.0, ("Y", "Z"): 2000.0, ("X", "Z"): 3000.0})


class Steps(CrossWords):
    """Step diagonals of a machine whose control has old tables: the ranges after the new ones are those of the machine."""

    SIZE, N = {"X": 800.0, "Y": 600.0, "Z": 500.0}, 10
    SIGNS = {"PPP": (1, 1, 1), "NPP": (-1, 1, 1), "PNP": (1, -1, 1), "PPN": (1, 1, -1)}

    def setUp(self):
        super().setUp()
        self.draw(random.Random("steps 1"))

    def draw(self, rng):
        self.rng = rng
        self.curves = {(a, b): [rng.gauss(0, 12), rng.gauss(0, 6)] for a in "XYZ" for b in "XYZ"}

    def error(self, at, size, tables):
        """um of each axis; the tables of a control add to it."""
        out = {}
        for a in "XYZ":
            out[a] = sum(size * (self.curves[a, b][0] * at[b] / self.SIZE[b] +
                                 self.curves[a, b][1] * math.sin(math.pi * at[b] / self.SIZE[b])) for b in "XYZ")
            out[a] += sum(t.added(at[b], "+") for (b, output), t in tables.items() if output == a)
        return out

    def steps(self, name, size, tables):
        """(positions, reading) after each move of one axis."""
        way = math.hypot(*self.SIZE.values())
        u = {a: s * self.SIZE[a] / way for a, s in zip("XYZ", self.SIGNS[name])}
        moves, start, out = {a: 0 for a in "XYZ"}, None, []
        for step in range(3 * self.N + 1):
            at = {a: self.SIZE[a] * (moves[a] if u[a] > 0 else self.N - moves[a]) / self.N for a in "XYZ"}
            e = self.error(at, size, tables)
            start = start or e
            out.append(sum(u[a] * (e[a] - start[a]) for a in "XYZ"))
            moves["XYZ"[step % 3]] += 1
        return out

    def whole(self, name, size, tables):
        read = self.steps(name, size, tables)[::3]
        return max(read) - min(read)

    def measured(self, size, tables, active):
        files = {}
        for k, a in enumerate("XYZ"):
            at = {b: self.SIZE[b] / 2 for b in "XYZ"}
            curve = lambda x, a=a, at=at: self.error({**at, a: x}, size, tables)[a]
            files[a] = ("axis", axis_csv([self.SIZE[a] * i / self.N for i in range(self.N + 1)], curve, curve), 'axis = "%s"' % a)
        rows = ["diagonal,step,moved,deviation_um"]
        for name in self.SIGNS:
            rows += ["%s,%d,%s,%.4f" % (name, i, "XYZ"[(i - 1) % 3], v + self.rng.gauss(0, 0.02))
                     for i, v in list(enumerate(self.steps(name, size, tables)))[1:]]
        ends = "from = { X = 0, Y = 0, Z = 0 }\nto = { %s }" % ", ".join("%s = %g" % p for p in self.SIZE.items())
        files["SD"] = ("step-diagonal", "\n".join(rows) + "\n", ends)
        self.campaign(files, '[run]\nanalyses = ["iso230-2", "step-diagonal"]\n', [(a, "linear") for a in "XYZ"], "siemens-840d")
        path = self.folder / "campaign.toml"
        if active:
            path.write_text(path.read_text().replace('active_table = "none"', 'active_table = "%s"' % active))
        results = self.run_site(expect=None)
        self.assertEqual(results["errors"], [])
        self.results = results
        texts = {p.name: p.read_text() for p in (self.out / "c").iterdir() if p.name.startswith("siemens-840d")}
        self.assertIn("siemens-840d-XYZ-CEC.ini", texts, results["tables"])
        found = {("XYZ"[i - 1], "XYZ"[o - 1]): t for i, o, t in cec(texts["siemens-840d-XYZ-CEC.ini"])}
        for k, a in enumerate("XYZ"):
            found[a, a] = TABLE["siemens-840d"]({n: t for n, t in texts.items() if "-%s-" % a in n}, k + 1)
            found[a, a].backlash = 0.0  # no reversal
        return texts, found, {p["name"]: p for t in results["tables"] for p in t["predictions"] if p["name"] in self.SIGNS}

    def test_the_words_about_cross_tables_are_true(self):
        seed = random.SystemRandom().randrange(1, 10**9)
        print("seed %d" % seed)
        self.draw(random.Random(seed))
        texts, tables, _ = self.measured(1.0, {}, None)
        self.assert_true("\n".join(texts.values()), {(o, i): t.plus for (i, o), t in tables.items() if i != o}, self.results, "siemens-840d")

    def test_ranges_over_old_tables(self):
        texts, old, _ = self.measured(1.0, {}, None)
        (self.folder / "old").mkdir()
        for name, text in texts.items():
            (self.folder / "old" / name).write_text(text)
        active = ",".join("old/siemens-840d-%s-EEC.ini" % a for a in "XYZ") + ",old/siemens-840d-XYZ-CEC.ini"
        _, new, predicted = self.measured(1.4, old, active)
        self.assertEqual(sorted(predicted), sorted(self.SIGNS))
        for name, p in predicted.items():
            self.assertGreater(self.whole(name, 1.4, old), 2.0)
            self.assertAlmostEqual(p["before"], self.whole(name, 1.4, old), delta=0.3)
            self.assertAlmostEqual(p["predicted"], self.whole(name, 1.4, new), delta=0.3)
            self.assertLess(self.whole(name, 1.4, new), 1.0)


class Chosen(BenchTest):
    def test_a_measurement_of_too_many_targets_for_the_history_is_named(self):
        for targets, notes in ((500, 0), (501, 1)):
            self.tearDown(), self.setUp()
            self.one_axis([2.0 * i for i in range(targets)], wave, lambda x: wave(x) + LOST,
                          "[options.siemens-840d]\nmax_points = 1000\n", "siemens-840d")
            found = [n for n in self.run_site().get("notes", []) if "The history keeps tables of up to 500" in n]
            self.assertEqual(len(found), notes, found)

    def test_a_control_without_a_table_for_an_axis_is_named(self):
        for control, axis, unit in (("reprapfirmware", "X", "mm"), ("reprapfirmware", "C", "deg"), ("twincat-volumetric", "W", "mm")):
            with self.subTest(control=control, axis=axis):
                self.tearDown(), self.setUp()
                options = '[options.%s]\nsign = "error"\n' % control if control == "twincat-volumetric" else ""
                self.one_axis([0.0, 40.0, 80.0, 120.0, 160.0], wave, lambda x: wave(x) + LOST, options, control, unit, axis)
                results = self.run_site()
                self.assertEqual([o["file"] for o in results["outputs"] if o["plugin"] == control], [])
                notes = results.get("notes", []) + [n for t in results.get("tables", []) for n in t.get("notes", [])]
                self.assertEqual(len([n for n in notes if n.startswith("%s has no table for %s," % (control, axis))]), 1, notes)

    def test_only_the_four_are_tried_where_the_control_is_not_stated(self):
        self.one_axis(TARGETS, wave, lambda x: wave(x) + LOST)
        tried = {o["plugin"] for o in self.run_site()["outputs"]}
        self.assertEqual(tried & NEW, set())
        self.assertEqual({"siemens-840d", "heidenhain-tnc", "linuxcnc", "fanuc"} - tried, set())


NEW = {"fagor-8055", "haas-classic", "mitsubishi", "twincat-nc-ptp", "twincat-cnc", "twincat-volumetric",
       "ecmc", "aerotech", "pmac", "klipper", "marlin", "reprapfirmware"}

if __name__ == "__main__":
    unittest.main()
