#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the ```console blocks of a document and compares what it shows with what comes out.

A line `$ command` is run by bash, all of a document in one fresh folder that holds a copy of samples/; the lines below it
are its output and errors, byte for byte. Every command must end with status 0. Figures of the text between the blocks that
have a decimal point or stand before a % must occur in some output.

    NONIO=build/dev/bin/nonio tests/docs/shown_test.py [--update] [--keep FOLDER] DOCUMENT
"""
import argparse
import difflib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PROJECT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FIGURE = re.compile(r"(?<![\w.])\d+\.\d+|\b\d+(?= %)")


class Runner:
    def __init__(self, folder):
        shutil.copytree(PROJECT / "samples", folder / "samples")
        programs = pathlib.Path(os.environ["NONIO"]).resolve().parent
        self.folder = folder
        self.environment = {"PATH": f"{programs}:{os.environ['PATH']}", "HOME": str(folder), "LC_ALL": "C"}
        self.outputs, self.failures = [], []

    def block(self, match):
        """The block as it comes out."""
        shown = []
        for line in match.group(1).splitlines():
            if not line.startswith("$ "):
                continue
            done = subprocess.run(["bash", "-c", line[2:]], cwd=self.folder, env=self.environment, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            if done.returncode != 0:
                self.failures.append(f"status {done.returncode}: {line}\n{done.stdout}")
            self.outputs.append(done.stdout)
            shown += [line, *(text.rstrip() for text in done.stdout.splitlines())]
        return "```console\n" + "\n".join(shown) + "\n```"


def unsaid_figures(text, outputs):
    """Figures of the text that no output has."""
    said = set(FIGURE.findall("\n".join(outputs)))
    prose = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    prose = re.sub(r"`[^`\n]*`|\]\([^)]*\)", "", prose)
    return [figure for figure in FIGURE.findall(prose) if figure not in said]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("document", type=pathlib.Path)
    parser.add_argument("--update", action="store_true", help="write what comes out into the document")
    parser.add_argument("--keep", type=pathlib.Path, help="leave the files in this new folder")
    options = parser.parse_args()
    document = PROJECT / options.document
    text = document.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory(prefix="nonio-docs-") as folder:
        runner = Runner(pathlib.Path(folder))
        found = BLOCK.sub(runner.block, text)
        if options.keep:
            shutil.copytree(folder, options.keep)
    if not runner.outputs:
        runner.failures.append(f"{options.document}: there is no command in it")
    if options.update:
        document.write_text(found, encoding="utf-8")
    elif found != text:
        runner.failures.append("".join(difflib.unified_diff(
            text.splitlines(True), found.splitlines(True), f"{options.document} as it is", "as it comes out")))
    if "tutorial" in document.name:
        runner.failures += [f"no output has the figure {figure} of the text"
                            for figure in unsaid_figures(found, runner.outputs)]
    for failure in runner.failures:
        print(failure)
    return 1 if runner.failures else 0


if __name__ == "__main__":
    sys.exit(main())
