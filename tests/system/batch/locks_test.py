# SPDX-License-Identifier: Apache-2.0
"""Who may use an output folder: one process of all hosts. Another host is a file that another host would have left."""
import json
import os
import pathlib
import signal
import subprocess
import time
import unittest

from nightly import NONIO, NightTest

BOOT = pathlib.Path("/proc/sys/kernel/random/boot_id").read_text().strip()
try:
    MACHINE = pathlib.Path("/etc/machine-id").read_text().strip()
except OSError:
    MACHINE = ""


class LockTest(NightTest):
    def setUp(self):
        super().setUp()
        self.campaign("a")
        self.user = self.out / ".nonio/user"
        self.user.parent.mkdir(parents=True)

    def left(self, host="elsewhere", boot="0-1", machine="m", job="", pid=17):
        self.user.write_text(json.dumps({"host": host, "pid": pid, "job": job, "machine": machine, "boot": boot}) + "\n")
        return self.user.read_bytes()

    def night(self, *args):
        return subprocess.run([NONIO, "night", *args], capture_output=True, text=True, timeout=60)

    def test_a_folder_that_another_host_uses_is_refused_and_named(self):
        said = self.left(job="7.0")
        for args in ([], ["--force"]):
            done = self.run_nonio(*args, expect=2)
            self.assertIn("process 17 on host elsewhere (job 7.0) is using the output folder", done.stderr)
            self.assertIn(f"nonio run unlock {self.out}", done.stderr)
        planned = self.night("plan", str(self.site), "--out", str(self.out), "--shards", "2")
        self.assertEqual(planned.returncode, 2, planned.stderr)
        self.assertEqual(self.user.read_bytes(), said)
        self.assertEqual(sorted(p.name for p in self.out.rglob("*") if p.is_file()), ["lock", "user"])

    def test_a_shard_does_not_depend_on_it(self):
        self.assertEqual(self.night("plan", str(self.site), "--out", str(self.out), "--shards", "1").returncode, 0)
        self.left()
        self.run_nonio("--shard", "0/1", expect=0)

    def test_a_file_that_cannot_be_understood_is_believed(self):
        for text in ("", "{}", "[1]", "{\"host\": 3, \"boot\": null}", "\xff", "{" * 5000):
            self.user.write_text(text, encoding="latin-1")
            self.assertIn("a process of unknown name is using", self.run_nonio(expect=2).stderr)
        self.assertEqual(self.night("unlock", str(self.out)).returncode, 0)
        self.run_nonio(expect=0)
        self.assertFalse(self.user.exists())

    def test_what_this_host_left_is_taken_over(self):
        self.left(boot=BOOT)
        (self.out / f".nonio/user-{BOOT.split('-')[0]}-abc").write_text("half")
        (self.out / ".nonio/user-fedcba98-abc").write_text("of another host")
        machine, host = pathlib.Path("/etc/machine-id"), os.uname().nodename
        if machine.is_file() and machine.read_text().strip():
            (self.out / ".nonio/user-01234567-abc").write_text(json.dumps(
                {"host": host, "pid": 17, "job": "", "machine": machine.read_text().strip(), "boot": "01234567-of-an-earlier-boot"}) + "\n")
        (self.out / ".nonio/user-89abcdef-abc").write_text(json.dumps(
            {"host": host, "pid": 17, "job": "", "machine": "m", "boot": "89abcdef-of-another-machine"}) + "\n")
        self.run_nonio(expect=0)
        self.assertEqual(sorted(p.name for p in self.user.parent.iterdir() if "user" in p.name), ["user-89abcdef-abc", "user-fedcba98-abc"])

    @unittest.skipUnless(MACHINE, "this host has no /etc/machine-id")
    def test_a_lock_of_this_host_before_its_restart_is_stale(self):
        self.left(host=os.uname().nodename, machine=MACHINE)
        self.run_nonio(expect=0)
        self.left(host="of the same image", machine=MACHINE)
        self.run_nonio(expect=2)

    def test_no_machine_and_no_boot_are_not_equal(self):
        self.left(host=os.uname().nodename, machine="", boot="")
        self.run_nonio(expect=2)

    def test_unlock_by_a_list_of_jobs(self):
        alive = self.root / "alive"
        alive.write_text("70.0\n7.1\n77.0\n")
        ask = ("unlock", str(self.out), "--alive", str(alive))
        self.left(job="")
        self.assertIn("was not started by a batch job", self.night(*ask).stderr)
        self.left(job="7.1")
        done = self.night(*ask)
        self.assertEqual(done.returncode, 2)
        self.assertIn("its job is alive", done.stderr)
        self.left(job="7.0")  # the scheduler has started it again
        done = self.night(*ask)
        self.assertEqual((done.returncode, self.user.exists()), (0, False), done.stderr)
        self.assertIn("it was used by process 17 on host elsewhere (job 7.0)", done.stderr)
        self.assertIn("the output folder is not in use", self.night(*ask).stderr)

    def test_a_run_in_progress_is_named_and_not_unlocked_and_leaves_nothing(self):
        for i in range(8):
            self.campaign(f"c{i}")
        running = subprocess.Popen(self.command(), env={**os.environ, "NONIO_JOB": "5.0"}, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        try:
            end = time.monotonic() + 60
            while not self.user.exists() or not (self.out / ".nonio/night.json").exists():
                self.assertLess(time.monotonic(), end)
                self.assertIsNone(running.poll())
            running.send_signal(signal.SIGSTOP)
            said = json.loads(self.user.read_text())
            self.assertEqual((said["pid"], said["host"], said["job"], said["boot"]),
                             (running.pid, os.uname().nodename, "5.0", BOOT))
            status = subprocess.run([NONIO, "status", str(self.out), "--json"], capture_output=True, text=True, timeout=60)
            status = json.loads(status.stdout)
            name = f"process {running.pid} on host {os.uname().nodename} (job 5.0)"
            self.assertEqual((status["state"], status["used_by"]), ("running", name))
            done = self.night("unlock", str(self.out))
            self.assertEqual(done.returncode, 2)
            self.assertIn("so it is not gone", done.stderr)
            self.assertTrue(self.user.exists())
        finally:
            running.send_signal(signal.SIGCONT)
            running.wait(120)
        self.assertEqual(running.returncode, 0)
        self.assertFalse(self.user.exists())

    def test_a_killed_run_is_resumed(self):
        running = subprocess.Popen(self.command(), stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        while not self.user.exists() and running.poll() is None:
            pass
        running.kill()
        running.wait(60)
        self.run_nonio(expect=0)
        self.assertFalse(self.user.exists())


if __name__ == "__main__":
    unittest.main()
