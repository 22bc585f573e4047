# SPDX-License-Identifier: Apache-2.0
"""start.py NONIO [--trials 30]: the cost of a short command, `explain` on 210 readings, compared with loading all plugins,
the program alone and an interpreter that does nothing. Least wall and CPU time of the trials, in ms, and ratios to the
interpreter's, which a busy machine changes less."""
import argparse
import os
import pathlib
import subprocess
import sys
import time

SITE = pathlib.Path(__file__).resolve().parent.parent / "samples" / "tutorial" / "site" / "missing-effect"


def least(command, trials):
    walls, cpus = [], []
    for _ in range(trials):
        began = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        walls.append(time.perf_counter() - began)
        cpus.append(usage.ru_utime + usage.ru_stime)
        if status:
            sys.exit(f"{command} failed: {status}")
    return 1e3 * min(walls), 1e3 * min(cpus)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("nonio")
    parser.add_argument("--trials", type=int, default=30)
    args = parser.parse_args()
    commands = {"python3 -I -c pass": [sys.executable, "-I", "-c", "pass"],
                "nonio version": [args.nonio, "version"],
                "nonio plugin list": [args.nonio, "plugin", "list"],
                "nonio model explain, 210 readings": [args.nonio, "model", "explain", str(SITE)]}
    base = None
    for name, command in commands.items():
        wall, cpu = least(command, args.trials)
        base = base or cpu
        print(f"{name:28} wall {wall:6.1f} ms   CPU {cpu:6.1f} ms   {cpu / base:5.1f} times the interpreter's CPU")


if __name__ == "__main__":
    main()
