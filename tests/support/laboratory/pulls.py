#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether what results.json says of followed quantities, and how sure it says it is, fits what is true of a made-up laboratory.

    pulls.py OUT TRUTH

For each quantity: (value - true)/u over all campaigns, u with what campaigns share; and of each two campaigns that follow one another on one
axis (difference - true difference)/u, what they share by the same source taken off: their root mean square (1 where u is right) and the
share within 1.96. Of u with few degrees of freedom both are a little larger and smaller than 1 and 95 %.
"""
import json
import math
import pathlib
import sys

from score import same_axis, same_quantity


def followed(out):
    """{campaign: [followed quantities]}"""
    found = {}
    for file in sorted(pathlib.Path(out).glob("*/results.json")):
        found[file.parent.name] = json.loads(file.read_text()).get("followed", [])
    return found


def common_of(f):
    return {c["source"]: c["u"] for c in f.get("common", [])}


class Pulls:
    def __init__(self):
        self.values = {}

    def add(self, name, pull):
        self.values.setdefault(name, []).append(pull)

    def text(self, title):
        out = [title, "%-28s %6s %6s %8s" % ("quantity", "n", "rms", "within")]
        for name, pulls in sorted(self.values.items()):
            rms = math.sqrt(sum(p * p for p in pulls) / len(pulls))
            out.append("%-28s %6d %6.2f %7.1f%%" % (name, len(pulls), rms, 100.0 * sum(abs(p) <= 1.96 for p in pulls) / len(pulls)))
        return "\n".join(out)


def compare(out, truth):
    found = followed(out)
    alone, pairs, absent = Pulls(), Pulls(), {}
    for s in truth["series"]:
        before = None
        for p in s["points"]:
            told = [f for f in found.get(p["campaign"], []) if (f.get("measurement") in (p["measurement"], "", None) or s["quantity"].startswith("squareness"))
                    and same_axis(s["axis"].split("-")[0], f["axis"]) and same_quantity(s["quantity"], f["quantity"])]
            if not told:
                absent[s["quantity"]] = absent.get(s["quantity"], 0) + 1
                continue
            f = told[0]
            common = common_of(f)
            alone.add(s["quantity"], (f["value"] - p["value"]) / math.sqrt(f["u"] ** 2 + sum(u * u for u in common.values())))
            if before and before[2] == p["conditions"]:
                sources = common.keys() | before[1].keys()
                shared = sum((common.get(c, 0.0) - before[1].get(c, 0.0)) ** 2 if c in common and c in before[1]
                             else common.get(c, before[1].get(c)) ** 2 for c in sources)
                d = (f["value"] - before[0]["value"]) - (p["value"] - before[3])
                pairs.add(s["quantity"], d / math.sqrt(f["u"] ** 2 + before[0]["u"] ** 2 + shared))
            before = (f, common, p["conditions"], p["value"])
    return alone, pairs, absent


def main():
    alone, pairs, absent = compare(sys.argv[1], json.loads(pathlib.Path(sys.argv[2]).read_text()))
    print(alone.text("each campaign against the truth"))
    print(pairs.text("two campaigns that follow one another"))
    print("true but not followed: " + (", ".join("%s %d" % a for a in sorted(absent.items())) or "none"))


if __name__ == "__main__":
    main()
