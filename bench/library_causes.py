# SPDX-License-Identifier: Apache-2.0
"""library_causes.py NONIO [--count N] [--seed SEED] [--only PART] [--verbose]

Campaigns with one cause of the library in addition to the model (scale and backlash, or eccentricity and backlash), and
with none: how often `explain --auto` names the cause first, how often it adds nothing that was not hidden and ends at the
noise floor ("complete"), and how often it names something wrong first. The physics is written here, apart from the
library: heat by small time steps, wear and friction as curves, in um, mm, s, arcsec, deg.

Wilson's 95 % intervals. Prints the seed of every campaign that is not right (--verbose)."""
import argparse
import collections
import json
import math
import os
import pathlib
import random
import subprocess
import tempfile

NOISE = 0.5


def smooth_step(z):
    return 1 / (1 + math.exp(-z))


def settle(t, tau):
    """A body that approaches its surroundings, by 400 explicit steps of a whole test."""
    x, n = 0.0, max(1, int(400 * t))
    for _ in range(n):
        x += (1 - x) * t / n / tau
    return x


# x: -0.5 .. 0.5 over the travel; d; t: 0 .. 1; run; runs; c: random numbers of the campaign; s: since the turn 0 .. 1
LINEAR = {
    "parabolic-reversal": lambda x, d, t, r, n, c: d * (0.25 - x * x),
    "local-reversal": lambda x, d, t, r, n, c: d / (1 + ((x - c["q"]) / c["w"]) ** 4),
    "reversal-step": lambda x, d, t, r, n, c: d * smooth_step((x - c["q"]) / 0.004),
    "reversal-after-turn": lambda x, d, t, r, n, c: d * math.exp(-(0.5 + d * x) / c["w"]),
    "half-lead": lambda x, d, t, r, n, c: math.sin(4 * math.pi * x * c["leads"] + c["phase"]),
    "lead-wave-middle": lambda x, d, t, r, n, c: math.sin(2 * math.pi * x * c["leads"] + c["phase"])
    * math.sin(math.pi * (x + 0.5)),
    "worn-section": lambda x, d, t, r, n, c: 1 / math.cosh((x - c["q"]) / (0.5 * c["w"])),
    "scale-kink": lambda x, d, t, r, n, c: abs(x - c["q"]),
    "screw-warms-between-bearings": lambda x, d, t, r, n, c: (0.25 - x * x) * settle(t, c["tau"]),
    "growth-stops": lambda x, d, t, r, n, c: x * min(t, c["at"]),
    "cooler-scale": lambda x, d, t, r, n, c: x * math.sin(c["waves"] * 2 * math.pi * t + c["phase"]),
    "settling-zero": lambda x, d, t, r, n, c: settle(t, c["tau"]),
    "cooler-zero": lambda x, d, t, r, n, c: math.sin(c["waves"] * 2 * math.pi * t + c["phase"]),
    "one-run-off": lambda x, d, t, r, n, c: float(r == c["which"]),
    "play-after-run": lambda x, d, t, r, n, c: d * float(r > c["which_before"]),
    "reversal-of-one-run": lambda x, d, t, r, n, c: d * float(r == c["which"]),
    "reversal-drift": lambda x, d, t, r, n, c: d * t,
    "pressure-scale": lambda x, d, t, r, n, c: x * c["weather"](t),
}
ROTARY = {
    "harmonic3": lambda x, d, t, r, n, c: math.sin(6 * math.pi * x + c["phase"]),
    "harmonic4": lambda x, d, t, r, n, c: math.sin(8 * math.pi * x + c["phase"]),
    "worm-sidebands": lambda x, d, t, r, n, c: math.sin(2 * math.pi * 90 * x + c["phase"])
    * math.cos(2 * math.pi * x + c["second"]),
    "reversal-two-waves": lambda x, d, t, r, n, c: d * math.sin(4 * math.pi * x + c["phase"]),
    "local-reversal-sector": lambda x, d, t, r, n, c: d * math.exp(-8 * math.sin(math.pi * (x - c["q"])) ** 2),
    "rotary-settling-zero": lambda x, d, t, r, n, c: settle(t, c["tau"]),
    "rotary-play-after-run": lambda x, d, t, r, n, c: d * float(r > c["which_before"]),
}
NONE = {"none": lambda *_: 0.0, "rotary-none": lambda *_: 0.0}


def weather(rng):
    a, b, c = rng.gauss(0, 3), rng.gauss(0, 2), rng.uniform(0, 6)
    return lambda t: a * t + b * math.sin(4 * t + c)


def campaign(rng, cause, shape, folder):
    """Writes it; hidden sizes are 2 to 8 times the noise (RMS)."""
    rotary = cause in ROTARY or cause == "rotary-none"
    runs, targets = rng.choice((5, 5, 6)), rng.choice((15, 19, 21))
    length, lead = (360.0, 4.0) if rotary else (rng.choice((400.0, 800.0, 1500.0)), rng.choice((8.0, 10.0, 16.0)))
    places = [(k + (0 if k in (0, targets - 1) else rng.uniform(-0.35, 0.35))) / (targets - 1) for k in range(targets)]
    places = [round(length * (0.97 if rotary else 1.0) * p, 3) for p in places]
    middle = places[-1] / 2
    which = rng.randint(1, runs)
    c = {"q": rng.uniform(-0.3, 0.3), "w": rng.uniform(0.08, 0.2), "phase": rng.uniform(0, 6.28), "which": which,
         "second": rng.uniform(0, 6.28), "which_before": rng.randint(1, runs - 1), "tau": rng.uniform(0.08, 0.4),
         "at": rng.uniform(0.3, 0.7), "waves": rng.uniform(1.6, 6.0), "leads": length / lead, "weather": weather(rng)}
    rows = []
    for run in range(1, runs + 1):
        for d in (1, -1):
            rows += [(run, d, p) for p in (places if d > 0 else reversed(places))]
    span = len(rows) - 1
    time = [15.0 * k + (60.0 * (row[0] - 1)) for k, row in enumerate(rows)]
    pure = []
    for k, (run, d, p) in enumerate(rows):
        x = (p - middle) / (360.0 if rotary else length)
        pure.append(shape(x, d, time[k] / time[span], run, runs, c))
    mean = sum(pure) / len(pure)
    rms = math.sqrt(sum((y - mean) ** 2 for y in pure) / len(pure))
    factor = NOISE * rng.uniform(2, 8) / rms if rms > 0 else 0.0
    slope, play, phase = rng.gauss(0, 4), rng.gauss(0, 3), rng.uniform(0, 6.28)
    unit, place = ("arcsec", "deg") if rotary else ("um", "mm")
    text = f"run,direction,target_{place},deviation_{unit},time_s" + (",pressure_hpa" if not rotary else "") + "\n"
    for k, (run, d, p) in enumerate(rows):
        known = slope * math.sin(math.radians(p) + phase) if rotary else slope * p / length
        y = 7.0 + known + play * d / 2 + factor * pure[k] + rng.gauss(0, NOISE)
        text += f"{run},{'+' if d > 0 else '-'},{p:.3f},{y:.3f},{time[k]:.0f}"
        text += f",{1010 + c['weather'](time[k] / time[span]):.2f}\n" if not rotary else "\n"
    (folder / "x.csv").write_text(text)
    axis = "C" if rotary else "X"
    drive = "teeth = 90" if rotary else f"screw_pitch_mm = {lead}"
    known = '"eccentricity:C", "backlash:C"' if rotary else '"scale:X", "backlash:X"'
    (folder / "campaign.toml").write_text(
        f'format = 1\n[campaign]\nid = "c"\n[machine]\nmodel = "m"\n[machine.axes.{axis}]\n'
        f'kind = "{"rotary" if rotary else "linear"}"\ntravel = [-1.0, {length + 1}]\n{drive}\n'
        f'[[measurement]]\nid = "A"\nkind = "axis"\naxis = "{axis}"\nfile = "x.csv"\n[model]\neffects = [{known}]\n')


def interval(k, n):
    z, p = 1.96, k / n
    half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    centre = (p + z * z / (2 * n)) / (1 + z * z / n)
    return f"{k:3d} of {n} ({100 * max(0, centre - half):.1f} .. {100 * min(1, centre + half):.1f} %)"


def explained(program, folder, *more):
    done = subprocess.run([program, "model", "explain", folder, "--json", *more], capture_output=True, text=True)
    return json.loads(done.stdout)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("program")
    options.add_argument("--count", type=int, default=10)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--only", default="")
    options.add_argument("--verbose", action="store_true")
    given = options.parse_args()
    total = collections.Counter()
    for cause, shape in {**LINEAR, **ROTARY, **NONE}.items():
        if given.only and given.only not in cause:
            continue
        tally, others = collections.Counter(), collections.Counter()
        for seed in range(given.seed, given.seed + given.count):
            rng = random.Random(f"{cause} {seed}")
            with tempfile.TemporaryDirectory() as place:
                folder = pathlib.Path(place)
                campaign(rng, cause, shape, folder)
                first = explained(given.program, folder)
                first = first["parts"][0] if "parts" in first else first
                verdict = first["verdict"]
                name = verdict.get("effect", "").split(":")[0]
                tally["alarm"] += verdict["kind"] != "nothing"
                tally["right"] += name == cause
                alike = [a.split(":")[0] for x in first["candidates"] if x["effect"] == verdict.get("effect")
                         for a in x["aliases"]]
                tally["alias"] += name != cause and cause in alike
                tally["wrong"] += name not in ("", cause) and cause not in alike
                tally["unknown"] += verdict["kind"] == "unknown"
                if name not in ("", cause):
                    others[name] += 1
                if verdict["kind"] == "missing":
                    explained(given.program, folder, "--auto")
                last = explained(given.program, folder)
                last = last["parts"][0] if "parts" in last else last
                tally["floor"] += last["verdict"]["kind"] == "nothing"
                if given.verbose and name != cause:
                    print(f"    {cause} seed {seed}: {verdict['kind']} {name} {alike}")
        n = given.count
        print(f"{cause:30s} first {tally['right']:3d}  alias {tally['alias']:3d}  wrong {tally['wrong']:3d}"
              f"  unknown {tally['unknown']:3d}  floor {tally['floor']:3d}  of {n}  {dict(others) or ''}", flush=True)
        kind = "none" if "none" in cause else "hidden"
        for key, value in tally.items():
            total[kind, key] += value
        total[kind, "n"] += n
    for kind in ("hidden", "none"):
        if n := total[kind, "n"]:
            for key in ("right", "alias", "wrong", "unknown", "floor") if kind == "hidden" else ("alarm",):
                print(f"{kind}: {key:8s} {interval(total[kind, key], n)}")


if __name__ == "__main__":
    main()
