# SPDX-License-Identifier: Apache-2.0
"""axe_test.py NONIO SOURCE_FOLDER: axe-core, the checker of others, on every page that people see, in all languages, light and
dark, wide, at 200 % zoom and 320 px wide. Debian has no axe-core and the project holds none: NONIO_AXE=FILE names an axe.min.js (`npm pack axe-core`); without it
the test is skipped. hindrances.py holds what a program can judge every time."""
import os
import pathlib
import shutil
import sys
import urllib.parse

import live_browser
from live_browser import SOURCE
from live_site_test import DATE, MACHINES, nonio

live_browser.PATIENCE = 120  # it is run by hand, on a machine that also does other work
AXE = os.environ.get("NONIO_AXE", "")
LANGUAGES = ("en", "de", "it")
# Width, height, scale: a PC; the same at 200 %; as narrow as WCAG 1.4.10 asks.
SIZES = ((1280, 800, 1), (640, 400, 2), (320, 640, 1))
RUN = """const done = arguments[arguments.length - 1];
axe.run(document, {resultTypes: ["violations"], rules: {"target-size": {enabled: true}}}).then((r) => done(r.violations.flatMap((v) => v.nodes.map((n) =>
  `${v.id} (${v.impact}): ${n.target.join(" ")}: ${n.any.concat(n.all, n.none).map((c) => c.message).join("; ")}`))), (e) => done([String(e)]));"""


class Axe(live_browser.LivePage):
    maxDiff = None
    judged = 0  # page, language, colour scheme and size with nothing wrong

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.axe = pathlib.Path(AXE).read_text()
        cls.d.set_script_timeout(300)  # a busy machine judges slowly

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        print(f"nothing is wrong with {cls.judged} views of a page", flush=True)

    def judge(self, where, language):
        """What is wrong with the page in its present state, in both colour schemes and each size."""
        self.d.execute_script(self.axe)  # by the driver: the page's own policy lets nothing in
        for scheme in ("light", "dark"):
            self.media(prefers_color_scheme=scheme)
            self.wait(lambda: self.js("matchMedia('(prefers-color-scheme: ' + arguments[0] + ')').matches", scheme))
            for width, height, scale in SIZES:
                self.size(width, height, scale)
                self.wait(lambda: self.js("innerWidth") == width)
                # Values are pale while they are computed anew.
                self.wait(lambda: self.js("document.querySelector('#now.old, #effects-list.old') === null"))
                with self.subTest(f"{where} {language} {scheme} {width} px"):
                    self.assertEqual("", "\n".join(self.d.execute_async_script(RUN)))
                    self.assertEqual(language, self.js("document.documentElement.lang"))
                    self.assertLessEqual(self.js("document.documentElement.scrollWidth"), width, "sideways scrolling")
                    Axe.judged += 1
        self.size(*SIZES[0])
        self.seen = getattr(self, "seen", 0) + 2

    def open(self, server, hash_=""):
        self.d.get("about:blank")
        self.d.get(server.address + hash_)

    def ready(self, state):
        self.wait(lambda: self.js("document.body.dataset.ready") == state, state)

    def in_language(self, folder, language):
        site = folder / "site.toml"
        site.write_text(f'language = "{language}"\n' + (site.read_text() if site.exists() else ""))
        return folder

    def test_it_finds_what_is_wrong(self):
        """Or it would have judged nothing."""
        page = self.folder / "bad.html"
        page.write_text("<!doctype html><title>x</title><main><h1>x</h1><img src='x'><p style='color:#aaa'>grey</p></main>")
        self.d.get(page.as_uri())
        self.d.execute_script(self.axe)
        found = {line.split(" ")[0] for line in self.d.execute_async_script(RUN)}
        self.assertLessEqual({"html-has-lang", "image-alt", "color-contrast"}, found)

    def test_the_page_of_a_campaign(self):
        for language in LANGUAGES:
            site = self.folder / language
            shutil.copytree(SOURCE / "samples/tutorial/site", site)
            shutil.copytree(SOURCE / "samples/site/13-gantry-diagonals", site / "gantry")
            self.in_language(site, language)
            for name in ("missing-effect", "gantry"):
                server = self.serve(site / name, "--edit")
                self.open(server)
                self.ready("explained")
                self.js("document.querySelectorAll('details').forEach((d) => d.open = true)")
                self.d.execute_script("document.querySelector('input[name=drawn][value=table]').click()")
                self.judge(name, language)
                self.d.execute_script("document.getElementById('finish').click()")
                self.wait(lambda: self.d.find_element("id", "save").is_enabled(), "steps are done")
                self.ready("explained")
                # Values of the last model are dimmed until those of the new one are there.
                self.wait(lambda: not self.js("document.querySelectorAll('.old').length"), "the values are new")
                self.judge(f"{name} finished", language)
                self.click("save")
                self.wait(lambda: self.js("document.getElementById('dialog').open"))
                self.judge(f"{name} dialog of saving", language)
                server.stop()
        self.assertEqual(2 * 2 * 3 * len(LANGUAGES), self.seen)

    def laboratory(self, language):
        site = self.folder / language / "lab"
        shutil.copytree(SOURCE / "samples/laboratory", site, ignore=lambda folder, names: [
            n for n in names if n.startswith("LAB-") and n not in MACHINES] if folder.endswith("laboratory") else [])
        shutil.copytree(SOURCE / "samples/tutorial/site/missing-effect", site / "missing-effect")
        manifest = site / "missing-effect/campaign.toml"
        manifest.write_text(manifest.read_text() + f'\n[run]\nanalyses = ["iso230-2", "model-fit"]\noutputs = ["model-html"]\n[options.model-html]\nlanguage = "{language}"\n')
        self.in_language(site, language)
        nonio("run", site, "--out", site.parent / "out", "--quiet", "--date", DATE)
        return site, site.parent / "out"

    def test_the_pages_of_a_site_kept_and_served(self):
        kinds = 0
        for language in LANGUAGES:
            site, out = self.laboratory(language)
            pages = ["index.html", "due.html", "instruments.html", "compare.html", "machines/LAB-04.html"]
            served = ["campaigns", "machines", "instruments", "settings", "entries", "certificates"]
            models = sorted(str(p.relative_to(out)) for p in out.rglob("*.html") if str(p.relative_to(out)) not in pages and p.parent.name != "machines")
            kinds = len(models)
            for name in (*pages, *models):
                self.d.get((out / name).as_uri())
                self.js("document.querySelectorAll('details').forEach((d) => d.open = true)")
                self.judge(name, language)
            server = self.serve(site, "--out", str(out), "--edit")
            self.open(server)
            self.ready("index.html")
            for name in (*pages, *served):
                self.d.execute_script("location.hash = arguments[0]", "" if name == "index.html" else "#to=" + urllib.parse.quote(name, safe=""))
                self.ready(name)
                self.js("document.querySelectorAll('details').forEach((d) => d.open = true)")
                self.judge(f"{name} served", language)
        self.assertGreater(kinds, 0, "pages of a model")
        self.assertEqual(2 * len(LANGUAGES) * (2 * len(pages) + kinds + len(served)), self.seen)


if __name__ == "__main__":
    if not AXE:
        print("skipped: NONIO_AXE names no axe.min.js (npm pack axe-core)")
        sys.exit(live_browser.SKIPPED)
    live_browser.main()
