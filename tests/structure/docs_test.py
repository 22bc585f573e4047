# SPDX-License-Identifier: Apache-2.0
"""What holds for the documents: lines fit 120 columns, tables and code apart; links point at pages that are
there; the rows of docs/constants.md are those that the code names.

docs_test.py SOURCE_FOLDER"""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
WIDTH = 120


def wide_lines(text):
    """Numbers of the lines that are too long and are neither a table, code, a comment nor one link."""
    code = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            code = not code
        elif not code and len(line) > WIDTH and not re.match(r"\s*(\||<!--|!\[|\[[^\]]*\]\([^)]*\)[.,]?$)", line):
            yield number


class Documents(unittest.TestCase):
    def test_a_line_that_is_too_long_is_seen(self):
        self.assertEqual([1], list(wide_lines("x " * 61)))
        self.assertEqual([], list(wide_lines("| " + "x " * 61)))
        self.assertEqual([], list(wide_lines("```\n" + "x " * 61 + "\n```")))

    def test_lines_fit_120_columns(self):
        wide = [f"{page.relative_to(ROOT)}:{n}" for page in PAGES for n in wide_lines(page.read_text())]
        self.assertEqual([], wide, "expected at most 120 columns")

    def test_links_lead_to_files_that_are_there(self):
        lost = [f"{page.relative_to(ROOT)}: {target}" for page in PAGES
                for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text())
                if "://" not in target and not (page.parent / target).exists()]
        self.assertEqual([], lost)

    def test_rows_of_the_constants_are_those_that_the_code_names(self):
        rows = set(re.findall(r"^\| ([AM]\d+) \|", (ROOT / "docs/constants.md").read_text(), re.M))
        named = set()
        for folder in ("engine/model", "engine/math", "engine/host"):
            for path in (ROOT / folder).rglob("*"):
                if path.suffix in (".cpp", ".h"):
                    named.update(re.findall(r"docs/constants\.md, ([AM]\d+)\b", path.read_text()))
        self.assertEqual(rows, named)


if __name__ == "__main__":
    unittest.main()
