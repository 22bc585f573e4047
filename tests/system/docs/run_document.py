#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of documents, those of each in one new folder that holds a copy of samples/, as in one terminal of
100 columns.

```console  lines `$ COMMAND`; the lines below each are its output and errors, byte for byte
```sh       one command per line
A line that ends with \\ goes on in the next. Status 0 is required, or 1 if `# status 1` follows the command.

Comments, which a reader of the page does not see:
<!-- not run: REASON -->        the next block is not run
<!-- file: PATH -->             the next block is put into this file
<!-- here: PATH is SOURCE -->   PATH is a copy of a file or folder of the project

A block of data in which a line looks like a command is a fault, and so is an indented block. In a tutorial the figures of
the text that have a decimal point or are followed by % must occur in some output.

    NONIO=build/dev/bin/nonio tests/system/docs/run_document.py [--update] [--keep FOLDER] DOCUMENT...
"""
import argparse
import contextlib
import difflib
import fcntl
import os
import pathlib
import pty
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
import time

import document

COLUMNS = 100  # of the terminal: what a reader sees
PROJECT = pathlib.Path(__file__).resolve().parents[3]
STATUS = re.compile(r"\s# status (\d+)\b[^\n]*$")
FIGURE = re.compile(r"(?<![\w.])\d+\.\d+|\b\d+(?= %)")


class Terminal:
    """Runs commands; variables that are exported and the folder stay as the last command left them."""

    def __init__(self, folder, programs):
        self.folder = folder
        self.state = folder.parent / "state"
        self.environment = {"PATH": f"{programs}:{os.environ['PATH']}", "HOME": str(folder), "LC_ALL": "C", "NONIO_ALLOW_ROOT": "1",
                            "NO_COLOR": "1", "TERM": "dumb",
                            "TMPDIR": str(folder.parent), "CMAKE_GENERATOR": "Ninja", "PYTHONDONTWRITEBYTECODE": "1",
                            "PYTHONPATH": str(programs.parent / "lib/python3/dist-packages")}
        for name in ("CXX", "CMAKE_CXX_COMPILER_LAUNCHER"):
            if os.environ.get(name):
                self.environment[name] = os.environ[name]
        if os.environ.get("CMAKE_CXX_COMPILER_LAUNCHER", "").endswith("ccache"):
            # Its cache is not that of HOME, and the name of the new folder does not count.
            cache = subprocess.run(["ccache", "--get-config", "cache_dir"], check=True, capture_output=True, text=True)
            self.environment |= {"CCACHE_DIR": cache.stdout.strip(), "CCACHE_BASEDIR": str(folder.parent), "CCACHE_NOHASHDIR": "1"}

    def run(self, command):
        """(status, output and errors)."""
        restored = f'. "{self.state}"\n' if self.state.exists() else ""
        kept = f"""trap '{{ export -p; echo "cd \\"$PWD\\""; }} > "{self.state}"' EXIT\n"""
        mine, terminal = pty.openpty()
        raw = termios.tcgetattr(terminal)
        raw[1] &= ~termios.OPOST  # no carriage return at the end of a line
        termios.tcsetattr(terminal, termios.TCSANOW, raw)
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 50, COLUMNS, 0, 0))
        with subprocess.Popen(["bash", "-c", restored + kept + command], cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, stdout=terminal, stderr=terminal) as process:
            os.close(terminal)
            output = b""
            with contextlib.suppress(OSError):  # how a terminal ends
                while part := os.read(mine, 65536):
                    output += part
            os.close(mine)
        return process.returncode, output.decode()


class Run:
    """One document run: what was said, what failed, and its text as it comes out."""

    def __init__(self, name, text, terminal):
        self.name, self.text, self.terminal = name, text, terminal
        self.outputs, self.failures = [], []
        self.lines = text.splitlines()

    def all(self):
        parts, faults = document.parts_of(self.text)
        self.failures += [f"{self.name}:{line}: {message}" for line, message in faults]
        shown = []
        for part in [] if faults else parts:
            if isinstance(part, document.Note):
                self.put(part)
            elif part.kind == "not run":
                print(f"{self.name}:{part.line}: not run: {part.note}")
            elif part.kind == "file":
                self.write(part)
            elif part.language in document.COMMANDS:
                shown.append((part, self.commands(part)))
        for block, lines in reversed(shown):
            if block.language == "console":
                self.lines[block.line:block.line + len(block.lines)] = [(block.indent + line).rstrip() for line in lines]

    def put(self, note):
        source, target = PROJECT / note.source, self.terminal.folder / note.target
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, dirs_exist_ok=True)
        elif source.is_file():
            shutil.copy(source, target)
        else:
            self.failures.append(f"{self.name}:{note.line}: there is no {note.source}")

    def write(self, block):
        file = self.terminal.folder / block.note
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(block.lines) + "\n", encoding="utf-8")

    def commands(self, block):
        """The block's lines as they come out."""
        lines = []
        for command_lines, number, _ in document.steps_of(block):
            command = "\n".join(command_lines)
            wanted = STATUS.search(command)
            began = time.monotonic()
            status, output = self.terminal.run(command.removeprefix("$ "))
            print(f"{time.monotonic() - began:7.2f} s  {self.name}:{number}: {command}")
            if status != (int(wanted[1]) if wanted else 0):
                self.failures.append(f"{self.name}:{number}: status {status}: {command}\n{output}")
            self.outputs.append(output)
            lines += [*command_lines, *output.splitlines()]
        return lines


def unsaid_figures(text, outputs):
    """Figures of the text that no output has."""
    said = set(FIGURE.findall("\n".join(outputs)))
    prose = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    prose = re.sub(r"`[^`\n]*`|\]\([^)]*\)", "", prose)
    return [figure for figure in FIGURE.findall(prose) if figure not in said]


def run(path, options):
    """What fails in the document."""
    file = PROJECT / path
    text = file.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory(prefix="nonio-docs-") as name:
        folder = pathlib.Path(name) / "here"
        folder.mkdir()
        if re.search(r"^ *```(console|sh)$", text, re.MULTILINE):
            shutil.copytree(PROJECT / "samples", folder / "samples")
        programs = pathlib.Path(os.environ["NONIO"]).resolve().parent
        if options.install:
            prefix = pathlib.Path(name) / "prefix"
            subprocess.run(["cmake", "--install", options.install, "--prefix", prefix], check=True, stdout=subprocess.DEVNULL)
            programs = prefix / "bin"
        done = Run(path, text, Terminal(folder, programs))
        done.all()
        if options.keep:
            shutil.copytree(folder, options.keep)
    found = "\n".join(done.lines) + "\n"
    if options.update:
        file.write_text(found, encoding="utf-8")
    elif found != text:
        done.failures.append("".join(difflib.unified_diff(text.splitlines(True), found.splitlines(True),
                                                          f"{path} as it is", "as it comes out")))
    if "tutorial" in file.name:
        done.failures += [f"{path}: no output has the figure {figure} of the text"
                          for figure in unsaid_figures(found, done.outputs)]
    return done.failures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("documents", nargs="+", metavar="DOCUMENT", type=pathlib.Path)
    parser.add_argument("--update", action="store_true", help="write what comes out into the document")
    parser.add_argument("--keep", type=pathlib.Path, help="leave the files in this new folder")
    parser.add_argument("--install", metavar="BUILD", help="install this build folder first, and use what is installed")
    options = parser.parse_args()
    failures = [failure for path in options.documents for failure in run(path, options)]
    for failure in failures:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
