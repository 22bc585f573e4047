#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a program over many simulated laboratories and scores its results.

    run_sites.py PROGRAM FOLDER [--preset mixed] [--sites 200] [--seed 1] [--nights 2] [--machines N] [--count N] [--known] [--plain]

For each site (seed, seed + 1, ...): the site as it was on each of its last dates, one month apart, a run (PROGRAM run SITE --out OUT),
then `PROGRAM history OUT --json` and `PROGRAM morning OUT --json` (--plain: plain.py judges instead). FOLDER/<seed>/ has truth.json,
history-<number>.json and morning-<number>.json; sites and results are removed. Prints the score of score.py over all sites. FOLDER must
be empty or missing. Campaigns vanish before the last run, so that at least two runs are needed to detect it.
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tomllib

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import make_laboratory  # noqa: E402 (this folder is no package)
import physics  # noqa: E402
import plain  # noqa: E402
import presets  # noqa: E402
import score  # noqa: E402
import truth as truths  # noqa: E402

MONTH = 30


def nights_of(program, folder, given, seed):
    """(truth, histories, mornings) of one laboratory."""
    sizes = {k: v for k, v in (("machines", given.machines), ("count", given.count)) if v is not None}
    last = presets.build(given.preset, seed, **sizes).night
    histories, mornings, truth = [], [], None
    for night in range(given.nights):
        until = last - MONTH * (given.nights - 1 - night)
        truth = make_laboratory.write(presets.build(given.preset, seed, **sizes), folder / "site", until, given.known)
        # Whatever vanishes or fails is part of the story: 1 is no error here.
        done = subprocess.run([program, "run", str(folder / "site"), "--out", str(folder / "out"), "--jobs", "1", "--quiet",
                               "--date", physics.date_of(until)],
                              capture_output=True, text=True)
        if done.returncode not in (0, 1):
            raise SystemExit("seed %d, night %d: run ended with %d\n%s" % (seed, night + 1, done.returncode, done.stderr))
        if given.plain:
            events = tomllib.loads((folder / "site" / "events.toml").read_text()).get("event", [])
            histories.append(plain.history(folder / "out", events, line=True))
            (folder / ("history-%02d.json" % (night + 1))).write_text(json.dumps(histories[-1]))
            continue
        for what, said in (("history", histories), ("morning", mornings)):
            told = subprocess.run([program, what, str(folder / "out"), "--json"], capture_output=True, text=True)
            if told.returncode not in (0, 1):
                raise SystemExit("seed %d, night %d: %s ended with %d\n%s" % (seed, night + 1, what, told.returncode, told.stderr))
            (folder / ("%s-%02d.json" % (what, night + 1))).write_text(told.stdout)
            said.append(json.loads(told.stdout))
    truths.save(truth, folder / "truth.json")
    return truth, histories, mornings


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], epilog=__doc__.split("\n\n", 1)[1],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--preset", choices=("lab", "quiet", "drifting", "mixed", "small"), default="mixed")
    for name, value in (("sites", 200), ("seed", 1), ("nights", 2), ("machines", None), ("count", None)):
        parser.add_argument("--" + name, type=int, default=value)
    for name in ("known", "plain"):
        parser.add_argument("--" + name, action="store_true")
    given = parser.parse_args()
    if given.folder.exists() and any(given.folder.iterdir()):
        raise SystemExit("%s: expected an empty folder" % given.folder)
    total = score.Score()
    for seed in range(given.seed, given.seed + given.sites):
        folder = given.folder / str(seed)
        folder.mkdir(parents=True)
        truth, histories, mornings = nights_of(given.program, folder, given, seed)
        total.add(truths.rounded(truth), histories, mornings)
        shutil.rmtree(folder / "site")
        shutil.rmtree(folder / "out")
    print("preset %s, seeds %d to %d, %d nights each" % (given.preset, given.seed, given.seed + given.sites - 1, given.nights))
    print(total.text())
    return 1 if total.fails() else 0


if __name__ == "__main__":
    sys.exit(main())
