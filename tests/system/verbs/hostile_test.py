# SPDX-License-Identifier: Apache-2.0
"""compare, explain and model on degenerate campaigns: an answer or an error, never a crash or NaN."""
import json
import unittest

from verbs import TARGETS, VerbTest, manifest, no_constants, readings

HEAD = "run,direction,target_mm,deviation_um\n"
HOSTILE = {
    "empty": "",
    "head only": HEAD,
    "one reading": HEAD + "1,+,0,1.5\n",
    "two readings": HEAD + "1,+,0,1.5\n1,+,10,1.5\n",
    "one target": HEAD + "".join(f"{r},{d},5,{r}.5\n" for r in (1, 2, 3) for d in "+-"),
    "one run": readings(runs=1),
    "one direction": readings(directions="+", scale=9),
    "no times": readings(times=False, backlash=-5),
    "all the same": readings(noise=0.0),
    "no noise": readings(noise=0.0, scale=20, backlash=-6),
    "huge": readings(noise=1e9, backlash=1e12),
    "tiny": readings(noise=1e-4, backlash=1e-3),
    "two runs of one target each": HEAD + "1,+,0,1\n2,-,10,2\n",
    "wide gap": readings(targets=[0.0, 1.0, 2.0, 1e7]),
    "all missing": HEAD + "1,+,0,nan\n1,-,0,\n",
    "far targets": readings(targets=[1e9 + t for t in TARGETS]),
}
MODELS = ([], ["scale:X"], ["scale:X", "backlash:X", "pitch-curve:X", "zero-drift:X"])


class Hostile(VerbTest):
    def test_an_answer_or_an_error(self):
        for name, data in HOSTILE.items():
            for model in MODELS:
                for verb in ("compare", "explain"):
                    with self.subTest(name=name, model=model, verb=verb):
                        self.campaign(manifest(model), x=data)
                        done = self.nonio(verb, self.folder, "--json", expect=None)
                        self.assertIn(done.returncode, (0, 1), done.stderr)
                        if done.returncode == 1:
                            self.assertTrue(done.stderr.strip())
                        if done.stdout:
                            json.loads(done.stdout, parse_constant=no_constants)
                            self.assertNotIn("null", done.stdout)
                            self.assertNotIn("{", json.loads(done.stdout).get("verdict", {}).get("says", ""))

    def test_text_for_people_has_no_nan(self):
        for name, data in HOSTILE.items():
            with self.subTest(name=name):
                self.campaign(manifest(["scale:X"]), x=data)
                for verb in ("compare", "explain"):
                    shown = self.nonio(verb, self.folder, expect=None).stdout.lower()
                    for word in (" nan", " inf", "{"):
                        self.assertNotIn(word, shown)

    def test_manifests(self):
        for text in ("", "format = 1\n", "\0", "[model]\neffects = 3\n"):
            with self.subTest(text=text):
                self.campaign(text, x=readings())
                for args in (("compare", self.folder), ("explain", self.folder),
                             ("model", "show", self.folder), ("model", "add", self.folder, "scale:X")):
                    self.assertTrue(self.nonio(*args, expect=2).stderr)
                self.assertEqual(self.text(), text)

    def test_kinds_without_an_axis(self):
        text = manifest([]).replace('kind = "axis"\naxis = "X"', 'kind = "diagonal"\nfrom = { X = 0 }\nto = { X = 9 }')
        self.campaign(text, x=readings())
        self.assertEqual(self.nonio("model", "compare", self.folder, expect=1).stdout.strip(), "")


if __name__ == "__main__":
    unittest.main()
