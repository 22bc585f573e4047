#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Readings made up, and what ISO 230-2 and VDI/DGQ 3441 give for them by exact arithmetic: make_oracle.py FOLDER [--check]

Readings have three decimals. Means and differences are fractions; square roots have 50 digits; the factors of the range
are integrated here from the normal distribution with 40 digits. Nothing is shared with the kernels. Each set has a property
in which evaluators differ: see SETS. --check compares with FOLDER and changes nothing."""
import decimal
import fractions
import json
import pathlib
import random
import sys

decimal.getcontext().prec = 50
Decimal, Fraction = decimal.Decimal, fractions.Fraction

# name: (targets in mm, runs, seed, share of readings that are missing, directions, slope um/m, reversal um, noise um)
SETS = {
    "even-targets": (range(0, 501, 50), 5, 1, 0.0, "+-", 12, 3, 1),
    "uneven-targets-and-negative": ((-320, -251, -160, -77, -3, 88, 173, 246, 331), 5, 2, 0.0, "+-", -30, -4, 1),
    "reversal-that-changes-sign": (range(0, 401, 40), 5, 3, 0.0, "+-", 5, None, 0.5),
    "readings-missing": (range(0, 601, 60), 6, 4, 0.15, "+-", 8, 2, 2),
    "only-upwards": (range(0, 301, 30), 5, 5, 0.0, "+", 20, 0, 1),
    "only-downwards": (range(0, 301, 30), 5, 6, 0.0, "-", 20, 0, 1),
    "one-run-scatters-more": (range(0, 241, 30), 5, 7, 0.0, "+-", 0, 1, None),
    "ten-runs": (range(0, 1001, 100), 10, 8, 0.0, "+-", 3, 6, 3),
    "two-runs": (range(0, 201, 50), 2, 9, 0.0, "+-", 3, 1, 1),
    "no-scatter": (range(0, 201, 50), 3, 10, 0.0, "+-", 40, 2, 0),
}


def readings_of(targets, runs, seed, missing, directions, slope, reversal, noise):
    """Rows (run, direction, target in mm, deviation in um)."""
    draw = random.Random(seed)
    rows = []
    for run in range(1, runs + 1):
        for direction in directions:
            for target in targets if direction == "+" else reversed(targets):
                lost = reversal if reversal is not None else (target - 200) / 20
                scatter = noise if noise is not None else (6 if run == 3 else 0.5)
                value = slope * target / 1000 - (lost if direction == "-" else 0) + draw.gauss(0, 1) * scatter
                if draw.random() >= missing:
                    rows.append((run, direction, target, f"{value:.3f}"))
    return rows


def root(value):
    return (Decimal(value.numerator) / Decimal(value.denominator)).sqrt()


def as_decimal(value):
    return Decimal(value.numerator) / Decimal(value.denominator) if isinstance(value, Fraction) else value


class Side:
    """The readings at one target in one direction: mean, standard deviation, range."""

    def __init__(self, values):
        self.n = len(values)
        self.mean = sum(values) / self.n if values else None
        self.range = max(values) - min(values) if self.n > 1 else None
        self.s = root(sum((v - self.mean) ** 2 for v in values) / (self.n - 1)) if self.n > 1 else None


def erf(x):
    """Series of the error function: 2/sqrt(pi) sum (-1)^n x^(2n+1)/(n! (2n+1)); with 90 digits, for its terms cancel."""
    with decimal.localcontext() as context:
        context.prec = 90
        term, total, n = x, x, 0
        while abs(term) > Decimal(10) ** -75:
            n += 1
            term = -term * x * x / n
            total += term / (2 * n + 1)
        return 2 * total / PI.sqrt()


def pi():
    """Machin: 16 atan(1/5) - 4 atan(1/239)."""
    with decimal.localcontext() as context:
        context.prec = 90

        def atan(inverse):
            power, total, n = Decimal(1) / inverse, Decimal(0), 0
            while power > Decimal(10) ** -85:
                total += power / (2 * n + 1) * (-1) ** n
                power /= inverse * inverse
                n += 1
            return total

        return 16 * atan(5) - 4 * atan(239)


PI = pi()


def range_factors():
    """d_n = integral of 1 - F^n - (1 - F)^n; the trapezoidal rule converges beyond all powers for such a function."""
    step = Decimal(1) / 8
    grid = [step * k for k in range(0, 81)]  # to 10 standard deviations: what is left is below 1e-22
    tail = {x: (1 - erf(x / Decimal(2).sqrt())) / 2 for x in grid}
    factors = {}
    for n in range(2, 11):
        at = {x: 1 - (1 - tail[x]) ** n - tail[x] ** n for x in grid}
        factors[n] = 2 * step * (sum(at.values()) - at[Decimal(0)] / 2)
    return factors


D_N = range_factors()


def arranged(rows):
    sides = {}
    for _, direction, target, deviation in rows:
        sides.setdefault(target, {"+": [], "-": []})[direction].append(Fraction(deviation))
    return [{d: Side(v) for d, v in sides[t].items()} for t in sorted(sides)]


def extent(values):
    values = list(values)
    return None if not values or None in values else max(values) - min(values)


def largest(values):
    values = list(values)
    return None if not values or None in values else max(values)


def average(values):
    values = list(values)
    return None if not values or None in values else sum(values) / len(values)


def over(factor, side, sign=1):
    """mean + sign factor s; None where one of both is not known."""
    return None if side.s is None else as_decimal(side.mean) + sign * factor * side.s


def iso(targets, k):
    both = [t["+"].n > 0 and t["-"].n > 0 for t in targets]
    out = {}
    for name, d in (("up", "+"), ("down", "-")):
        there = [t[d] for t in targets if t[d].n > 0]
        out[f"E_{name}"] = extent(s.mean for s in there)
        out[f"R_{name}"] = largest(None if s.s is None else 2 * k * s.s for s in there)
        out[f"A_{name}"] = extent(over(k, s, sign) for s in there for sign in (1, -1))
    B = [t["+"].mean - t["-"].mean if b else None for t, b in zip(targets, both)]
    R = [None if not b or t["+"].s is None or t["-"].s is None else
         max(k * t["+"].s + k * t["-"].s + abs(as_decimal(B_i)), 2 * k * t["+"].s, 2 * k * t["-"].s)
         for t, b, B_i in zip(targets, both, B)]
    out["B"], out["B_mean"] = largest(None if b is None else abs(b) for b in B), average(B)
    out["R"] = largest(R)
    out["E"] = extent(t[d].mean for t in targets for d in "+-")
    out["A"] = extent(over(k, t[d], sign) for t in targets for d in "+-" for sign in (1, -1))
    out["M"] = extent((t["+"].mean + t["-"].mean) / 2 if b else None for t, b in zip(targets, both))
    return out


def vdi(targets, deviation_of):
    S = [{d: deviation_of(t[d]) for d in "+-"} for t in targets]
    out = {}
    for name, d in (("up", "+"), ("down", "-")):
        there = [(as_decimal(t[d].mean), s[d]) for t, s in zip(targets, S) if t[d].n > 0]
        out[f"Pa_{name}"] = extent(m for m, _ in there)
        high = largest(None if s is None else m + 3 * s for m, s in there)
        low = largest(None if s is None else 3 * s - m for m, s in there)
        out[f"P_{name}"] = None if high is None or low is None else high + low
        out[f"Ps_max_{name}"] = largest(None if s is None else 6 * s for _, s in there)
    both = [t["+"].n > 0 and t["-"].n > 0 for t in targets]
    xs = [as_decimal((t["+"].mean + t["-"].mean) / 2) if b else None for t, b in zip(targets, both)]
    U = [as_decimal(abs(t["+"].mean - t["-"].mean)) if b else None for t, b in zip(targets, both)]
    Ps = [None if s["+"] is None or s["-"] is None else 3 * (s["+"] + s["-"]) for s in S]
    whole = [None if u is None or p is None else u + p for u, p in zip(U, Ps)]
    high = largest(None if x is None or w is None else x + w / 2 for x, w in zip(xs, whole))
    low = largest(None if x is None or w is None else w / 2 - x for x, w in zip(xs, whole))
    out["P"] = None if high is None or low is None else high + low
    out["Pa"] = extent(xs)
    out["Ps_max"], out["Ps_mean"] = largest(Ps), average(Ps)
    out["U_max"], out["U_mean"] = largest(U), average(U)
    out["PsU_max"] = largest(whole)
    return out


def expected(rows):
    targets = arranged(rows)
    by_range = lambda side: None if side.range is None or side.n not in D_N else as_decimal(side.range) / D_N[side.n]
    results = {"iso230_2_2014": iso(targets, 2), "iso230_2_1988": iso(targets, 3),
               "vdi3441_direct": vdi(targets, lambda side: side.s), "vdi3441_range": vdi(targets, by_range)}
    return {name: {key: None if value is None else float(as_decimal(value)) for key, value in sorted(result.items())}
            for name, result in results.items()}


def main():
    folder, check = pathlib.Path(sys.argv[1]), "--check" in sys.argv
    stale = []
    for name, how in SETS.items():
        rows = readings_of(*how)
        files = {f"{name}.csv": "run,direction,target,deviation\n" + "".join(f"{r},{d},{t},{x}\n" for r, d, t, x in rows),
                 f"{name}.expected.json": json.dumps({"oracle": expected(rows)}, indent=1) + "\n"}
        for file, text in files.items():
            if check and (not (folder / file).exists() or (folder / file).read_text() != text):
                stale.append(file)
            elif not check:
                (folder / file).write_text(text)
    print(f"{len(SETS)} sets" + "".join(f"\nexpected what make_oracle.py writes, found another {file}" for file in stale))
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
