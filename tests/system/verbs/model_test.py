# SPDX-License-Identifier: Apache-2.0
"""nonio model show, add, drop: the manifest keeps its bytes, the figures fall."""
import json
import unittest

from verbs import VerbTest, manifest, readings


class Model(VerbTest):
    def test_add_shows_before_and_after_and_keeps_every_other_byte(self):
        before = manifest(["scale:X"]).replace('["scale:X"]', '[\n  "scale:X", # pitch, 3 Nov\n]') + "# end"
        self.campaign(before, x=readings(scale=20, backlash=-6))
        shown = self.nonio("model", "add", self.folder, "backlash:X").stdout
        after = before.replace('# pitch, 3 Nov\n', '# pitch, 3 Nov\n  "backlash:X",\n')
        self.assertEqual(self.text(), after)
        for words in ("before", "after", "RMS", "cross-validation", "noise floor", "backlash:X", "u =", "####"):
            self.assertIn(words, shown)
        bars = [line.count("#") for line in shown.splitlines() if line.startswith(("  before ", "  after ")) and "#" in line]
        self.assertEqual(len(bars), 2)
        self.assertGreater(bars[0], 3 * bars[1])
        step = json.loads((self.folder / "model-history.jsonl").read_text())
        self.assertEqual((step["action"], step["effect"]), ("add", "backlash:X"))
        self.assertGreater(step["rms_before_um"], 3 * step["rms_after_um"])
        self.nonio("model", "drop", self.folder, "backlash:X")
        self.assertEqual(self.text(), before)
        self.assertEqual(len((self.folder / "model-history.jsonl").read_text().splitlines()), 2)
        self.assertIn("+ backlash:X", self.nonio("model", "show", self.folder).stdout)

    def test_the_page_says_what_drop_would_leave_and_in_which_order_the_error_falls(self):
        effects = ["backlash:X", "scale:X", "zero-drift:X"]
        self.campaign(manifest(effects, '[run]\noutputs = ["model-html"]\n'), x=readings(scale=60, backlash=-3, drift=9))
        self.nonio("run", self.site, "--out", self.site / "out", "--quiet", expect=None)
        page = (self.site / "out" / "c" / "model-X.html").read_text()
        data = json.loads(page.split('id="data">')[1].split("</script>")[0])
        whole = self.json_of("model", "compare", self.folder)["parts"][0]
        self.assertAlmostEqual(data["rms"], whole["rms_um"], places=5)
        self.assertAlmostEqual(data["largest"], whole["largest"]["residual_um"], places=5)
        for effect in data["effects"]:
            dropped = self.json_of("model", "drop", self.folder, effect["name"])["after"]
            others = self.json_of("model", "compare", self.folder)["parts"][0]
            self.assertAlmostEqual(effect["without"]["largest"], others["largest"]["residual_um"], places=5)
            self.json_of("model", "add", self.folder, effect["name"])
            self.assertAlmostEqual(effect["without"]["rms"], dropped["rms_um"], places=5)
            self.assertAlmostEqual(effect["without"]["cv_rms"], dropped["cv_rms_um"], places=5)
            kept = [r + s for r, s in zip(data["residual"], effect["says"])]
            unfitted = (sum(r * r for r in kept) / len(kept)) ** 0.5
            self.assertLessEqual(effect["without"]["rms"], unfitted + 1e-5)  # eight digits on the page
        falls = [line.split("</div>")[0] for line in page.split('class="label">')[1:]]
        self.assertEqual(falls, ["no effects", "+ scale:X", "+ zero-drift:X", "+ backlash:X"])

    def test_a_curve_is_described_by_its_shape(self):
        self.campaign(manifest(["pitch-curve:X"]), x=readings(wave=2, noise=0.1))
        shown = self.nonio("model", "show", self.folder).stdout
        self.assertRegex(shown, r"pitch-curve:X +curve: RMS [\d.]+ um, from -[\d.]+ um \(at \d+ mm\) to [\d.]+ um \(at \d+ mm\)")
        self.assertNotRegex(shown, r"\bs1\b")

    def test_json(self):
        self.campaign(manifest([]), x=readings(backlash=-6))
        change = self.json_of("model", "add", self.folder, "backlash:X")
        self.assertEqual(change["schema"], "nonio-model/1")
        self.assertEqual(change["effects"], ["backlash:X"])
        self.assertLess(change["after"]["rms_um"], change["before"]["rms_um"])
        shown = self.json_of("model", "show", self.folder)
        self.assertEqual(shown["parts"][0]["model"]["effects"], ["backlash:X"])

    def test_what_is_refused_changes_nothing(self):
        text = manifest(["scale:X"])
        self.campaign(text, x=readings(scale=20))
        for args, words in ((("add", "scale:X"), "is in the model already"),
                            (("add", "scal:X"), 'nearest: "scale:X"'),
                            (("add", "scale:Y"), 'no axis "Y"'),
                            (("add", "scale"), "expected kind:axis"),
                            (("drop", "backlash:X"), "is not in the model")):
            done = self.nonio("model", args[0], self.folder, args[1], expect=2)
            self.assertIn(words, done.stderr)
            self.assertEqual(self.text(), text)
        self.assertFalse((self.folder / "model-history.jsonl").exists())

    def test_an_effect_that_is_not_separable_from_the_model_is_not_added(self):
        text = manifest(["scale:X", "backlash:X"])
        self.campaign(text, x=readings(runs=1, targets=[0.0, 50.0]))
        done = self.nonio("model", "add", self.folder, "backlash-slope:X", expect=None)
        if done.returncode != 0:
            self.assertEqual(self.text(), text)
        self.nonio("model", "add", self.folder, "temperature:X", expect=None)
        self.assertEqual(done.returncode == 0, "backlash-slope" in self.text())
        self.assertNotIn("temperature", self.text())

    def test_a_value_below_its_uncertainty_is_warned_of(self):
        self.campaign(manifest([]), x=readings(seed=4))
        done = self.nonio("model", "add", self.folder, "backlash:X")
        self.assertIn("warning: backlash:X", done.stdout)

    def test_a_broken_history_stops_before_anything_is_written(self):
        text = manifest(["scale:X"])
        self.campaign(text, x=readings())
        (self.folder / "model-history.jsonl").write_text('{"action":"add"}\n')
        done = self.nonio("model", "add", self.folder, "backlash:X", expect=None)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("model-history.jsonl:1", done.stderr)
        self.assertEqual(self.text(), text)

    def test_help_teaches(self):
        self.assertIn("Example", self.nonio("model", "add", "--help").stdout)
        self.nonio("model", expect=2)
        self.nonio("model", "add", self.folder, expect=2)


if __name__ == "__main__":
    unittest.main()
