# SPDX-License-Identifier: Apache-2.0
"""The pages of the documentation, opened as files: search finds a term and leads to its page, and a block in a list is a
block.

documentation_test.py SOURCE_FOLDER"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from browser import SKIPPED, Browser, program

SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
if program() is None or shutil.which("mkdocs") is None:
    print("skipped: no chromium or no mkdocs")
    sys.exit(SKIPPED)
LINKS = "[...document.querySelectorAll('.md-search-result__link')].map(a => a.href).join(' ')"
TYPE = """(() => { const field = document.querySelector('[data-md-component=search-query]');
  field.focus(); field.value = 'backlash'; field.dispatchEvent(new KeyboardEvent('keyup')); })()"""
LOST = r"[...document.querySelectorAll('p')].filter(p => /```|^(sh|toml|console|csv)\s/.test(p.innerText)).length"


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="nonio-pages-", ignore_cleanup_errors=True)
        cls.addClassCleanup(folder.cleanup)
        cls.site = pathlib.Path(folder.name) / "site"
        subprocess.run(["mkdocs", "build", "--quiet", "--strict", "--site-dir", cls.site], cwd=SOURCE, check=True)
        cls.browser = Browser(program(), pathlib.Path(folder.name) / "profile")
        cls.addClassCleanup(cls.browser.close)

    def test_search_finds_a_term_from_pages_of_every_depth(self):
        for page in ("index.html", "dev/live.html"):
            self.browser.open((self.site / page).as_uri(), 1280)
            self.browser.value(TYPE)
            end = time.monotonic() + 60
            while not self.browser.value(LINKS) and time.monotonic() < end:
                time.sleep(0.2)
            self.assertIn((self.site / "formats.html").as_uri(), self.browser.value(LINKS), page)

    def test_no_block_is_running_text(self):
        pages = sorted(self.site.glob("*.html"))
        self.assertIn("howto-metrologist.html", [page.name for page in pages])
        for page in pages:
            self.browser.open(page.as_uri(), 1280)
            self.assertEqual(0, self.browser.value(LOST), page.name)


if __name__ == "__main__":
    unittest.main()
