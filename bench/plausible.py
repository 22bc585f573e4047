#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""plausible.py NONIO N [--seed S] [--folder F] [--batch B]: how often readings of an ordinary or of a bad machine are
called implausible. Makes N campaigns from a seed, as instruments leave them (units, digits, orders of the rows, one or
both directions, with and without times and temperatures, linear and rotary, straightness), of machines from very
good to worn out, runs the program over them, and prints the rate and every finding plausibility.* with its campaign. 0
is wanted; status 1 if there is one."""
import argparse
import collections
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile


def machine(rng, rotary, travel):
    """Deviation of a target (0 to 1 of the travel) from a direction in a run, and its size; um or arcsec."""
    quality = rng.choice(["fine", "good", "ordinary", "ordinary", "worn", "bad"])
    size = {"fine": 0.5, "good": 2.0, "ordinary": 8.0, "worn": 40.0, "bad": 120.0}[quality] * rng.uniform(0.6, 1.6)
    if not rotary:
        size *= math.sqrt(travel / 1000)
    noise = size * rng.choice([0.02, 0.05, 0.1, 0.3])
    lost = -size * rng.choice([0.0, 0.1, 0.5, 1.0, 2.0]) * rng.random() * rng.choice([1, 1, 1, -1])
    slope = size * rng.gauss(0, 1.0)
    waves = [(size * rng.gauss(0, 0.3), rng.uniform(0.5, 12), rng.uniform(0, 6.3)) for _ in range(3)]
    drift = size * rng.choice([0, 0, 0.05, 0.1]) * rng.gauss(0, 1)
    wedge = size * rng.choice([0, 0, 0.2]) * rng.gauss(0, 1)
    tilt = rng.choice([0, 0, 0.5]) * lost

    def deviation(x, direction, run):
        value = slope * x + drift * run + wedge * run * x + rng.gauss(0, noise)
        value += sum(a * math.sin(6.2832 * f * x + p) for a, f, p in waves)
        if direction == "-":
            value += lost + tilt * (x - 0.5)
        if rng.random() < 0.0005:  # a misreading now and then
            value += size * rng.choice([-8, 8])
        return value
    return deviation, size


def campaign(folder, index, seed):
    rng = random.Random(f"{seed}-{index}")
    rotary = rng.random() < 0.15
    kind = "straightness" if not rotary and rng.random() < 0.1 else "axis"
    unit, reading = ("deg", "arcsec") if rotary else ("mm", "um")
    travel = 360.0 if rotary else rng.choice([100, 250, 400, 600, 1000, 1600, 3000, 8000, 14500])
    count = rng.choice([5, 6, 7, 11, 11, 21, 41])
    runs = rng.choice([1, 2, 3, 5, 5, 5, 6, 10])
    margin = travel * rng.uniform(0, 0.15)
    step = (travel - 2 * margin) / (count - 1)
    offset = rng.choice([0.0, 0.0, 0.3])
    targets = [round(margin + i * step + rng.uniform(-offset, offset) * step, 3) for i in range(count)]
    targets = [min(max(t, 0.0), travel) for t in targets]
    deviation, size = machine(rng, rotary, travel)
    more = random.Random(f"{seed}-{index}-more")
    settle = size * more.choice([0, 0, 0.1, 0.3]) * more.gauss(0, 1)  # a curve of its own that dies away from run to run
    runs_to_settle, worn = more.uniform(0.5, 4), more.choice([0, 0, 0, 0.5]) * size * more.gauss(0, 1)
    worn_at, worn_width = more.random(), more.uniform(0.05, 0.3)  # lost motion that is larger at one place
    comment = more.choice(["", "", "# deviations in um, targets in mm\n", "# Achse: X; Einheit: mm\n", "# unit: um\n"])
    if rotary:
        comment = comment and "# Abweichung [arcsec], target [deg]\n"
    # An instrument that cannot resolve the machine shows zeros, and that is worth a finding.
    digits = rng.choice([0, 1, 1, 2, 3, 4, 6]) if size > 5 else rng.choice([1, 1, 2, 3, 4, 6]) if size > 0.5 else 3
    both = rng.choice(["both", "both", "both", "both", "+", "-"])
    layout = rng.choice(["bidirectional", "bidirectional", "sorted", "by-direction", "pendulum"])
    as_position = kind == "axis" and rng.random() < 0.3
    rows = []
    tilt = rng.gauss(0, 0.5) * travel if kind == "straightness" else 0.0  # a straightedge that is not aligned
    for run in range(1, runs + 1):
        strokes = [d for d in "+-" if both in ("both", d)]
        if layout == "pendulum":
            order = range(count) if run % 2 else reversed(range(count))
            rows += [(run, d, i) for i in order for d in strokes]
            continue
        for d in strokes:
            order = range(count)[::-1] if d == "-" and layout == "bidirectional" else range(count)
            rows += [(run, d, i) for i in order]
    if layout == "sorted":
        rows.sort(key=lambda r: (r[2], r[1], r[0]))
    if layout == "by-direction":
        rows.sort(key=lambda r: (r[1], r[0], r[2]))
    with_time = rng.random() < 0.3 and layout == "bidirectional"
    with_material = rng.random() < 0.3
    separator = rng.choice([",", ",", ";", "\t"])
    if as_position and "unit: um" in comment:  # would be wrong
        comment = ""
    head = ["run", "direction", f"target_{unit}", f"position_{unit}" if as_position else f"deviation_{reading}"]
    head += ["time_s"] * with_time + ["material_c"] * with_material
    lines = [separator.join(head)]
    warm = rng.uniform(16, 30)
    for n, (run, d, i) in enumerate(rows):
        value = deviation(targets[i] / travel, d, run) + tilt * targets[i] / travel
        x = targets[i] / travel
        value += settle * math.exp(-run / runs_to_settle) * math.sin(4 * x)
        value += worn * math.exp(-((x - worn_at) / worn_width) ** 2) * (d == "-")
        if as_position:
            text = f"{targets[i] + value / (3600 if rotary else 1000):.{rng.choice([6]) if digits > 2 else 4}f}"
        else:
            text = f"{value:.{digits}f}"
        fields = [str(run), d, f"{targets[i]:g}", text]
        fields += [f"{n * 8.5:.1f}"] * with_time + [f"{warm + 0.002 * n:.2f}"] * with_material
        lines.append(separator.join(fields))
    folder.mkdir(parents=True)
    (folder / "x.csv").write_text(comment + "\n".join(lines) + ("\n" if rng.random() < 0.9 else ""))
    axis = "C" if rotary else "X"
    extra = ""
    if rng.random() < 0.7:
        extra += f"travel = [0.0, {travel}]\n"
    if not rotary and rng.random() < 0.5:
        extra += f"screw_pitch_mm = {rng.choice([0.02, 5.0, 10.0, 20.0])}\nexpansion_um_per_m_K = 11.5\n"
    instrument = ""
    if rng.random() < 0.7:
        instrument = ("[instrument]\ncalibrated = 2026-01-12\n" +
                      ("U_arcsec = 0.2\n" if rotary else "U_fixed_um = 0.1\nU_per_m_um = 0.4\n"))
    lateral = 'lateral = "Y"\n' if kind == "straightness" else ""
    (folder / "campaign.toml").write_text(
        f'format = 1\n[campaign]\nid = "p-{index:06}"\ndate = 2026-03-02\n[machine]\nmodel = "M"\n'
        f'[machine.axes.{axis}]\nkind = "{"rotary" if rotary else "linear"}"\n{extra}{instrument}'
        f'[run]\nanalyses = []\noutputs = []\n'
        f'[[measurement]]\nid = "{axis}"\nkind = "{kind}"\naxis = "{axis}"\nfile = "x.csv"\n{lateral}')


def findings(out):
    for results in sorted(out.glob("*/results.json")):
        content = json.loads(results.read_text())
        for error in content.get("errors", []):
            yield results.parent.name, "error", error
        for analysis in content.get("analyses", []):
            for f in analysis.get("findings", []):
                if f["id"].startswith("plausibility."):
                    yield results.parent.name, f["id"], f.get("evidence")


def main():
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("nonio")
    ask.add_argument("count", type=int)
    ask.add_argument("--seed", type=int, default=1)
    ask.add_argument("--batch", type=int, default=2500)
    ask.add_argument("--folder", type=pathlib.Path, help="keeps the campaigns there")
    wish = ask.parse_args()
    root = wish.folder or pathlib.Path(tempfile.mkdtemp(prefix="nonio-plausible-"))
    alarms, kinds = set(), collections.Counter()
    for first in range(0, wish.count, wish.batch):
        site, out = root / f"site-{first}", root / f"out-{first}"
        for i in range(first, min(first + wish.batch, wish.count)):
            campaign(site / f"{i:06}", i, wish.seed)
        done = subprocess.run([wish.nonio, "run", str(site), "--out", str(out), "--quiet"], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        if done.returncode not in (0, 1):
            sys.exit(done.stdout)
        for name, kind, evidence in findings(out):
            alarms.add(name)
            kinds[kind] += 1
            print(f"{name}: {kind} {evidence}")
        if not wish.folder:
            shutil.rmtree(site), shutil.rmtree(out)
    print(f"{len(alarms)} of {wish.count} campaigns called implausible, rate {len(alarms) / wish.count:.5f} "
          f"(seed {wish.seed})", dict(kinds) or "")
    if not wish.folder:
        shutil.rmtree(root)
    sys.exit(1 if alarms else 0)


if __name__ == "__main__":
    main()
