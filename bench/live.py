# SPDX-License-Identifier: Apache-2.0
"""live.py NONIO [--readings 210,20000,1000000] [--trials 5] [--no-browser] [--keep FOLDER]: how fast `nonio serve` answers.

Simulated campaigns with a hidden warm-up (seed 7). Each is opened twice: over the interface as the page uses it (events,
then what changed), and in Chromium, where times run to the painted picture (marks of the page). A click adds the effect
that is hidden, then others; a zoom asks for a quarter of the axis. Peer in the same run: `nonio model compare` and
`nonio model explain` as whole programs, and NumPy, which reads the same file and solves one least-squares problem of the
model (needs python3-numpy). Memory is VmHWM of each process, and the page's JavaScript heap.
"""
import argparse
import http.client
import json
import os
import pathlib
import platform
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.parse

import long_tables

EFFECT = "warm-up:X"  # the hidden one
CLICKS = [EFFECT, "zero-drift:X", "backlash-slope:X", "periodic:X", "growth-drift:X"]
PATIENCE = 180


class Server:
    def __init__(self, nonio, folder):
        self.began = time.perf_counter()
        self.process = subprocess.Popen([nonio, "serve", str(folder)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.page = self.process.stdout.readline().strip()
        self.address, self.token = self.page.split("#t=")
        self.connection = http.client.HTTPConnection(urllib.parse.urlsplit(self.address).netloc, timeout=PATIENCE)
        self.bytes = 0

    def seconds(self):
        return time.perf_counter() - self.began

    def ask(self, path, body=None):
        """Status, JSON."""
        fields = {"X-Nonio-Token": self.token}
        if body is not None:
            body, fields["Content-Type"] = json.dumps(body), "application/json"
        self.connection.request("GET" if body is None else "POST", "/api/" + path, body, fields)
        answer = self.connection.getresponse()
        text = answer.read()
        self.bytes = len(text)
        return answer.status, json.loads(text)

    def until(self, path, holds, what):
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            status, answer = self.ask(path)
            if holds(status, answer):
                return answer
            time.sleep(0.003)
        sys.exit(f"{path}: never {what}: {str(answer)[:300]}")

    def opened(self):
        return self.until("state", lambda s, a: a.get("bench") == "open", "open")

    def fitted(self):
        return self.until("parts/X/fit", lambda s, a: s != 409, "fitted")

    def explained(self):
        return self.until("parts/X/explain", lambda s, a: s != 409, "explained")

    def processes(self):
        parents = {}
        for entry in pathlib.Path("/proc").iterdir():
            if entry.name.isdigit():
                try:
                    parents[int(entry.name)] = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
                except (OSError, IndexError):
                    pass
        found, grew = {self.process.pid}, True
        while grew:
            more = {p for p, parent in parents.items() if parent in found} - found
            found |= more
            grew = bool(more)
        return sorted(found)

    def memory(self):
        """Of the server, and of the largest process that calculates: MB."""
        of = {}
        for pid in self.processes():
            try:
                of[pid] = int(re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{pid}/status").read_text())[1]) / 1024
            except (OSError, TypeError):
                pass
        return of.pop(self.process.pid, 0.0), max(of.values(), default=0.0)

    def end(self):
        self.process.terminate()
        self.process.wait(20)
        self.process.stdout.close()


def ms(seconds):
    return f"{1e3 * seconds:9.0f} ms"


def middle(of):
    return statistics.median(of)


def timed(what):
    began = time.perf_counter()
    what()
    return time.perf_counter() - began


def interface(nonio, folder, trials):
    """Figures without a browser."""
    out, server = {}, Server(nonio, folder)
    out["address printed"] = server.seconds()
    server.opened()
    out["campaign read"] = server.seconds()
    if server.ask("parts/X/look")[0] == 200 and server.ask("parts/X/series?x=target&y=deviation&px=800")[0] == 200:
        out["readings as a picture"] = server.seconds()
    server.fitted()
    out["model as well"] = server.seconds()
    out["bytes of a fit"] = server.bytes
    began = time.perf_counter()
    server.explained()
    out["explained, after the fit"] = time.perf_counter() - began
    clicks, pictures, explains, peak = [], [], [], [0.0, 0.0]
    time.sleep(1.0)  # a person looks at the page
    for effect in CLICKS[:trials]:
        began = time.perf_counter()
        if server.ask("model", {"add": effect})[0] != 200:
            continue  # these readings cannot show it
        server.until("parts/X/picture", lambda s, a: s != 409, "drawn")
        pictures.append(time.perf_counter() - began)
        server.fitted()
        clicks.append(time.perf_counter() - began)
        server.explained()
        explains.append(time.perf_counter() - began)
        peak = [max(a, b) for a, b in zip(peak, server.memory())]
    out["click to new residuals"] = middle(pictures)
    out["click to new fit"] = middle(clicks)
    out["click to explained"] = middle(explains)
    zooms = [timed(lambda k=k: server.ask(f"parts/X/series?x=target&y=residual&px=800&x0={20 + k}&x1={310 + k}")) for k in range(4 * trials)]
    out["zoom"], out["zoom, slowest"] = middle(zooms), max(zooms)
    out["memory of the server, MB"], out["memory of the worker, MB"] = peak
    server.end()
    return out


def browser(profile):
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    options = Options()
    options.binary_location = shutil.which("chromium")
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1280,800",
                     "--enable-precise-memory-info", f"--user-data-dir={profile}"):
        options.add_argument(argument)
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


# Time of the n-th mark of this name, or null; the page sets it after the frame that shows the change.
MARK = "const m = performance.getEntriesByName(arguments[0], 'mark').filter((e) => e.startTime > arguments[1]); return m.length ? m[0].startTime : null;"


# Time from a click that enlarges the readings that the page holds to the end of the frame that shows them.
ZOOM = """const done = arguments[0], at = performance.now(); document.querySelector('#picture-0 .chart-tools button').click();
requestAnimationFrame(() => setTimeout(() => done(performance.now() - at)));"""


def marked(d, name, after=0.0):
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        at = d.execute_script(MARK, name, after)
        if at is not None:
            return at / 1e3
        time.sleep(0.01)
    sys.exit(f"no mark {name}")


def clicked(d, selector):
    return d.execute_script("const n = performance.now(); document.querySelector(arguments[0]).click(); return n;", selector)


def page(nonio, folder, trials, readings):
    """Figures of Chromium, to the painted picture."""
    out = {}
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        d = browser(profile)
        server = Server(nonio, folder)
        d.get(server.page)
        out["page: start of the program to a picture"] = server.seconds()
        first = marked(d, "picture")
        out["page: start of the program to a picture"] = d.execute_script("return performance.timeOrigin;") / 1e3 + first - (time.time() - server.seconds())
        marked(d, "fitted")
        d.get("about:blank")
        d.get(server.page)
        out["page: opened to a picture"] = marked(d, "picture")
        out["page: opened to the model"] = marked(d, "fitted")
        d.execute_script("document.querySelector(\"details[data-key='rest']\")?.setAttribute('open', '')")
        time.sleep(2.0 if readings < 500000 else 8.0)  # a person looks at the page
        clicks = []
        for _ in range(1 + trials):  # only the first is a model that was not fitted before
            at = clicked(d, f"input[data-effect='{EFFECT}']")
            clicks.append((marked(d, "fitted", at) - at / 1e3, marked(d, "all", at) - at / 1e3))
            time.sleep(1.0)
        out["page: click to the new picture"], out["page: ... all nine"] = clicks[0]
        out["page: click, fitted before"] = middle([c[0] for c in clicks[1:]])
        asks_server, zooms = d.execute_script("return document.querySelector('#picture-0 .between') !== null"), []
        for _ in range(trials):
            if asks_server:
                at = clicked(d, "#picture-0 .chart-tools button")
                zooms.append(marked(d, "zoomed", at) - at / 1e3)
            else:
                zooms.append(d.execute_async_script(ZOOM) / 1e3)
            time.sleep(0.2)
        out["page: zoom"] = middle(zooms)
        d.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
        out["page: heap, MB"] = d.execute_script("return performance.memory.usedJSHeapSize;") / 1e6
        server.end()
        d.quit()
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("nonio", type=pathlib.Path)
    parser.add_argument("--readings", default="210,20000,1000000")
    parser.add_argument("--trials", type=int, default=5)
    parser.add_argument("--no-browser", action="store_true")
    parser.add_argument("--keep", type=pathlib.Path, help="where the campaigns are made, and found again")
    args = parser.parse_args()
    nonio = str(args.nonio.resolve())
    os.environ.setdefault("NONIO_ALLOW_ROOT", "1")
    cpu = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text())
    print(f"{platform.platform()}, {cpu[1] if cpu else '?'}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; "
          f"{subprocess.run([nonio, 'version'], capture_output=True, text=True).stdout.splitlines()[0]}; seed 7; medians of {args.trials}")
    with tempfile.TemporaryDirectory() as scratch:
        for readings in map(int, args.readings.split(",")):
            folder = (args.keep or pathlib.Path(scratch)) / str(readings)
            if not (folder / "campaign").exists():
                folder.mkdir(parents=True, exist_ok=True)
                long_tables.campaign(nonio, folder, readings, True)
            folder /= "campaign"
            print(f"\n{readings:,} readings, {(folder / 'x.csv').stat().st_size / 1e6:.1f} MB")
            figures = interface(nonio, folder, args.trials if readings < 500000 else 2)
            if not args.no_browser:
                figures |= page(nonio, folder, args.trials if readings < 500000 else 2, readings)
            for verb in ("compare", "explain"):
                figures[f"nonio {verb}, whole program"] = min(
                    timed(lambda: subprocess.run([nonio, verb, str(folder), "--json"], stdout=subprocess.DEVNULL)) for _ in range(2))
            figures["NumPy: read, one lstsq (CPU)"] = peer = long_tables.numpy_seconds(folder / "x.csv", readings / 80.0)
            for name, value in figures.items():
                if name.endswith("MB") or name.startswith("bytes"):
                    print(f"  {name:42} {value:9,.0f}")
                else:
                    print(f"  {name:42} {ms(value)}   {value / peer:8.2f} of NumPy")


if __name__ == "__main__":
    main()
