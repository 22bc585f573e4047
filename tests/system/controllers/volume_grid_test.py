#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The grid of the volume, read by a parser of its own that knows only plugins/outputs/volume-grid/README.md: a machine that has it
loaded moves to where it was sent."""
import csv
import io
import json
import math
import unittest

from bench import BenchTest

SIZE = (800.0, 600.0, 500.0)
N = 8


def error(x, y, z):
    """um over mm: scales, two bows, two squarenesses (the chain bed - X - Y - Z - tool)."""
    bow = lambda at, length: 4 * at / length * (1 - at / length)
    return (0.020 * x - 0.030 * y + 0.015 * z + 3 * bow(y, SIZE[1]),
            -0.010 * y - 0.020 * z + 5 * bow(x, SIZE[0]),
            0.025 * z)


def steps(count=N):
    return [[length * i / count for length in SIZE] for i in range(count + 1)]


def axis(k):
    rows = ["run,direction,target_mm,deviation_um"]
    for run in (1, 2):
        for direction in "+-":
            for i in range(N + 1) if direction == "+" else range(N, -1, -1):
                at = [length / 2 for length in SIZE]
                at[k] = SIZE[k] * i / N
                rows.append(f"{run},{direction},{at[k]:g},{error(*at)[k] + 0.05 * math.sin(7 * i + 3 * run + k):.4f}")
    return "\n".join(rows) + "\n"


def diagonal(sign):
    u = [s * length / math.hypot(*SIZE) for s, length in zip(sign, SIZE)]
    rows = ["run,direction,target_mm,deviation_um"]
    for run in (1, 2):
        for i in range(N + 1):
            at = [length * (i if s > 0 else N - i) / N for s, length in zip(sign, SIZE)]
            seen = sum(c * e for c, e in zip(u, error(*at)))
            rows.append(f"{run},+,{math.hypot(*SIZE) * i / N:.6f},{seen + 0.05 * math.sin(5 * i + 2 * run + sign[0] + 3 * sign[1]):.4f}")
    return "\n".join(rows) + "\n"


def read(grid, at):
    """Linear in X, Y and Z, as the file says."""
    nodes = [grid[name] for name in ("X_mm", "Y_mm", "Z_mm")]
    index, part = [], []
    for k, x in enumerate(at):
        i = max(j for j, node in enumerate(nodes[k][:-1]) if j == 0 or node <= x)
        index.append(i)
        part.append(min(1, max(0, (x - nodes[k][i]) / (nodes[k][i + 1] - nodes[k][i]))))
    out = [0.0, 0.0, 0.0]
    for corner in range(8):
        up = [corner >> k & 1 for k in range(3)]
        weight = math.prod(part[k] if up[k] else 1 - part[k] for k in range(3))
        i, j, k = (index[k] + up[k] for k in range(3))
        node = grid["error_um"][(i * len(nodes[1]) + j) * len(nodes[2]) + k]
        out = [o + weight * e for o, e in zip(out, node)]
    return out


class VolumeGrid(BenchTest):
    def night(self):
        text = 'format = 1\n[campaign]\nid = "c"\n[machine]\nstructure = "bridge"\n'
        files = {}
        for k, name in enumerate("XYZ"):
            text += f'[machine.axes.{name}]\nkind = "linear"\ntravel = [0, {SIZE[k]:g}]\nexpansion_um_per_m_K = 11\n'
        text += ('[instrument]\nU_fixed_um = 0.1\nU_per_m_um = 0.2\n[environment]\nmisalignment_mm = 0.2\ntemperature_range_K = 0.1\n'
                 'temperature_difference_K = 0.1\nexpansion_range_um_per_m_K = 1\ndrift_um = 0.1\n')
        for k, name in enumerate("XYZ"):
            at = ", ".join(f"{other} = {SIZE[i] / 2:g}" for i, other in enumerate("XYZ") if i != k)
            text += f'[[measurement]]\nid = "{name}"\nkind = "axis"\naxis = "{name}"\nat = {{ {at} }}\nfile = "{name.lower()}.csv"\n'
            files[name.lower()] = axis(k)
        for name, sign in (("PPP", (1, 1, 1)), ("NPP", (-1, 1, 1)), ("PNP", (1, -1, 1)), ("PPN", (1, 1, -1))):
            ends = [", ".join(f"{axis} = {length if (s > 0) == far else 0:g}" for axis, s, length in zip("XYZ", sign, SIZE))
                    for far in (False, True)]
            text += f'[[measurement]]\nid = "{name}"\nkind = "diagonal"\nfrom = {{ {ends[0]} }}\nto = {{ {ends[1]} }}\nfile = "{name.lower()}.csv"\n'
            files[name.lower()] = diagonal(sign)
        text += ('[run]\nanalyses = ["rigid-body"]\noutputs = ["volume-grid"]\n[options.rigid-body]\ndegree = 2\nparts = 8\n'
                 'errors = ["EXX", "EYY", "EZZ", "EYX", "EXY", "C0Y", "B0Z", "A0Z"]\n')
        folder = self.site / "c"
        folder.mkdir(exist_ok=True)
        (folder / "campaign.toml").write_text(text)
        for name, data in files.items():
            (folder / f"{name}.csv").write_text(data)
        self.nonio("run", self.site, "--out", self.site.parent / "out", "--quiet", expect=None)
        found = list((self.site.parent / "out").rglob("volume-grid-*.json"))
        self.assertEqual(len(found), 1)
        return json.loads(found[0].read_text())

    def test_a_machine_with_it_loaded_goes_where_it_is_sent(self):
        grid = self.night()
        self.assertEqual(grid["schema"], "nonio-volume-grid/1")
        self.assertEqual(len(grid["error_um"]), 9 ** 3)
        self.assertEqual(len(grid["U_um"]), 9 ** 3)
        zero = error(*(length / 2 for length in SIZE))
        before = after = 0.0
        for x in (0, 130, 400, 730, 800):
            for y in (0, 90, 300, 510, 600):
                for z in (0, 200, 500):
                    true = [e - z0 for e, z0 in zip(error(x, y, z), zero)]
                    left = [t - g for t, g in zip(true, read(grid, (x, y, z)))]
                    before, after = max(before, math.hypot(*true)), max(after, math.hypot(*left))
        self.assertGreater(before, 10)
        self.assertLess(after, 0.5)  # scatter 0.05 um, and bows between nodes 100 mm apart

    def test_its_prediction_is_that_of_the_readings(self):
        grid = self.night()
        self.assertEqual([p["measurement"] for p in grid["predicted"]], ["X", "Y", "Z", "PPP", "NPP", "PNP", "PPN"])
        u = [length / math.hypot(*SIZE) for length in SIZE]
        left = []
        for row in csv.DictReader(io.StringIO(diagonal((1, 1, 1)))):
            share = float(row["target_mm"]) / math.hypot(*SIZE)
            e = read(grid, [share * length for length in SIZE])
            left.append(float(row["deviation_um"]) - sum(c * k for c, k in zip(u, e)))
        mean = sum(left) / len(left)
        rms = math.sqrt(sum((v - mean) ** 2 for v in left) / len(left))
        told = next(p for p in grid["predicted"] if p["measurement"] == "PPP")
        self.assertEqual(told["readings"], len(left))
        self.assertAlmostEqual(told["rms_after_um"], rms, places=6)
        self.assertGreater(told["rms_before_um"], 5 * rms)


if __name__ == "__main__":
    unittest.main()
