#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes samples/site: constructed campaigns, each with a story (see README.md beside this file).

    make_samples.py [FOLDER]        default: the folder `site` beside this file

Same bytes every time. All readings are whole numbers of 0.001 um (or 0.001 arcsec), and every
scatter sums to zero, so that the means and reversal values below are exact. The random numbers are
sums of uniform ones: no function of the C library whose last digit could differ between machines.
"""
import math
import os
import random
import sys

RUNS = 5


class Noise:
    """Numbers that look normal, from a seed."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def uniform(self, low, high):
        return low + (high - low) * self.random.random()

    def normal(self):
        return sum(self.random.random() for _ in range(12)) - 6.0

    def scatter(self, s, runs=RUNS):
        """Whole numbers that sum to 0, with the standard deviation s (n - 1) as near as it goes."""
        if runs < 2 or s == 0:
            return [0] * runs
        z = [self.normal() for _ in range(runs)]
        mean = sum(z) / runs
        z = [x - mean for x in z]
        size = math.sqrt(sum(x * x for x in z) / (runs - 1))
        d = [round(x * s / size) for x in z]
        d[0] -= sum(d)
        wanted = s * s * (runs - 1)

        def error(x):
            return abs(sum(v * v for v in x) - wanted)

        pairs = [(i, j) for i in range(runs) for j in range(runs) if i != j]
        while True:
            moved = []
            for i, j in pairs:
                trial = list(d)
                trial[i] += 1
                trial[j] -= 1
                moved.append(trial)
            best = min(moved, key=error)
            if error(best) >= error(d):
                return d
            d = best


def targets(noise, first, last, count, share=0.3):
    """P_i = (i - 1) p + r (ISO 230-2): r random, inside the travel, to 0.001."""
    p = (last - first) / (count - 1)
    out = []
    for i in range(count):
        r = noise.uniform(-share, share) * p
        if i == 0:
            r = abs(r)
        if i == count - 1:
            r = -abs(r)
        out.append(round(first + i * p + r, 3))
    return out


def smooth(noise, size, count):
    """A slow curve over `count` targets, whole numbers, about +-size."""
    waves = [(k, noise.normal() / k, noise.uniform(0.0, 6.283)) for k in (1, 2, 3)]
    curve = [sum(a * math.sin(k * 3.1416 * i / (count - 1) + f) for k, a, f in waves)
             for i in range(count)]
    largest = max(abs(y) for y in curve)
    return [round(size * y / largest) for y in curve]


def standard_cycle(places, mean_plus, mean_minus, s_plus, s_minus, noise, shift=None, runs=RUNS):
    """Rows of the linear cycle: all targets up, then all down, `runs` times.

    Deviations in 0.001 of the unit. shift(place, step) is added, step counting the readings.
    """
    up = [noise.scatter(s, runs) for s in s_plus]
    down = [noise.scatter(s, runs) for s in s_minus]
    rows = []
    for run in range(runs):
        for direction, order in (("+", range(len(places))), ("-", reversed(range(len(places))))):
            for i in order:
                value = mean_plus[i] + up[i][run] if direction == "+" else mean_minus[i] + down[i][run]
                if shift:
                    value += shift(places[i], len(rows))
                rows.append({"run": run + 1, "direction": direction, "target": places[i],
                             "deviation": value})
    return rows


def behind(mean, reversal, noise, spread=140):
    """Means of the - passes for B_i around `reversal`: B_i = mean(+) - mean(-)."""
    return [y - reversal + round(spread * noise.normal()) for y in mean]


def even(values, s):
    return [s for _ in values]


def drawn(values, noise, s):
    """Standard deviations as five readings would give them around s."""
    return [max(s * 0.4, s * (1.0 + 0.3 * noise.normal())) for _ in values]


# --- files ---------------------------------------------------------------------------------------

def decimal(thousandths):
    sign = "-" if thousandths < 0 else ""
    whole, rest = divmod(abs(int(thousandths)), 1000)
    return "%s%d.%03d" % (sign, whole, rest)


def place_text(value):
    return decimal(round(value * 1000))


def table(rows, comment, rotary=False, extra=(), separator=","):
    """A measurement file. A deviation may be text already (a mark of a missing reading)."""
    names = ["run", "direction", "target_deg" if rotary else "target_mm",
             "deviation_arcsec" if rotary else "deviation_um"] + list(extra)
    lines = ["# " + line for line in comment] + [separator.join(names)]
    for row in rows:
        d = row["deviation"]
        fields = [str(row["run"]), row["direction"], place_text(row["target"]),
                  d if isinstance(d, str) else decimal(d)]
        fields += [row[name] for name in extra]
        lines.append(separator.join(fields))
    return "\n".join(lines) + "\n"


def toml(value):
    """A text, or a table of positions."""
    if isinstance(value, dict):
        return "{ %s }" % ", ".join("%s = %g" % item for item in value.items())
    return '"%s"' % value


def manifest(story, ident, customer, place, date, machine, axes, measurements, instrument=None,
             environment=None, analyses=None):
    out = ["# Constructed: nobody measured this machine, and customer and machine are invented."]
    out += ["# " + line for line in story]
    out += ["format = 1", "", "[campaign]", 'id = "%s"' % ident, 'customer = "%s"' % customer,
            'site = "%s"' % place, 'operator = "A. Sample"', "date = %s" % date, "", "[machine]"]
    out += ['%s = "%s"' % item for item in machine.items()]
    for name, keys in axes.items():
        out += ["", "[machine.axes.%s]" % name] + ["%s = %s" % item for item in keys.items()]
    out += ["", "[instrument]"] + ["%s = %s" % item for item in (instrument or INTERFEROMETER).items()]
    if environment:
        out += ["", "[environment]"] + ["%s = %s" % item for item in environment.items()]
    for keys in measurements:
        out += ["", "[[measurement]]"] + ["%s = %s" % (key, toml(value)) for key, value in keys.items()]
    if analyses:
        out += ["", "[run]", "analyses = [%s]" % ", ".join(toml(name) for name in analyses)]
    return "\n".join(out) + "\n"


INTERFEROMETER = {"maker": '"Sample Optics"', "model": '"Laser interferometer"', "serial": '"L-001"',
                  "calibrated": "2026-01-12", "certificate": '"SO-2026-0001"',
                  "U_fixed_um": "0.1", "U_per_m_um": "0.5"}
ROTARY_CALIBRATOR = {"maker": '"Sample Optics"', "model": '"Rotary calibrator"',
                     "serial": '"R-001"', "calibrated": "2026-01-12",
                     "certificate": '"SO-2026-0002"', "U_arcsec": "0.4"}
PROBE = {"maker": '"Sample Optics"', "model": '"Touch probe and ball"', "serial": '"P-001"',
         "calibrated": "2026-01-12", "certificate": '"SO-2026-0003"', "U_fixed_um": "2.0", "U_per_m_um": "1.0"}
GOOD_ROOM = {"misalignment_mm": "0.5", "temperature_range_K": "0.2",
             "temperature_difference_K": "0.8", "expansion_range_um_per_m_K": "1.0",
             "drift_um": "0.6"}


def linear(travel, pitch=10.0, expansion=11.5, **more):
    keys = {"kind": '"linear"', "travel": "[0.0, %.1f]" % travel, "screw_pitch_mm": "%.1f" % pitch,
            "expansion_um_per_m_K": "%.1f" % expansion}
    keys.update(more)
    return keys


def axis_measurement(axis, kind="axis", name=None, **more):
    name = name or axis
    keys = {"id": name, "kind": kind, "axis": axis, "file": name.lower() + ".csv"}
    keys.update(more)
    return keys


MADE_UP = "Constructed readings, see campaign.toml."


# --- the stories ---------------------------------------------------------------------------------

def asymmetric_repeatability():
    noise = Noise(101)
    places = targets(noise, 0.0, 1200.0, 13)
    m = len(places)
    # Standard deviations in 0.001 um, so that R+ = 4 max s+ = 4.516, R- = 4 max s- = 1.756,
    # Ps_max = 3 max(s+ + s-) = 4.275, Ps_mean = 3 mean(s+ + s-) = 3.195.
    s_plus = [noise.uniform(680.0, 900.0) for _ in range(m)]
    s_minus = [noise.uniform(220.0, 330.0) for _ in range(m)]
    s_plus[8], s_minus[8] = 1129.0, 1425.0 - 1129.0
    s_minus[3], s_plus[3] = 439.0, 812.0
    free = [i for i in range(m) if i not in (3, 8)]
    left = 1065.0 * m - sum(s_plus) - sum(s_minus)
    for i in free:
        s_plus[i] += left / len(free)
    mean = smooth(noise, 3200, m)
    reversal = [-1150 + round(60 * noise.normal()) for _ in places]
    rows = standard_cycle(places, mean, [a - b for a, b in zip(mean, reversal)], s_plus, s_minus, noise)
    story = ["One direction repeats well, the other does not: a spindle nut that settles only from one side.",
             "ISO 230-2 (2014): R+ 4.516 um, R- 1.756 um.",
             "VDI/DGQ 3441 averages the two directions away: Ps_max 4.275 um, Ps_mean 3.195 um."]
    return {"campaign.toml": manifest(
                story, "01-asymmetric-repeatability", "Esempio Uno S.r.l.", "Torino", "2026-03-02",
                {"maker": "Sample Machines", "model": "VM 12", "serial": "S-0101",
                 "structure": "single-column", "control": "siemens-840d"},
                {"X": linear(1200.0)}, [axis_measurement("X")], environment=GOOD_ROOM),
            "x.csv": table(rows, [MADE_UP])}


def constant_reversal():
    noise = Noise(102)
    places = targets(noise, 0.0, 1000.0, 13)
    m = len(places)
    # B_mean = -8.143, max |B_i| = 8.943; the rest lies as closely as the scatter would have it.
    reversal = [-8143 + round(230 * max(-2.0, min(2.0, noise.normal()))) for _ in places]
    reversal[5] = -8943
    for k in range(abs(-8143 * m - sum(reversal))):
        i = k % m if k % m != 5 else 6
        reversal[i] += 1 if -8143 * m > sum(reversal) else -1
    mean = smooth(noise, 2500, m)
    rows = standard_cycle(places, mean, [a - b for a, b in zip(mean, reversal)],
                          drawn(places, noise, 560.0), drawn(places, noise, 560.0), noise)
    story = ["Lost motion, the same everywhere: every pass back is about 8 um behind.",
             "ISO 230-2: B_mean -8.143 um (with its sign), B 8.943 um. VDI/DGQ 3441: U_mean 8.143, U_max 8.943.",
             "One value in the control compensates it."]
    return {"campaign.toml": manifest(
                story, "02-constant-reversal", "Esempio Due S.p.A.", "Bologna", "2026-03-04",
                {"maker": "Sample Machines", "model": "HM 10", "serial": "S-0102",
                 "structure": "single-column", "control": "fanuc"},
                {"Z": linear(1000.0)}, [axis_measurement("Z")], environment=GOOD_ROOM),
            "z.csv": table(rows, [MADE_UP])}


def opposed_sinusoids():
    noise = Noise(103)
    half = [0.0, 31.7, 57.4, 90.0, 118.9, 152.3]
    places = half + [x + 180.0 for x in half]
    sine = [math.sin(math.radians(x)) for x in half]

    def shape(share):
        return [5580.0 * ((1.0 - share) * y + share * y ** 3) for y in sine]

    low, high = 0.0, 1.5  # share of the third power for which the mean of |B_i| is 2.47
    for _ in range(60):
        middle = 0.5 * (low + high)
        if sum(abs(y) for y in shape(middle)) / len(half) > 2470.0:
            low = middle
        else:
            high = middle
    first = [2 * round(y / 2.0) for y in shape(low)]
    first[3] = 5580
    second = [-y for y in first]
    second[3] += 60  # 270 deg a little less than 90 deg
    second[1] -= 30
    second[5] -= 30
    reversal = first + second
    mean = [round(500 * math.cos(math.radians(2.0 * x))) for x in places]
    plus = [a + b // 2 for a, b in zip(mean, reversal)]
    minus = [a - b // 2 for a, b in zip(mean, reversal)]
    rows = standard_cycle(places, plus, minus, drawn(places, noise, 330.0),
                          drawn(places, noise, 330.0), noise)
    story = ["A table whose two directions swing against each other: the drive winds up with the load.",
             "ISO 230-2: B_mean 0.00 arcsec, yet B 5.58 arcsec. VDI/DGQ 3441: U_mean 2.47, U_max 5.58 arcsec.",
             "A single backlash value would make it worse at half of the targets."]
    axis = {"kind": '"rotary"', "travel": "[0.0, 360.0]", "teeth": "120"}
    return {"campaign.toml": manifest(
                story, "03-opposed-sinusoids", "Esempio Tre S.n.c.", "Brescia", "2026-03-06",
                {"maker": "Sample Machines", "model": "RT 5", "serial": "S-0103",
                 "structure": "other", "control": "heidenhain-tnc"},
                {"C": axis}, [axis_measurement("C")], instrument=ROTARY_CALIBRATOR,
                environment={"drift_arcsec": "0.3"}),
            "c.csv": table(rows, [MADE_UP], rotary=True)}


def with_temperature(rows, seconds, warming):
    """Time and temperatures; warming(seconds) is what the machine gained since the start."""
    for step, row in enumerate(rows):
        t = step * seconds
        row["time_s"] = "%d" % t
        row["material_c"] = "%.2f" % (20.0 + warming(t))
        row["air_c"] = "%.2f" % (20.6 + 0.2 * warming(t))
    return rows


ENVIRONMENT_COLUMNS = ("time_s", "material_c", "air_c")


def parallel_drift():
    noise = Noise(104)
    places = targets(noise, 0.0, 800.0, 11)
    mean = smooth(noise, 1800, len(places))
    rows = standard_cycle(places, mean, behind(mean, -1400, noise), drawn(places, noise, 380.0),
                          drawn(places, noise, 380.0), noise,
                          shift=lambda place, step: round(0.075 * 1000 * step))
    with_temperature(rows, 24, lambda t: 0.0001 * t)
    story = ["Every pass lies a little higher than the one before, by the same amount everywhere:",
             "the zero moves (spindle heat, dead path), not the scale. It looks like bad repeatability.",
             "The machine is not thermally stable: do not compensate yet."]
    return {"campaign.toml": manifest(
                story, "04-drift-parallel", "Esempio Quattro S.r.l.", "Modena", "2026-03-09",
                {"maker": "Sample Machines", "model": "VM 8", "serial": "S-0104",
                 "structure": "single-column", "control": "linuxcnc"},
                {"Y": linear(800.0)}, [axis_measurement("Y")]),
            "y.csv": table(rows, [MADE_UP], extra=ENVIRONMENT_COLUMNS)}


def wedge_drift():
    noise = Noise(105)
    places = targets(noise, 0.0, 1500.0, 16)
    mean = smooth(noise, 2000, len(places))
    warming = 0.00045  # K/s; a screw at 11.5 um/(m K) that is clamped at 0

    def grow(place, step):
        return round(1000 * 11.5 * (place / 1000.0) * warming * 20.0 * step)

    rows = standard_cycle(places, mean, behind(mean, -1800, noise), drawn(places, noise, 420.0),
                          drawn(places, noise, 420.0), noise, shift=grow)
    with_temperature(rows, 20, lambda t: warming * t)
    story = ["The passes open like a fan: nothing at the clamped end, more and more along the travel.",
             "The screw warms up under work and grows. Warm up first, measure again, then compensate."]
    return {"campaign.toml": manifest(
                story, "05-drift-wedge", "Esempio Cinque S.p.A.", "Vicenza", "2026-03-11",
                {"maker": "Sample Machines", "model": "HM 15", "serial": "S-0105",
                 "structure": "single-column", "control": "siemens-840d"},
                {"X": linear(1500.0)}, [axis_measurement("X")]),
            "x.csv": table(rows, [MADE_UP], extra=ENVIRONMENT_COLUMNS)}


def long_axis():
    noise = Noise(106)
    places = targets(noise, 0.0, 14500.0, 59, share=0.04)
    wave = smooth(noise, 9000, len(places))
    plus, minus = [], []
    for i, place in enumerate(places):
        y = wave[i] + round(3.1 * place) + round(1800 * math.sin(place / 420.0))
        plus.append(y + round(700 * noise.normal()))
        minus.append(y + 11500 + round(700 * noise.normal()))
    rows = standard_cycle(places, plus, minus, even(places, 0), even(places, 0), noise, runs=1)
    story = ["A gantry axis of 14.5 m: one run each way, a target about every 250 mm.",
             "One run has no scatter, so there is no R and no A, and the report says so."]
    axis = linear(14500.0, pitch=20.0)
    return {"campaign.toml": manifest(
                story, "06-long-axis", "Esempio Sei S.r.l.", "Trieste", "2026-03-16",
                {"maker": "Sample Machines", "model": "GT 145", "serial": "S-0106",
                 "structure": "gantry", "control": "siemens-840d"},
                {"X": axis}, [axis_measurement("X")], environment=GOOD_ROOM),
            "x.csv": table(rows, [MADE_UP])}


def italian_export():
    noise = Noise(107)
    places = targets(noise, 0.0, 600.0, 9)
    mean = smooth(noise, 4100, len(places))
    rows = standard_cycle(places, mean, behind(mean, -2600, noise), drawn(places, noise, 450.0),
                          drawn(places, noise, 450.0), noise)
    for step, row in enumerate(rows):
        row["material_c"] = "%.1f" % (20.3 + 0.1 * math.sin(step / 15.0))
    text = table(rows, [], extra=("material_c",), separator=";").replace(".", ",")
    comment = ("# Letture costruite, non misurate: nessuna macchina \u00e8 stata toccata.\n"
               "# Esportate come da un foglio elettronico italiano.\n")
    story = ["The file is what an Italian spreadsheet exports: fields between `;`, decimal commas,",
             "a byte-order mark, and lines that end in CRLF. It is read as it is."]
    return {"campaign.toml": manifest(
                story, "07-italian-spreadsheet", "Esempio Sette S.a.s.", "Cuneo", "2026-03-18",
                {"maker": "Sample Machines", "model": "VM 6", "serial": "S-0107",
                 "structure": "single-column"},
                {"Y": linear(600.0)}, [axis_measurement("Y", file="esportazione.csv")]),
            "esportazione.csv": ("\ufeff" + comment + text).replace("\n", "\r\n")}


def broken():
    noise = Noise(108)
    places = targets(noise, 0.0, 500.0, 6)
    mean = smooth(noise, 2000, len(places))
    rows = standard_cycle(places, mean, [y + 900 for y in mean], even(places, 400.0),
                          even(places, 400.0), noise)
    lines = table(rows, [MADE_UP, "A digit of one target was typed as the letter O."]).split("\n")
    fields = lines[16].split(",")
    fields[2] = fields[2][:1] + "O" + fields[2][2:]
    lines[16] = ",".join(fields)
    story = ["The file has a typing error: the letter O in a number. The campaign fails with the line and the",
             "column, and all the others of the night go on."]
    return {"campaign.toml": manifest(
                story, "08-broken-file", "Esempio Otto S.r.l.", "Pavia", "2026-03-20",
                {"maker": "Sample Machines", "model": "VM 5", "serial": "S-0108",
                 "structure": "single-column"},
                {"X": linear(500.0)}, [axis_measurement("X")]),
            "x.csv": "\n".join(lines)}


def tolerances():
    noise = Noise(109)
    places = targets(noise, 0.0, 1000.0, 11)
    mean = smooth(noise, 3600, len(places))
    reversal = [-4600 + round(120 * noise.normal()) for _ in places]
    rows = standard_cycle(places, mean, [a - b for a, b in zip(mean, reversal)],
                          drawn(places, noise, 420.0), drawn(places, noise, 420.0), noise)
    story = ["With tolerances, an instrument and its surroundings: every value has its uncertainty U (k = 2), and",
             "every tolerance an answer after ISO 14253-1. A conforms, B does not conform, and E lies so close to its",
             "limit that it cannot be decided: three answers, not two."]
    axis = linear(1000.0, tolerance_um="{ A = 22.0, E = 12.0, B = 3.0 }")
    return {"campaign.toml": manifest(
                story, "09-tolerances", "Esempio Nove S.p.A.", "Padova", "2026-03-23",
                {"maker": "Sample Machines", "model": "VM 10", "serial": "S-0109",
                 "structure": "single-column", "control": "siemens-840d"},
                {"X": axis}, [axis_measurement("X")],
                environment={"misalignment_mm": "1.0", "temperature_range_K": "0.2",
                             "temperature_difference_K": "1.5", "expansion_range_um_per_m_K": "1.0",
                             "drift_um": "1.0"}),
            "x.csv": table(rows, [MADE_UP])}


def one_direction():
    noise = Noise(1110)
    places = targets(noise, 0.0, 700.0, 9)
    mean = smooth(noise, 2700, len(places))
    rows = standard_cycle(places, mean, mean, drawn(places, noise, 500.0),
                          even(places, 0), noise)
    rows = [row for row in rows if row["direction"] == "+"]
    story = ["Measured from one side only. What one direction gives is given (A+, E+, R+); what needs both",
             "(A, E, R, B) is absent, never 0, and no backlash is written."]
    return {"campaign.toml": manifest(
                story, "10-one-direction", "Esempio Dieci S.r.l.", "Udine", "2026-03-25",
                {"maker": "Sample Machines", "model": "GR 7", "serial": "S-0110",
                 "structure": "other"},
                {"Z": linear(700.0)}, [axis_measurement("Z")], environment=GOOD_ROOM),
            "z.csv": table(rows, [MADE_UP])}


def missing_and_misread():
    noise = Noise(111)
    places = targets(noise, 0.0, 900.0, 10)
    mean = smooth(noise, 3000, len(places))
    rows = standard_cycle(places, mean, behind(mean, -1200, noise), drawn(places, noise, 480.0),
                          drawn(places, noise, 480.0), noise)
    for step, mark in ((23, "-1e20"), (24, ""), (57, "n/a")):
        rows[step]["deviation"] = mark
    rows[66]["deviation"] += 9000
    story = ["Three readings were not taken (blank, n/a, and the -1e20 that some instruments write): they are",
             "missing and counted, never zero. One reading of run 4 is 9 um off: it is named as a suspected",
             "misreading and stays in the evaluation, because nobody removes readings in silence."]
    return {"campaign.toml": manifest(
                story, "11-missing-and-misread", "Esempio Undici S.r.l.", "Como", "2026-03-27",
                {"maker": "Sample Machines", "model": "VM 9", "serial": "S-0111",
                 "structure": "bridge"},
                {"X": linear(900.0)}, [axis_measurement("X")], environment=GOOD_ROOM),
            "x.csv": table(rows, [MADE_UP])}


def straightness():
    noise = Noise(112)
    places = targets(noise, 0.0, 1000.0, 11)
    m = len(places)
    mean = smooth(noise, 2600, m)
    rows = standard_cycle(places, mean, behind(mean, -1500, noise), drawn(places, noise, 400.0),
                          drawn(places, noise, 400.0), noise)
    bow = [round(6500 * (1.0 - (2.0 * x / 1000.0 - 1.0) ** 2)) + round(300 * noise.normal())
           for x in places]
    lateral = standard_cycle(places, bow, behind(bow, -250, noise), drawn(places, noise, 350.0),
                             drawn(places, noise, 350.0), noise)
    story = ["Two measurements of one axis: its positions, and its straightness in the direction of Y (a bow of",
             "about 6.5 um). The straightness has a file of the same form and names its direction."]
    return {"campaign.toml": manifest(
                story, "12-straightness", "Esempio Dodici S.p.A.", "Novara", "2026-03-30",
                {"maker": "Sample Machines", "model": "HM 10", "serial": "S-0112",
                 "structure": "single-column", "control": "siemens-840d"},
                {"X": linear(1000.0), "Y": linear(600.0)},
                [axis_measurement("X"), axis_measurement("X", "straightness", "X-in-Y", lateral="Y")],
                environment=GOOD_ROOM),
            "x.csv": table(rows, [MADE_UP]),
            "x-in-y.csv": table(lateral, [MADE_UP])}


class Gantry:
    """12 m x 9 m, 30 steps of 400, 300 and 500 mm (3-4-5). Errors in um over t = 0..1 of the travel,
    0 at both ends; the linear forward model of docs/formulas.md."""
    n, Lx, Ly = 30, 12000.0, 9000.0
    lines_of_x = (300.0, 8700.0)
    B_x, B_y = -2.0, -1.5  # reversal

    def __init__(self, straight, square):
        self.straight, self.k = straight, square

    def EYX(self, t):
        return self.straight * (38.0 * 4.0 * t * (1.0 - t) - 21.0 * math.sin(2.0 * math.pi * t)
                                + 5.0 * math.sin(3.0 * math.pi * t))

    def EXY(self, t):
        return self.straight * (-27.0 * 4.0 * t * (1.0 - t) + 14.0 * math.sin(2.0 * math.pi * t))

    def x(self, side, t):
        """Positioning of X on one line: what calibration left."""
        return (3.0 * math.sin(5.0 * t) - 4.0 * t + 1.5 * math.sin(13.0 * t)
                + side * (2.5 * math.sin(4.0 * t) + 1.0 * t))

    def y(self, t):
        return -2.5 * math.sin(6.0 * t) + 3.0 * t

    def x_at(self, y, t):
        low, high = self.lines_of_x
        second = (y - low) / (high - low)
        return (1.0 - second) * self.x(0, t) + second * self.x(1, t)

    def point(self, a, b):
        """Error of the tool point at a, b = 0..1 of both travels: um along X and Y."""
        y = self.Ly * b
        return (self.x_at(y, a) + self.EXY(b) - self.k * 1e-3 * y, self.EYX(a) + self.y(b))

    def along(self, start, end, steps):
        """Places from the first stop, mm, and what is read there, 0.001 um."""
        dx, dy = (end[0] - start[0]) * self.Lx, (end[1] - start[1]) * self.Ly
        length = math.hypot(dx, dy)
        places, values = [], []
        for j in range(steps + 1):
            t = j / steps
            ex, ey = self.point(start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1]))
            places.append(round(length * t, 3))
            values.append((ex * dx + ey * dy) / length)
        return places, [round(1000.0 * (v - values[0])) for v in values]


def gantry_rows(places, mean, reversal, noise):
    """Two runs in both directions."""
    return standard_cycle(places, [y + round(500.0 * reversal) for y in mean],
                          [y - round(500.0 * reversal) for y in mean],
                          drawn(places, noise, 500.0), drawn(places, noise, 500.0), noise, runs=2)


def gantry_diagonals():
    noise = Noise(113)
    before, after = Gantry(1.0, 8.0), Gantry(0.06, 0.3)
    files, measurements = {}, []

    def add(ident, name, rows, **keys):
        files[name] = table(rows, [MADE_UP])
        measurements.append({"id": ident, "file": name, **keys})

    t = [i / Gantry.n for i in range(Gantry.n + 1)]
    steps_x = [400.0 * i for i in range(Gantry.n + 1)]
    steps_y = [300.0 * i for i in range(Gantry.n + 1)]
    for side, line in enumerate(Gantry.lines_of_x):
        curve = [round(1000.0 * (before.x(side, p) - before.x(side, 0.0))) for p in t]
        add("X%d" % (side + 1), "x%d.csv" % (side + 1), gantry_rows(steps_x, curve, Gantry.B_x, noise),
            kind="axis", axis="X", at={"Y": line})
    curve = [round(1000.0 * (before.y(p) - before.y(0.0))) for p in t]
    add("Y", "y.csv", gantry_rows(steps_y, curve, Gantry.B_y, noise), kind="axis", axis="Y")
    reversal = 0.8 * Gantry.B_x + 0.6 * Gantry.B_y
    for when, machine in (("00", before), ("final", after)):
        lines = [("D1", (0.0, 0.0), (1.0, 1.0), Gantry.n), ("D2", (0.0, 1.0), (1.0, 0.0), Gantry.n)]
        if when == "00":
            lines.append(("D3", (0.0, 0.0), (1.0, 0.5), Gantry.n // 2))
        for name, start, end, steps in lines:
            places, mean = machine.along(start, end, steps)
            add("%s %s" % (name, when), "%s-%s.csv" % (name.lower(), when),
                gantry_rows(places, mean, reversal, noise), kind="diagonal",
                **{"from": {"X": 12000.0 * start[0], "Y": 9000.0 * start[1]},
                   "to": {"X": 12000.0 * end[0], "Y": 9000.0 * end[1]}})
    story = ["A gantry of 12 m x 9 m. Positioning of both sides of X and of Y is calibrated, so the diagonals should",
             "be equal but for squareness. They are not: errors many times larger, at points that do not correspond.",
             "It is the straightness of both axes. A third diagonal, to half of Y, tells the two apart. D1 final and",
             "D2 final are read after the compensation: nearly equal, which proves less than it seems."]
    files["campaign.toml"] = manifest(
        story, "13-gantry-diagonals", "Esempio Tredici S.p.A.", "Verona", "2026-04-02",
        {"maker": "Sample Machines", "model": "PG 12", "serial": "S-0113", "structure": "gantry",
         "control": "siemens-840d"},
        {"X": linear(12000.0), "Y": linear(9000.0)}, measurements, environment=GOOD_ROOM,
        analyses=["iso230-2", "diagonal-straightness"])
    return files


# --- rotary axes -----------------------------------------------------------------------------------

def turned(point, centre, direction, degrees):
    """A point turned about a line, in mm, exactly (Rodrigues)."""
    t = math.radians(degrees)
    arm = [p - c for p, c in zip(point, centre)]
    along = sum(a * d for a, d in zip(arm, direction))
    cross = [direction[1] * arm[2] - direction[2] * arm[1], direction[2] * arm[0] - direction[0] * arm[2],
             direction[0] * arm[1] - direction[1] * arm[0]]
    return [c + a * math.cos(t) + x * math.sin(t) + d * along * (1.0 - math.cos(t))
            for c, a, x, d in zip(centre, arm, cross, direction)]


def unit(vector):
    size = math.sqrt(sum(v * v for v in vector))
    return [v / size for v in vector]


def ball_centres(noise, centre, direction, start, angles, sigma_um, comment):
    """The file of a ball that turns with the axis; coordinates to 0.0001 mm, noise in each."""
    direction = unit(direction)
    lines = ["# " + line for line in comment] + ["angle_deg,x_mm,y_mm,z_mm"]
    for angle in angles:
        point = turned(start, centre, direction, angle)
        read = [p + 0.001 * sigma_um * noise.normal() for p in point]
        lines.append(f"{angle}," + ",".join(f"{x:.4f}" for x in read))
    return "\n".join(lines) + "\n"


def rotary_table():
    noise = Noise(114)
    # The ball is 261 mm from each line; C leans by 146 urad, B carries C.
    c_line = ([412.300, 305.120, -148.600], [0.00012, -0.00008, 1.0])
    b_line = ([412.286, 0.0, -310.045], [0.00015, 1.0, -0.00007])
    c_start = [412.300 + 261.0, 305.120, -130.0]
    b_start = [412.286, 118.0, -310.045 + 261.0]
    story = ["A rotary table: C (full turn, every 45 deg) on a swivelling axis B (-60 to 90 deg, every 15 deg), a ball",
             "261 mm from each axis, both read in one frame. Constructed: lines and noise (1 um in each coordinate) are",
             "chosen; the centres are the ball turned exactly about the lines."]
    text = manifest(story, "14-rotary-table", "Esempio Quattordici S.r.l.", "Udine", "2026-04-02",
                    {"maker": "Sample Machines", "model": "UM 5", "serial": "S-0114", "structure": "bridge"},
                    {"C": {"kind": '"rotary"', "travel": "[0.0, 360.0]"},
                     "B": {"kind": '"rotary"', "travel": "[-60.0, 90.0]"}},
                    [axis_measurement("C", "ball-centres"), axis_measurement("B", "ball-centres")],
                    PROBE)
    text += """
[run]
analyses = ["rotary-kinematics"]

[options.rotary-kinematics]
same_reference = ["C", "B"]
"""
    made = [MADE_UP]
    return {"campaign.toml": text,
            "c.csv": ball_centres(noise, *c_line, c_start, range(0, 360, 45), 1.0, made),
            "b.csv": ball_centres(noise, *b_line, b_start, range(-60, 91, 15), 1.0, made)}


# Step diagonals: the signs with which the axes go, and the order of their moves.
DIAGONALS = {"PPP": (1, 1, 1), "NPP": (-1, 1, 1), "PNP": (1, -1, 1), "PPN": (1, 1, -1)}


def errors_of_volume(noise, size):
    """Nine curves over t = 0..1, 0 at 0, in 0.001 um: [axis][direction]. Slopes hold squareness."""
    def curve():
        a, b, c = (size * noise.normal() for _ in range(3))
        f = noise.uniform(0.0, 6.283)
        return lambda t: (a * t + 0.6 * b * (math.sin(3.1416 * t))
                          + 0.25 * c * (math.sin(6.2832 * t + f) - math.sin(f)))
    return [[curve() for _ in range(3)] for _ in range(3)]


def step_readings(travel, n, curves, share):
    """{diagonal: [deviation after each of the 3n moves]}: u.(E(position) - E(start)), times share."""
    length = math.sqrt(sum(t * t for t in travel))
    out = {}
    for name, sign in DIAGONALS.items():
        readings, moves = [], [0, 0, 0]

        def error(direction):
            places = [m if s > 0 else n - m for m, s in zip(moves, sign)]
            return sum(curves[axis][direction](places[axis] / n) for axis in range(3))
        start = [error(d) for d in range(3)]
        for step in range(3 * n):
            moves[step % 3] += 1
            readings.append(share * sum(sign[d] * travel[d] / length * (error(d) - start[d])
                                        for d in range(3)))
        out[name] = readings
    return out


def set_up_readings(noise, travel, n, angle):
    """What mirrors that stand askew by about `angle` (rad) add: nothing after a whole cycle."""
    length = math.sqrt(sum(t * t for t in travel))
    out = {}
    for name, sign in DIAGONALS.items():
        u = [s * t / length for s, t in zip(sign, travel)]
        nu = [angle * noise.normal() for _ in range(3)]
        along = sum(a * b for a, b in zip(nu, u))
        nu = [a - along * b for a, b in zip(nu, u)]
        steps = [1e6 * a * s * t / n for a, s, t in zip(nu, sign, travel)]
        out[name] = [sum(steps[:step % 3 + 1]) if step % 3 < 2 else 0.0 for step in range(3 * n)]
    return out


def step_table(noise, travel, n, curves, largest):
    """A file whose largest deviation after whole cycles is `largest` (0.001 um), and the share of
    the curves that is in it."""
    askew = set_up_readings(noise, travel, n, 60e-6)
    scatter = {name: [50.0 * noise.normal() for _ in range(3 * n)] for name in DIAGONALS}

    def readings(share):
        plain = step_readings(travel, n, curves, share)
        return {name: [round(a + b + c) for a, b, c in zip(plain[name], askew[name], scatter[name])]
                for name in DIAGONALS}

    def worst(share):
        return max(abs(r) for values in readings(share).values() for r in values[2::3])
    low, high = 0.0, 100.0
    while high - low > 1e-9:
        middle = (low + high) / 2.0
        low, high = (middle, high) if worst(middle) < largest else (low, middle)
    rows = ["# " + MADE_UP, "diagonal,step,moved,deviation_um"]
    for name, values in readings(high).items():
        rows += ["%s,%d,%s,%s" % (name, i + 1, "XYZ"[i % 3], decimal(v)) for i, v in enumerate(values)]
    return "\n".join(rows) + "\n", high


def lengths_table(noise, travel, curve, share):
    """An axis run on the line through the middle of the volume."""
    places = targets(noise, 0.0, travel, 21)
    mean = [share * curve(x / travel) for x in places]
    rows = standard_cycle(places, [round(y) - 150 for y in mean], [round(y) + 150 for y in mean],
                          even(places, 200.0), even(places, 200.0), noise)
    return table(rows, [MADE_UP])


def step_diagonals(seed, ident, customer, place, date, model, travel, n, before, after):
    noise = Noise(seed)
    files, measurements = {}, []
    for occasion, largest in (("00", before), ("final", after)):
        curves = errors_of_volume(noise, 10000.0)
        text, share = step_table(noise, travel, n, curves, largest)
        files["sd-%s.csv" % occasion] = text
        for k, axis in enumerate("XYZ"):
            measurements.append(axis_measurement(axis, "axis", "%s %s" % (axis, occasion)))
            measurements[-1]["file"] = "%s-%s.csv" % (axis.lower(), occasion)
            files[measurements[-1]["file"]] = lengths_table(noise, travel[k], curves[k][k], share)
        measurements.append({"id": "SD %s" % occasion, "kind": "step-diagonal",
                             "from": dict.fromkeys("XYZ", 0), "to": dict(zip("XYZ", travel)),
                             "file": "sd-%s.csv" % occasion})
    story = ["Step diagonals of a volume of %d x %d x %d mm in %d steps, before (00) and after (final) a" % (*travel, n),
             "compensation: the largest deviation at whole steps is %.1f um, then %.1f um. The axis runs beside" % (
                 before / 1000.0, after / 1000.0),
             "them give the lengths that step diagonals do not know; the mirror stands askew by some 0.06 mrad."]
    text = manifest(story, ident, customer, place, date,
                    {"maker": "Sample Machines", "model": model, "serial": "S-0%d" % seed,
                     "structure": "bridge", "control": "siemens-840d"},
                    {axis: linear(float(t)) for axis, t in zip("XYZ", travel)}, measurements,
                    environment=GOOD_ROOM)
    files["campaign.toml"] = text + '\n[run]\nanalyses = ["iso230-2", "step-diagonal"]\n'
    return files


def step_diagonal_800():
    return step_diagonals(115, "15-step-diagonal", "Esempio Quindici S.p.A.", "Parma", "2026-04-08",
                          "BM 8", (800, 600, 600), 40, 60000, 6800)


def step_diagonal_900():
    return step_diagonals(116, "16-step-diagonal", "Esempio Sedici S.r.l.", "Reggio Emilia", "2026-04-10",
                          "BM 9", (900, 720, 720), 30, 58000, 8700)


STORIES = {
    "01-asymmetric-repeatability": asymmetric_repeatability,
    "02-constant-reversal": constant_reversal,
    "03-opposed-sinusoids": opposed_sinusoids,
    "04-drift-parallel": parallel_drift,
    "05-drift-wedge": wedge_drift,
    "06-long-axis": long_axis,
    "07-italian-spreadsheet": italian_export,
    "08-broken-file": broken,
    "09-tolerances": tolerances,
    "10-one-direction": one_direction,
    "11-missing-and-misread": missing_and_misread,
    "12-straightness": straightness,
    "13-gantry-diagonals": gantry_diagonals,
    "14-rotary-table": rotary_table,
    "15-step-diagonal": step_diagonal_800,
    "16-step-diagonal": step_diagonal_900,
}

SITE = """# What holds for all sample campaigns. The laboratory is invented.
[laboratory]
name = "Sample Calibration Laboratory"
address = "Via dell'Esempio 1, 10100 Torino"
country = "IT"
accreditation = "none (sample)"
authoriser = "B. Sample"

[run]
analyses = ["iso230-2", "vdi-dgq-3441"]

[limits]
seconds = 60
memory_MB = 2000
"""


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(text.encode("utf-8"))


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, "site")
    write(os.path.join(folder, "site.toml"), SITE)
    for name, story in STORIES.items():
        for file, text in story().items():
            write(os.path.join(folder, name, file), text)


if __name__ == "__main__":
    main()
