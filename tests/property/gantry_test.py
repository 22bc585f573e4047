# SPDX-License-Identifier: Apache-2.0
"""gantry_test.py NONIO [--campaigns N] [--seed SEED]

Gantries measured by two diagonals (or three) and lines of X at places that are no stops of the diagonals: the odd parts of
the two straightnesses are then nearly the same thing, and a straightness of millimetres would imitate a squareness. From
an empty model `--auto` finds the squareness and ends at the noise floor, or says that it does not know (one in six at most);
no curve has a size that no guide has."""
import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile

import machines

GEOMETRIES = {"two diagonals, no stops": {}, "two diagonals, one line": {"lines": 1}, "three diagonals, no stops": {"diagonals": 3}}
LARGEST = 300.0  # um; hidden are bows of 30 um


def said(nonio, *words):
    return json.loads(subprocess.run([nonio, "model", *words, "--json", "--quiet"], capture_output=True, text=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--campaigns", type=int, default=2, help="of each geometry")
    parser.add_argument("--seed", type=int, default=None)
    args = parser.parse_args()
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(1 << 31)
    print(f"seed {seed}")
    faults = unknown = 0
    for name, geometry in GEOMETRIES.items():
        for k in range(args.campaigns):
            with tempfile.TemporaryDirectory() as scratch:
                machines.gantry(random.Random(f"{seed} {name} {k}"), pathlib.Path(scratch), **geometry)
                first = said(args.nonio, "explain", scratch)
                last = said(args.nonio, "explain", scratch, "--auto")
                fit = said(args.nonio, "compare", scratch)["parts"][0]
                rms = {c["effect"]: c["rms_um"] for c in first["candidates"]}
                named = next(iter(rms), None)
                largest = max([abs(p["value"]) for p in fit["model"]["parameters"] if p["unit"] == "um"], default=0.0)
                model = last["model"]["effects"]
                print(f"{name} {k}: first {named}, verdict {last['verdict']['kind']}, RMS / floor "
                      f"{fit['rms_um'] / fit['noise_floor_um']:.2f}, largest {largest:.0f} um, model {model}", flush=True)
                kind = last["verdict"]["kind"]
                unknown += kind == "unknown" and "squareness:XY" not in model
                if (kind != "unknown" and "squareness:XY" not in model) or largest > LARGEST:
                    faults += 1
                    print("  FAULT")
    print(f"{faults} faults, {unknown} not known")
    return 0 if faults == 0 and 6 * unknown <= len(GEOMETRIES) * args.campaigns else 1


if __name__ == "__main__":
    sys.exit(main())
