# SPDX-License-Identifier: Apache-2.0
"""predicted_rms_test.py NONIO [--campaigns N] [--candidates N] [--seed SEED]

`explain` predicts for each candidate the RMS with it in the model. The law: `model add` obtains it, within 2 %. Checked
over random campaigns of several kinds (an axis, a rotary axis, two states of an axis, a gantry), in addition to empty
models and to those that `explain` has led to."""
import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile

import machines

WITHIN = 0.02
KINDS = [machines.linear, machines.rotary, machines.two_states, machines.gantry]


def said(nonio, *words):
    done = subprocess.run([nonio, *words, "--json", "--quiet"], capture_output=True, text=True)
    return json.loads(done.stdout) if done.stdout else {}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--campaigns", type=int, default=4, help="of each kind")
    parser.add_argument("--candidates", type=int, default=4, help="of each explanation, at most")
    parser.add_argument("--seed", type=int, default=None)
    args = parser.parse_args()
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(1 << 31)
    print(f"seed {seed}")
    compared, faults, worst = {}, 0, 0.0
    for kind in KINDS:
        for k in range(10 * args.campaigns):
            if k >= args.campaigns and kind.__name__ in compared:  # more only where nothing could be compared
                break
            rng = random.Random(f"{seed} {kind.__name__} {k}")
            with tempfile.TemporaryDirectory() as scratch:
                kind(rng, pathlib.Path(scratch))
                for _ in range(3):
                    whole = said(args.nonio, "model", "explain", scratch)
                    candidates = [c for c in whole.get("candidates", []) if c.get("score", 0) > 0]
                    for c in rng.sample(candidates, min(args.candidates, len(candidates))):
                        unit = next(key for key in c if key in ("rms_um", "rms_arcsec"))
                        after = said(args.nonio, "model", "add", scratch, c["effect"]).get("after")
                        if not after:
                            continue  # in addition to the model these readings cannot show it
                        said(args.nonio, "model", "drop", scratch, c["effect"])
                        compared[kind.__name__] = compared.get(kind.__name__, 0) + 1
                        off = abs(after[unit] / c[unit] - 1)
                        worst = max(worst, off)
                        if off > WITHIN:
                            faults += 1
                            model = whole["model"]["effects"]
                            print(f"{kind.__name__} {k}: {c['effect']} in addition to {model}: predicted {c[unit]}, obtained {after[unit]}")
                    if not candidates:
                        break
                    said(args.nonio, "model", "add", scratch, candidates[0]["effect"])
    print(f"compared {compared}, {faults} faults; largest difference {100 * worst:.2f} %")
    return 0 if faults == 0 and len(compared) == len(KINDS) else 1


if __name__ == "__main__":
    sys.exit(main())
