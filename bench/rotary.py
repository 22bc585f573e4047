# SPDX-License-Identifier: Apache-2.0
"""rotary.py BENCH_ROTARY [POINTS]: circles per second on one core, compared with numpy doing the same: plane
by SVD, start by lstsq, Gauss-Newton by lstsq, covariance. CPU time of both, in the same session."""
import os
import re
import subprocess
import sys
import time

import numpy as np


def fit(points):
    mean = points.mean(axis=0)
    axes = np.linalg.svd(points - mean, full_matrices=False)[2]
    flat = (points - mean) @ axes.T
    u, v, h = flat.T
    one = np.ones_like(u)
    a, b, c = np.linalg.lstsq(np.column_stack([2 * u, 2 * v, one]), u * u + v * v, rcond=None)[0]
    x = np.array([a, b, np.sqrt(c + a * a + b * b)])
    while True:
        du, dv = u - x[0], v - x[1]
        rho = np.hypot(du, dv)
        J = np.column_stack([-du / rho, -dv / rho, -one])
        step = np.linalg.lstsq(J, x[2] - rho, rcond=None)[0]
        x = x + step
        if np.abs(step).max() <= 1e-11 * x[2]:
            break
    cov = np.linalg.inv(J.T @ J)
    G = np.column_stack([u, v, one])
    tilt = np.linalg.inv(G.T @ G)
    g = np.array([x[0], x[1], 1.0])
    s2 = ((rho - x[2]) ** 2 + h ** 2).sum() / (2 * len(u) - 6)
    return mean + x[0] * axes[0] + x[1] * axes[1], s2 * cov, s2 * tilt, s2 * g @ tilt @ g


def main():
    bench, points = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 8
    os.sched_setaffinity(0, {0})
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    angle = 2 * np.pi * np.arange(points) / points
    exact = np.column_stack([0.261 * np.cos(angle), 0.261 * np.sin(angle), 0 * angle]) + [0.102532, 0.05123, 0.128947]
    random = np.random.default_rng(1)
    circles = [exact + random.normal(0.0, 10e-6, exact.shape) for _ in range(3000)]
    began = time.process_time()
    for circle in circles:
        fit(circle)
    peer = len(circles) / (time.process_time() - began)
    out = subprocess.run([bench, "100000", str(points)], capture_output=True, text=True, check=True).stdout
    ours = float(re.search(r"geometric: (\d+)", out).group(1))
    print(f"{points} points: nonio {ours:.0f}, numpy {peer:.0f} circles/s of CPU time: {ours / peer:.1f} times")


if __name__ == "__main__":
    main()
