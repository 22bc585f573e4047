#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the tests that claim to see a mistake against each mutant: run_mutants.py MUTANTS.toml... NAME=PROGRAM...

First without a mutant, where they must pass; then with each, where they must fail (exit status 1, or a test that
failed before the program crashed: a crash or a time-out alone shows nothing). LD_PRELOAD puts the mutants in place, or
--plugins: the folder that has, for each file of mutants, a folder of its name with the mutated plugins."""
import argparse
import os
import pathlib
import subprocess
import sys
import tomllib

CASES = pathlib.Path(__file__).resolve().parent.parent / "cases"


def command(programs, killers):
    """One list of arguments; `tests` are case files or a filter of GoogleTest."""
    program, tests = killers["program"], killers["tests"]
    if isinstance(tests, str):
        return [programs[program], f"--gtest_filter={tests}"]
    return [programs[program], *(str(CASES / f"{name}.case") for name in tests)]


def run(arguments, plugins, mutant=None):
    environment = {k: v for k, v in os.environ.items() if k != "NONIO_MUTANT"}
    if mutant:
        environment["NONIO_MUTANT"] = mutant
    if plugins:
        environment["NONIO_TEST_PLUGINS"] = str(plugins)
    done = subprocess.run(arguments, env=environment, capture_output=True, text=True, timeout=300)
    return done.returncode, done.stdout + done.stderr


def check(file, programs, plugins):
    """The number of mutants of one file that are not as they must be, and of all."""
    declared = tomllib.loads(file.read_text())
    killers = {name: command(programs, {**declared, **mutant}) for name, mutant in declared["mutant"].items()}
    wrong = 0
    for arguments in {tuple(k) for k in killers.values()}:
        status, said = run(arguments, plugins)
        if status != 0 or "Running 0 tests" in said:
            wrong += 1
            print(f"{file.stem} without a mutant: expected the tests to run and pass, found status {status}\n"
                  f"{' '.join(arguments)}\n{said}")
    for name, arguments in killers.items():
        status, said = run(arguments, plugins, f"{file.stem}.{name}")
        if status < 0 and "[  FAILED  ]" in said:
            status = 1
        verdict = {0: "survived", 1: "killed"}.get(status, f"stopped with status {status}, which no test saw")
        print(f"{file.stem}.{name}: {verdict}")
        if status != 1:
            wrong += 1
            print(f"{' '.join(arguments)}\n{said[-3000:]}")
    return wrong, len(killers)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--plugins", type=pathlib.Path)
    parser.add_argument("arguments", nargs="+")
    options = parser.parse_args()
    programs = dict(argument.split("=", 1) for argument in options.arguments if "=" in argument)
    results = [check(file, programs, options.plugins and options.plugins / file.stem)
               for file in map(pathlib.Path, options.arguments) if file.suffix == ".toml"]
    wrong, mutants = (sum(column) for column in zip(*results))
    print(f"{mutants} mutants, {wrong} not as they must be")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
