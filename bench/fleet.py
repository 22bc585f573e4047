# SPDX-License-Identifier: Apache-2.0
"""Many campaigns of one axis, each with one hidden effect of 0.3 to 1 times the noise: what `model explain` finds in all of
them together. The readings are made here, not by the program.

    python3 bench/fleet.py NONIO [--fleets 20] [--campaigns 20] [--seed 1] [--size 0.5] [--passes 0.0] [--travels]

--travels: each campaign measures another part of the travel. --passes: standard deviation of an offset that each pass has, over that of a reading.
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import tempfile

PITCH, LENGTH, TARGETS, RUNS = 20.0, 800.0, 21, 5


def shapes():
    """Effect -> its deviation at (position, direction, time 0..1), of RMS about 1."""
    mid = LENGTH / 2
    return {
        "backlash:X": lambda x, d, t: -d,
        "scale:X": lambda x, d, t: (x - mid) / (LENGTH / math.sqrt(12)),
        "periodic:X": lambda x, d, t: math.sqrt(2) * math.sin(2 * math.pi * x / PITCH + 0.7),
        "pitch-curve:X": lambda x, d, t: math.sqrt(2) * math.cos(2 * math.pi * x / LENGTH),
        "zero-drift:X": lambda x, d, t: math.sqrt(12) * (t - 0.5),
        "growth-drift:X": lambda x, d, t: (x - mid) / (LENGTH / math.sqrt(12)) * math.sqrt(3) * t,
        "backlash-slope:X": lambda x, d, t: -d * (x - mid) / (LENGTH / math.sqrt(12)),
    }


TRAVELS = ((0.0, 800.0), (0.0, 500.0), (300.0, 800.0), (150.0, 650.0))


def write(folder, number, parts, noise, passes, rng, travel=TRAVELS[0]):
    folder.mkdir(parents=True)
    step = (travel[1] - travel[0]) / (TARGETS - 1)
    targets = [round(travel[0] + i * step + (rng.random() - 0.5) * 0.8 * PITCH, 3) for i in range(TARGETS)]
    rows, k, all_readings = ["run,direction,target_mm,deviation_um,time_s"], 0, TARGETS * RUNS * 2
    for run in range(1, RUNS + 1):
        for direction in (1, -1):
            offset = rng.gauss(0, passes * noise)
            for x in targets if direction > 0 else reversed(targets):
                e = sum(f(x, direction, k / all_readings) for f in parts) + rng.gauss(0, noise) + offset
                rows.append(f"{run},{'+' if direction > 0 else '-'},{x},{e:.3f},{10 * k}")
                k += 1
    (folder / "x.csv").write_text("\n".join(rows) + "\n")
    date = f"{2020 + number // 12}-{number % 12 + 1:02d}-05"
    (folder / "campaign.toml").write_text(f'''format = 1
[campaign]
id = "c{number:04d}"
date = {date}
[machine]
asset = "M-1"
[machine.axes.X]
kind = "linear"
travel = [0.0, {LENGTH}]
screw_pitch_mm = {PITCH}
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
''')
    return date


def fleet(root, story, effect, size, campaigns, passes, rng, travels=TRAVELS[:1]):
    """Campaigns with one effect: in all the same ("shared"), from one of them on ("appears"), in one half of them
    ("differs"), or in none ("none"). Returns the first campaign that has it, of "appears"."""
    noise = 10 ** rng.uniform(-0.5, 0.5)
    shape = shapes().get(effect)
    first = rng.randint(campaigns // 4, 3 * campaigns // 4)
    having = set(rng.sample(range(campaigns), campaigns // 2))
    for n in range(campaigns):
        gain = size * noise
        if story == "appears" and n < first or story == "differs" and n not in having:
            gain = 0.0
        parts = [lambda x, d, t, g=gain: g * shape(x, d, t)] if story != "none" else []
        write(root / f"c{n:04d}", n, parts, noise, passes, rng, rng.choice(travels) if len(travels) > 1 else travels[0])
    return first


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--fleets", type=int, default=20, help="of each story")
    parser.add_argument("--campaigns", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--size", type=float, help="RMS of the effect over the noise; else 0.3 to 1")
    parser.add_argument("--passes", type=float, default=0.0)
    parser.add_argument("--travels", action="store_true")
    parser.add_argument("--stories", nargs="+", default=["shared", "appears", "differs", "none"])
    parser.add_argument("--effects", nargs="+", default=sorted(shapes()))
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    print(f"seed {arguments.seed}, {arguments.campaigns} campaigns of {TARGETS * RUNS * 2} readings")
    for story in arguments.stories:
        named = holds = wrong = 0
        for _ in range(arguments.fleets):
            effect = rng.choice(arguments.effects)
            size = arguments.size or rng.uniform(0.3, 1.0)
            with tempfile.TemporaryDirectory() as folder:
                first = fleet(pathlib.Path(folder), story, effect, size, arguments.campaigns, arguments.passes, rng,
                              TRAVELS if arguments.travels else TRAVELS[:1])
                done = subprocess.run([arguments.nonio, "model", "explain", folder, "--json", "--quiet"],
                                      stdout=subprocess.PIPE, text=True, check=True)
            answer = json.loads(done.stdout)
            found = {effect if effect in e["aliases"] else e["effect"]: e for e in answer["effects"]}  # "or the effect" is its name too
            named += effect in found and story != "none"
            wrong += bool(set(found) - ({effect} if story != "none" else set()))
            if story != "none" and effect in found:
                one = found[effect]
                right = {"shared": one["per_campaign"] == "shared", "differs": one["per_campaign"] == "own",
                         "appears": one["per_campaign"] == "changed" and one["values"][1]["from"] == f"c{first:04d}"}[story]
                holds += right
            if story != "none" and (effect not in found or not right) or set(found) - {effect}:
                print(f"  {story} {effect} {size:.2f}:", [(e["effect"], e["per_campaign"], e["aliases"]) for e in answer["effects"]],
                      answer["verdict"]["kind"], first if story == "appears" else "")
        print(f"{story:8} named {named} of {arguments.fleets if story != 'none' else 0}, as made {holds}, wrong names in {wrong}", flush=True)


if __name__ == "__main__":
    main()
