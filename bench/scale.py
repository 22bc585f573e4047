#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""scale.py PROGRAM [FEW MANY]: the cost of one more campaign in each step of a run: calls of the file system (strace), CPU time,
files, bytes and memory of the plan. Each is the difference of two sites of FEW and MANY campaigns (100 and 300; for the
memory 100 times as many), divided by the difference of their numbers. The constants of docs/dev/scale.md; TMPDIR selects the disk."""
import collections
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

import campaigns

TRACED = ("openat,open,creat,rename,renameat,renameat2,newfstatat,stat,lstat,statx,access,faccessat,faccessat2,readlink,readlinkat,"
          "mkdir,mkdirat,unlink,unlinkat,rmdir,fsync,fdatasync,syncfs,getdents64,link,linkat,pread64")
KINDS = (("pread64", "pread of a pack"), ("rename", "rename"), ("newfstatat", "stat"), ("lstat", "stat"), ("statx", "stat"), ("access", "stat"), ("faccessat", "stat"))


def make(site, count):
    """With the outputs that a site has by itself; in folders of a thousand."""
    text = campaigns.MANIFEST.replace("outputs = []\n", "")
    site.mkdir()
    (site / "site.toml").write_text("format = 1\n")
    for i in range(count):
        folder = site / f"{i // 1000:05}" / f"c{i:07}"
        folder.mkdir(parents=True)
        (folder / "campaign.toml").write_text(text.format(i))
        (folder / "x.csv").write_text(campaigns.readings(i))


def kind_of(name, line):
    if name in ("openat", "open"):
        return "create" if "O_CREAT" in line else "open folder" if "O_DIRECTORY" in line else "open to read"
    return next((kind for begin, kind in KINDS if name.startswith(begin)), name)


# As docs/dev/scale.md counts them; a page of a pack is part of a request of 256 kB.
OPERATIONS = {"create": 4, "open to read": 3, "rename": 1, "mkdir": 1, "open folder": 2, "pread of a pack": 16 / 256}


def calls(root, command, below=None):
    """On files below `root`, or another folder, also by way of an open one."""
    trace = root / "trace"
    below = str(below or root)
    subprocess.run(["strace", "-f", "-y", "-qq", "-s", "200", "-e", f"trace={TRACED}", "-o", trace, *command], stdout=subprocess.DEVNULL, check=False)
    counts = collections.Counter()
    with open(trace, errors="replace") as lines:
        for line in lines:
            call = re.match(r"\d+\s+(\w+)\(", line)
            if call and below in line and (call[1] != "pread64" or ".sqlar" in line):
                counts[kind_of(call[1], line)] += 1
    counts["operations of NFS"] = sum(n * counts[kind] for kind, n in OPERATIONS.items())
    return counts


def cpu(_, command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, stdout=subprocess.DEVNULL, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return collections.Counter(user=after.ru_utime - before.ru_utime, system=after.ru_stime - before.ru_stime)


def steps(site, parts, out, packs, scratch):
    return {"first night": ["run", site, "--out", out, "--jobs", "1"], "unchanged night": ["run", site, "--out", out, "--jobs", "1"],
            "plan": ["run", "plan", site, "--out", parts, "--shards", "1"],
            "shard": ["run", site, "--out", parts, "--shard", "0/1", "--jobs", "1"], "merge": ["run", "merge", parts],
            "plan of packs": ["run", "plan", site, "--out", packs, "--shards", "1"],
            "packed shard": ["run", site, "--out", packs, "--shard", "0/1", "--jobs", "1", "--pack", "--scratch", scratch],
            "merge of packs": ["run", "merge", packs], "unchanged night of packs": ["run", site, "--out", packs, "--jobs", "1"]}


def compare(program, root, counts, scratch):
    """`scratch`: a folder elsewhere, which is on the host's own disk and not counted."""
    on_results = (lambda folder, command: calls(folder, command, next(c for c in command if "/packs-" in c or "/parts-" in c or "/out-" in c)))
    for how, of in (("calls", calls), ("calls on results", on_results), ("CPU, ms", cpu)):
        measured = {}
        for n in counts:
            site, out, parts, packs = (root / f"{what}-{n}" for what in ("site", "out", "parts", "packs"))
            for folder in (out, parts, packs):
                shutil.rmtree(folder, ignore_errors=True)
            if not site.exists():
                make(site, n)
            measured[n] = {name: of(root, [program, *map(str, step), "--quiet"])
                           for name, step in steps(site, parts, out, packs, scratch).items()}
            files = [p for p in out.rglob("*") if p.is_file()]
            measured[n]["results"] = collections.Counter(files=len(files), bytes=sum(p.stat().st_size for p in files))
        few, many = counts
        for name in measured[few]:
            scale = 1000.0 if of is cpu and name != "results" else 1.0
            each = {k: (measured[many][name][k] - measured[few][name][k]) * scale / (many - few) for k in sorted(measured[many][name])}
            print(how, name, {k: round(v, 2) for k, v in each.items() if abs(v) >= 0.01}, flush=True)


def memory(program, root, counts):
    peaks = []
    for n in counts:
        site = root / f"large-{n}"
        make(site, n)
        process = subprocess.Popen([program, "run", "plan", site, "--out", root / f"plan-{n}", "--shards", "64", "--quiet"])
        peak = 0.0
        while process.poll() is None:
            peak = max(peak, campaigns.peak_memory(process))
            time.sleep(0.01)
        peaks.append(peak)
    few, many = counts
    print(f"memory of the plan: {peaks[0]:.1f} and {peaks[1]:.1f} MiB for {few} and {many} campaigns: "
          f"{(peaks[1] - peaks[0]) * 2**20 / (many - few):.0f} bytes each", flush=True)


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    few, many = map(int, sys.argv[2:4] or (100, 300))
    with tempfile.TemporaryDirectory(prefix="nonio-scale-") as folder:
        with tempfile.TemporaryDirectory(prefix="nonio-own-disk-") as scratch:
            compare(program, pathlib.Path(folder), (few, many), pathlib.Path(scratch))
        memory(program, pathlib.Path(folder), (100 * few, 100 * many))


if __name__ == "__main__":
    main()
