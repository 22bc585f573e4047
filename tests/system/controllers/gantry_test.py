# SPDX-License-Identifier: Apache-2.0
"""A gantry driven on both sides of Y is one driven on both sides of X in a mirror: the same tables, the same prediction.

    NONIO_SEED=7 ctest --test-dir build/ci -R controllers.gantry -V
"""
import math
import os
import random
import re
import unittest

from bench import BenchTest

SEED = int(os.environ.get("NONIO_SEED", random.SystemRandom().randrange(2**31)))
LENGTH = {"U": 6000.0, "V": 4000.0}  # U: the axis that is driven on both sides; V: the one on the beam
SIDES = (300.0, 3700.0)
N = 20


class Machine:
    """First-order kinematics of a beam that moves along U and carries V; errors in um. Exact where a beam is rigid."""

    def __init__(self, rng):
        self.pitch = [rng.gauss(0, 6) for _ in range(4)]
        self.bow = [rng.gauss(0, 15) for _ in range(4)]
        self.yaw, self.square, self.backlash = rng.gauss(0, 4), rng.gauss(0, 12), (rng.gauss(-3, 1), rng.gauss(-2, 1))

    def along_u(self, u, v):
        t = u / LENGTH["U"]
        own = self.pitch[0] * t + self.pitch[1] * math.sin(4 * t)
        return own - v * 1e-3 * self.yaw * math.sin(math.pi * t) + self.bow[2] * math.sin(math.pi * v / LENGTH["V"]) \
            + self.bow[3] * math.sin(2 * math.pi * v / LENGTH["V"]) - self.square * v * 1e-3

    def along_v(self, u, v):
        t = u / LENGTH["U"]
        return self.pitch[2] * v / LENGTH["V"] + self.pitch[3] * math.sin(5 * v / LENGTH["V"]) \
            + self.bow[0] * math.sin(math.pi * t) + self.bow[1] * math.sin(2 * math.pi * t)


def line(rng, machine, start, end, n, sense):
    """CSV along a straight line, by the way from its start."""
    first = None
    rows, curve = ["run,direction,target_mm,deviation_um"], []
    for i in range(n + 1):
        u, v = (a + (b - a) * i / n for a, b in zip(start, end))
        e = sense[0] * machine.along_u(u, v) + sense[1] * machine.along_v(u, v)
        first = e if first is None else first
        curve.append(e - first)
    lost = sum(abs(s) * b for s, b in zip(sense, machine.backlash))
    for run in (1, 2, 3):
        for d in (1, -1):
            for i in range(n + 1) if d > 0 else range(n, -1, -1):
                rows.append("%d,%s,%.4f,%.4f" % (run, "+" if d > 0 else "-", math.dist(start, end) * i / n, curve[i] + d * lost / 2 + rng.gauss(0, 0.2)))
    return "\n".join(rows) + "\n"


class Gantry(BenchTest):
    def write(self, machine, seed, driven, control, sides=True, structure="gantry"):
        rng = random.Random(seed)
        u, v = (driven, "XY".replace(driven, ""))
        c, s = (LENGTH[a] / math.hypot(LENGTH["U"], LENGTH["V"]) for a in "UV")
        L = LENGTH
        lines = {"U1": ((0, SIDES[0]), (L["U"], SIDES[0]), N, (1, 0)), "U2": ((0, SIDES[1]), (L["U"], SIDES[1]), N, (1, 0)),
                 "V": ((0, 0), (0, L["V"]), N, (0, 1)), "D1": ((0, 0), (L["U"], L["V"]), N, (c, s)),
                 "D2": ((0, L["V"]), (L["U"], 0), N, (c, -s)), "D3": ((0, 0), (L["U"], L["V"] / 2), N // 2, None)}
        text = ('format = 1\n[campaign]\nid = "c"\ndate = 2026-05-10\n[machine]\nasset = "G-1"\nstructure = "%s"\ncontrol = "%s"\n' % (structure, control)
                + "[instrument]\nU_fixed_um = 0.1\nU_per_m_um = 0.1\n[environment]\nmisalignment_mm = 0.5\ntemperature_range_K = 0.05\n"
                  "temperature_difference_K = 0.1\nexpansion_range_um_per_m_K = 0.5\ndrift_um = 0.3\n")
        for axis, size in ((u, L["U"]), (v, L["V"]), (u + "2", None)):
            if axis == u + "2" and not sides:
                continue
            text += '[machine.axes.%s]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm = "none"\n' % axis
            if size:
                text += "travel = [0, %g]\nexpansion_um_per_m_K = 11.5\n" % size
            if axis == u and sides:
                text += 'slave = "%s2"\n' % u
        for name, (start, end, n, sense) in lines.items():
            if sense is None:
                way = math.dist(start, end)
                sense = ((end[0] - start[0]) / way, (end[1] - start[1]) / way)
            (self.folder / (name + ".csv")).write_text(line(rng, machine, start, end, n, sense))
            text += '[[measurement]]\nid = "%s"\nfile = "%s.csv"\n' % (name, name)
            if name[0] == "D":
                text += 'kind = "diagonal"\nfrom = { %s = %g, %s = %g }\nto = { %s = %g, %s = %g }\n' % (u, start[0], v, start[1], u, end[0], v, end[1])
                continue
            text += 'kind = "axis"\naxis = "%s"\n' % (u if name[0] == "U" else v)
            if name[0] == "U":
                text += "at = { %s = %g }\n" % (v, start[1])
                if sides:
                    text += 'side = "%s"\n' % ("master" if name == "U1" else "slave")
        (self.folder / "campaign.toml").write_text(text + '[run]\nanalyses = ["iso230-2", "diagonal-straightness"]\n')
        self.record(["X", "Y", "Z", u + "2"], asset="G-1")
        return self.run_site()

    @staticmethod
    def of(results, plugin):
        return next(a for a in results["analyses"] if a["plugin"] == plugin)

    def test_y_driven_on_both_sides_is_x_in_a_mirror(self):
        print("seed", SEED, flush=True)
        for k in range(3):
            machine = Machine(random.Random(SEED + k))
            # Entries of 0.1 um, of the pitch and the lateral table, at the highest and the lowest point: 4 times 0.05 um in each of both.
            for control, rounding in (("siemens-840d", 0.02), ("heidenhain-tnc", 0.4)):
                with self.subTest(k=k, control=control, seed=SEED):
                    of = {driven: self.write(machine, SEED + k, driven, control) for driven in "XY"}
                    one, other = (self.of(of[a], "diagonal-straightness") for a in "XY")
                    self.assertNotIn("refused", " ".join(f["id"] for f in other["findings"]))
                    for name in ("C0Y", "C0Y_LSQ", "slave_shift", "racking"):
                        a, b = one["values"][name], other["values"][name]
                        self.assertAlmostEqual(a["value"], b["value"], delta=1e-3, msg=name)
                        self.assertAlmostEqual(a["U"], b["U"], delta=1e-3 * a["U"], msg=name)
                    # C0Y turns +Y towards -X: the angle between both opens, whichever of them carries the other.
                    self.assertAlmostEqual(one["values"]["C0Y"]["value"], machine.square, delta=1.5)
                    self.assertIn("ECY", other["series"])
                    tables = {a: next(t for t in of[a]["tables"] if t["plugin"] == control) for a in "XY"}
                    predicted = {a: {(p["measurement"], p["name"]): p for p in tables[a]["predictions"]} for a in "XY"}
                    self.assertEqual(set(predicted["X"]), set(predicted["Y"]))
                    self.assertLessEqual({"D1", "D2"}, {name for _, name in predicted["Y"]})
                    for key, p in predicted["Y"].items():
                        self.assertAlmostEqual(p["predicted"], predicted["X"][key]["predicted"], delta=rounding, msg=key)
                        if key[1][0] == "D" and p["before"] > 10.0:  # a range below its U stays as it is
                            self.assertLess(p["predicted"], 0.25 * p["before"] + 1.0, key)
                    files = {a: [o["file"] for o in of[a]["outputs"] if o["plugin"] == control] for a in "XY"}
                    self.assertEqual(len(files["X"]), len(files["Y"]), files)
                    text = {a: "\n".join((self.out / "c" / f).read_text() for f in sorted(files[a])) for a in "Y"}
                    for axis in ("Y2", "X"):
                        self.assertRegex(text["Y"], r"\b%s\b" % axis)
                    if control == "siemens-840d":  # Y is AX2, its second side AX4
                        moved = set(re.findall(r"OUTPUT_AXIS\[\d+\]=\(AX(\d)\)", text["Y"]))
                        self.assertLessEqual({"1", "2", "4"}, moved)

    def test_y_on_two_lines_without_drives_is_refused_by_name_and_listed(self):
        machine = Machine(random.Random(SEED))
        for structure, refused in (("gantry", False), ("bridge", False), ("other", True)):
            found = self.of(self.write(machine, SEED, "Y", "siemens-840d", sides=False, structure=structure), "diagonal-straightness")
            self.assertEqual("diagonals.refused-carrier" in [f["id"] for f in found["findings"]], refused, structure)
            self.assertEqual("C0Y" in found["values"], not refused)
            listed = [l for l in self.json_of("morning", self.out, expect=None)["lines"] if l["id"].startswith("worklist.no-result:")]
            self.assertEqual(len(listed), int(refused), structure)


if __name__ == "__main__":
    unittest.main()
