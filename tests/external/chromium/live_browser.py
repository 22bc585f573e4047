# SPDX-License-Identifier: Apache-2.0
"""What the tests of the pages of `nonio serve` in a real browser share: a browser, a server, and a page that keeps its
picture when a test fails."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.parse
import urllib.request

try:
    from selenium import webdriver
    from selenium.common.exceptions import StaleElementReferenceException
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import WebDriverWait
except ImportError:
    webdriver = ActionChains = By = Keys = StaleElementReferenceException = None
from browser import SKIPPED, program

NONIO, SOURCE = (pathlib.Path(a).resolve() for a in sys.argv[1:3])  # servers run in folders of their own
DRIVER = shutil.which("chromedriver")
PATIENCE = 30
TUTORIAL = SOURCE / "samples/tutorial/site/missing-effect"


def said(verb, folder, *more):
    got = subprocess.run([str(NONIO), verb, str(folder), "--json", *more], capture_output=True, text=True)
    return json.loads(got.stdout)


def browser(profile, width=1280, height=800):
    options = Options()
    options.binary_location = program()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", f"--user-data-dir={profile}",
                     f"--window-size={width},{height}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


class Live:
    """A `nonio serve` of its own campaign, port and token."""

    def __init__(self, folder, *more):
        self.command, self.beside = [str(NONIO), "live", *more, folder.name], folder.parent
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.beside)
        self.address = self.process.stdout.readline().strip()
        if not self.address.startswith("http://127.0.0.1:"):
            raise AssertionError(f"{self.command}: {self.address} {self.process.stderr.read()}")

    def ask(self, path):
        """An answer of the interface, without the browser; one that is not there yet is waited for."""
        base, token = self.address.split("#t=")
        deadline = time.monotonic() + 10 * PATIENCE
        while True:
            try:
                return json.load(urllib.request.urlopen(urllib.request.Request(base + path, headers={"X-Nonio-Token": token}), timeout=PATIENCE))
            except urllib.error.HTTPError as refused:
                with refused:
                    if refused.code != 409 or time.monotonic() > deadline:
                        raise
            time.sleep(0.05)

    def explained(self):
        """Of each part that has been compared: what compare and explain say of it."""
        while (state := self.ask("api/state"))["bench"] not in ("open", "failed"):
            time.sleep(0.05)
        path = lambda part, what: f"api/parts/{urllib.parse.quote(part['name'], safe='')}/{what}"
        return {p["name"]: (self.ask(path(p, "fit?page=0"))["compare"], self.ask(path(p, "explain"))["explain"]) for p in state["parts"]}

    def stop(self, kill=False):
        (self.process.kill if kill else self.process.terminate)()
        self.process.wait(20)
        for pipe in (self.process.stdout, self.process.stderr):
            pipe.close()


class LivePage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        cls.d = browser(cls.profile.name)

    @classmethod
    def tearDownClass(cls):
        cls.d.quit()
        cls.profile.cleanup()

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.folder = pathlib.Path(self.scratch.name)
        self.servers = []
        self.addCleanup(self.end)
        self.size(1280, 800)

    def end(self):
        outcome = getattr(self._outcome, "result", None)
        if outcome and any(test is self for test, _ in outcome.errors + outcome.failures):
            name = pathlib.Path(tempfile.gettempdir()) / f"nonio-live-{self.id().split('.')[-1]}"
            self.d.save_screenshot(f"{name}.png")
            print(f"kept {name}.png;", self.d.get_log("browser"), flush=True)
        self.d.switch_to.window(self.d.window_handles[0])
        for server in self.servers:
            if server.process.poll() is None:
                server.stop()
        self.scratch.cleanup()

    # ---- tools ----
    def size(self, width, height=800, scale=1):
        self.d.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": False})

    def media(self, **features):
        self.d.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": k.replace("_", "-"), "value": v} for k, v in features.items()]})
        self.addCleanup(self.d.execute_cdp_cmd, "Emulation.setEmulatedMedia", {"features": []})

    def serve(self, folder, *more):
        server = Live(folder, *more)
        self.servers.append(server)
        return server

    def wait(self, condition, what=""):
        return WebDriverWait(self.d, PATIENCE, 0.03).until(lambda d: condition(), what)

    def js(self, text, *arguments):
        return self.d.execute_script("return " + text, *arguments)

    def text(self, identifier):
        return self.js(f"document.getElementById('{identifier}').textContent")

    def press(self, *keys):
        ActionChains(self.d).send_keys(*keys).perform()

    def click(self, identifier):
        self.d.find_element(By.ID, identifier).click()

    def no_complaints(self):
        # 409 (not explained yet) and lost connections are part of the conversation.
        bad = [e["message"] for e in self.d.get_log("browser") if e["level"] == "SEVERE" and "status of 409" not in e["message"]]
        self.assertEqual([], bad)

    def own_requests_only(self):
        origin = self.js("location.origin")
        asked = self.js("performance.getEntriesByType('resource').map((e) => e.name)")
        self.assertEqual([], [a for a in asked if not a.startswith(origin + "/")])
        self.assertNotIn("t=", self.js("location.href"), "the token does not stay in the address")


class CampaignPage(LivePage):
    """The page of a campaign: its states, and what is ticked."""

    def campaign(self, source=TUTORIAL, name=None):
        return pathlib.Path(shutil.copytree(source, self.folder / (name or source.name)))

    def open(self, server, wait="explained"):
        self.d.get("about:blank")
        self.d.get(server.address)
        self.d.get_log("browser")
        self.ready(wait)

    def ready(self, state="explained"):
        self.wait(lambda: self.js("document.body.dataset.ready") in state.split("|"), f"the page is {state}")

    def verdict(self, kind):
        self.wait(lambda: self.js("document.getElementById('verdict').classList.contains(arguments[0])", kind), f"verdict {kind}")
        return self.text("verdict")

    def rms(self):
        return float(self.js("document.querySelector('#now .number').dataset.value"))

    def ticks(self, group=None):
        where = f"[data-group=\"{group}\"] " if group else ""
        return self.js(f"[...document.querySelectorAll('{where}input[data-effect]')].map((e) => e.dataset.effect + (e.checked ? '' : '?'))")

    def tick(self, effect):
        before, was = self.js("document.body.dataset.version"), effect in self.ticks()

        def clicked():
            try:  # what arrives meanwhile may draw the list again
                box = self.d.find_element(By.CSS_SELECTOR, f"input[data-effect='{effect}']")
                self.js("arguments[0].scrollIntoView({block: 'center'})", box)
                box.click()
                return True
            except StaleElementReferenceException:
                return False
        self.wait(clicked, effect)
        self.wait(lambda: self.js("document.body.dataset.version") != before and (effect + ("?" if was else "")) in self.ticks(), effect)
        self.ready()


def main():
    if webdriver is None or program() is None or DRIVER is None:
        print("skipped: needs Chromium, chromium-driver and python3-selenium")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
