# SPDX-License-Identifier: Apache-2.0
"""The worklists of a laboratory of 60 machines with twelve crashes of 4 um: they are short, and each crash is reported. The machines
have fewer campaigns than in bench and documents (five or six each, not eight or nine), so that the test takes seconds."""
import email
import email.policy
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
            f.write(f'\n[mail]\nto = ["a@lab.test"]\nfrom = "nonio@lab.test"\nsendmail = "{post}"\n'
                    'base_url = "https://lab.test/out"\n')

    def night(self, date):
        nonio("run", self.site, "--out", self.out, "--quiet", "--date", date)
        return (self.out / "summary.txt").read_text()


class Mornings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="nonio-mornings-")
        above = pathlib.Path(cls.folder.name)
        print(f"seed {SEED}", flush=True)
        cls.hit, cls.quiet = Site(above, "lab", count=5), Site(above, "quiet", count=4)
        cls.summaries = [cls.hit.night(date) for date in ("2026-11-22", "2026-11-23")]
        cls.lines = json.loads(nonio("status", "--actions", cls.hit.out, "--json").stdout)["lines"]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_summary_is_short(self):
        for summary in self.summaries:
            self.assertLessEqual(len(summary.splitlines()), MOST_LINES, summary)

    def test_a_good_run_without_changes_is_one_line(self):
        self.quiet.night("2026-11-22")
        summary = self.quiet.night("2026-11-23")
        self.assertEqual(len(summary.splitlines()), 1, summary)

    def test_each_crash_is_named_by_machine_axis_quantity_and_days(self):
        days = {p["campaign"]: p["date"] for s in self.hit.truth["series"] for p in s["points"]}
        crashes = [c for c in self.hit.truth["changes"] if "crash" in c["kinds"]]
        self.assertEqual(len(crashes), 12)
        for c in crashes:
            self.assertGreaterEqual(c["quantities"]["B_mean"]["in_u"], score.LEAST)
            between = f"Mean reversal changed by .* between {days[c['after']]} and {days[c['before']]}"
            told = [line for line in self.lines if (line.get("machine"), line.get("axis")) == (c["machine"], c["axis"]) and line["state"] == "new"]
            self.assertTrue(any(re.search(between, line["says"]) for line in told), (c["machine"], c["axis"], told))
            for summary in self.summaries:
                self.assertRegex(summary, f"{c['machine']} {c['axis']}: .*{between}")

    def test_the_mail_is_what_the_lines_say(self):
        letter = email.message_from_bytes(self.hit.letter.read_bytes(), policy=email.policy.default).get_content()
        mailed = [line for line in self.lines if line["mail"]]
        self.assertGreaterEqual(len(mailed), 12)
        self.assertEqual(len(letter.splitlines()), len(mailed))
        links = re.findall(r"\[(\S+)\]$", letter, re.M)
        self.assertEqual(sorted(links), sorted("https://lab.test/out/" + line["link"] for line in mailed if line.get("link")))
        self.assertGreaterEqual(len(links), 12)
        for line in mailed:
            if line.get("axis"):
                self.assertIn(f"{line['machine']} {line['axis']}: ", letter)


if __name__ == "__main__":
    unittest.main()
