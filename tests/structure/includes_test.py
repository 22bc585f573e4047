# SPDX-License-Identifier: Apache-2.0
"""Who may include whom: docs/architecture.md, held against the include lines."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
# part -> parts it may include
MAY = {
    "engine/sdk": {"sdk"},
    "engine/math": {"sdk", "math"},
    "engine/history": {"sdk", "history"},
    "engine/model": {"sdk", "math", "model"},
    "engine/pdf": {"sdk", "pdf"},
    "engine/sign": {"sdk", "pdf", "sign"},
    "engine/host": {"sdk", "math", "history", "model", "pdf", "sign", "reports", "workbench", "host"},
    "engine/app": {"sdk", "host", "app"},
    "reports": {"sdk", "pdf", "reports", "workbench"},
    "plugins/readers": {"sdk", "math"},
    "plugins/analyses": {"sdk", "math"},
    "plugins/effects": {"sdk", "math"},
    "plugins/controllers": {"sdk", "math", "controllers"},
    "plugins/outputs": {"sdk", "math", "reports", "workbench"},
}
# Rooms of engine/host, from below upwards -> the rooms below that each may include. Beside the sdk:
ROOMS = {
    "storage": set(),
    "process": {"storage"},
    "config": {"storage"},
    "loader": {"storage", "process", "config"},
    "reading": {"storage", "process", "config", "loader"},
    "modelling": {"storage", "process", "config", "loader", "reading"},
    "tables": {"storage", "process", "config", "loader", "reading"},
    "evaluation": {"storage", "process", "config", "loader", "reading", "modelling", "tables"},
    "certificates": {"storage", "process", "config", "loader", "reading", "modelling", "tables", "evaluation"},
}
ROOMS["history"] = {"storage", "process", "config", "loader", "reading", "evaluation"}
ROOMS["morning"] = ROOMS["history"] | {"history"}
# Three users of the engine, which do not know each other.
ROOMS |= {room: set(ROOMS) for room in ("batch", "plugin_check", "tools")}
ROOMS["live"] = ROOMS["batch"] | {"batch"}
# What a room takes of the other parts, beside sdk and math.
PARTS_OF_ROOMS = {"reading": {"model"}, "modelling": {"model"}, "evaluation": {"model"}, "plugin_check": {"model"}, "tools": {"model"},
                  "certificates": {"sign"}, "batch": {"sign", "reports"}, "morning": {"history", "reports"}, "live": {"model", "reports", "sign", "workbench"}}
# Folders that know each other only through these.
SHARED = {"common"}
# third-party header -> the parts that are its home
HOMES = {
    "Poco/": {"engine/host", "plugins/readers"}, "boost/dll": {"engine/host"}, "boost/math": {"engine/math", "engine/history"},
    "boost/": {"engine/host", "engine/math", "engine/history"}, "toml++": {"engine/host"}, "muParser": {"engine/host"}, "hpdf": {"engine/pdf"}, "qrencode": {"reports"},
    "libdeflate": {"engine/pdf"}, "openssl/": {"engine/pdf", "engine/sign", "engine/host"}, "xmlsec/": {"engine/sign"},
    "libxml/": {"engine/sign", "plugins/readers"}, "utf8proc": {"reports"}, "CLI/": {"engine/app"}, "nlohmann": {"engine/host", "engine/app", "plugins/outputs"},
    "Eigen": {"engine/math", "engine/history", "engine/model", "plugins/analyses", "plugins/effects"}, "tl/": {"engine/sdk"}, "sqlite3": {"engine/host"}, "libpq": {"engine/host"},
}


def of_host(part, room, name):
    """What is wrong with including `name`, a header of engine/host, or with what a room includes."""
    where = re.match(r"host/(\w+)/(?:\w+/)?\w+\.h$", name)
    if where:
        if where.group(1) not in ROOMS:
            return f"there is no room {where.group(1)}"
        if part == "engine/app":
            return f"{name} brings a third-party type" if name in LEAKS else None
        if part != "engine/host":
            return f"{part} may not include engine/host"
        if where.group(1) != room and where.group(1) not in ROOMS[room]:
            return f"{room} may not include {where.group(1)}"
    own = re.match(r"nonio/(\w+)/", name)
    if room and own and own.group(1) not in {"sdk", "math"} | PARTS_OF_ROOMS.get(room, set()):
        return f"{room} may not include nonio/{own.group(1)}"
    return None


def leaking_headers():
    """Headers of engine/host through which a third-party type comes."""
    headers = {p.relative_to(ROOT / "engine").as_posix(): p.read_text(encoding="utf-8") for p in (ROOT / "engine/host").rglob("*.h")}
    leaks = {name for name, text in headers.items() if re.search(THIRD_PARTY, text)}
    while more := {n for n, text in headers.items() if n not in leaks and any(f'"{leak}"' in text for leak in leaks)}:
        leaks |= more
    return leaks


THIRD_PARTY = r"include\s*<(Eigen|Poco|boost|toml|muParser|nlohmann|hpdf|openssl|libxml|xmlsec|sqlite|simdjson)"
LEAKS = leaking_headers()


def complaint(part, path, line):
    header = re.match(r'\s*#\s*include\s*([<"])([^">]+)', line)
    if not header:
        return None
    name = header.group(2)
    room = (ROOT / path).relative_to(ROOT / "engine/host").parts[0] if part == "engine/host" else None
    if why := of_host(part, room, name):
        return why
    if header.group(1) == '"' and not re.match(r"(nonio|host|reports)/", name):
        # A bare name: a header of the same folder, or of the folder that its neighbours share.
        target = path.parent / name
        if room:
            return f'"{name}": say its room'
        if part.startswith("plugins/") and not target.exists():
            others = [p for p in (ROOT / part).rglob(name) if not SHARED & set(p.parts)]
            if others and not list((ROOT / part).rglob(f"common/**/{name}")):
                return f'"{name}" belongs to {others[0].parent.relative_to(ROOT)}: plugins share only what stands in common'
    own = re.match(r"nonio/(\w+)/", name)
    if own and own.group(1) not in MAY[part]:
        return f"{part} may not include nonio/{own.group(1)}"
    for library, homes in HOMES.items():
        if name.startswith(library):
            return None if part in homes else f"{library} belongs in {', '.join(sorted(homes))}"
    return None


wrong, seen = [], 0
for part in MAY:
    for path in sorted((ROOT / part).rglob("*")):
        if path.suffix not in (".h", ".cpp"):
            continue
        public = "include" in path.parts
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            seen += 1
            why = complaint(part, path, line)
            if public and re.search(THIRD_PARTY, line):
                why = why or "no third-party type crosses a public header"
            if why:
                wrong.append(f"{path.relative_to(ROOT)}:{number}: {why}")
print("\n".join(wrong) or f"{seen} lines keep the rules")
sys.exit(bool(wrong) or seen < 1000)
