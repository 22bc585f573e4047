#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the program's results for samples/site with those stored in expected/.

    program_test.py build/ci/bin/nonio             compares; exit status 1 and a list where something differs
    program_test.py build/ci/bin/nonio --accept    stores the present results, and prints what changed (so does NONIO_ACCEPT=1)

expected/<campaign>/results.txt has a line for each value of results.json: its place and the value. A list of numbers
is one line. Numbers agree where they differ by less than 1e-9 of the largest number of their line: the last digits belong to the
processor. Versions of the program and digests of files are left out. The same folder has all controller tables, as bytes.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
EXPECTED = os.path.join(HERE, "expected")
SITE = os.path.normpath(os.path.join(HERE, "..", "..", "samples", "site"))
LEFT_OUT = {"nonio", "sha256"}
DOCUMENTS = (".pdf", ".html", ".json", ".csv")  # files that are not loaded into a control
TOLERANCE = 1e-9


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def named(items):
    """The elements of a list with what identifies each of them, so that a new element moves no other."""
    count = {}
    for item in items:
        name = "?"
        if isinstance(item, dict):
            name = "/".join(str(item[k]) for k in ("plugin", "id", "measurement", "name", "file", "axis") if k in item)
        count[name] = count.get(name, 0) + 1
        yield "%s#%d" % (name, count[name]), item


def lines_of(value, place=""):
    """(place, value) of each leaf; a list of numbers is a leaf."""
    if isinstance(value, dict):
        for key in sorted(value):
            if key not in LEFT_OUT:
                yield from lines_of(value[key], place + "." + key if place else key)
    elif isinstance(value, list) and not all(is_number(x) or x is None for x in value):
        for name, item in named(value):
            yield from lines_of(item, "%s[%s]" % (place, name))
    else:
        yield place, value


def as_text(results):
    return "".join("%s = %s\n" % (place, json.dumps(value, ensure_ascii=False)) for place, value in lines_of(results))


def from_text(text):
    out = {}
    for line in text.splitlines():
        place, _, value = line.partition(" = ")
        out[place] = json.loads(value)
    return out


def agree(a, b):
    if isinstance(a, list) and isinstance(b, list):
        if len(a) != len(b) or any((x is None) != (y is None) for x, y in zip(a, b)):
            return False
        size = max((abs(x) for x in a + b if x is not None), default=0.0)
        return all(x is None or abs(x - y) <= TOLERANCE * size for x, y in zip(a, b))
    if is_number(a) and is_number(b):
        return abs(a - b) <= TOLERANCE * max(abs(a), abs(b), 1e-3)
    return a == b and type(a) is type(b)


def short(value):
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 90 else text[:87] + "..."


def differences(stored, found):
    for place in sorted(stored.keys() | found.keys()):
        if place not in found:
            yield "%s: stored %s, now missing" % (place, short(stored[place]))
        elif place not in stored:
            yield "%s: not stored, now %s" % (place, short(found[place]))
        elif not agree(stored[place], found[place]):
            yield "%s: stored %s, now %s" % (place, short(stored[place]), short(found[place]))


def made_by(program, folder):
    """{campaign: {file: bytes}}: the lines of results.json and the tables."""
    environment = dict(os.environ, NONIO_ALLOW_ROOT="1", LC_ALL="C")
    night = subprocess.run([program, "run", SITE, "--out", folder, "--quiet", "--date", "2026-06-01"], env=environment,
                           capture_output=True, text=True, timeout=600)
    if night.returncode not in (0, 1):  # 1: one sample is broken on purpose
        sys.exit("nonio run ended with %d:\n%s" % (night.returncode, night.stderr))
    out = {}
    for campaign in sorted(os.listdir(folder)):
        results = os.path.join(folder, campaign, "results.json")
        if not os.path.isfile(results):
            continue
        with open(results, encoding="utf-8") as opened:
            out[campaign] = {"results.txt": as_text(json.load(opened)).encode()}
        for name in sorted(os.listdir(os.path.join(folder, campaign))):
            if not name.endswith(DOCUMENTS):
                with open(os.path.join(folder, campaign, name), "rb") as opened:
                    out[campaign][name] = opened.read()
    return out


def stored():
    out = {}
    for campaign in sorted(os.listdir(EXPECTED)) if os.path.isdir(EXPECTED) else []:
        out[campaign] = {}
        for name in sorted(os.listdir(os.path.join(EXPECTED, campaign))):
            with open(os.path.join(EXPECTED, campaign, name), "rb") as opened:
                out[campaign][name] = opened.read()
    return out


def compare(before, now):
    """What differs, a sentence each."""
    for campaign in sorted(before.keys() | now.keys()):
        a, b = before.get(campaign, {}), now.get(campaign, {})
        for name in sorted(a.keys() | b.keys()):
            what = campaign + "/" + name
            if name not in b:
                yield what + ": stored, now missing"
            elif name not in a:
                yield what + ": not stored, now made"
            elif name == "results.txt":
                for sentence in differences(from_text(a[name].decode()), from_text(b[name].decode())):
                    yield campaign + ": " + sentence
            elif a[name] != b[name]:
                rows = [i for i, (x, y) in enumerate(zip(a[name].splitlines(), b[name].splitlines()), 1) if x != y]
                yield "%s: other bytes, first in line %d" % (what, rows[0] if rows else len(a[name].splitlines()) + 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program nonio")
    parser.add_argument("--accept", action="store_true", default=os.environ.get("NONIO_ACCEPT") == "1", help="store what the program makes now")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        now = made_by(os.path.abspath(chosen.program), os.path.join(folder, "out"))
    samples = sorted(name for name in os.listdir(SITE) if os.path.isfile(os.path.join(SITE, name, "campaign.toml")))
    missing = [name for name in samples if name not in now]
    if missing:
        sys.exit("no results of " + ", ".join(missing))
    found = list(compare(stored(), now))
    for sentence in found[:60]:
        print(sentence)
    if len(found) > 60:
        print("and %d more" % (len(found) - 60))
    if chosen.accept:
        shutil.rmtree(EXPECTED, ignore_errors=True)
        for campaign, files in now.items():
            os.makedirs(os.path.join(EXPECTED, campaign))
            for name, data in files.items():
                with open(os.path.join(EXPECTED, campaign, name), "wb") as opened:
                    opened.write(data)
        print("stored %d campaigns in %s" % (len(now), os.path.relpath(EXPECTED)))
        return 0
    if not found:
        print("%d campaigns, %d tables: as stored" % (len(now), sum(len(files) - 1 for files in now.values())))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
