#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""margins.py NONIO FILE...: how far files of readings are from the bounds of docs/dev/wrong-inputs.md. Runs the program over
each file (CSV of one axis, or .rtl) as a campaign of its own, prints its findings plausibility.*, and for each bound on
readings alone the value of the file that comes nearest to it. Status 1 if a file is called implausible."""
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile


def rows_of(path):
    lines = [l for l in path.read_text(encoding="utf-8-sig").splitlines() if l.strip() and not l.startswith("#")]
    head = lines[0].split(",")
    if head[:2] != ["run", "direction"]:
        return head, []
    return head, [(int(f[0]), f[1], float(f[2]), float(f[3])) for f in (l.split(",") for l in lines[1:])]


def figures(head, rows):
    """name -> (value of the file, bound, whether it must stay above)"""
    rotary = "deg" in head[2]
    values = [v for *_, v in rows]
    cells = {}
    for run, d, t, v in rows:
        cells.setdefault((t, d), []).append(v)
    medians = {k: statistics.median(v) for k, v in cells.items()}
    span = max(t for _, _, t, _ in rows) - min(t for _, _, t, _ in rows)
    size = max(medians.values()) - min(medians.values())
    t0, m0 = statistics.fmean(t for t, _ in medians), statistics.fmean(medians.values())
    unit = 3600.0 if rotary else 1000.0
    slope = (sum((k[0] - t0) * (m - m0) for k, m in medians.items()) / sum((k[0] - t0) ** 2 for k in medians)) / unit
    scatter = [statistics.stdev(v) for v in cells.values() if len(v) > 1]
    out = {"deviation over position": (abs(slope), 0.02, False),
           "range of the medians, share of the way": (size / unit / span, 0.05, False),
           "range of all readings": (max(values) - min(values), 0.02 if rotary else min(0.05, 1e-3 * span), True)}
    if scatter:
        out["median scatter"] = (statistics.median(scatter), 200.0 if rotary else 500.0, False)
    sizes = {}
    for run, d, t, v in rows:
        sizes.setdefault((run, d), []).append(v)

    def spread(v):
        far = sorted(abs(x - statistics.median(v)) for x in v)[:-2]
        return math.sqrt(sum(x * x for x in far) / len(far))
    spreads = [spread(v) for v in sizes.values() if len(v) >= 6]
    if len(spreads) >= 3:
        middle = statistics.median(spreads)
        out["size of a pass against the others"] = (max(max(s / middle, middle / s) for s in spreads), 8.0, False)
    if (apart := two_curves(rows)) is not None:
        out["two parts of the runs apart, squares"] = (apart, 25.0, False)
    return out


def two_curves(rows):
    """Squares of the means of two parts of the runs apart, over those of one run about its part's mean; a line of each run
    is out."""
    runs, directions = sorted({r for r, *_ in rows}), {d for _, d, *_ in rows}
    cells = {(r, d, t): v for r, d, t, v in rows}
    targets = sorted(t for t in {t for _, _, t, _ in rows} if all((r, d, t) in cells for r in runs for d in directions))
    if len(targets) < 6 or len(runs) < 4:
        return None

    def straightened(r):
        v = [statistics.fmean(cells[r, d, t] for d in directions) for t in targets]
        t0, v0 = statistics.fmean(targets), statistics.fmean(v)
        slope = sum((t - t0) * (x - v0) for t, x in zip(targets, v)) / sum((t - t0) ** 2 for t in targets)
        return [x - v0 - slope * (t - t0) for t, x in zip(targets, v)]
    curves, most = [straightened(r) for r in runs], 0.0
    for gap in (0, 1):
        for k in range(2, len(runs) - gap - 1):
            parts = [curves[:k], curves[k + gap:]]
            means = [[statistics.fmean(c) for c in zip(*part)] for part in parts]
            squares = sum((x - m) ** 2 for part, mean in zip(parts, means) for c in part for x, m in zip(c, mean))
            scatter = squares / ((len(runs) - gap - 2) * (len(targets) - 2))
            apart = statistics.fmean((a - b) ** 2 for a, b in zip(*means))
            if scatter > 0 and apart >= 0.1 * max(statistics.fmean(x * x for x in m) for m in means):
                most = max(most, apart / scatter)
    return most


def main():
    nonio, files = sys.argv[1], [pathlib.Path(f) for f in sys.argv[2:]]
    nearest, alarms = {}, 0
    with tempfile.TemporaryDirectory(prefix="nonio-margins-") as folder:
        root = pathlib.Path(folder)
        for i, path in enumerate(files):
            head, rows = rows_of(path) if path.suffix == ".csv" else ([], [])
            rotary = any("deg" in h for h in head)
            into = root / "site" / f"f{i}"
            into.mkdir(parents=True)
            (into / path.name).write_bytes(path.read_bytes())
            axis = "C" if rotary else "X"
            (into / "campaign.toml").write_text(
                f'format = 1\n[campaign]\nid = "f{i}"\n[machine.axes.{axis}]\nkind = "{"rotary" if rotary else "linear"}"\n'
                + f'[[measurement]]\nid = "{axis}"\nkind = "axis"\naxis = "{axis}"\nfile = "{path.name}"\n')
            for name, (value, bound, above) in (figures(head, rows) if rows else {}).items():
                margin = value / bound if above else bound / value if value else math.inf
                if name not in nearest or margin < nearest[name][0]:
                    nearest[name] = (margin, value, bound, path.name)
        subprocess.run([nonio, "run", str(root / "site"), "--out", str(root / "out"), "--quiet"], capture_output=True)
        for i, path in enumerate(files):
            content = json.loads((root / "out" / f"f{i}" / "results.json").read_text())
            found = sorted({f["id"] for a in content["analyses"] for f in a["findings"] if f["id"].startswith("plausibility.")})
            alarms += bool(found)
            print(f"{path.name}: {', '.join(found) or 'none'}" + "".join(f"; refused: {e['message'][:90]}" for e in content["errors"]))
    for name, (margin, value, bound, file) in nearest.items():
        print(f"{name}: nearest {value:.6g} ({file}), bound {bound:g}, margin a factor of {margin:.3g}")
    print(f"{alarms} of {len(files)} files called implausible")
    sys.exit(1 if alarms else 0)


if __name__ == "__main__":
    main()
