# SPDX-License-Identifier: Apache-2.0
"""Campaigns of known errors, the program, and what the tests of tables share."""
import json
import math
import os
import pathlib
import pty
import random
import re
import subprocess
import tempfile
import time
import unittest

NONIO = os.environ["NONIO"]


def noise(direction, x):
    """Three numbers whose sum is 0."""
    rng = random.Random("%s%.6f" % (direction, x))
    one, two = rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03)
    return one, two, -one - two


def axis_csv(targets, plus, minus=None, unit="mm"):
    """Three runs whose means are the curves and which scatter by 0.03; deviations in um or arcsec. Zeros stay zeros."""
    of = "deviation_um" if unit == "mm" else "deviation_arcsec"
    rows = ["run,direction,target_%s,%s" % (unit, of)]
    zero = not any(plus(x) for x in targets)
    for run, share in ((1, 0), (2, 1), (3, 2)):
        for direction, curve in (("+", plus), ("-", minus)):
            if curve:
                rows += ["%d,%s,%.6f,%.9f" % (run, direction, x, curve(x) + (
                    0.0 if zero else noise(direction, x)[share]))
                         for x in (targets if direction == "+" else targets[::-1])]
    return "\n".join(rows) + "\n"


class BenchTest(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="nonio-tables-")
        self.site = pathlib.Path(self._folder.name) / "site"
        self.out = pathlib.Path(self._folder.name) / "out"
        self.folder = self.site / "c"
        self.folder.mkdir(parents=True)

    def tearDown(self):
        self._folder.cleanup()

    active_stated, active_backlash, travel = True, '"none"', ""

    def none_active(self, name, kind):
        """No table was active while this axis was measured, and this backlash value; or nothing is stated."""
        text = '[machine.axes.%s]\nkind = "%s"\n%s' % (name, kind, self.travel)
        unit = "deg" if kind == "rotary" else "mm"
        return text + ('active_table = "none"\nactive_backlash_%s = %s\n' % (unit, self.active_backlash) if self.active_stated else "")

    def campaign(self, files, extra="", axes=(("X", "linear"),), control=None):
        text = 'format = 1\n[campaign]\nid = "c"\n[machine]\n'
        if control:
            text += 'control = "%s"\n' % control
        if "number=" not in extra:
            text += 'asset = "S-1"\n'
            self.record([name for name, _ in axes], from_zero=control == "linuxcnc")
        for name, kind in axes:
            text += self.none_active(name, kind)
        for name, (kind, data, more) in files.items():
            (self.folder / (name + ".csv")).write_text(data)
            text += '[[measurement]]\nid = "%s"\nkind = "%s"\nfile = "%s.csv"\n%s\n' % (name, kind, name, more)
        (self.folder / "campaign.toml").write_text(text + extra)

    def record(self, axes, more="", from_zero=False, asset="S-1"):
        """The machine as the site knows it: how its control counts the axes."""
        folder = self.site / "machines"
        folder.mkdir(exist_ok=True)
        (folder / (asset + ".toml")).write_text('format = 1\nasset = "%s"\n%s' % (asset, more) + "".join(
            '[axes.%s]\nkind = "%s"\nnumber = %d\n' % (a, "rotary" if a[0] in "ABC" else "linear", i + (not from_zero))
            for i, a in enumerate(axes)))

    def one_axis(self, targets, plus, minus=None, extra="", control=None, unit="mm", axis="X"):
        self.campaign({axis: ("axis", axis_csv(targets, plus, minus, unit), 'axis = "%s"' % axis)}, extra,
                      ((axis, "linear" if unit == "mm" else "rotary"),), control)

    def nonio(self, *args, expect=0):
        done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=300)
        if expect is not None:
            self.assertEqual(done.returncode, expect, "%s\n%s%s" % (args, done.stderr, done.stdout))
        return done

    def json_of(self, *args, expect=0):
        return json.loads(self.nonio(*args, "--json", expect=expect).stdout)

    def answered(self, args, answers):
        """What `insert` prints on a terminal, and its status; one answer for each question, which ends with a colon."""
        child, terminal = pty.fork()
        if child == 0:
            os.execv(NONIO, [NONIO, *map(str, args)])
        shown, seen = b"", 0
        limit = time.monotonic() + 60
        while time.monotonic() < limit:
            try:
                shown += os.read(terminal, 4096)
            except OSError:
                break
            if answers and re.search(rb"(none\)|oder none\)): $", shown[seen:]):
                seen = len(shown)
                os.write(terminal, answers.pop(0).encode() + b"\n")
        os.close(terminal)
        return shown.decode(), os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

    def run_site(self, expect=0):
        self.nonio("run", self.site, "--out", self.out, "--quiet", expect=expect)
        return json.loads((self.out / "c" / "results.json").read_text())

    def file(self, name):
        return (self.out / "c" / name).read_text()


def interpolate(points, x):
    """Linear between (position, value), the end values outside."""
    points = sorted(points)
    if x <= points[0][0]:
        return points[0][1]
    for (a, u), (b, v) in zip(points, points[1:]):
        if x <= b:
            return u + (x - a) / (b - a) * (v - u)
    return points[-1][1]


def wave(x):
    """um over mm"""
    return 6.0 * math.sin(x / 90.0) + 0.02 * x - 1.5
