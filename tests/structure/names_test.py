# SPDX-License-Identifier: Apache-2.0
"""The engine names no plugin: no string literal of engine or reports is the name of one. Only engine/platform asks whether
results are in a folder or in a pack."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
# Names of plugins that are also words of the field or of the program, as keys, columns and findings.
WORDS = {"backlash", "certificate", "circles", "csv", "dcc", "descriptions", "eccentricity", "observations", "parts", "periodic", "rotary", "runs",
         "scale", "square", "squareness", "straightness", "temperature"}
# What may name some, where, and why.
SAMPLES = ("engine/plugin_check/plugin_check_",)  # a sample for each kind of measurement
SIMULATED = SAMPLES + ("engine/simulation/",)  # the kinds that are simulated without a method
KNOWN = {
    "circle": SIMULATED, "rtcp": SIMULATED, "step-diagonal": SIMULATED,
    "diagonals": SAMPLES, "lengths": SAMPLES, "spindle": SAMPLES, "thermal": SAMPLES,
    "siemens-840d": ("engine/app/new_text.cpp",),  # the example in a new file
    "iso230-2": ("engine/campaign/planning/plan.cpp",),  # the standard, as the reason for a plan
}

names = {p.name for p in (ROOT / "plugins").glob("*/*") if p.is_dir() and p.name != "common"} - WORDS
names |= {p.stem for p in (ROOT / "samples/plugins").glob("*.cpp")}
literal = re.compile(r'"((?:[^"\\]|\\.)*)"')


used = set()


def named(path, text):
    """(line, name) of each literal of a source that is the name of a plugin and may not be."""
    for number, line in enumerate(text.splitlines(), 1):
        if not line.lstrip().startswith(("//", "#include")):
            for word in literal.findall(line):
                name = word.split(":")[0]
                known = [(name, where) for where in KNOWN.get(name, ()) if path.startswith(where)]
                used.update(known or [name])
                if name in names and not known:
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
# An exception that nothing needs any more would hide the next name.
wrong += [f"{one} needs no exception" for one in sorted(WORDS - used)]
wrong += [f"{name} needs no exception in {where}" for name, places in KNOWN.items() for where in places if (name, where) not in used]
if not packed.search("if (storage::in_pack(folder)) return;"):
    wrong.append("a planted question for a pack was not found")
print("\n".join(wrong) or f"{seen} sources name none of {len(names)} plugins")
sys.exit(bool(wrong) or seen < 500)
