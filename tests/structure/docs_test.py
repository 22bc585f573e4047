# SPDX-License-Identifier: Apache-2.0
"""What holds for the documents: lines fit 120 columns, tables and code apart; links point at pages and headings that
are there, and so do the pages that the sources name; the rows of docs/dev/constants.md are those that the code names;
no page, no help and no English text has the phrases that readers stumbled over.

docs_test.py SOURCE_FOLDER"""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
WIDTH = 120
NAVIGATION = re.findall(r"^ +- ([^:]+): (\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.M)
# What a person reads first: all; metrologist, service engineer, IT, author of a plugin.
PATHS = [["README.md"], ["docs/index.md", "docs/howto-metrologist.md", "docs/tutorial-first-certificate.md"],
         ["docs/index.md", "docs/howto-service.md"], ["docs/index.md", "docs/howto-nightly.md"],
         ["docs/index.md", "docs/howto-plugin.md"]]
ITEM = re.compile(r"(?:[-*]|\d+\.) ")


def wide_lines(text):
    """Numbers of the lines that are too long and are neither a table, code, a comment nor one link."""
    code = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            code = not code
        elif not code and len(line) > WIDTH and not re.match(r"\s*(\||<!--|!\[|\[[^\]]*\]\([^)]*\)[.,]?$)", line):
            yield number


def lost_lists(text):
    """Numbers of the lines that Python-Markdown takes for running text: an item without a blank line before the list, or
    after a block of the last item, and a block or paragraph of an item that is indented by 1 to 3."""
    code, in_list, before = False, False, ""
    for number, line in enumerate(text.splitlines(), 1):
        fence = re.match(r" *```\S*$", line)
        if not code and re.match(r" {1,3}\S", line) and (fence or in_list and not before.strip()):
            yield number
        if fence:
            code = not code
        elif not code and ITEM.match(line):
            if before.startswith("    ") or not in_list and before.strip() and not before.startswith(("#", "|")):
                yield number
            in_list = True
        elif not code and line.strip() and not line.startswith(" "):
            in_list = in_list and bool(before.strip())
        before = line


def elements(text):
    """Placeholders such as <asset> outside of code, which a browser takes for an element and does not show."""
    text = re.sub(r"^ *```.*?^ *```|<!--.*?-->|`[^`]*`", "", text, flags=re.M | re.S)
    return [m[0] for m in re.finditer(r"<(\w+)>", text) if m[1] not in ("code", "br", "sub", "sup")]


# Phrases that a reader had to read twice.
RIDDLES = re.compile(r"""predecessors | \bhas\ a\ say\b | what\ comes\ of\ it | \bto\ be\ had\b | \bbad\ record\b
    | (held|hold|holds|holding)\ (\w+\ )?against\b | laws\ of\ (its|their|each)\ kind | verdict:\ nothing
    | deserves?\ (a\ look|their\ trust) | what\ is\ left\b | nobody\ (knows|says|pays|fills)
    | tell(s)?\ them\ apart | told\ apart | the\ whole\ of\ what | left\ unsaid | is\ not\ content\ with
    | as\ far\ as\ these\ readings\ go | \bone\ a\ (row|file|line|campaign|check|kind)\b""",
    re.X | re.I)


def joined(text):
    """The text on one line, literals of C++ that follow one another as one."""
    return re.sub(r"\s+", " ", re.sub(r'"\s*\n\s*"', "", text).replace("\\n", " "))


def headings(text):
    """The names under which a page's headings are linked to."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    return {re.sub(r"[^\w\- ]", "", line.strip().lower()).replace(" ", "-")
            for line in re.findall(r"^#+ (.*)$", text, re.M)}


def sources():
    for folder in ("engine", "plugins", "reports", "templates", "tests", "samples", "bench", "scripts", "cmake"):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix in (".cpp", ".h", ".py", ".md", ".toml", ".txt", ".cmake", ".in") and path.is_file():
                yield path


class Documents(unittest.TestCase):
    maxDiff = None
    def test_a_line_that_is_too_long_is_seen(self):
        self.assertEqual([1], list(wide_lines("x " * 61)))
        self.assertEqual([], list(wide_lines("| " + "x " * 61)))
        self.assertEqual([], list(wide_lines("```\n" + "x " * 61 + "\n```")))

    def test_lines_fit_120_columns(self):
        wide = [f"{page.relative_to(ROOT)}:{n}" for page in PAGES for n in wide_lines(page.read_text())]
        self.assertEqual([], wide, "expected at most 120 columns")

    def test_no_placeholder_is_an_element(self):
        self.assertEqual(["<asset>"], elements("machines/<asset>.toml of `<folder>`, H<sub>2</sub>O"))
        found = [f"{page.relative_to(ROOT)}: {e}" for page in PAGES for e in elements(page.read_text(encoding="utf-8"))]
        self.assertEqual([], found, "expected a placeholder in capitals or in backquotes")

    def test_each_sample_has_one_row_in_their_order(self):
        rows = re.findall(r"^\| `([^`]+)` \|", (ROOT / "samples" / "README.md").read_text(), re.M)
        there = sorted(p.name for p in (ROOT / "samples" / "site").iterdir() if (p / "campaign.toml").exists())
        self.assertEqual(there, rows)

    def test_no_row_of_the_manifest_is_there_twice(self):
        rows = re.findall(r"^\|.*$", (ROOT / "docs" / "manifest.md").read_text(), re.M)
        keys = [row.split(" | ")[0] for row in rows if "`[" in row.split(" | ")[0] or "`kind`" in row]
        self.assertEqual([], sorted({k for k in keys if keys.count(k) > 1 and k != "| `kind`"}))
        self.assertEqual(1, sum(row.startswith("| `kind` | Required") for row in rows))

    def test_links_lead_to_files_that_are_there(self):
        lost = [f"{page.relative_to(ROOT)}: {target}" for page in PAGES
                for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text())
                if "://" not in target and not (page.parent / target).exists()]
        self.assertEqual([], lost)

    def test_links_lead_to_headings_that_are_there(self):
        lost = []
        for page in PAGES:
            for target, heading in re.findall(r"\]\(([^)#\s]*)#([^)]+)\)", page.read_text()):
                there = page.parent / target if target else page
                if "://" not in target and heading not in headings(there.read_text()):
                    lost.append(f"{page.relative_to(ROOT)}: {target}#{heading}")
        self.assertEqual([], lost)

    def test_pages_that_the_sources_name_are_there(self):
        lost = {f"{path.relative_to(ROOT)}: {page}" for path in sources()
                for page in re.findall(r"\bdocs/[a-z-]+\.md\b", path.read_text(errors="replace"))
                if not (ROOT / page).exists()}
        self.assertEqual(set(), lost)

    def test_no_phrase_that_readers_stumbled_over(self):
        texts = [*PAGES, *(ROOT / "plugins").rglob("README.md"), *(ROOT / "templates/words/en").glob("*.toml"),
                 *(ROOT / "engine/app").glob("*.cpp"), *(ROOT / "engine/plugin_check").glob("*.cpp")]
        found = [f"{path.relative_to(ROOT)}: {phrase.group(0)!r}" for path in texts
                 for phrase in RIDDLES.finditer(joined(path.read_text()))]
        self.assertEqual("", "\n".join(found))

    def test_a_phrase_over_two_lines_or_two_strings_is_seen(self):
        for text in ("what\ncomes of it", 'a = "what comes "\n      "of it";'):
            self.assertTrue(RIDDLES.search(joined(text)), text)

    def test_every_page_is_in_the_navigation_once(self):
        self.assertEqual(sorted(page for _, page in NAVIGATION), sorted(p.relative_to(ROOT / "docs").as_posix() for p in (ROOT / "docs").rglob("*.md")))

    def test_each_reader_reaches_the_goal_within_3000_words(self):
        for pages in PATHS:
            words = sum(len(re.sub(r"<!--.*?-->", "", (ROOT / page).read_text(), flags=re.S).split()) for page in pages)
            self.assertLessEqual(words, 700 if pages == ["README.md"] else 3000, pages)

    def test_a_page_has_one_title(self):
        titles = {page: title for title, page in NAVIGATION if page != "index.md"}
        headings_1 = {page: re.search(r"^# (.*)$", (ROOT / "docs" / page).read_text(), re.M)[1] for page in titles}
        self.assertEqual(titles, headings_1)

    def test_the_text_of_a_link_is_no_file(self):
        found = [f"{page.relative_to(ROOT)}: {text}" for page in PAGES if page.parent != ROOT
                 for text in re.findall(r"\[([\w.-]+\.md|howto-\w+|tutorial-[\w-]+)\]\(", page.read_text())]
        self.assertEqual([], found, "expected the title of the page")

    def test_each_picture_is_shown(self):
        shown = {(page.parent / target).resolve().relative_to(ROOT) for page in PAGES
                 for target in re.findall(r"!\[[^\]]*\]\(([^)\s]+)\)", page.read_text())}
        there = {path.relative_to(ROOT) for path in (ROOT / "docs" / "pictures").iterdir()}
        self.assertEqual(there, shown)

    def test_lists_are_lists_on_the_built_pages(self):
        self.assertEqual([2], list(lost_lists("text\n- an item\n")))
        self.assertEqual([3], list(lost_lists("1. an item\n\n   ```sh\n   true\n   ```\n")))
        self.assertEqual([4], list(lost_lists("1. an item\n\n    of two paragraphs\n2. another\n")))
        self.assertEqual([], list(lost_lists("text\n\n- an item\n- another\n\n    ```sh\n    - no\n    ```\n")))
        pages = [*PAGES, *(ROOT / "plugins").rglob("README.md")]
        lost = [f"{page.relative_to(ROOT)}:{n}" for page in pages for n in lost_lists(page.read_text())]
        self.assertEqual([], lost, "expected a blank line before a list, and blocks in it indented by 4")

    def test_rows_of_the_constants_are_those_that_the_code_names(self):
        listed = re.findall(r"^\| ([AM]\d+) \|", (ROOT / "docs/dev/constants.md").read_text(), re.M)
        rows = set(listed)
        self.assertEqual([], sorted(row for row in rows if listed.count(row) > 1), "one number for two rows")
        named = set()
        for folder in ("engine/model", "engine/math", "engine/sdk", "engine/campaign", "plugins"):
            for path in (ROOT / folder).rglob("*"):
                if path.suffix in (".cpp", ".h"):
                    named.update(re.findall(r"docs/dev/constants\.md, ([AM]\d+)\b", path.read_text()))
        self.assertEqual(rows, named)


if __name__ == "__main__":
    unittest.main()
