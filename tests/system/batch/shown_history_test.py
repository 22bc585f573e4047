# SPDX-License-Identifier: Apache-2.0
"""Reports that show the history of their machine: it depends only on the campaigns up to their day, not on the order of runs."""
import json
import math
import os
import random
import re
import shutil
import signal
import subprocess
import time
import unittest

from nightly import NightTest, tree

DAYS = ("2025-01-15", "2025-07-14", "2026-01-20", "2026-07-11")
SEED = int(os.environ.get("NONIO_SEED", "19"))
KILLS = int(os.environ.get("NONIO_KILLS", "3"))
SITE = """[run]
analyses = ["iso230-2"]
outputs = ["pdf-report"]
[options.pdf-report]
history = true
[[due]]
months = 6
"""
MANIFEST = """format = 1
[campaign]
id = "{id}"
date = {day}
[machine]
asset = "{asset}"
[machine.axes.X]
kind = "linear"
tolerance_um = {{ A = 18.0, B = 8.0, R = 8.0 }}
[instrument]
model = "Laser"
serial = "L-1"
certificate = "C-7"
calibrated = 2024-11-02
U_fixed_um = 0.1
U_per_m_um = 0.5
[environment]
temperature_range_K = 0.4
temperature_difference_K = 1.0
drift_um = 0.2
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
"""


class ShownHistory(NightTest):
    def setUp(self):
        super().setUp()
        (self.site / "site.toml").write_text(SITE)

    def measured(self, number, asset="M-1", seed=None):
        """The campaign of that number, so named that their order by id is not the one by day."""
        name = "zyxw"[number]
        return self.campaign(name, text=MANIFEST.format(id=name, day=DAYS[number], asset=asset), seed=seed or f"{asset} {number}")

    def night(self, day, *more, expect=0):
        return self.run_nonio("--date", day, "--quiet", *more, expect=expect)

    def record(self, name):
        return json.loads((self.out / name / "run.json").read_text())

    def reports(self):
        return {p.parent.name: p.read_bytes() for p in sorted(self.out.glob("?/report.pdf"))}

    def text(self, name):
        done = subprocess.run(["pdftotext", "-layout", self.out / name / "report.pdf", "-"], capture_output=True, text=True, check=True)
        return re.sub(r"[ \n]+", " ", done.stdout)

    def again(self, out):
        """Another output folder of the same site."""
        shutil.rmtree(out, ignore_errors=True)
        self.out = out
        return self

    def test_one_by_one_and_all_at_once_are_the_same(self):
        for number, day in enumerate(DAYS):
            self.measured(number)
            self.night(day)
        one_by_one = self.reports()
        self.assertEqual(len(one_by_one), 4)
        for jobs in ("1", "4"):
            self.again(self.root / f"at once {jobs}").night("2026-11-03", "--jobs", jobs)
            self.assertEqual(self.reports(), one_by_one)
        # In reverse order of the days, each in a run of its own.
        shutil.rmtree(self.site / "z"), shutil.rmtree(self.site / "y"), shutil.rmtree(self.site / "x")
        self.again(self.root / "backwards").night("2026-11-03")
        for number in (2, 0, 1):
            self.measured(number)
            self.night("2026-11-04")
        self.assertEqual(self.reports(), one_by_one)
        # A store that is made again.
        (self.out / "history.sqlite").unlink()
        self.night("2026-11-05")
        self.assertEqual(self.reports(), one_by_one)
        self.assertEqual(self.ids("done"), [])

    def test_what_it_says_and_what_is_recorded(self):
        for number in range(4):
            self.measured(number)
        self.night("2026-11-03")
        self.assertIn("M-1: first campaign, 2025-01-15", self.text("z"))
        self.assertEqual(self.record("z")["history"]["campaigns"], {})
        self.assertEqual(list(self.record("w")["history"]["campaigns"]), ["z", "y", "x"])
        said = self.text("w")
        self.assertIn("this campaign and 3 other campaigns", said)
        self.assertIn(self.record("w")["history"]["sha256"][:16], said)
        self.assertIn("Next calibration: 2027-01-11 (every 6 months", said)
        # The difference, from what results.json says: what both campaigns have in common cancels.
        found = [next(q for q in self.results(name)["followed"] if q["quantity"] == "B_mean") for name in ("x", "w")]
        size = found[1]["value"] - found[0]["value"]
        u = math.hypot(found[0]["u"], found[1]["u"])
        digits = 1 - math.floor(math.log10(2 * u))
        self.assertIn(f"{size:.{digits}f} ± {2 * u:.{digits}f}", said.replace("−", "-"))
        # The results do not depend on it, but for the digest of the file.
        without = self.results("w")
        (self.site / "site.toml").write_text(SITE.replace("history = true", "history = false"))
        self.again(self.root / "without").night("2026-11-03")
        self.assertNotIn("history", self.record("w"))
        bare = self.results("w")
        for results in (without, bare):
            results.pop("outputs"), results.pop("inputs", None)
        self.assertEqual(bare, without)

    def test_what_makes_a_report_anew(self):
        for number in (1, 2, 3):
            self.measured(number)
        self.measured(0, asset="M-2")
        self.night("2026-11-03")
        first = self.reports()
        self.night("2026-11-04")
        self.assertEqual((self.ids("done"), self.reports()), ([], first), "a night on which nothing changed")

        def event(day, night, text="tool hit the vice"):
            with open(self.site / "events.toml", "a", encoding="utf-8") as file:
                if file.tell() == 0:
                    file.write("format = 1\n")
                file.write(f'[[event]]\ndate = {day}\nmachine = "M-1"\naxis = "X"\nkind = "crash"\ntext = "{text}"\n')
            self.night(night)
            return {name for name, report in self.reports().items() if report != first[name]}

        self.assertEqual(event("2026-12-24", "2026-12-25"), set(), "after the last campaign")
        self.assertEqual(self.ids("done"), [])
        self.assertEqual(event("2026-03-01", "2026-12-26", "tool hit 校正"), {"w"})
        self.assertEqual(self.reason("done", "w"), "the history of its machine changed")
        self.assertIn("2026-03-01 X crash: tool hit", self.text("w"))
        first = self.reports()
        self.measured(2, seed="corrected")
        self.night("2026-12-27")
        self.assertEqual({n for n, report in self.reports().items() if report != first[n]}, {"w", "x"})
        first = self.reports()
        (self.site / "site.toml").write_text(SITE + '[[alias]]\nname = "M-2"\nasset = "M-1"\nwhy = "one plate"\n')
        self.night("2026-12-28")
        self.assertIn("M-1 (also M-2), up to 2025-07-14: this campaign and one other", self.text("y"))

    def test_killed_it_ends_as_undisturbed(self):
        for number in range(4):
            self.measured(number)
        began = time.monotonic()
        self.night("2026-11-03")
        took = time.monotonic() - began
        whole, rng, killed = tree(self.out), random.Random(SEED), 0
        while killed < KILLS:
            self.again(self.root / f"killed {time.monotonic_ns()}")
            moment = rng.uniform(0.1, 1.0) * took
            run = subprocess.Popen(self.command("--date", "2026-11-03", "--quiet"), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
            time.sleep(moment)
            os.killpg(run.pid, signal.SIGKILL)
            if run.wait() != -signal.SIGKILL:
                took = moment  # it ended before, so that later moments are too late
                continue
            killed += 1
            state = self.out / ".nonio" / "night.json"
            if not state.exists() or json.loads(state.read_text())["state"] != "complete":
                self.night("2026-11-03")  # a run that was complete when it was killed would be followed by a second one
            self.assertEqual(tree(self.out), whole, f"killed after {moment:.3f} s, seed {SEED}")

    def test_a_template_without_the_page_is_an_error(self):
        (self.site / "templates").mkdir()
        shutil.copy(os.path.join(os.environ["NONIO_TEMPLATES"], "report.toml"), self.site / "templates" / "report-bare.toml")
        path = self.site / "templates" / "report-bare.toml"
        path.write_text(path.read_text().replace('"history", ', ""))
        (self.site / "site.toml").write_text(SITE.replace("history = true", 'history = true\ntemplate = "report-bare"'))
        self.measured(0)
        done = self.night("2026-11-03", expect=1)
        self.assertIn('options.pdf-report.history: the template has no block "history"', done.stderr)


if __name__ == "__main__":
    unittest.main()
