# SPDX-License-Identifier: Apache-2.0
"""A measuring method that the tree does not have: `nonio plugin new method`, built against the package, in every verb."""
import csv
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "live"))
import live

NONIO = os.environ["NONIO"]
MEANS = [2, 4, 10, 8, 6]  # um, of the gauge


def manifest(**changes):
    measurement = {"id": "X", "kind": "lever-gauge", "axis": "X", "ratio": 0.5, "file": "x.csv", **changes}
    lines = [f"{key} = {json.dumps(value)}" for key, value in measurement.items() if value is not None]
    return "\n".join(["format = 1", "[campaign]", 'id = "a"', "date = 2026-03-02", "[machine]", 'asset = "M-1"',
                      "[machine.axes.X]", 'kind = "linear"', "travel = [0.0, 500.0]", "[[measurement]]", *lines,
                      "[run]", 'outputs = ["json", "csv", "pdf-report"]', ""])


def readings(shift=0.0):
    rows = ["direction,target_mm,gauge_um"]
    for off in (2, -2, 2):
        for way in "+-":
            for k in range(5) if way == "+" else range(4, -1, -1):
                rows.append(f"{way},{100 * k},{MEANS[k] + off + shift + (way == '-') * 20}")
    return "\n".join(rows) + "\n"


class ForeignMethod(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="nonio-method-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.work = pathlib.Path(cls.folder.name)
        subprocess.run([NONIO, "plugin", "new", "method", "lever-gauge"], cwd=cls.work, check=True, capture_output=True)
        cls.plugins = cls.build(cls.work / "lever-gauge")

    @staticmethod
    def build(plugin):
        cmake = os.environ["NONIO_CMAKE"]
        for command in ([cmake, "-S", plugin, "-B", plugin / "build", "-G", "Ninja",
                         f"-DCMAKE_PREFIX_PATH={os.environ['NONIO_PACKAGE']}",
                         f"-DCMAKE_CXX_COMPILER={os.environ['NONIO_COMPILER']}"],
                        [cmake, "--build", plugin / "build"]):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stdout + done.stderr
        return plugin / "build"

    @classmethod
    def plugins_with(cls, name, statement):
        """The plugin, built again as a method that also declares something."""
        plugin = cls.work / name
        shutil.copytree(cls.work / "lever-gauge", plugin, ignore=shutil.ignore_patterns("build"))
        source = next(plugin.glob("*.cpp"))
        text = source.read_text()
        assert '  // m.observed_as = "axis"' in text
        source.write_text(text.replace('  // m.observed_as = "axis"', "  " + statement + " //"))
        return cls.build(plugin)

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-method-site-")
        self.addCleanup(folder.cleanup)
        self.site = pathlib.Path(folder.name) / "site"
        self.out = pathlib.Path(folder.name) / "out"

    def campaign(self, text, rows=None):
        folder = self.site / "a"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "campaign.toml").write_text(text)
        (folder / "x.csv").write_text(readings() if rows is None else rows)
        return folder

    def nonio(self, *arguments, status=0, plugins=None):
        done = subprocess.run([NONIO, *map(str, arguments), "--plugin-path", plugins or self.plugins], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def refusal(self, text, rows=None):
        self.campaign(text, rows)
        self.nonio("run", self.site, "--out", self.out, status=1)
        return json.loads((self.out / "a/results.json").read_text())["errors"][0]

    def test_a_run_with_its_report_and_tables(self):
        self.campaign(manifest())
        self.nonio("run", self.site, "--out", self.out)
        results = json.loads((self.out / "a/results.json").read_text())
        analysis = next(a for a in results["analyses"] if a["plugin"] == "lever-gauge")
        value = analysis["values"]["range"]
        self.assertAlmostEqual(value["value"], 4.0, places=6)  # half of 10 - 2 um
        self.assertGreater(value["U"], 0.0)
        self.assertEqual(analysis["budget"]["contributions"][0]["id"], "repetition")
        with open(self.out / "a/values.csv") as file:
            self.assertIn(("lever-gauge", "range"), {(r["plugin"], r["name"]) for r in csv.DictReader(file)})
        self.assertTrue((self.out / "a/a.pdf").exists() or list((self.out / "a").glob("*.pdf")))

    def test_mistakes_are_answered_with_the_nearest_name(self):
        for changes, wanted in (
                ({"ratio": None, "ratoi": 0.5}, r'unknown key measurement\.ratoi \(nearest: "ratio"\)'),
                ({"kind": "lever-gage"}, r'measurement\.kind: expected one of angle, .*, lever-gauge, .*nearest: "lever-gauge"'),
                ({"ratio": "half"}, r"measurement\.ratio: expected a number, found a text"),
                ({"ratio": 0}, r"measurement\.ratio: expected a ratio from 0\.001 to 1000; found 0"),
                ({"axis": None}, r'measurement\.axis: is missing: the axis that moves, "X"'),
                ({"lateral": "Y"}, r"unknown key measurement\.lateral")):
            with self.subTest(changes):
                self.assertRegex(self.refusal(manifest(**changes))["message"], wanted)

    def test_mistakes_in_the_file(self):
        for rows, wanted, line in (
                (readings().replace("gauge_um", "gage_um"), 'unknown column "gage_um"; did you mean "gauge_um"', 1),
                (readings().replace(",gauge_um", ""), 'missing column: expected "gauge_um", found direction, target_mm', 1),
                (readings().replace("100,", "one,", 1), 'expected a number, found "one"', 3),
                (readings().replace(",6", ",600000", 1), "expected a reading of the gauge in um, up to 100 mm", 0)):
            with self.subTest(wanted):
                error = self.refusal(manifest(), rows)
                self.assertIn(wanted, error["message"])
                self.assertEqual(error["file"], "x.csv")
                if line:
                    self.assertEqual(error["line"], line)

    def test_effects_are_compared_and_explained(self):
        folder = self.campaign(manifest())
        self.assertIn("axis X (measurement X): 30 readings", self.nonio("model", "compare", folder))
        self.assertRegex(self.nonio("model", "explain", folder), r"backlash")

    def test_effects_do_not_apply_where_no_axis_moved(self):
        plugins = self.plugins_with("apart", "m.motion = nonio::Measurement::Motion::none;")
        self.assertIn("this campaign has other readings: lever-gauge",
                      self.nonio("model", "compare", self.campaign(manifest()), plugins=plugins, status=1))

    def test_the_history_has_its_values(self):
        self.campaign(manifest())
        self.nonio("run", self.site, "--out", self.out)
        with sqlite3.connect(self.out / "history.sqlite") as history:
            rows = history.execute("SELECT quantity, value FROM result WHERE source = 'lever-gauge'").fetchall()
        self.assertEqual([(q, round(v, 6)) for q, v in rows], [("range", 4.0)])
        self.nonio("machine", "history", self.out, "M-1")

    def test_the_live_page_has_its_measurement(self):
        folder = self.campaign(manifest())
        with live.Server(folder, "--plugin-path", self.plugins) as server:
            state = server.opened()
            self.assertEqual([part["name"] for part in state["parts"]], ["X"])

    def test_a_simulated_campaign_is_explained(self):
        spec = self.site.parent / "spec.toml"
        spec.write_text(manifest() + "\n".join([
            "[simulation]", "seed = 3", "[[cycle]]", 'measurement = "X"', "from_mm = 0", "to_mm = 500", "step_mm = 25",
            "runs = 5", "feed_mm_per_min = 2000", "noise_um = 0.2", "[[effect]]", 'name = "backlash:X"', "b_um = 9", ""]))
        self.nonio("model", "simulate", spec, "--out", self.site / "a")
        header = (self.site / "a/x.csv").read_text().splitlines()[1]
        self.assertEqual(header, "target_mm,direction,gauge_um")
        self.nonio("run", self.site, "--out", self.out)
        self.assertRegex(self.nonio("model", "explain", self.site / "a"), r"backlash:X")

    def test_the_schema_has_its_keys(self):
        measurement = json.loads(self.nonio("schema", "campaign"))["properties"]["measurement"]["items"]
        self.assertIn("lever-gauge", measurement["properties"]["kind"]["enum"])
        self.assertEqual(measurement["properties"]["ratio"]["minimum"], 0.001)

    def test_a_method_that_observes_an_axis_is_evaluated_as_one(self):
        plugins = self.plugins_with("as-axis", 'm.observed_as = "axis";')
        self.campaign(manifest().replace("[[measurement]]", 'active_table = "none"\nactive_backlash_mm = "none"\n[[measurement]]').replace(
            'outputs = ["json"', 'outputs = ["linuxcnc", "json"'))
        self.nonio("run", self.site, "--out", self.out, plugins=plugins)
        results = json.loads((self.out / "a/results.json").read_text())
        iso = next(a for a in results["analyses"] if a["plugin"] == "iso230-2")
        # The gauge reads 20 um more in one direction; its lever halves that.
        self.assertAlmostEqual(iso["values"]["B"]["value"], 10.0, places=6)
        self.assertAlmostEqual(iso["values"]["M"]["value"], 4.0, places=6)
        self.assertIn("linuxcnc", {o["plugin"] for o in results["outputs"]})
        self.assertEqual(json.loads((self.out / "a/readings.json").read_text())["measurements"][0]["kind"], "lever-gauge")
        with sqlite3.connect(self.out / "history.sqlite") as history:
            followed = {q for q, in history.execute("SELECT quantity FROM result")}
        self.assertIn("B_mean", followed)
        words = self.nonio("plugin", "check", plugins, "--cases", self.work / "lever-gauge/cases", "--json", plugins=plugins)
        checks = {(c["plugin"], c["check"]): c["state"] for c in json.loads(words[:words.rindex("}") + 1])["checks"]}
        self.assertEqual(checks["method lever-gauge", "observed-kind"], "passed")

    def test_its_checks(self):
        words = self.nonio("plugin", "check", self.plugins, "--cases", self.work / "lever-gauge/cases", "--json")
        checks = {(c["plugin"], c["check"]): c["state"] for c in json.loads(words[:words.rindex("}") + 1])["checks"]}
        for name in ("names", "keys", "columns", "round-trip", "malformed", "pure"):
            self.assertEqual(checks["method lever-gauge", name], "passed", name)


if __name__ == "__main__":
    unittest.main()
