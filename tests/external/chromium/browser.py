# SPDX-License-Identifier: Apache-2.0
"""Chromium without a driver, for tests of pages that are opened from disk."""
import json
import os
import shutil
import subprocess
import sys

SKIPPED = 77


def program():
    return next((p for p in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if p), None)


class Browser:
    """Chromium over its debugging pipe: messages of JSON that end with a zero byte."""

    def __init__(self, program, folder):
        to_read, self.send_to = os.pipe()
        self.read_from, to_write = os.pipe()
        # The browser wants the pipe as descriptors 3 and 4.
        command = f"exec {program} --headless --no-sandbox --disable-gpu --disable-dev-shm-usage " \
                  f"--user-data-dir={folder} --remote-debugging-pipe about:blank " \
                  f"3<&{to_read} 4>&{to_write}"
        self.process = subprocess.Popen(["bash", "-c", command], pass_fds=(to_read, to_write),
                                        stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.last, self.session, self.target, self.rest = 0, None, None, b""
        self.events = []

    def receive(self):
        while b"\0" not in self.rest:
            got = os.read(self.read_from, 1 << 20)
            if not got:
                sys.exit("the browser ended")
            self.rest += got
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def ask(self, method, **parameters):
        self.last += 1
        message = {"id": self.last, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.send_to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.last:
                assert "error" not in answer, answer
                return answer["result"]
            self.events.append(answer)

    def open(self, url, width):
        """In a tab of its own; the one before is closed."""
        self.session, before = None, self.target
        self.target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        if before:
            self.ask("Target.closeTarget", targetId=before)
        self.session = self.ask("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        self.events = []
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.ask(f"{domain}.enable")
        self.metrics(width)
        self.ask("Page.navigate", url=url)
        while not any(e.get("method") == "Page.loadEventFired" for e in self.events):
            self.events.append(self.receive())

    def width(self, width):
        self.metrics(width)
        while not self.value(f"matchMedia('(width: {width}px)').matches"):
            pass

    def metrics(self, width):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=900,
                 deviceScaleFactor=1, mobile=width < 600)

    def value(self, expression):
        result = self.ask("Runtime.evaluate", expression=expression, returnByValue=True,
                          awaitPromise=True)
        assert "exceptionDetails" not in result, result
        return result["result"].get("value")

    def close(self):
        self.session = None
        self.ask("Browser.close")
        self.process.wait(timeout=30)


def complaints(browser, own):
    """Errors of scripts and of the browser, and requests for a page that `own` does not know."""
    bad = []
    for event in browser.events:
        if event.get("method") == "Runtime.exceptionThrown":
            bad.append(event["params"]["exceptionDetails"].get("text"))
        if event.get("method") == "Log.entryAdded" and event["params"]["entry"]["level"] == "error":
            bad.append(event["params"]["entry"]["text"])
        if event.get("method") == "Network.requestWillBeSent":
            url = event["params"]["request"]["url"]
            if not url.startswith("file:") or not own(url):
                bad.append("asks for " + url)
    return bad
