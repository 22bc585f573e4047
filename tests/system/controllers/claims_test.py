#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the comments of a table state is what its file contains, and outside of the table the machine is no worse than
without it: read back and replayed by independent parsers."""
import json
import os
import random
import re
import unittest

from bench import interpolate
from parsers import HAS_BACKLASH, STEP, TABLE
from truth import BACKUP, StateBench, Truth

SEED = int(os.environ.get("SEED", "0")) or random.SystemRandom().randrange(1, 10**9)


class Axis(Truth):
    """Targets that every control can have; negative positions for the control whose zero is at the upper end."""

    def __init__(self, seed, shape, control):
        super().__init__(seed, shape)
        if control in ("haas-classic", "pmac", "aerotech"):  # the table begins at the zero of the axis
            self.targets = [round(x - self.targets[0], 3) for x in self.targets]
        if control == "haas-classic":
            step = round((self.targets[1] - self.targets[0]) / 12.7 + 0.5) * 12.7
            self.targets = [round(-step * k, 3) for k in range(len(self.targets))][::-1]
        if control in ("pmac", "fanuc", "mitsubishi"):
            step = round(self.targets[1] - self.targets[0], 1)
            self.targets = [round(step * k, 3) for k in range(len(self.targets))]


def means_of(csv):
    sums = {}
    for line in csv.splitlines()[1:]:
        _, d, x, v = line.split(",")
        sums.setdefault((float(x), d), []).append(float(v))
    return {k: sum(v) / len(v) for k, v in sums.items()}


class Claims(StateBench):
    def text_of(self, files):
        return "\n".join(re.sub(r"^\s*(//|#|;)\s?", "", l) for t in files.values() for l in t.splitlines())

    def one(self, pattern, text, what):
        found = {m if isinstance(m, tuple) else (m,) for m in re.findall(pattern, text, re.M)}
        self.assertEqual(len(found), 1, "%s: %s in\n%s" % (what, found, text[:1500]))
        return found.pop()

    def written(self, cases):
        """Control, shape, truth, campaign, files and readings of each case, all of one run: a machine each."""
        made = []
        for control, shape, truth in cases:
            name = "%s-%s" % (control, shape)
            self.record([], "[axes.X]\nnumber = %d\nreference_mm = 0.0\n" % (control != "linuxcnc"), asset=name)
            csv = truth.readings(0)
            folder = self.campaign_of(name, "2022-11-01", control, csv, self.NONE, machine='asset = "%s"\n' % name)
            if control == "pmac":
                path = folder / "campaign.toml"
                path.write_text(path.read_text() + "[options.pmac.axes.X]\ncounts_per_mm = 2000\n")
            made.append((control, shape, truth, name, csv))
        self.run_all(None)
        for control, shape, truth, name, csv in made:
            files = {p.name: p.read_text() for p in sorted((self.out / name).iterdir()) if p.name.startswith(control)}
            self.assertTrue(files, name)
            yield control, shape, truth, name, files, csv

    def test_the_comments_are_true(self):
        print("SEED=%d" % SEED)
        even = ("pmac", "fanuc", "mitsubishi", "haas-classic")
        # Equal readings of two machines would be implausible.
        cases = [(control, shape, Axis(SEED + i, shape, control)) for i, control in enumerate(TABLE)
                 for shape in ("wave", "line" if control in even else "uneven")]
        for control, _, truth, name, files, csv in self.written(cases):
            self.check(control, files, csv, truth, name)

    def check(self, control, files, csv, truth, campaign):
        what, text, table = "%s seed %d" % (control, SEED), self.text_of(files), TABLE[control](files, 1)
        step, means = STEP.get(control, 0.001), means_of(csv)
        near = lambda a, b, by: self.assertLessEqual(abs(a - b), by, "%s: %s, %s" % (what, a, b))
        if control != "twincat-volumetric":
            at = self.one(r"^axis (\S+), measurement (\S+), (\S+), campaign (\S+)$", text, what)
            self.assertEqual(at, ("X", "X", "2022-11-01", campaign))
            low, high, n = self.one(r"^measured from (\S+) mm to (\S+) mm, (\d+) targets$", text, what)
            self.assertEqual((float(low), float(high), int(n)), (truth.targets[0], truth.targets[-1], len(truth.targets)))
        # Entries, as the file has them: without the constants that the parser leaves out.
        largest, where, steep, begin = (float(v) for v in self.one(
            r"largest entry (\S+) um at (\S+) mm, steepest (\S+) um/m from (\S+) mm", text, what))
        columns = [table.plus, table.minus] if table.minus != table.plus else [table.plus]
        if control == "pmac":  # entries that hold the ends are not measured
            columns = [[(x, v) for x, v in table.plus if x <= truth.targets[-1] + 1e-6]]
        digit = 0.000501  # of a text with three decimals
        near(max(abs(v) for c in columns for _, v in c), largest, digit)
        near(max(abs(v) for c in columns for x, v in c if abs(x - where) < 1e-3), largest, digit)
        slopes = [(abs(b[1] - a[1]) / (b[0] - a[0]) * 1e3, a[0]) for c in columns for a, b in zip(c, c[1:])]
        near(max(slopes)[0], steep, digit)
        near(max(s for s, x in slopes if abs(x - begin) < 1e-3), steep, digit)
        # What the run prints is the same, with three digits.
        results = json.loads((self.out / campaign / "results.json").read_text())
        notes = "\n".join(n for t in results["tables"] if t["plugin"] == control for n in t["notes"])
        for one, other in zip(self.one(r"largest entry is (\S+) um, the steepest change (\S+) um/m", notes, what), (largest, steep)):
            near(float(one), other, 0.0051 * max(other, 0.1))
        (zero,) = self.one(r"zero at (?:the reference position )?(\S+) mm", text, what)
        near(sum(interpolate(c, float(zero)) for c in columns) / len(columns), 0.0, step / 2 + 0.001)
        whole = [v for v in means.values()]
        for (E,) in {(e,) for e in re.findall(r"E of the axis (\S+) um", text)}:
            near(float(E), max(whole) - min(whole), 0.001)
        B = sum(means[x, "+"] - means[x, "-"] for x in truth.targets) / len(truth.targets)
        for said in set(re.findall(r"mean reversal B = (-?[\d.]+) um", text)):
            near(float(said), B, 0.001)
        for said in set(re.findall(r"backlash parameter = (-?[\d.]+) mm", text)):
            near(float(said) * 1e3, -B, step / 2 + 0.001)
            if control in HAS_BACKLASH:
                near(table.backlash, float(said) * 1e3, digit)
        for said in set(re.findall(r"^points in this table: (\d+)$", text, re.M)):
            self.assertEqual(int(said), len(table.plus) - (control == "mitsubishi"), what)
        for said in set(re.findall(r"\.comp has (\d+) lines", text)):
            self.assertEqual(int(said), len(table.plus), what)
        for said in set(re.findall(r"^entries in this table: (\d+)$", text, re.M)):
            self.assertEqual(int(said), len(table.plus) - 1, what)
        for said in set(re.findall(r"MD38000\[0\] >= (\d+)", text)):
            self.assertEqual(int(said), len(table.plus), what)
        for low, high in set(re.findall(r"numbers (\d+) to (\d+)", text)):
            points = [int(n) - 10000 for n in re.findall(r"^N(1\d{4})P", text, re.M)]
            self.assertEqual((int(low), int(high)), (min(points), max(points)), what)
        for n, v in re.findall(r"\b(36\d\d|1851) = (-?\d+)", text):
            self.assertIn(int(v), [int(x) for x in re.findall(r"N%sA\d+P(-?\d+)" % n, text)] or [int(v)], what)
        ends = set(re.findall(r"below (\S+) mm and above (\S+) mm the value of that end holds", text))
        if control == "pmac":
            ends = set(re.findall(r"from (\S+) mm to (\S+) mm the value of the nearest end holds", text))
            low, high = (float(v) for v in ends.pop())
            for x, end in ((low, truth.targets[0]), (high, truth.targets[-1])):
                near(table.added(x), table.added(end), 1e-6)
        elif control not in ("twincat-volumetric", "mitsubishi"):
            self.assertEqual({(float(a), float(b)) for a, b in ends},
                             {(round(table.plus[0][0], 4), round(table.plus[-1][0], 4))}, what)

    def test_a_renewed_file_states_the_new_table(self):
        """Nothing of the replaced table is left among the comments."""
        print("SEED=%d" % SEED)
        controls = ("siemens-840d", "fanuc", "heidenhain-tnc", "linuxcnc", "twincat-cnc", "aerotech")
        cases = [(control, "wave", Axis(SEED + i, "wave", control)) for i, control in enumerate(controls)]
        for control, _, truth, name, files, _ in self.written(cases):
            before = TABLE[control](files, 1)
            ends = {**BACKUP, "twincat-cnc": (".lis",), "aerotech": (".cal",)}[control]
            backup = ",".join(str(self.out / name / n) for n in files if n.endswith(ends))
            csv = truth.readings(1, before)
            known = 'active_backlash_mm = %.6f\n' % (before.backlash * 1e-3)
            now = self.campaign_of("now-" + name, "2024-11-20", control, csv, known, machine='asset = "%s"\n' % name)
            self.json_of("table", "insert", backup, "--with", now, "--out", self.site / ("load-" + name))
            load = {p.name: p.read_text() for p in (self.site / ("load-" + name)).iterdir()}
            text, table = self.text_of(load), TABLE[control](load, 1)
            self.assertNotIn("2022-11-01", text, control)
            self.assertIsNone(re.search(r"campaign %s$" % name, text, re.M), control)
            if control != "aerotech":  # it has no parameter for the reversal
                self.assertLess(truth.E(1, table), 1.7 + STEP.get(control, 0.0), control)
            for largest in set(re.findall(r"largest entry (\S+) um", text)):
                self.assertLessEqual(abs(max(abs(v) for c in (table.plus, table.minus) for _, v in c) - float(largest)), 0.000501, control)
            for said in set(re.findall(r"backlash parameter = (-?[\d.]+) mm", text)):
                self.assertLessEqual(abs(table.backlash - 1e3 * float(said)), 0.000501, control)
            for said in set(re.findall(r"getriebe\[0\]\.lose +(-?\d+)$", text, re.M)):
                self.assertLessEqual(abs(0.1 * int(said) - table.backlash), 0.1, control)

    def test_outside_of_the_table_the_machine_is_no_worse(self):
        """A tenth of the length beyond both ends: the error goes on from where it is at the end."""
        print("SEED=%d" % SEED)
        cases = [(control, shape, Axis(SEED - i, shape, control)) for i, control in enumerate(TABLE) for shape in ("wave", "line")]
        for control, shape, truth, _, files, _ in self.written(cases):
            table = TABLE[control](files, 1)
            low, high = truth.targets[0], truth.targets[-1]
            step = STEP.get(control, 0.001) + 0.35
            beyond = [i / 20.0 * 0.1 * (high - low) for i in range(21)]
            rest = lambda x: truth.e[0](x) + table.added(x)
            for end, way in ((low, -1.0), (high, 1.0)):
                for way_off in beyond:
                    x = end + way * way_off
                    self.assertLessEqual(abs(rest(x) - rest(end)), abs(truth.e[0](x) - truth.e[0](end)) + step,
                                         "%s %s seed %d at %g" % (control, shape, SEED, x))
            places = [low - b for b in beyond] + truth.targets + [high + b for b in beyond]
            spread = lambda f: max(map(f, places)) - min(map(f, places))
            # The scatter of the means is in the table too: a range of 0.4 um, of 0.6 at times.
            self.assertLessEqual(spread(rest), spread(truth.e[0]) + step + 0.25, "%s %s seed %d" % (control, shape, SEED))


if __name__ == "__main__":
    unittest.main()
