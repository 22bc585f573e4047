# SPDX-License-Identifier: Apache-2.0
"""model_laws_test.py NONIO [--plans N] [--seed SEED]

Two laws of `compare`, for plans of measurement that are drawn at random (complete runs, runs of a part of the targets, one
direction or two, a target left out, one or two measurements):
1. No length that is printed exceeds 100 times the largest reading.
2. One more effect in the model never raises what is left of the same readings: the sum of squares that the fit minimises
   (s^2 times redundancy). Where readings are independent this is the RMS itself. Only models whose curves have as many
   knots as before are compared: their number is chosen by evidence, and may fall."""
import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile

EFFECTS = ["scale:X", "backlash:X", "zero-drift:X", "backlash-slope:X", "growth-drift:X", "pitch-curve:X"]
LARGEST = 100.0


def readings(rng):
    """Rows of one measurement, and the largest reading in size, um."""
    targets = sorted(rng.sample(range(0, 2000, 10), rng.randint(5, 15)))
    ways = rng.choice(("+-", "+-", "+-", "+"))
    noise, steps = 10.0 ** rng.uniform(-1, 1), [rng.gauss(0, 3) for _ in range(6)]
    rows, clock = [], 0
    for run in range(1, rng.randint(1, 5) + 1):
        some = targets if run == 1 or rng.random() < 0.5 else sorted(rng.sample(targets, rng.randint(1, len(targets) - 1)))
        for way in ways:
            for x in some if way == "+" else reversed(some):
                if rng.random() < 0.03:
                    continue
                y = (steps[0] * x / 1000 + steps[1] * (1 if way == "+" else -1) + steps[2] * clock / 100
                     + steps[3] * ((x - 1000) / 1000) ** 2 + rng.gauss(0, noise))
                rows.append((run, way, x, round(y, 3), 5 * clock))
                clock += 1
    return rows


def write(rng, folder):
    largest, measurements = 0.0, ""
    for m in range(rng.choice((1, 1, 2))):
        rows = readings(rng)
        largest = max([largest] + [abs(r[3]) for r in rows])
        (folder / f"{m}.csv").write_text("run,direction,target_mm,deviation_um,time_s\n"
                                         + "".join(",".join(map(str, r)) + "\n" for r in rows))
        measurements += f'[[measurement]]\nid = "M{m}"\nkind = "axis"\naxis = "X"\nfile = "{m}.csv"\n'
    (folder / "head").write_text('format = 1\n[campaign]\nid = "c"\n[machine]\nmodel = "m"\n[machine.axes.X]\nkind = "linear"\n'
                                 'travel = [0, 2000]\n' + measurements)
    return largest


def lengths(value, path=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from lengths(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for k, inner in enumerate(value):
            yield from lengths(inner, f"{path}[{k}]")
    elif isinstance(value, (int, float)) and path.endswith("_um"):
        yield path, value


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--plans", type=int, default=40)
    parser.add_argument("--seed", type=int, default=None)
    args = parser.parse_args()
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(1 << 31)
    print(f"seed {seed}")
    faults = compared = 0
    for k in range(args.plans):
        rng = random.Random(seed + k)
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            largest = write(rng, folder)
            order = rng.sample(EFFECTS, len(EFFECTS))
            before = None
            for count in range(len(order) + 1):
                model = ", ".join(f'"{e}"' for e in order[:count])
                (folder / "campaign.toml").write_text((folder / "head").read_text() + f"[model]\neffects = [{model}]\n")
                done = subprocess.run([args.nonio, "compare", scratch, "--json", "--quiet"], capture_output=True, text=True)
                said = json.loads(done.stdout) if done.stdout else {}
                if not said.get("parts"):
                    break  # these readings cannot show that effect, or not tell it from the others
                compared += 1
                part = said["parts"][0]
                for path, value in lengths(part):
                    if not abs(value) <= LARGEST * largest:
                        faults += 1
                        print(f"plan {seed + k}, model {order[:count]}: {path} is {value}, the largest reading {largest}")
                knots = [p["value"] for p in part["model"]["parameters"] if p["name"] == "knots"]
                suspects = [s["file"] + str(s.get("line")) for s in part["suspects"]]
                weighed = suspects, part["noise"].get("stretch_from_mm"), knots or (before and before[1][2])
                now = part["s_um"] ** 2 * part["redundancy"], part["rms_um"]
                if before and before[1] == weighed:
                    independent = part["noise"]["neighbours_used"] == 0 and "stretch_from_mm" not in part["noise"]
                    for what, old, new in zip(("sum of squares", "RMS"), before[0], now):
                        if new > old * (1 + 1e-6) and (what != "RMS" or independent):
                            faults += 1
                            print(f"plan {seed + k}: with {order[count - 1]} the {what} rises from {old} to {new}")
                before = now, weighed
    print(f"{args.plans} plans, {compared} comparisons, {faults} faults")
    return 0 if faults == 0 and compared > args.plans else 1


if __name__ == "__main__":
    sys.exit(main())
