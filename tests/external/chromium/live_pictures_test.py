# SPDX-License-Identifier: Apache-2.0
"""live_pictures_test.py NONIO SOURCE_FOLDER: what the page of `nonio serve` draws of many readings, of the machine in space and
of circles, and numbers that are those of `nonio model compare` and `explain`, in a real browser with the real server."""
import re
import subprocess
import threading

import live_browser
from live_browser import By, Keys, NONIO, SOURCE, said


class Pictures(live_browser.CampaignPage):
    def test_in_space_the_machine_is_drawn_with_its_lines(self):
        source = SOURCE / "samples/site/13-gantry-diagonals"
        self.open(self.serve(self.campaign(source)))
        self.assertTrue(self.d.find_element(By.ID, "space").is_displayed())
        part = said("compare", source)["parts"][0]
        names = "[...document.querySelectorAll('#space-table tbody tr')].map((r) => [...r.children].map((c) => c.textContent))"
        table = self.js(names)
        self.assertEqual(sorted(part["measurements"]), sorted(row[0] for row in table))
        self.assertEqual(part["observations"], sum(int(row[1]) for row in table))
        sizes = [float(row[2]) for row in table]
        self.assertEqual(sorted(sizes, reverse=True), sizes, "the worst first")
        total = (sum(int(row[1]) * float(row[2]) ** 2 for row in table) / part["observations"]) ** 0.5
        self.assertAlmostEqual(self.rms(), total, delta=0.02 * total)
        self.assertEqual({"bed", "X", "Y", "tool"}, set(self.js("[...document.querySelectorAll('#space [data-body]')].map((b) => b.dataset.body)")))
        self.assertIn("gantry", self.text("space-chain"))
        drawn = "document.getElementById('space-picture').innerHTML"
        for slider, key in (("space-times", Keys.ARROW_RIGHT), ("space-turn", Keys.PAGE_UP), ("space-lift", Keys.PAGE_UP)):
            before = self.js(drawn)
            self.d.find_element(By.ID, slider).send_keys(key)
            self.wait(lambda: self.js(drawn) != before, slider)
            self.assertEqual(slider, self.js("document.activeElement.id"), "the focus stays on the slider")
        inside = "(() => { const s = document.querySelector('#space svg').getBoundingClientRect(); return [...document.querySelectorAll('#space svg *')].filter((e) => e.tagName !== 'title').every((e) => { const r = e.getBoundingClientRect(); return r.left >= s.left - 1 && r.right <= s.right + 1 && r.top >= s.top - 1 && r.bottom <= s.bottom + 1; }); })()"
        self.assertTrue(self.js(inside), "nothing is cut")
        self.assertEqual(["PNG", "SVG", "CSV"], self.js("[...document.querySelectorAll('#space-picture .chart-tools button')].map((b) => b.textContent)"))
        self.js("document.querySelector('#space-picture svg').focus()")
        self.press(Keys.HOME)
        self.assertRegex(self.js("document.getElementById('tip').innerText"), r"X [\d.]+, Y [\d.]+, Z [\d.]+ mm\s+Residual / \u00B5m: ")
        self.no_complaints()

    def test_more_readings_than_the_page_holds_are_drawn_from_the_server_and_zoomed(self):
        truth = (SOURCE / "samples/simulate/worn-screw.toml").read_text()
        truth = re.sub(r"step_mm = 58.0", "step_mm = 1.0", truth).replace("runs = 5", "runs = 10").replace("dwell_s = 4.0", "dwell_s = 0.1")
        (self.folder / "truth.toml").write_text(truth)
        subprocess.run([str(NONIO), "simulate", str(self.folder / "truth.toml"), "--out", str(self.folder / "many"), "--quiet"], check=True, capture_output=True)
        self.open(self.serve(self.folder / "many"), "fitted")
        n = said("compare", self.folder / "many")["parts"][0]["observations"]
        self.assertGreater(n, 20000)
        self.wait(lambda: self.js("document.querySelectorAll('svg:has(.between)').length") == 6, "position, time, run, phase, temperature, model")
        zoomed = "document.getElementById('big-0').textContent"
        count = lambda: int(re.match(r"\d+", self.js(zoomed))[0])
        self.assertGreaterEqual(count(), n)
        self.js("document.querySelector('#picture-0 .chart-tools button').click()")
        self.wait(lambda: 0.4 * n < count() < 0.6 * n, "half of the axis")
        self.js("document.querySelector('#picture-0 svg').focus()")
        self.press("0")
        self.wait(lambda: count() >= n)
        self.no_complaints()

    def test_circles_are_drawn_as_a_ball_bar_draws_them(self):
        server = self.serve(self.campaign(SOURCE / "samples/site/40-circles"))
        server.ask("api/parts/XYZ/picture")  # of many readings a fit takes its time
        self.open(server, "fitted|explained")
        lines = lambda name: [self.js(f"document.querySelectorAll('#picture-{name} path.line.{look}').length") for look in ("plus", "minus", "mean")]
        self.wait(lambda: lines("polar") == [1, 1, 2], "both directions, and the model in each")
        self.assertEqual([1, 1, 0], lines("rest"))
        title = self.js("document.querySelector('#picture-polar b').textContent")
        self.assertEqual(title, "Circles, 5 \u00B5m a division")
        for look, low, high in (("plus", 9.2, 11), ("minus", 17.7, 20)):  # G of the sample: 9.2 and 17.8 um
            path = self.js(f"document.querySelector('#picture-polar path.line.{look}').getAttribute('d')")
            numbers = [float(v) for v in re.findall(r"[\d.]+", path)]
            radii = [((x - 160) ** 2 + (y - 160) ** 2) ** 0.5 / 19.5 * 5 for x, y in zip(numbers[::2], numbers[1::2])]
            self.assertEqual(720, len(radii))
            self.assertTrue(low < max(radii) - min(radii) < high, (look, max(radii) - min(radii)))
        self.js("document.querySelector('#picture-polar svg').focus()")
        self.press(Keys.HOME)
        self.assertIn("circle.csv, line", self.js("document.getElementById('tip').innerText"))
        self.assertGreaterEqual(self.js("document.querySelectorAll('figure .chosen').length"), 3, "marked in the others too")
        self.no_complaints()

    def test_circles_of_two_planes_are_drawn_apart(self):
        folder = self.campaign(SOURCE / "samples/site/40-circles")
        manifest = folder / "campaign.toml"
        manifest.write_text(manifest.read_text() + '[[measurement]]\nid = "C2"\nfile = "circle.csv"\nkind = "circle"\nplane = "YZ"\n'
                            "radius_mm = 150\ncentre = { X = 400, Y = 250, Z = 200 }\n")
        server = self.serve(folder)
        server.ask("api/parts/XYZ/picture")
        self.open(server, "fitted|explained")
        picture = "document.querySelector('#picture-polar svg')"
        self.wait(lambda: self.js(f"{picture}.querySelectorAll('path.line.plus').length") == 2)
        self.assertEqual("0 0 320 640", self.js(f"{picture}.getAttribute('viewBox')"))
        self.assertEqual(["+X", "+Y", "+Y", "+Z"], self.js(f"[...{picture}.querySelectorAll('text')].map((t) => t.textContent)"))
        tops = self.js(f"[...{picture}.querySelectorAll('path.line.plus')].map((p) => p.getBBox().y)")
        self.assertTrue(0 < tops[0] < 320 < tops[1] < 640, tops)
        self.no_complaints()

    def test_numbers_of_all_samples_are_those_of_compare_and_explain(self):
        """With the server's own answers, which test live.numbers compares with `nonio model compare` and `explain`."""
        sources = [s for s in sorted((SOURCE / "samples/site").iterdir()) if (s / "campaign.toml").exists()]
        servers = {source: self.serve(self.campaign(source)) for source in sources}
        # Explanations of the large ones take seconds: they are found while the page shows the others.
        slow = threading.Thread(target=lambda: [server.explained() for server in reversed(servers.values())])
        slow.start()
        self.addCleanup(slow.join)
        seen = 0
        for source, server in servers.items():
            explained = server.explained()
            if not explained:
                continue
            self.open(server, "fitted|explained")
            for name, (part, found) in explained.items():
                self.js("[...document.querySelectorAll('#parts button')].find((b) => b.dataset.key === arguments[0]).click()", "part-" + name)
                self.wait(lambda: self.js("(document.querySelector('#parts [aria-pressed=true]') || {dataset: {}}).dataset.key") == "part-" + name)
                self.ready("fitted|explained")
                wanted = part.get("rms_um", part.get("rms_arcsec"))
                self.wait(lambda: abs(self.rms() - wanted) < 1e-9 * max(1, wanted), f"{source.name} {name}: {wanted}")
                wanted = [c["effect"] for c in found["candidates"] if c.get("score", 0) > 0]
                self.wait(lambda: [t.rstrip("?") for t in self.ticks("effects.help")] == wanted, f"{source.name} {name}: {wanted}")
                seen += 1
            self.no_complaints()
        self.assertGreater(seen, 10)


if __name__ == "__main__":
    live_browser.main()
