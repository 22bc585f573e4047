#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes samples/site: constructed campaigns, each with a story (see samples/README.md).

    make_samples.py [FOLDER]        default: the folder of this file

Same bytes every time. All readings are whole numbers of 0.001 um (or 0.001 arcsec), and every
scatter sums to zero, so that the means and reversal values below are exact. The random numbers are
sums of uniform ones: no function of the C library whose last digit could differ between machines.
"""
import argparse
import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import by_rules  # noqa: E402 (this folder is no package)
import for_customers  # noqa: E402 (this folder is no package)
import in_circles  # noqa: E402
import in_fine  # noqa: E402
import in_heat  # noqa: E402
import in_space  # noqa: E402 (this folder is no package)
import in_volumes  # noqa: E402
from parts import (GOOD_ROOM, MADE_UP, ROTARY_CALIBRATOR, Noise, axis_measurement, behind, decimal,
                   drawn, even, linear, manifest, smooth, standard_cycle, table, targets, toml)


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
    # B_mean = -8.143, max |B_i| = 8.943; the others vary by the scatter only.
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
             "every tolerance a decision according to ISO 14253-1. A conforms, B does not conform, and E is so close to",
             "its limit that it is indeterminate: three decisions, not two."]
    axis = linear(1000.0, tolerance_um="{ A = 22.0, E = 12.0, B = 3.0 }")
    return {"campaign.toml": manifest(
                story, "09-tolerances", "Esempio Nove S.p.A.", "Padova", "2026-03-23",
                {"asset": "S-0109", "maker": "Sample Machines", "model": "VM 10", "serial": "S-0109",
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
                environment=GOOD_ROOM, analyses=["iso230-2", "vdi-dgq-3441", "direct-straightness"]),
            "x.csv": table(rows, [MADE_UP]),
            "x-in-y.csv": table(lateral, [MADE_UP])}


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
    **in_space.STORIES,
    **in_volumes.STORIES,
    **by_rules.STORIES,
    **in_circles.STORIES,
    **in_heat.STORIES,
    **in_fine.STORIES,
}

RECORDS = {"S-0109": """# Constructed, as all samples are: what the house knows of this machine, whoever measures it.
format = 1
asset = "S-0109"
maker = "Sample Machines"
model = "VM 10"
serial = "S-0109"
control = "siemens-840d"
control_version = "4.95"

[axes.X]
number = 1                     # n of AXn
name = "X1"
reference_mm = 0.0
travel = [0.0, 1000.0]
largest_um = 100.0             # of the maker: what a table may add
slope_um_per_m = 500.0
"""}

SITE = """# What holds for all sample campaigns. The laboratory is invented.
[laboratory]
name = "Sample Calibration Laboratory"
address = "Via dell'Esempio 1, 10100 Torino"
country = "IT"
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", default=here, metavar="FOLDER")
    folder = parser.parse_args().folder
    write(os.path.join(folder, "site", "site.toml"), SITE)
    for name, text in RECORDS.items():
        write(os.path.join(folder, "site", "machines", name + ".toml"), text)
    for name, story in STORIES.items():
        for file, text in story().items():
            write(os.path.join(folder, "site", name, file), text)
    for file, text in for_customers.FILES.items():
        write(os.path.join(folder, "certificates", file), text)
    for file in for_customers.EXECUTABLE:
        os.chmod(os.path.join(folder, "certificates", file), 0o755)


if __name__ == "__main__":
    main()
