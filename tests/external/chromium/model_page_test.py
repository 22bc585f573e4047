# SPDX-License-Identifier: Apache-2.0
"""model_page_test.py WRITE_MODEL_PAGES: the page model-html in a real browser: it requests nothing
but itself, draws its pictures, removes effects with the stated numbers, and shows a reading."""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
from xml.etree import ElementTree

from browser import SKIPPED, Browser, complaints, program


def fit_without(data, effects):
    """RMS and largest residual: of the whole model, fitted again without one effect if the page has that; else
    the parts of the effects come back, less a zero."""
    weight = data["weight"]
    fitted = data if not effects else data["effects"][effects[0]]["without"] if len(effects) == 1 else None
    if fitted:
        return fitted["rms"], fitted["largest"]
    residual = [r + sum(data["effects"][e]["says"][i] for e in effects) for i, r in enumerate(data["residual"])]
    if effects:
        shift = sum(w * (r - o) for w, r, o in zip(weight, residual, data["residual"]))
        residual = [r - shift / sum(weight) for r in residual]
    rms = math.sqrt(sum(w * r * r for w, r in zip(weight, residual)) / sum(weight))
    return rms, max((r for w, r in zip(weight, residual) if w > 0), key=abs)


def check_numbers(browser, data, effects, where):
    """All numbers that are visible are of the fit that is drawn."""
    printed = lambda v: f"{v:.2f}".replace("-", "\u2212").replace(".", "," if data["language"] in ("de", "it") else ".")
    rms, largest = fit_without(data, effects)
    visible = browser.value("document.body.innerText")
    sentence = browser.value("document.getElementById('rms').innerText")
    assert printed(rms) in sentence, f"{where}: wanted {printed(rms)}, found {sentence}"
    before, after = data["words"]["largest"].split("{value}")[0], data["words"]["rms_now"].split("{rms}")[0]
    found = re.findall(re.escape(before) + "(\\S+)", visible)
    assert found and set(found) == {printed(largest)}, f"{where}: wanted {printed(largest)}, found {found}"
    assert visible.count(after) == 1, where
    shown = browser.value("[...document.querySelectorAll('.whole')].filter((e) => e.getClientRects().length > 0).length")
    assert (shown == 0) == bool(effects), f"{where}: {shown} parts of the whole model with {effects} removed"
    assert (data["words"]["of_whole"] in sentence) == bool(effects), sentence


def check(browser, page, widths):
    where = f"{page.parent.parent.name}/{page.parent.name}"
    data = json.loads(page.read_text().split('id="data">')[1].split("</script>")[0])
    browser.open(page.as_uri(), widths[0])
    assert browser.value("document.querySelectorAll('figure').length") == 10, where
    drawn = browser.value("[...document.querySelectorAll('figure')].filter(f => f.querySelector('svg path, canvas')).length")
    assert drawn == sum(not p["none"] for p in [data["fit"], *data["pictures"]]), f"{where}: {drawn} drawn"
    if not data["fit"]["none"]:
        modelled = browser.value("document.querySelectorAll('#picture-fit path.mean, #picture-fit path.model').length")
        assert modelled > 0 and browser.value("document.querySelector('figure').id") == "picture-fit", f"{where}: no model is drawn first"
    for width in reversed(widths):
        browser.width(width)
        wide = browser.value("document.documentElement.scrollWidth")
        assert wide <= width, f"{where} at {width}: the page is {wide} wide"
    shown = lambda: browser.value("document.getElementById('rms').textContent")
    check_numbers(browser, data, [], where)
    cross_validated = lambda: browser.value("(document.querySelector('#picture-8 svg') || {}).innerHTML")
    # Of many readings a click takes its time: the first and the last effect there.
    effects = range(len(data["effects"]))
    for effect in sorted({effects[0], effects[-1]}) if "many" in where and effects else effects:
        box = f"document.querySelectorAll('#effects input')[{effect}]"
        before = cross_validated()
        browser.value(f"{box}.click()")
        check_numbers(browser, data, [effect], where)
        assert data["left_out"] is None or cross_validated() != before, f"{where}: cross-validation is of the whole model"
        refitted = data["effects"][effect]["without"] is not None
        said = data["words"]["without" if refitted else "not_refitted"].split("{")[0]
        assert said in shown(), f"{where}: wanted {said}, found {shown()}"
        assert browser.value("location.hash") == f"#e{effect}", where
        browser.value(f"{box}.click()")
    if len(data["effects"]) > 1 and "many" not in where:
        for effect in (0, 1):
            browser.value(f"document.querySelectorAll('#effects input')[{effect}].click()")
        check_numbers(browser, data, [0, 1], where)
        assert data["words"]["not_refitted"].split("{")[0] in shown(), f"{where}: found {shown()}"
        for effect in (0, 1):
            browser.value(f"document.querySelectorAll('#effects input')[{effect}].click()")
    bad = complaints(browser, lambda url: "/model-" in url)
    assert not bad, f"{where}: {bad}"


def check_dark(browser, page):
    browser.open(page.as_uri(), 1400)
    colour = "getComputedStyle(document.body).backgroundColor"
    light = browser.value(colour)
    browser.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    dark = browser.value(colour)
    assert light == "rgb(255, 255, 255)" and sum(map(int, re.findall(r"\d+", dark))) < 150, (light, dark)


def check_hover(browser, page):
    browser.open(page.as_uri(), 1400)
    place = browser.value("""(() => {
        const ring = document.querySelector('#picture-0 .suspect');
        ring.scrollIntoView({block: 'center'});
        const box = ring.getBoundingClientRect();
        return [box.x + box.width / 2, box.y + box.height / 2];
    })()""")
    browser.value("new Promise(done => setTimeout(done, 200))")
    browser.ask("Input.dispatchMouseEvent", type="mouseMoved", x=place[0], y=place[1])
    tip = browser.value("document.getElementById('tip').innerText")
    assert "Run 1" in tip and "line 78" in tip and "suspected" in tip, tip
    marked = set(browser.value("[...document.querySelectorAll('.chosen')].map(c => c.closest('figure').id)"))
    assert marked == {"picture-fit"} | {f"picture-{k}" for k in range(9) if k != 1}, marked  # 1 has means of targets


def check_chart(browser, page):
    """Zoom by button, key and pointer; the chart as a file."""
    data = json.loads(page.read_text().split('id="data">')[1].split("</script>")[0])
    browser.open(page.as_uri(), 1400)
    readings = "[...document.querySelectorAll('#picture-0 .marks')].reduce((n, p) => n + p.getAttribute('d').split('M').length - 1, 0)"
    labels = "[...document.querySelectorAll('#picture-0 svg text')].map((t) => t.textContent).join(' ')"
    everything, whole = browser.value(readings), browser.value(labels)
    assert everything == len(data["residual"]), everything
    press = lambda name: browser.value(f"document.querySelectorAll('#picture-0 .chart-tools button')[{('in', 'out', 'left', 'right', 'all').index(name)}].click()")
    press("in")
    middle = browser.value(readings)
    assert 0.3 * everything < middle < 0.7 * everything and browser.value(labels) != whole, middle
    press("left")
    first = browser.value(labels)
    press("right")
    press("right")
    assert first != browser.value(labels) != whole
    press("right")  # there is no more
    key = "document.querySelector('#picture-0 svg').dispatchEvent(new KeyboardEvent('keydown', {key: '%s', bubbles: true}))"
    browser.value(key % "0")
    assert (browser.value(readings), browser.value(labels)) == (everything, whole)
    box = browser.value("""(() => { const svg = document.querySelector('#picture-0 svg'); svg.scrollIntoView({block: 'center'});
        const box = svg.getBoundingClientRect(); return [box.x, box.y, box.width, box.height]; })()""")
    browser.value("new Promise(done => setTimeout(done, 200))")
    for kind, part in (("mousePressed", 0.6), ("mouseMoved", 0.8), ("mouseReleased", 0.8)):
        browser.ask("Input.dispatchMouseEvent", type=kind, x=box[0] + part * box[2], y=box[1] + 0.4 * box[3], button="left", buttons=1, clickCount=1)
    assert 0 < browser.value(readings) < 0.4 * everything
    browser.value(key % "0")
    browser.value(key % "Home")
    assert "line" in browser.value("document.getElementById('tip').innerText"), "the first reading, by a key"
    browser.value("""(() => { const make = URL.createObjectURL; window.handed = {};
        let last; URL.createObjectURL = (blob) => make.call(URL, last = blob);
        HTMLAnchorElement.prototype.click = function () { window.handed[this.download.split('.').pop()] = last; }; })()""")
    browser.value("[...document.querySelectorAll('#picture-0 .chart-tools button')].slice(-3).forEach((b) => b.click())")
    while browser.value("Object.keys(handed).length") < 3:
        pass
    table = browser.value("handed.csv.text()").splitlines()
    assert table[0].startswith("axis,series,line,") and sum(",readings," in row for row in table) == everything, table[:3]
    # A text that a spreadsheet would take for a formula is guarded, as by the program.
    browser.value("""nonioSave.buttons(document.querySelector('#picture-0 svg'), () => [['=1+1', '-5.1', '+a', '@x, y', 'b'], [-3, 1.5, '', '', '']]).at(-1).click(), null""")
    while (guarded := browser.value("handed.csv.text()")).startswith("axis"):
        pass
    assert guarded == "'=1+1,-5.1,'+a,\"'@x, y\",b\n-3,1.5,,,\n", guarded
    drawn = browser.value("handed.svg.text()")
    assert ElementTree.fromstring(drawn) is not None and 'stroke="rgb(' in drawn and "var(" not in drawn
    pixels = browser.value("createImageBitmap(handed.png).then((image) => [image.width, image.height])")
    view = browser.value("(({width, height}) => [width, height])(document.querySelector('#picture-0 svg').viewBox.baseVal)")
    assert pixels == [2 * v for v in view], (pixels, view)
    bad = [b for b in complaints(browser, lambda url: "/model-" in url) if not b.startswith("asks for data:image/svg")]
    assert not bad, bad


def main():
    if program() is None:
        print("skipped: no Chromium on this machine")
        return SKIPPED
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        pages = pathlib.Path(folder) / "pages"
        subprocess.run([sys.argv[1], str(pages)], check=True)
        browser = Browser(program(), folder + "/profile")
        for page in sorted(pages.glob("*/*/model-*.html")):
            check(browser, page, (1400,) if page.parts[-3] == "many" else (1400, 400, 320))
        check_dark(browser, pages / "usual" / "en" / "model-X.html")
        check_hover(browser, pages / "usual" / "en" / "model-X.html")
        check_chart(browser, pages / "usual" / "en" / "model-X.html")
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
