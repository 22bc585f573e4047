#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Accuracy and speed of the statistics of a history, compared with numpy on the same series in the same session.

    python3 bench/history_statistics.py build/ci [TRIALS] [SERIES]

The peer does for SERIES of the series that Nonio was timed with what trend_of does first: least squares, the largest fall of chi-square by a
step, its null simulated with 10,000 draws, a line. Prints both times per series, their ratio, and in how many the chi-square of the level agrees.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy

DRAWS = 10_000


def peer(t, y, u, rng):
    """(chi-square of the level, largest fall by a step, its p, slope)"""
    n = len(t)
    ones = numpy.ones((n, 1)) / u[:, None]
    z = y / u
    q, _ = numpy.linalg.qr(ones)
    level = z - q @ (q.T @ z)
    directions = []
    for k in range(n - 1):
        step = (numpy.arange(n) > k) / u
        rest = step - q[:, 0] * (q[:, 0] @ step)
        directions.append(rest / numpy.linalg.norm(rest))
    directions = numpy.array(directions)
    most = ((directions @ z) ** 2).max()
    null = ((directions @ rng.standard_normal((n, DRAWS))) ** 2).max(axis=0)
    line = numpy.linalg.lstsq(numpy.column_stack([1 / u, t / u]), z, rcond=None)[0]
    return level @ level, most, ((null > most).sum() + 1) / (DRAWS + 1), line[1]


def main():
    build = pathlib.Path(sys.argv[1])
    trials = sys.argv[2] if len(sys.argv) > 2 else "1000"
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 500
    program = next(p for p in build.rglob("bench_history_statistics") if p.is_file())
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "series.csv"
        out = subprocess.run([program, trials, file], check=True, capture_output=True, text=True).stdout
        print(out, end="")
        rows = [[float(x) for x in row] for row in csv.reader(file.open())]
    ours = float(out.split()[-2]) / len(rows)
    rng = numpy.random.default_rng(20261126)
    begin, agree, levels = time.perf_counter(), 0, 0
    for row in rows[:count]:
        points = numpy.array(row[:-3]).reshape(-1, 3)
        chi2 = peer(points[:, 0], points[:, 1], points[:, 2], rng)[0]
        if int(row[-3]) == 1:
            levels += 1
            agree += abs(chi2 - row[-2]) < 1e-9 * max(1.0, chi2)
    theirs = (time.perf_counter() - begin) / count
    print(f"a series: nonio {1e3 * ours:.3f} ms, numpy {numpy.__version__} {1e3 * theirs:.3f} ms, ratio {theirs / ours:.2f}; "
          f"chi-square of the level agrees in {agree} of {levels}")
    return 0 if agree == levels else 1


if __name__ == "__main__":
    sys.exit(main())
