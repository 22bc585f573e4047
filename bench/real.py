# SPDX-License-Identifier: Apache-2.0
"""real.py NONIO                       result of `explain` for the real readings in bench/real, compared with what a
                                       person sees in them (bench/real/wanted.toml)
real.py NONIO --hidden COUNT [--seed SEED]    an effect hidden in their scatter: whole passes, less the mean of each
                                       target from each side, in another order; how often it is named
real.py NONIO --complete COUNT [--seed SEED]  the same without an effect: how often the verdict is `nothing`, or says that passes
                                       differ; alarms found, and printed as their rate

Wilson's 95 % intervals. Status 1 where a set is not read as wanted."""
import argparse
import collections
import csv
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).parent / "real"
SETS = sorted(p.parent.name for p in HERE.glob("*/campaign.toml"))
SIZES = (3.5, 9.0)  # of an effect, in standard deviations of the scatter, as in story `one` of bench_hidden


def explained(nonio, folder):
    done = subprocess.run([nonio, "model", "explain", str(folder), "--json", "--quiet"], capture_output=True, text=True)
    if not done.stdout:
        sys.exit(f"{folder}: {done.stderr}")
    return json.loads(done.stdout)


def named(said):
    """What is said to belong into the model."""
    effect = said["verdict"].get("effect")
    return ([effect] if effect else []) + [e for e in said["certain"] if e != effect]


def stated(said):
    """What is said to be certain without a cause: effects of which it is the sign."""
    of = {"drift": "zero-drift", "reversal": "backlash"}
    return [f"{of[s['what']]}:{said['axis']}" for s in said["statements"]]


def faults_of(said, wanted):
    names = named(said)
    if said["verdict"]["kind"] == "missing":
        names += said["candidates"][0]["aliases"]
    floor = said.get("noise_floor_um", said.get("noise_floor_arcsec"))
    key = "rms_um" if "noise_floor_um" in said else "rms_arcsec"
    described = {d["effect"]: d for d in said["descriptions"]}
    faults = [f"verdict {said['verdict']['kind']}"] if said["verdict"]["kind"] not in wanted["verdict"] else []
    faults += [f"{e} is not named" for e in wanted["certain"] if e not in names + stated(said)]
    faults += [f"{e} is named" for e in names if e in wanted["never"]]
    faults += [f"{e} does not describe" for e in wanted["describes"] if e not in described]
    if said["descriptions"] and "floors" in wanted:
        left = said["descriptions"][-1][key] / floor
        faults += [f"descriptions leave {left:.2f} floors"] if left > wanted["floors"] else []
    if said["verdict"]["kind"] == "unknown" and not said.get("next"):
        faults.append("does not say what to measure")
    return faults


def read_all(nonio, page):
    wanted = tomllib.loads((HERE / "wanted.toml").read_text())
    bad, rows = 0, []
    print("| set | verdict | named | stated | RMS / floor | RMS with descriptions / floor | descriptions |")
    print("|---|---|---|---|---|---|---|")
    for name in SETS:
        said = explained(nonio, HERE / name)
        unit = "um" if "noise_floor_um" in said else "arcsec"
        floor = said[f"noise_floor_{unit}"]
        last = said["descriptions"][-1][f"rms_{unit}"] / floor if said["descriptions"] else math.nan
        signs = [x["what"] for x in said["statements"]]
        described = ", ".join(d["effect"] for d in said["descriptions"])
        rows.append(f"| `{name}` | {said['verdict']['kind']} | {', '.join(named(said)) or '–'} | {', '.join(signs) or '–'} | "
                    f"{said['model'][f'rms_{unit}'] / floor:.1f} | {'–' if math.isnan(last) else f'{last:.2f}'} | "
                    f"{described or '–'} |")
        print(rows[-1])
        faults = faults_of(said, wanted[name])
        bad += bool(faults)
        for fault in faults:
            print(f"    NOT AS READ: {fault}")
    result = f"{len(SETS) - bad} of {len(SETS)} sets as a person reads them"
    print(result)
    if page is None:
        return bad == 0
    text = " ".join(page.read_text().split())
    untrue = [row for row in [*rows, result] if row not in text]
    for row in untrue:
        print(f"{page.name} does not state: {row}")
    return not untrue


class Real:
    """A set and its scatter: of each pass its readings less the means of their cells, without misread ones."""

    def __init__(self, name):
        lines = [l for l in (HERE / name / "readings.csv").read_text().splitlines() if not l.startswith("#")]
        rows = list(csv.DictReader(lines))
        self.name, self.columns = name, list(rows[0])
        self.axis = "C" if "target_deg" in rows[0] else "X"
        target, value = self.columns[2], self.columns[3]
        self.targets = sorted({float(r[target]) for r in rows})
        self.runs = len({r["run"] for r in rows})
        self.ways = sorted({r["direction"] for r in rows})  # "+" first
        cells = collections.defaultdict(list)
        for r in rows:
            cells[r["direction"], float(r[target])].append(float(r[value]))
        # A mean that contains a misread value would give the other readings of its cell an error in common.
        far = 6 * statistics.median(abs(v - statistics.median(c)) for c in cells.values() for v in c)
        middle = {cell: statistics.fmean(v for v in values if abs(v - statistics.median(values)) <= far)
                  for cell, values in cells.items()}
        grow = math.sqrt(self.runs / (self.runs - 1))  # the middle takes some of the scatter with it
        self.passes = collections.defaultdict(list)
        for way in self.ways:
            for run in sorted({r["run"] for r in rows}, key=int):
                left = {float(r[target]): grow * (float(r[value]) - middle[way, float(r[target])])
                        for r in rows if r["direction"] == way and r["run"] == run}
                self.passes[way].append([left[t] for t in self.targets])
        self.scatter = math.sqrt(statistics.fmean(v * v for w in self.ways for p in self.passes[w] for v in p))


def effects_of(real):
    """Shapes over (position -1..1, direction, time 0..1) of what is hidden, by their name in the catalogue."""
    shapes = {"zero-drift": lambda p, d, t: t, "growth-drift": lambda p, d, t: p * t}
    if real.axis == "X":
        shapes["scale"] = lambda p, d, t: p
    if len(real.ways) == 2:
        shapes["backlash"] = lambda p, d, t: d
        if real.axis == "X":
            shapes["backlash-slope"] = lambda p, d, t: d * p
    return shapes


def campaign(real, rng, hidden, size):
    """Rows in the order of the cycle, with times."""
    low, high = real.targets[0], real.targets[-1]
    rows = []
    order = {way: rng.sample(real.passes[way], real.runs) for way in real.ways}  # no machine repeats a pass to the digit
    for run in range(1, real.runs + 1):
        for way in real.ways:
            drawn = dict(zip(real.targets, order[way][run - 1]))
            for target in real.targets if way == "+" else reversed(real.targets):
                rows.append([run, way, target, drawn[target]])
    if hidden:
        shape = effects_of(real)[hidden]
        says = [shape((2 * r[2] - low - high) / (high - low), 1 if r[1] == "+" else -1, i / (len(rows) - 1))
                for i, r in enumerate(rows)]
        middle = statistics.fmean(says)
        rms = math.sqrt(statistics.fmean((s - middle) ** 2 for s in says))
        for r, s in zip(rows, says):
            r[3] += size * real.scatter * s / rms
    return rows


def write(real, rows, folder):
    folder.mkdir(exist_ok=True)
    (folder / "campaign.toml").write_text((HERE / real.name / "campaign.toml").read_text())
    with open(folder / "readings.csv", "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(real.columns + ["time_s"])
        out.writerows([*r[:3], f"{r[3]:.6f}", 10 * i] for i, r in enumerate(rows))


def share(yes, of):
    z2 = 1.959964 ** 2
    p = yes / of
    middle = (p + z2 / (2 * of)) / (1 + z2 / of)
    half = math.sqrt(z2 * (p * (1 - p) + z2 / (4 * of)) / of) / (1 + z2 / of)
    return f"{yes:4} of {of:4}  {100 * p:5.1f} %  ({100 * max(0, middle - half):.1f} .. {100 * min(1, middle + half):.1f})"


def true_words(said):
    """What whole passes drawn again can show: nothing, or that passes and runs differ from each other."""
    if named(said):
        return False
    kind = said["verdict"]["kind"]
    places = [f["where"] for f in said["fails"]]
    return kind in ("nothing", "unrepeatable") or bool(places) and all("run" in p or "time" in p for p in places)


def story(nonio, count, seed, hide):
    sets = [Real(name) for name in SETS]
    tallies, verdicts = collections.defaultdict(list), collections.Counter()
    with tempfile.TemporaryDirectory() as scratch:
        for s in range(seed, seed + count):
            rng = random.Random(s)
            real = rng.choice(sets)
            hidden = rng.choice(sorted(effects_of(real))) if hide else None
            write(real, campaign(real, rng, hidden, rng.uniform(*SIZES)), pathlib.Path(scratch))
            said = explained(nonio, scratch)
            names, truth = named(said), hidden and f"{hidden}:{real.axis}"
            first = said["candidates"][0] if said["candidates"] else {"aliases": []}
            right = truth in names or bool(names) and truth in first["aliases"]
            wrong = [n for n in names if n != truth] if not right else [n for n in names[1:] if n != truth]
            verdicts[said["verdict"]["kind"]] += 1
            for key in ("all", real.name, hidden or "-"):
                tallies[key].append((right if hide else true_words(said), bool(wrong),
                                     said["verdict"]["kind"] != "nothing", said["false_alarm_rate"]))
            if wrong:
                print(f"  seed {s}: {real.name}, hidden {truth}, named {', '.join(names)}", file=sys.stderr)
    print(f"seeds {seed} .. {seed + count - 1}; verdicts {dict(verdicts)}")
    for key, all_of in tallies.items():
        right, wrong, alarms, printed = zip(*all_of)
        rates = "" if hide else f"   alarms {share(sum(alarms), len(alarms))}, printed {100 * statistics.fmean(printed):.1f} %"
        print(f"  {key:30} {'named' if hide else 'true'} {share(sum(right), len(right))}   "
              f"wrong names {share(sum(wrong), len(wrong))}{rates}")
    right, _, alarms, _ = zip(*tallies["all"])
    return 100 * statistics.fmean(right if hide else alarms)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--hidden", type=int, metavar="COUNT")
    parser.add_argument("--complete", type=int, metavar="COUNT")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most", type=float, metavar="PERCENT", help="of --complete: status 1 beyond so many alarms")
    parser.add_argument("--least", type=float, metavar="PERCENT", help="of --hidden: status 1 if fewer are named")
    parser.add_argument("--page", type=pathlib.Path, help="instead: whether this page states what is found")
    args = parser.parse_args()
    if args.hidden or args.complete:
        percent = story(args.nonio, args.hidden or args.complete, args.seed, bool(args.hidden))
        if args.hidden:
            return 1 if args.least is not None and percent < args.least else 0
        return 1 if args.most is not None and percent > args.most else 0
    return 0 if read_all(args.nonio, args.page) else 1


if __name__ == "__main__":
    sys.exit(main())
