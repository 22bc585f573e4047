# SPDX-License-Identifier: Apache-2.0
"""The mornings of a laboratory of 60 machines with twelve crashes of 4 um: short, and each crash is in it. Fewer campaigns than the
laboratory of bench and documents (five or six of a machine, not eight or nine), so that it takes seconds."""
import json
import os
import pathlib
import re
import stat
import subprocess
import sys
import tempfile
import unittest

NONIO = os.environ["NONIO"]
ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "support" / "laboratory"))
import make_laboratory  # noqa: E402 (this folder is no package)
import presets  # noqa: E402
import score  # noqa: E402
import truth as truths  # noqa: E402

SEED = int(os.environ.get("NONIO_SEED", "41"))
MOST_LINES = 40


def nonio(*args):
    done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=300)
    if done.returncode not in (0, 1):
        raise AssertionError(f"{args}: status {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done


class Site:
    def __init__(self, above, preset, **sizes):
        self.site, self.out, self.letter = above / preset, above / (preset + "-out"), above / (preset + "-letter")
        lab = presets.build(preset, SEED, **sizes)
        self.truth = truths.rounded(make_laboratory.write(lab, self.site, lab.night))
        post = above / (preset + "-sendmail")
        post.write_text(f'#!/bin/sh\ncat > "{self.letter}"\n')
        post.chmod(post.stat().st_mode | stat.S_IXUSR)
        with open(self.site / "site.toml", "a") as f:
            f.write(f'\n[mail]\nto = ["a@lab.test"]\nfrom = "nonio@lab.test"\nsendmail = "{post}"\n')

    def night(self, date):
        nonio("run", self.site, "--out", self.out, "--quiet", "--date", date)
        return (self.out / "summary.txt").read_text()


class Mornings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="nonio-mornings-")
        above = pathlib.Path(cls.folder.name)
        print(f"seed {SEED}", flush=True)
        cls.hit = Site(above, "lab", count=5)
        cls.summaries = [cls.hit.night(date) for date in ("2026-11-22", "2026-11-23")]
        cls.lines = json.loads(nonio("morning", cls.hit.out, "--json").stdout)["lines"]
        cls.crashes = [c for c in cls.hit.truth["changes"] if "crash" in c["kinds"]]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_summary_is_short(self):
        for summary in self.summaries:
            self.assertLessEqual(len(summary.splitlines()), MOST_LINES, summary)


if __name__ == "__main__":
    unittest.main()
