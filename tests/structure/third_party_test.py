# SPDX-License-Identifier: Apache-2.0
"""third_party contains exactly the files that its README lists with their digests; the licence of each is in the package's
copyright file and in docs/dev/architecture.md, and Nonio embeds its bytes unchanged.

third_party_test.py SOURCE_FOLDER BUILD_FOLDER"""
import hashlib
import pathlib
import re
import sys
import unittest

BUILD = pathlib.Path(sys.argv.pop(2))
ROOT = pathlib.Path(sys.argv.pop(1))


def said(folder):
    rows = re.findall(r"^\| (\S+) \| `([0-9a-f]{64})` \|$", (folder / "README.md").read_text(), re.M)
    return dict(rows)


def found(folder):
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in folder.iterdir() if p.name != "README.md"}


class ThirdParty(unittest.TestCase):
    folders = sorted(p for p in (ROOT / "third_party").iterdir())

    def test_files_are_those_of_the_readme(self):
        self.assertTrue(self.folders)
        for folder in self.folders:
            self.assertEqual(said(folder), found(folder), folder.name)
            self.assertIn("LICENSE", found(folder))

    def test_the_package_and_the_documents_name_them(self):
        for folder in self.folders:
            name = (folder / "README.md").read_text().splitlines()[0].split()[1]
            for text in ("cmake/package/copyright", "docs/dev/architecture.md"):
                self.assertIn(name, (ROOT / text).read_text(), f"{text} names {name}")

    def test_they_are_embedded_unchanged(self):
        for built, origin in (("uplot.js", "uPlot.iife.min.js"), ("uplot.css", "uPlot.min.css")):
            self.assertEqual((ROOT / "third_party/uplot" / origin).read_bytes(),
                             (BUILD / "reports/workbench" / built).read_bytes(), built)


if __name__ == "__main__":
    unittest.main()
