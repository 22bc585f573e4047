#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the CPU time of a release build from nothing, for each part of the source tree.

  build_cost.py BUILD-FOLDER [--jobs N] [--target NAME ...] [--largest N] [CMake arguments]

As the launcher of compiler and linker it adds one line per command to the file in NONIO_BUILD_COST.
"""
import argparse
import collections
import os
import pathlib
import resource
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent
PARTS = ("engine/sdk", "engine/math", "engine/model", "engine/pdf", "engine/sign", "engine/laboratory/statistics",
         "engine/app", "engine", "reports", "plugins")


def launch(command):
    """Runs one command and notes its CPU time and what it makes."""
    status = subprocess.call(command)
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    made = command[command.index("-o") + 1] if "-o" in command else command[-1]
    if not made.endswith(".o"):  # a link: its first object states the part
        made = next((word for word in command if word.endswith(".o")), made) + " (link)"
    with open(os.environ["NONIO_BUILD_COST"], "a", encoding="utf-8") as log:
        log.write(f"{usage.ru_utime + usage.ru_stime:.2f}\t{made}\n")
    return status


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("folder", type=pathlib.Path)
    arguments.add_argument("--jobs", type=int, default=2)
    arguments.add_argument("--target", nargs="+", default=["all"], help="build only these, as nonio_math nonio_model")
    arguments.add_argument("--largest", type=int, default=0, help="also print the commands that take the most time")
    options, rest = arguments.parse_known_args()
    log = options.folder.resolve() / "build_cost.tsv"
    options.folder.mkdir(parents=True, exist_ok=True)
    log.unlink(missing_ok=True)
    me = f"{sys.executable};{pathlib.Path(__file__).resolve()};--launch"
    environment = {**os.environ, "NONIO_BUILD_COST": str(log), "CCACHE_DISABLE": "1"}
    subprocess.run(["cmake", "--preset", "release", "-S", SOURCE, "-B", options.folder, *rest,
                    f"-DCMAKE_CXX_COMPILER_LAUNCHER={me}", f"-DCMAKE_CXX_LINKER_LAUNCHER={me}"],
                   check=True, stdout=subprocess.DEVNULL, cwd=SOURCE)
    subprocess.run(["cmake", "--build", options.folder, "--clean-first", f"-j{options.jobs}",
                    "--target", *options.target],
                   check=True, stdout=subprocess.DEVNULL, env=environment)
    seconds = collections.Counter()
    commands = collections.Counter()
    rows = [(float(time), made) for time, made in
            (line.split("\t") for line in log.read_text(encoding="utf-8").splitlines())]
    for time, made in rows:
        part = next((part for part in PARTS if made.startswith(part + "/")), "others")
        seconds[part] += time
        commands[part] += 1
    print("| part | commands | CPU s |\n|---|---|---|")
    for part in (*PARTS, "others"):
        if commands[part]:
            name = "the products" if part == "engine" else part
            print(f"| {name} | {commands[part]} | {seconds[part]:.0f} |")
    print(f"| sum | {len(rows)} | {sum(seconds.values()):.0f} |")
    for time, made in sorted(rows, reverse=True)[:options.largest]:
        print(f"{time:7.2f}  {made}")


if __name__ == "__main__":
    sys.exit(launch(sys.argv[2:]) if sys.argv[1:2] == ["--launch"] else main())
