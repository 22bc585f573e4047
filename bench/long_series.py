#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""long_series.py PROGRAM [RUNS TARGETS]: `nonio run` on one axis of very many runs, and on one of very many targets.

Four sizes of each, doubled up to RUNS (250,000) runs at 20 targets and TARGETS (64,000) targets in 3 runs, both directions,
all outputs. CPU time and memory of the largest process, each with its ratio to half the size: 2 is linear.
"""
import os
import pathlib
import random
import subprocess
import sys
import tempfile

import make_site


def series(folder, runs, targets):
    make_site.campaign(folder, 0)
    manifest = folder / "campaign.toml"
    manifest.write_text(manifest.read_text().replace("travel = [0.0, 1100.0]", f"travel = [0.0, {10.0 * targets}]"))
    rng = random.Random(1)
    pitch = [rng.gauss(0, 3) for _ in range(targets)]
    with open(folder / "x.csv", "w") as file:
        file.write("run,direction,target_mm,deviation_um\n")
        for run in range(1, runs + 1):
            for sign, order, lost in (("+", range(targets), 0.0), ("-", reversed(range(targets)), -4.0)):
                file.writelines(f"{run},{sign},{10 * i},{pitch[i] + lost + rng.gauss(0, 0.4):.3f}\n" for i in order)


def measured(program, runs, targets):
    """CPU time, s, and memory, MB."""
    with tempfile.TemporaryDirectory(prefix="nonio-series-") as folder:
        site, out = pathlib.Path(folder, "site"), pathlib.Path(folder, "out")
        series(site / "a", runs, targets)
        process = subprocess.Popen([program, "run", site, "--out", out, "--jobs", "1", "--quiet"])
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            sys.exit(f"nonio run ended with {process.returncode}")
        return used.ru_utime + used.ru_stime, used.ru_maxrss * 1024 / 1e6


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    most_runs, most_targets = map(int, sys.argv[2:4] or (250_000, 64_000))
    print(f"{'runs':>8} {'targets':>8} {'readings':>11} {'CPU, s':>8} {'ratio':>6} {'MB':>7} {'ratio':>6}")
    for sizes in ([(most_runs >> k, 20) for k in (3, 2, 1, 0)], [(3, most_targets >> k) for k in (3, 2, 1, 0)]):
        before = None
        for runs, targets in sizes:
            now = measured(program, runs, targets)
            ratios = [f"{a / b:.2f}" for a, b in zip(now, before)] if before else ["", ""]
            print(f"{runs:>8} {targets:>8} {2 * runs * targets:>11,} {now[0]:>8.1f} {ratios[0]:>6} {now[1]:>7.0f} {ratios[1]:>6}", flush=True)
            before = now


if __name__ == "__main__":
    main()
