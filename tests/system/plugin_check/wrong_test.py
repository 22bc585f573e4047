#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each wrong plugin is caught by the checks that are for its mistake, and by no other."""
import json
import pathlib
import subprocess
import sys

NONIO, PLUGINS, CASES = sys.argv[1:4]

# What a table of the wrong sign does to a machine is seen by everything that loads it.
EVERY_TABLE = {"cancels", "sign", "rounding", "limits", "rotary"}
WANTED = {
    "effect dependent-columns": {"independent"},
    "effect constant-column": {"independent"},
    "effect moving-while-still": {"at-rest"},
    "effect order-of-rows": {"rows"},
    "effect crash-on-empty": {"malformed"},
    "effect coarse-grid": {"neighbours"},
    "effect double-grid": {"grid"},
    "analysis order-of-rows": {"rows"},
    "analysis moves-with-zero": {"shift"},
    "analysis not-to-scale": {"scale"},
    "analysis one-sided": {"mirror"},
    "analysis likes-x": {"renamed"},
    "analysis divides-by-travel": {"malformed"},
    "analysis counts-calls": {"again"},
    "analysis crash-on-empty": {"malformed"},
    "analysis endless-on-zero": {"malformed"},
    "analysis says-nothing": {"results"},
    "analysis always-fails": {"results"},
    "analysis endless": {"again", "results", "time"},
    "analysis of-its-home": {"pure"},
    "output dated": {"pure"},
    "output of-its-folder": {"pure"},
    "output writes-a-file": {"pure"},
    "output opens-a-socket": {"writes", "again", "empty", "malformed", "pure"},  # the kernel ends it at once
    "output makes-a-process": {"pure"},
    "controller unreadable": EVERY_TABLE,
    "controller reads-nothing": EVERY_TABLE,
    "controller nothing-wrong": set(),
    "output counts-calls": {"again"},
    "output named-by-machine": {"malformed"},
    "output crash-without-results": {"empty"},
    "output two words": {"names"},
    "output no-help": {"options"},
    "output wrong-default": {"options"},
    "output wrong-unit": {"options"},
    "output path-by-choice": {"choices"},
    "controller wrong-sign": EVERY_TABLE,
    "controller drifting": {"rounding"},
    "controller wrapping": {"limits"},
    "reader loses-minus": {"signs"},
    "reader averages-sentinels": {"sentinels"},
    "output exports-two": set(),
    "method halves-readings": {"round-trip"},
    "method divides-by-readings": {"malformed"},
    "method crash-on-empty": {"malformed"},
    "method of-its-home": {"pure"},
    "method two-columns-of-a-name": {"columns"},
    "method key-without-help": {"keys"},
    "": {"symbols"},  # of a file
}
CRASHED = {"method crash-on-empty", "effect crash-on-empty", "analysis crash-on-empty", "analysis endless-on-zero", "analysis endless",
           "output crash-without-results", "output opens-a-socket"}


def main():
    failures, caught, seen = [], {}, set()
    for file in sorted(pathlib.Path(PLUGINS).glob("*.so")):
        cases = {"wrong_outputs": ["--cases", CASES],  # of the readers
                 "wrong_methods": ["--cases", CASES.replace("cases", "method_cases")]}.get(file.stem, [])
        done = subprocess.run([NONIO, "plugin", "check", file, "--json", "--seconds", "3", *cases],
                              stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode != 1:
            failures.append(f"{file.name}: exit status {done.returncode}, expected 1\n{done.stdout}")
            continue
        for check in json.loads(done.stdout)["checks"]:
            seen.add(check["plugin"])
            if check["state"] not in ("failed", "crashed"):
                continue
            caught.setdefault(check["plugin"], set()).add(check["check"])
            crashes = check["plugin"] in CRASHED and check["check"] != "time"
            if (check["state"] == "crashed") != crashes:
                failures.append(f"{check['plugin']}: {check['check']} {check['state']}: {check['says']}")
            if check["plugin"] not in WANTED or check["check"] not in WANTED[check["plugin"]]:
                failures.append(f"{check['plugin']}: {check['check']} caught it too: {check['says']}")
    for plugin, wanted in WANTED.items():
        if plugin not in seen:
            failures.append(f"{plugin}: it was not checked")
        for check in sorted(wanted - caught.get(plugin, set())):
            failures.append(f"{plugin}: {check} did not catch it")
    for failure in failures:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
