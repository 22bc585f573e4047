#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""wrong_inputs_test.py [--count N] [--seed S] [--list]: N mutants of manifests and readings, each compared with its
original. A mutant is refused, remarked (it has a finding or note that the original has not) or accepted. One that is
accepted must be named in docs/dev/wrong-inputs.md, with the reason, or have the numbers of the original.
The whole: --count 1200. `NONIO` is the program, `NONIO_DOCS` the folder of the documents."""
import argparse
import collections
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import mutants

NONIO = os.environ["NONIO"]
DOCS = pathlib.Path(os.environ["NONIO_DOCS"])


def explained():
    """Names of mutators in the table of what is accepted."""
    text = (DOCS / "dev/wrong-inputs.md").read_text(encoding="utf-8")
    table = text[text.index("## Accepted"):]
    names = set()
    for line in table.split("\n"):
        if line.startswith("| `"):
            names |= set(re.findall(r"`([^`]+)`", line.split("|")[1]))
    return names


def run(site, out):
    done = subprocess.run([NONIO, "run", str(site), "--out", str(out), "--quiet"], capture_output=True, text=True,
                          timeout=1800)
    if done.returncode not in (0, 1):
        sys.exit(f"nonio run ended with {done.returncode}: {done.stderr}")


class Result:
    def __init__(self, folder):
        self.content = json.loads((folder / "results.json").read_text(encoding="utf-8"))
        self.errors = self.content.get("errors", [])
        self.findings, self.numbers, self.notes = set(), {}, set()
        for a in self.content.get("analyses", []):
            self.findings |= {f["id"] for f in a.get("findings", [])}
            for name, value in a.get("values", {}).items():
                self.numbers[a["plugin"], name] = (value["value"], value.get("U"))
            for p in a.get("points", []):
                self.numbers[a["plugin"], "point", p.get("target")] = tuple(sorted(p.items()))
        self.tables = {}
        for o in self.content.get("outputs", []):
            self.findings |= {f["id"] for f in o.get("findings", [])}
            if o["plugin"] == "siemens-840d" and "file" in o:
                self.tables[o["file"]] = o["sha256"]
        for note in self.content.get("notes", []):
            self.notes.add(note if isinstance(note, str) else note.get("id", json.dumps(note, sort_keys=True)))


def judge(mutant, original):
    if mutant.errors:
        return "refused"
    new = (mutant.findings - original.findings) | (mutant.notes - original.notes)
    return "remarked" if new else "accepted"


def write(folder, manifest, data):
    folder.mkdir(parents=True)
    (folder / "campaign.toml").write_bytes(manifest)
    (folder / "x.csv").write_bytes(data)


def by_folder(out):
    """Results by the folder of the campaign, since a mutant may have lost its id."""
    found = {}
    for record in out.glob("*/run.json"):
        found[json.loads(record.read_text())["folder"]] = record.parent
    return found


def complaints_of(errors):
    """What a refusal must say: the file, the line, what was found or expected."""
    for e in errors:
        if not e.get("file"):
            yield f"no file: {e}"
        elif not e.get("line"):
            yield f"no line: {e}"
        elif not e.get("message"):
            yield f"no message: {e}"


def main():
    ask = argparse.ArgumentParser(description=__doc__)
    ask.add_argument("--count", type=int, default=300)
    ask.add_argument("--seed", type=int, default=2026)
    ask.add_argument("--list", action="store_true", help="prints every mutant with what became of it")
    ask.add_argument("--only", default="", help="mutators whose names hold this text")
    wish = ask.parse_args()
    print(f"{wish.count} mutants, seed {wish.seed}")
    known = explained()
    counts, wrong, lines = collections.Counter(), [], collections.Counter()
    with tempfile.TemporaryDirectory(prefix="nonio-wrong-") as folder:
        root = pathlib.Path(folder)
        tasks = list(mutants.mutants(wish.seed, wish.count, wish.only))
        for campaign, _, _, _, text, data, plain in tasks:
            write(root / "site" / campaign, text, data)
            write(root / "plain" / campaign, mutants.MANIFEST.format(id=campaign).encode(), plain)
        run(root / "plain", root / "plain-out")
        run(root / "site", root / "out")
        results, originals = by_folder(root / "out"), by_folder(root / "plain-out")
        for campaign, name, kind, expected, *_ in tasks:
            if campaign not in results:
                wrong.append(f"{name} ({campaign}): no result at all")
                continue
            mutant, original = Result(results[campaign]), Result(originals[campaign])
            outcome = judge(mutant, original)
            counts[kind, outcome] += 1
            doubts = {f for f in mutant.findings if f.startswith("plausibility.")}
            changed = mutant.numbers != original.numbers or mutant.tables != original.tables
            if wish.list:
                print(f"{outcome:9}{name}: " + ("; ".join(
                    f"{e.get('file', '?')}:{e.get('line', '')} {e['message']}" for e in mutant.errors) or ", ".join(
                        sorted((mutant.findings - original.findings) | (mutant.notes - original.notes)))
                    or ("other numbers" if changed else "the same numbers")))
            if original.errors or any(f.startswith("plausibility.") for f in original.findings):
                wrong.append(f"{name} ({campaign}): the original is refused or implausible: {original.errors} "
                             f"{original.findings}")
            if not original.tables:
                wrong.append(f"{name} ({campaign}): the original has no table")
            if doubts and mutant.tables:
                wrong.append(f"{name} ({campaign}): a table in spite of {doubts}")
            if expected == "refused" and outcome != "refused":
                wrong.append(f"{name} ({campaign}): {outcome}, expected refused")
            if expected == "remarked" and outcome == "accepted":
                wrong.append(f"{name} ({campaign}): accepted, expected a remark")
            if outcome == "accepted" and changed and name not in known:
                wrong.append(f"{name} ({campaign}): accepted with other numbers, and no word why that is right in "
                             "docs/dev/wrong-inputs.md")
            if outcome == "refused":
                wrong += [f"{name} ({campaign}): {c}" for c in complaints_of(mutant.errors)]
                lines["with line" if all(e.get("line") for e in mutant.errors) else "without line"] += 1
    kinds = sorted({k for k, _ in counts})
    print(f"{'class':14}{'refused':>9}{'remarked':>9}{'accepted':>9}")
    for kind in kinds:
        print(f"{kind:14}" + "".join(f"{counts[kind, o]:9}" for o in ("refused", "remarked", "accepted")))
    print(f"{'all':14}" + "".join(f"{sum(n for (_, o), n in counts.items() if o == outcome):9}"
                                  for outcome in ("refused", "remarked", "accepted")), dict(lines))
    for one in wrong:
        print("WRONG", one)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
