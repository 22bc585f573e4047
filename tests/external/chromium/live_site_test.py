# SPDX-License-Identifier: Apache-2.0
"""live_site_test.py NONIO SOURCE_FOLDER: the page of `nonio serve SITE` in a real browser, with the real server: the worklist as
on the static pages, filters, entries by mouse and by keys, two tabs, read-only, a campaign opened and left, run again and
cancelled, certificates verified and approved, hostile names, a run in progress, a server that ends, widths, dark colours,
motion and accessibility. Waits for states, never sleeps."""
import fcntl
import json
import os
import pathlib
import shutil
import subprocess
import tomllib

import live_browser
from live_browser import By, Keys, NONIO, SOURCE, StaleElementReferenceException
from hindrances import HINDRANCES

DATE = "2026-11-22"
HOSTILE = "<img src=x onerror=window.hacked=1><script>window.hacked=1</script>"
MACHINES = ("LAB-02", "LAB-04", "LAB-11")


def nonio(*arguments):
    return subprocess.run([str(NONIO), *map(str, arguments)], capture_output=True, text=True)


class SitePage(live_browser.LivePage):
    """Each test has a copy of a laboratory after one run."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.laboratory = pathlib.Path(cls.profile.name) / "laboratory"
        site = cls.laboratory / "lab"
        shutil.copytree(SOURCE / "samples/laboratory", site, ignore=lambda folder, names: [
            n for n in names if n.startswith("LAB-") and n not in MACHINES] if folder.endswith("laboratory") else [])
        nonio("run", site, "--out", cls.laboratory / "out", "--quiet", "--date", DATE)

    def setUp(self):
        super().setUp()
        # A site is identified by its folder: a moved one is the same site if its old folder no longer exists.
        self.site, self.out = self.folder / "lab", self.folder / "out"
        shutil.copytree(self.laboratory / "lab", self.site)
        shutil.copytree(self.laboratory / "out", self.out)
        state = self.out / ".nonio/night.json"
        state.write_text(json.dumps({**json.loads(state.read_text()), "site": str(self.site.resolve())}))

    def serve_site(self, *more):
        return self.serve(self.site, "--out", str(self.out), *more)

    def open(self, server, hash_="", ready="index.html"):
        self.d.get("about:blank")
        self.d.get(server.address + hash_)
        self.d.get_log("browser")
        self.ready(ready)

    def ready(self, name):
        self.wait(lambda: self.js("document.body.dataset.ready") == name, f"{name} is shown")

    def go(self, name):
        self.js("document.querySelector('#nav [data-key=\"nav-' + arguments[0] + '\"]').click()", name)
        self.ready(name)

    def morning(self):
        return json.loads(nonio("status", "--actions", self.out, "--site", self.site, "--json").stdout)["lines"]

    def rows(self):
        return self.js("[...document.querySelectorAll('tr[data-line]')].filter((r) => r.getClientRects().length).map((r) => r.dataset.line)")

    def key(self, key):
        return self.js("[...document.querySelectorAll('[data-key]')].find((e) => e.dataset.key === arguments[0]) || null", key)

    def push(self, key):
        self.wait(lambda: self.key(key) is not None, key)
        self.js("arguments[0].scrollIntoView({block: 'center'})", self.key(key))
        self.key(key).click()

    def in_dialog(self):
        self.wait(lambda: self.js("document.getElementById('dialog').open"))

    def dialog_closed(self):
        self.wait(lambda: not self.js("document.getElementById('dialog').open"), "the dialog closes")

    def fill_in(self, **fields):
        for name, text in fields.items():
            box = self.d.find_element(By.CSS_SELECTOR, f"#dialog [name={name}]")
            box.clear()
            box.send_keys(text)

    def first_new(self):
        return next(l for l in self.morning() if l["state"] == "new" and l.get("machine") and l["kind"] in ("out", "changed"))

    def acknowledged(self):
        path = self.site / "acknowledged.toml"
        return tomllib.loads(path.read_text()) if path.exists() else {}

    def known(self, line):
        return self.js("(document.querySelector('tr[data-line=\"' + arguments[0] + '\"]') || {className: ''}).className", line["id"]) == "known"

    # ---- what is shown ----
    def test_it_shows_what_the_static_pages_show(self):
        text = "[...document.querySelectorAll('main td, main th, main p, main li, main h1, main h2, main h3, main dd, main dt, main summary')].map((e) => e.textContent)"
        drawn = "[...document.querySelectorAll('main svg *')].map((e) => e.tagName + ['d', 'points', 'x1', 'y1', 'cx', 'class'].map((a) => e.getAttribute(a)).join(' '))"
        wanted = {}
        for name in ("due.html", "instruments.html", "compare.html", "machines/LAB-04.html", "index.html"):
            self.d.get((self.out / name).as_uri())
            wanted[name] = self.js(text), self.js(drawn)
        server = self.serve_site()
        self.open(server, "&to=due.html", "due.html")
        for name, (texts, pictures) in wanted.items():
            self.d.execute_script("location.hash = arguments[0]", "" if name == "index.html" else "#to=" + name.replace("/", "%2F"))
            self.ready(name)
            self.js("document.querySelectorAll('main .acts, main [aria-labelledby=campaigns-of]').forEach((e) => e.remove())")
            self.assertEqual(texts, self.js(text), name)
            self.assertEqual(pictures, self.js(drawn), name)
            self.assertGreater(len(texts), 1)
        self.open(server)
        self.assertEqual([l["id"] for l in self.morning()], self.rows())
        self.assertIn(DATE, self.text("beside"))
        self.no_complaints()
        self.own_requests_only()

    def test_filters_stay_in_the_address(self):
        server = self.serve_site()
        self.open(server)
        all_rows = self.rows()
        kind = self.js("document.querySelector('tr[data-kind]').dataset.kind")
        self.d.execute_script("const s = document.querySelector('select[name=kind]'); s.value = arguments[0]; s.dispatchEvent(new Event('change', {bubbles: true}));", kind)
        some = self.rows()
        self.assertLess(len(some), len(all_rows))
        self.assertEqual(f"#kind={kind}", self.js("location.hash"))
        self.go("due.html")
        self.go("index.html")
        self.assertEqual(some, self.rows(), "they are kept on the way back")
        self.d.get("about:blank")
        self.d.get(server.address + f"&kind={kind}")
        self.ready("index.html")
        self.assertEqual(some, self.rows(), "an address that was sent shows the same")
        self.assertEqual(f"#kind={kind}", self.js("location.hash"))
        self.no_complaints()

    def test_read_only_shows_nothing_that_cannot_be_done(self):
        self.open(self.serve_site())
        self.assertIn("only shows", self.text("read-only"))
        keys = self.js("[...document.querySelectorAll('main [data-key]')].map((e) => e.dataset.key.split('-')[0])")
        self.assertEqual({"row", "filter", "open"}, set(keys))
        self.go("entries")
        self.assertEqual([], self.js("[...document.querySelectorAll('main button')].map((e) => e.id)"))
        self.go("campaigns")
        self.assertIsNone(self.js("document.getElementById('run-all')"))
        self.assertIsNone(self.key("run-" + self.js("document.querySelector('[data-campaign]').dataset.campaign")))
        self.no_complaints()

    # ---- what people do ----
    def test_by_mouse_only(self):
        self.open(self.serve_site("--edit"))
        line = self.first_new()
        self.push("ack-" + line["id"])
        self.in_dialog()
        self.assertIn(line["machine"], self.text("dialog"))
        self.fill_in(by="B. Sample", why="nut is ordered")
        self.click("dialog-write")
        self.dialog_closed()
        self.wait(lambda: self.known(line), "the line is known")
        entry = self.acknowledged()["acknowledged"][0]
        self.assertEqual((line["id"], line["machine"], "B. Sample (not authenticated)", "nut is ordered"), (entry["finding"], entry["machine"], entry["by"], entry["why"]))
        self.assertIn("nonio machine ack", self.text("command"))
        self.assertEqual([l["id"] for l in self.morning()], self.rows(), "in the order of the terminal")
        self.push("withdraw-" + line["id"])
        self.in_dialog()
        self.assertEqual("B. Sample", self.js("document.getElementById('field-by').value"), "the name is remembered")
        self.click("dialog-write")
        self.dialog_closed()
        self.wait(lambda: not self.known(line), "the line is new again")
        self.assertEqual(1, len(self.acknowledged()["withdrawn"]))
        self.push("event-" + line["id"])
        self.in_dialog()
        self.fill_in(text="tool hit the vice")
        self.d.find_element(By.CSS_SELECTOR, "#field-kind option[value=crash]").click()
        self.click("dialog-write")
        self.dialog_closed()
        events = tomllib.loads((self.site / "events.toml").read_text())["event"]
        self.assertEqual((line["machine"], "crash", "tool hit the vice", "B. Sample (not authenticated)"), tuple(events[-1][k] for k in ("machine", "kind", "text", "by")))
        self.go("entries")
        self.assertIn("tool hit the vice", self.text("main"))
        # The machine, one of its campaigns, and back.
        self.go("index.html")
        self.d.find_element(By.CSS_SELECTOR, "tr[data-line] a[href*=machines]").click()
        self.wait(lambda: self.js("document.body.dataset.ready").startswith("machines/"), "a machine's page")
        self.assertIn("tool hit the vice", self.text("main")) if line["machine"] == self.js("document.querySelector('h1').textContent") else None
        campaign = self.js("document.querySelector('.campaigns [data-campaign]').dataset.campaign")
        self.push("open-" + campaign)
        self.wait(lambda: self.js("document.body.dataset.ready") == "explained", "its workbench")
        self.assertEqual(campaign, self.text("campaign"))
        self.d.find_element(By.ID, "back").click()
        self.ready("index.html")
        self.no_complaints()

    def test_by_keys_only(self):
        self.open(self.serve_site("--edit"))
        line = self.first_new()
        self.press("j")
        for _ in range(40):
            if self.js("(document.activeElement.dataset || {}).line") == line["id"]:
                break
            self.press("j")
        self.assertEqual(line["id"], self.js("document.activeElement.dataset.line"))
        for _ in range(12):
            if self.js("(document.activeElement.dataset || {}).key") == "ack-" + line["id"]:
                break
            self.press(Keys.TAB)
        self.assertEqual("solid", self.js("getComputedStyle(document.activeElement).outlineStyle"))
        self.press(Keys.ENTER)
        self.in_dialog()
        self.assertEqual("field-by", self.js("document.activeElement.id"), "the first field has the focus")
        self.press("B. Sample")
        for _ in range(8):
            if self.js("document.activeElement.id") == "field-why":
                break
            self.press(Keys.TAB)
        self.press("nut is ordered, j and k are letters here", Keys.ENTER)
        self.dialog_closed()
        self.wait(lambda: self.known(line), "the line is known")
        self.wait(lambda: self.js("(document.activeElement.closest('tr[data-line]') || {dataset: {}}).dataset.line") == line["id"], "the focus is where it was, at the line")
        for _ in range(60):
            if self.js("(document.activeElement.dataset || {}).key") == "filter-kind":
                break
            live_browser.ActionChains(self.d).key_down(Keys.SHIFT).send_keys(Keys.TAB).key_up(Keys.SHIFT).perform()
        self.assertEqual("filter-kind", self.js("document.activeElement.dataset.key"))
        before = len(self.rows())
        self.press(Keys.ARROW_DOWN)
        self.wait(lambda: len(self.rows()) < before, "the filter works by keys")
        self.press("j")
        self.press(Keys.ESCAPE)
        self.js("document.querySelector('tr[data-line]:not([hidden])').focus()")
        self.press(Keys.ENTER)
        self.wait(lambda: self.js("document.body.dataset.ready").startswith("machines/"), "Enter opens the machine")
        self.wait(lambda: self.js("document.activeElement.tagName") == "H1", "the focus is where the new page begins")
        self.d.back()
        self.ready("index.html")
        self.no_complaints()

    def test_two_tabs(self):
        server = self.serve_site("--edit")
        self.open(server)
        line = self.first_new()
        first = self.d.current_window_handle
        self.d.switch_to.new_window("tab")
        self.d.get(server.address)
        self.ready("index.html")
        second = self.d.current_window_handle
        self.push("ack-" + line["id"])
        self.in_dialog()
        self.fill_in(by="B. Sample", why="nut is ordered")
        self.click("dialog-write")
        self.dialog_closed()
        self.d.switch_to.window(first)
        self.wait(lambda: self.known(line), "the other tab shows it")
        nonio("machine", "ack", self.site, "--withdraw", "--finding", line["id"], "--machine", line["machine"], "--by", "B. Sample")
        self.wait(lambda: not self.known(line), "what a terminal does is shown too")
        self.d.switch_to.window(second)
        self.wait(lambda: not self.known(line), "in both")
        self.d.close()
        self.d.switch_to.window(first)

    def test_typed_text_is_kept(self):
        self.open(self.serve_site("--edit"))
        line = self.first_new()
        self.push("ack-" + line["id"])
        self.in_dialog()
        self.fill_in(by="B. Sample", why="nut is")
        nonio("machine", "event", self.site, "--machine", line["machine"], "--kind", "other", "--text", "seen on the way", "--date", "2026-01-01")
        version = self.js("document.body.dataset.version")
        self.wait(lambda: self.js("document.body.dataset.version") != version, "the page has heard of it")
        self.assertEqual("nut is", self.js("document.getElementById('field-why').value"))
        self.click("dialog-write")
        self.dialog_closed()
        self.wait(lambda: self.known(line))

    def test_a_refusal_is_said_and_nothing_is_lost(self):
        self.open(self.serve_site("--edit"))
        line = self.first_new()
        (self.site / "acknowledged.toml").write_text("format = 1\n[[acknowledged]]\nmachine = 7\n")
        self.push("ack-" + line["id"])
        self.in_dialog()
        self.fill_in(by="B. Sample", why="nut is ordered")
        self.click("dialog-write")
        self.wait(lambda: "acknowledged.toml" in self.js("document.querySelector('#dialog [role=alert]').textContent"))
        self.assertEqual("nut is ordered", self.js("document.getElementById('field-why').value"))

    def test_one_campaign_is_run_again(self):
        self.open(self.serve_site("--edit"))
        campaign = self.js("document.querySelector('[data-key^=run-]').closest('tr').querySelector('[data-campaign]').dataset.campaign")
        line = self.js("document.querySelector('[data-key^=run-]').closest('tr').dataset.line")
        self.push("run-" + line)
        self.wait(lambda: self.js("document.getElementById('run-end') !== null"), "its end")
        self.assertIn("the same, byte by byte", self.text("run-end"))
        self.assertIn(campaign, self.text("run-end"))
        folder = json.loads((self.out / campaign / "run.json").read_text())["folder"]
        csv = next((self.site / folder).glob("*.csv"))
        csv.write_text(csv.read_text().rstrip("\n") + "9\n")
        self.push("run-" + line)
        self.wait(lambda: "different" in (self.js("(document.getElementById('run-end') || {}).textContent") or ""), "new results")
        self.assertEqual(1, json.loads((self.out / "summary.json").read_text())["night"])
        self.push("run-close")
        self.wait(lambda: self.js("document.getElementById('run-end') === null"))
        self.no_complaints()

    def test_a_run_is_cancelled(self):
        # 24,000 readings a campaign, 25 campaigns: several seconds of work on any computer.
        truth = (SOURCE / "samples/simulate/worn-screw.toml").read_text()
        for before, after in (("step_mm = 58.0", "step_mm = 1.0"), ("runs = 5", "runs = 10"), ("dwell_s = 4.0", "dwell_s = 0.1")):
            self.assertIn(before, truth)
            truth = truth.replace(before, after)
        (self.folder / "truth.toml").write_text(truth)
        nonio("model", "simulate", self.folder / "truth.toml", "--out", self.folder / "long", "--quiet")
        manifest = (self.folder / "long/campaign.toml").read_text()
        self.assertIn('id = "worn-screw"', manifest)
        for n in range(25):
            shutil.copytree(self.folder / "long", self.site / f"more-{n}")
            (self.site / f"more-{n}/campaign.toml").write_text(manifest.replace('id = "worn-screw"', f'id = "more-{n}"'))
        self.open(self.serve_site("--edit"), "&to=campaigns", "campaigns")
        self.assertIn("nav-due.html", self.js("[...document.querySelectorAll('#nav a')].map((a) => a.dataset.key)"))
        self.click("run-all")
        self.wait(lambda: self.js("document.getElementById('run-share') !== null"), "progress")
        self.assertLessEqual(0, self.js("document.getElementById('run-share').value"))

        def cancelled():
            try:  # progress draws the button anew
                self.click("run-cancel")
                return True
            except StaleElementReferenceException:
                return False
        self.wait(cancelled, "the button")
        self.wait(lambda: "cancelled" in (self.js("(document.getElementById('run-end') || {}).textContent") or ""), "cancelled")

    # ---- what happens elsewhere ----
    def test_a_run_goes_on_and_the_server_ends(self):
        server = self.serve_site("--port", "0", "--token-file", str(self.folder / "token"))
        port = server.address.rsplit(":", 1)[1].split("/")[0]
        self.open(server)
        state, text = self.out / ".nonio/night.json", (self.out / ".nonio/night.json").read_text()
        with open(self.out / ".nonio/lock") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            night = json.loads(text)
            state.write_text(json.dumps({**night, "state": "running", "night": 2, "last": night["end"]}))
            self.wait(lambda: "Run 2 is in progress" in self.text("night"))
            self.assertIn(DATE, self.text("night"))
            state.write_text(text)
        self.wait(lambda: self.text("night") == "", "it has ended")
        server.stop(kill=True)
        self.wait(lambda: "No answer" in self.text("alarm"))
        self.assertGreater(len(self.rows()), 0, "what was shown stays")
        server.command = [*server.command[:2], "--out", str(self.out), "--port", port, "--token-file", str(self.folder / "token"), server.command[-1]]
        nonio("machine", "ack", self.site, "--finding", self.first_new()["id"], "--machine", (line := self.first_new())["machine"], "--until", "2099-01-01", "--by", "B", "--why", "nut is ordered")
        server.start()
        self.wait(lambda: self.js("document.getElementById('alarm').hidden"), "it goes on")
        self.wait(lambda: self.known(line), "and shows what came meanwhile")

    # ---- certificates ----
    def test_certificates_are_released_and_verified_in_german(self):
        shutil.rmtree(self.site), shutil.rmtree(self.out)
        shutil.copytree(SOURCE / "samples/certificates", self.site)
        (self.site / "site.toml").write_text('language = "de"\n' + (self.site / "site.toml").read_text())
        subprocess.run([self.site / "make-key.sh"], check=True, capture_output=True)
        nonio("run", self.site, "--out", self.out, "--quiet")
        self.open(self.serve_site("--edit"), "&to=certificates", "certificates")
        form = ".draft[data-campaign=adjusted] form"
        reasons = self.d.find_elements(By.CSS_SELECTOR, form + " [name=reason]")
        self.assertEqual(3, len(reasons))
        drafts = json.loads(nonio("certificate", "approve", self.site, "--list", "--json").stdout)["drafts"]
        asking = [f for d in drafts if d["campaign"] == "adjusted" for f in d["findings"] if f["severity"] == "attention"]
        self.assertEqual([f["said"] for f in asking], self.js(f"[...document.querySelectorAll('{form} label b')].map((b) => b.textContent)"))
        self.assertTrue(all(f["said"] != f["title"] for f in asking), "in the words of the site")
        self.d.find_element(By.CSS_SELECTOR, form + " [name=by]").send_keys("B. Sample")
        for box in reasons:
            box.send_keys("as found")
        self.picture("site-release")
        self.d.find_element(By.CSS_SELECTOR, form + " [type=submit]").click()
        self.wait(lambda: self.js("document.getElementById('released') !== null"), "issued")
        self.assertIn("S-0001", self.text("released"))
        self.wait(lambda: self.js("document.querySelector('.draft') === null"))
        files = [self.out / "adjusted/certificate.pdf", self.out / "adjusted/certificate.xml", self.folder / "forged.pdf", self.folder / "a<b>.txt"]
        files[2].write_bytes(files[0].read_bytes().replace(b"S-0001", b"S-0002"))
        files[3].write_text("nothing")
        self.d.find_element(By.ID, "verify-files").send_keys("\n".join(map(str, files)))
        self.wait(lambda: self.js("[...document.querySelectorAll('#verified > li')].map((e) => e.className.split(' ')[1])") == ["holds", "holds", "fails", "failed"],
                  "each file has its verdict")
        self.assertGreater(self.js("document.querySelectorAll('#verified > li:first-child tbody tr').length"), 10)
        self.assertEqual("false", self.js("String(document.querySelector('#verified > li:first-child details').open)"))
        names = self.js("[...document.querySelectorAll('#verified tbody th')].map((e) => [e.title, e.textContent])")
        own = set(tomllib.loads((SOURCE / "templates/words/de/workbench-site.toml").read_text())["check"].values())
        self.assertEqual([], [(id_, name) for id_, name in names if name.removeprefix("DCC: ") not in own], "each check has its name")
        self.assertIn("DCC: ", {name[:5] for _, name in names})
        self.assertGreater(self.js("document.querySelectorAll('#verified > .fails .check-fails').length"), 0)
        self.assertEqual([], self.js(HINDRANCES))
        self.picture("site-verified")

    # ---- for everybody ----
    def test_hostile_names_stay_text(self):
        """Machines, customers, campaigns, axes: whatever a name says, no script runs."""
        shutil.rmtree(self.out)
        for manifest in self.site.rglob("campaign.toml"):
            text = manifest.read_text()
            folder = manifest.parent
            if folder.name.startswith("LAB-04") or "LAB-04" in str(folder):
                manifest.write_text(text.replace('"LAB-04"', json.dumps(HOSTILE)).replace("LAB-04", "LAB-04"))
        odd = self.site / "<img src=x onerror=hacked=1>"
        shutil.copytree(SOURCE / "samples/site/02-constant-reversal", odd)
        (odd / "campaign.toml").write_text((odd / "campaign.toml").read_text() + "\nwrong = '<script>hacked=1</script>'\n")
        (self.site / "events.toml").write_text(f"format = 1\n[[event]]\ndate = 2026-01-01\nmachine = {json.dumps(HOSTILE)}\nkind = \"crash\"\ntext = {json.dumps(HOSTILE + chr(0x202e))}\n")
        nonio("run", self.site, "--out", self.out, "--quiet", "--date", DATE)
        nonio("machine", "ack", self.site, "--finding", HOSTILE, "--machine", HOSTILE, "--until", "2099-01-01", "--by", HOSTILE, "--why", HOSTILE)
        self.open(self.serve_site("--edit"))
        self.assertIn("<img", self.text("main"))
        names = ["index.html", "due.html", "instruments.html", "compare.html", "campaigns", "machines", "entries", "certificates"]
        names += [str(p.relative_to(self.out)) for p in self.out.glob("machines/*.html")]
        for name in names:
            self.d.execute_script("location.hash = '#to=' + encodeURIComponent(arguments[0])" if name != "index.html" else "location.hash = ''", name)
            self.ready(name)
            self.assertIsNone(self.js("window.hacked || null"), name)
            self.assertEqual(0, self.js("document.querySelectorAll('img, main script, iframe, [onerror]').length"), name)
        self.d.execute_script("location.hash = '#to=entries'")
        self.ready("entries")
        self.assertIn("\\u202e", self.text("main"), "what turns the direction of writing is told by its number")
        self.d.execute_script("location.hash = '#to=../../etc/passwd'")
        self.ready("index.html")
        self.no_complaints()

    def picture(self, name):
        if folder := os.environ.get("NONIO_PICTURES"):
            self.d.save_screenshot(f"{folder}/{name}.png")

    def test_widths_zoom_dark_motion_and_hindrances(self):
        line = self.first_new()
        nonio("machine", "ack", self.site, "--finding", line["id"], "--machine", line["machine"], "--until", "2099-01-01", "--by", "B. Sample", "--why", "nut is ordered")
        self.open(self.serve_site("--edit"))
        for name in ("index.html", "machines/LAB-04.html", "campaigns", "machines", "entries", "certificates", "due.html", "instruments.html", "compare.html"):
            self.d.execute_script("location.hash = arguments[0]", "" if name == "index.html" else "#to=" + name.replace("/", "%2F"))
            self.ready(name)
            self.js("document.querySelectorAll('details').forEach((d) => d.open = true)")
            for width, scale in ((320, 1), (420, 1), (640, 2), (1280, 1), (1920, 1)):
                self.size(width, 800, scale)
                self.wait(lambda: self.js("innerWidth") == width)
                self.wait(lambda: self.js("document.documentElement.scrollWidth") <= width, f"{name} at {width} px")
            for scheme in ("light", "dark"):
                self.media(prefers_color_scheme=scheme)
                for width in (1280, 420):
                    self.size(width)
                    self.wait(lambda: self.js("innerWidth") == width)
                    self.assertEqual([], self.js(HINDRANCES), f"{name} {scheme} {width}")
            small = self.js("[...document.querySelectorAll('button, input, select, summary, nav a')].filter((e) => e.getClientRects().length && e.getBoundingClientRect().height < 24).map((e) => e.outerHTML.slice(0, 90))")
            self.assertEqual([], small, f"{name}: targets of 24 px")
        self.go("index.html")
        self.push("event-" + line["id"])
        self.in_dialog()
        for width in (320, 1280):
            self.size(width, 700)
            self.wait(lambda: self.js("document.documentElement.scrollWidth") <= width, f"dialog at {width} px")
            self.assertEqual([], self.js(HINDRANCES), f"dialog {width}")
        self.media(prefers_reduced_motion="reduce")
        self.assertEqual("0s", self.js("getComputedStyle(document.querySelector('#dialog button')).transitionDuration"))


if __name__ == "__main__":
    live_browser.main()
