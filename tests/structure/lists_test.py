# SPDX-License-Identifier: Apache-2.0
"""What is built and tested is listed in CMake, and the lists are complete: no file(GLOB), and every source, plugin, case
and document is in a list.

lists_test.py SOURCE_FOLDER"""
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
# The files that are allowed to read a folder; each states the reason.
READS_A_FOLDER = {"cmake/NonioCase.cmake": 1, "cmake/NonioPlugin.cmake": 1}
PARTS = ("engine", "reports", "plugins", "templates", "tests", "cmake", "bench")


def code(text):
    return re.sub(r"#.*", "", text)


def globs(text):
    return len(re.findall(r"\bfile\s*\(\s*GLOB", code(text)))


def names(lists, name):
    """Whether the text of a CMakeLists.txt has this name, as a word of its own."""
    return re.search(rf"(?<![\w./-]){re.escape(name)}(?![\w./-])", code(lists)) is not None


def unnamed_sources(root):
    """Sources that no CMakeLists.txt of their folder or of one above it names."""
    lists = {p.parent: code(p.read_text()) for p in root.rglob("CMakeLists.txt")}
    for path in sorted(root.rglob("*.cpp")):
        above = [f for f in path.parents if f in lists and root in (f, *f.parents)]
        if not any(names(lists[f], path.relative_to(f).as_posix()) for f in above):
            yield path.relative_to(root).as_posix()


class Lists(unittest.TestCase):
    maxDiff = None

    def missing(self, lists, found):
        """Of the names `found`, which there must be, those that the CMakeLists.txt of `lists` does not have."""
        found = list(found)
        self.assertTrue(found)
        text = (ROOT / lists / "CMakeLists.txt").read_text()
        self.assertEqual([], [name for name in found if not names(text, name)], f"expected in {lists}/CMakeLists.txt")

    def test_no_list_is_read_from_a_folder(self):
        files = [ROOT / "CMakeLists.txt", *(p for part in PARTS for pattern in ("CMakeLists.txt", "*.cmake")
                                            for p in (ROOT / part).rglob(pattern))]
        self.assertGreater(len(files), 100)
        found = {p.relative_to(ROOT).as_posix(): globs(p.read_text()) for p in files}
        self.assertEqual(READS_A_FOLDER, {name: count for name, count in found.items() if count})

    def test_every_source_is_named(self):
        for part in ("engine", "reports", "plugins"):
            self.assertEqual([], list(unnamed_sources(ROOT / part)), part)

    def test_every_plugin_is_named_and_has_a_readme(self):
        folders = [p.parent for p in (ROOT / "plugins").glob("*/*/CMakeLists.txt")]
        self.missing("plugins", (p.relative_to(ROOT / "plugins").as_posix() for p in folders))
        self.assertEqual([], [str(p) for p in folders if not (p / "README.md").exists()])

    def test_every_template_is_named(self):
        self.missing("templates", (p.name for p in (ROOT / "templates").iterdir() if p.name != "CMakeLists.txt"))

    def test_every_case_is_named(self):
        for folder in ("tests/cases", "tests/cases/readers"):
            self.missing(folder, (p.stem for p in (ROOT / folder).glob("*.case")))

    def test_every_list_of_mutants_is_named(self):
        text = code((ROOT / "tests/mutants/CMakeLists.txt").read_text())
        found = [p.stem for p in (ROOT / "tests/mutants").glob("*.toml")]
        self.assertIn("iso230_2", found)
        self.assertEqual([], [name for name in found if not re.search(rf"[/ ]{name}[ ).]", text)])

    def test_every_document_is_run(self):
        patterns = ("*.md", "docs/*.md", "docs/dev/*.md", "samples/*.md", "samples/*/README.md", "tests/*/README.md", "tests/*/*/README.md")
        self.missing("tests/system/docs", (p.relative_to(ROOT).as_posix() for pattern in patterns for p in ROOT.glob(pattern)))

    def test_what_is_not_named_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "src").mkdir()
            (root / "CMakeLists.txt").write_text("add_library(a\n  src/a.cpp\n  src/abc.cpp)  # src/b.cpp\n")
            for name in ("a", "b", "bc"):
                (root / "src" / f"{name}.cpp").write_text("")
            self.assertEqual(["src/b.cpp", "src/bc.cpp"], list(unnamed_sources(root)))
        self.assertEqual(2, globs("file(GLOB a *.cpp)\nfile( GLOB_RECURSE b *)  # file(GLOB c)"))


if __name__ == "__main__":
    unittest.main()
