#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plugins with one fault each: the check that is for it catches it, under every seed; the plugin without a fault passes all.

    spoiled_test.py NONIO PLUGINS CASES [--list] [--seeds N]

Each library is one source with all faults of its kind; a copy of it has the fault that its file is called after.
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ALL = {
    "pure": "by-the-clock by-the-date by-home by-folder writes-a-file reads-a-file opens-a-socket makes-a-process "
            "runs-a-program",
    "names": "capitals two-words no-version version-in-words no-summary summary-of-two-lines option-twice "
             "option-with-a-blank",
    "options": "no-help default-out-of-range unit-of-another default-no-choice choice-twice range-turned "
               "default-no-number",
    "loads": "throws-at-start crashes-at-start slow-at-start registers-nothing",
    "again": "counts-calls",
}
OWN = {
    "reader": {
        "true-values": "deviation-x1000 deviation-in-nm deviation-turned deviation-without-sign deviation-in-microinches "
                 "deviation-halved deviation-rounded deviation-cut-off deviation-shifted temperature-corrected target-in-m "
                 "target-in-inches target-turned target-from-one target-as-reached directions-swapped all-towards-plus "
                 "direction-by-deviation runs-from-two all-of-one-run run-a-pass four-seconds-for-six time-in-ms "
                 "time-from-one kelvin fahrenheit twenty-degrees lost-last-target lost-first-target lost-last-run "
                 "lost-last-line lost-first-line lost-way-back lost-every-tenth lost-small-ones lost-large-ones "
                 "lost-negative-ones last-line-twice means-of-runs zeroed target-of-the-row-before "
                 "deviation-of-the-row-before way-back-mirrored blanks-as-zero times-lost temperatures-lost "
                 "air-for-material",
        "reads": "refuses-all throws finds-nothing column-too-short a-reading-that-is-none an-infinite-reading "
                 "a-position-that-is-none no-lines a-line-that-is-not-there without-read without-recognises",
        "empty": "knows-nothing-written reads-nothing-as-zero",
        "foreign": "knows-everything knows-a-pdf knows-json knows-zeros knows-digits",
        "truncated": "pads-what-was-cut",
        "damaged": "damage-is-nan crashes-at-damage hangs-at-damage",
        "sentinels": "sentinels-as-readings sentinels-as-zero sentinels-take-the-row-before sentinels-as-the-row-before",
        "signs": "loses-plus-signs loses-minus-signs",
    },
    "effect": {
        "true-values": "in-mm in-um turned halved without-sign squared from-the-first-target towards-plus-only with-direction "
                 "cut-off by-commanded-position wave-of-half-the-period wave-without-two-pi wave-in-degrees "
                 "wave-of-cosine-and-sine",
        "independent": "a-constant zeros wave-of-two-sines",
        "columns": "a-nan infinite an-entry-too-few an-entry-too-many a-column-too-many without-parameters "
                   "without-columns without-applies refuses-all throws",
        "rows": "by-the-order by-the-row-before",
        "at-rest": "while-still",
        "malformed": "crashes-without-readings crashes-with-one-reading hangs-without-times",
        "neighbours": "grid-with-holes",
        "grid": "grid-with-a-twin grid-that-falls grid-with-a-nan",
    },
    "analysis": {
        "true-values": "x1000 halved turned rounded first-run-only towards-plus-only every-second-reading without-the-largest "
                 "of-another-quantity of-another-name without-a-value one-too-many",
        "results": "refuses-all throws says-nothing hangs without-analyse without-applies",
        "rows": "the-first the-last of-neighbours",
        "shift": "rms largest-of-all",
        "scale": "to-the-square root a-constant-more",
        "mirror": "above-the-mean positive-places-only",
        "renamed": "likes-x",
        "finite": "a-nan infinite evidence-that-is-none",
        "malformed": "crashes-without-readings crashes-with-one-reading crashes-at-huge-ones hangs-at-zeros "
                   "infinite-for-one nan-without-travel log-of-zero",
    },
    "output": {
        "writes": "refuses-all throws writes-nothing into-a-folder above absolute without-name no-json twice-the-same "
                  "prediction-of-nan evidence-of-nan without-write",
        "empty": "crashes-without-results crashes-without-readings",
        "malformed": "crashes-at-long-texts named-by-machine named-by-customer",
        "choices": "path-by-choice crashes-by-choice crashes-at-the-end",
    },
    "table": {
        "declared": "without-a-name without-facts fact-twice fact-without-words step-of-zero step-of-nan "
                    "increments-of-nothing without-parse",
        "true-values": "reads-x1000 reads-tenths reads-inches reads-the-other-sign reads-increments reads-places-in-m "
                 "reads-places-from-the-first reads-without-the-last reads-without-the-first reads-the-next-entry "
                 "reads-backwards",
        "cancels": "unreadable reads-nothing writes-the-error writes-twice-as-much writes-half-of-it writes-a-tenth "
                   "writes-inches writes-increments writes-backwards writes-one-point-later writes-as-error minus-turned "
                   "minus-x10 minus-in-um minus-from-elsewhere minus-of-a-constant plus-x10 columns-exchanged minus-backwards throws "
                   "refuses-all writes-nothing",
        "rounding": "one-point-off cuts-digits-off rounds-away rounds-coarsely sums-roundings",
        "limits": "wraps-at-a-byte clips-large-ones",
        "rotary": "turn-that-does-not-close rotary-in-radians",
    },
}


def faults_of(kind):
    for group in (ALL, OWN[kind]):
        for check, names in group.items():
            for name in names.split():
                yield name, check


def main():
    nonio, plugins, cases = sys.argv[1:4]
    seeds = int(sys.argv[sys.argv.index("--seeds") + 1]) if "--seeds" in sys.argv else 3
    rows = [(kind, name, check) for kind in OWN for name, check in faults_of(kind)]
    if "--list" in sys.argv:
        for row in rows:
            print(*row)
        return 0
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        def run(kind, fault, check, seed):
            copy = pathlib.Path(folder) / f"{kind}--{fault}.so"
            if not copy.exists():
                try:
                    shutil.copyfile(pathlib.Path(plugins) / f"spoiled_{kind}.so", copy.with_suffix(f".{seed}.part"))
                    copy.with_suffix(f".{seed}.part").replace(copy)
                except OSError as error:
                    sys.exit(str(error))
            command = [nonio, "plugin", "check", copy, "--json", "--seconds", "3", "--seed", str(seed), "--seeds", "1",
                       "--cases", pathlib.Path(cases) / ("reader" if kind == "reader" else "other")]
            if check:
                command += ["--only", check]
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
            try:
                return done.returncode, json.loads(done.stdout)["checks"]
            except (ValueError, KeyError):
                return done.returncode, [{"check": "", "state": "no answer", "says": done.stdout + done.stderr}]

        def caught(row):
            kind, name, check = row
            for seed in range(1, seeds + 1):
                status, found = run(kind, name, check, seed)
                bad = [c for c in found if c["state"] in ("failed", "crashed")]
                if status != 1 or not any(c["check"] == check for c in bad):
                    says = "; ".join(f"{c['check']} {c['state']}: {c['says']}" for c in found)
                    return f"{kind} {name}: {check} did not catch it under seed {seed} (status {status}): {says[:300]}"
            return ""

        def right(kind):
            status, found = run(kind, "none", "", 1)
            bad = [f"{kind} without a fault: {c['check']} {c['state']}: {c['says']}" for c in found
                   if c["state"] not in ("passed", "skipped")]
            if status != 0 and not bad:
                bad = [f"{kind} without a fault: status {status}"]
            return bad

        with ThreadPoolExecutor(2) as pool:
            for bad in pool.map(right, OWN):
                failures += bad
            failures += filter(None, pool.map(caught, rows))
    for failure in failures:
        print(failure)
    print(f"{len(rows)} faults, {seeds} seeds: {len(rows) - sum(' did not ' in f for f in failures)} caught")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
