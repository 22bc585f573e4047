# SPDX-License-Identifier: Apache-2.0
"""What may include what: docs/dev/architecture.md, compared with the include lines, and planted lines that break it."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
# Products of nonio_engine -> the products that each may include, and their folders from below upwards: a folder may
# include those before it. What a product has outside of its folders may include all of them.
PRODUCTS = {
    "platform": (set(), ("storage", "process")),
    "campaign": ({"platform"}, ("config", "loader", "reading", "schema", "modelling", "tables", "evaluation", "importing", "planning")),
    "certificates": ({"platform", "campaign"}, ()),
    "laboratory": ({"platform", "campaign"}, ("statistics", "store", "assessment")),
    "batch": ({"platform", "campaign", "certificates", "laboratory"}, ("state", "survey", "commit", "workers", "close", "shards", "release")),
    "live": ({"platform", "campaign", "certificates", "laboratory", "batch"}, ()),
    "plugin_check": ({"platform", "campaign"}, ()),
    "simulation": ({"platform", "campaign"}, ()),
}
# The libraries with public headers "nonio/<name>/..." -> those that each part may include.
MAY = {
    "engine/sdk": {"sdk"},
    "engine/math": {"sdk", "math"},
    "engine/model": {"sdk", "math", "model"},
    "engine/pdf": {"sdk", "pdf"},
    "engine/sign": {"sdk", "pdf", "sign"},
    "engine/platform": {"sdk"},
    "engine/campaign": {"sdk", "math"},
    "engine/campaign/reading": {"sdk", "math", "model"},
    "engine/campaign/modelling": {"sdk", "math", "model"},
    "engine/campaign/evaluation": {"sdk", "math", "model"},
    "engine/certificates": {"sdk", "sign"},
    "engine/laboratory": {"sdk"},
    "engine/laboratory/statistics": {"sdk", "math"},
    "engine/laboratory/assessment": {"sdk", "math", "reports"},
    "engine/batch": {"sdk", "sign", "reports"},
    "engine/live": {"sdk", "math", "model", "sign", "reports", "workbench"},
    "engine/plugin_check": {"sdk", "math", "model"},
    "engine/simulation": {"sdk", "math", "model"},
    "engine/app": {"sdk"},
    "engine/python": {"sdk", "model"},
    "reports": {"sdk", "pdf", "reports", "workbench"},
    "plugins/readers": {"sdk", "math"},
    "plugins/analyses": {"sdk", "math"},
    "plugins/effects": {"sdk", "math"},
    "plugins/controllers": {"sdk", "math", "controllers"},
    "plugins/outputs": {"sdk", "math", "reports", "workbench"},
}
# The header through which all of the engine and the program get JSON.
JSON = "platform/storage/json_values.h"
# Folders of plugins that all plugins of one kind may include.
SHARED = {"common"}
ENGINE = {f"engine/{product}" for product in PRODUCTS}
# third-party header -> the parts that may include it
HOMES = {
    "Poco/": {"engine/batch", "engine/live", "plugins/readers"},
    "boost/dll": {"engine/campaign/loader"}, "boost/math": {"engine/math"},
    "boost/": {"engine/campaign/loader", "engine/math"},
    "toml++": {"engine/campaign", "engine/certificates", "engine/laboratory/store"}, "muParser": {"engine/campaign/config"},
    "hpdf": {"engine/pdf"}, "qrencode": {"reports"}, "libdeflate": {"engine/pdf"},
    "openssl/": {"engine/pdf", "engine/sign", "engine/platform/storage"}, "xmlsec/": {"engine/sign"},
    "libxml/": {"engine/sign"}, "utf8proc": {"reports"}, "CLI/": {"engine/app"},
    "pybind11/": {"engine/python"},
    "argon2": {"engine/certificates"}, "xlsxwriter": {"engine/platform/storage"}, "nlohmann": {"engine/platform/storage", "engine/app"},
    "Eigen": {"engine/math", "engine/model", "plugins/analyses", "plugins/effects"},
    "math/eigen/": {"engine/laboratory/statistics"}, "tl/": {"engine/sdk"}, "sqlite3": {"engine/platform/storage"}, "libpq": {"engine/platform/storage"},
}
THIRD_PARTY = r"include\s*<(Eigen|Poco|boost|toml|muParser|nlohmann|hpdf|openssl|libxml|xmlsec|sqlite|simdjson)"


def longest(path, names):
    """The longest of the folders `names` that holds `path`, or none."""
    return max((n for n in names if path.startswith(n + "/")), key=len, default=None)


def product_of(header):
    """("campaign", "reading") of campaign/reading/names.h; a product without folders, or a file outside of them: None."""
    product, *rest = header.split("/")
    if product not in PRODUCTS:
        return None
    return product, rest[0] if len(rest) > 1 and rest[0] in PRODUCTS[product][1] else None


def of_product(path, header):
    """Why a source may not include `header`, which belongs to a product of the engine."""
    to, inner = product_of(header)
    if path.startswith(("engine/app/", "engine/python/")):  # the program, and the module of Python
        return f"{header} brings a third-party type" if header in LEAKS else None
    own = product_of(path.removeprefix("engine/")) if path.startswith("engine/") else None
    if not own:
        return f"only products and the program include headers of {to}"
    if own[0] != to:
        return None if to in PRODUCTS[own[0]][0] else f"{own[0]} may not include {to}"
    folders = PRODUCTS[to][1]
    if own[1] and (not inner or folders.index(inner) > folders.index(own[1])):
        return f"{to}/{own[1]} may not include {header}: it is above"
    return None


def leaking_headers():
    """Headers of products through which a third-party type comes, other than the engine's own name of JSON."""
    headers = {p.relative_to(ROOT / "engine").as_posix(): p.read_text(encoding="utf-8") for product in PRODUCTS for p in (ROOT / "engine" / product).rglob("*.h")}
    leaks = {name for name, text in headers.items() if re.search(THIRD_PARTY, text)} - {JSON}
    while more := {n for n, text in headers.items() if n not in leaks and any(f'"{leak}"' in text for leak in leaks)}:
        leaks |= more
    return leaks


LEAKS = leaking_headers()


def of_neighbour(path, name):
    """Why a bare name may not be included: it is no header of the same folder, nor of one that its neighbours share."""
    source = ROOT / path
    if product_of(path.removeprefix("engine/")):
        return f'"{name}": expected its path below engine/'
    part = longest(path, MAY)
    if part.startswith("plugins/") and not (source.parent / name).exists():
        others = [p for p in (ROOT / part).rglob(name) if not SHARED & set(p.parts)]
        if any((source.parent.name, p.parent.name) == ("spreadsheet", "csv") for p in others):  # which reads its table
            return None
        if others and not list((ROOT / part).rglob(f"common/**/{name}")):
            return f'"{name}" belongs to {others[0].parent.relative_to(ROOT)}: plugins share only what is in common'
    return None


def complaint(path, line):
    """What is wrong with an include line of the source `path`, as posix text below the root."""
    header = re.match(r'\s*#\s*include\s*([<"])([^">]+)', line)
    if not header:
        return None
    name = header.group(2)
    if "/include/" in path and re.search(THIRD_PARTY, line):
        return "no third-party type crosses a public header"
    if product_of(name):
        return of_product(path, name)
    own = re.match(r"nonio/(\w+)/", name)
    if own:
        part = longest(path, MAY)
        return None if own.group(1) in MAY[part] else f"{part} may not include nonio/{own.group(1)}"
    if header.group(1) == '"' and not name.startswith("math/eigen/") and not name.startswith("reports/"):
        return of_neighbour(path, name)
    for library, homes in HOMES.items():
        if name.startswith(library):
            return None if longest(path, homes) else f"{library} belongs in {', '.join(sorted(homes))}"
    return None


# One line for each rule, that breaks it.
PLANTED = [
    ("engine/platform/storage/files.cpp", '#include "platform/process/child.h"'),
    ("engine/platform/storage/files.cpp", '#include "campaign/config/keys.h"'),
    ("engine/campaign/reading/names.cpp", '#include "campaign/evaluation/evaluate.h"'),
    ("engine/campaign/config/keys.cpp", "#include <Poco/Net/Socket.h>"),
    ("engine/certificates/verify.cpp", '#include "laboratory/store/store.h"'),
    ("engine/laboratory/store/store.cpp", '#include "certificates/register.h"'),
    ("engine/laboratory/statistics/gls.cpp", '#include "laboratory/store/store.h"'),
    ("engine/batch/state/run_state.cpp", '#include "batch/run.h"'),
    ("engine/batch/survey/survey.cpp", '#include "batch/workers/runner.h"'),
    ("engine/batch/run.cpp", '#include "live/session.h"'),
    ("engine/simulation/simulate.cpp", '#include "batch/run.h"'),
    ("engine/batch/run.cpp", '#include "run_state.h"'),
    ("engine/model/fit/fit.cpp", '#include "campaign/reading/names.h"'),
    ("engine/math/axis/axis.cpp", '#include "nonio/model/explain.h"'),
    ("engine/campaign/config/keys.cpp", '#include "nonio/model/explain.h"'),
    ("engine/sdk/include/nonio/sdk/plugin.h", "#include <nlohmann/json.hpp>"),
    ("engine/batch/run.cpp", "#include <nlohmann/json.hpp>"),
    ("plugins/effects/scale/plugin.cpp", '#include "campaign/reading/names.h"'),
    ("plugins/effects/scale/plugin.cpp", '#include "nonio/reports/plot.h"'),
    ("plugins/readers/csv/plugin.cpp", '#include "camonitor.h"'),
    ("reports/src/plot.cpp", '#include "campaign/reading/names.h"'),
    ("engine/app/main.cpp", f'#include "{min(LEAKS)}"'),
]

wrong, seen = [f"planted and not found: {path}: {line}" for path, line in PLANTED if not complaint(path, line)], 0
for folder in sorted({part.split("/")[0] for part in MAY}):
    for path in sorted((ROOT / folder).rglob("*")):
        if path.suffix not in (".h", ".cpp") or not longest(path.relative_to(ROOT).as_posix(), MAY):
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            seen += 1
            if why := complaint(path.relative_to(ROOT).as_posix(), line):
                wrong.append(f"{path.relative_to(ROOT)}:{number}: {why}")
print("\n".join(wrong) or f"{seen} lines keep the rules, {len(PLANTED)} planted lines do not")
sys.exit(bool(wrong) or seen < 1000)
