# SPDX-License-Identifier: Apache-2.0
"""What is given out stays right whatever the disk, the terminal and other programs do meanwhile."""
import errno
import fcntl
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import threading
import time
import unittest

from nightly import NONIO, NightTest, given_out, readings, tree

SHIM = os.environ["NONIO_FAULT_SHIM"]
KILLS = int(os.environ.get("NONIO_KILLS", "8"))
SEED = int(os.environ.get("NONIO_SEED", "20261122"))


def fault(what, main=False):
    return {**os.environ, "LD_PRELOAD": SHIM, "NONIO_FAULT": what, **({"NONIO_FAULT_IN": "main"} if main else {})}


class Durable(NightTest):
    def left(self):
        return [str(p) for p in self.out.rglob("*") if "nonio-tmp" in p.name or p.name.endswith(".before")]

    def status(self, *args):
        return subprocess.run([NONIO, "status", str(self.out), *args], capture_output=True, text=True, timeout=60)

    def test_no_unlink_no_broken_summary(self):
        self.campaign("a")
        self.campaign("b", text="no manifest")
        done = self.run_nonio(env=fault(f"unlink:1:{errno.EPERM}:1000000"), expect=1)
        self.assertEqual(1, self.summary()["counts"]["failed"])
        self.assertEqual(["a"], self.ids("done"), done.stderr)

    def test_a_campaign_folder_may_have_any_name(self):
        self.campaign("list.nonio-tmp")
        self.run_nonio(expect=0)
        self.assertTrue((self.out / "list.nonio-tmp" / "results.json").exists())

    def test_renames_that_fail_leave_nothing(self):
        self.campaign("a")
        for times in (1, 1000):  # the summary's too
            for n in range(1, 12):
                shutil.rmtree(self.out, ignore_errors=True)
                done = self.run_nonio(env=fault(f"rename:{n}:{errno.EIO}:{times}"))
                self.assertIn(done.returncode, (1, 2), done.stderr) if n < 8 else None
                self.assertFalse(self.left(), (n, times))
                self.run_nonio(expect=0)

    def test_sighup_ends_as_sigterm_does(self):
        for i in range(30):
            self.campaign(f"c{i:02}")
        process = subprocess.Popen(self.command(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(0.3)
        process.send_signal(signal.SIGHUP)
        _, errors = process.communicate(timeout=60)
        self.assertIn(process.returncode, (0, 130), errors)
        self.assertFalse(self.left())
        self.run_nonio(expect=0)

    def test_nohup_is_obeyed(self):
        for i in range(10):
            self.campaign(f"c{i:02}")
        process = subprocess.Popen(["nohup", *self.command()], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(0.2)
        process.send_signal(signal.SIGHUP)
        self.assertEqual(0, process.wait(60))

    def test_a_disk_without_locks_is_called_that(self):
        self.campaign("a")
        done = self.run_nonio(env=fault(f"flock:1:{errno.ENOLCK}:100"), expect=2)
        self.assertIn("No locks available", done.stderr)
        self.assertNotIn("another run", done.stderr)

    def test_another_run_is_called_that(self):
        self.campaign("a")
        self.run_nonio(expect=0)
        with open(self.out / ".nonio" / "lock") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertIn("another run", self.run_nonio(expect=2).stderr)
            self.assertEqual(0, self.status().returncode)  # the last run is complete

    def test_readings_rewritten_in_place_are_of_one_state(self):
        folder = self.campaign("a", run='[run]\nanalyses = ["iso230-2"]\noutputs = ["json"]\n')
        states = [readings(k, runs=40, targets=200) for k in "xy"]
        size = max(map(len, states))
        states = [s + "#" * (size - len(s)) + "\n" for s in states]
        wanted = set()
        for state in states:
            (folder / "x.csv").write_text(state)
            self.run_nonio("--force", expect=0)
            wanted.add(json.dumps(self.results("a")["analyses"]))
        ended = threading.Event()

        def rewrite():
            rng = random.Random(SEED)
            with open(folder / "x.csv", "r+b", buffering=0) as file:
                while not ended.is_set():
                    file.seek(0)
                    file.write(rng.choice(states).encode())
                    time.sleep(rng.uniform(0.0, 0.02))

        writer = threading.Thread(target=rewrite)
        writer.start()
        try:
            for _ in range(8):
                done = self.run_nonio("--force")
                if done.returncode == 0:
                    self.assertIn(json.dumps(self.results("a")["analyses"]), wanted)
                else:
                    self.assertIn("another process is writing to it", done.stderr)
        finally:
            ended.set()
            writer.join()

    def test_verify_results_finds_what_keeps_size_and_time(self):
        self.campaign("a")
        self.run_nonio(expect=0)
        good = tree(self.out / "a")
        path = self.out / "a" / "values.csv"
        stat = path.stat()
        path.write_bytes(path.read_bytes()[:-3] + b"9\r\n"[-3:])
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
        self.assertNotEqual(good["values.csv"], path.read_bytes())
        self.run_nonio(expect=0)
        self.assertEqual(["a"], self.ids("unchanged"))
        self.run_nonio("--verify-results", expect=0)
        self.assertEqual("values.csv was changed in the output", self.reason("done", "a"))
        self.assertEqual(good["values.csv"], path.read_bytes())

    def test_lost_writes_are_no_results(self):
        self.campaign("a")
        self.run_nonio("--date", "2026-11-03", expect=0)
        good = given_out(self.out)
        lost = 0
        for n in range(1, 40):
            shutil.rmtree(self.out)
            done = self.run_nonio("--date", "2026-11-03", env=fault(f"write:{n}:LOST"))
            lost += done.returncode == 1 and "does not give back" in done.stderr
            if done.returncode == 0:
                self.assertEqual(good, given_out(self.out), n)
        self.assertGreater(lost, 3)

    def test_a_flush_that_fails_fails_all_that_is_staged(self):
        for name in "abc":
            self.campaign(name)
        done = self.run_nonio("--jobs", "3", env=fault(f"syncfs:1:{errno.EIO}"), expect=1)
        self.assertIn("cannot flush the disk", done.stderr)
        self.run_nonio(expect=0)

    def test_what_the_disk_reports_only_once_is_heard(self):
        """An error of the disk after the first results were written, before anybody flushes them."""
        for name in "abc":
            self.campaign(name)
        counts = self.root / "counts"
        self.run_nonio("--jobs", "3", env={**os.environ, "LD_PRELOAD": SHIM, "NONIO_FAULT_COUNTS": str(counts)}, expect=0)
        writes = int(dict(line.split() for line in counts.read_text().splitlines())["write"])
        good = {k: v for k, v in tree(self.out).items() if k.endswith("results.json")}
        heard = 0
        for n in range(1, writes, max(1, writes // 12)):
            shutil.rmtree(self.out)
            done = self.run_nonio("--jobs", "3", env=fault(f"write:{n}:LATE"))
            heard += done.returncode == 1 and "cannot flush the disk" in done.stderr
            self.run_nonio(expect=0)
            self.assertEqual(good, {k: v for k, v in tree(self.out).items() if k.endswith("results.json")})
        self.assertGreater(heard, 5)

    def test_a_failure_that_passes_leaves_the_last_good_result(self):
        self.campaign("a")
        self.run_nonio("--date", "2026-11-03", expect=0)
        good = {k: v for k, v in tree(self.out / "a").items()}
        for date in ("2026-11-04", "2026-11-05"):
            self.campaign("a", seed=date)
            done = self.run_nonio("--date", date, env=fault(f"fork:7:{errno.EAGAIN}:100000"), expect=1)
            self.assertIn("no process for a worker", done.stderr)
            self.assertEqual("failed", self.results("a")["status"])
            self.assertEqual(["last-good", "results.json", "run.json"], sorted(os.listdir(self.out / "a")))
            self.assertEqual(good, tree(self.out / "a" / "last-good"))
            entry = self.summary()["failed"][0]
            self.assertEqual({"night": 2, "date": "2026-11-04"}, entry["failed_since"])
            self.assertEqual({"night": 1, "date": "2026-11-03", "status": "ok" if "ok" in entry["last_good"]["status"]
                              else "attention", "folder": "a/last-good"}, entry["last_good"])
        self.assertIn("failed since run 2 of 2026-11-04", (self.out / "summary.txt").read_text())
        self.run_nonio(expect=0)
        self.assertFalse((self.out / "a" / "last-good").exists())

    def test_a_moment_without_processes_costs_nothing(self):
        self.campaign("a")
        self.run_nonio(env=fault(f"fork:3:{errno.EAGAIN}:3"), expect=0)

    def test_the_summary_has_the_number_of_the_run(self):
        self.campaign("a")
        self.run_nonio("--date", "2026-11-03", expect=0)
        self.campaign("b")
        self.run_nonio("--date", "2026-11-04", expect=0)
        summary = self.summary()
        self.assertEqual((2, "2026-11-04", {"tonight": 2, "night_before": 1}),
                         (summary["night"], summary["date"], summary["seen"]))
        self.assertIn("Run 2 of 2026-11-04; 2 campaigns seen, 1 in the previous run",
                      (self.out / "summary.txt").read_text())
        self.assertIn("--date", self.run_nonio("--date", "2026-02-30", expect=2).stderr)

    def test_status(self):
        self.assertEqual(2, self.status().returncode)
        self.campaign("a")
        self.run_nonio("--date", "2026-11-03", expect=0)
        done = self.status()
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"^run 1 of 2026-11-03 is complete, 0\.0 h ago: 1 campaign, 0 failed\n")
        self.assertEqual("", self.status("--quiet").stdout)
        old = time.time() - 40 * 3600
        os.utime(self.out / "summary.json", (old, old))
        self.assertEqual(1, self.status().returncode)
        self.assertEqual(0, self.status("--max-age", "48").returncode)
        said = json.loads(self.status("--json").stdout)
        self.assertEqual((False, 1, "complete"), (said["well"], said["night"], said["state"]))
        self.run_nonio("--force", env=fault("rename:3:KILL", main=True))
        done = self.status("--max-age", "0")
        self.assertEqual(1, done.returncode)
        self.assertIn("run 2", done.stdout)
        self.assertIn("did not end", done.stdout)

    def test_kill_9_in_changed_and_forced_runs(self):
        """The place of each kill is a call that changes the disk: no timing can miss it."""
        rng = random.Random(SEED)
        print(f"seed {SEED}, {KILLS} kills", flush=True)
        run = '[run]\noutputs = ["json", "csv"]\n'
        for name in "abcd":
            self.campaign(name, run=run)
        before = self.root / "before"
        self.run_nonio("--date", "2026-11-03", out=before, expect=0)
        os.remove(before / "d" / "values.csv")  # a reason that only the output shows
        self.campaign("a", run=run, seed="other")
        self.campaign("b", run='[run]\noutputs = ["json"]\n')  # files that go away
        for args in (["--date", "2026-11-04"], ["--date", "2026-11-04", "--force"]):
            reference = self.root / "reference"
            shutil.rmtree(reference, ignore_errors=True)
            subprocess.run(["cp", "-a", str(before), str(reference)], check=True)
            self.run_nonio(*args, out=reference, expect=0)
            for _ in range(KILLS):
                shutil.rmtree(self.out, ignore_errors=True)
                subprocess.run(["cp", "-a", str(before), str(self.out)], check=True)
                where = f"{rng.choice(['rename', 'unlink', 'syncfs', 'write'])}:{rng.randint(1, 24)}:KILL"
                for again in range(2):
                    if self.run_nonio(*args, env=fault(where)).returncode == 0:
                        break
                    where = f"rename:{rng.randint(1, 10)}:KILL"
                deadline = time.monotonic() + 30  # what the killed process started ends a moment later
                while json.loads(self.status("--json").stdout)["state"] == "running":
                    self.assertLess(time.monotonic(), deadline, "a process of the killed run goes on")
                    time.sleep(0.05)
                self.run_nonio(*args[:2], expect=0) if self.status("--max-age", "0").returncode else None
                a, b = given_out(reference), given_out(self.out)
                self.assertTrue(a == b, f"{args} {where}: {[k for k in a.keys() | b.keys() if a.get(k) != b.get(k)]}")

    @unittest.skipIf("NONIO_TEST_NO_MEMORY_LIMIT" in os.environ, "malloc is the sanitizer's")
    def test_memory_that_is_refused_in_the_main_process(self):
        """At random places of a run: a message and a status, never a crash, never other bytes with status 0."""
        self.campaign("a", run='[run]\noutputs = ["json"]\n')
        self.run_nonio("--date", "2026-11-03", "--jobs", "1", expect=0)
        good = given_out(self.out)
        counts = self.root / "counts"
        shutil.rmtree(self.out)
        self.run_nonio("--jobs", "1", env={**fault(f"malloc:1000000000:{errno.ENOMEM}", True),
                                           "NONIO_FAULT_COUNTS": str(counts)}, expect=0)
        calls = int(dict(line.split() for line in counts.read_text().splitlines())["malloc"])
        places = int(os.environ.get("NONIO_PLACES", "24"))
        rng = random.Random(SEED)
        for n in sorted(rng.sample(range(1, calls), places)):
            for times in (1, 100000):
                shutil.rmtree(self.out, ignore_errors=True)
                done = self.run_nonio("--date", "2026-11-03", "--jobs", "1",
                                      env=fault(f"malloc:{n}:{errno.ENOMEM}:{times}", True))
                self.assertIn(done.returncode, (0, 1, 2), f"{n}: {done.stderr}")
                if done.returncode == 0:
                    self.assertEqual(good, given_out(self.out), n)
                else:
                    self.assertTrue(done.stderr, n)


if __name__ == "__main__":
    unittest.main()
