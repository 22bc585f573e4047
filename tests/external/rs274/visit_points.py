#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""visit_points.py NONIO

`nonio plan program` writes programs; rs274, LinuxCNC's own interpreter, runs them. Where it stops, in
which order and how long must be the plan, written down here once more.

Exit status: 0 shown, 1 not so, 77 rs274 is not here.
"""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

NONIO = sys.argv.pop(1)
OVER, DWELL, RUNS = 1.5, 2.25, 2
X0, Y0, Z0 = -100.0, 50.0, -600.0  # start of the travels
AXES = ["--axis", "X=-100:4100", "--axis", "Y=50:3050", "--axis", "Z=-600:0"]
N, STEP_X, STEP_Y = 12, 240.0, 180.0
STEPS = 7  # of a step diagonal


def run_by_linuxcnc(program):
    """[(position of X Y Z A B C, seconds of rest there)]"""
    done = subprocess.run(["rs274", "-g", program.name], cwd=program.parent, capture_output=True, text=True,
                          timeout=60)
    if done.returncode != 0:
        raise AssertionError(f"{program.name}: {done.stderr}{done.stdout[-500:]}")
    stops = []
    for line in done.stdout.splitlines():
        move = re.search(r"(STRAIGHT_FEED|STRAIGHT_TRAVERSE)\(([^)]*)\)", line)
        if move:
            stops.append([[float(v) for v in move.group(2).split(",")], 0.0])
        rest = re.search(r"DWELL\(([^)]*)\)", line)
        if rest:
            stops[-1][1] += float(rest.group(1))
    return stops


def to_and_fro(stops, before, after, both=True):
    moves = [(before, 0.0)]
    for _ in range(RUNS):
        moves += [(s, DWELL) for s in stops]
        if both:
            moves += [(after, 0.0)] + [(s, DWELL) for s in reversed(stops)]
        moves.append((before, 0.0))
    return moves


def line(start, step, n):
    """Stops on a straight line of X and Y, and the points of turning."""
    further = OVER / max(abs(s) for s in step)
    at = lambda i: [start[0] + i * step[0], start[1] + i * step[1]]
    return to_and_fro([at(i) for i in range(n + 1)], at(-further), at(n + further))


def step_diagonal(name):
    ends = [(X0, 4100.0), (Y0, 3050.0), (Z0, 0.0)]
    step = [int((b - a - 2 * OVER) / STEPS / 0.001 + 1e-6) * 0.001 for a, b in ends]
    sign = [1 if c == "P" else -1 for c in name]
    start = [a + OVER + (0 if s > 0 else STEPS * d) for (a, _), s, d in zip(ends, sign, step)]
    before = [p - s * OVER for p, s in zip(start, sign)]
    moves = [(before, 0.0)]
    for _ in range(RUNS):
        at = list(start)
        moves.append((list(at), DWELL))
        for _ in range(STEPS):
            for a in range(3):
                at[a] += sign[a] * step[a]
                moves.append((list(at), DWELL))
        moves.append((before, 0.0))
    return moves


class Interpreter(unittest.TestCase):
    def write(self, *words, axes=AXES):
        folder = tempfile.TemporaryDirectory(prefix="nonio-rs274-")
        self.addCleanup(folder.cleanup)
        settings = [f"over_travel_mm={OVER}", f"dwell_s={DWELL}", f"runs={RUNS}", "over_travel_deg=2"]
        command = [NONIO, "plan", "program", *axes, "--control", "gcode", "--out", folder.name, *words]
        for s in settings:
            command += ["--set", s]
        subprocess.run(command, check=True, capture_output=True, timeout=60)
        return pathlib.Path(folder.name)

    def same(self, program, planned, axes=(0, 1, 2)):
        stops = run_by_linuxcnc(program)
        self.assertEqual(len(stops), len(planned), program.name)
        for i, ((position, rest), (wanted, dwell)) in enumerate(zip(stops, planned)):
            near = 1e-4 if dwell else 1.1e-3  # the over-travel is cut off to 0.001 mm
            for axis, value in zip(axes, wanted):
                self.assertAlmostEqual(position[axis], value, delta=near, msg=f"{program.name} {i}")
            for axis in set(range(6)) - set(axes[:len(wanted)]):
                self.assertEqual(position[axis], 0.0, f"{program.name} {i}")
            self.assertAlmostEqual(rest, dwell, delta=1e-4, msg=f"{program.name} {i}")
        return stops

    def test_diagonals_and_axes_on_their_grid(self):
        grid = ["--n", str(N), "--step-x", f"{STEP_X:g}", "--step-y", f"{STEP_Y:g}"]
        folder = self.write(*grid, "--set", "programs=axes,diagonals,half-diagonal", axes=AXES[:4])
        x, y = X0 + OVER, Y0 + OVER
        self.same(folder / "program-gcode-D1.ngc", line((x, y), (STEP_X, STEP_Y), N))
        self.same(folder / "program-gcode-D2.ngc", line((x, y + N * STEP_Y), (STEP_X, -STEP_Y), N))
        self.same(folder / "program-gcode-D3.ngc", line((x, y), (2 * STEP_X, STEP_Y), N // 2))
        for axis, (name, start, step) in enumerate((("X", x, STEP_X), ("Y", y, STEP_Y))):
            stops = [[start + i * step] for i in range(N + 1)]
            self.same(folder / f"program-gcode-{name}.ngc",
                      to_and_fro(stops, [start - OVER], [start + N * step + OVER]), axes=(axis,))

    def test_every_row_of_the_table_of_plans(self):
        """Each triple that fits has its programs; steps by the triple itself, not by what the verb says of them."""
        folder = tempfile.TemporaryDirectory(prefix="nonio-rs274-")
        self.addCleanup(folder.cleanup)
        table = [NONIO, "plan", "table", "--x", "4000", "--y", "3000", "--max-step", "400", "--least-cover", "0.99",
                 "--over-travel", f"{OVER}", "--runs", f"{RUNS}", "--json"]
        done = subprocess.run([*table, "--program", folder.name, "--control", "gcode", "--set", f"dwell_s={DWELL}"],
                              check=True, capture_output=True, text=True, timeout=60)
        rows = json.loads(done.stdout)["rows"]
        self.assertGreater(len(rows), 2)
        for i, row in enumerate(rows):
            a, b, c, n = (row[k] for k in "abcn")
            self.assertEqual(a * a + b * b, c * c)
            step = (a * row["q"], b * row["q"])
            programs = pathlib.Path(folder.name) / f"{i + 1:02}-{a}-{b}-{c}"
            self.same(programs / "program-gcode-D1.ngc", line((OVER, OVER), step, n))
            self.same(programs / "program-gcode-D2.ngc", line((OVER, OVER + n * step[1]), (step[0], -step[1]), n))
            for axis, name in enumerate("XY"):
                stops = [[OVER + k * step[axis]] for k in range(n + 1)]
                self.same(programs / f"program-gcode-{name}.ngc",
                          to_and_fro(stops, [0.0], [2 * OVER + n * step[axis]]), axes=(axis,))

    def test_step_diagonals(self):
        folder = self.write("--set", "programs=step-diagonals", "--set", f"steps={STEPS}")
        self.assertEqual(len(list(folder.iterdir())), 4)
        for name in ("PPP", "NPP", "PNP", "PPN"):
            self.same(folder / f"program-gcode-{name}.ngc", step_diagonal(name))

    def test_a_rotary_axis(self):
        folder = self.write("--set", "interval_deg=45", "--set", "targets=even", axes=["--axis", "C=-5:365"])
        stops = [[i * 45.0] for i in range(9)]
        self.same(folder / "program-gcode-C.ngc", to_and_fro(stops, [-2.0], [362.0]), axes=(5,))

    def test_random_offsets_are_the_same_in_every_run(self):
        folder = self.write(axes=["--axis", "X=0:1003"])
        stops = run_by_linuxcnc(folder / "program-gcode-X.ngc")
        targets = [p[0] for p, rest in stops if rest > 0]
        up = targets[:5]
        self.assertEqual(targets, (up + up[::-1]) * RUNS)
        for i, t in enumerate(up):
            self.assertLessEqual(abs(t - (1.5 + 250 * i)), 75.0001)
        self.assertEqual(len({round(b - a, 3) for a, b in zip(up, up[1:])}), 4, up)
        start, end = round(up[0] - OVER, 3), round(up[-1] + OVER, 3)
        self.assertEqual([p[0] for p, rest in stops if rest == 0], [start] + [end, start] * RUNS)


class Probing(unittest.TestCase):
    """A ball on a table that is not quite where the program has it: what LinuxCNC's interpreter probes, touched here exactly,
    logged as LinuxCNC does, and read back by the program."""
    CENTRE, DIRECTION, RADIUS = (350.021, 249.987, 0.0), (1.1e-4, -6e-5, 1.0), 15.0
    NOMINAL, BALL = (350.0, 250.0, 0.0), (530.0, 250.0, -60.0)

    def turned(self, point, degrees, centre=CENTRE, direction=DIRECTION):
        """Rodrigues' formula about the true axis."""
        size = math.sqrt(sum(d * d for d in direction))
        n = [d / size for d in direction]
        arm = [p - c for p, c in zip(point, centre)]
        along, t = sum(a * b for a, b in zip(arm, n)), math.radians(degrees)
        cross = [n[1] * arm[2] - n[2] * arm[1], n[2] * arm[0] - n[0] * arm[2], n[0] * arm[1] - n[1] * arm[0]]
        return [c + a * math.cos(t) + x * math.sin(t) + d * along * (1 - math.cos(t))
                for c, a, x, d in zip(centre, arm, cross, n)]

    def touched(self, start, end, ball):
        """Where a straight move meets the sphere."""
        way = [b - a for a, b in zip(start, end)]
        length = math.sqrt(sum(w * w for w in way))
        way = [w / length for w in way]
        to = [b - a for a, b in zip(start, ball)]
        near = sum(a * b for a, b in zip(to, way))
        off = sum(a * a for a in to) - near * near
        self.assertLess(off, self.RADIUS ** 2)
        at = near - math.sqrt(self.RADIUS ** 2 - off)
        self.assertTrue(0 < at < length, "no contact")
        return [a + at * w for a, w in zip(start, way)]

    def probed(self, program, height):
        """Lines of the log of a program, which must not touch anything on its way."""
        done = subprocess.run(["rs274", "-g", program.name], cwd=program.parent, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        at, log, angles = None, [], []
        ball = [b + o for b, o in zip(self.BALL, (0.02, -0.03, 0.01 + height))]  # not where the program has it
        for line in done.stdout.splitlines():
            found = re.search(r"(STRAIGHT_FEED|STRAIGHT_TRAVERSE|STRAIGHT_PROBE)\(([^)]*)\)", line)
            if not found:
                continue
            to = [float(v) for v in found.group(2).split(",")][:6]
            here = self.turned(ball, to[5])
            if found.group(1) == "STRAIGHT_PROBE":
                self.assertEqual(at[3:], to[3:])
                point = self.touched(at[:3], to[:3], here)
                log.append(" ".join(f"{v:.6f}" for v in [*point, *to[3:], 0, 0, 0]))
                angles.append(to[5])
                at = [*point, *to[3:]]
                continue
            if at is not None and at[5] == to[5]:  # a retreat begins at the contact
                for k in range(1, 51):
                    p = [a + (b - a) * k / 50 for a, b in zip(at[:3], to[:3])]
                    self.assertGreaterEqual(math.dist(p, here), self.RADIUS - 1e-9, line)
            elif at is not None:  # the table turns: the stylus is above whatever comes round
                self.assertEqual(at[:3], to[:3])
                self.assertGreater(at[2], here[2] + self.RADIUS + 5)
            at = to
        self.assertEqual(angles, [45.0 * i for i in range(8) for _ in range(5)] * 2)
        return "\n".join(log) + "\n"

    def test_touches_read_back_give_the_axis(self):
        with tempfile.TemporaryDirectory(prefix="nonio-rs274-") as name:
            folder = pathlib.Path(name)
            settings = {"axis": "C", "centre_mm": "%g,%g,%g" % self.NOMINAL, "ball_mm": "%g,%g,%g" % self.BALL,
                        "heights_mm": "0,120", "radius_mm": self.RADIUS, "runs": 2}
            command = [NONIO, "plan", "program", "--axis", "X=0:700", "--axis", "Y=0:500", "--axis", "Z=-400:200",
                       "--axis", "C=0:360", "--control", "probing", "--out", folder / "p"]
            for key, value in settings.items():
                command += ["--set", f"{key}={value}"]
            subprocess.run(command, check=True, capture_output=True, timeout=60)
            self.assertEqual(sorted(p.name for p in (folder / "p").iterdir()),
                             ["program-probing-C1.ngc", "program-probing-C2.ngc"])
            (folder / "site" / "c").mkdir(parents=True)
            text = ('format = 1\n[campaign]\nid = "c"\n[machine.axes.C]\nkind = "rotary"\ntravel = [0, 360]\n'
                    '[run]\nanalyses = ["rotary-kinematics"]\noutputs = ["json"]\n[options.linuxcnc-probe]\nunit = "mm"\n')
            for i, height in ((1, 0.0), (2, 120.0)):
                program = folder / "p" / f"program-probing-C{i}.ngc"
                self.assertIn(f"(PROBEOPEN nonio-C{i}.txt)", program.read_text())
                (folder / "site" / "c" / f"c{i}.txt").write_text(self.probed(program, height))
                text += f'[[measurement]]\nid = "C{i}"\nkind = "ball-centres"\naxis = "C"\nfile = "c{i}.txt"\n'
            (folder / "site" / "c" / "campaign.toml").write_text(text)
            subprocess.run([NONIO, "run", folder / "site", "--out", folder / "out", "--quiet", "--root"], capture_output=True,
                           timeout=120)
            results = json.loads((folder / "out" / "c" / "results.json").read_text())
        self.assertEqual(results["errors"], [])
        found = [a["values"] for a in results["analyses"] if a["plugin"] == "rotary-kinematics"]
        self.assertEqual(len(found), 2)
        for values, height in zip(found, (0.0, 120.0)):
            z = values["centre_z"]["value"]
            self.assertAlmostEqual(z, self.BALL[2] + height, delta=0.1)
            for axis, c, d in zip("xy", self.CENTRE, self.DIRECTION):
                self.assertAlmostEqual(values["centre_" + axis]["value"], c + d * z, delta=1e-5)
            for axis, d in zip("ijk", self.DIRECTION):
                self.assertAlmostEqual(values["direction_" + axis]["value"], d, delta=1e-7)


    # B on the bed carries C: lines with both at 0, C at 0.03 mm from B; five positions of B, six of C.
    B_CENTRE, B_DIRECTION = (350.05, 0.0, -100.02), (2e-4, 1.0, -1e-4)
    TILTS, TURNS, STEM = (-60.0, -30.0, 0.0, 30.0, 60.0), [60.0 * i for i in range(6)], 4.0

    def probed_on_two(self, program):
        """The log. Neither ball nor stem is touched on the way."""
        done = subprocess.run(["rs274", "-g", program.name], cwd=program.parent, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        both = lambda p, b, c: self.turned(self.turned(p, c), b, self.B_CENTRE, self.B_DIRECTION)
        ball = [b + o for b, o in zip(self.BALL, (0.02, -0.03, 0.01))]
        at, log, places = None, [], []
        for line in done.stdout.splitlines():
            found = re.search(r"(STRAIGHT_FEED|STRAIGHT_TRAVERSE|STRAIGHT_PROBE)\(([^)]*)\)", line)
            if not found:
                continue
            to = [float(v) for v in found.group(2).split(",")][:6]
            here, foot = (both(p, to[4], to[5]) for p in (ball, [*ball[:2], ball[2] - 200.0]))
            if found.group(1) == "STRAIGHT_PROBE":
                point = self.touched(at[:3], to[:3], here)
                log.append(" ".join(f"{v:.6f}" for v in [*point, *to[3:], 0, 0, 0]))
                places.append((to[4], to[5]))
                path = [[a + (b - a) * k / 20 for a, b in zip(at[:3], point)] for k in range(21)]
                at = [*point, *to[3:]]
            elif at is not None and at[3:] == to[3:]:
                path = [[a + (b - a) * k / 50 for a, b in zip(at[:3], to[:3])] for k in range(1, 51)]
                at = to
            else:
                path, at = [to[:3]], to
            for p in path:
                self.assertGreaterEqual(math.dist(p, here), self.RADIUS - 1e-9, line)
                for k in range(41):  # stylus tip 3 mm, stem 1 mm in radius
                    self.assertGreater(math.dist(p, [a + (b - a) * k / 40 for a, b in zip(here, foot)][:3]), self.STEM, line)
        self.assertEqual(sorted(set(places)), sorted((b, c) for b in self.TILTS for c in self.TURNS))
        self.assertGreaterEqual(min(places.count(p) for p in set(places)), 5)
        return "\n".join(log) + "\n"

    def test_two_axes_read_back_give_both_lines(self):
        with tempfile.TemporaryDirectory(prefix="nonio-rs274-") as name:
            folder = pathlib.Path(name)
            settings = {"axis": "C", "centre_mm": "350,250,0", "ball_mm": "430,250,-20", "radius_mm": self.RADIUS,
                        "places": 6, "carried_by": "B", "carrier_centre_mm": "350,0,-100", "carrier_deg": "-60,-30,0,30,60"}
            self.BALL = (430.0, 250.0, -20.0)
            command = [NONIO, "plan", "program", "--axis", "X=0:700", "--axis", "Y=0:500", "--axis", "Z=-400:200",
                       "--axis", "B=-100:100", "--axis", "C=0:360", "--control", "probing", "--out", folder / "p"]
            for key, value in settings.items():
                command += ["--set", f"{key}={value}"]
            subprocess.run(command, check=True, capture_output=True, timeout=60)
            program = folder / "p" / "program-probing-BC.ngc"
            (folder / "site" / "c").mkdir(parents=True)
            (folder / "site" / "c" / "bc.txt").write_text(self.probed_on_two(program))
            (folder / "site" / "c" / "campaign.toml").write_text(
                'format = 1\n[campaign]\nid = "c"\n[machine.axes.B]\nkind = "rotary"\n[machine.axes.C]\nkind = "rotary"\n'
                '[run]\nanalyses = ["rotary-chain"]\noutputs = ["json"]\n[options.linuxcnc-probe]\nunit = "mm"\n'
                '[options.rotary-chain]\ntables = ["B", "C"]\n'
                '[[measurement]]\nid = "BC"\nkind = "ball-centres"\naxis = "C"\nfile = "bc.txt"\n')
            subprocess.run([NONIO, "run", folder / "site", "--out", folder / "out", "--quiet", "--root"], capture_output=True,
                           timeout=120)
            results = json.loads((folder / "out" / "c" / "results.json").read_text())
        self.assertEqual(results["errors"], [])
        values = next(a["values"] for a in results["analyses"] if a["plugin"] == "rotary-chain")
        for axis, centre, direction in (("B", self.B_CENTRE, self.B_DIRECTION), ("C", self.CENTRE, self.DIRECTION)):
            size = math.sqrt(sum(d * d for d in direction))
            n = [d / size for d in direction]
            found = [values[f"centre_{k}_{axis}"]["value"] - c for k, c in zip("xyz", centre)]
            off = sum(a * b for a, b in zip(found, n))
            for k, a, d in zip("xyz", found, n):  # any point of the line will do
                self.assertAlmostEqual(a, off * d, delta=1e-5, msg=f"{axis} {k}")
            for k, d in zip("ijk", n):
                self.assertAlmostEqual(values[f"direction_{k}_{axis}"]["value"], d, delta=1e-7, msg=f"{axis} {k}")


class SignProbe(unittest.TestCase):
    """Offsets in the control (G54, G92) do not move the probe: it is in machine coordinates."""

    def test_offsets_do_not_move_it(self):
        with tempfile.TemporaryDirectory(prefix="nonio-rs274-") as name:
            folder = pathlib.Path(name)
            (folder / "c").mkdir()
            (folder / "c" / "campaign.toml").write_text(
                'format = 1\n[campaign]\nid = "c"\n[machine]\nmodel = "FP 12"\ncontrol = "linuxcnc"\n'
                '[machine.axes.X]\nkind = "linear"\ntravel = [-10, 410]\nactive_table = "none"\n'
                '[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "X.csv"\n')
            rows = ["run,direction,target_mm,deviation_um"]
            rows += [f"{r},{d},{50 * i},{(i * i) % 7}" for r in (1, 2) for d in "+-" for i in range(9)]
            (folder / "c" / "X.csv").write_text("\n".join(rows) + "\n")
            done = subprocess.run([NONIO, "table", "probe", folder / "c", "--out", folder / "p", "--json"],
                                  capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 0, done.stderr)
            probe = json.loads(done.stdout)["probes"][0]
            program = folder / "p" / "sign-probe-X.nc"
            text = program.read_text()
            self.assertIn("(machine: FP 12)", text)
            self.assertIn("DRY RUN FIRST", text)
            # G54 is at 100 inch, G92 at 7 inch, and both are on
            (program.parent / "v.var").write_text("5210\t1\n5211\t7\n5220\t1\n5221\t100\n")
            ran = subprocess.run(["rs274", "-v", "v.var", "-g", program.name], cwd=program.parent, text=True,
                                 capture_output=True, timeout=60)
            self.assertEqual(ran.returncode, 0, ran.stderr)
            offset = {}
            moves, seen = [], []
            for line in ran.stdout.splitlines():
                word = re.search(r"([A-Z_0-9]+)\(([^)]*)\)", line)
                if word is None:
                    continue
                numbers = re.findall(r"-?\d+\.?\d*", word.group(2))
                if word.group(1) == "SET_G5X_OFFSET":
                    offset["g5x"] = float(numbers[1])
                elif word.group(1) == "SET_G92_OFFSET":
                    offset["g92"] = float(numbers[0])
                elif word.group(1) in ("STRAIGHT_FEED", "STRAIGHT_TRAVERSE"):
                    moves.append((word.group(1), float(numbers[0]) + sum(offset.values())))
                seen.append(word.group(1))
        self.assertEqual(len(offset), 2)
        self.assertGreater(min(offset.values()), 100.0)
        wanted = [probe[k] for k in ("start_mm", "from_mm", "to_mm")]
        self.assertEqual([kind for kind, _ in moves], ["STRAIGHT_FEED"] * 3)
        for (_, at), to in zip(moves, wanted):
            self.assertAlmostEqual(at, to, delta=1e-3)
        for word, times in (("DWELL", 2), ("PROGRAM_STOP", 2), ("PROGRAM_END", 1)):
            self.assertEqual(seen.count(word), times, word)


if shutil.which("rs274") is None:
    print("skipped: rs274 of LinuxCNC is not installed")
    sys.exit(77)
unittest.main()
