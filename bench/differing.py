# SPDX-License-Identifier: Apache-2.0
"""differing.py NONIO [--count N] [--seed SEED] [--least PERCENT]

Two measurements of one axis, of two states of the machine or two sides of a gantry, that differ in one effect: how often
`explain` calls the model complete although they differ, how often it names the effect with its two values, and how often
it finds a difference between two measurements that have none. The physics is written here, apart from the effects of the
program: each measurement warms up, wears and jumps by its own formula in um, mm and s.

Wilson's 95 % intervals. Status 1 where a differing campaign is called complete, or fewer are named than --least."""
import argparse
import collections
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

NOISE = 0.5  # um

# Shapes over the position x (0..1), direction d, time t (0..1), RMS about 1, and the effects that name them.
SHAPES = {
    "backlash": (lambda x, d, t, c: d, {"backlash"}),
    "scale": (lambda x, d, t, c: 3.46 * (x - 0.5), {"scale"}),
    "growth": (lambda x, d, t, c: 6.0 * (x - 0.5) * t, {"growth-drift"}),
    "warm-up": (lambda x, d, t, c: 4.6 * (x - 0.5) * (1 - math.exp(-4.0 * t)), {"warm-up", "growth-drift"}),
    "drift": (lambda x, d, t, c: 3.46 * (t - 0.5), {"zero-drift"}),
    "widening": (lambda x, d, t, c: 3.46 * (x - 0.5) * d, {"backlash-slope"}),
    "curve": (lambda x, d, t, c: 1.41 * math.sin(c["turns"] * math.pi * x + c["phase"]), {"pitch-curve"}),
}
SECOND = (-1.0, -0.8, -0.5, -0.3, 0.0, 0.3, 0.6)  # the amplitude in the second measurement, of that in the first
BY = ("adjustment", "state", "side", "measurement")


def campaign(rng, shape, size, second, by, folder):
    """Writes the two measurements; returns the parameters of the effect in both, where they are plain numbers."""
    targets = sorted(rng.uniform(0.02, 0.98) for _ in range(rng.randint(9, 14)))
    targets = [0.0, *targets, 1.0]
    length, runs = rng.choice((400.0, 1000.0, 2500.0)), rng.randint(3, 5)
    common = {"scale": rng.gauss(0, 3), "backlash": rng.gauss(0, 2)}
    curve = {"turns": rng.choice((2, 3)), "phase": rng.uniform(0, 6.28)}
    readings = 2 * runs * len(targets)
    for m, amplitude in enumerate((size, size * second)):
        zero, rows, k = rng.gauss(0, 20), [], 0
        for run in range(1, runs + 1):
            for d in (1, -1):
                for x in targets if d > 0 else reversed(targets):
                    y = zero + common["scale"] * x + common["backlash"] * d / 2 + rng.gauss(0, NOISE)
                    y += amplitude * SHAPES[shape][0](x, d, k / (readings - 1), curve)
                    rows.append(f"{run},{'+' if d > 0 else '-'},{length * x:.3f},{y:.4f},{8 * k}")
                    k += 1
        (folder / f"m{m}.csv").write_text("run,direction,target_mm,deviation_um,time_s\n" + "\n".join(rows) + "\n")
    key = {"adjustment": ('adjustment = "before"', 'adjustment = "after"'), "state": ('state = "found"', 'state = "left"'),
           "side": ('at = { Y = 200 }', 'at = { Y = 2200 }'), "measurement": ("", "")}[by]
    (folder / "campaign.toml").write_text(
        f'format = 1\n[campaign]\nid = "c"\n[machine]\nmodel = "m"\n[machine.axes.X]\nkind = "linear"\n'
        f'travel = [-1.0, {length + 1}]\n[machine.axes.Y]\nkind = "linear"\ntravel = [0, 2500]\n'
        + "".join(f'[[measurement]]\nid = "{i}"\nkind = "axis"\naxis = "X"\nfile = "m{m}.csv"\n{key[m]}\n'
                  for m, i in enumerate(("P", "Q")))
        + '[model]\neffects = ["scale:X", "backlash:X"]\n')
    if shape == "backlash":  # um
        return {"effect": "backlash:X", "values": [common["backlash"] + 2 * a for a in (size, size * second)]}
    if shape == "scale":  # um/m
        return {"effect": "scale:X",
                "values": [(common["scale"] + 3.46 * a) / (length * 1e-3) for a in (size, size * second)]}
    return None


def share(yes, of):
    if of == 0:
        return "-"
    z2, p = 1.959964 ** 2, yes / of
    middle, half = p + z2 / (2 * of), math.sqrt(z2 * (p * (1 - p) + z2 / (4 * of)) / of)
    low, high = (middle - half) / (1 + z2 / of), (middle + half) / (1 + z2 / of)
    return f"{yes} of {of}, {100 * p:.1f} % ({100 * max(0, low):.1f} .. {100 * min(1, high):.1f})"


def run(nonio, *args):
    done = subprocess.run([nonio, *args, "--json", "--quiet"], capture_output=True, text=True)
    if not done.stdout:
        sys.exit(f"{args}: {done.stderr}")
    return json.loads(done.stdout)


def within(parameters, truth):
    """Of the parameters of the differing effect, each with its true value, how many are within U."""
    of = [p for p in parameters if p.get("group") and p["effect"].startswith(truth["effect"] + "@")]
    return sum(abs(p["value"] - t) <= 2 * p["u"] for p, t in zip(of, truth["values"])), len(truth["values"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--count", type=int, default=360)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--least", type=float, default=0.0)
    parser.add_argument("--verbose", action="store_true")
    args = parser.parse_args()
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(1 << 31)
    print(f"seed {seed}, {args.count} campaigns")
    tally, complete, named, ended, alarms, alike, held = collections.defaultdict(list), 0, 0, 0, 0, 0, []
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for k in range(args.count):
            rng = random.Random(seed + k)
            shape, second, by = rng.choice(sorted(SHAPES)), rng.choice(SECOND), rng.choice(BY)
            size = NOISE * rng.uniform(2.0, 4.0)
            truth = campaign(rng, shape, size, second, by, folder)
            said = run(args.nonio, "explain", scratch, "--auto")
            names = [s["effect"] for s in said.get("steps", [])]
            for s in [said["verdict"].get("effect"), *said.get("certain", [])]:
                names += [s] if s else []
            right = any(n.split("@")[0].split(":")[0] in SHAPES[shape][1] and "@" in n for n in names)
            done = said["verdict"]["kind"] == "nothing"
            complete += done and not right
            ended += done and right
            named += right
            tally[shape].append(right), tally["by " + by].append(right), tally[f"second {second}"].append(right)
            if args.verbose and not right:
                print(f"  {seed + k}: {shape} x {second}, {size / NOISE:.1f} noise, by {by}: {said['verdict']['kind']}, {names}")
            if right and truth:
                held.append(within(said["model"]["parameters"], truth))
            campaign(rng, shape, size, 1.0, by, folder)
            said = run(args.nonio, "explain", scratch, "--auto")
            names = [s["effect"] for s in said.get("steps", [])] + said.get("certain", [])
            alarm = any("@" in n for n in names)
            alike += 1
            alarms += alarm
            if args.verbose and alarm:
                print(f"  {seed + k}: alike, {shape}, named {names}")
    print(f"differing, called complete without the difference: {share(complete, args.count)}")
    print(f"differing effect named with its values:            {share(named, args.count)}")
    print(f"  values of backlash and scale within U:           {share(sum(h[0] for h in held), sum(h[1] for h in held))}")
    print(f"  and then complete:                               {share(ended, args.count)}")
    print(f"alike, a difference named:                         {share(alarms, alike)}")
    for key, all_of in sorted(tally.items()):
        print(f"  {key:20} {share(sum(all_of), len(all_of))}")
    return 0 if complete == 0 and named >= args.least / 100 * args.count else 1


if __name__ == "__main__":
    sys.exit(main())
