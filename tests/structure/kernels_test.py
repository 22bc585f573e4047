# SPDX-License-Identifier: Apache-2.0
"""Who may include whom between the folders of engine/math and engine/model, and between the folders of readers."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
# folder -> folders of the same part that it may include
MAY = {
    "engine/math": {
        "statistics": set(), "axis": {"statistics"}, "uncertainty": {"statistics", "axis"}, "planning": {"statistics"},
        "findings": {"statistics", "uncertainty", "axis", "planning"}, "volumetric": {"statistics", "uncertainty"},
        "rotary": {"statistics"}, "circles": {"statistics"}, "heat": {"statistics", "uncertainty"}, "compensation": {"statistics", "axis"}, "followed": {"statistics", "axis"}},
    "engine/model": {
        "data": set(), "course": {"data"}, "fit": {"data", "course"}, "search": {"data", "fit"},
        "diagnosis": {"data", "course", "fit", "search"}, "joint": {"data", "fit", "search", "diagnosis"}},
}
# folders that belong to no other and that all of a part may include
OPEN = {"include", "eigen", "common"}
# A reader that hands its table on to another one.
READ_BY = {"spreadsheet": ["csv"]}


def files(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in (".h", ".cpp"))


def quoted(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if header := re.match(r'\s*#\s*include\s*"([^"]+)"', line):
            yield number, header.group(1)


wrong, seen = [], 0


def complain(path, number, why):
    wrong.append(f"{path.relative_to(ROOT)}:{number}: {why}")


for part, walls in MAY.items():
    root = ROOT / part
    homes = {}  # header, as it is included -> its folder
    for path in files(root):
        folder = path.relative_to(root).parts[0]
        if folder not in walls and folder not in OPEN:
            complain(path, 1, f"expected one of the folders {', '.join(walls)}, found {folder}")
        below = path.relative_to(root / folder)
        homes[str(below.relative_to("include")) if below.parts[0] == "include" else f"{folder}/{path.name}"] = folder
    for path in files(root):
        folder = path.relative_to(root).parts[0]
        if folder not in walls:
            continue
        for number, name in quoted(path):
            seen += 1
            home = homes.get(name) or homes.get(f"{folder}/{name}")
            if home in walls and home != folder and home not in walls[folder]:
                complain(path, number, f"{part}/{folder} may not include {part}/{home}")
            if "/" not in name and home is None and not (ROOT / "engine/math/eigen" / name).exists():
                complain(path, number, f'"{name}" is no header of {part}/{folder}: say its folder')

readers = ROOT / "plugins/readers"
for path in files(readers):
    for number, name in quoted(path):
        if "/" in name:
            continue
        seen += 1
        read_by = [path.parent, *(readers / other for other in READ_BY.get(path.parent.name, ()))]
        if not any((folder / name).exists() for folder in read_by) and not list((readers / "common").glob(f"*/{name}")):
            complain(path, number, f'"{name}" is no header of {path.parent.name}: readers share only what stands in common')
print("\n".join(wrong) or f"{seen} includes keep the walls")
sys.exit(bool(wrong) or seen < 100)
