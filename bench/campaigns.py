#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""campaigns.py PROGRAM [N]: runs over a site of N campaigns (default 100,000), on the disk of TMPDIR: first, unchanged, ten
changed; and SIGTERM in every phase of a run, which the next run must finish. Time, peak memory of the main process, files."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

MANIFEST = '''format = 1
[campaign]
id = "c{0:07}"
date = 2026-11-03
[machine]
model = "M"
[machine.axes.X]
kind = "linear"
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
[run]
analyses = ["iso230-2"]
outputs = []
'''


def readings(index):
    own = index / 100_000  # no two campaigns with the same readings: a copy is evaluated again when the other one changes
    rows = ["run,direction,target_mm,deviation_um"]
    for run in range(1, 4):
        for direction, targets in (("+", (0, 103, 211, 307)), ("-", (307, 211, 103, 0))):
            rows += [f"{run},{direction},{t},{(t * 7 + index * 13 + run * 5) % 11 / 10 - (direction == '-') + own:.5f}" for t in targets]
    return "\n".join(rows) + "\n"


def make(site, count):
    for k in range(count):
        folder = site / f"{k // 1000:04}" / f"{k:07}"
        folder.mkdir(parents=True)
        (folder / "campaign.toml").write_text(MANIFEST.format(k))
        (folder / "x.csv").write_text(readings(k))


def peak_memory(process):
    """Of the main process alone, in MiB, looked at while it runs."""
    peak = 0.0
    try:
        for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines():
            if line.startswith("VmHWM"):
                peak = int(line.split()[1]) / 1024
    except (OSError, IndexError):
        pass
    return peak


def night(command, stop_at=None):
    """`stop_at`: ("seconds", s) after the start, or ("campaigns", n) when so many are done. Seconds, peak, status, and the seconds
    from SIGTERM to the end."""
    began = time.monotonic()
    process = subprocess.Popen([*command, "--json"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    peak, stopped = 0.0, None

    def stop():
        nonlocal stopped
        stopped = time.monotonic()
        process.send_signal(signal.SIGTERM)

    timer = threading.Timer(stop_at[1], stop) if stop_at and stop_at[0] == "seconds" else None
    if timer:
        timer.start()
    ended = threading.Event()

    def watch():
        nonlocal peak
        while not ended.wait(0.02):
            peak = max(peak, peak_memory(process))

    watcher = threading.Thread(target=watch)
    watcher.start()
    done = 0
    for line in process.stdout:
        done += line.startswith('{"event":"campaign"')
        if stop_at and stop_at[0] == "campaigns" and done == stop_at[1] and stopped is None:
            stop()
    status = process.wait()
    end = time.monotonic()
    ended.set()
    watcher.join()
    if timer:
        timer.cancel()
    return end - began, peak, status, end - stopped if stopped else None


def summary(out):
    return json.loads((out / "summary.json").read_text())["counts"]


def main():
    program, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 100000
    root = pathlib.Path(tempfile.mkdtemp(prefix="nonio-campaigns-"))
    try:
        site, out = root / "site", root / "out"
        make(site, count)
        os.sync()  # otherwise the first flush of a run writes the whole site
        command = [program, "run", str(site), "--out", str(out)]

        def show(name, seconds, peak, status, after=None):
            term = "" if after is None else f", ended {after:.2f} s after SIGTERM"
            print(f"{name}: {seconds:.1f} s, main process {peak:.1f} MiB, status {status}{term}", flush=True)

        def whole(name, changed):
            measured = night(command)
            show(name, *measured)
            counts = summary(out)
            assert (counts["campaigns"], counts["done"], counts["failed"]) == (count, changed, 0), counts
            assert measured[2] == 0
            return measured

        print(f"{count} campaigns, {os.cpu_count()} cores")
        for name, phase in (("first night, SIGTERM while the site is surveyed", ("seconds", 0.5)),
                            ("first night, SIGTERM while campaigns are done", ("campaigns", count // 3))):
            measured = night(command, phase)
            show(name, *measured)
            assert measured[2] == 130, measured
        whole("first night, gone on to its end", count)
        shutil.rmtree(out)
        whole("first night", count)
        unchanged = whole("unchanged night", 0)
        print(f"files in the output folder: {sum(len(files) for _, _, files in os.walk(out))}")
        for k in range(10):
            index = k * 17 % count
            (site / f"{index // 1000:04}" / f"{index:07}" / "x.csv").write_text(readings(index + count))
        whole("ten changed", min(10, count))
        for share in (0.2, 0.5, 0.8, 0.97):
            measured = night(command, ("seconds", unchanged[0] * share))
            show(f"unchanged night, SIGTERM after {share:.0%} of its time", *measured)
            assert measured[2] in (0, 130), measured
        whole("unchanged night after these", 0)
    finally:
        shutil.rmtree(root)


if __name__ == "__main__":
    main()
