# SPDX-License-Identifier: Apache-2.0
"""Killed, interrupted, out of disk: the next run ends with the bytes of an undisturbed one."""
import json
import os
import random
import signal
import subprocess
import time
import unittest

from nightly import NightTest, tree

KILLS = int(os.environ.get("NONIO_KILLS", "8"))
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

    def test_kill_9_at_random_moments(self):
        print(f"seed {SEED}, {KILLS} kills", flush=True)
        rng = random.Random(SEED)
        reference, seconds = self.undisturbed()
        hit = 0
        for k in range(KILLS):
            out = self.root / f"killed-{k}"
            # Some are killed twice before they may end.
            for _ in range(rng.choice((1, 1, 2))):
                process = subprocess.Popen(self.command(out=out), stdout=subprocess.DEVNULL,
                                           stderr=subprocess.DEVNULL)
                time.sleep(rng.uniform(0.0, seconds))
                hit += process.poll() is None
                process.kill()
                process.wait()
                if self.ended(out):
                    break
            if not self.ended(out):  # else the last moment was after its end
                self.run_nonio(out=out, expect=0)
            self.assertTrue(reference == tree(out), f"kill {k}: {self.differences(reference, tree(out))}")
        self.assertGreater(hit, KILLS // 2)  # else nothing was interrupted

    def test_ctrl_c_ends_cleanly_and_resumes(self):
        reference, seconds = self.undisturbed()
        process = subprocess.Popen(self.command(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(seconds * 0.6)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertIn("interrupted", errors)
        self.assertFalse([p for p in self.out.rglob("*.nonio-tmp")])
        self.run_nonio(expect=0)
        self.assertTrue(reference == tree(self.out), self.differences(reference, tree(self.out)))

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
