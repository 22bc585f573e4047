#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Steps that a history names where the targets are moved from visit to visit, as ISO 230-2 wants it.

    bench/history_offsets.py PROGRAM FOLDER [--machines 40] [--seed 1] [--offsets 0 0.05 0.2 0.5] [--quiet]

Invented machines (tests/support/laboratory) of 6 to 10 visits and three axes each, of which two in three have one undeclared
step: reversal, scale, a bent stretch of the screw, scatter or the error of the pitch, of 3 to 12 standard uncertainties. Their curves are
no polynomials: slow waves, a wave of an Abbe error, a kink, an error of the pitch. Each target of each visit is moved by a random part of a
step of at most the offset; 0: evenly spaced targets, always the same. --quiet: without steps. FOLDER must be empty or not there.

A step of a quantity is its change over the whole travel, between the visits next to it whose targets tell the quantity. Its standard
uncertainty is that of the difference of these two visits: of their readings, and of the calibrations of a scale where the instrument
changed. It does not contain what moved targets sample differently. At offset 0 the step is that at the targets.

Prints for each offset: planted steps of which a quantity is named; quantities with a step of 3 standard uncertainties or more that are
named; reported changes that did not happen, out of the series in the history.
"""
import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests" / "support" / "laboratory"))
import life  # noqa: E402 (this folder is no package)
import make_laboratory  # noqa: E402
import presets  # noqa: E402
import score  # noqa: E402
import truth as truths  # noqa: E402
from parts import Noise, targets  # noqa: E402

OFFSET = 0.0
DENSE = 331  # intervals, a prime number: no pitch divides them


class Curved(life.Axis):
    """An axis whose curve is no polynomial: `kink` um/m from a place on, and a wave of `abbe` um."""
    kink, at, abbe, length, phase = 0.0, 0.0, 0.0, 1.0, 0.0

    def error(self, state, x, direction, warmer=0.0):
        y = super().error(state, x, direction, warmer) + self.kink * max(0.0, x - self.at) / 1000.0
        return y + self.abbe * math.sin(2.0 * math.pi * x / self.length + self.phase)


def moved(seed, machine, axis, plan):
    first, last = axis.travel
    if OFFSET == 0.0:
        return [round(first + (last - first) * i / (axis.count - 1), 3) for i in range(axis.count)]
    places = targets(Noise("%s/offsets %s %s" % (seed, plan.ident, axis.name)), first, last, axis.count, OFFSET)
    for i in range(1, len(places)):  # neighbours at half a step may meet
        places[i] = round(max(places[i], places[i - 1] + 0.1 * (last - first) / (axis.count - 1)), 3)
    return places


def values_of_axis(axis, m, day, without=()):
    """Of the whole travel. What a visit's own targets make of an error between them is no value of the axis, and no step of it."""
    first, last = axis.travel
    places = [first + (last - first) * i / DENSE for i in range(DENSE + 1)]
    return life.true_values(axis, life.quantities_of(axis, places), places, day, without)


class Truth(truths.Truth):
    """Whose steps are those of the axis, between the visits next to them whose targets tell the quantity."""

    def add_changes(self, machine, axis, taken, grouped):
        if OFFSET == 0.0:
            return super().add_changes(machine, axis, taken, grouped)
        own = [truths.noise_of(machine, axis, m) for _, m in taken]
        for k, together in grouped:
            (p, m), (q, n) = taken[k], taken[k + 1]
            now, before = (values_of_axis(axis, n, together[-1]["day"], without) for without in ((), tuple(together)))
            sizes = {}
            for name, size in ((name, now[name] - before[name]) for name in now):
                told = [[u[name] for u in part if name in u] for part in (own[k::-1], own[k + 1:])]
                if all(told):
                    parts = [told[0][0], told[1][0]]
                    if name == "scale" and p.instrument.key(p.day) != q.instrument.key(q.day):
                        parts += [i.U_per_m / 2.0 for i in (p.instrument, q.instrument)]
                    u = math.hypot(*parts)
                    sizes[name] = {"size": size, "u": u, "in_u": abs(size) / u, "in_u_of_levels": abs(size) / math.hypot(
                        *(math.hypot(*part) / len(part) for part in told))}
            self.changes.append({"machine": machine.names[0], "axis": axis.name, "kinds": [h["kind"] for h in together],
                                 "after": p.ident, "before": q.ident, "declared": False, "compensated": False, "comparable": True,
                                 "quantities": sizes})
        return None


def laboratory(seed, machines, quiet):
    lab = presets.Laboratory("mixed", seed, "2021-11-22", "2026-11-22")
    instruments = presets.lasers(lab, "2021-10-01")
    for k in range(machines):
        noise, machine = presets.common_machine(lab, k, calm=True)
        for axis in machine.axes:
            axis.__class__ = Curved
            length = axis.travel[1] - axis.travel[0]
            axis.kink, axis.at = noise.uniform(-8.0, 8.0), axis.travel[0] + length * noise.uniform(0.2, 0.8)
            axis.abbe, axis.length, axis.phase = noise.uniform(0.0, 1.5), length * noise.uniform(0.25, 1.5), noise.uniform(0.0, 6.0)
            axis.count = int(noise.uniform(9, 22))
        presets.campaigns(lab, machine, noise, 6 + k % 5, 6 + k % 5, instruments)
        if not quiet and k % 3 != 2:
            axis = machine.axes[int(noise.uniform(0, len(machine.axes)))]
            what, _ = presets.crash_of(noise, machine, axis, noise.uniform(3.0, 12.0))
            axis.happens(presets.between_plans(noise, machine, 3, 3), "crash", **what)
        lab.machines.append(machine)
    return lab


def one(program, folder, seed, offset, given):
    global OFFSET
    OFFSET = offset
    life.places_of = moved
    where = folder / ("%g" % offset)
    where.mkdir(parents=True)
    lab = laboratory(seed, given.machines, given.quiet)
    truths.Truth = Truth
    truth = make_laboratory.write(lab, where / "site", lab.night)
    for change in truth["changes"]:  # other ends are what is asked about
        change["comparable"] = True
    done = subprocess.run([program, "run", where / "site", "--out", where / "out", "--jobs", "2", "--quiet", "--date", "2026-11-22"],
                          capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise SystemExit(done.stderr)
    history = json.loads(subprocess.run([program, "machine", "history", where / "out", "--json"], check=True, capture_output=True, text=True).stdout)
    (where / "history.json").write_text(json.dumps(history))
    truths.save(truth, where / "truth.json")
    shutil.rmtree(where / "site")
    shutil.rmtree(where / "out")
    return truths.rounded(truth), history


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], epilog=__doc__.split("\n\n", 1)[1],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--machines", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--offsets", type=float, nargs="+", default=[0.0, 0.05, 0.2, 0.5])
    parser.add_argument("--quiet", action="store_true")
    given = parser.parse_args()
    print("seed %d, %d machines" % (given.seed, given.machines))
    for offset in given.offsets:
        truth, history = one(given.program, given.folder, given.seed, offset, given)
        total = score.Score()
        total.add(truth, [history])
        followed = [s for s in history["series"] if "model" in s]
        print("offset %.2f: steps with a quantity named %s; quantities of 3 u or more %s" % (offset, total.main, total.steps["all"]))
        print("  " + "; ".join("%g to %g u: %s" % (*b, c) for b, c in total.steps.items() if b != "all" and c.of))
        print("  false: %d of %d series; instruments taken for the machine: %d; missed: %s" % (
            len(total.false), len(followed), len(total.blamed), total.missed), flush=True)
        for text in total.false[:6]:
            print("    " + text)


if __name__ == "__main__":
    main()
