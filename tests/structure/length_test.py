# SPDX-License-Identifier: Apache-2.0
"""No source above 400 lines and no function above a screen (60 lines) without a comment `// Long: why`: at the top of
the file, or right above the function. A comment that is no longer needed is found too.

length_test.py SOURCE_FOLDER"""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
PARTS = ("engine", "plugins", "reports", "tests", "bench", "templates", "samples")
FILE, FUNCTION = 400, 60
WHY = re.compile(r"// Long: \S+ \S+")
# What ends in { and is no function. Sources are formatted (scripts/check-format), so indents tell where a body ends.
OTHER = re.compile(r"\s*(namespace|struct|class|enum|union|extern|if|for|while|switch|else|do\b|case|\}|[^(]*=|template <.*> struct)")


def functions(lines):
    """(first line, length) of each function at most one class or namespace deep; lines from 0."""
    for brace, line in enumerate(lines):
        if not line.rstrip().endswith("{"):
            continue
        first = brace  # the head of a function may take several lines
        while first > 0 and lines[first - 1].strip() and not re.search(r"//|[{};:]\s*$|^#", lines[first - 1]):
            first -= 1
        head = lines[first]
        indent = len(head) - len(head.lstrip())
        if indent > 4 or OTHER.match(head):
            continue
        for last in range(brace + 1, len(lines)):
            if lines[last].strip() and len(lines[last]) - len(lines[last].lstrip()) <= indent:
                if lines[last].startswith(" " * indent + "}"):
                    yield first, last - first + 1
                break


def comment_that_ends(lines, end):
    """The lines of the comment right above line `end`."""
    first = end
    while first > 0 and re.match(r"\s*//", lines[first - 1]):
        first -= 1
    return lines[first:end]


def says_why(comment):
    return any(WHY.search(line) for line in comment)


def complaints(name, text):
    lines = text.splitlines()
    top = next((i for i, line in enumerate(lines) if not line.startswith("//")), len(lines))
    long, why = len(lines) > FILE, says_why(lines[:top])
    if long and not why:
        yield f"{name}: expected at most {FILE} lines or a comment \"// Long: why\" at the top, found {len(lines)} lines"
    if why and not long:
        yield f"{name}: expected no \"// Long:\" at the top of a file of {len(lines)} lines"
    for first, length in functions(lines):
        if length > FUNCTION and not says_why(comment_that_ends(lines, first)):
            yield (f"{name}:{first + 1}: expected at most {FUNCTION} lines of a function or a comment \"// Long: why\" "
                   f"above it, found {length} lines")


class Length(unittest.TestCase):
    maxDiff = None

    def test_sources_and_functions_are_short_or_say_why(self):
        files = [p for part in PARTS for p in (ROOT / part).rglob("*") if p.suffix in (".cpp", ".h")]
        self.assertGreater(len(files), 500)
        found = [c for p in sorted(files) for c in complaints(p.relative_to(ROOT).as_posix(), p.read_text(errors="replace"))]
        self.assertEqual("", "\n".join(found))

    def test_what_is_long_is_seen(self):
        body = "int f(int a,\n      int b) {\n" + "  ++a;\n" * 60 + "  return a;\n}\n"
        lines = "int x;\n" * 401
        for text, count in ((body, 1), ("int x;\n\n// Long: a list.\n" + body, 0), ("int x;\n\n// Long:\n" + body, 1),
                                            (lines, 1), ("// Long: one table.\n" + lines, 0), ("// Long:\n" + lines, 1),
                            ("// Long: one table.\nint x;\n", 1)):
            self.assertEqual(count, len(list(complaints("a.cpp", text))), text[:60])


if __name__ == "__main__":
    unittest.main()
