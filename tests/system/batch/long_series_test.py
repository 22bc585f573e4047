# SPDX-License-Identifier: Apache-2.0
"""Measurements of very many targets or runs: memory per reading is bounded, and no digit of a mean is lost."""
import fractions
import os
import random
import subprocess
import unittest

from nightly import NightTest


def readings(runs, targets):
    """Rows of an axis, and the readings of each target and direction in thousandths of a micrometre."""
    rng = random.Random(20261128)
    rows, values = ["run,direction,target_mm,deviation_um"], {}
    for run in range(1, runs + 1):
        for direction in "+-":
            for i in range(targets)[:: 1 if direction == "+" else -1]:
                value = round(rng.gauss(1000.0 * (i % 7) - (4000.0 if direction == "-" else 0.0), 400.0))
                values.setdefault((i, direction), []).append(value)
                rows.append(f"{run},{direction},{10 * i},{value / 1000:.3f}")
    return "\n".join(rows) + "\n", values


class LongSeriesTest(NightTest):
    def series(self, name, runs, targets):
        text, values = readings(runs, targets)
        (self.campaign(name) / "x.csv").write_text(text, "utf-8")
        return values

    def memory(self, runs):
        """Of the largest process, in bytes."""
        self.series("many-runs", runs, 20)
        process = subprocess.Popen(self.command("--quiet", "--jobs", "1"), stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return 1024 * used.ru_maxrss

    @unittest.skipIf("NONIO_TEST_NO_MEMORY_LIMIT" in os.environ, "the address space is the sanitizer's")
    def test_32000_targets_fit_into_500_MB(self):
        self.series("many-targets", 2, 32000)
        (self.site / "site.toml").write_text("[limits]\nmemory_MB = 500\n")
        self.run_nonio(expect=0)
        self.assertEqual(len(self.results("many-targets")["analyses"][0]["points"]), 32000)

    @unittest.skipIf("NONIO_TEST_NO_MEMORY_LIMIT" in os.environ, "the memory is the sanitizer's")
    def test_memory_of_a_reading_does_not_depend_on_the_number_of_runs(self):
        few, some, many = (self.memory(runs) for runs in (1000, 3000, 7000))
        self.assertLess((some - few) / (2000 * 40), 600)
        self.assertLess((many - some) / (4000 * 40), 600)

    def test_no_digit_is_lost_in_3000_runs(self):
        values = self.series("many-runs", 3000, 20)
        self.run_nonio(expect=0)
        points = self.results("many-runs")["analyses"][0]["points"]
        for (i, direction), of_target in values.items():
            mean = fractions.Fraction(sum(of_target), 1000 * len(of_target))
            self.assertEqual(points[i]["mean" + direction], float(f"{float(mean):.12g}"), f"target {i}, {direction}")
            self.assertEqual(points[i]["n" + direction], 3000)


if __name__ == "__main__":
    unittest.main()
