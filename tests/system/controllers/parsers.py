# SPDX-License-Identifier: Apache-2.0
"""Tables as the controls read them, by the words of their makers and not by our code.

`TABLE[control](files, axis number or name)` takes the texts of the written files by name and gives a Table: what the
control adds to the position, in um over mm, moving towards plus and towards minus, and its backlash value in um.
"""
import re

from bench import interpolate


class Table:
    """`plus`, `minus`: (mm, um) that are added to the position; outside of them the end values stay."""

    def __init__(self, plus, minus=None, backlash=0.0):
        self.plus, self.minus, self.backlash = sorted(plus), sorted(minus or plus), backlash
        self.span = None  # of a table that goes on at its other end

    def added(self, x, direction="+"):
        if self.span:
            x -= self.span * (x // self.span)
        half = self.backlash / 2.0
        return (interpolate(self.plus, x) + half if direction == "+" else interpolate(self.minus, x) - half)


def rows_of(text, mark="#"):
    return [[float(w) for w in l.split()] for l in text.splitlines() if l and not l.startswith(mark)]


def one(files, end):
    (name,) = [n for n in files if n.endswith(end)]
    return files[name]


def siemens(files, axis=1):
    text = "\n".join(files.values())
    value = lambda name: float(re.search(r"^\$AA_ENC_COMP_%s\[0,AX%d\]=(\S+)" % (name, axis), text, re.M)[1])
    step, low = value("STEP"), value("MIN")
    points = [(low + step * int(i), -1e3 * float(v))
              for i, v in re.findall(r"^\$AA_ENC_COMP\[0,(\d+),AX%d\]=(\S+)" % axis, text, re.M)]
    backlash = re.search(r"^\$MA_BACKLASH\[0,AX%d\]=(\S+)" % axis, text, re.M)
    return Table(points, backlash=1e3 * float(backlash[1]) if backlash else 0.0)


def cec(text):
    """Cross tables of SINUMERIK, as (input, output, Table): axis numbers, what is added to the output by the input."""
    word = lambda name, t: re.search(r"^\$AN_CEC_%s\[%s\]=(\S+)" % (name, t), text, re.M)[1]
    tables = []
    for t in sorted(set(re.findall(r"^\$AN_CEC\[(\d+),", text, re.M)), key=int):
        step, low = float(word("STEP", t)), float(word("MIN", t))
        points = [(low + step * int(i), -1e3 * float(v))
                  for i, v in re.findall(r"^\$AN_CEC\[%s,(\d+)\]=(\S+)" % t, text, re.M)]
        tables.append((int(re.search(r"\d+", word("INPUT_AXIS", t))[0]), int(re.search(r"\d+", word("OUTPUT_AXIS", t))[0]), Table(points)))
    return tables


def heidenhain(files, axis=None):
    lines = one({n: t for n, t in files.items() if not t.startswith("BEGIN CONFIG")}, ".COM").splitlines()
    assert " MM" in lines[0] or "DATUM" in lines[0], lines[0]
    points = [(float(l.split()[1]), -1e3 * float(l.split()[-1])) for l in lines[2:] if l and l[0].isdigit()]
    backlash = [re.search(r"^backLash = (\S+)", t, re.M) for t in files.values()]
    return Table(points, backlash=sum(1e3 * float(b[1]) for b in backlash if b))


def fanuc(files, axis=1):
    text = [t for t in files.values() if t.startswith("%")][0]
    of = {int(n): int(v) for n, v in re.findall(r"^N(\d+)P(-?\d+)", text, re.M)}
    own = {int(m[1]): int(v) for m in re.finditer(r"^N(\d+)((?:A\d+P-?\d+)+)", text, re.M)
           for a, v in re.findall(r"A(\d+)P(-?\d+)", m[2]) if int(a) == axis}
    reference, low, high, scale = (own[n] for n in (3620, 3621, 3622, 3623))
    step, zero = own[3624] * 1e-3, 0.0
    total, points = 0, {reference: 0}
    for n in range(reference + 1, high + 1):
        total += of.get(10000 + n, 0)
        points[n] = total
    total = 0
    for n in range(reference, low - 1, -1):  # number n covers the interval below point n
        total -= of.get(10000 + n, 0)
        points[n - 1] = total
    return Table([(zero + (n - reference) * step, float(v * scale)) for n, v in points.items()],
                 backlash=float(own.get(1851, 0)))


def linuxcnc(files, axis=None):
    rows = rows_of(one(files, ".comp"))
    return Table([(x, 1e3 * (x - up)) for x, up, _ in rows], [(x, 1e3 * (x - down)) for x, _, down in rows])


def fagor(files, axis=None):
    rows = rows_of(one(files, ".txt"))
    return Table([(r[1], -1e3 * r[2]) for r in rows])


def haas(files, axis=None):
    return Table([(25.4 * r[1], -25.4e3 * r[2]) for r in rows_of(one(files, ".txt"))])


def mitsubishi(files, axis=None):
    points, interval = {0: 0.0}, None
    rows = {int(r[0]): (r[1], r[2]) for r in rows_of(one(files, ".txt"))}
    for k in sorted(k for k in rows if k > 0):
        points[k] = points[k - 1] + rows[k][1] / 2.0
    for k in sorted((k for k in rows if k < 0), reverse=True):
        points[k] = points[k + 1] - rows[k][1] / 2.0
    interval = next(iter(rows.values()))[0]
    return Table([(k * interval, v) for k, v in points.items()])


def twincat_ptp(files, axis=None):
    text = one(files, ".st")
    said = re.search(r"MC_BacklashCompensation\.Backlash = (\S+) mm", text)
    return Table([(float(x), 1e3 * float(c)) for x, c in
                  re.findall(r"Position := ([-\d.]+), Compensation := ([-\d.]+)", text)],
                 backlash=1e3 * float(said[1]) if said else 0.0)


def twincat_cnc(files, axis=None):
    text = one(files, ".lis")
    keys = dict(l.split(None, 1) for l in text.splitlines() if l and not l.startswith("#"))
    start, step = int(keys["kw.ssfk.kw_startpos"]), int(keys["kw.ssfk.interval"])
    said = re.search(r"getriebe\[0\]\.lose = (-?\d+)", text)
    return Table([(1e-4 * (start + i * step), -0.1 * int(keys["kw.ssfk.table[%d].pos" % i]))
                  for i in range(int(keys["kw.ssfk.kw_nr_max"]))], backlash=0.1 * int(said[1]) if said else 0.0)


def twincat_volumetric(files, axis=None):
    rows = [l.split("//")[0].split() for l in one(files, ".csv").splitlines()]
    return Table([(float(r[0]), -1e3 * float(r[1])) for r in rows if r and r[0][0] in "-0123456789"])


def ecmc(files, axis=None):
    return Table([(x, -1e3 * v) for x, v in rows_of(one(files, ".corr"))])  # release 9: the value is added to the reading


def aerotech(files, axis=None):
    step, values = None, []
    for line in one(files, ".cal").splitlines():
        line = re.split("[;']", line)[0].strip()
        if "SAMPLEDIST=" in line:
            step = float(re.search(r"SAMPLEDIST=(\S+)", line)[1])
        elif line and not line.startswith(":"):
            values.append(float(line.split()[0]))
    return Table([(i * step, 1e3 * v) for i, v in enumerate(values)])


def pmac(files, axis=None, counts_per_mm=2000.0):
    words = re.search(r"#\d+ DEFINE COMP (\d+),(\d+)\n([-\d\s]+)$", one(files, ".pmc"))
    step = int(words[2]) / int(words[1]) / counts_per_mm
    values = [int(w) / 16.0 / counts_per_mm * 1e3 for w in words[3].split()]
    said = [re.search(r"Ix86 \(Ixx86\) = (\S+) mm", t) for t in files.values()]
    table = Table([(0.0, 0.0)] + [((k + 1) * step, v) for k, v in enumerate(values)],
                  backlash=sum(1e3 * float(s[1]) for s in said if s))
    table.span = int(words[2]) / counts_per_mm
    return table


# Where the sign is not documented, the option in CONTROLS states it.
TABLE = {"siemens-840d": siemens, "heidenhain-tnc": heidenhain, "fanuc": fanuc, "linuxcnc": linuxcnc, "fagor-8055": fagor,
         "haas-classic": haas, "mitsubishi": mitsubishi, "twincat-nc-ptp": twincat_ptp, "twincat-cnc": twincat_cnc,
         "twincat-volumetric": twincat_volumetric, "ecmc": ecmc, "aerotech": aerotech, "pmac": pmac}
OPTIONS = {"fagor-8055": 'sign = "error"\n', "haas-classic": 'sign = "error"\n', "twincat-volumetric": 'sign = "error"\n',
           "ecmc": "release = 9\n", "fanuc": "extended = true\n"}
# um: half a step of the table and, of increments, of the backlash value.
STEP = {"fanuc": 1.0, "mitsubishi": 0.5, "haas-classic": 2.54, "fagor-8055": 0.1, "heidenhain-tnc": 0.1, "twincat-cnc": 0.1,
        "pmac": 0.04}
HAS_BACKLASH = {"siemens-840d", "heidenhain-tnc", "fanuc", "twincat-cnc", "twincat-nc-ptp", "pmac"}
