# SPDX-License-Identifier: Apache-2.0
"""The JSON schemas of campaign.toml and site.toml: they take what Nonio takes and refuse what it refuses."""
import copy
import datetime
import json
import os
import pathlib
import re
import subprocess
import tempfile
import tomllib
import unittest

import jsonschema

import toml
import whole

NONIO, READS = os.environ["NONIO"], os.environ["NONIO_SCHEMA_READS"]
PROJECT = pathlib.Path(__file__).resolve().parents[3]
WRONG = [7, -7, 0, 2.5, 1e12, True, "some text", "X", "2025-01-02", "", "a\tb", datetime.date(2025, 1, 2),
         datetime.time(12, 0), [], [1, 2], ["a"], {}, {"a": 1}, {"X": 1}, [{"a": 1}], [[1]], [1, "a"]]
# In JSON, and for taplo, these are texts: the schema cannot distinguish them from a required text.
DAYS = [f"= {toml.written(value)}" for value in WRONG if isinstance(value, (datetime.date, datetime.time))]
# Where the schema accepts what the program refuses: (place, why).
ONLY_PROGRAM = [
    (r".*\b(date|end_date|received|calibrated|valid_until|until)", "a date in quotes; the last day before the first one"),
    (r"machine\.axes\.X\.slave", "the master"),
    (r"measurement\.\d+\.lateral", "the axis that moves"),
    (r"measurement\.\d+\.at", "the axis that moves"),
    (r"(acknowledged|withdrawn)(\..*)?", "the acknowledgement that is taken back"),
    (r"measurement\.[12](\.(id|kind|axis|reversal_of))?", "the line before the straightedge was turned over"),
    (r"measurement\.8\.centre(\.[XY])?", "the axes of a circle's centre are those of its plane"),
    (r"measurement\.3\.(square|square_turned)|square(\.0(\.id)?)?", "a line on a square that there is"),
    (r"model\.formula\.0\.(axis|expression|parameters.*)", "a formula that is none on this machine"),
    (r"signing(\.(pkcs12|pkcs11|password_\w+|trust|time_stamp_roots|signer|signers(\.0\.(from|until))?))?", "which keys stand together; the last day not before the first"),
    (r"mail\.(to|smtp|sendmail|user|password_\w+)(\.\d+)?", "which keys stand together; addresses"),
    (r"certificate\.numbering", "a pattern of numbers"),
    (r"certificate\.register|database\.(register|schema)", "one register, apart from the history"),
    (r".*\b(travel|range|grid)", "the smaller number first"),
    (r"asset", "the name of the file"),
    (r"user(\.0\.password)?", "a user at least; the whole form of a hash"),
    (r"taken(\..*)?", "the smaller number first"),
    (r"axes\.\w+\.(state\.\d+\.)?(since|number)", "the day of table and backlash; no number twice"),
]
# Where the schema refuses what parsing accepts, as these are names that only a run knows.
ONLY_SCHEMA = [
    (r"(machine\.)?control", "an output"),
    (r"measurement\.\d+\.reader", "a reader"),
    (r"run\.(analyses|outputs)", "analyses, outputs"),
    (r"model\.effects", "an effect"),
    (r"model\.formula", "the formula that an effect is"),
    (r"options\..*", "a plugin, an option"),
]


def schema(file):
    done = subprocess.run([NONIO, "schema", file], capture_output=True, text=True, check=True, timeout=120)
    return json.loads(done.stdout)


SCHEMAS = {file: schema(file) for file in ("campaign", "site", "machine", *whole.LOGS)}


def whole_files():
    """A file of each kind with every key there is."""
    return (("campaign", whole.campaign()), ("site", whole.site()), ("machine", whole.machine()),
            *((file, whole.log(file)) for file in whole.LOGS))


VALIDATORS = {file: jsonschema.Draft7Validator(s, format_checker=jsonschema.FormatChecker(["date"]))
              for file, s in SCHEMAS.items()}


def complaints(file, data):
    return [f"{'.'.join(map(str, e.path))}: {e.message}" for e in VALIDATORS[file].iter_errors(toml.as_json(data))]


def verdicts(file, documents):
    """Of the program: "ok", or an error, for each text."""
    documents = list(documents)
    done = subprocess.run([READS, file], input="".join(f"{text}\0" for text in documents), capture_output=True, text=True,
                          check=True, timeout=300)
    lines = done.stdout.splitlines()
    assert len(lines) == len(documents)
    return lines


def places(data, path=()):
    """Every key and every element of a list."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield (*path, key), value
        yield from places(value, (*path, key))


def opened(data, path):
    """A copy, and in it what contains the end of the path: all else is shared."""
    out = inner = copy.copy(data)
    for key in path[:-1]:
        inner[key] = inner = copy.copy(inner[key])
    return out, inner


def changed(data, path, value):
    out, inner = opened(data, path)
    inner[path[-1]] = value
    return out


def without(data, path):
    out, inner = opened(data, path)
    del inner[path[-1]]
    return out


def mutations(data):
    """(where, what was done, the file)"""
    for path, value in places(data):
        name = ".".join(map(str, path))
        yield name, "taken away", without(data, path)
        for wrong in WRONG:
            yield name, f"= {toml.written(wrong)}", changed(data, path, wrong)
        if isinstance(value, str) and value:
            yield name, "another letter", changed(data, path, value + "!")
        if isinstance(value, dict):
            yield name, "a key more", changed(data, (*path, "nonsense"), 1)
    yield "", "a key more", {**data, "nonsense": 1}


def reason(place, table):
    return next((why for why in table if re.fullmatch(f"(?:{why[0]})" + r"(\.\d+)*", place)), None)


def is_refused(file, place, case):
    """By the schema. Tables and entries of lists that are as they were are left out: they are good, and no rule needs two."""
    table, _, rest = place.partition(".")
    own = {key: value for key, value in case.items() if key in {"format", "campaign", "asset", table, "nonsense"}}
    entry = rest.partition(".")[0]
    if entry.isdigit() and rest != entry:
        own[table] = [own[table][int(entry)]]
    return not VALIDATORS[file].is_valid(toml.as_json(own))


def keys_of(s, path=()):
    """Every key that a schema names, * for a name that is free."""
    for name, inner in s.get("properties", {}).items():
        if path[:1] != ("options",):
            yield (*path, name)
            yield from keys_of(inner, (*path, name))
    for inner in s.get("patternProperties", {}).values():
        yield from keys_of(inner, (*path, "*"))
    if isinstance(s.get("items"), dict):
        yield from keys_of(s["items"], path)


def keys_in(data, free=("axes",)):
    for path, _ in places(data):
        plain = [key for key in path if isinstance(key, str)]
        yield tuple("*" if i and plain[i - 1] in free else key for i, key in enumerate(plain))


class Schema(unittest.TestCase):
    def test_they_are_schemas(self):
        for file, s in SCHEMAS.items():
            jsonschema.Draft7Validator.check_schema(s)
            for path in keys_of(s):
                self.assertTrue(path[-1])

    def test_every_manifest_of_the_project(self):
        seen = 0
        for folder in ("samples", "plugins", "tests"):
            for path in sorted((PROJECT / folder).rglob("*.toml")):
                file = "machine" if path.parent.name == "machines" else path.stem
                # The method_cases have kinds of plugins that are wrong on purpose, the sample plugins their own control.
                if file in SCHEMAS and path.name != "machine.toml" and not {"corpus", "method_cases"} & set(path.parts) \
                        and PROJECT / "samples/plugins" not in path.parents:
                    data = tomllib.loads(path.read_text(encoding="utf-8"))
                    self.assertEqual(complaints(file, data), [], path)
                    seen += 1
        self.assertGreater(seen, 20)

    def test_the_whole_files_have_every_key(self):
        for file, data in whole_files():
            self.assertEqual(complaints(file, data), [])
            self.assertEqual(verdicts(file, [toml.document(data)]), ["ok"])
            self.assertEqual(set(keys_of(SCHEMAS[file])) - set(keys_in(data)), set())

    def test_every_key_taken_away_and_mistyped(self):
        used = set()
        for file, data in whole_files():
            cases = list(mutations(data))
            known = {id(value): toml.written(value) for value in data.values()}
            answers = verdicts(file, [toml.document(case, known) for _, _, case in cases])
            refused, differ = 0, []
            for (place, what, case), answer in zip(cases, answers):
                found = is_refused(file, place, case)
                refused += found and answer != "ok"
                if found == (answer != "ok") or what in DAYS:
                    continue
                why = reason(place, ONLY_SCHEMA if found else ONLY_PROGRAM)
                used.add(why)
                if why is None:
                    differ.append(f"{file}: {place} {what}: " + (
                        f"only the schema refuses: {complaints(file, case)[0]}" if found
                        else f"only the program refuses: {answer}"))
            self.assertFalse(differ, "\n".join(differ))
            self.assertGreater(refused, {"campaign": 500, "site": 500, "machine": 100}.get(file, 20))
        self.assertEqual({*ONLY_PROGRAM, *ONLY_SCHEMA} - used, set(), "they do not differ there")

    def test_rules_over_several_tables_are_left_to_the_program(self):
        data = whole.campaign()
        plan = {**data, "measurement": []}
        twice = copy.deepcopy(data)
        twice["measurement"][1]["id"] = "X 1"
        slave = copy.deepcopy(data)
        slave["measurement"][0]["side"] = "slave"
        unnamed = without(slave, ("machine", "axes", "X", "slave"))
        cases = [slave, unnamed, plan, without(plan, ("run", "analyses")), without(without(data, ("run",)), ("measurement",)), twice]
        self.assertEqual([answer == "ok" for answer in verdicts("campaign", map(toml.document, cases))],
                         [True, False, True, False, False, False])
        for case in cases:
            self.assertEqual(complaints("campaign", case), [])

    def test_the_documents_name_every_key(self):
        campaign = (PROJECT / "docs" / "manifest.md").read_text(encoding="utf-8")
        rest = (PROJECT / "docs" / "site.md").read_text(encoding="utf-8").partition("\n## site.toml\n")[2]
        machine = rest.partition("\n## machines/ASSET.toml\n")[2]
        logs = [(file, rest.partition(f"\n### {file}.toml\n")[2].partition("\n##")[0]) for file in whole.LOGS]
        for file, section in (("campaign", campaign), ("site", rest.partition("\n## ")[0]),
                              ("machine", machine.partition("\n## ")[0]), *logs):
            named, declared = set(documented(section)), {p for p in keys_of(SCHEMAS[file]) if p[-1] != "*"}
            self.assertEqual(named - declared, set(), f"{file}.toml has none of these")
            self.assertEqual(declared - named, set(), f"the document of {file}.toml does not name these")

    def test_the_tables_of_keys_are_generated(self):
        done = subprocess.run([PROJECT / "scripts" / "generate-docs", "--check", NONIO], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_every_key_has_a_description(self):
        """A sentence or two; options are described by their plugins."""
        for s in SCHEMAS.values():
            for path, value in places(s):
                if path[-1] == "description" and not isinstance(value, dict) and "options" not in path:
                    self.assertRegex(value, r"^[A-Z\"`].*[.)]$", path)


def documented(text):
    """Keys of the first column of a table: `[section]` `key`, ...; a section goes on in the rows below."""
    section = ()
    for row in re.findall(r"^\| (.*?) \|", text, re.MULTILINE):
        for word in re.findall(r"`([^`]+)`", row):
            header = re.fullmatch(r"\[+([^\]]+)\]+", word)
            if header is None:
                yield (*section, word)
                continue
            section = tuple(header[1].replace("axes.X", "axes.*").split("."))
            section = section[:1] if section[0] == "options" else section
            for end in range(1, len(section) + 1):
                if section[:end][-1] != "*":
                    yield section[:end]


READINGS = "run,direction,target_mm,deviation_um\n" + "".join(
    f"{run},{way},{target},{target / 50 + run % 2}\n" for run in (1, 2, 3)
    for way, targets in (("+", (0, 50, 100)), ("-", (100, 50, 0))) for target in targets)


def small(**changes):
    return {"format": 1, "machine": {"axes": {"X": {}}},
            "measurement": [{"id": "X", "kind": "axis", "axis": "X", "file": "x.csv"}],
            "run": {"analyses": ["iso230-2"], "outputs": ["json"]}, **changes}


def measured(**more):
    return small(measurement=[{"id": "X", "kind": "axis", "axis": "X", "file": "x.csv", **more}])


def modelled(effect, **more):
    return small(run={"analyses": ["model-fit"], "outputs": ["json"]}, model={"effects": [effect], **more})


FORMULA = {"name": "sag", "axis": "X", "expression": "a*p*p/m", "parameters": [{"name": "a", "unit": "um/m"}]}
# Name, whether it is good, the campaign.
NAMED = [
    ("as-it-is", True, small()),
    ("analysis", False, small(run={"analyses": ["iso230-3"]})),
    ("output", False, small(run={"outputs": ["jsn"]})),
    ("control", False, small(machine={"control": "fanuk"})),
    ("good-control", True, small(machine={"control": "fanuc"})),
    ("control-unsaid", True, small(machine={"control": ""})),
    ("reader", False, measured(reader="cvs")),
    ("good-reader", True, measured(reader="csv")),
    ("effect", False, modelled("bakclash:X")),
    ("effect-of-nothing", False, modelled("backlash")),
    ("effect-in-space", False, modelled("yaw:x")),
    ("effect-of-the-set-up", False, modelled("line-slope:X")),
    ("good-effect", True, modelled("backlash:X")),
    ("formula", True, modelled("sag:X", formula=[FORMULA])),
    ("owner", False, small(options={"iso230-3": {"edition": 2006}})),
    ("option", False, small(options={"iso230-2": {"editon": 2006}})),
    ("choice", False, small(options={"iso230-2": {"edition": 2007}})),
    ("type", False, small(options={"iso230-2": {"edition": "2006"}})),
    ("good-option", True, small(options={"iso230-2": {"edition": 2006}})),
]


def beyond(option, limit, by):
    if limit not in option:
        return None
    return int(option[limit]) + by if option["type"] == "integer" else option[limit] + by


class Run(unittest.TestCase):
    """Names and options that the plugins bring: what a run says of them, the schema says too."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="nonio-schema-")
        self.root = pathlib.Path(self._folder.name)

    def tearDown(self):
        self._folder.cleanup()

    def campaign(self, name, data):
        folder = self.root / "site" / name
        folder.mkdir(parents=True)
        (folder / "campaign.toml").write_text(toml.document({**data, "campaign": {"id": name}}), encoding="utf-8")
        (folder / "x.csv").write_text(READINGS, encoding="utf-8")

    def run_nonio(self):
        return subprocess.run([NONIO, "run", str(self.root / "site"), "--out", str(self.root / "out"), "--quiet"],
                              capture_output=True, text=True, timeout=300, check=False)

    def test_names_and_options_of_a_campaign(self):
        for name, _, data in NAMED:
            self.campaign(name, data)
        self.run_nonio()
        for name, good, data in NAMED:
            results = json.loads((self.root / "out" / name / "results.json").read_text(encoding="utf-8"))
            self.assertEqual(results["errors"] == [], good, f"{name}: {results['errors']}")
            found = complaints("campaign", {**data, "campaign": {"id": name}})
            self.assertEqual(found == [], good, f"{name}: {found}")

    def site(self, options):
        """What the program says of these options in site.toml."""
        (self.root / "site" / "site.toml").write_text(toml.document({"options": options}), encoding="utf-8")
        done = self.run_nonio()
        return done.returncode, done.stderr

    def test_every_option_of_every_plugin(self):
        self.campaign("a", small())
        owners = SCHEMAS["site"]["properties"]["options"]["properties"]
        options = {owner: s["properties"] for owner, s in owners.items() if s["properties"]}
        self.assertGreater(len(options), 10)

        def values(choose):
            chosen = {owner: {name: choose(s) for name, s in own.items()} for owner, own in options.items()}
            return {owner: {n: v for n, v in own.items() if v is not None} for owner, own in chosen.items()}

        defaults = values(lambda s: s["default"])
        self.assertEqual(complaints("site", {"options": defaults}), [])
        self.assertNotEqual(self.site(defaults)[0], 2)
        wrong = {
            "type": values(lambda s: "x" if s["type"] != "string" else 7),
            "choice": values(lambda s: None if "enum" not in s else "x" if s["type"] == "string" else 7777),
            "too little": values(lambda s: beyond(s, "minimum", -1)),
            "too much": values(lambda s: beyond(s, "maximum", 1)),
            "unknown": {owner: {"nonsense": 1} for owner in options},
        }
        for what, each in wrong.items():
            status, said = self.site(each)
            self.assertEqual(status, 2, what)
            for owner, own in each.items():
                for name, value in own.items():
                    self.assertIn(f"options.{owner}.{name}", said, what)
                    self.assertNotEqual(complaints("site", {"options": {owner: {name: value}}}), [], (what, owner, name))


if __name__ == "__main__":
    unittest.main()
