# SPDX-License-Identifier: Apache-2.0
"""library_test.py ROOT [--write]

The table of causes in docs/effects.md is that of templates/causes; --write makes it anew."""
import pathlib
import sys
import tomllib
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
PAGE = ROOT / "docs" / "effects.md"
BEGIN, END = "<!-- causes: made by tests/structure/library_test.py --write -->\n", "<!-- end of causes -->\n"


def causes():
    for file in sorted((ROOT / "templates" / "causes").glob("*.toml")):
        for cause in tomllib.loads(file.read_text())["cause"]:
            yield file.stem, cause


def table():
    rows = ["| name | of | cause | deviation | usual size | table | prior |", "|---|---|---|---|---|---|---|"]
    for group, c in causes():
        expression = c["expression"].replace("|", "&#124;")
        rows.append(f"| `{c['name']}` | {group}, {c['axis']} | {c['title']['en']} | <code>{expression}</code> | {c['size']} "
                    f"| {'yes' if c.get('compensable') else 'no'} | {c.get('prior', 'common')} |")
    return "\n".join(rows) + "\n"


def with_table(text):
    before, rest = text.split(BEGIN)
    return before + BEGIN + "\n" + table() + "\n" + END + rest.split(END)[1]


class Library(unittest.TestCase):
    maxDiff = None

    def test_table_is_current(self):
        text = PAGE.read_text()
        self.assertEqual(with_table(text), text, "run tests/structure/library_test.py ROOT --write")

    def test_names_and_texts_are_there_once(self):
        names = [c["name"] for _, c in causes()]
        self.assertGreaterEqual(len(names), 60)
        self.assertEqual(len(set(names)), len(names))
        formulas = [(c["axis"], c["expression"]) for _, c in causes()]
        self.assertEqual(len(set(formulas)), len(formulas), "two causes have one formula")


if __name__ == "__main__":
    if "--write" in sys.argv:
        PAGE.write_text(with_table(PAGE.read_text()))
    else:
        unittest.main()
