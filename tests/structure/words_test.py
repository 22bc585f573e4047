# SPDX-License-Identifier: Apache-2.0
"""Texts for people use the terms of docs/terms.toml: no forbidden synonym and no private phrase in templates/words, in
literals and comments of engine, plugins and reports (among them all texts of --help), in README.md, CONTRIBUTING.md and
the pages for users and developers. The glossary is the one that the terms make.

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
    if language == "en":
        found += [(re.compile(p["pattern"], re.I), re.compile(p["except"], re.I) if "except" in p else None, p["write"])
                  for p in TERMS["phrase"]]
    return found


def wrong(text, language="en"):
    """(phrase, words to write) of each phrase that the text may not have."""
    for pattern, exception, write in RULES[language]:
        for match in pattern.finditer(text):
            if not (exception and exception.search(text[max(0, match.start() - 30):match.end() + 30])):
                yield match[0], write


RULES = {language: rules(language) for language in ("en", "de", "it")}
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')


def words(language):
    """(place, text) of each value of templates/words."""
    def texts(table):
        for value in table.values():
            yield from texts(value) if isinstance(value, dict) else [str(value)]
    for path in sorted((ROOT / "templates" / "words" / language).glob("*.toml")):
        for text in texts(tomllib.loads(path.read_text(encoding="utf-8"))):
            yield path.name, re.sub(r"\{\w+\}", "{}", text)


def sources():
    for folder in ("engine", "plugins", "reports"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                yield path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")


def split(text):
    """(literals that people read, comments); literals in succession are one, a name without a blank is none."""
    comments = " ".join(re.findall(r"(?:^|\s)//+(.*)$", text, re.M))
    code = re.sub(r"^\s*(//|#include).*$", "", text, flags=re.M)
    code = re.sub(r"[ \t]//[^\"\n]*$", "", code, flags=re.M)
    code = re.sub(r'"\s*\n\s*"', "", code)
    return [literal for literal in LITERAL.findall(code) if " " in literal.strip()], comments


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
        self.assertTrue(list(wrong("Le letture sono derivate", "it")))
        self.assertEqual([(["a stands b"], " beside it")], [split('f("a stands "\n  "b");  // beside it\n')])
        self.assertEqual([], list(wrong("The number stands for the axis.")))

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
        found = [f"{path}: {phrase!r} in {literal!r}; write {write}" for path, text in sources()
                 for literal in split(text)[0] for phrase, write in wrong(literal)]
        self.assertEqual("", "\n".join(found))

    def test_pages(self):
        pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("**/*.md")),
                 ROOT / "samples" / "README.md", *sorted((ROOT / "plugins").rglob("README.md"))]
        found = [f"{page.relative_to(ROOT)}: {phrase!r}; write {write}" for page in pages
                 for line in prose(page.read_text(encoding="utf-8")).split("\n") for phrase, write in wrong(line)]
        self.assertEqual("", "\n".join(found))

    def test_comments(self):
        found = [f"{path}: {phrase!r}; write {write}" for path, text in sources() for phrase, write in wrong(split(text)[1])]
        self.assertEqual("", "\n".join(found))


if __name__ == "__main__":
    unittest.main()
