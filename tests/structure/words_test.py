# SPDX-License-Identifier: Apache-2.0
"""Texts for people use the terms of docs/terms.toml: no forbidden synonym and no private phrase in templates/words, in
literals of engine, plugins and reports (among them all texts of --help), in comments and docstrings of all sources and
scripts, in README.md, CONTRIBUTING.md and the pages for users and developers. The glossary is generated from the terms.

words_test.py SOURCE_FOLDER"""
import pathlib
import re
import subprocess
import sys
import tomllib
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
TERMS = tomllib.loads((ROOT / "docs" / "terms.toml").read_text(encoding="utf-8"))
TERM = [term for section in TERMS["section"] for term in section["term"]]


def rules(language):
    """(pattern, pattern of exceptions, words to write) of a language."""
    key = "forbidden" if language == "en" else f"forbidden_{language}"
    found = [(re.compile(pattern, re.I), None, term.get(language, "")) for term in TERM for pattern in term.get(key, [])]
    return found + [(re.compile(p["pattern"], re.I), re.compile(p["except"], re.I) if "except" in p else None, p["write"])
                    for p in TERMS["phrase"] if p.get("language", "en") == language]


def wrong(text, language="en"):
    """(phrase, words to write) of each phrase that the text may not have."""
    for pattern, exception, write in RULES[language]:
        for match in pattern.finditer(text):
            if not (exception and exception.search(text[max(0, match.start() - 30):match.end() + 30])):
                yield match[0], write


RULES = {language: rules(language) for language in ("en", "de", "it")}
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')
LINES = r"(?:^|(?<=[ \t])){0}.*(?:\n[ \t]*{0}.*)*"  # comments on successive lines are one, because phrases are wrapped
SLASHES, HASH, BLOCK = LINES.format("//"), LINES.format("#(?!!)"), r"/\*[\s\S]*?\*/"
TEXT = r"""\"{3}[\s\S]*?\"{3}|'{3}[\s\S]*?'{3}"""
COMMENT = {suffix: re.compile(pattern, re.M) for suffix, pattern in {  # group 1: a comment; otherwise a text that may contain "#"
    ".h": f"({SLASHES})", ".cpp": f"({SLASHES})", ".js": f"({SLASHES}|{BLOCK})", ".css": f"({BLOCK})", ".sh": f"({HASH})",
    ".cmake": f"({HASH})", **dict.fromkeys(("", ".py"), rf'(^[ \t]*"""[\s\S]*?"""|{HASH})|{TEXT}')}.items()}


def words(language):
    """(place, text) of each value of templates/words."""
    def texts(table):
        for value in table.values():
            yield from texts(value) if isinstance(value, dict) else [str(value)]
    for path in sorted((ROOT / "templates" / "words" / language).glob("*.toml")):
        for text in texts(tomllib.loads(path.read_text(encoding="utf-8"))):
            yield path.name, re.sub(r"\{\w+\}", "{}", text)


def kind(path):
    """The suffix of a source, also of one that CMake or `nonio plugin new` fills in (.in)."""
    name = pathlib.PurePath(path).name.removesuffix(".in")
    return ".cmake" if name == "CMakeLists.txt" else pathlib.PurePath(name).suffix


def sources(*folders):
    """(path, text) of each file with comments; without a suffix it is a script."""
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if kind(path) in COMMENT and path.is_file() and (kind(path) or path.read_bytes()[:2] == b"#!"):
                yield path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")


def literals(text):
    """The literals that people read; literals in succession are one, a name without a blank is none."""
    code = re.sub(r"^\s*(//|#include).*$", "", text, flags=re.M)
    code = re.sub(r"[ \t]//[^\"\n]*$", "", code, flags=re.M)
    code = re.sub(r'"\s*\n\s*"', "", code)
    return [literal for literal in LITERAL.findall(code) if " " in literal.strip()]


def comments(path, text):
    """(line, text) of each comment and docstring of a source."""
    for match in COMMENT[kind(path)].finditer(text):
        if match[1]:
            yield text.count("\n", 0, match.start()) + 1, re.sub(r"\n[ \t]*(//+|#+|\*)?[ \t]*", " ", match[1])


def prose(text):
    """A page without code, comments, and targets of links."""
    text = re.sub(r"^ *```.*?^ *```", "", text, flags=re.M | re.S)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    return re.sub(r"`[^`\n]*`|\]\([^)]*\)", " ", text)


class Words(unittest.TestCase):
    maxDiff = None

    def test_a_planted_phrase_is_found(self):
        for text in ("The key stands beside the file.", "the next night", "after our reading", "It cannot be decided."):
            self.assertTrue(list(wrong(text)), text)
        self.assertTrue(list(wrong("Alle Ablesungen", "de")))
        for text in ("Die Spalte sagt es.", "Niemand nennt sie.", "was er wegnähme", "nicht wie versprochen", "nicht entscheidbar", "nicht sicher"):
            self.assertTrue(list(wrong(text, "de")), text)
        for text in ("Il manifesto non dice nulla.", "nessuno ha detto perché", "come promesso", "ciò che toglierebbe", "passate escluse", "non certo"):
            self.assertTrue(list(wrong(text, "it")), text)
        self.assertEqual([], list(wrong("Die Aussage ist vorausgesagt.", "de")))
        self.assertEqual([], list(wrong("Da un certo istante tutto è spostato.", "it")))
        self.assertTrue(list(wrong("Le letture sono derivate", "it")))
        self.assertEqual(["a stands b"], literals('f("a stands "\n  "b");  // beside it\n'))
        self.assertEqual([], list(wrong("The number stands for the axis.")))

    def test_a_planted_comment_is_found(self):
        for path, text in (("a.h", "int a;  ///< GONE\n"), ("a.cpp", "f();\n// GONE\n"), ("a.js", "f();  // GONE"),
                           ("a.js", "f(\n/* GONE */);"), ("a.css", "p { /* GONE */ }"), ("a.py", "def f():\n    '''GONE'''\n"),
                           ("a.py", "f()  # GONE\n"), ("a.sh", "f  # GONE"), ("a", "#!/bin/sh\n# GONE"),
                           ("CMakeLists.txt", "f()  # GONE"), ("a.cpp.in", "f();  // GONE")):
            mark = next((m for m in ("///<", "//", "#") if m + " GONE" in text), "")
            for gap in (" ", f"\n  {mark[:3]} "):
                planted = text.replace("'''", '"' * 3).replace("GONE", f"it is{gap}gone")
                found = [(line, phrase) for line, comment in comments(path, planted) for phrase, _ in wrong(comment)]
                self.assertEqual([(text[:text.index("GONE")].count("\n") + 1, "is gone")], found, planted)
        for path, text in (("a.cpp", 'f("https://is.gone");\n#include "is gone"'), ("a.py", "f('is gone')\n"),
                           ("a.py", "TOML = '''\n# is gone\n'''\n"), ("a.css", "p:is(.gone) {}")):
            self.assertEqual([], list(comments(path, text)), text)

    def test_terms_are_unique_and_forbid_no_term(self):
        for key in ("id", "en"):
            names = [term[key] for term in TERM]
            self.assertEqual([], sorted({name for name in names if names.count(name) > 1}))
        self.assertEqual([], [term["id"] for term in TERM if list(wrong(term["en"]))])
        self.assertEqual([], [term["id"] for term in TERM for code in ("de", "it") if list(wrong(term.get(code, ""), code))])

    def test_the_glossary_is_generated(self):
        done = subprocess.run([sys.executable, "-B", ROOT / "scripts" / "generate-docs", "--check"], capture_output=True, text=True)
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)

    def test_templates(self):
        found = [f"{language}/{place}: {phrase!r} in {text!r}; write {write}" for language in RULES
                 for place, text in words(language) for phrase, write in wrong(text, language)]
        self.assertEqual("", "\n".join(found))

    def test_literals(self):
        found = [f"{path}: {phrase!r} in {literal!r}; write {write}" for path, text in sources("engine", "plugins", "reports")
                 if path.endswith((".h", ".cpp")) for literal in literals(text) for phrase, write in wrong(literal)]
        self.assertEqual("", "\n".join(found))

    def test_pages(self):
        pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("**/*.md")),
                 *sorted((ROOT / "samples").rglob("README.md")), *sorted((ROOT / "plugins").rglob("README.md"))]
        found = [f"{page.relative_to(ROOT)}: {phrase!r}; write {write}" for page in pages
                 for line in prose(page.read_text(encoding="utf-8")).split("\n") for phrase, write in wrong(line)]
        self.assertEqual("", "\n".join(found))

    def test_comments(self):
        folders = ("engine", "plugins", "reports", "templates", "tests", "bench", "samples", "scripts", "cmake")
        found = [f"{path}:{line}: {phrase!r}; write {write}" for path, text in sources(*folders)
                 for line, comment in comments(path, text) for phrase, write in wrong(comment)]
        self.assertEqual("", "\n".join(found))


if __name__ == "__main__":
    unittest.main()
