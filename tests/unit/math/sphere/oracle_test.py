# SPDX-License-Identifier: Apache-2.0
"""Spheres from touches by a method of its own: damped Newton on the sum of squares with its full second
derivatives, solved by elimination; the cofactor as the inverse of J'J, formed and inverted here."""
import math
import random
import subprocess
import sys


def total(touches, p, radius):
    r = radius or p[3]
    return math.fsum((math.dist(t, p[:3]) - r) ** 2 for t in touches)


def gradient_and_curvature(touches, p, radius):
    """Analytic first and second derivatives of the sum of squares."""
    k = 3 if radius else 4
    r = radius or p[3]
    g = [0.0] * k
    h = [[0.0] * k for _ in range(k)]
    for t in touches:
        d = math.dist(t, p[:3])
        e = d - r
        j = [-(t[i] - p[i]) / d for i in range(3)] + ([] if radius else [-1.0])
        for a in range(k):
            g[a] += 2.0 * e * j[a]
            for b in range(k):
                second = ((1.0 if a == b else 0.0) - j[a] * j[b]) / d if a < 3 and b < 3 else 0.0
                h[a][b] += 2.0 * (j[a] * j[b] + e * second)
    return g, h


def solve(a, b):
    """Gaussian elimination with pivots; b may have several columns."""
    n = len(a)
    m = [row[:] + right[:] for row, right in zip(a, b)]
    for c in range(n):
        pivot = max(range(c, n), key=lambda r: abs(m[r][c]))
        m[c], m[pivot] = m[pivot], m[c]
        for r in range(n):
            if r != c:
                f = m[r][c] / m[c][c]
                m[r] = [x - f * y for x, y in zip(m[r], m[c])]
    return [[x / m[i][i] for x in m[i][n:]] for i in range(n)]


def fit(touches, radius, start):
    p = list(start)
    for _ in range(60):
        g, h = gradient_and_curvature(touches, p, radius)
        step = solve(h, [[-x] for x in g])
        size, now = 1.0, total(touches, p, radius)
        while True:
            new = [x + size * s[0] for x, s in zip(p, step)]
            if total(touches, new, radius) <= now or size < 1e-6:
                break
            size /= 2
        p = new
    return p


def main():
    rng = random.Random(20)
    cases, lines = [], []
    for _ in range(60):
        n = rng.randint(5, 25)
        centre = [rng.uniform(-2, 2) for _ in range(3)]
        r = rng.uniform(0.005, 0.05)
        radius = r if rng.random() < 0.3 else 0.0
        touches = []
        for _ in range(n):  # on the upper half and a little below
            z = rng.uniform(-0.3, 1.0)
            a = rng.uniform(0, 2 * math.pi)
            s = math.sqrt(1 - z * z)
            off = r + rng.gauss(0, 2e-6)
            touches.append([c + off * u for c, u in zip(centre, (s * math.cos(a), s * math.sin(a), z))])
        cases.append((touches, radius, centre + ([] if radius else [r])))
        lines.append(" ".join([str(n), repr(radius)] + [repr(x) for t in touches for x in t]))
    out = subprocess.run([sys.argv[1]], input="\n".join(lines), capture_output=True, text=True, check=True)
    answers = out.stdout.splitlines()
    assert len(answers) == len(cases), out.stdout
    worst = [0.0, 0.0, 0.0]
    for (touches, radius, start), answer in zip(cases, answers):
        words = answer.split()
        assert words[0] != "error", answer
        *found, rss = map(float, words)
        p = fit(touches, radius, start)
        worst[0] = max(worst[0], *(abs(a - b) for a, b in zip(p, found[:3])))
        worst[1] = max(worst[1], abs(total(touches, p, radius) - rss) / rss)
        # Linear propagation: cofactor = inverse of J'J.
        k = 3 if radius else 4
        jj = [[0.0] * k for _ in range(k)]
        for t in touches:
            d = math.dist(t, p[:3])
            j = [(t[i] - p[i]) / d for i in range(3)] + ([] if radius else [1.0])
            for a in range(k):
                for b in range(k):
                    jj[a][b] += j[a] * j[b]
        inverse = solve(jj, [[1.0 if a == b else 0.0 for b in range(k)] for a in range(k)])
        worst[2] = max(worst[2], *(abs(inverse[i][i] / found[4 + i] - 1) for i in range(3)))
    print(f"{len(cases)} spheres: centres agree to {worst[0]:.1e} m, sums of squares to {worst[1]:.1e}, "
          f"cofactors to {worst[2]:.1e} of their size")
    assert worst[0] < 1e-11 and worst[1] < 1e-6 and worst[2] < 1e-6


main()
