#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each slip that once went through in silence, with the finding or the refusal that it gets; no table with such a
finding unless the manifest says why."""
import json
import os
import pathlib
import random
import subprocess
import tempfile
import unittest

import mutants
from mutants import HEAD, MANIFEST, POSITION, change_run, copy_pass, copy_run, csv, flip, positions, scaled

NONIO = os.environ["NONIO"]
SEED = 7


class Cases(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="nonio-wrong-")
        self.addCleanup(self._folder.cleanup)
        self.root = pathlib.Path(self._folder.name)
        self.site, self.out = self.root / "site", self.root / "out"
        self.rows = [[r, d, t, float(f"{v:.3f}")] for r, d, t, v in mutants.rows_of(random.Random(SEED))]

    def campaign(self, name, data=None, change=lambda text: text):
        folder = self.site / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "campaign.toml").write_text(change(MANIFEST.format(id=name)))
        data = csv(self.rows) if data is None else data
        (folder / "x.csv").write_bytes(data if isinstance(data, bytes) else data.encode())

    def night(self, *args):
        done = subprocess.run([NONIO, "run", str(self.site), "--out", str(self.out), "--quiet", *args],
                              capture_output=True, text=True, timeout=300)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        self.results = {f.parent.name: json.loads(f.read_text()) for f in self.out.glob("*/results.json")}

    def doubts(self, name):
        content = self.results[name]
        self.assertEqual(content["errors"], [])
        return {f["id"]: f for a in content["analyses"] for f in a["findings"] if f["id"].startswith("plausibility.")}

    def tables(self, name):
        return [f.name for f in (self.out / name).glob("siemens-840d*")]

    def test_readings(self):
        rows, rng = self.rows, random.Random(SEED)
        all_runs = range(1, 6)
        cases = {
            "deviation-grows-with-position": [
                csv(positions(1000.0)(rows, rng), POSITION), csv(positions(25.4)(rows, rng), POSITION),
                csv(positions(1.0, True)(rows, rng), POSITION), csv(scaled()(rows, rng), POSITION)],
            "deviation-below-uncertainty": [csv(scaled(1, 1e-3)(rows, rng), digits=6)],
            "deviation-too-large": [csv(scaled(1, 1e3)(rows, rng), digits=0)],
            "span-against-travel": [csv(scaled(1e-3)(rows, rng), target="{:.6f}"),
                                    csv(scaled(1 / 25.4)(rows, rng), target="{:.5f}")],
            "direction-against-order": [csv(change_run(rows, 4, flip)), csv([flip(r) for r in rows])],
            "directions-swapped": [csv(sorted(change_run(rows, 2, flip), key=lambda r: (r[2], r[1], r[0])))],
            "passes-identical": [
                csv(copy_run(rows, 1, 2)),
                csv([r for k in all_runs for r in copy_pass(rows, (k, "+"), (k, "-")) if r[0] == k])],
            "readings-all-equal": [csv(scaled(1, 0)(rows, rng))],
            "file-cut-short": [csv(rows)[:-2], csv(rows)[:-3]],
            "temperature": [csv([r + [68.0] for r in rows], HEAD + ["material_c"])],
        }
        for finding, files in cases.items():
            for i, data in enumerate(files):
                self.campaign(f"{finding}-{i}", data)
        self.campaign("good")
        self.night()
        self.assertEqual(self.doubts("good"), {})
        self.assertTrue(self.tables("good"))
        for finding, files in cases.items():
            for i in range(len(files)):
                with self.subTest(finding=finding, file=i):
                    name = f"{finding}-{i}"
                    found = self.doubts(name).get("plausibility." + finding)
                    if finding == "deviation-too-large":  # nanometres may also look like a slope
                        found = found or self.doubts(name).get("plausibility.deviation-grows-with-position")
                    self.assertIsNotNone(found, self.doubts(name))
                    self.assertEqual(found["severity"], "attention")
                    self.assertTrue(found["evidence"])
                    self.assertNotIn("{", found["advice"])
                    self.assertEqual(self.results[name]["status"], "attention")
                    self.assertEqual(self.tables(name), [])
                    self.assertIn("table.withheld", json.dumps(self.results[name]))

    def test_manifest(self):
        swap = lambda old, new: lambda text: text.replace(old, new, 1)
        attention = {"unknown-axis": swap('axis = "X"', 'axis = "Z"'), "day-to-come": swap("2026-03-02", "2062-03-02"),
                     "calibrated-later": swap("2026-01-12", "2026-03-03")}
        refused = {"expansion-small": (swap("= 11.5", "= 0.0000115"), 15, "1/K"),
                   "expansion-large": (swap("= 11.5", "= 11500"), 15, "found 11500"),
                   "kelvin": (swap("difference_K = 0.8", "difference_K = 293"), 29, "found 293"),
                   "uncertainty": (swap("U_fixed_um = 0.1", "U_fixed_um = 1e308"), 24, "found 1e+308")}
        for i, (name, change) in enumerate(attention.items()):
            self.rows[0][3] += 0.001  # other files than those of the others
            self.campaign(name, change=change)
        for name, (change, _, _) in refused.items():
            self.campaign(name, change=change)
        self.night()
        for name in attention:
            self.assertIn("plausibility." + name, self.doubts(name))
            self.assertEqual(self.tables(name), [], name)
        for name, (_, line, word) in refused.items():
            error = self.results[name]["errors"][0]
            self.assertEqual((error["file"], error["line"]), ("campaign.toml", line), error)
            self.assertIn("expected", error["message"])
            self.assertIn(word, error["message"])

    def test_air_that_no_shop_has(self):
        self.campaign("air", csv([r + [20.0 if i else -999] for i, r in enumerate(self.rows)], HEAD + ["air_c"]))
        self.night()
        error = self.results["air"]["errors"][0]
        self.assertEqual((error["file"], error["line"], error["column"]), ("x.csv", 2, "air_c"))
        self.assertIn("expected -60 to 150 degC", error["message"])
        self.assertIn("found -999", error["message"])

    def test_a_doubt_about_one_axis_withholds_only_what_is_made_of_it(self):
        axis = ('[machine.axes.Y]\nkind = "linear"\ntravel = [0.0, 1000.0]\nexpansion_um_per_m_K = 11.5\nactive_table = "none"\nactive_backlash_mm = "none"\n'
                '[instrument]')
        lines = "".join(
            f'[[measurement]]\nid = "{id}"\nkind = "{kind}"\n{more}\nfile = "{id}.csv"\n' for id, kind, more in (
                ("Y", "axis", 'axis = "Y"\nat = { X = 0 }'), ("yaw", "angle", 'axis = "X"\nabout = "Z"'),
                ("D1", "diagonal", "from = { X = 0, Y = 0 }\nto = { X = 800, Y = 600 }"),
                ("D2", "diagonal", "from = { X = 0, Y = 600 }\nto = { X = 800, Y = 0 }")))
        manifest = lambda text: text.replace("[instrument]", axis).replace('file = "x.csv"', 'file = "x.csv"\nat = { Y = 0 }').replace(
            "[options.siemens-840d]\n", lines + "[options.siemens-840d]\n").replace('"X number=1"', '"X number=1", "Y number=2"')
        rng = random.Random(SEED + 1)
        spread = lambda rows, step: [[r, d, step * sorted({x[2] for x in rows}).index(t), v] for r, d, t, v in rows]
        mean = lambda rows, at, d: sum(v for r, way, t, v in rows if (way, t) == (d, at)) / 5
        first, other = spread(self.rows, 80.0), spread(mutants.rows_of(rng), 60.0)
        cases = {"sound": other, "doubted": copy_run(other, 1, 2), "good": [[*r[:3], 0.02 * r[3]] for r in other]}
        for name, rows in cases.items():
            first[0][3] += 0.001
            change = lambda text: manifest(text).replace("drift_um = 0.6", f"drift_um = {9 if name == 'good' else 0.6}")
            self.campaign(name, csv(first), change)
            (self.site / name / "Y.csv").write_text(csv([[*r[:3], r[3] + 1e-3 * len(name)] for r in rows]))
            (self.site / name / "yaw.csv").write_text(csv(
                [[r, d, 80.0 * i, rng.gauss(0, 0.02)] for r in range(1, 6) for d in "+-" for i in range(11)[::1 if d == "+" else -1]],
                ["run", "direction", "target_mm", "deviation_arcsec"]))
            for id in ("D1", "D2"):
                (self.site / name / f"{id}.csv").write_text(csv(
                    [[r, d, 100.0 * i, 0.8 * mean(first, 80 * i, d) + 0.6 * (mean(rows, 60 * i, d) if id == "D1" else
                      -mean(rows, 600 - 60 * i, "-+"[d == "-"])) + rng.gauss(0, 0.3)] for r in range(1, 6) for d in "+-"
                     for i in range(11)[::1 if d == "+" else -1]]))
        self.night()
        cross = {f for f in self.tables("sound") if "XY" in f}
        self.assertTrue(cross)
        self.assertEqual(self.doubts("sound"), {})
        self.assertEqual({f for f in self.tables("doubted")}, {f for f in self.tables("sound") if "-X-" in f})
        (withheld,) = [f for t in self.results["doubted"]["tables"] for f in t["findings"] if f["id"] == "table.withheld"]
        self.assertEqual(withheld["evidence"]["measurements"], "D1, D2, Y")
        self.assertEqual(withheld["evidence"]["findings"], "plausibility.passes-identical")
        # A very good axis has a U of ordinary size.
        self.assertEqual(self.doubts("good"), {})
        values = [a["values"]["A"] for a in self.results["good"]["analyses"] if a["plugin"] == "iso230-2" and a["measurement"] == "Y"]
        self.assertGreater(values[0]["U"], 5 * values[0]["value"])

    def test_a_person_says_why(self):
        standing = '[[tables.accept]]\nfinding = "plausibility.{}"\nreason = "the new bearing only"\n'
        short = csv(scaled(1e-3)(self.rows, None), target="{:.6f}")
        self.campaign("one", short, lambda text: text + standing.format("span-against-travel"))
        both = standing.format("span-against-travel") + standing.format("span-against-pitch")
        self.rows[3][3] += 0.001
        self.campaign("both", csv(scaled(1 / 60)(self.rows, None), target="{:.5f}"),
                      lambda text: text + standing.format("span-against-travel"))
        self.rows[3][3] += 0.001
        self.campaign("none", None, lambda text: text + standing.format("span-against-travel"))
        self.rows[3][3] += 0.001
        self.campaign("silent", short.replace("0.0", "0.00", 1),
                      lambda text: text + both.replace("the new bearing only", "-"))
        self.night()
        self.assertEqual(self.tables("one"), [])  # the pitch is still there
        self.assertTrue(self.tables("both"), self.results["both"])
        self.assertIn("plausibility.span-against-travel", self.doubts("both"))
        error = self.results["none"]["errors"][0]
        self.assertEqual(error["file"], "campaign.toml")
        self.assertIn("the readings have no finding plausibility.span-against-travel", error["message"])
        self.assertIn("expected why", self.results["silent"]["errors"][0]["message"])

    def test_file_of_another_campaign(self):
        for name in ("c", "a", "b"):
            self.campaign(name)
        self.rows[0][3] += 0.001
        self.campaign("d")
        self.night()
        of = lambda name: self.doubts(name).get("plausibility.file-of-another-campaign", {}).get("evidence", {})
        self.assertEqual([of(n).get("campaign") for n in "abcd"], ["b", "a", "a", None])
        files = lambda: {f: f.read_bytes() for f in self.out.glob("[a-d]/*")}
        before = files()
        self.night()
        for name in "abcd":  # unchanged, and not done again
            self.assertEqual(json.loads((self.out / name / "run.json").read_text())["night"], 1)
        self.assertEqual(before, files())
        for name in ("b", "c"):
            (self.site / name / "x.csv").write_text(csv(scaled(1, 1.01 if name == "b" else 1.02)(self.rows, None)))
        self.night()
        self.assertEqual([of(n) for n in "abcd"], [{}] * 4)
        self.assertTrue(self.tables("a"))

    def test_unknown_formats(self):
        text = csv(self.rows)
        cases = {"header": (text.split("\n", 1)[1], "header row", "found numbers in its place"),
                 "cr": (text.replace("\n", "\r"), "LF or CRLF", "found a lone CR"),
                 "pipe": (csv(self.rows, separator="|"), "header row", 'found "|" between the names'),
                 "blank": (csv(self.rows, separator=" "), "header row", "found blanks between the names")}
        for name, (data, _, _) in cases.items():
            self.campaign(name, data)
        self.night()
        for name, (_, expected, found) in cases.items():
            error = self.results[name]["errors"][0]
            self.assertEqual((error["file"], error["line"]), ("x.csv", 1))
            self.assertIn(expected, error["message"])
            self.assertIn(found, error["message"])


if __name__ == "__main__":
    unittest.main()
