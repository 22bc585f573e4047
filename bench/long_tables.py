# SPDX-License-Identifier: Apache-2.0
"""long_tables.py NONIO PICTURE.svg [MOST]: `nonio model explain` on tables of 1,000 to MOST (default 1,000,000) readings.

CPU time of the whole program, reading the file included, of two kinds of table: few runs at many targets, many runs at
few. In the same run NumPy reads the same file (loadtxt) and solves one least-squares problem of the same size with the
columns of the model and of the effect that is hidden (lstsq): no search, no tests, no repeats.
"""
import math
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy

SPEC = '''format = 1
[campaign]
id = "long"
customer = "Bench"
date = 2026-11-03
[machine]
maker = "Maker"
model = "M"
serial = "1"
[machine.axes.X]
kind = "linear"
travel = [0.0, 1200.0]
expansion_um_per_m_K = 11.5
screw_pitch_mm = 10.0
[instrument]
maker = "Maker"
model = "Laser"
serial = "1"
U_fixed_um = 0.2
[model]
effects = ["backlash:X", "scale:X"]
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
[simulation]
seed = 7
[[cycle]]
measurement = "X"
from_mm = 20.0
to_mm = 1180.0
step_mm = {step!r}
runs = {runs}
noise_um = 0.6
dwell_s = 0.1
pause_s = 1.0
feed_mm_per_min = 60000.0
[[effect]]
name = "backlash:X"
b_um = -6.0
[[effect]]
name = "scale:X"
a_um_per_m = 8.0
[[effect]]
name = "warm-up:X"
w_um_per_m = 6.0
tau_s = {tau!r}
'''


def cpu_of_children(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def campaign(nonio, folder, readings, few_runs):
    runs = 5 if few_runs else readings // 50
    targets = readings // (2 * runs)
    way = 2 * runs * (1.16 + targets * 0.1)
    spec = folder / "spec.toml"
    spec.write_text(SPEC.format(step=1160.0 / (targets - 1), runs=runs, tau=way / 8.0))
    out = folder / "campaign"
    cpu_of_children([nonio, "model", "simulate", spec, "--out", out])
    return out


def numpy_seconds(file, tau):
    start = time.process_time()
    with open(file) as lines:
        rows = [line.replace("+", "1").replace("-,", "-1,", 1) for line in lines if line[0].isdigit()]
    run, d, x, y, t = numpy.loadtxt(rows, delimiter=",", unpack=True)
    p = (x - x.mean()) / 1e3
    a = numpy.column_stack([numpy.ones_like(p), d / 2, p, p * (1 - numpy.exp(-t / tau))])
    numpy.linalg.lstsq(a, y, rcond=None)
    return time.process_time() - start


def plot(path, rows):
    """Log-log, a decade 130 wide and 80 high; the dashed line has slope 1."""
    low, high = min(n for n, *_ in rows), max(n for n, *_ in rows)
    seconds = [s for _, *times in rows for s in times]
    floor, top = math.floor(math.log10(min(seconds))), math.ceil(math.log10(max(seconds)))

    def at(n, s):
        return 70 + 130 * (math.log10(n / low)), 20 + 80 * (top - math.log10(s))

    width, height = at(high, 1)[0] + 190, at(1, 10.0 ** floor)[1]
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height + 50:.0f}" '
           'font-family="sans-serif" font-size="12">',
           f'<rect width="{width:.0f}" height="{height + 50:.0f}" fill="white"/>']
    for k in range(floor, top + 1):
        x, y = at(high, 10.0 ** k)
        svg.append(f'<path d="M70 {y:.1f}H{x:.1f}" stroke="#ddd"/>')
        svg.append(f'<text x="62" y="{y + 4:.1f}" text-anchor="end">{10.0 ** k:g} s</text>')
    for n, *_ in rows:
        x, _ = at(n, 1)
        svg.append(f'<path d="M{x:.1f} 20V{height:.1f}" stroke="#ddd"/>')
        svg.append(f'<text x="{x:.1f}" y="{height + 18:.1f}" text-anchor="middle">{n:,}</text>')
    svg.append(f'<text x="{at(high, 1)[0] / 2 + 35:.1f}" y="{height + 38:.1f}" text-anchor="middle">readings</text>')
    last = max(rows[-1][1:3])
    start = max(low, high * 10.0 ** floor / last)
    (x1, y1), (x2, y2) = at(start, last * start / high), at(high, last)
    svg.append(f'<path d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" stroke="#888" stroke-dasharray="5 4"/>')
    mid = at(math.sqrt(start * high), last * math.sqrt(start / high))
    svg.append(f'<text x="{mid[0] + 8:.1f}" y="{mid[1] + 14:.1f}" fill="#666">slope 1</text>')
    names = ("explain, 5 runs", "explain, 25 targets", "NumPy: read, one lstsq")
    ends = sorted((at(high, rows[-1][k + 1])[1], k) for k in range(3))
    label = -100.0
    for y, k in ends:
        colour = ("#0b5fa5", "#c4501b", "#3b7d3b")[k]
        points = [at(n, times[k]) for n, *times in rows]
        svg.append(f'<polyline points="{" ".join(f"{x:.1f},{v:.1f}" for x, v in points)}" fill="none" '
                   f'stroke="{colour}" stroke-width="1.8"/>')
        svg += [f'<circle cx="{x:.1f}" cy="{v:.1f}" r="3" fill="{colour}"/>' for x, v in points]
        label = max(y, label + 15)
        svg.append(f'<text x="{at(high, 1)[0] + 10:.1f}" y="{label + 4:.1f}" fill="{colour}">{names[k]}</text>')
    svg.append("</svg>")
    pathlib.Path(path).write_text("\n".join(svg) + "\n")


def main():
    nonio, picture = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    most = int(sys.argv[3]) if len(sys.argv) > 3 else 1_000_000
    rows, readings = [], 1000
    print(f"{'readings':>9} {'5 runs':>9} {'25 targets':>11} {'NumPy':>9}  ratio to NumPy   (CPU, s)")
    while readings <= most:
        with tempfile.TemporaryDirectory() as scratch:
            times = []
            for few_runs in (True, False):
                folder = pathlib.Path(scratch) / str(few_runs)
                folder.mkdir()
                made = campaign(nonio, folder, readings, few_runs)
                times.append(min(cpu_of_children([nonio, "model", "explain", made])[0] for _ in range(3)))
                if few_runs:
                    peer = min(numpy_seconds(made / "x.csv", readings / 80.0) for _ in range(3))
        rows.append((readings, *times, peer))
        print(f"{readings:9,} {times[0]:9.3f} {times[1]:11.3f} {peer:9.3f}  {times[0] / peer:.2f}, {times[1] / peer:.2f}",
              flush=True)
        readings *= 10
    plot(picture, rows)


if __name__ == "__main__":
    main()
