# SPDX-License-Identifier: Apache-2.0
"""whole_volume_test.py NONIO [--seed SEED] [--campaigns N]

Sample 23 with other noise: a volume with all 21 errors, some smaller than one of them alone could be seen. `model explain
--auto` runs until nothing is left, adds no other effect, and leaves the noise."""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "samples"))
import in_volumes

OF_FLOOR = 1.2  # RMS over the floor of the repeats, which is itself an estimate
HIDDEN = {*(f"backlash:{a}" for a in "XYZ"), *(f"scale:{a}" for a in "XYZ"), "pitch-curve:X",
          *(f"straightness:E{of}" for of in ("YX", "ZX", "XY", "ZY", "XZ", "YZ")),
          *(f"squareness:{of}" for of in ("XY", "XZ", "YZ")), "yaw:X", "pitch:X", "roll:X", "pitch:Y", "roll:Y"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--campaigns", type=int, default=10)
    args = parser.parse_args()
    bad = 0
    for seed in range(args.seed, args.seed + args.campaigns):
        with tempfile.TemporaryDirectory() as scratch:
            for name, text in in_volumes.whole_volume(seed).items():
                (pathlib.Path(scratch) / name).write_text(text)
            done = subprocess.run([args.nonio, "model", "explain", scratch, "--auto", "--json", "--quiet"], capture_output=True, text=True)
        said = json.loads(done.stdout)
        part = said["parts"][0] if said.get("parts") else said
        others = sorted(set(part["model"]["effects"]) - HIDDEN)
        ratio = part["model"]["rms_um"] / part["noise_floor_um"]
        well = part["verdict"]["kind"] == "nothing" and not others and ratio <= OF_FLOOR
        bad += not well
        print(f"seed {seed}: {part['verdict']['kind']}, {len(part['model']['effects'])} effects, {ratio:.2f} floors"
              + ("" if not others else f", not hidden: {', '.join(others)}") + ("" if well else "  NOT AS EXPECTED"), flush=True)
    print(f"{args.campaigns - bad} of {args.campaigns} end at their floor")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
