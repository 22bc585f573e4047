# SPDX-License-Identifier: Apache-2.0
"""volumes.py NONIO [--hidden 1,2,4,8,21] [--campaigns N] [--seed SEED] [--least PERCENT] [--verbose]

Campaigns of a whole volume (axes on several lines, straightness on two heights, four body diagonals; 1,500 to 2,000
readings) with so many errors hidden at once, each seen in the readings with 3 to 8 times their noise. The model is empty;
`model explain --auto` runs to its end. For each number of errors: campaigns in which all were found, in which a name was
added that was not hidden, that ended `nothing`, and the CPU time. With --least it fails if fewer than PERCENT of the campaigns
of 4 errors find all of them, or if one adds another name.

Chain bed - X - Y - Z - tool, first order, tool without offset (docs/conventions.md)."""
import argparse
import json
import math
import pathlib
import random
import resource
import subprocess
import sys
import tempfile

POOL = ["backlash:X", "scale:X", "scale:Y", "scale:Z", "pitch-curve:X", "pitch-curve:Y", "pitch-curve:Z", "straightness:EYX", "straightness:EZX",
        "straightness:EXY", "straightness:EZY", "straightness:EXZ", "straightness:EYZ", "squareness:XY", "squareness:XZ", "squareness:YZ",
        "yaw:X", "pitch:X", "roll:X", "pitch:Y", "roll:Y"]
NOISE = 0.5  # um


def curve(rng, length, targets):
    """A smooth curve over 0 .. length without mean and slope over the targets: by definition no zero, scale or squareness."""
    a, b = rng.gauss(0, 1), rng.gauss(0, 0.7)

    def bow(u):
        return a * (1.5 * u * u - 0.5) + b * (4.375 * u**4 - 3.75 * u * u + 0.375)

    mean = sum(bow(2 * k / (targets - 1) - 1) for k in range(targets)) / targets
    return lambda x: bow(2 * x / length - 1) - mean


def errors(name, rng, size, targets):
    """(x, y, z, sides) -> error of the tool point, each in um for a unit of the amplitude; lengths in m."""
    kind, of = name.split(":")
    if kind == "backlash":
        return lambda p, side: [side[0] / 2, 0, 0]
    axis = "XYZ".index(of[-1]) if kind != "squareness" else None
    if kind == "scale":
        return lambda p, side: [p[k] if k == axis else 0 for k in range(3)]
    if kind == "squareness":
        k, lever, sign = {"XY": (0, 1, -1), "XZ": (0, 2, 1), "YZ": (1, 2, -1)}[of]
        return lambda p, side: [sign * p[lever] if j == k else 0 for j in range(3)]
    f = curve(rng, size[axis], targets)
    if kind == "pitch-curve":
        return lambda p, side: [f(p[k]) if k == axis else 0 for k in range(3)]
    if kind == "straightness":
        k = "XYZ".index(of[1])
        return lambda p, side: [f(p[axis]) if j == k else 0 for j in range(3)]
    return {"yaw:X": lambda p, side: [-p[1] * f(p[0]), 0, 0], "pitch:X": lambda p, side: [p[2] * f(p[0]), 0, 0],
            "roll:X": lambda p, side: [0, -p[2] * f(p[0]), p[1] * f(p[0])], "pitch:Y": lambda p, side: [0, -p[2] * f(p[1]), 0],
            "roll:Y": lambda p, side: [p[2] * f(p[1]), 0, 0]}[name]


def lines_of(size):
    """(id, keys, from, to, sensed direction)"""
    x, y, z = size
    axis = lambda k, a, b: (f'kind = "axis"\naxis = "{"XYZ"[k]}"\nat = {at(k, a)}', a, b, [1.0 if j == k else 0.0 for j in range(3)])
    at = lambda k, a: "{ " + ", ".join(f"{'XYZ'[j]} = {1000 * a[j]:.4f}" for j in range(3) if j != k) + " }"
    across = lambda k, e, a, b: (f'kind = "straightness"\naxis = "{"XYZ"[k]}"\nlateral = "{"XYZ"[e]}"\nat = {at(k, a)}', a, b, [1.0 if j == e else 0.0 for j in range(3)])
    out = [axis(0, (0, v, w), (x, v, w)) for v in (0, y) for w in (0, z)]
    out += [axis(1, (u, 0, w), (u, y, w)) for u, w in ((0, 0), (0, z), (x, 0))] + [axis(2, (0, 0, 0), (0, 0, z)), axis(2, (x, y, 0), (x, y, z))]
    out += [across(0, e, (0, v, w), (x, v, w)) for e in (1, 2) for v, w in ((0, 0), (y, z))]
    out += [across(1, e, (0, 0, w), (0, y, w)) for e in (0, 2) for w in (0, z)]
    out += [across(2, e, (0, 0, 0), (0, 0, z)) for e in (0, 1)]
    for sx, sy, sz in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)):
        a, b = (sx * x, sy * y, sz * z), ((1 - sx) * x, (1 - sy) * y, (1 - sz) * z)
        length = math.dist(a, b)
        keys = "".join(f"{word} = {{ X = {1000 * p[0]:.4f}, Y = {1000 * p[1]:.4f}, Z = {1000 * p[2]:.4f} }}\n" for word, p in (("from", a), ("to", b)))
        out.append(('kind = "diagonal"\n' + keys, a, b, [(b[k] - a[k]) / length for k in range(3)]))
    return out


def readings_of(line, error, targets, runs):
    """Rows (run, way, place in m, deviation)."""
    _, a, b, sense = line
    length = math.dist(a, b)
    way = [(b[k] - a[k]) / length for k in range(3)]
    said = lambda p, side: sum(n * e for n, e in zip(sense, error(p, side)))
    straight = abs(sum(n * w for n, w in zip(sense, way))) < 0.5
    ends = [said(a, way), said(b, way)]
    rows = []
    for run in range(1, runs + 1):
        for direction in (1, -1):
            stops = range(targets) if direction > 0 else range(targets - 1, -1, -1)
            for i in stops:
                share = i / (targets - 1)
                p = [a[k] + share * (b[k] - a[k]) for k in range(3)]
                v = said(p, [direction * (w > 1e-9) - direction * (w < -1e-9) for w in way]) - ends[0]
                rows.append((run, direction, share * length, v - (share * (ends[1] - ends[0]) if straight else 0)))
    return rows


def visible(rows_of_lines):
    squares = n = 0
    for rows in rows_of_lines:
        mean = sum(r[3] for r in rows) / len(rows)
        here = sum((r[3] - mean) ** 2 for r in rows)
        if here > 1e-12:
            squares, n = squares + here, n + len(rows)
    return math.sqrt(squares / n)


def write(rng, folder, hidden):
    size = (rng.uniform(0.8, 1.6), rng.uniform(0.6, 1.0), rng.uniform(0.5, 0.8))
    targets, runs = rng.randint(11, 15), 3
    lines = lines_of(size)
    total = None
    for name in hidden:
        error = errors(name, rng, size, targets)
        one = [readings_of(line, error, targets, runs) for line in lines]
        factor = rng.choice((-1, 1)) * rng.uniform(3, 8) * NOISE / visible(one)
        if total is None:
            total = [[[*r[:3], factor * r[3]] for r in rows] for rows in one]
        else:
            for rows, more in zip(total, one):
                for r, m in zip(rows, more):
                    r[3] += factor * m[3]
    text = 'format = 1\n[campaign]\nid = "v"\n[machine]\nmodel = "m"\nstructure = "bridge"\n'
    for k, axis in enumerate("XYZ"):
        text += f'[machine.axes.{axis}]\nkind = "linear"\ntravel = [0, {1000 * size[k]:.4f}]\n'
    for k, (line, rows) in enumerate(zip(lines, total)):
        slope = rng.gauss(0, 3) if "straightness" in line[0] else 0.0  # of the straightedge
        table = ["run,direction,target_mm,deviation_um"]
        table += [f"{r[0]},{'+' if r[1] > 0 else '-'},{1000 * r[2]:.4f},{r[3] + slope * r[2] + rng.gauss(0, NOISE):.3f}" for r in rows]
        (folder / f"{k}.csv").write_text("\n".join(table) + "\n")
        text += f'[[measurement]]\nid = "L{k}"\nfile = "{k}.csv"\n{line[0]}\n'
    (folder / "campaign.toml").write_text(text + "[model]\neffects = []\n")
    return sum(len(rows) for rows in total)


def processor_time():
    """Seconds that programs took which have ended: as on a machine that does nothing else."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--hidden", default="1,2,4,8,21")
    parser.add_argument("--campaigns", type=int, default=10)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--least", type=float, default=None)
    parser.add_argument("--verbose", action="store_true")
    args = parser.parse_args()
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(1 << 31)
    print(f"seed {seed}, {args.campaigns} campaigns each")
    print("| hidden | all found | a wrong name | ends nothing | RMS / floor, mean | CPU, mean s | most s | readings |\n|---|---|---|---|---|---|---|---|")
    well = True
    for count in map(int, args.hidden.split(",")):
        found = wrong = ended = 0
        seconds, ratios, size = [], [], 0
        for k in range(args.campaigns):
            rng = random.Random(f"{seed} {count} {k}")
            hidden = sorted(rng.sample(POOL, count))
            with tempfile.TemporaryDirectory() as scratch:
                size = write(rng, pathlib.Path(scratch), hidden)
                began = processor_time()
                done = subprocess.run([args.nonio, "model", "explain", scratch, "--auto", "--json", "--quiet"], capture_output=True, text=True)
                seconds.append(processor_time() - began)
                said = json.loads(done.stdout)
            part = said["parts"][0] if "parts" in said else said
            named = part["model"]["effects"]
            missing, more = sorted(set(hidden) - set(named)), sorted(set(named) - set(hidden))
            kind = part["verdict"]["kind"]
            found, wrong, ended = found + (not missing), wrong + bool(more), ended + (kind == "nothing")
            ratios.append(part["model"]["rms_um"] / part["noise_floor_um"])
            if args.verbose and (missing or more or kind != "nothing"):
                print(f"  {count} hidden, campaign {k}: {kind}, missing {missing}, wrong {more}")
        print(f"| {count} | {found}/{args.campaigns} | {wrong}/{args.campaigns} | {ended}/{args.campaigns} | {sum(ratios) / len(ratios):.2f} "
              f"| {sum(seconds) / len(seconds):.1f} | {max(seconds):.1f} | {size} |", flush=True)
        if count == 4 and args.least is not None:
            well = well and wrong == 0 and 100 * found >= args.least * args.campaigns
    return 0 if well else 1


if __name__ == "__main__":
    sys.exit(main())
