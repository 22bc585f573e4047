# SPDX-License-Identifier: Apache-2.0
"""What the tests of the nightly run share: small sites, and the program under test."""
import json
import os
import pathlib
import random
import signal
import sqlite3
import subprocess
import tempfile
import time
import unittest

NONIO = os.environ["NONIO"]
PLUGINS = pathlib.Path(os.environ["NONIO_TEST_PLUGINS"])


def readings(seed, runs=5, targets=6):
    """An axis with lost motion and noise, as CSV."""
    rng = random.Random(seed)
    rows = ["run,direction,target_mm,deviation_um"]
    for run in range(1, runs + 1):
        for direction in "+-":
            for i in range(targets)[:: 1 if direction == "+" else -1]:
                lost = 4.0 if direction == "-" else 0.0
                rows.append(f"{run},{direction},{i * 50 + i * i},{rng.gauss(i + lost, 0.5):.3f}")
    return "\n".join(rows) + "\n"


def manifest(campaign_id, extra="", run=""):
    return (f'format = 1\n[campaign]\nid = "{campaign_id}"\ndate = 2026-11-03\n'
            f'[machine]\nmodel = "M"\n[machine.axes.X]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm = 0\n'
            f'[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n{run}{extra}')


class NightTest(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="nonio-night-")
        self.root = pathlib.Path(self._folder.name)
        self.site, self.out = self.root / "site", self.root / "out"
        self.site.mkdir()

    def tearDown(self):
        self._folder.cleanup()

    def campaign(self, name, campaign_id=None, text=None, extra="", run="", seed=None):
        folder = self.site / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "campaign.toml").write_text(
            text or manifest(campaign_id or name, extra, run), encoding="utf-8")
        (folder / "x.csv").write_text(readings(seed if seed is not None else name), encoding="utf-8")
        return folder

    def command(self, *args, out=None):
        return [NONIO, "run", str(self.site), "--out", str(out or self.out), *args]

    def run_nonio(self, *args, out=None, expect=None, **kwargs):
        done = subprocess.run(self.command(*args, out=out), capture_output=True, text=True,
                              timeout=300, **kwargs)
        if expect is not None:
            self.assertEqual(done.returncode, expect, done.stderr + done.stdout)
        return done

    def kill_nights(self, kills, seed, check):
        """Kills nights with three changed campaigns of six at random moments, `check` after each. Returns how many nights began."""
        print(f"seed {seed}, {kills} kills", flush=True)
        rng = random.Random(seed)
        for i in range(6):
            self.campaign(f"c{i}")
        self.run_nonio()
        killed, moment, longest = 0, 0, 5.0
        while killed < kills:
            self.assertLess(moment, 20 * kills + 20, "no night could be killed before its end")
            for i in range(3):
                self.campaign(f"c{(moment + i) % 6}", seed=100.0 + 3 * moment + i)
            moment += 1
            start = time.monotonic()
            night = subprocess.Popen(self.command(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                night.wait(rng.uniform(0.0, longest))
                longest = time.monotonic() - start
                continue
            except subprocess.TimeoutExpired:
                os.killpg(night.pid, signal.SIGKILL)
                night.wait()
            killed += 1
            check(f"kill {killed}")
        return moment

    def results(self, campaign_id, out=None):
        return json.loads(((out or self.out) / campaign_id / "results.json").read_text("utf-8"))

    def summary(self, out=None):
        return json.loads(((out or self.out) / "summary.json").read_text("utf-8"))

    def ids(self, section, out=None):
        return [entry["id"] for entry in self.summary(out)[section]]

    def reason(self, section, campaign_id):
        return next(e["reason"] for e in self.summary()[section] if e["id"] == campaign_id)


def rows_of(store):
    """What a database says; how its pages lie depends on how it grew."""
    database = sqlite3.connect(f"file:{store}?mode=ro", uri=True)
    try:
        return "\n".join(database.iterdump()).encode()
    finally:
        database.close()


def tree(folder):
    """Every file below a folder with its bytes, of a database its rows."""
    folder = pathlib.Path(folder)
    return {str(p.relative_to(folder)): rows_of(p) if p.suffix == ".sqlite" else p.read_bytes()
            for p in folder.rglob("*") if p.is_file()}


def given_out(folder):
    """Without the mark of the process that uses the folder: a run that was killed leaves its mark, and the next run
    takes it over (night.locks)."""
    files = tree(folder)
    files.pop(".nonio/user", None)
    return files
