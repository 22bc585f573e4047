# SPDX-License-Identifier: Apache-2.0
"""site_page_test.py WRITE_SITE_PAGES: the laboratory's pages in a real browser: nothing is wider than the
screen, nothing is asked for, everybody can read and reach everything; filters, keyboard, print, no scripts."""
import pathlib
import subprocess
import sys
import tempfile

from browser import SKIPPED, Browser, complaints, program
from hindrances import HINDRANCES

WIDTHS = (320, 420, 1280, 1920)
SETTLED = "new Promise((done) => setInterval(() => { if ("


def check(browser, page, where):
    """One page, opened once: each width, closed and with its numbers; dark; printed."""
    browser.open(page.as_uri(), WIDTHS[0])
    for opened in (False, True):
        if opened:
            browser.value("document.querySelectorAll('details').forEach((d) => d.open = true)")
        for width in WIDTHS:
            browser.width(width)
            wide = browser.value("document.documentElement.scrollWidth")
            assert wide <= width, f"{where} at {width}, numbers {'' if opened else 'not '}shown: the page is {wide} wide"
            bad = browser.value(HINDRANCES) if opened else []
            assert not bad, f"{where} at {width}:\n  " + "\n  ".join(bad)
    browser.width(1280)
    browser.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    bad = browser.value(HINDRANCES)
    assert not bad, where + ", dark:\n  " + "\n  ".join(bad)
    browser.ask("Emulation.setEmulatedMedia", features=[])
    check_print(browser, where)
    charts = page.parents[page.parent.name == "machines"] / "charts.js"
    bad = complaints(browser, lambda url: url in (page.as_uri(), charts.as_uri()))
    assert not bad, where + ":\n  " + "\n  ".join(bad)


def shown(browser):
    return browser.value("[...document.querySelectorAll('tr[data-kind]')].filter((r) => r.getClientRects().length).length")


def check_filters(browser, index):
    browser.open(index.as_uri(), 1280)
    assert shown(browser) == 4
    browser.open(index.as_uri() + "#kind=changed&customer=Bianchi", 1280)
    assert shown(browser) == 1
    assert browser.value("document.getElementById('shown').textContent") == "1 / 4"
    browser.value("""(() => { const s = document.querySelector('select[name=customer]');
                     s.value = ''; s.dispatchEvent(new Event('change')); })()""")
    assert shown(browser) == 2 and browser.value("location.hash") == "#kind=changed"
    browser.value("new Promise((done) => { addEventListener('hashchange', () => done()); location.hash = '#kind=out'; })")
    assert shown(browser) == 1 and browser.value("document.querySelector('select[name=kind]').value") == "out"
    browser.open(index.as_uri() + "#kind=%22%3E%3Cscript%3E", 1280)
    assert shown(browser) == 4, "a filter that is not there hides nothing"


def press(browser, key):
    for kind in ("keyDown", "keyUp"):
        codes = {"Enter": 13, "Tab": 9}
        extra = {"windowsVirtualKeyCode": codes[key]} if key in codes else {}
        if kind == "keyDown" and (key == "Enter" or len(key) == 1):
            extra["text"] = "\r" if key == "Enter" else key
        browser.ask("Input.dispatchKeyEvent", type=kind, key=key, **extra)


def check_keyboard(browser, index):
    browser.open(index.as_uri(), 1280)
    focused = "[...document.querySelectorAll('tr[data-kind]')].indexOf(document.activeElement)"
    press(browser, "j")
    assert browser.value(focused) == 0
    for _ in range(2):
        press(browser, "j")
    assert browser.value(focused) == 2
    press(browser, "k")
    assert browser.value(focused) == 1
    outline = browser.value("getComputedStyle(document.activeElement).outlineStyle")
    assert outline == "solid", f"where the keyboard is, nobody sees: {outline}"
    browser.events = []
    press(browser, "Enter")
    while not any(e.get("method") == "Page.loadEventFired" for e in browser.events):
        browser.events.append(browser.receive())
    assert browser.value("location.pathname").endswith("/machines/S-0042.html")
    browser.open(index.as_uri(), 1280)
    reached = []
    for _ in range(6):
        press(browser, "Tab")
        reached.append(browser.value("document.activeElement.tagName + (document.activeElement.name || '')"))
    assert reached == ["A", "A", "A", "A", "SELECTkind", "SELECTcustomer"], reached


def check_charts(browser, page):
    """The tools of the charts: zoom by keys and pointer, values, and the same drawing afterwards."""
    browser.open(page.as_uri(), 1280)
    first = "document.querySelector('svg.chart')"
    assert browser.value(f"{SETTLED}document.querySelectorAll('.chart-tools').length === document.querySelectorAll('svg.chart').length) done(true); }}, 20))")
    drawn = f"{first}.querySelector('.drawn').innerHTML + [...{first}.querySelectorAll('.across')].map((g) => g.innerHTML)"
    whole = browser.value(drawn)
    browser.value(f"{first}.focus()")
    press(browser, "Home")
    told = browser.value("document.getElementById('tip').textContent")
    rows = browser.value(f"[...{first}.parentNode.querySelectorAll('tbody tr')].map((r) => [r.cells[0].textContent, r.cells[2].textContent])")
    assert any(told.startswith(day) and value in told for day, value in rows), (told, rows)
    press(browser, "+")
    near = browser.value(drawn)
    assert near != whole, "the key + does not enlarge"
    labels = browser.value(f"[...{first}.querySelectorAll('.across text')].map((t) => t.textContent)")
    assert labels and len(set(labels)) == len(labels), labels
    press(browser, "0")
    assert browser.value(drawn) == whole, "the whole axis is not as it was drawn"
    box = browser.value(f"(({first}.scrollIntoView()), [...['x', 'y', 'width', 'height'].map((k) => {first}.getBoundingClientRect()[k])])")
    at = {"y": box[1] + box[3] / 2, "button": "left", "clickCount": 1}
    for kind, part in (("mousePressed", 0.4), ("mouseMoved", 0.5), ("mouseMoved", 0.7), ("mouseReleased", 0.7)):
        browser.ask("Input.dispatchMouseEvent", type=kind, x=box[0] + part * box[2], **at)
    assert browser.value(drawn) not in (whole, near), "a range chosen with the pointer does not enlarge"


def check_alone(browser, page, folder):
    """A page that was sent without charts.js has its charts, without tools."""
    alone = pathlib.Path(folder) / "alone" / page.name
    alone.parent.mkdir()
    alone.write_bytes(page.read_bytes())
    browser.open(alone.as_uri(), 1280)
    assert browser.value("document.querySelectorAll('svg.chart path').length") > 0
    assert browser.value("document.querySelectorAll('.chart-tools').length") == 0


def check_print(browser, where):
    browser.width(1123 - 76)
    browser.ask("Emulation.setEmulatedMedia", media="print")
    assert browser.value("getComputedStyle(document.querySelector('nav')).display") == "none", where
    wide = browser.value("[document.documentElement.scrollWidth, innerWidth]")
    assert wide[0] <= wide[1], f"{where}: printed {wide}"
    paper = browser.value("[...document.querySelectorAll('.fine, .heed, .grave')].every((e) => "
                          "getComputedStyle(e).printColorAdjust === 'exact')")
    assert paper, f"{where}: the months lose their colours"
    assert len(browser.ask("Page.printToPDF", printBackground=False)["data"]) > 1000
    browser.ask("Emulation.setEmulatedMedia", media="")


def check_without_scripts(browser, index):
    browser.open("about:blank", 1280)
    browser.ask("Emulation.setScriptExecutionDisabled", value=True)
    browser.events = []
    browser.ask("Page.navigate", url=index.as_uri())
    while not any(e.get("method") == "Page.loadEventFired" for e in browser.events):
        browser.events.append(browser.receive())
    root = browser.ask("DOM.getDocument")["root"]["nodeId"]
    rows = browser.ask("DOM.querySelectorAll", nodeId=root, selector="tr[data-kind]:not([hidden])")["nodeIds"]
    assert len(rows) == 4
    filters = browser.ask("DOM.querySelector", nodeId=root, selector=".filters[hidden]")["nodeId"]
    assert filters, "filters that do nothing are not shown"
    browser.ask("Emulation.setScriptExecutionDisabled", value=False)


def main():
    if program() is None:
        print("skipped: no Chromium on this machine")
        return SKIPPED
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        pages = pathlib.Path(folder) / "pages"
        subprocess.run([sys.argv[1], str(pages)], check=True)
        browser = Browser(program(), folder + "/profile")
        for page in sorted(pages.rglob("*.html")):
            check(browser, page, str(page.relative_to(pages)))
        check_filters(browser, pages / "en" / "index.html")
        check_keyboard(browser, pages / "en" / "index.html")
        check_without_scripts(browser, pages / "en" / "index.html")
        for language in ("en", "de"):
            check_charts(browser, pages / language / "machines" / "S-0042.html")
        check_alone(browser, pages / "en" / "machines" / "S-0042.html", folder)
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
