# SPDX-License-Identifier: Apache-2.0
"""live_newcomer_test.py NONIO SOURCE_FOLDER: a newcomer at the page of `nonio serve SITE --edit` in a real browser. From an empty
site and a spreadsheet to an approved, verified certificate without a terminal; a table with unknown columns; what is kept and what
is refused; pages at three sizes, without hindrances, file syntax and commands."""
import json
import math
import os
import pathlib
import random
import shutil
import subprocess
import sys
import time
import tomllib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
import sheets
import live_browser
from live_browser import By, NONIO, SOURCE
from hindrances import HINDRANCES

SEED = int(os.environ.get("NONIO_SEED", str(random.SystemRandom().randrange(1 << 32))))
MOST_ACTIONS = 25
STATED = {"machine-maker": "Zayer", "machine-model": "FP 12", "machine-serial": "0417", "campaign-customer": "Officine Rossi", "campaign-customer_address": "Via Uno 1, Torino",
          "campaign-site": "Torino, hall 2", "axis-expansion_um_per_m_K": "11,5", "axis-tolerance-A": "25", "instrument-maker": "Sample Optics", "instrument-model": "L 80",
          "instrument-serial": "L-001", "instrument-calibrated": "2026-02-01", "instrument-certificate": "SO-1", "instrument-U_fixed_um": "0.1", "instrument-U_per_m_um": "0.5",
          "environment-misalignment_mm": "0.5", "environment-temperature_range_K": "0.2", "environment-temperature_difference_K": "0.8",
          "environment-expansion_range_um_per_m_K": "1", "environment-drift_um": "0.6"}
SIZES = ((1280, 720), (1920, 1080), (420, 800))


def readings(seed, names=("run", "direction", "target_mm", "deviation_um", "material_c", "air_c")):
    r = random.Random(seed)
    targets = [round(20 + 46 * i + r.uniform(-4, 4), 3) for i in range(11)]
    return [list(names)] + [[run, way, t, round(0.003 * t + r.gauss(0, 0.25), 3), 20.1, 20.3][:len(names)] for run in range(1, 6) for way in "+-"
                            for t in (targets if way == "+" else targets[::-1])]


class Newcomer(live_browser.LivePage):
    def setUp(self):
        super().setUp()
        print(f"seed {SEED}", flush=True)
        self.size(1280, 720)
        self.site, self.out = self.folder / "site", self.folder / "out"
        shutil.copytree(SOURCE / "samples/certificates", self.site, ignore=lambda _, names: [n for n in names if n == "adjusted"])
        subprocess.run([self.site / "make-key.sh"], check=True, capture_output=True)
        self.actions = 0

    def open(self, *more):
        self.server = self.serve(self.site, "--out", str(self.out), *more)
        self.d.get("about:blank")
        self.d.get(self.server.address)
        self.d.get_log("browser")
        self.ready("campaigns")

    def ready(self, name):
        self.wait(lambda: (self.js("document.body.dataset.ready") or "").startswith(name), f"{name} is shown")

    def go(self, hash_, name=None):
        self.d.execute_script("location.hash = '#to=' + arguments[0]", hash_)
        self.ready(name or hash_)

    # Each of these is one action of a person.
    def drop(self, path):
        self.actions += 1
        self.d.find_element(By.ID, "new-file").send_keys(str(path))

    def state(self, name, text):
        self.actions += 1
        box = self.d.find_element(By.ID, "new-" + name)
        if box.get_attribute("type") == "date":
            self.d.execute_script("arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input', {bubbles: true}))", box, text)
        else:
            box.clear()
            box.send_keys(text)

    def press_on(self, selector):
        self.actions += 1
        box = self.d.find_element(By.CSS_SELECTOR, selector)
        self.js("arguments[0].scrollIntoView({block: 'center'})", box)
        box.click()

    def has(self, selector):
        return self.js("document.querySelector(arguments[0]) !== null", selector)

    def picture(self, name):
        if folder := os.environ.get("NONIO_PICTURES"):
            width = self.js("innerWidth")
            self.size(width, max(720, self.js("document.documentElement.scrollHeight")))
            self.d.save_screenshot(f"{folder}/{name}-{width}.png")

    def looks_right(self, name):
        """At three sizes nothing is wider than the window, nothing hinders, and nothing is written as in a file or on a terminal."""
        for width, height in SIZES:
            self.size(width, height)
            self.wait(lambda: self.js("innerWidth") == width)
            self.wait(lambda: self.js("document.documentElement.scrollWidth") <= width, f"{name} at {width} px")
            self.wait(lambda: self.js("[...document.querySelectorAll('#picture-fit svg')].every((s) => !s.clientWidth || Math.abs(s.viewBox.baseVal.width - s.clientWidth) < 2)"), "the picture is drawn for this width")
            self.assertEqual([], self.js(HINDRANCES), f"{name} at {width} px")
            self.picture(name)
        self.size(1280, 720)
        self.wait(lambda: self.js("innerWidth") == 1280)
        text = self.js("[...document.querySelectorAll('#app > :not(footer)')].map((e) => e.innerText).join(' ')")
        for syntax in ("[[", "nonio ", ".toml", "--edit", "_um", "_mm"):
            self.assertNotIn(syntax, text.replace("FP12_X_20261120.xlsx", ""), name)

    # ---- the day of a newcomer ----
    def test_from_a_spreadsheet_to_a_verified_certificate(self):
        file = self.folder / "FP12_X_20261120.xlsx"
        sheets.xlsx(file, {"Data": readings(SEED)})
        self.open("--edit")
        self.looks_right("empty")
        self.drop(file)
        self.wait(lambda: self.has("#new-plot"), "the curve")
        top = self.js("document.querySelector('#new-plot').getBoundingClientRect()")
        self.assertLess(top["bottom"], 720, "the curve is seen without scrolling, before any form")
        self.assertEqual(110, self.js("[...document.querySelectorAll('#new-plot .marks')].reduce((n, p) => n + p.getAttribute('d').split('M').length - 1, 0)"))
        self.assertEqual(["X", "2026-11-20"], self.js("['new-axis', 'new-campaign-date'].map((id) => document.getElementById(id).value)"), "from the name of the file")
        self.assertIn("Serial number of the instrument", self.text("new-lacks"), "what is missing is named")
        self.looks_right("new")
        for name, text in STATED.items():
            self.state(name, text)
        self.assertNotIn(":", self.text("new-lacks"), "nothing is missing")
        self.press_on("#new-create")
        self.ready("campaign/")
        self.wait(lambda: self.has(".draft form"), "verdict and draft")
        decided = self.js("[...document.querySelectorAll('#decisions tbody tr')].map((r) => r.cells[3].textContent)")
        self.assertEqual((4, 1), (len(decided), sum("conforms" in d for d in decided)), "four values, one of them with a limit")
        numbers = dict(self.js("[...document.querySelectorAll('#decisions tbody tr')].map((r) => [r.cells[0].textContent.split(': ').pop(), r.cells[1].textContent])"))
        self.looks_right("campaign")
        asked = self.d.find_elements(By.CSS_SELECTOR, ".draft form [name=reason]")
        for box in asked:  # readings with unusual noise get findings; each needs a reason
            box.send_keys("as found")
        self.actions += 1
        self.d.find_element(By.CSS_SELECTOR, ".draft form [name=by]").send_keys("B. Sample")
        self.press_on(".draft form [type=submit]")
        self.wait(lambda: self.has("#released-verdict"), "issued and verified")
        self.assertIn("S-0001", self.text("released"))
        self.assertIn("VALID", self.text("released-verdict"))
        self.assertLessEqual(self.actions, MOST_ACTIONS)
        print(f"{self.actions} actions, {len(asked)} reasons", flush=True)
        self.looks_right("issued")
        # Everything is in ordinary files.
        campaign = next(p.parent for p in self.site.glob("*/campaign.toml"))
        self.assertEqual(file.read_bytes(), (campaign / file.name).read_bytes())
        manifest = tomllib.loads((campaign / "campaign.toml").read_text())
        self.assertEqual(("Zayer", "0417", 11.5, {"A": 25}), (manifest["machine"]["maker"], manifest["machine"]["serial"], manifest["machine"]["axes"]["X"]["expansion_um_per_m_K"], manifest["machine"]["axes"]["X"]["tolerance_um"]))
        results = json.loads((self.out / campaign.name / "results.json").read_text())
        values = next(a["values"] for a in results["analyses"] if {"A", "R"} <= a["values"].keys())
        for name, shown in numbers.items():  # the value with its expanded uncertainty, as everywhere
            digits = max(0, 1 - math.floor(math.log10(values[name]["U"])))
            for number, key in zip(shown.split("\u00b1"), ("value", "U"), strict=True):
                self.assertAlmostEqual(values[name][key], float(number.replace("\u2212", "-").split()[0]), delta=0.51 * 10**-digits, msg=f"{name} {key}")
        issued = self.out / campaign.name / "certificate.pdf"
        verified = json.loads(subprocess.run([str(NONIO), "certificate", "verify", "--site", str(self.site), "--json", str(issued)], capture_output=True, text=True).stdout)
        self.assertTrue(verified["holds"])
        # The lists have it, with its documents.
        self.go("campaigns")
        self.wait(lambda: "S-0001" in self.text("campaign-list"), "the certificate is listed")
        self.looks_right("campaigns")
        self.go("machines")
        self.assertIn("Zayer 0417", self.text("main"))
        self.looks_right("machines")
        # The second campaign of this machine and instrument: what is known is offered.
        second = self.folder / "Y_20261122.xlsx"
        sheets.xlsx(second, {"Data": readings(SEED + 1)})
        self.go("new")
        self.drop(second)
        self.wait(lambda: self.has("#new-plot"))
        self.assertEqual(["Y", "L-001", "0.5"], self.js("['new-axis', 'new-instrument-serial', 'new-environment-misalignment_mm'].map((id) => document.getElementById(id).value)"))
        self.d.find_element(By.CSS_SELECTOR, "#new-known-machine option[value='0']").click()
        self.assertEqual(["0417", "Officine Rossi"], self.js("['new-machine-serial', 'new-campaign-customer'].map((id) => document.getElementById(id).value)"))
        self.no_complaints()
        self.own_requests_only()

    def test_columns_are_stated_by_hand_once(self):
        names = ("Lauf", "Richtung", "Soll mm", "Abw um")
        first, later = self.folder / "odd.xlsx", self.folder / "later.xlsx"
        sheets.xlsx(first, {"Messung": [["Halle 2"], *readings(SEED, names)]})
        sheets.xlsx(later, {"Messung": [["Halle 3"], *readings(SEED + 1, names)]})
        self.open("--edit")
        self.drop(first)
        self.wait(lambda: self.has("#new-columns select"), "its columns are shown")
        self.assertFalse(self.has("#new-plot"))
        self.assertEqual(list(names), self.js("[...document.querySelectorAll('#new-columns thead tr:first-child th')].map((e) => e.textContent)"))
        self.looks_right("columns")
        for k, meaning in enumerate(("run", "direction", "target_mm", "deviation_um")):
            self.d.find_element(By.CSS_SELECTOR, f"[data-key=column-{k}] option[value={meaning}]").click()
        self.wait(lambda: self.has("#new-plot"), "read as stated")
        for name in ("machine-maker", "machine-serial"):
            self.state(name, STATED[name])
        self.press_on("#new-create")
        self.ready("campaign/")
        self.wait(lambda: self.has("#missing"), "what a certificate lacks")
        self.assertIn("Serial number of the instrument", self.text("missing"))
        self.looks_right("incomplete")
        manifest = tomllib.loads(next(self.site.glob("*/campaign.toml")).read_text())
        self.assertEqual([f"{n} = {k}" for n, k in zip(names, ("run", "direction", "target_mm", "deviation_um"))], manifest["options"]["spreadsheet"]["columns"])
        self.go("new")
        self.drop(later)
        self.wait(lambda: self.has("#new-plot"), "the next file with these names needs nothing")
        twice = self.folder / "twice.xlsx"
        sheets.xlsx(twice, {"Messung": readings(SEED, ("Lauf", "Richtung", "Wert", "Wert"))})
        self.drop(twice)
        self.wait(lambda: self.has("[data-column='#4']"), "columns with equal names have numbers")
        for k, meaning in enumerate(("run", "direction", "target_mm", "deviation_um")):
            self.d.find_element(By.CSS_SELECTOR, f"[data-key=column-{k}] option[value={meaning}]").click()
        self.wait(lambda: self.has("#new-plot"), "read as stated")
        self.no_complaints()

    def test_a_refusal_keeps_what_was_stated(self):
        file = self.folder / "x.csv"
        file.write_text("\n".join(",".join(map(str, row)) for row in readings(SEED)) + "\n")
        self.open("--edit")
        self.drop(file)
        self.wait(lambda: self.has("#new-plot"))
        self.state("machine-maker", "Zayer")
        self.state("axis-tolerance-A", "twelve")
        self.press_on("#new-create")
        self.wait(lambda: self.text("new-refused") != "", "it is refused")
        self.assertEqual(["Zayer", "twelve"], self.js("['new-machine-maker', 'new-axis-tolerance-A'].map((id) => document.getElementById(id).value)"))
        self.assertEqual("new-axis-tolerance-A", self.js("document.activeElement.id"), "the field is marked")
        self.assertEqual([], list(self.site.glob("*/campaign.toml")))
        (self.folder / "wrong.csv").write_text("run,direction,target_mm,deviation_um\n1,+,0,abc\n")
        self.drop(self.folder / "wrong.csv")
        self.wait(lambda: self.has("#new-unread"), "an unreadable file")
        self.assertIn("2", self.text("new-unread"))
        self.assertFalse(self.has("#new-form"))

    def test_read_only(self):
        shutil.copytree(SOURCE / "samples/certificates/adjusted", self.site / "adjusted")
        self.open()
        self.wait(lambda: self.has("[data-folder=adjusted]"))
        self.assertFalse(self.has("#new"))
        self.assertFalse(self.has("#run-all"))
        self.go("campaign%2Fadjusted", "campaign/adjusted")
        self.assertEqual(["open-adjusted"], self.js("[...document.querySelectorAll('main button')].map((e) => e.dataset.key)"))
        self.looks_right("read-only")

    def test_each_role_sees_what_it_may_do(self):
        shutil.copytree(SOURCE / "samples/certificates/adjusted", self.site / "adjusted")
        (self.site / "users.toml").write_text("format = 1\n" + "".join(f'[[user]]\naccount = "{role}"\nname = "{name}"\nrole = "{role}"\n' for role, name in
                                              (("view", "V. Sample"), ("measure", "M. Sample"), ("approve", "B. Sample"), ("administer", "A. Sample"))))
        subprocess.run([str(NONIO), "run", self.site, "--out", self.out, "--quiet"])
        server = self.serve(self.site, "--out", str(self.out), "--edit", "--host", "nonio.example.org", "--user-header", "X-Remote-User")
        self.d.execute_cdp_cmd("Network.enable", {})
        self.addCleanup(self.d.execute_cdp_cmd, "Network.setExtraHTTPHeaders", {"headers": {}})
        for role, may in (("view", (False, False, False)), ("measure", (True, False, False)), ("approve", (True, True, False)), ("administer", (True, True, True))):
            self.d.execute_cdp_cmd("Network.setExtraHTTPHeaders", {"headers": {"X-Remote-User": role}})
            self.d.get("about:blank")
            self.d.get(server.address + "&to=campaigns")
            self.ready("campaigns")
            self.wait(lambda: self.has("[data-folder=adjusted]"))
            begins = self.has("#new")
            self.go("campaign%2Fadjusted", "campaign/adjusted")
            approves = self.has(".draft form")
            if approves:
                self.assertTrue(self.js("document.querySelector('.draft form [name=by]').readOnly"), "under the own name only")
                self.assertIn("Sample", self.js("document.querySelector('.draft form [name=by]').value"))
            self.go("entries")
            self.assertEqual(may, (begins, approves, self.has("#audit")), role)
            self.assertIn(". Sample", self.text("user"))
            self.looks_right("role-" + role)
        self.d.execute_cdp_cmd("Network.setExtraHTTPHeaders", {"headers": {"X-Remote-User": "else"}})
        self.d.get("about:blank")
        self.d.get(server.address)
        self.wait(lambda: "not a user" in (self.js("(document.getElementById('alarm') || {}).textContent") or ""), "a stranger is told so")

    def test_people_sign_in_and_approve_with_their_password(self):
        password = "the password of a person"
        shutil.copytree(SOURCE / "samples/certificates/adjusted", self.site / "adjusted")
        line = subprocess.run([str(NONIO), "serve", self.site, "--hash-password"], input=password + "\n", capture_output=True, text=True, check=True).stdout
        (self.site / "users.toml").write_text(f'format = 1\n[[user]]\naccount = "sample"\nname = "B. Sample"\nrole = "approve"\n{line}')
        subprocess.run([str(NONIO), "run", self.site, "--out", self.out, "--quiet"])
        server = self.serve(self.site, "--out", str(self.out), "--edit")
        self.d.get("about:blank")
        self.d.get(server.address + "#to=campaign%2Fadjusted")
        self.ready("sign-in")
        self.looks_right("sign-in")
        for given, right in (("a wrong password", False), (password, True)):
            for box, text in (("account", "sample"), ("password", given)):
                self.d.find_element(By.ID, "sign-in-" + box).clear()
                self.d.find_element(By.ID, "sign-in-" + box).send_keys(text)
            self.click("sign-in-go")
            if not right:
                self.wait(lambda: "wrong" in self.js("document.querySelector('#sign-in [role=alert]').textContent"), "it is refused")
                time.sleep(1.1)  # the delay that the next one has to wait for
        self.ready("campaign/adjusted")
        self.wait(lambda: self.has("#fitted[data-ready]"), "the picture")
        bar = self.js("document.querySelector('#fitted-errors').getBoundingClientRect().bottom")
        self.assertLess(bar, 720, "model, remainder and error with its noise floor are seen without scrolling")
        self.assertEqual((2, True), (len(self.d.find_elements(By.CSS_SELECTOR, "#fitted-errors .error-line")), self.has("#fitted-errors .floor-mark")))
        self.assertFalse(self.js("document.cookie.includes('nonio')"), "no script reads the session")
        for box in self.d.find_elements(By.CSS_SELECTOR, ".draft form [name=reason]"):
            box.send_keys("as found")
        self.looks_right("approve")
        self.d.find_element(By.CSS_SELECTOR, ".draft form [name=password]").send_keys(password)
        self.press_on(".draft form [type=submit]")
        self.wait(lambda: self.has("#released-verdict"), "issued and verified")
        self.assertIn("VALID", self.text("released-verdict"))
        for name in ("instruments", "settings"):
            self.go(name)
            self.looks_right(name)
        # A campaign's own page has the session, too.
        self.go("campaign%2Fadjusted", "campaign/adjusted")
        self.press_on("[data-key=open-adjusted]")
        self.wait(lambda: (self.js("document.body.dataset.ready") or "") in ("fitted", "explained"), "the workbench")
        self.click("back")
        self.wait(lambda: self.has("#sign-out"))
        self.click("sign-out")
        self.ready("sign-in")
        self.d.get(server.address + "c/adjusted/")
        self.ready("sign-in")


if __name__ == "__main__":
    live_browser.main()
