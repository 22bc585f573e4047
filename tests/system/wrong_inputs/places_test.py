#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every error of an output or an analysis has a file and a line: that of the option that is to blame, else of the key that
asks for the output."""
import json
import os
import pathlib
import random
import subprocess
import tempfile
import unittest

import mutants
from mutants import MANIFEST, csv

NONIO = os.environ["NONIO"]


class Places(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="nonio-places-")
        self.addCleanup(self._folder.cleanup)
        self.root = pathlib.Path(self._folder.name)
        self.site, self.out, self.texts = self.root / "site", self.root / "out", {}

    def campaign(self, name, change, rows=None):
        folder = self.site / name
        folder.mkdir(parents=True)
        text = change(MANIFEST.format(id=name).replace('control = "siemens-840d"\n', "").split("[options")[0])
        self.texts[name] = text.split("\n")
        (folder / "campaign.toml").write_text(text)
        (folder / "x.csv").write_text(csv(rows or mutants.rows_of(random.Random(len(self.texts)))))

    def night(self):
        done = subprocess.run([NONIO, "run", str(self.site), "--out", str(self.out), "--quiet"], capture_output=True,
                              text=True, timeout=300)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        self.results = {f.parent.name: json.loads(f.read_text()) for f in self.out.glob("*/results.json")}

    def blamed(self, name, error):
        """The line of the manifest that an error names."""
        self.assertEqual(error.get("file"), "campaign.toml", (name, error))
        self.assertGreater(error.get("line", 0), 0, (name, error))
        return self.texts[name][error["line"] - 1]

    def controls(self):
        done = subprocess.run([NONIO, "table", "controls", "--json"], capture_output=True, text=True, timeout=60, check=True)
        return {c["name"]: c for c in json.loads(done.stdout)["controllers"]}

    def test_a_sign_that_is_not_known(self):
        """The maker does not state the sign: requested as a control, in [run], and with another option."""
        unknown = ("fagor-8055", "haas-classic", "twincat-volumetric")
        for name in unknown:
            self.campaign(f"control-{name}", lambda t, n=name: t.replace('serial = "1"', f'serial = "1"\ncontrol = "{n}"', 1))
            self.campaign(f"run-{name}", lambda t, n=name: t + f'[run]\nanalyses = []\noutputs = ["json", "{n}"]\n')
            self.campaign(f"option-{name}", lambda t, n=name: t + f'[options.{n}]\nsign = ""\n[run]\noutputs = ["{n}"]\n')
            self.campaign(f"table-{name}",
                          lambda t, n=name: t + f'[options.{n}]\naxes = ["X number=1"]\n[run]\noutputs = ["{n}"]\n')
        self.night()
        for name in unknown:
            for how, key in (("control", "control ="), ("run", "outputs ="), ("option", "sign ="), ("table", "[options.")):
                with self.subTest(output=name, asked=how):
                    errors = self.results[f"{how}-{name}"]["errors"]
                    error = next(e for e in errors if "does not state which sign" in e["message"])
                    self.assertIn(key, self.blamed(f"{how}-{name}", error))

    def test_every_output_that_cannot_write(self):
        """All controls, asked for where their tables cannot be: no axis, no number, a rotary axis for a linear one, more
        targets than room, an option out of place."""
        far = [[r, d, t * 900, v] for r, d, t, v in mutants.rows_of(random.Random(3), count=300)]
        wish = {"plain": (lambda t: t, None), "long": (lambda t: t.replace("1000.0]", "1000000.0]"), far),
                "turned": (lambda t: t.replace('"linear"', '"rotary"').replace("screw_pitch_mm = 10.0\n", ""), None),
                "odd": (lambda t: t + "[options.{n}]\naxes = [\"X number=1 nonsense=3\"]\n", None)}
        for name in self.controls():
            for how, (change, rows) in wish.items():
                self.campaign(f"{how}-{name}", lambda t, n=name, c=change: c(t).replace("{n}", n) +
                              f'[run]\noutputs = ["{n}"]\n', rows)
        self.night()
        errors = [(n, e) for n, r in self.results.items() for e in r["errors"]]
        self.assertGreater(len(errors), 20)
        for name, error in errors:
            with self.subTest(campaign=name):
                self.assertIn(error.get("file"), ("campaign.toml", "x.csv"), error)
                self.assertGreater(error.get("line", 0), 0, error)
                self.assertTrue(error["message"])

    def test_a_site_that_asks(self):
        self.site.mkdir()
        (self.site / "site.toml").write_text('format = 1\n[run]\noutputs = ["json", "haas-classic"]\n')
        self.campaign("asked", lambda t: t)
        self.night()
        error = self.results["asked"]["errors"][0]
        self.assertIn("does not state which sign", error["message"])
        self.assertEqual((error["file"], error["line"]), ("site.toml", 3))


if __name__ == "__main__":
    unittest.main()
