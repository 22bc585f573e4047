# SPDX-License-Identifier: Apache-2.0
"""What is followed over the campaigns of a machine, as weights of the mean deviations: written down once more, apart from the
program, from docs/formulas.md.

A quantity is sum_i (plus_i m+_i + minus_i m-_i) over the targets i, m+ and m- the means over the runs in the two directions. So its
value without noise, and what noise makes of it, come from the same weights.
"""
import math

FEWEST_FOR_CURVE, FEWEST_FOR_SINUSOID = 5, 10
MOST_INFLATED = 2.0  # a sinusoid that the targets tell so much worse than evenly spread phases is not followed


def solve(a, b):
    """x with a x = b: Gaussian elimination with pivots; b has several columns. None where a is singular."""
    n = len(a)
    rows = [list(a[i]) + list(b[i]) for i in range(n)]
    largest = max(abs(x) for row in a for x in row)
    for c in range(n):
        p = max(range(c, n), key=lambda r: abs(rows[r][c]))
        if abs(rows[p][c]) < 1e-12 * largest:
            return None
        rows[c], rows[p] = rows[p], rows[c]
        for r in range(n):
            if r != c:
                f = rows[r][c] / rows[c][c]
                rows[r] = [x - f * y for x, y in zip(rows[r], rows[c])]
    return [[x / rows[i][i] for x in rows[i][n:]] for i in range(n)]


def fit_rows(columns):
    """Rows of (X'X)^-1 X' for X with these columns."""
    normal = [[sum(x * y for x, y in zip(a, b)) for b in columns] for a in columns]
    return solve(normal, columns)


def legendre(targets, count):
    middle, length = (targets[0] + targets[-1]) / 2.0, targets[-1] - targets[0]
    z = [2.0 * (x - middle) / length for x in targets]
    return [[1.0] * len(z), z, [(3.0 * v * v - 1.0) / 2.0 for v in z], [(5.0 * v ** 3 - 3.0 * v) / 2.0 for v in z]][:count]


def sinusoid(targets, period, beside):
    """Rows of cos and sin, or None where they are not identifiable with these targets."""
    if len(targets) < FEWEST_FOR_SINUSOID or targets[-1] - targets[0] < period / 2.0:
        return None
    phases = [2.0 * math.pi * x / period for x in targets]
    rows = fit_rows(beside + [[math.cos(p) for p in phases], [math.sin(p) for p in phases]])
    if rows is None or any(sum(v * v for v in row) > MOST_INFLATED * 2.0 / len(targets) for row in rows[-2:]):
        return None
    return rows[-2:]


def covers_a_turn(targets):
    return 360.0 - (targets[-1] - targets[0]) <= 120.0 and all(b - a <= 120.0 for a, b in zip(targets, targets[1:]))


def weights(targets, rotary=False, period=None, across=False):
    """{name: (plus, minus)}: mm or deg, um or arcsec; scale in um/m. Both directions at every target. `across`: a straightness."""
    def of_means(row):
        return [w / 2.0 for w in row], [w / 2.0 for w in row]

    out = {}
    turn = rotary and covers_a_turn(targets)
    beside = legendre(targets, 1 if turn else 4)
    if not rotary:
        if not across:
            slope = fit_rows(legendre(targets, 2))[1]
            out["scale"] = of_means([1000.0 * w * 2.0 / (targets[-1] - targets[0]) for w in slope])
        if len(targets) >= FEWEST_FOR_CURVE:
            curve = fit_rows(legendre(targets, 4))
            out["curve_2"], out["curve_3"] = of_means(curve[2]), of_means(curve[3])
    for name, length in (("turn", 360.0 if turn else None), ("cyclic", period)):
        rows = length and sinusoid(targets, length, beside)
        if rows:
            out[name + "_cos"], out[name + "_sin"] = of_means(rows[0]), of_means(rows[1])
    m = len(targets)
    out["B_mean"] = [1.0 / m] * m, [-1.0 / m] * m
    return out


def value(weight, plus, minus):
    return sum(w * y for w, y in zip(weight[0], plus)) + sum(w * y for w, y in zip(weight[1], minus))


def repetition(weight, runs, s, own=0.0, shared=0.0):
    """Standard uncertainty of a quantity from its scatter: s of a single reading, of the offset of each pass (own) and of what both
    passes of a run share; in the unit of the readings."""
    a, b = sum(weight[0]), sum(weight[1])
    return math.sqrt((s * s * sum(w * w for part in weight for w in part) + own * own * (a * a + b * b)
                      + shared * shared * (a + b) ** 2) / runs)
