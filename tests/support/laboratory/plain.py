#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A plain judgement of a machine's history, from `followed` in results.json alone: a second opinion, and what score.py is tried with.

    plain.py OUT [--events FILE] [--line]

Prints nonio-history/1 as `nonio machine history OUT --json` does. Each series: generalised least squares with a level (with --line also a slope,
from five points on), what campaigns share in its covariance, one step at each event and each table (told if it is significant). Then the
undeclared step that lowers chi^2 most is added while (places - 1) P(chi^2_1 > gain) < 1 %/series of the site. No random walk, no choice
among models.
"""
import argparse
import datetime
import json
import math
import pathlib
import tomllib

from quantities import solve

SERIES_AT_1 = 0.01
AHEAD = 183  # days


def points_of(out):
    """{(machine, axis, quantity, conditions): [point]}; a point: day, order on the day, campaign, value, u, common, unit."""
    found = {}
    for file in sorted(pathlib.Path(out).glob("*/results.json")):
        result = json.loads(file.read_text())
        machine = result["campaign"]["machine"].get("asset", result["campaign"]["machine"].get("serial", ""))
        day = datetime.date.fromisoformat(result["campaign"]["date"]).toordinal()
        for f in result.get("followed", []):
            conditions = {k: v for k, v in f["conditions"].items() if k != "compensation"}
            key = machine, f["axis"], f["quantity"], json.dumps(conditions, sort_keys=True), f["unit"]
            found.setdefault(key, []).append({"day": day, "left": f["state"] == "as-left", "campaign": file.parent.name, "value": f["value"],
                                              "u": f["u"], "common": {c["source"]: c["u"] for c in f.get("common", [])}})
    return {k: sorted(p, key=lambda x: (x["day"], x["left"], x["campaign"])) for k, p in found.items()}


def covariance(points):
    return [[sum(u * q["common"].get(c, 0.0) for c, u in p["common"].items()) + (p["u"] ** 2 if p is q else 0.0) for q in points]
            for p in points]


class Fit:
    def __init__(self, inverse, columns, y):
        n = range(len(y))
        weighted = [[sum(inverse[i][j] * c[j] for j in n) for i in n] for c in columns]
        normal = [[sum(w[i] * c[i] for i in n) for c in columns] for w in weighted]
        unit = [[float(i == j) for j in range(len(columns))] for i in range(len(columns))]
        self.cov = solve(normal, unit)
        if self.cov is None:
            return
        right = [sum(w[i] * y[i] for i in n) for w in weighted]
        self.b = [sum(c * r for c, r in zip(row, right)) for row in self.cov]
        rest = [y[i] - sum(b * c[i] for b, c in zip(self.b, columns)) for i in n]
        self.chi2 = sum(rest[i] * sum(inverse[i][j] * rest[j] for j in n) for i in n)

    def at(self, column):
        value = sum(b * c for b, c in zip(self.b, column))
        return value, math.sqrt(max(0.0, sum(a * b * self.cov[i][j] for i, a in enumerate(column) for j, b in enumerate(column))))


def step(n, k):
    return [0.0] * (k + 1) + [1.0] * (n - k - 1)


def declared(points, machine, axis, events):
    """{k: cause} of steps between points k and k + 1."""
    out = {}
    for k, (p, q) in enumerate(zip(points, points[1:])):
        if p["campaign"] == q["campaign"]:
            out[k] = "table"
        elif any(e["machine"] == machine and e.get("axis", axis) == axis and e["kind"] != "instrument"
                 and p["day"] <= e["date"].toordinal() <= q["day"] for e in events):
            out.setdefault(k, "event")
    tables = {points[k]["day"] for k, cause in out.items() if cause == "table"}
    return {k: c for k, c in out.items() if c == "table" or not {points[k]["day"], points[k + 1]["day"]} & tables}


def judge(key, points, events, share, line):
    machine, axis, quantity, _, unit = key
    n, y, V = len(points), [p["value"] for p in points], covariance(points)
    inverse = solve(V, [[float(i == j) for j in range(n)] for i in range(n)])
    years = [(p["day"] - points[0]["day"]) / 365.25 for p in points]
    base = [[1.0] * n] + ([years] if line and n >= 5 else [])
    steps = declared(points, machine, axis, events)
    chances = {}

    def fitted(places):
        return Fit(inverse, base + [step(n, k) for k in sorted(places)], y)

    fit = fitted(steps)
    while fit.cov is not None and n - len(base) - len(steps) > 1:
        tried = [(f.chi2, k) for k in range(n - 1) if k not in steps and (f := fitted([*steps, k])).cov is not None]
        if not tried:
            break
        best, k = min(tried)
        p = min(1.0, (n - 1) * math.erfc(math.sqrt(max(0.0, fit.chi2 - best) / 2.0)))
        if p > share:
            break
        steps[k], chances[k] = "undeclared", p
        fit = fitted(steps)
    if fit.cov is None:
        return None
    changes = []
    for i, k in enumerate(sorted(steps)):
        size, u = fit.b[len(base) + i], math.sqrt(fit.cov[len(base) + i][len(base) + i])
        p = chances.get(k, math.erfc(abs(size) / u / math.sqrt(2.0)))
        if p > share:  # declared, and nothing of it is in this quantity
            continue
        changes.append({"after": points[k]["campaign"], "before": points[k + 1]["campaign"], "size": size, "u": u,
                        "p": p, "cause": steps[k]})
    slope = fit.at([0.0, 1.0] + [0.0] * len(steps)) if len(base) > 1 else (0.0, 0.0)
    ends = [-1, *sorted(steps), n - 1]
    segments = [{"from": points[a + 1]["campaign"], "to": points[b]["campaign"], "slope_per_year": slope[0], "u_slope": slope[1]}
                for a, b in zip(ends, ends[1:])]
    day = points[-1]["day"] + AHEAD
    value, u = fit.at([1.0] + [(day - points[0]["day"]) / 365.25] * (len(base) - 1) + [1.0] * len(steps))
    return {"machine": machine, "axis": axis, "quantity": quantity, "unit": unit, "model": "step" if steps else "level", "changes": changes,
            "points": [{"campaign": p["campaign"], "value": p["value"], "u": p["u"]} for p in points], "segments": segments,
            "forecast": {"date": datetime.date.fromordinal(day).isoformat(), "value": value, "u": u}}


def history(out, events=(), line=False):
    found = {k: p for k, p in points_of(out).items() if len(p) >= 3}
    series = [judge(k, p, events, SERIES_AT_1 / max(1, len(found)), line) for k, p in sorted(found.items())]
    return {"schema": "nonio-history/1", "night": 1, "series": [s for s in series if s], "machines": [], "vanished": []}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], epilog=__doc__.split("\n\n", 1)[1],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--events", type=pathlib.Path)
    parser.add_argument("--line", action="store_true")
    given = parser.parse_args()
    events = tomllib.loads(given.events.read_text()).get("event", []) if given.events else []
    print(json.dumps(history(given.out, events, given.line), indent=0))


if __name__ == "__main__":
    main()
