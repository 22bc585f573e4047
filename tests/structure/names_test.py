# SPDX-License-Identifier: Apache-2.0
"""The engine names no plugin: no string literal of engine or reports is the name of one. Only engine/platform asks whether
results are in a folder or in a pack."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
# Names of plugins that are also words of the field or of the program, as keys and kinds.
WORDS = {"circle", "thermal", "spindle", "lengths", "json", "csv", "dcc", "straightness", "square", "rtcp", "temperature", "scale",
         "step-diagonal", "certificate", "squareness", "descriptions", "periodic", "backlash", "pitch-curve", "eccentricity",
         "artefacts", "circles", "diagonals", "heat", "observations", "parts", "rotary", "runs", "spreadsheet"}
# (file, name) -> why it is there.
KNOWN = {
    ("engine/model/diagnosis/verdict.cpp", "growth-drift"): "two effects that are one growth from another place",
    ("engine/model/diagnosis/verdict.cpp", "zero-drift"): "two effects that are one growth from another place",
    ("engine/app/new_text.cpp", "siemens-840d"): "the example in a new file",
    ("engine/campaign/planning/plan.cpp", "iso230-2"): "the standard, as the reason for a plan",
}

names = {p.name for p in (ROOT / "plugins").glob("*/*") if p.is_dir() and p.name != "common"} - WORDS
literal = re.compile(r'"((?:[^"\\]|\\.)*)"')


def named(path, text):
    """(line, name) of each literal of a source that is the name of a plugin and may not be."""
    for number, line in enumerate(text.splitlines(), 1):
        if not line.lstrip().startswith(("//", "#include")):
            for word in literal.findall(line):
                if word.split(":")[0] in names and (path, word.split(":")[0]) not in KNOWN:
                    yield number, word


# What is read from a pack in another way than by the functions that take every path of results.
packed = re.compile(r"\b(in_pack|PackAddress|read_packed|size_packed|names_packed)\b")
wrong, seen = [], 0
for folder in ("engine", "reports"):
    for source in sorted((ROOT / folder).rglob("*")):
        if source.suffix in (".h", ".cpp"):
            seen += 1
            path = source.relative_to(ROOT).as_posix()
            wrong += [f"{path}:{number}: names the plugin {word}" for number, word in named(path, source.read_text(encoding="utf-8"))]
            if not path.startswith("engine/platform/"):
                wrong += [f"{path}: {word} is a word of engine/platform; expected a function of packed_results.h" for word in packed.findall(source.read_text(encoding="utf-8"))]
if len(names) < 50 or not list(named("engine/app/x.cpp", 'if (a.plugin == "rotary-chain") return;')):
    wrong.append("a planted name was not found")
if not packed.search("if (storage::in_pack(folder)) return;"):
    wrong.append("a planted question for a pack was not found")
print("\n".join(wrong) or f"{seen} sources name none of {len(names)} plugins")
sys.exit(bool(wrong) or seen < 500)
