#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The history of many campaigns and the worklist: made from nothing, and updated after 100 new campaigns.

    python3 bench/history_store.py build/ci [CAMPAIGNS] [FOLDER] [postgresql://...]

Writes results.json and run.json of 100,000 made-up campaigns (3000 machines or, of fewer campaigns, one for 33 of them; two axes, 44 numbers with
covariance each) and lets bench_history do the rest. With an address the store is on that server, in a schema bench.
"""
import hashlib
import json
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

SEED = 20260319
TEMPLATES = pathlib.Path(__file__).resolve().parent.parent / "templates"
QUANTITIES = ["scale", "B_mean", "ln_s", "cyclic_cos", "cyclic_sin", "curve_2", "curve_3", "curve_4"]
VALUES = ["A", "A+", "A-", "E", "E+", "E-", "M", "R", "R+", "R-", "B", "B_mean"]


def results(rng, campaign, machine, day):
    followed, covariance, analyses = [], [], []
    for axis in "XY":
        covariance.append({"first": len(followed), "count": len(QUANTITIES),
                           "upper": [round(rng.uniform(0, 0.1), 9) for _ in range(len(QUANTITIES) * (len(QUANTITIES) + 1) // 2)]})
        for q in QUANTITIES:
            followed.append({"measurement": axis, "axis": axis, "quantity": q, "unit": "um", "value": round(rng.gauss(0, 0.3), 9),
                             "u": round(rng.uniform(0.2, 0.3), 9), "state": "as-found",
                             "common": [{"source": "instrument Sample Optics L-001 SO-2026-0001 2026-01-12", "u": 0.3}],
                             "conditions": {"from": 13.2, "to": 986.5, "compensation": "on"}})
        analyses.append({"plugin": "iso230-2", "version": "1", "measurement": axis,
                         "values": {v: {"value": round(rng.uniform(1, 9), 9), "unit": "um", "U": 1.9, "k": 2.0} for v in VALUES},
                         "points": [{"target": 50.0 * i, **{k: round(rng.gauss(0, 3), 9) for k in ("mean+", "mean-", "s+", "s-", "B")}}
                                    for i in range(11)],
                         "findings": [{"id": "reversal.constant", "severity": "info", "evidence": {}, "advice": "Nothing to do."}]})
    return {"schema": "nonio-results/1",
            "campaign": {"id": campaign, "date": day, "machine": {"maker": "Sample", "model": "V", "serial": machine, "asset": machine},
                         "instrument": {"maker": "Sample Optics", "serial": "L-001", "certificate": "SO-2026-0001", "calibrated": "2026-01-12"}},
            "status": "ok", "errors": [], "analyses": analyses, "followed": followed, "followed_covariance": covariance,
            "outputs": []}


def write(out, campaign, night, rng, kinds, machines, day=None):
    folder = out / campaign
    folder.mkdir()
    day = day or f"{2021 + rng.randrange(5)}-{1 + rng.randrange(12):02}-{1 + rng.randrange(28):02}"
    text = kinds[rng.randrange(len(kinds))].replace("CAMPAIGN", campaign).replace("MACHINE", f"S-{rng.randrange(machines):04}").replace("DAY", day)
    (folder / "results.json").write_text(text)
    (folder / "run.json").write_text(json.dumps({
        "schema": "nonio-run/2", "folder": campaign, "night": night, "date": "2026-03-02", "reason": "", "status": "ok", "retry": False,
        "inputs": {"version": "1", "campaign.toml": hashlib.sha256(campaign.encode()).hexdigest()},
        "files": {"results.json": [len(text), hashlib.sha256(text.encode()).hexdigest()]},
        "errors": [], "findings": [], "previous_findings": []}, indent=1))


def main():
    build = pathlib.Path(sys.argv[1])
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 100_000
    machines = max(1, min(3000, count // 33))
    above = pathlib.Path(tempfile.mkdtemp(prefix="nonio-history-", dir=sys.argv[3] if len(sys.argv) > 3 else None))
    out = above / "out"
    try:
        rng = random.Random(SEED)
        (out / ".nonio").mkdir(parents=True)
        kinds = [json.dumps(results(rng, "CAMPAIGN", "MACHINE", "DAY"), indent=1) + "\n" for _ in range(200)]
        for i in range(count):
            write(out, f"c{i:06}", 1, rng, kinds, machines)
        print(f"seed {SEED}, {count} campaigns", flush=True)
        program = next(p for p in build.rglob("bench_history") if p.is_file())
        if len(sys.argv) > 4:
            subprocess.run([program, "server", out, sys.argv[4]], check=True)
        subprocess.run([program, "rebuild", out], check=True)
        subprocess.run([program, "status", "--actions", out, TEMPLATES], check=True)
        new = [f"n{i:03}" for i in range(100)]
        for campaign in new:  # measured after all others, as new campaigns are
            write(out, campaign, 2, rng, kinds, machines, "2026-03-19")
        subprocess.run([program, "update", out, *new], check=True)
        subprocess.run([program, "status", "--actions", out, TEMPLATES], check=True)
        subprocess.run([program, "status", "--actions", out, TEMPLATES], check=True)
        for name in ("history.sqlite", "index.html", ".nonio/machines.sqlite"):
            if (out / name).exists():
                print(f"{name}: {(out / name).stat().st_size / 1e6:.1f} MB")
    finally:
        shutil.rmtree(above)


if __name__ == "__main__":
    main()
