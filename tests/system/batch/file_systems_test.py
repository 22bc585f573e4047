# SPDX-License-Identifier: Apache-2.0
"""Real file systems that go wrong: a share (FUSE) whose answers fail or never come, a disk (loop device) that is full, one that takes what it
cannot keep. Needs root and the devices; what is not there is skipped."""
import contextlib
import ctypes
import errno
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

from nightly import NightTest, tree

RUN = '[run]\nanalyses = ["iso230-2"]\noutputs = ["json", "csv", "pdf-report"]\n'
DATE = ("--date", "2026-11-03")
MB = 1 << 20
is_root = os.geteuid() == 0
# Debian's module belongs to Debian's Python.
FUSE_PYTHON = next((p for p in (sys.executable, "/usr/bin/python3")
                    if subprocess.run([p, "-c", "import fuse"], capture_output=True).returncode == 0), None)
has_share = is_root and os.path.exists("/dev/fuse") and FUSE_PYTHON
has_disk = is_root and os.path.exists("/dev/loop-control") and shutil.which("mkfs.ext4")


def run(*args):
    return subprocess.run([str(a) for a in args], capture_output=True, text=True)


def end_with_parent():
    """No share outlives a test that is killed: whoever touches it would hang."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class FileSystems(NightTest):
    def setUp(self):
        super().setUp()
        self.mounted = []
        for name in "abc":
            self.campaign(name, run=RUN)

    def tearDown(self):
        for place in reversed(self.mounted):
            run("umount", "--lazy", place)
        super().tearDown()

    def mount(self, *args, on):
        on.mkdir(exist_ok=True)
        done = run("mount", *args, on)
        if done.returncode != 0:
            self.skipTest("mount is not allowed here: " + done.stderr.strip())
        self.mounted.append(on)

    def left(self):
        return [str(p) for p in self.out.rglob("*") if "nonio-tmp" in p.name or p.name.endswith(".before")]

    # A share.

    @contextlib.contextmanager
    def share(self):
        """The site as a share shows it; gives what makes a call go wrong."""
        folder, mounted = self.site, self.root / "share"
        mounted.mkdir()
        server = subprocess.Popen([FUSE_PYTHON, "-B", pathlib.Path(__file__).with_name("share.py"), folder, mounted],
                                  stderr=subprocess.PIPE, text=True, preexec_fn=end_with_parent)
        faults = folder.with_suffix(".fault")

        def fault(*words):
            if words:
                faults.with_suffix(".new").write_text(" ".join(str(w) for w in words))
                faults.with_suffix(".new").rename(faults)
            else:
                faults.unlink(missing_ok=True)

        try:
            deadline = time.monotonic() + 20
            while not (mounted / "a").exists():
                if server.poll() is not None or time.monotonic() > deadline:
                    server.kill()
                    self.skipTest("no share can be mounted here: " + server.communicate()[1].strip())
                time.sleep(0.05)
            self.site = mounted
            yield fault
        finally:
            self.site = folder
            fault()
            run("umount", "--lazy", mounted)
            server.kill()
            server.wait()
            server.stderr.close()

    @unittest.skipUnless(has_share, "needs root, /dev/fuse and python3-fuse")
    def test_a_share_that_fails_or_hangs(self):
        reference = self.root / "reference"
        (self.site / "site.toml").write_text("[limits]\ndisk_seconds = 2\n")
        with self.share() as fault:
            self.run_nonio(*DATE, out=reference, expect=0)
            for told in (("readdir", "/b", errno.EIO), ("readdir", "/b", "hang"), ("getattr", "/b", errno.ESTALE),
                         ("open", "/b/campaign.toml", errno.ESTALE), ("read", "/b/x.csv", errno.EIO), ("read", "/b/x.csv", "hang")):
                shutil.rmtree(self.out, ignore_errors=True)
                fault(*told)
                how = told[2]
                words = "no answer within 2 s" if how == "hang" else os.strerror(how)
                # A process that waits in the kernel for the share is left behind: neither this run nor the next waits for it.
                for _ in range(2 if how == "hang" else 1):
                    began = time.monotonic()
                    done = self.run_nonio(*DATE, "--quiet", expect=1)
                    self.assertRegex(done.stderr, rf"\bb\b.*{words}", told)
                    self.assertEqual([e["folder"] for e in self.summary()["failed"]], ["b"], told)
                    self.assertEqual(len(self.ids("done") + self.ids("unchanged")), 2, told)
                    self.assertLess(time.monotonic() - began, 30.0, told)
                fault()
                self.run_nonio(*DATE, expect=0)
                self.assertEqual(self.results_in(self.out), self.results_in(reference), told)
            for path in ("/", "/b", "/site.toml", "/b/x.csv"):
                shutil.rmtree(self.out, ignore_errors=True)
                fault("getattr" if "." in path else "readdir", path, "hang")
                night = subprocess.Popen(self.command(*DATE), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                time.sleep(0.7)
                began = time.monotonic()
                night.send_signal(signal.SIGTERM)
                _, words = night.communicate(timeout=60)
                self.assertIn(night.returncode, (130, -signal.SIGTERM), path + ": " + words)
                self.assertLess(time.monotonic() - began, 10.0, path)
                self.assertFalse(self.left())
                fault()

    @staticmethod
    def results_in(out):
        return {k: v for k, v in tree(out).items() if "/" in k and not k.startswith(".nonio") and not k.endswith("run.json")}

    # A disk.

    def undisturbed(self):
        reference = self.root / "reference"
        self.run_nonio(*DATE, out=reference, expect=0)
        return tree(reference)

    def disk(self, image, size):
        with open(image, "wb") as file:
            file.truncate(size)
        made = run("mkfs.ext4", "-q", "-m", "0", "-E", "lazy_itable_init=1", image)
        self.assertEqual(made.returncode, 0, made.stderr)

    def told_and_made_good(self, done, words, make_room, reference):
        """The run reports what happened, and the next one has all results."""
        self.assertIn(done.returncode, (1, 2), done.stderr)
        self.assertRegex(done.stderr, words)
        make_room()
        self.run_nonio(*DATE, expect=0)
        files = {k: v for k, v in tree(self.out).items() if k != "lost+found"}
        self.assertEqual(self.results_in(self.out), {k: v for k, v in reference.items() if k in self.results_in(self.root / "reference")})
        self.assertFalse(self.left())
        self.assertIn("summary.json", files)

    @unittest.skipUnless(has_disk, "needs root, loop devices and mkfs.ext4")
    def test_a_disk_that_is_full(self):
        reference = self.undisturbed()
        image, ballast = self.root / "disk", self.out / "ballast"
        self.disk(image, 8 * MB)
        self.mount("-o", "loop", image, on=self.out)
        for room in (0, 20_000, 60_000, 120_000):
            for old in self.out.iterdir():
                shutil.rmtree(old) if old.is_dir() else old.unlink()
            free = os.statvfs(self.out)
            ballast.write_bytes(b"x" * (free.f_bavail * free.f_frsize - room - 4096))
            done = self.run_nonio(*DATE)
            self.assertFalse(self.left(), done.stderr)
            for report in self.out.rglob("*.pdf"):
                self.assertEqual(report.read_bytes(), reference[str(report.relative_to(self.out))])
            self.told_and_made_good(done, os.strerror(errno.ENOSPC), ballast.unlink, reference)

    @unittest.skipUnless(has_disk, "needs root, loop devices and mkfs.ext4")
    def test_a_disk_that_takes_what_it_cannot_keep(self):
        """A thin one: its file is on a file system that is full, which the kernel finds out when it writes back."""
        reference = self.undisturbed()
        below, image = self.root / "below", self.root / "below" / "disk"
        self.mount("-t", "tmpfs", "-o", "size=12m", "tmpfs", on=below)
        self.disk(image, 64 * MB)
        self.mount("-o", "loop", image, on=self.out)
        run("sync", "--file-system", self.out)
        ballast = below / "ballast"
        with contextlib.suppress(OSError), open(ballast, "wb", buffering=0) as file:
            while True:
                file.write(b"x" * 65536)
        done = self.run_nonio(*DATE)

        def make_room():
            ballast.unlink()
            self.assertEqual(run("umount", self.out).returncode, 0)
            self.assertLess(run("e2fsck", "-fy", image).returncode, 4)
            self.mount("-o", "loop", image, on=self.out)

        self.told_and_made_good(done, "Input/output error|Read-only file system|No space left on device|lost", make_room, reference)


if __name__ == "__main__":
    program = unittest.main(exit=False)
    result = program.result
    if result.wasSuccessful() and result.testsRun == len(result.skipped):
        print("skipped: " + "; ".join(sorted({why for _, why in result.skipped})))
        sys.exit(77)
    sys.exit(not result.wasSuccessful())
