# SPDX-License-Identifier: Apache-2.0
"""A worker does many campaigns, and no result shows which one did it, or after what."""
import contextlib
import os
import pathlib
import signal
import subprocess
import unittest

from nightly import PLUGINS, NightTest, manifest, tree

ALL = ('[run]\nanalyses = ["iso230-2", "vdi-dgq-3441"]\noutputs = ["json", "csv", "pdf-report", '
       '"siemens-840d", "heidenhain-tnc", "fanuc", "linuxcnc"]\n')


def children(pid):
    return [int(p) for p in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


class Workers(NightTest):
    def site_of(self, number):
        for i in range(number):
            self.campaign(f"c{i:03}", run=ALL)

    def test_one_worker_for_many_is_as_a_process_for_each(self):
        self.site_of(70)  # more than one worker does
        self.campaign("c005x", text=manifest("c005x").replace("linear", "lineal"))
        self.campaign("c030", run=ALL + '[options.pdf-report]\nlanguage = "it"\n')
        fresh = self.root / "fresh"
        self.run_nonio("--jobs", "1", expect=1)
        # A plugin from elsewhere, even one that no campaign calls, gives each its own process.
        self.run_nonio("--plugin-path", str(PLUGINS / "bad"), out=fresh, expect=1)

        def results(out):
            return {k: v for k, v in tree(out).items() if not k.endswith("run.json")}
        one, other = results(self.out), results(fresh)
        self.assertGreater(len(one), 70 * 10)
        self.assertEqual(sorted(k for k in one.keys() | other.keys() if one.get(k) != other.get(k)), [])

    def test_killed_worker_costs_no_campaign(self):
        self.site_of(60)
        reference = self.root / "reference"
        self.run_nonio("--jobs", "1", out=reference, expect=0)
        for trial in range(20):  # until one is not over before its processes are killed
            out = self.root / f"killed-{trial}"
            run = subprocess.Popen(self.command("--jobs", "1", out=out), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
            while run.poll() is None and not any(out.glob("*/run.json")):
                pass
            killed = []
            for process in children(run.pid):  # plugins are loaded, evaluate; one has the files, one stores
                with contextlib.suppress(ProcessLookupError):  # it had just ended
                    os.kill(process, signal.SIGKILL)
                    killed.append(process)
            _, errors = run.communicate(timeout=120)
            if len(killed) == 4:
                break
        self.assertEqual(len(killed), 4)
        self.assertEqual(run.returncode, 0, errors)
        self.assertTrue(tree(reference) == tree(out))


if __name__ == "__main__":
    unittest.main()
