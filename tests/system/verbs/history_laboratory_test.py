# SPDX-License-Identifier: Apache-2.0
"""`nonio machine history` of samples/laboratory, against what is true of it and against results.json."""
import json
import math
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest

NONIO = os.environ["NONIO"]
ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "support" / "laboratory"))
import presets  # noqa: E402 (this folder is no package)
import score  # noqa: E402
import make_laboratory  # noqa: E402
import truth as truths  # noqa: E402


def nonio(*args, expect=0):
    done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=300)
    if done.returncode != expect:
        raise AssertionError(f"{args}: status {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done


class Laboratory(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="nonio-history-")
        above = pathlib.Path(cls.folder.name)
        cls.out, cls.site = above / "out", above / "site"
        lab = presets.build("small", 1)
        cls.truth = truths.rounded(make_laboratory.write(lab, cls.site, lab.night, True))
        nonio("run", cls.site, "--out", cls.out, "--quiet", "--date", "2026-11-22")
        cls.text = nonio("machine", "history", cls.out, "--json").stdout
        cls.history = json.loads(cls.text)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def series(self, machine, axis, quantity):
        return [s for s in self.history["series"] if (s["machine"], s["axis"], s["quantity"]) == (machine, axis, quantity)]

    def changes(self, machine):
        return [(s["axis"], s["quantity"], c["after"], c["before"], c["cause"]) for s in self.history["series"]
                if s["machine"] == machine for c in s.get("changes", [])]

    def test_the_schema_by_the_letter(self):
        self.assertEqual((self.history["schema"], self.history["night"], self.history["vanished"]), ("nonio-history/1", 1, []))
        self.assertEqual({m["machine"] for m in self.history["machines"]}, {s["machine"] for s in self.history["series"]})
        for m in self.history["machines"]:
            self.assertEqual(set(m), {"machine", "next_due", "proposal"})
        for s in self.history["series"]:
            for p in s["points"]:
                self.assertLessEqual({"campaign", "date", "state", "value", "u", "u_common", "joined"}, set(p))
                self.assertIn(p["state"], ("as-found", "as-left", "check"))
                self.assertTrue(p["joined"] or p["why_not"])
            if "model" not in s:  # a maximum: nothing is drawn through it
                self.assertFalse({"segments", "changes", "smallest_change"} & set(s))
                continue
            self.assertIn(s["model"], ("none", "level", "drift", "step", "walk"))
            for g in s["segments"]:
                self.assertEqual(set(g), {"from", "to", "value", "u", "slope_per_year", "u_slope"})
            for c in s["changes"]:
                self.assertEqual(set(c), {"after", "before", "size", "u", "p", "p_adjusted", "cause", "event"})
                self.assertIn(c["cause"], ("undeclared", "event", "instrument", "table"))
                self.assertLessEqual(c["p"], c["p_adjusted"])
            if s["forecast"]:
                self.assertEqual(set(s["forecast"]), {"date", "value", "u", "limit", "p_out", "leaves", "answer"})
                self.assertIn(s["forecast"]["answer"], ("keep", "watch", "watch-now", "act", "overdue", "passed", "cannot-say"))
                self.assertEqual(s["forecast"]["value"] is None, s["forecast"]["answer"] == "cannot-say")

    def test_numbers_are_those_of_the_results(self):
        seen = 0
        for s in self.history["series"]:
            for p in s["points"]:
                results = json.loads((self.out / p["campaign"] / "results.json").read_text())
                if "model" in s:
                    here = [(f["value"], f["u"]) for f in results["followed"] if (f["axis"], f["quantity"]) == (s["axis"], s["quantity"])]
                    self.assertIn((p["value"], p["u"]), here)
                else:
                    self.assertIn(p["value"], [a["values"][s["quantity"]]["value"] for a in results["analyses"]
                                               if s["quantity"] in a.get("values", {})])
                seen += 1
        self.assertGreater(seen, 1500)

    def test_what_is_true_is_named(self):
        total = score.Score()
        total.add(self.truth, [self.history])
        self.assertEqual(total.fails(), [], total.text())
        self.assertEqual(total.steps["all"].hits, total.steps["all"].of, total.text())
        self.assertGreaterEqual(total.steps["all"].of, 11)
        self.assertEqual(total.causes.hits, total.causes.of, total.text())

    def test_the_stories(self):
        self.assertEqual(self.changes("LAB-01"), [])
        self.assertIn(("X", "B_mean", "2025-07-lab-02", "2026-01-lab-02", "undeclared"), self.changes("LAB-02"))
        self.assertEqual({c[4] for c in self.changes("LAB-03") if c[1] == "B_mean"}, {"event"})
        self.assertIn(("X", "scale", "2025-01-lab-05", "2025-01-lab-05", "table"), self.changes("LAB-05"))
        self.assertEqual({c[4] for c in self.changes("LAB-06") if c[1] == "scale"} - {"instrument"}, set())
        self.assertEqual(len(self.series("LAB-10", "X2", "B_mean")), 1)
        (joined,) = self.series("LAB-09", "X", "scale")  # another stretch: compared over what both have in common
        self.assertTrue(all(p["joined"] for p in joined["points"]))
        self.assertEqual(joined["compared_over"]["unit"], "mm")

    def test_made_again_it_is_the_same(self):
        (self.out / "history.sqlite").unlink()
        nonio("run", self.site, "--out", self.out, "--quiet", "--date", "2026-11-22")
        again = json.loads(nonio("machine", "history", self.out, "--json").stdout)
        self.assertEqual(again["series"], self.history["series"])

    def test_a_store_that_is_behind_is_said(self):
        self.assertEqual(nonio("machine", "history", self.out).stderr, "")
        known = self.out / ".nonio" / "history"
        text = known.read_text()
        known.unlink()
        self.addCleanup(known.write_text, text)
        self.assertIn("may lack results of run", nonio("machine", "history", self.out).stderr)

    def test_on_a_terminal(self):
        table = nonio("machine", "history", self.out).stdout.splitlines()
        self.assertEqual(table[0].split()[0], "Machine")
        self.assertEqual(len(table), 1 + len(self.history["machines"]))
        said = nonio("machine", "history", self.out, "LAB-02", "--axis", "X", "--quantity", "B_mean").stdout
        self.assertRegex(said, r"2025-07-14 .*\n +~ -4\.\d+ ± 0\.\d+ um, p < 0\.0001: changed; no event is known\n +2026-01-24")
        said = nonio("machine", "history", self.out, "LAB-03", "--axis", "Z", "--quantity", "B_mean").stdout
        self.assertIn("* crash: Drove into the pallet", said)
        self.assertIn("Slope: ", said)
        said = nonio("machine", "history", self.out, "LAB-01", "--axis", "X", "--quantity", "B_mean").stdout
        self.assertRegex(said, r"No change without a known event. Detection limit: 0\.\d+ um")
        self.assertIn('nearest: "LAB-01"', nonio("machine", "history", self.out, "LAB-O1", expect=2).stderr)
        self.assertIn("nonio run", nonio("machine", "history", self.site, expect=2).stderr)
        one = json.loads(nonio("machine", "history", self.out, "LAB-02", "--json").stdout)
        self.assertEqual({s["machine"] for s in one["series"]}, {"LAB-02"})

    def test_the_scatter_is_a_scatter_and_its_change_a_factor(self):
        said = nonio("machine", "history", self.out, "LAB-04", "--axis", "X", "--quantity", "ln_s").stdout
        self.assertIn("X  Scatter of the readings (ln_s), um: ", said)
        known = {s["machine"]: s for s in self.history["series"] if s["axis"] == "X" and s["quantity"] == "ln_s"}["LAB-04"]
        for p in known["points"]:
            low, s, high = (math.exp(p["value"] + k * p["u"]) for k in (-2, 0, 2))
            self.assertRegex(said, rf"{p['date']}  as \w+ +{s:.3f} \({low:.3f} to {high:.3f}\)")
        self.assertEqual(1, len(known["changes"]))
        factor = math.exp(known["changes"][0]["size"])
        self.assertIn(f"~ a factor of {factor:.2f} (", said)
        lines = json.loads(nonio("status", "--actions", self.out, "--json", expect=1).stdout)["lines"]
        says = " ".join(line["says"] for line in lines if (line.get("machine"), line.get("axis")) == ("LAB-04", "X"))
        self.assertIn(f"Scatter changed by a factor of {factor:.2f} (", says)
        turning = nonio("machine", "history", self.out, "LAB-11", "--axis", "C", "--quantity", "ln_s").stdout
        self.assertIn("(ln_s), arcsec: ", turning)

    def test_lines_fit_100_columns(self):
        shown = nonio("machine", "history", self.out).stdout
        for m in self.history["machines"]:
            shown += nonio("machine", "history", self.out, m["machine"]).stdout
        self.assertEqual([], [line for line in shown.split("\n") if len(line) > 100])

    def test_the_store_keeps_when_machines_are_due(self):
        site, out = self.site.parent / "due", self.site.parent / "due-out"
        shutil.copytree(self.site / "LAB-11", site / "LAB-11")
        shutil.copy(self.site / "events.toml", site)
        (site / "site.toml").write_text('[[due]]\nmonths = 12\n[[due]]\nmachine = "LAB-11"\nmonths = 6\n')
        nonio("run", site, "--out", out, "--quiet", "--date", "2026-11-22")
        self.assertEqual(json.loads(nonio("machine", "history", out, "--json").stdout)["machines"][0]["next_due"][:7], "2026-01")
        kept = sqlite3.connect(out / "history.sqlite").execute("SELECT * FROM due_rule ORDER BY machine").fetchall()
        self.assertEqual(kept, [("", 12), ("LAB-11", 6)])

    def test_what_is_out_names_the_event_of_its_jump(self):
        site, out = self.site.parent / "said", self.site.parent / "said-out"
        shutil.copytree(self.site / "LAB-02", site / "LAB-02")
        nonio("machine", "event", site, "--machine", "LAB-02", "--axis", "X", "--kind", "crash", "--date", "2025-10-14", "--text", "tool in the chuck")
        nonio("run", site, "--out", out, "--quiet", "--date", "2026-11-22")
        lines = json.loads(nonio("status", "--actions", out, "--json", expect=1).stdout)["lines"]
        says = [line["says"] for line in lines if (line["kind"], line["machine"], line["axis"]) == ("out", "LAB-02", "X")]
        self.assertEqual(len(says), 1)
        self.assertIn("between 2025-07-14 and 2026-01-24: crash: tool in the chuck", says[0])

    def with_table(self, name, left):
        """LAB-05 until its table was loaded, which Nonio wrote; `left` changes a deviation found into one left."""
        site, out = self.site.parent / name, self.site.parent / (name + "-out")
        for campaign in ("2024-01-lab-05", "2024-07-lab-05", "2025-01-lab-05"):
            shutil.copytree(self.site / "LAB-05" / campaign, site / campaign)
        (site / "site.toml").write_text('[run]\nanalyses = ["iso230-2"]\noutputs = ["siemens-840d"]\n')
        if left:
            folder = site / "2025-01-lab-05"
            rows = (folder / "x-found.csv").read_text().splitlines(keepends=True)
            changed = [",".join(f"{left * float(f):.2f}" if i == 3 else f for i, f in enumerate(row.split(","))) if row[:1].isdigit() else row
                       for row in rows]
            (folder / "x-left.csv").write_text("".join(changed))
        nonio("run", site, "--out", out, "--quiet", "--date", "2025-02-01")
        lines = json.loads(nonio("status", "--actions", out, "--json", expect=1).stdout)["lines"]  # the table that was on is not stated
        predictions = {p["name"]: p["predicted"] for t in json.loads((out / "2025-01-lab-05" / "results.json").read_text())["tables"]
                       for p in t.get("predictions", [])}
        return [line for line in lines if line["id"].startswith("worklist.table")], predictions, (out / "machines" / "LAB-05.html").read_text()

    def test_a_good_table_is_said_to_be_good(self):
        lines, predictions, page = self.with_table("good-table", None)
        self.assertEqual(lines, [])
        self.assertIn(f"5.258 µm as found, {predictions['B']:.3f} µm predicted, ", page)
        self.assertIn("The difference from the prediction is not significant.", page)

    def test_a_table_with_the_wrong_sign_is_a_decision(self):
        lines, _, page = self.with_table("wrong-sign", 2.0)
        self.assertEqual([(line["kind"], line["machine"], line["axis"]) for line in lines], [("changed", "LAB-05", "X")])
        self.assertIn("did not have the predicted effect", lines[0]["says"])
        self.assertIn("It differs significantly from the prediction.", page)

    def test_a_table_that_was_not_loaded_is_a_decision(self):
        lines, _, _ = self.with_table("not-loaded", 0.97)
        self.assertEqual(len(lines), 1)

    def test_a_machine_has_a_proposal_or_a_reason(self):
        for m in self.history["machines"]:
            self.assertEqual(set(m["proposal"]), {"months", "method", "why"})
            self.assertIn(m["proposal"]["method"], ("staircase", "control-chart", "fleet"))
            self.assertTrue(m["proposal"]["why"])
            self.assertEqual(m["proposal"]["months"] is None, m["proposal"]["why"].startswith("No proposal"))
            self.assertNotIn("{", m["proposal"]["why"])
            page = "".join(p.read_text() for p in (self.out / "machines").glob(m["machine"].replace(" ", "_") + "*"))
            self.assertIn(m["proposal"]["why"].replace(" um ", " µm "), page.replace("&#39;", "'"))
        proposals = {m["machine"]: m["proposal"] for m in self.history["machines"]}
        self.assertIsNone(proposals["LAB-02"]["months"])  # out of its tolerance now: no date helps
        self.assertIn("beyond its limit", proposals["LAB-02"]["why"])
        self.assertEqual(proposals["LAB-01"]["months"], 12)  # as its rule states: nothing speaks against it

    def test_a_value_has_one_U_in_all_views(self):
        points = [p for s in self.history["series"] if s["quantity"] == "B_mean" for p in s["points"]]
        self.assertTrue(points)
        for p in points:
            results = json.loads((self.out / p["campaign"] / "results.json").read_text())
            stated = [a["values"]["B_mean"]["U"] for a in results["analyses"] if "U" in a.get("values", {}).get("B_mean", {})
                      and abs(a["values"]["B_mean"]["value"] - p["value"]) < 1e-9]
            self.assertIn(round(p["U"], 9), [round(U, 9) for U in stated], p)
        rows = json.loads(nonio("machine", "list", self.out, "LAB-02", "--axis", "X", "--quantity", "B_mean", "--json").stdout)["points"]
        for campaign in {r["campaign"] for r in rows}:
            self.assertEqual(len({round(r["U"], 9) for r in rows if r["campaign"] == campaign}), 1, rows)

    def test_nothing_keeps_the_date_of_an_axis_that_is_out(self):
        out = {(line["machine"], line["axis"]) for line in json.loads(nonio("status", "--actions", self.out, "--json", expect=1).stdout)["lines"]
               if line["kind"] == "out"}
        self.assertIn(("LAB-02", "X"), out)
        for s in self.history["series"]:
            if (s["machine"], s["axis"]) in out and s.get("forecast"):
                self.assertEqual(s["forecast"]["answer"], "act", s["quantity"])
            if s["quantity"] == "B_mean" and s.get("forecast"):
                self.assertIsNone(s["forecast"]["limit"])

    def test_another_edition_is_not_joined(self):
        for quantity in "AER":
            points = self.series("LAB-09", "X", quantity)[0]["points"]
            self.assertEqual([p.get("why_not") for p in points], ["edition"] * 3 + [None] * 5, quantity)

    def test_what_vanished_is_named_and_stays(self):
        site, out = self.site.parent / "less", self.site.parent / "less-out"
        for name in ("LAB-01", "LAB-02"):
            shutil.copytree(self.site / name, site / name)
        nonio("run", site, "--out", out, "--quiet", "--date", "2026-11-21")
        shutil.rmtree(site / "LAB-02")
        nonio("run", site, "--out", out, "--quiet", "--date", "2026-11-22", expect=1)
        told = json.loads(nonio("machine", "history", out, "--json").stdout)
        self.assertEqual(len(told["vanished"]), 8)
        self.assertEqual({v["last_seen_night"] for v in told["vanished"]}, {1})
        self.assertTrue(all(v["folder"].startswith("LAB-02/") for v in told["vanished"]))
        self.assertIn("LAB-02", [m["machine"] for m in told["machines"]])


if __name__ == "__main__":
    unittest.main()
