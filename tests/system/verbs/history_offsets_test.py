# SPDX-License-Identifier: Apache-2.0
"""Targets that are moved from visit to visit, as ISO 230-2 wants it, are one series (bench/history_offsets.py measures more)."""
import argparse
import os
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "bench"))
import history_offsets  # noqa: E402 (this folder is no package)

SEED = int(os.environ.get("SEED", "7"))


class Offsets(unittest.TestCase):
    def test_series_go_on_and_steps_are_named(self):
        given = argparse.Namespace(machines=9, quiet=False)
        with tempfile.TemporaryDirectory(prefix="nonio-offsets-") as folder:
            truth, history = history_offsets.one(os.environ["NONIO"], pathlib.Path(folder) / "work", SEED, 0.4, given)
        followed = [s for s in history["series"] if "model" in s]
        self.assertFalse([p for s in followed for p in s["points"] if not p["joined"]], "seed %d" % SEED)
        compared = [s for s in followed if "compared_over" in s]
        self.assertEqual({s["quantity"] for s in compared}, {"scale", "curve_2", "curve_3", "B_mean"}, "seed %d" % SEED)
        for s in compared:
            self.assertLess(s["compared_over"]["from"], s["compared_over"]["to"])
        site = history_offsets.score.Site(truth, history)
        steps = [(c, q) for c in truth["changes"] for q, step in c["quantities"].items()
                 if q in ("B_mean", "scale", "ln_s") and step["in_u"] >= 5.0]
        self.assertTrue(steps, "seed %d" % SEED)
        for c, quantity in steps:
            self.assertTrue(history_offsets.score.look_for(site, c, quantity)[0], "seed %d: %s of %s" % (SEED, quantity, c["machine"]))


if __name__ == "__main__":
    print("seed %d" % SEED)
    unittest.main()
