# SPDX-License-Identifier: Apache-2.0
"""Killed, interrupted, out of disk: the next run ends with the bytes of an undisturbed one."""
import json
import os
import random
import shutil
import signal
import subprocess
import time
import unittest

from nightly import NightTest, tree

KILLS = int(os.environ.get("NONIO_KILLS", "8"))
TERMS = int(os.environ.get("NONIO_TERMS", "12"))
SEED = int(os.environ.get("NONIO_SEED", "20261121"))


class Interruption(NightTest):
    def setUp(self):
        super().setUp()
        for i in range(24):
            self.campaign(f"c{i:02}")

    def undisturbed(self):
        reference = self.root / "reference"
        began = time.monotonic()
        self.run_nonio(out=reference, expect=0)
        return tree(reference), time.monotonic() - began

    @staticmethod
    def ended(out):
        state = out / ".nonio" / "night.json"
        return state.exists() and json.loads(state.read_text())["state"] == "complete"

    @staticmethod
    def differences(a, b):
        return sorted(k for k in a.keys() | b.keys() if a.get(k) != b.get(k))

    def kill_somewhere(self, out, rng):
        """Kills a run at a random moment; false if it had ended before. A run may be quicker than the one
        that was timed (another load on the machine), so moments are drawn from its shortest time so far."""
        began = time.monotonic()
        process = subprocess.Popen(self.command(out=out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            process.wait(rng.uniform(0.0, self.seconds))
            self.seconds = min(self.seconds, time.monotonic() - began)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        return process.returncode == -signal.SIGKILL

    def test_kill_9_at_random_moments(self):
        print(f"seed {SEED}, {KILLS} kills", flush=True)
        rng = random.Random(SEED)
        reference, self.seconds = self.undisturbed()
        for k in range(KILLS):
            for trial in range(100):
                out = self.root / f"killed-{k}-{trial}"
                if self.kill_somewhere(out, rng):
                    break
            else:
                self.fail("no run could be killed before its end")
            # Some are killed twice before they may end; what had ended already would begin another night.
            if rng.random() < 0.3 and not self.ended(out):
                self.kill_somewhere(out, rng)
            if not self.ended(out):
                self.run_nonio(out=out, expect=0)
            self.assertTrue(reference == tree(out), f"kill {k}: {self.differences(reference, tree(out))}")

    def test_sigterm_at_random_moments(self):
        """First and forced runs in turn: the run ends soon and leaves nothing behind, the next one has the same bytes."""
        print(f"seed {SEED}, {TERMS} SIGTERMs", flush=True)
        rng = random.Random(SEED)
        before = self.root / "before"
        args = {"first": ["--date", "2026-11-03"], "forced": ["--date", "2026-11-04", "--force"]}
        self.run_nonio(*args["first"], out=before, expect=0)
        references, ends = {}, {}
        for how in args:
            out = self.as_before(how, before)
            began = time.monotonic()
            self.run_nonio(*args[how], out=out, expect=0)
            references[how] = tree(out), time.monotonic() - began
        for k in range(TERMS):
            how = ("first", "forced")[k % 2]
            out = self.as_before(how, before)
            reference, seconds = references[how]
            night = subprocess.Popen(self.command(*args[how], out=out), stdout=subprocess.DEVNULL,
                                     stderr=subprocess.PIPE, text=True)
            # The later ones are there for nights that are quicker than the one that was timed.
            time.sleep(seconds * (k + rng.random()) / TERMS)
            began = time.monotonic()
            night.send_signal(signal.SIGTERM)
            _, errors = night.communicate(timeout=120)
            told = f"{how}, SIGTERM {k}: status {night.returncode} after {time.monotonic() - began:.2f} s: {errors}"
            # Before it can catch a signal it ends by it.
            self.assertIn(night.returncode, (0, 130, -signal.SIGTERM), told)
            self.assertLess(time.monotonic() - began, 10.0, told)
            self.assertEqual([str(p) for p in out.rglob("*nonio-tmp*")], [], told)
            if night.returncode == 130:
                self.assertIn("interrupted", errors)
            if night.returncode != 0:
                self.run_nonio(*args[how], out=out, expect=0)
            self.assertTrue(tree(out) == reference, f"{told}: other {self.differences(reference, tree(out))}")
            ends[night.returncode] = ends.get(night.returncode, 0) + 1
        print(f"status and how often: {ends}", flush=True)
        self.assertIn(130, ends, "no night was interrupted")

    def as_before(self, how, before):
        out = self.root / "out"
        shutil.rmtree(out, ignore_errors=True)
        if how == "forced":
            shutil.copytree(before, out)
        return out

    def test_ctrl_c_ends_cleanly_and_resumes(self):
        reference, seconds = self.undisturbed()
        for trial in range(20):  # until one is quick enough for a run that may be quicker than the first
            out = self.root / f"interrupted-{trial}"
            process = subprocess.Popen(self.command(out=out), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                       text=True)
            time.sleep(seconds * 0.6 * 0.8 ** trial)
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=120)
            if process.returncode != 0 and "interrupted" in errors:
                break
        self.assertEqual(process.returncode, 130, errors)
        self.assertIn("interrupted", errors)
        self.assertFalse([p for p in out.rglob("*.nonio-tmp")])
        self.run_nonio(out=out, expect=0)
        self.assertTrue(reference == tree(out), self.differences(reference, tree(out)))

    @unittest.skipUnless(os.geteuid() == 0, "a small file system needs root to mount")
    def test_disk_full(self):
        self.out.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", str(self.out)],
                                 capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("mount is not allowed here")
        try:
            done = self.run_nonio(expect=1)
            self.assertIn("No space left on device", done.stderr)
            self.assertFalse([p for p in self.out.rglob("*.nonio-tmp")])
            for results in self.out.rglob("results.json"):
                self.assertTrue(results.read_text().endswith("}\n"), results)
            for report in self.out.rglob("*.pdf"):
                self.assertTrue(report.read_bytes().rstrip().endswith(b"%%EOF"), report)
        finally:
            subprocess.run(["umount", str(self.out)], check=True)


if __name__ == "__main__":
    unittest.main()
