# SPDX-License-Identifier: Apache-2.0
"""What the tests of compare, explain and model share: campaigns with known effects, and the program."""
import json
import math
import os
import pathlib
import random
import subprocess
import tempfile
import unittest

NONIO = os.environ["NONIO"]
TARGETS = [37.0 * i for i in range(11)]


def readings(seed=1, runs=3, targets=TARGETS, noise=0.5, directions="+-", times=True, axis="mm", **effects):
    """CSV of a linear axis: scale um/m, backlash um, drift um over the test, by names of effects."""
    rng = random.Random(seed)
    rows = [f"run,direction,target_{axis},deviation_um" + (",time_s" if times else "")]
    middle, t = (targets[0] + targets[-1]) / 2, 0
    steps = runs * len(targets) * len(directions)
    for run in range(1, runs + 1):
        for direction in directions:
            for target in targets if direction == "+" else targets[::-1]:
                d = 1 if direction == "+" else -1
                value = (effects.get("scale", 0.0) * (target - middle) / 1000
                         + effects.get("backlash", 0.0) * d / 2
                         + effects.get("drift", 0.0) * t / steps
                         + effects.get("wave", 0.0) * math.sin(2 * math.pi * target / 97)
                         + effects.get("dent", 0.0) * (target == targets[len(targets) // 2])
                         + rng.gauss(0, noise))
                rows.append(f"{run},{direction},{target:g},{value:.4f}" + (f",{t * 10}" if times else ""))
                t += 1
    return "\n".join(rows) + "\n"


def manifest(effects=(), extra="", model="", axes="X", campaign_id="c"):
    text = f'format = 1\n[campaign]\nid = "{campaign_id}"\n'
    for axis in axes:
        text += f'[machine.axes.{axis}]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm = "none"\n'
    for axis in axes:
        text += f'[[measurement]]\nid = "{axis}"\nkind = "axis"\naxis = "{axis}"\nfile = "{axis.lower()}.csv"\n'
    text += extra
    if effects is not None:
        text += f"[model]\neffects = {json.dumps(list(effects))}\n{model}"
    return text


def no_constants(name):
    raise AssertionError(f"{name} is not JSON")


class VerbTest(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="nonio-verbs-")
        self.site = pathlib.Path(self._folder.name) / "site"
        self.folder = self.site / "c"
        self.folder.mkdir(parents=True)

    def tearDown(self):
        self._folder.cleanup()

    def campaign(self, text, **files):
        (self.folder / "campaign.toml").write_bytes(text.encode())
        for name, data in files.items():
            (self.folder / f"{name}.csv").write_text(data, encoding="utf-8")

    def nonio(self, *args, expect=0):
        done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=300)
        if expect is not None:
            self.assertEqual(done.returncode, expect, f"{args}\n{done.stderr}{done.stdout}")
        return done

    def json_of(self, *args, expect=0):
        done = self.nonio(*args, "--json", expect=expect)
        self.assertNotIn("null", done.stdout)
        return json.loads(done.stdout, parse_constant=no_constants)

    def text(self):
        return (self.folder / "campaign.toml").read_bytes().decode()
