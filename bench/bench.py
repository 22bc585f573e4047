# SPDX-License-Identifier: Apache-2.0
"""bench.py NONIO [--campaigns 1000] [--unchanged 10000]: the cost of the nightly run, compared with that of a Python
pipeline with the same outputs in the same session; then the time of each stage (bench_campaign, if it was built next to
NONIO), and the limit: the cost of writing the same files, their digests and the deflate of the pages alone (limit.py).
Prints tables; asserts nothing. TMPDIR selects the disk."""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

import limit

HERE = pathlib.Path(__file__).parent


def timed(command, cores, worst_status=1):
    """Wall seconds, CPU seconds with all children, and the largest memory in MB of the main process
    alone, on `cores` cores."""
    began = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               preexec_fn=lambda: os.sched_setaffinity(0, set(range(cores))))
    largest, ended = [0.0], threading.Event()

    def watch():
        while not ended.wait(0.02):
            try:
                status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
            except OSError:
                return
            largest[0] = max([largest[0], *(int(s) / 1024 for s in re.findall(r"VmHWM:\s+(\d+)", status))])

    watcher = threading.Thread(target=watch)
    watcher.start()
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - began
    ended.set()
    watcher.join()
    if os.waitstatus_to_exitcode(status) > worst_status:
        sys.exit(f"{command} failed: {status}")
    return wall, usage.ru_utime + usage.ru_stime, largest[0]


def beside(commands):
    """Wall seconds of commands that run at once, each on a core of its own."""
    began = time.monotonic()
    running = {subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                preexec_fn=lambda core=core: os.sched_setaffinity(0, {core})).pid
               for core, command in enumerate(commands)}
    walls = []
    while running:
        pid, _ = os.wait()
        running.discard(pid)
        walls.append(time.monotonic() - began)
    return walls


def processor_seconds(pid):
    """CPU time of a process and of its children that have ended."""
    try:
        fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return 0.0
    return sum(int(x) for x in fields[11:15]) / os.sysconf("SC_CLK_TCK")


def evaluating(parent):
    """CPU time of the processes that evaluate, by their ids: only they have two filters of system calls."""
    found = {}
    for pid in pathlib.Path(f"/proc/{parent}/task/{parent}/children").read_text().split():
        try:
            status = pathlib.Path(f"/proc/{pid}/status").read_text()
        except OSError:
            continue
        if re.search(r"^Seccomp_filters:\s+2$", status, re.M):
            found[pid] = processor_seconds(pid)
    return found


def budget(command, campaigns):
    """The CPU time of each stage of a run, from its own reports of the stages."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                               preexec_fn=lambda: os.sched_setaffinity(0, {0}))
    spent, evaluated, stage, began = {}, {}, "start", 0.0
    for line in process.stdout:
        event = json.loads(line)
        if event["event"] == "stage":
            now = processor_seconds(process.pid)
            spent[stage] = now - began
            stage, began = event["name"], now
        elif event["event"] == "campaign":
            evaluated.update(evaluating(process.pid))
    usage = os.wait4(process.pid, 0)[2]
    spent[stage] = usage.ru_utime + usage.ru_stime - began
    spent["of campaigns: reading, analyses, tables, documents"] = sum(evaluated.values())
    for name, seconds in spent.items():
        print(f"{1e3 * seconds / campaigns:8.2f} ms  {name}")


def stages(nonio, site, out):
    """A line a stage, all in one process."""
    program = nonio.parent / "bench_campaign"
    if not program.exists():
        print(f"no stages: there is no {program}; build its target")
        return
    plugins = next(nonio.parent.parent.glob("lib/**/nonio/plugins"))
    templates = nonio.parent.parent / "share" / "nonio" / "templates"
    subprocess.run([program, site, out, plugins, templates], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("nonio")
    parser.add_argument("--campaigns", type=int, default=1000)
    parser.add_argument("--unchanged", type=int, default=10000)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="nonio-bench-") as folder:
        root = pathlib.Path(folder)
        site, n = root / "site", args.campaigns
        subprocess.run([sys.executable, HERE / "make_site.py", site, str(n)], check=True)
        run = [args.nonio, "run", site, "--quiet", "--out"]
        rows = []
        one, one_cpu, memory = timed([*run, root / "one", "--jobs", "1"], 1)
        rows.append(("nonio, one worker on one core", n / one, memory))
        peer, peer_cpu, peer_memory = timed([sys.executable, HERE / "peer.py", site, root / "peer"], 1, 0)
        rows.append(("Python pipeline on one core", n / peer, peer_memory))
        two, _, memory2 = timed([*run, root / "two", "--jobs", "2"], 2)
        rows.append(("nonio, two workers on two cores", n / two, memory2))
        for name, rate, mb in rows:
            print(f"{name:36} {rate:8.1f} campaigns/s   {mb:6.1f} MB")
        print(f"nonio against Python, per core: {peer / one:.1f} times (CPU time: {peer_cpu / one_cpu:.1f} times, "
              f"{1e3 * one_cpu / n:.1f} against {1e3 * peer_cpu / n:.1f} ms)")
        print(f"two workers against one: {one / two:.2f} times")
        walls = beside([[*run, root / f"beside-{core}", "--jobs", "1"] for core in range(2)])
        print(f"two runs of one worker at once, one on each core: {sum(one / wall for wall in walls):.2f} times; "
              "what this machine and its disk give")
        print("CPU time of the run for each campaign:")
        budget([args.nonio, "run", site, "--json", "--jobs", "1", "--out", root / "budget"], n)
        print("where the CPU time of evaluating and storing goes, in one process:", flush=True)
        stages(pathlib.Path(args.nonio).resolve(), site, root / "stages")
        print("the limit, CPU time a campaign:")
        least = limit.print_limits(root / "one")
        print(f"Nonio takes {one_cpu / n / least:.1f} times the limit")
        sample = root / "one" / "bench-000000"
        print("outputs of one campaign:", json.dumps({p.name: p.stat().st_size for p in sorted(sample.iterdir())}))
        small, _, small_memory = timed([*run, root / "one", "--jobs", "1"], 2)
        print(f"{n} unchanged: {small:.2f} s, {small_memory:.1f} MB")
        if args.unchanged:
            big = root / "big"
            subprocess.run([sys.executable, HERE / "make_site.py", big, str(args.unchanged)], check=True)
            command = [args.nonio, "run", big, "--quiet", "--out", root / "bigout"]
            _, _, first_memory = timed(command, 2)
            seconds, _, again_memory = timed(command, 2)
            print(f"{args.unchanged} campaigns: {first_memory:.1f} MB in the first run; "
                  f"unchanged: {seconds:.2f} s, {again_memory:.1f} MB")


if __name__ == "__main__":
    main()
