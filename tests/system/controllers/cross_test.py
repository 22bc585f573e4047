#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Gantries with tables of pitch on both sides and of one axis over the other: all files are loaded into a machine of known
errors whose beam is rigid, by parsers of their own.

    NONIO_SEED=7 ctest --test-dir build/ci -R controllers.cross -V
"""
import csv
import math
import os
import random
import re
import unittest

import gantry_test
from gantry_test import LENGTH, SIDES, Machine
from parsers import Table, cec, siemens

SEED = int(os.environ.get("NONIO_SEED", random.SystemRandom().randrange(2**31)))
CONTROL = "siemens-840d"


class Loaded:
    """A machine of gantry_test with the tables of a control: U is driven on both sides, V is on the beam. The same
    interface, so that it can be measured and loaded again. `shift`: of the zero of the second side, um."""

    def __init__(self, machine, files, numbers, shift=0.0):
        self.machine, self.shift = machine, shift
        self.pitch = {a: self.pitch_of(files, k) for a, k in numbers.items()}
        self.cross = [c for n, t in files.items() if "CEC" in n for c in cec(t)]
        self.numbers = numbers
        self.backlash = machine.backlash

    @staticmethod
    def pitch_of(files, number):
        """An axis may have no table: its error is too small, or its readings were refused."""
        own = {n: t for n, t in files.items() if "EEC" in n and "AX%d" % number in t.splitlines()[0]}
        return siemens(own, number) if own else Table([(0.0, 0.0)])

    def added(self, axis, u, v):
        """Mean of both directions."""
        at = {"U": u, "U2": u, "V": v}
        own = self.pitch[axis]
        sum_ = (own.added(at[axis], "+") + own.added(at[axis], "-")) / 2
        by = {k: a for a, k in self.numbers.items()}
        return sum_ + sum(t.added(at[by[i]]) for i, o, t in self.cross if by[o] == axis) + (self.shift if axis == "U2" else 0.0)

    def along_u(self, u, v):
        one, two = self.added("U", u, v), self.added("U2", u, v)
        return self.machine.along_u(u, v) + one + (two - one) * (v - SIDES[0]) / (SIDES[1] - SIDES[0])

    def along_v(self, u, v):
        return self.machine.along_v(u, v) + self.added("V", u, v)


def diagonal(machine, falling, n=80):
    """Range along a diagonal, um."""
    way = math.hypot(LENGTH["U"], LENGTH["V"])
    c, s = LENGTH["U"] / way, LENGTH["V"] / way * (-1 if falling else 1)
    at = [(LENGTH["U"] * i / n, LENGTH["V"] * (n - i if falling else i) / n) for i in range(n + 1)]
    e = [c * machine.along_u(u, v) + s * machine.along_v(u, v) for u, v in at]
    return max(e) - min(e)


class Cross(gantry_test.Gantry):
    test_y_driven_on_both_sides_is_x_in_a_mirror = test_y_on_two_lines_without_drives_is_refused_by_name_and_listed = None

    def measured(self, machine, seed, driven="X", extra="", active=None):
        """The program's tables of this machine, by name."""
        self.more, self.active = extra, active or {}
        results = self.write(machine, seed, driven, CONTROL)
        return results, {o["file"]: (self.out / "c" / o["file"]).read_text() for o in results["outputs"] if o["plugin"] == CONTROL}

    def run_site(self, expect=0):
        path = self.folder / "campaign.toml"
        text = path.read_text().replace("[run]\n", '[run]\noutputs = ["%s", "csv"]\n' % CONTROL).replace('"iso230-2"', '"iso230-2", "iso230-6"') + self.more
        for axis, files in self.active.items():
            text = re.sub(r'(\[machine\.axes\.%s\]\nkind = "linear"\n)active_table = "none"\nactive_backlash_mm = "none"' % axis,
                          r'\1active_table = "%s"' % files, text)
        path.write_text(text)
        return super().run_site(expect)

    @staticmethod
    def numbers(driven):
        return {"U": 1 if driven == "X" else 2, "V": 2 if driven == "X" else 1, "U2": 4}

    @staticmethod
    def shift_of(text):
        found = re.search(r"shift the zero of \w+ by ([-+][\d.]+) mm", text)
        return 1e3 * float(found[1]) if found else 0.0

    def test_squareness_in_the_table_or_as_shift_of_the_slaves_zero(self):
        print("seed", SEED, flush=True)
        for k in range(4):
            for driven in "XY":
                machine = Machine(random.Random(SEED + k))
                for choice in ("table", "slave-zero"):
                    with self.subTest(k=k, driven=driven, choice=choice, seed=SEED):
                        results, files = self.measured(machine, SEED + k, driven, '[options.siemens-840d]\nsquareness = "%s"\n' % choice)
                        (cross,) = [t for n, t in files.items() if "CEC" in n]
                        shift = self.shift_of(cross)
                        after = Loaded(machine, files, self.numbers(driven), shift)
                        predicted = {p["name"]: p for t in results["tables"] if t["plugin"] == CONTROL for p in t["predictions"] if p["name"][0] == "D"}
                        U = min(v["U"] for a in results["analyses"] if a["plugin"] == "iso230-6" for n, v in a["values"].items() if n == "E")
                        for name, falling in (("D1", False), ("D2", True)):
                            was, now = diagonal(machine, falling), diagonal(after, falling)
                            case = "%s: %.2f -> %.2f um, promised %.2f" % (name, was, now, predicted[name]["predicted"])
                            print(driven, choice, case)
                            self.assertLess(now, 0.2 * was + 2.5, case)
                            self.assertAlmostEqual(predicted[name]["before"], was, delta=1.5, msg=case)
                            # Less than U of the diagonal's E is never promised.
                            self.assertAlmostEqual(predicted[name]["predicted"], max(now, U), delta=2.0, msg=case)
                            self.assertGreater(predicted[name]["predicted"], U - 0.01, case)
                        if choice == "table":
                            self.assertIn("the squareness is in them", cross)
                            self.assertEqual(shift, 0.0)
                            continue
                        # At the ends of the beam: C0Y over the distance of the sides.
                        self.assertAlmostEqual(shift, machine.square * (SIDES[1] - SIDES[0]) * 1e-3, delta=4.0)
                        self.assertNotIn("the squareness is in them", cross)
                        self.assertIn("|==>|" if shift > 0 else "|<==|", cross)
                        self.assertLess(diagonal(after, True), diagonal(Loaded(machine, files, self.numbers(driven), -shift), True) + 0.5)
                        (note,) = [n for t in results["tables"] if t["plugin"] == CONTROL for n in t["notes"] if "shift the zero" in str(n)]
                        self.assertIn("%s2" % driven, str(note))

    def test_a_cross_table_that_was_active_is_removed_from_the_curves(self):
        """A worn gantry, measured with the tables of its first campaign: the new ones are complete."""
        for k in range(3):
            old, now = Machine(random.Random(SEED + k)), Machine(random.Random(SEED + 50 + k))
            _, files = self.measured(old, SEED + k)
            for n, t in files.items():
                (self.folder / n).write_text(t)
            active = {a: ",".join(n for n in files if re.search(r"-%s(-|Y)" % a, n)) for a in ("X", "Y", "X2")}
            active["Y"] = ",".join(n for n in files if "-Y-" in n or "CEC" in n)
            active["X2"] += ",siemens-840d-XY-CEC.ini"
            before = Loaded(now, files, self.numbers("X"))
            results, new = self.measured(before, SEED + 90 + k, active=active)
            self.assertEqual(results["errors"], [])
            after = Loaded(now, new, self.numbers("X"))
            for falling in (False, True):
                case = "k %d: %.2f without, %.2f with the old tables, %.2f with the new ones" % (
                    k, diagonal(now, falling), diagonal(before, falling), diagonal(after, falling))
                print(case)
                self.assertLess(diagonal(after, falling), 0.2 * diagonal(before, falling) + 2.5, case)
            table = next(t for t in results["tables"] if t["plugin"] == CONTROL)
            predicted = {p["name"]: p for p in table["predictions"] if p["name"][0] == "D"}
            U = min(v["U"] for a in results["analyses"] if a["plugin"] == "iso230-6" for n, v in a["values"].items() if n == "E")
            for name, falling in (("D1", False), ("D2", True)):
                self.assertAlmostEqual(predicted[name]["before"], diagonal(before, falling), delta=1.5)
                self.assertAlmostEqual(predicted[name]["predicted"], max(diagonal(after, falling), U), delta=2.0)

    def test_curves_with_their_uncertainty_as_csv(self):
        results, _ = self.measured(Machine(random.Random(SEED)), SEED)
        analysis = self.of(results, "diagonal-straightness")
        path = next((self.out / "c").glob("curves-*-diagonal-straightness.csv"))
        rows = list(csv.DictReader(path.read_text().splitlines()))
        for name, series in analysis["series"].items():
            mine = [r for r in rows if r["curve"] == name]
            self.assertEqual([float(r["position"]) for r in mine], series["position"], name)
            for column, key in (("value", "value"), ("U", "U")):
                for r, v in zip(mine, series[key]):
                    self.assertAlmostEqual(float(r[column]), v, delta=1e-6 * max(1.0, abs(v)))
            self.assertEqual({r["over"] for r in mine}, {series["over"]})
            self.assertEqual({r["unit"] for r in mine}, {series["unit"]})

    def test_without_a_known_gantry_the_choice_is_refused_by_name(self):
        self.more, self.active = '[options.siemens-840d]\nsquareness = "slave-zero"\n', {}
        results = self.write(Machine(random.Random(SEED)), SEED, "X", CONTROL, sides=False)
        table = next(t for t in results["tables"] if t["plugin"] == CONTROL)
        self.assertIn("table.slave-zero-unknown", [f["id"] for f in table["findings"]])
        self.assertFalse([o for o in results["outputs"] if "CEC" in o["file"]])


if __name__ == "__main__":
    unittest.main()
