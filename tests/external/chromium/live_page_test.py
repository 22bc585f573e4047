# SPDX-License-Identifier: Apache-2.0
"""live_page_test.py NONIO SOURCE_FOLDER: the page of `nonio serve` in a real browser, with the real server: the tutorial by
mouse and by keys, undo, reload, two tabs, hostile names, a file edited by another program, a server that ends, widths, dark
colours, motion and accessibility. Pictures and numbers have a test of their own (live_pictures_test.py).

Waits for states, never sleeps. On failure the screenshot and the browser's log are kept in the test's folder. With
NONIO_PICTURES=FOLDER the three pictures of README.md are written there."""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tomllib

import live_browser
from live_browser import ActionChains, By, Keys, NONIO, SOURCE, TUTORIAL, said
from hindrances import HINDRANCES

ENGLISH = tomllib.loads((SOURCE / "templates/words/en/workbench.toml").read_text())


class Page(live_browser.CampaignPage):
    # ---- the loop ----
    def test_the_tutorial_by_mouse_only(self):
        folder = self.campaign()
        self.open(self.serve(folder, "--edit"))
        self.assertIn("zero-drift:X", self.verdict("missing"))
        for place, unit in ((0, "rms_um"),):
            self.assertAlmostEqual(said("compare", folder)["parts"][place][unit], self.rms(), 9)
        self.assertEqual(["scale:X", "backlash:X"], self.ticks("effects.model"))
        self.picture("1-start")
        self.tick("zero-drift:X")
        self.assertIn("periodic:X", self.verdict("missing"))
        self.assertIn("pitch-curve:X", self.verdict("missing"), "what these readings cannot separate is told")
        self.picture("2-drift")
        self.tick("periodic:X")
        self.verdict("nothing")
        self.assertIn("pitch-curve:X would fit these readings as well as periodic:X", self.text("limits"), "complete does not settle it")
        self.picture("3-complete")
        self.assertEqual(["scale:X", "backlash:X", "zero-drift:X", "periodic:X"], self.ticks("effects.model"))
        self.assertEqual(["scale:X", "backlash:X"], tomllib.loads((folder / "campaign.toml").read_text())["model"]["effects"], "nothing is written before save")
        self.assertIn("nonio model add", self.text("command"))
        self.click("save")
        self.wait(lambda: self.d.find_element(By.ID, "save-write").is_displayed())
        self.assertIn("zero-drift:X", self.d.find_element(By.CSS_SELECTOR, ".diff .plus:last-of-type, .diff").text)
        self.d.find_element(By.ID, "save-why").send_keys("seen in picture 3")
        self.click("save-write")
        self.wait(lambda: not self.js("document.getElementById('dialog').open"))
        self.wait(lambda: not self.d.find_element(By.ID, "save").is_enabled())
        self.assertEqual(["scale:X", "backlash:X", "zero-drift:X", "periodic:X"], tomllib.loads((folder / "campaign.toml").read_text())["model"]["effects"])
        history = [json.loads(line) for line in (folder / "model-history.jsonl").read_text().splitlines()]
        self.assertEqual(["zero-drift:X", "periodic:X"], [line["effect"] for line in history])
        compared = said("compare", folder)["parts"][0]
        self.assertAlmostEqual(compared["rms_um"], self.rms(), 9)
        for parameter in compared["model"]["parameters"]:
            shown = self.js("document.querySelector(`[data-parameter='${arguments[0]}']`).dataset.value", f"{parameter['effect']}.{parameter['name']}")
            self.assertAlmostEqual(parameter["value"], float(shown), 9)
        self.no_complaints()
        self.own_requests_only()

    def picture(self, name):
        if folder := os.environ.get("NONIO_PICTURES"):
            self.size(1280, 720)
            self.js("document.querySelector('main').scrollTo(0, 0)")
            ActionChains(self.d).move_to_element_with_offset(self.d.find_element(By.ID, "campaign"), 0, 0).perform()
            self.wait(lambda: True)
            self.js("document.activeElement.blur()")
            self.d.save_screenshot(f"{folder}/live-{name}.png")
            self.size(1280, 800)

    def test_the_tutorial_by_keys_only(self):
        folder = self.campaign()
        self.open(self.serve(folder, "--edit"))

        def reach(effect):
            """With Tab to the first effect, then with arrows."""
            focused = "(document.activeElement.dataset || {}).effect"
            for _ in range(60):
                if self.js(focused):
                    break
                self.press(Keys.TAB)
            for _ in range(20):
                if self.js(focused) == effect:
                    return
                self.press(Keys.ARROW_DOWN)
            self.fail(f"{effect} is not reached by keys")

        for effect in ("zero-drift:X", "periodic:X"):
            reach(effect)
            self.press(Keys.SPACE)
            self.wait(lambda: effect in self.ticks("effects.model"), effect)
            self.ready()
            self.assertEqual("tick-" + effect, self.js("document.activeElement.dataset.key"), "the focus stays on the effect")
        self.verdict("nothing")
        self.press("s")
        self.wait(lambda: self.js("document.getElementById('dialog').open"))
        for _ in range(6):
            if self.js("document.activeElement.id") == "save-why":
                break
            self.press(Keys.TAB)
        self.press("by keys", Keys.ENTER)
        self.wait(lambda: not self.js("document.getElementById('dialog').open"))
        self.assertEqual(["scale:X", "backlash:X", "zero-drift:X", "periodic:X"], tomllib.loads((folder / "campaign.toml").read_text())["model"]["effects"])
        self.press("z")
        self.wait(lambda: "periodic:X?" in self.ticks())
        self.press("y")
        self.wait(lambda: "periodic:X" in self.ticks())
        self.no_complaints()

    def test_a_reading_is_reached_by_keys_and_left_out_with_a_reason(self):
        self.open(self.serve(self.campaign()))
        before = self.rms()
        self.js("document.querySelector('#picture-2 svg').focus()")
        self.press(Keys.END)
        self.wait(lambda: "x.csv" in self.text("said"))
        self.assertEqual(10, self.js("document.querySelectorAll('.chosen').length - document.querySelectorAll('.effect.chosen').length"), "marked in all pictures that have it")
        self.press(Keys.ENTER)
        self.wait(lambda: self.js("document.getElementById('dialog').open"))
        self.assertIn("x.csv", self.text("dialog"))
        do = self.d.find_element(By.CSS_SELECTOR, "#dialog .exclude-do")
        do.click()
        self.assertTrue(self.js("document.getElementById('dialog').open"), "no reason, no exclusion")
        self.d.find_element(By.CSS_SELECTOR, "#dialog .exclude input").send_keys("beam interrupted")
        do.click()
        self.wait(lambda: "beam interrupted" in self.text("readings-list"))
        self.ready()
        self.wait(lambda: self.rms() != before)
        self.d.find_element(By.CSS_SELECTOR, "#readings-list li button").click()
        self.wait(lambda: "beam interrupted" not in self.text("readings-list") and abs(self.rms() - before) < 1e-9)
        self.no_complaints()

    def test_of_two_readings_that_are_left_out_each_is_the_one_that_was_touched(self):
        self.open(self.serve(self.campaign()))
        for line in (3, 4):
            self.js("document.querySelector('#picture-2 svg').focus()")
            self.press(Keys.HOME, Keys.ENTER)
            self.wait(lambda: self.js("document.getElementById('dialog').open"))
            self.assertIn(f"x.csv:{line}", re.sub(r",? line ", ":", self.text("dialog")))
            self.d.find_element(By.CSS_SELECTOR, "#dialog .exclude input").send_keys("chip", Keys.ENTER)
            self.wait(lambda: f"x.csv:{line} " in self.text("readings-list"))
            self.ready()
        self.assertIn("x.csv:3 ", self.text("readings-list"))
        self.assertEqual(0, self.js("document.querySelectorAll('.big').length"), "few readings are drawn one by one")

    def test_a_region_is_the_same_readings_in_all_pictures(self):
        self.open(self.serve(self.campaign()))
        picture = self.d.find_element(By.CSS_SELECTOR, "#picture-2 svg")
        self.js("arguments[0].scrollIntoView({block: 'center'})", picture)
        wide = picture.size["width"]
        ActionChains(self.d).move_to_element_with_offset(picture, -int(wide * 0.2), -60).click_and_hold().move_by_offset(int(wide * 0.3), 100).release().perform()
        self.wait(lambda: "readings chosen" in self.text("region"))
        n = int(re.search(r"(\d+) of 210", self.text("region"))[1])
        self.assertGreater(n, 20)
        shown = self.js("[0, 2, 3, 4, 5, 6, 7, 8].map((k) => document.querySelector(`#picture-${k} .picked`).getAttribute('d').split('M').length - 1)")
        self.assertEqual([n] * 8, shown)
        self.click("region-clear")
        self.wait(lambda: self.js("document.querySelectorAll('.picked').length") == 0 and self.js("document.querySelector('#region details') !== null"))
        self.js("document.querySelector('#region details').open = true")
        self.d.find_element(By.CSS_SELECTOR, "[data-key=region-from]").send_keys("500")
        self.d.find_element(By.CSS_SELECTOR, "[data-key=region-to]").send_keys("700,5", Keys.ENTER)
        self.wait(lambda: "readings chosen" in self.text("region"))
        self.assertIn("40 of 210", self.text("region"), "four targets lie between, measured ten times each")

    def test_a_place_that_fails_leads_to_its_picture(self):
        self.open(self.serve(self.campaign()))
        places = said("compare", TUTORIAL)["parts"][0]["left"]
        shown = self.js("[...document.querySelectorAll('.place')].map((e) => [e.dataset.where, Number(e.dataset.share)])")
        self.assertEqual([[p["where"], p["share"]] for p in places], shown)
        self.assertIn("82 % of what remains depends on time", self.text("places-list"))
        self.d.find_element(By.CSS_SELECTOR, "[data-where=time]").click()
        self.wait(lambda: self.js("document.activeElement.closest('figure') && document.activeElement.closest('figure').id") == "picture-2")
        self.assertIn("failing", self.js("document.getElementById('picture-2').className"))

    def test_suggest_takes_one_step_and_finish_all_as_explain_auto_does(self):
        folder = self.campaign()
        self.open(self.serve(folder))
        self.click("suggest")
        self.wait(lambda: "zero-drift:X" in self.ticks("effects.model"))
        self.wait(lambda: self.d.find_element(By.ID, "finish").is_enabled())
        self.press("z")
        self.wait(lambda: "zero-drift:X?" in self.ticks())
        self.click("finish")
        self.verdict("nothing")
        self.wait(lambda: self.d.find_element(By.ID, "finish").is_enabled())
        model = self.ticks("effects.model")
        self.assertEqual(3, self.js("document.querySelectorAll('.trail li').length"), "each step is shown")
        self.click("suggest")
        self.wait(lambda: self.text("said") == ENGLISH["job"]["none"], "that there is nothing more is told")
        auto = self.campaign(name="auto")
        said("explain", auto, "--auto")
        self.assertEqual(tomllib.loads((auto / "campaign.toml").read_text())["model"]["effects"], model)

    # ---- state ----
    def test_undo_goto_name_and_reload_keep_the_state(self):
        server = self.serve(self.campaign())
        self.open(server)
        self.tick("zero-drift:X")
        fallen = self.rms()
        name = self.d.find_element(By.ID, "step-name")
        name.send_keys("with drift", Keys.TAB)
        self.wait(lambda: "with drift" in self.text("trail"))
        self.click("undo")
        self.wait(lambda: "zero-drift:X?" in self.ticks())
        self.d.refresh()
        self.ready()
        self.assertIn("zero-drift:X?", self.ticks())
        self.assertIn("with drift", self.text("trail"))
        self.js("[...document.querySelectorAll('.trail button')].pop().click()")
        self.wait(lambda: "zero-drift:X" in self.ticks())
        self.ready()
        self.assertAlmostEqual(fallen, self.rms(), 9)

    def test_two_tabs_show_the_same(self):
        server = self.serve(self.campaign())
        self.open(server)
        first = self.d.current_window_handle
        self.d.switch_to.new_window("tab")
        self.d.get(server.address)
        self.ready()
        self.tick("zero-drift:X")
        self.d.switch_to.window(first)
        self.wait(lambda: "zero-drift:X" in self.ticks())
        self.d.switch_to.window(self.d.window_handles[-1])
        self.d.close()
        self.d.switch_to.window(first)

    def test_a_file_edited_by_another_program_is_reported_and_not_overwritten(self):
        folder = self.campaign()
        self.open(self.serve(folder, "--edit"))
        self.tick("zero-drift:X")
        manifest = folder / "campaign.toml"
        manifest.write_text(manifest.read_text().replace('"scale:X", ', ""))
        self.wait(lambda: "changed on disk" in self.text("alarm"))
        self.js("document.getElementById('save').click()")
        self.wait(lambda: self.d.find_element(By.ID, "save-write").is_displayed())
        self.click("save-write")
        self.wait(lambda: self.js("document.querySelector('#dialog .flag[role=alert]').textContent") != "")
        self.assertEqual(["backlash:X"], tomllib.loads(manifest.read_text())["model"]["effects"])
        self.press(Keys.ESCAPE)
        self.click("reload")
        self.wait(lambda: self.ticks("effects.model") == ["backlash:X"])

    def test_read_only_says_so(self):
        folder = self.campaign()
        self.open(self.serve(folder))
        self.tick("zero-drift:X")
        self.click("save")
        self.wait(lambda: self.js("document.getElementById('dialog').open"))
        self.assertIn("may not write", self.text("dialog"))
        self.assertFalse(self.d.find_element(By.ID, "save-write").is_enabled())

    def test_a_server_that_ends_and_comes_back_is_reported(self):
        folder = self.campaign()
        token = self.folder / "token"
        server = self.serve(folder, "--token-file", str(token))
        port = re.search(r":(\d+)/", server.address)[1]
        self.open(server)
        server.stop(kill=True)
        self.wait(lambda: "No answer from the server" in self.text("alarm"))
        server.command[2:2] = ["--port", port]
        server.start()
        self.wait(lambda: self.js("document.getElementById('alarm').hidden"))
        self.ready()
        self.tick("zero-drift:X")

    def test_without_the_key_of_the_address_the_page_says_what_to_do(self):
        server = self.serve(self.campaign())
        self.d.switch_to.new_window("tab")
        self.d.get(server.address.split("#")[0])
        self.wait(lambda: self.js("document.querySelector('[role=alert]') && document.querySelector('[role=alert]').textContent.includes('#')"))
        self.d.close()

    # ---- for everybody ----
    def test_hostile_names_stay_text(self):
        folder = self.campaign()
        hostile = "<img src=x onerror=window.hacked=1><script>window.hacked=1</script>"
        manifest = folder / "campaign.toml"
        text = manifest.read_text()
        for key in ("maker", "model", "serial"):
            text = re.sub(rf'(?m)^{key} = ".*"', f"{key} = {json.dumps(hostile)}", text, count=1)
        file = "<img src=x onerror=hacked=1>.csv"
        (folder / "x.csv").rename(folder / file)
        manifest.write_text(text.replace('"x.csv"', json.dumps(file)))
        self.open(self.serve(folder))
        self.assertIn(hostile, self.text("machine"))
        self.js("document.querySelector('#readings details').open = true")
        self.assertIn(file, self.text("readings-list"))
        self.assertIsNone(self.js("window.hacked || null"))
        self.assertEqual(0, self.js("document.querySelectorAll('img').length"))
        self.no_complaints()

    def test_widths_zoom_dark_motion_and_hindrances(self):
        self.open(self.serve(self.campaign()))
        self.js("document.querySelectorAll('details').forEach((d) => d.open = true)")
        for width, scale in ((320, 1), (420, 1), (640, 2), (1280, 1), (1920, 1)):
            self.size(width, 800, scale)
            self.wait(lambda: self.js("innerWidth") == width)
            self.wait(lambda: self.js("document.documentElement.scrollWidth") <= width, f"{width} px")
        for scheme in ("light", "dark"):
            self.media(prefers_color_scheme=scheme)
            for width in (1280, 420):
                self.size(width)
                self.wait(lambda: self.js("(() => { const s = document.querySelector('#picture-0 svg'); return Math.abs(s.viewBox.baseVal.width - s.clientWidth); })()") < 2)
                self.assertEqual([], self.js(HINDRANCES), f"{scheme} {width}")
        small = self.js("[...document.querySelectorAll('button, input, select, summary')].filter((e) => e.getClientRects().length && "
                        "(e.type === 'checkbox' || e.type === 'radio' ? e.closest('label') : e).getBoundingClientRect().height < 24).map((e) => e.outerHTML.slice(0, 90))")
        self.assertEqual([], small, "targets of 24 px")
        self.media(prefers_reduced_motion="reduce")
        self.assertEqual("0s", self.js("getComputedStyle(document.querySelector('.value')).transitionDuration"))
        self.d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        self.assertEqual("none", self.js("getComputedStyle(document.querySelector('footer')).display"))

    def test_learning_hides_what_is_known_and_says_when_it_is_right(self):
        self.open(self.serve(self.campaign()))
        self.click("learn")
        self.wait(lambda: "Something is missing" in self.text("learn-says"))
        self.assertNotIn("zero-drift", self.text("verdict") + self.text("places-list") + self.text("next-what"))
        self.assertEqual([], self.ticks("effects.help"))
        self.tick("backlash-slope:X")
        self.wait(lambda: "hardly helps" in self.text("learn-says"))
        self.click("undo")
        self.wait(lambda: "backlash-slope:X?" in self.ticks())
        self.ready()
        self.tick("zero-drift:X")
        self.wait(lambda: "Good" in self.text("learn-says"))
        self.tick("periodic:X")
        self.wait(lambda: "Right" in self.text("learn-says"))
        self.click("learn")

    # ---- what leaves the page ----
    def test_this_page_the_pdf_and_the_command_are_those_of_the_trial(self):
        downloads = self.folder / "downloads"
        downloads.mkdir()
        self.d.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(downloads)})
        folder = self.campaign()
        self.open(self.serve(folder))
        self.tick("zero-drift:X")
        self.click("page")
        kept = downloads / "model-X.html"
        self.wait(kept.exists, "the page is kept")
        data = json.loads(kept.read_text().split('id="data">')[1].split("</script>")[0])
        self.assertEqual(["scale:X", "backlash:X", "zero-drift:X"], [e["name"] for e in data["effects"]], "the model of the trial, not of the file")
        self.assertAlmostEqual(self.rms(), sum(r * r for r in data["residual"]) ** 0.5 / len(data["residual"]) ** 0.5, 3)
        self.click("report")
        report = downloads / f"{said('compare', folder)['campaign']}.pdf"
        self.wait(report.exists, "the PDF is kept")
        self.assertEqual(b"%PDF-", report.read_bytes()[:5])
        self.assertIn(b"%%EOF", report.read_bytes()[-10:])
        origin = self.js("location.origin")
        self.d.execute_cdp_cmd("Browser.grantPermissions", {"origin": origin, "permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"]})
        self.click("command-label")
        self.click("copy")
        command = self.text("command")
        self.assertEqual("nonio model add missing-effect zero-drift:X", command)
        self.wait(lambda: self.d.execute_async_script("navigator.clipboard.readText().then(arguments[0])") == command, "the command is in the clipboard")
        done = subprocess.run([str(NONIO), *command.split()[1:]], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(0, done.returncode, done.stderr)
        self.assertAlmostEqual(self.rms(), said("compare", folder)["parts"][0]["rms_um"], 9)
        self.no_complaints()

    def test_a_period_is_set_and_reported(self):
        folder = self.campaign()
        self.open(self.serve(folder))
        value = "document.getElementById('period-value')"
        was = self.js(value + ".value")
        box = self.d.find_element(By.ID, "period-value")
        box.clear()
        box.send_keys("nothing", Keys.ENTER)
        self.wait(lambda: self.text("alarm") != "", "what is no length is refused with words")
        self.d.find_element(By.ID, "period-value").clear()
        self.d.find_element(By.ID, "period-value").send_keys("12")
        version = self.js("document.body.dataset.version")
        self.js("document.querySelector(`input[data-effect='zero-drift:X']`).click()")
        self.wait(lambda: self.js("document.body.dataset.version") != version and "zero-drift:X" in self.ticks("effects.model"))
        self.ready()
        self.assertEqual("12", self.js(value + ".value"), "what is typed stays while the page is drawn")
        self.d.find_element(By.ID, "period-value").send_keys(Keys.ENTER)
        self.wait(lambda: "nonio model period" in self.text("command"), "the command has it")
        self.assertIn("X 12", self.text("command"))
        self.ready()
        self.click("undo")
        self.wait(lambda: "period" not in self.text("command"))
        self.wait(lambda: self.js(value + ".value") == was)
        self.no_complaints()

    def test_one_run_more_is_what_explain_says(self):
        folder = self.campaign()
        self.open(self.serve(folder))
        foreseen = said("explain", folder, "--what-if")["what_if"]
        rows = self.js("[...document.querySelectorAll('#what-if tbody tr')].map((r) => [...r.children].map((c) => c.textContent))")
        self.assertEqual(2 + len(foreseen[0]["evidence"]), len(rows))
        for row, name in ((rows[0], "scale:X"), (rows[2], foreseen[0]["evidence"][0]["effect"])):
            self.assertIn(name, row[0])
        u = said("compare", folder)["parts"][0]["model"]["parameters"][0]["u"]
        for k, one in enumerate(foreseen):
            self.assertLess(abs(float(rows[0][2 + k]) / (2 * u * one["parameters"][0]["factor"]) - 1), 0.006)
            self.assertLess(abs(float(rows[2][2 + k]) / one["evidence"][0]["then"] - 1), 0.006)
        self.assertIn("--what-if", self.text("what-if"))

    def test_a_table_off_and_on_is_what_compare_says(self):
        folder = self.campaign()
        self.open(self.serve(folder))
        predicted = said("compare", folder)["parts"][0]["after_table"]
        self.assertEqual(["scale:X", "backlash:X"], predicted["takes"])
        drawn = lambda: self.js("document.querySelector('#picture-0 svg').innerHTML")
        choose = lambda what: self.d.find_element(By.CSS_SELECTOR, f"input[name=drawn][value={what}]").click()
        choose("deviation")
        off = drawn()
        choose("table")
        self.wait(lambda: drawn() != off, "the pictures are those after the table")
        cells = self.js("[...document.querySelectorAll('#after-table tbody tr')].map((r) => [r.children[0].textContent, ...[...r.children].slice(1).map((c) => Number(c.dataset.value))])")
        test = predicted["tests"][0]
        self.assertEqual([[n, test["before"][n + "_um"], test["after"][n + "_um"]] for n in "EAR"] + [["RMS", predicted["rms_before_um"], predicted["rms_um"]]], cells)
        self.assertIn("nonio model compare " + folder.name, self.text("after-table"))
        self.tick("scale:X")
        self.wait(lambda: "backlash:X" in self.text("after-table") and "scale:X as" not in self.text("after-table").replace("scale:X, ", ""))
        self.assertIn("&& nonio model compare " + folder.name, self.text("after-table"), "what a terminal has to do first")
        self.tick("backlash:X")
        self.wait(lambda: "No effect of this model" in self.text("after-table"))
        self.no_complaints()

    def test_a_campaign_that_effects_do_not_explain_says_what_it_has(self):
        self.open(self.serve(self.campaign(SOURCE / "samples/site/43-spindle")), "none")
        self.assertIn("Measured here: spindle", self.text("verdict"))
        self.assertFalse(self.d.find_element(By.ID, "suggest").is_displayed())
        self.assertTrue(self.d.find_element(By.ID, "report").is_displayed())
        self.no_complaints()

    def test_messages_for_people_are_in_their_language(self):
        for language, apart, again in (("de", "können nicht unterscheiden", "schon im Modell"), ("it", "non distinguono", "già nel modello")):
            site = self.folder / language
            site.mkdir()
            (site / "site.toml").write_text(f'language = "{language}"\n')
            shutil.copytree(TUTORIAL, site / "one")
            server = self.serve(site / "one")
            self.open(server)
            self.js("net.ask('/api/model', {body: {add: 'scale:X'}}).catch((e) => window.told = e.message)")
            self.wait(lambda: self.js("window.told"))
            self.assertIn(again, self.js("window.told"))
            self.assertNotIn("English", self.js("window.told"))
            self.assertIn(apart, self.js("net.program('not separable with these readings: scale:X a, warm-up:X g')"))
            self.assertIn("13", self.js("net.program('5 readings cannot determine 13 unknowns')"))
            self.assertIn("no such sentence", self.js("net.program('no such sentence')"))

    def test_a_plugin_that_is_killed_during_a_fit_costs_that_fit(self):
        if "NONIO_LIVE_PLUGINS" not in os.environ:
            self.skipTest("needs NONIO_LIVE_PLUGINS")
        server = self.serve(self.campaign(), "--plugin-path", os.environ["NONIO_LIVE_PLUGINS"] + "/hangs")

        def below(pid):
            found = set()
            for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
                try:
                    parent = int(stat.read_text().rsplit(")", 1)[1].split()[1])
                except OSError:
                    continue
                if parent == pid:
                    found |= {int(stat.parent.name)} | below(int(stat.parent.name))
            return found
        self.open(server, "fitted")
        before, rms = below(server.process.pid), self.rms()
        self.wait(lambda: "hanging:X?" in self.ticks())
        self.js("document.querySelector(`input[data-effect='hanging:X']`).click()")
        self.wait(lambda: "hanging:X" in self.ticks("effects.model"))
        self.wait(lambda: below(server.process.pid) - before, "a process fits")

        def killed():
            for pid in below(server.process.pid) - before:
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            return "A plugin crashed while it calculated" in self.text("app")
        self.wait(killed, "the page says what happened")
        self.js("document.querySelector(`input[data-effect='hanging:X']`).click()")
        self.wait(lambda: "hanging:X?" in self.ticks())
        self.ready("fitted")
        self.assertAlmostEqual(rms, self.rms(), 9)
        self.assertNotIn("plugin crashed", self.text("app"))


if __name__ == "__main__":
    live_browser.main()
