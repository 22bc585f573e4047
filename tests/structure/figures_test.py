# SPDX-License-Identifier: Apache-2.0
"""The figures that the source papers print: each has a test that is there and has the figure in its body, or a reason; the
page docs/dev/printed-figures.md shows the same rows.

figures_test.py SOURCE_FOLDER [--update]   --update writes the rows of the page anew"""
import pathlib
import re
import sys
import tomllib
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
LIST = ROOT / "tests" / "structure" / "printed_figures.toml"
PAGE = ROOT / "docs" / "dev" / "printed-figures.md"
PAPERS = {"gantry": "Two diagonals of a gantry, and triples", "standards": "ISO 230-2 and VDI/DGQ 3441",
          "rotary": "Rotary axes", "steps": "Step diagonals"}
KEYS = {"paper", "printed", "nonio", "test", "with", "why"}


def body(path, name):
    """The text of a test: TEST(SUITE, CASE) up to the brace at the margin, or a method up to the next one; else None."""
    if not path.is_file():
        return None
    text = path.read_text()
    if path.suffix == ".cpp":
        if name.count(".") != 1:
            return None
        suite, case = map(re.escape, name.split("."))
        found = re.search(rf"^TEST(?:_F|_P)?\({suite}, {case}\) \{{.*?^\}}", text, re.M | re.S)
    else:
        found = re.search(rf"^( +)def {re.escape(name)}\(self.*?(?=^\1def |^\S|\Z)", text, re.M | re.S)
    return found.group(0) if found else None


def wrong(row):
    """What is wrong with a row, or None."""
    if set(row) - KEYS or not {"paper", "printed", "nonio"} <= set(row) or row["paper"] not in PAPERS:
        return "expected paper, printed, nonio, and test or why"
    if "test" not in row:
        return None if row.get("why") and "with" not in row else "expected a test, or a reason and nothing to look for"
    path, _, name = row["test"].partition(": ")
    if "with" not in row:
        return "expected the words that the test must have"
    there = body(ROOT / path, name)
    if there is None:
        return f"there is no test {row['test']}"
    lacks = [word for word in row["with"] if word not in there]
    if not row["with"] and not row.get("why"):
        return "expected a figure that the test compares"
    return f"{row['test']} has no {lacks}" if lacks else None


def rows():
    return tomllib.loads(LIST.read_text())["figure"]


def page_rows():
    out = []
    for paper, title in PAPERS.items():
        out += [f"## {title}", "", "| printed | Nonio | test, or why not |", "|---|---|---|"]
        for row in rows():
            if row["paper"] == paper:
                test = "`" + row["test"].partition(": ")[2] + "`" if "test" in row else ""
                says = ". ".join(part for part in (test, row.get("why", "")) if part)
                out.append(f"| {row['printed']} | {row['nonio']} | {says} |")
        out.append("")
    return "\n".join(out)


class Figures(unittest.TestCase):
    maxDiff = None

    def test_every_row_has_its_test_or_its_reason(self):
        self.assertGreater(len(rows()), 20)
        self.assertEqual([], [f"{row.get('printed')}: {wrong(row)}" for row in rows() if wrong(row)])
        self.assertEqual(set(PAPERS), {row["paper"] for row in rows()})

    def test_the_page_has_the_same_rows(self):
        self.assertEqual(page_rows(), PAGE.read_text().partition("\n\n## ")[2].join(["## ", ""]))

    def test_a_row_without_its_test_is_seen(self):
        here = {"paper": "steps", "printed": "p", "nonio": "n"}
        plan = "tests/system/verbs/plan_test.py: "
        for more, words in (({}, "expected a test"), ({"why": "w", "with": []}, "nothing to look for"),
                            ({"test": plan + "test_count_and_odd", "with": []}, "there is no test"),
                            ({"test": plan + "test_count_and_even", "with": []}, "expected a figure"),
                            ({"test": plan + "test_count_and_even", "with": ["67.20"]}, "has no"),
                            ({"test": "tests/unit/math/triples_test.cpp: Triples.None", "with": []}, "there is no test"),
                            ({"test": "tests/none.cpp: Triples.None", "with": []}, "there is no test"),
                            ({"papers": "x"}, "expected paper"), ({"paper": "x"}, "expected paper")):
            self.assertIn(words, wrong({**here, **more}) or "", more)
        self.assertIsNone(wrong({**here, "test": plan + "test_count_and_even", "with": ["--even"]}))
        self.assertIsNone(wrong({**here, "why": "w"}))


if __name__ == "__main__":
    if "--update" in sys.argv:
        PAGE.write_text(PAGE.read_text().partition("\n\n## ")[0] + "\n\n" + page_rows())
        sys.exit()
    unittest.main()
