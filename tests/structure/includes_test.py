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
    "engine/model": {"sdk", "math", "model"},
    "engine/pdf": {"sdk", "pdf"},
    "engine/sign": {"sdk", "pdf", "sign"},
    "engine/host": {"sdk", "math", "model", "pdf", "sign", "host"},
    "engine/app": {"sdk", "host", "app"},
    "reports": {"sdk", "pdf", "reports"},
    "plugins/readers": {"sdk", "math"},
    "plugins/analyses": {"sdk", "math"},
    "plugins/effects": {"sdk", "math"},
    "plugins/controllers": {"sdk", "math", "controllers"},
    "plugins/outputs": {"sdk", "math", "reports"},
}
# third-party header -> the parts that are its home
HOMES = {
    "Poco/": {"engine/host"}, "boost/dll": {"engine/host"}, "boost/math": {"engine/math"},
    "boost/": {"engine/host", "engine/math"}, "toml++": {"engine/host"}, "muParser": {"engine/host"}, "hpdf": {"engine/pdf"}, "qrencode": {"reports"},
    "libdeflate": {"engine/pdf"}, "openssl/": {"engine/pdf", "engine/sign", "engine/host"}, "xmlsec/": {"engine/sign"},
    "libxml/": {"engine/sign"}, "CLI/": {"engine/app"}, "nlohmann": {"engine/host", "engine/app", "plugins/outputs"},
    "Eigen": {"engine/math", "engine/model", "plugins/analyses", "plugins/effects"}, "tl/": {"engine/sdk"}, "sqlite3": {"engine/host"},
}


def complaint(part, line):
    header = re.match(r'\s*#\s*include\s*[<"]([^">]+)', line)
    if not header:
        return None
    name = header.group(1)
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
            why = complaint(part, line)
            if public and re.search(r"include\s*<(Eigen|Poco|boost|toml|muParser|nlohmann|hpdf|openssl|libxml|xmlsec|sqlite)", line):
                why = why or "no third-party type crosses a public header"
            if why:
                wrong.append(f"{path.relative_to(ROOT)}:{number}: {why}")
print("\n".join(wrong) or f"{seen} lines keep the rules")
sys.exit(bool(wrong) or seen < 1000)
