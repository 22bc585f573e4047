#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a copy of a source that holds all its mutants: make_mutants.py MUTANTS.toml SOURCE COPY

NONIO_MUTANT in the environment says which one is alive (FILE.NAME, FILE of MUTANTS.toml); without it the copy does what the source does. `change` is a
list of [from, to]: each place of the text `from` becomes a choice between both expressions; `statement` the same for
statements; `insert` puts the statement `to` behind `from`. A mutant with `source` is of that file only."""
import pathlib
import sys
import tomllib

HEAD = """#ifndef NONIO_MUTANTS
#define NONIO_MUTANTS
#include <cstdlib>
#include <cstring>
namespace {
bool alive(const char* mutant) {
  static const char* const name = std::getenv("NONIO_MUTANT");
  return name != nullptr && std::strcmp(name, mutant) == 0;
}
}  // namespace
#endif
"""


def main():
    declared, source, copy = map(pathlib.Path, sys.argv[1:])
    text = source.read_text()
    for name, mutant in tomllib.loads(declared.read_text())["mutant"].items():
        if mutant.get("source", source.name) != source.name:
            continue
        for kind, form in (("change", '(alive("{name}") ? ({new}) : ({old}))'),
                           ("statement", 'if (alive("{name}")) {{ {new}; }} else {{ {old}; }}'),
                           ("insert", '{old} if (alive("{name}")) {{ {new}; }}')):
            for old, new in mutant.get(kind, []):
                if old not in text:
                    sys.exit(f"{declared}: mutant {name}: expected \"{old}\" in {source}, not found; it needs the new text")
                text = text.replace(old, form.format(name=f"{declared.stem}.{name}", old=old, new=new))
    copy.write_text(HEAD + text)


if __name__ == "__main__":
    main()
