# SPDX-License-Identifier: Apache-2.0
"""Axes whose error without any table is known, measured in several years, and the backups of their controls."""
import math
import random

from bench import BenchTest
from parsers import OPTIONS, TABLE

FOUR = ("siemens-840d", "fanuc", "heidenhain-tnc", "linuxcnc")
BACKUP = {"siemens-840d": ("-EEC.ini", "-backlash.ini"), "fanuc": (".prm",), "heidenhain-tnc": (".COM", "CONFIG.CMA", ".txt"),
          "linuxcnc": (".comp",)}


class Truth:
    """One axis without any table: um over mm, in two states of wear, and its lost motion."""

    def __init__(self, seed, shape):
        rng = random.Random("%s %d" % (shape, seed))
        self.rng, self.lost = rng, rng.choice([-1, 1]) * rng.uniform(2.0, 8.0)
        length, first = rng.uniform(500.0, 1500.0), rng.choice([0.0, 3.7, -0.5])
        n = rng.randint(9, 21)
        grid = length / (n - 1)
        even = shape != "uneven"
        self.targets = [round(first + grid * i + (0.0 if even else rng.uniform(-0.2, 0.2) * grid), 3) for i in range(n)]
        slope, size, period = rng.uniform(-25, 25) * 1e-3, rng.uniform(2, 8), rng.uniform(0.8, 2.0) * length
        if shape == "line":
            size = 0.0
        self.e = [lambda x, k=k: k * slope * (x - first) + k * size * math.sin(2 * math.pi * x / period)
                  for k in (rng.uniform(0.5, 0.8), rng.uniform(1.0, 1.5))]

    def readings(self, state, table=None, noise=0.3, runs=5):
        rows = ["run,direction,target_mm,deviation_um"]
        for run in range(1, runs + 1):
            for d in "+-":
                for x in self.targets if d == "+" else self.targets[::-1]:
                    rows.append("%d,%s,%.3f,%.3f" % (run, d, x, self.error(state, x, d, table) + self.rng.gauss(0, noise)))
        return "\n".join(rows) + "\n"

    def error(self, state, x, d, table=None):
        return (self.e[state](x) + (0.0 if d == "+" else self.lost) + (table.added(x, d) if table else 0.0))

    def E(self, state, table=None):
        all_ = [self.error(state, x, d, table) for x in self.targets for d in "+-"]
        return max(all_) - min(all_)


class StateBench(BenchTest):
    def site_of(self, control, more=""):
        self.record([], '[axes.X]\nnumber = %d\nreference_mm = 0.0\n%s' % (control != "linuxcnc", more))

    def campaign_of(self, name, date, control, readings, active="", machine='asset = "S-1"\n'):
        folder = self.site / name
        folder.mkdir(exist_ok=True)
        (folder / "x.csv").write_text(readings)
        options = "[options.%s]\n%s" % (control, OPTIONS[control]) if control in OPTIONS else ""
        (folder / "campaign.toml").write_text(
            'format = 1\n[campaign]\nid = "%s"\ndate = %s\n[machine]\n%scontrol = "%s"\n[machine.axes.X]\nkind = "linear"\n%s'
            '[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n%s' % (name, date, machine, control, active, options))
        return folder

    NONE = 'active_table = "none"\nactive_backlash_mm = "none"\n'

    def run_all(self, expect=0):
        self.folder.rmdir() if self.folder.exists() and not any(self.folder.iterdir()) else None
        return self.nonio("run", self.site, "--out", self.out, "--quiet", expect=expect)

    def files(self, control, folder):
        return {p.name: p.read_text() for p in folder.iterdir() if p.is_file() and p.suffix not in (".json", ".pdf")
                and (p.name.startswith(control) or p.suffix in (".COM", ".CMA", ".ini", ".prm", ".comp", ".txt"))}

    def backup(self, control, truth):
        """The table of an earlier campaign, as the control would save it."""
        self.site_of(control)
        self.campaign_of("old", "2022-11-01", control, truth.readings(0), self.NONE)
        self.run_all(None)
        table = TABLE[control](self.files(control, self.out / "old"))
        backup = ",".join(str(p) for p in sorted((self.out / "old").iterdir())
                          if p.name.startswith(control) and p.name.endswith(BACKUP[control]))
        return table, backup
