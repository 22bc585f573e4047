#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Jumps of the reversal value from results.json alone: independent of the program's history, so that the two can be compared.

    oracle.py OUT [--truth FILE] [--least UM]

Prints each jump of B_mean of at least 3 um from one campaign of an axis to the next that no table explains (as left on the day of the
first): machine, axis, campaigns, size, and how many standard uncertainties: u(B_mean)^2 = sum over targets of (s+^2 + s-^2)/n/m^2. With a
truth: those that were planted and are missing, those that were not planted; exit status 1 if there are any.
"""
import argparse
import json
import math
import pathlib
import sys


def reversal(analysis):
    points = [p for p in analysis["points"] if "B" in p]
    variance = sum(p["s+"] ** 2 / p["n+"] + p["s-"] ** 2 / p["n-"] for p in points) / len(points) ** 2
    return analysis["values"]["B_mean"]["value"], math.sqrt(variance)


def series(out):
    found = {}
    for file in sorted(pathlib.Path(out).glob("*/results.json")):
        result = json.loads(file.read_text())
        campaign = result["campaign"]
        machine = campaign["machine"].get("asset", campaign["machine"]["serial"])
        for a in result["analyses"]:
            if a["plugin"] == "iso230-2" and "B_mean" in a["values"]:
                axis, _, state = a["measurement"].partition(" ")
                found.setdefault((machine, axis), []).append((campaign["date"], state == "left", campaign["id"], *reversal(a)))
    return {key: sorted(points) for key, points in found.items()}


def jumps(found, least):
    out = []
    for (machine, axis), points in sorted(found.items()):
        for (_, _, after, a, ua), (_, left, before, b, ub) in zip(points, points[1:]):
            if abs(b - a) >= least and not left:
                out.append((machine, axis, after, before, b - a, abs(b - a) / math.hypot(ua, ub)))
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], epilog=__doc__.split("\n\n", 1)[1],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--truth", type=pathlib.Path)
    parser.add_argument("--least", type=float, default=3.0)
    given = parser.parse_args()
    found = jumps(series(given.out), given.least)
    for machine, axis, after, before, size, in_u in found:
        print("%s %s: %s to %s: %+.2f um, %.1f u" % (machine, axis, after, before, size, in_u))
    if not given.truth:
        return 0
    planted = {(c["after"], c["before"], c["axis"]) for c in json.loads(given.truth.read_text())["changes"]
               if "crash" in c["kinds"] and abs(c["quantities"].get("B_mean", {"size": 0.0})["size"]) >= given.least}
    seen = {(after, before, axis) for _, axis, after, before, _, _ in found}
    print("%d planted, %d seen, %d missing, %d not planted" % (len(planted), len(planted & seen), len(planted - seen), len(seen - planted)))
    for what, those in (("missing", planted - seen), ("not planted", seen - planted)):
        for after, before, axis in sorted(those):
            print("%s: %s, %s to %s" % (what, axis, after, before))
    return 1 if planted != seen else 0


if __name__ == "__main__":
    sys.exit(main())
