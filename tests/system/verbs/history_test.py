# SPDX-License-Identifier: Apache-2.0
"""event, ack, forget and query, as a person uses them."""
import csv
import io
import json
import shutil
import sqlite3
import subprocess
import unittest

from verbs import NONIO, VerbTest, manifest, readings

BUDGET = ("[instrument]\nU_fixed_um = 0.2\nU_per_m_um = 0.5\n[environment]\nmisalignment_mm = 0.5\ntemperature_range_K = 0.2\n"
          "temperature_difference_K = 1.0\nexpansion_range_um_per_m_K = 2.0\ndrift_um = 0.4\n")
MACHINE = '[machine]\nasset = "S-0042"\nmaker = "Sample"\nserial = "417"\n'


class HistoryVerbs(VerbTest):
    def setUp(self):
        super().setUp()
        self.out = self.site.parent / "out"

    def write(self, name, day, seed, machine=MACHINE, **effects):
        folder = self.site / name
        folder.mkdir(exist_ok=True)
        text = manifest(campaign_id=name).replace("[machine.axes", machine + "[machine.axes", 1)
        (folder / "campaign.toml").write_text(text.replace(f'id = "{name}"\n', f'id = "{name}"\ndate = {day}\n', 1))
        (folder / "x.csv").write_text(readings(seed=seed, **effects))

    def nonio(self, *args, expect=0):
        done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done

    def night(self, expect=0, date="2026-06-01"):
        return self.nonio("run", self.site, "--out", self.out, "--date", date, expect=expect)

    def event(self, *args, expect=0):
        return self.nonio("machine", "event", self.site, *args, expect=expect)

    def test_query(self):
        self.write("c", "2025-01-02", 1, backlash=4)
        self.write("d", "2026-01-02", 2, backlash=6)
        self.write("e", "2026-02-02", 3, MACHINE.replace("S-0042", "s 0O42"))
        self.night()
        said = self.nonio("machine", "list", self.out).stdout
        self.assertIn('S-0042 and s 0O42 may be one machine: spelled alike', said)
        result = json.loads((self.out / "d" / "results.json").read_text())
        expected = next(a for a in result["analyses"] if a["plugin"] == "iso230-2")["values"]["B_mean"]["value"]
        wanted = ("S-0042", "--quantity", "B_mean", "--source", "iso230-2", "--from", "2026-01-01", "--to", "2026-12-31")
        points = json.loads(self.nonio("machine", "list", self.out, *wanted, "--json").stdout)["points"]
        self.assertEqual([(p["campaign"], p["value"], p["unit"]) for p in points], [("d", expected, "um")])
        rows = list(csv.DictReader(io.StringIO(self.nonio("machine", "list", self.out, *wanted, "--csv").stdout)))
        self.assertEqual([(r["campaign"], float(r["value"])) for r in rows], [("d", expected)])
        self.assertIn(f" {expected:.2f} ", self.nonio("machine", "list", self.out, *wanted).stdout)
        (self.site / "site.toml").write_text('[[alias]]\nname = "s 0O42"\nasset = "S-0042"\nwhy = "same plate"\n')
        self.night()
        everything = self.nonio("machine", "list", self.out, "s 0O42", "--quantity", "B_mean", "--source", "iso230-2", "--json").stdout
        self.assertEqual([p["campaign"] for p in json.loads(everything)["points"]], ["c", "d", "e"])
        self.assertNotIn("may be one machine", self.nonio("machine", "list", self.out).stdout)

    def test_a_renamed_machine_is_listed_once(self):
        self.write("c", "2025-01-02", 1)
        self.write("d", "2025-03-02", 2)
        self.night()
        for name, day, seed in (("c", "2025-01-02", 1), ("d", "2025-03-02", 2)):
            self.write(name, day, seed, MACHINE.replace("S-0042", "M-5"))
        self.night()
        listed = json.loads(self.nonio("machine", "list", self.out, "--json").stdout)["machines"]
        self.assertEqual(listed, [{"machine": "M-5", "campaigns": 2}])
        for refused in (("list", self.out, "S-0042", "--quantity", "A"), ("history", self.out, "S-0042"),
                        ("event", self.site, "--machine", "S-0042", "--kind", "crash", "--text", "hit", "--out", self.out)):
            self.assertIn('no machine "S-0042"', self.nonio("machine", *refused, expect=2).stderr)

    def years(self, stated, tolerance, effects, date="2026-06-01"):
        """One campaign a half-year, with its active backlash value, its tolerances and what it measures."""
        (self.site / "site.toml").write_text('[run]\nanalyses = ["iso230-2"]\noutputs = []\n')
        for k, (value, limit, of) in enumerate(zip(stated, tolerance, effects)):
            name, day = f"c{k}", f"{2022 + k // 2}-0{1 + 6 * (k % 2)}-10"
            self.write(name, day, k + 1, MACHINE + 'control = "siemens-840d"\n', noise=0.1, **of)
            file = self.site / name / "campaign.toml"
            file.write_text(file.read_text().replace('active_backlash_mm = "none"\n', f"active_backlash_mm = {value}\nexpansion_um_per_m_K = 11.5\n{limit}")
                            + BUDGET)
        self.night(date=date)
        lines = json.loads((self.out / "summary.json").read_text())["lines"]
        return [line for line in lines if line["kind"] in ("changed", "out")], lines

    def test_a_reversal_that_follows_the_stated_backlash_value_is_no_fault(self):
        stated, measured = [0.0044] * 5 + ['"none"'], [-0.6] * 5 + [-5.0]
        found, _ = self.years(stated, [""] * 6, [{"backlash": b} for b in measured])
        self.assertEqual(found, [])
        history = self.nonio("machine", "history", self.out, "S-0042", "--axis", "X", "--quantity", "B_mean").stdout
        self.assertIn("another backlash value active", history)

    def test_a_reversal_that_changes_by_more_than_the_stated_value_is_a_fault(self):
        stated, measured = [0.0044] * 5 + ['"none"'], [-0.6] * 5 + [-12.0]
        found, lines = self.years(stated, [""] * 6, [{"backlash": b} for b in measured])
        self.assertEqual([line["kind"] for line in found], ["changed"], lines)

    def test_a_last_value_without_a_limit_is_told_beside_the_judged_one(self):
        limit = "tolerance_um = { B = 8.0 }\n"
        found, lines = self.years(['"none"'] * 4, [limit] * 3 + [""], [{"backlash": b} for b in (-10, -10, -10, -1)])
        said = " ".join(line["says"] for line in found)
        self.assertIn("Did not conform to the tolerance limit of 8.00 um when it was last judged. On 2023-07-10, 1.", said, lines)

    def test_the_date_is_kept_only_if_all_quantities_with_a_limit_keep_it(self):
        """B is steady; A, which has no model of its own, grows beyond its limit before the next date."""
        limit = "tolerance_um = { A = 24.5, B = 8.0 }\n"
        _, lines = self.years(['"none"'] * 7, [limit] * 7, [{"scale": 10.0 * k} for k in range(7)], "2025-02-01")
        series = json.loads(self.nonio("machine", "history", self.out, "S-0042", "--json").stdout)["series"]
        of = {s["quantity"]: s["forecast"] for s in series if s.get("forecast")}
        self.assertNotIn("A", of)  # in JSON no maximum is extrapolated
        self.assertEqual({q: of[q]["answer"] for q in ("B", "scale")}, {"B": "watch", "scale": "keep"})
        said = self.nonio("machine", "history", self.out, "S-0042", "--quantity", "A").stdout
        self.assertRegex(said, r"On 2025-07-\d\d: 2[5-9]\.\d .* um expected, [0-9.]+ % beyond the limit. Act.")
        self.assertEqual([(line["kind"], line["quantity"]) for line in lines if line["kind"] == "soon"], [("soon", "A")], lines)
        self.assertNotIn("Keep the date", self.nonio("machine", "history", self.out, "S-0042").stdout)

    def test_a_value_is_forecast_against_the_limit_of_its_own_measurement(self):
        for k in range(6):
            name, day = f"c{k}", f"{2022 + k // 2}-0{1 + 6 * (k % 2)}-10"
            self.write(name, day, k + 1, noise=0.1, scale=50)
            (self.site / name / "low.csv").write_text(readings(seed=100 + k, noise=0.1, scale=15))
            file = self.site / name / "campaign.toml"
            text = file.read_text().replace('[[measurement]]\nid = "X"\n', '[[measurement]]\nid = "X low"\nkind = "axis"\naxis = "X"\nfile = "low.csv"\n'
                                            'tolerance_um = { A = 9.0 }\n[[measurement]]\nid = "X top"\ntolerance_um = { A = 25.0 }\n')
            file.write_text(text + BUDGET)
        self.night(date="2024-08-01")
        lines = json.loads((self.out / "summary.json").read_text())["lines"]
        self.assertEqual([line for line in lines if line["kind"] in ("soon", "out", "changed")], [])

    def test_the_date_is_kept_where_all_are_steady(self):
        limit = "tolerance_um = { A = 24.5, B = 8.0 }\n"
        _, lines = self.years(['"none"'] * 7, [limit] * 7, [{"scale": 50.0}] * 7, "2025-02-01")
        self.assertEqual([line for line in lines if line["kind"] == "soon"], [])
        self.assertIn("Keep the date", self.nonio("machine", "history", self.out, "S-0042", "--quantity", "A").stdout)

    def test_a_second_crash_after_a_repair_is_a_line(self):
        found, lines = self.years(['"none"'] * 8, [""] * 8, [{"backlash": b} for b in [-0.6] * 3 + [-5.0] + [-0.6] * 3 + [-5.0]])
        self.assertEqual([line["kind"] for line in found], ["changed"], lines)
        self.assertIn("between 2025-01-10 and 2025-07-10", found[0]["says"])

    def test_two_lines_of_an_axis_are_two_series(self):
        """Two measurements of X in each campaign, with other reversals: neither changes."""
        for k in range(8):
            name, day = f"c{k}", f"{2022 + k // 2}-0{1 + 6 * (k % 2)}-10"
            self.write(name, day, k + 1, noise=0.1, backlash=-3.4)
            (self.site / name / "low.csv").write_text(readings(seed=100 + k, noise=0.1, backlash=-2.1))
            file = self.site / name / "campaign.toml"
            text = file.read_text().replace('[[measurement]]\nid = "X"\n', '[[measurement]]\nid = "X-low"\nkind = "axis"\naxis = "X"\nfile = "low.csv"\n'
                                            '[[measurement]]\nid = "X-high"\n')
            file.write_text(text + BUDGET)
        self.night()
        series = [s for s in json.loads(self.nonio("machine", "history", self.out, "S-0042", "--json").stdout)["series"]
                  if s["quantity"] == "B_mean"]
        self.assertEqual({s["line"]: (s["model"], len(s["points"]), s["changes"]) for s in series},
                         {"X-low": ("level", 8, []), "X-high": ("level", 8, [])})
        said = self.nonio("machine", "history", self.out, "S-0042", "--quantity", "B_mean").stdout
        self.assertIn("X X-high  ", said)

    def test_a_repair_that_did_not_help_closes_no_line(self):
        event = '[[event]]\nmachine = "S-0042"\ndate = {}\nkind = "{}"\naxis = "X"\ntext = "{}"\n'
        (self.site / "events.toml").write_text(event.format("2024-02-01", "crash", "hit the vice")
                                               + event.format("2024-08-01", "repair", "new nut"))
        for after, kinds in ((-5.0, ["changed"]), (-0.6, [])):
            shutil.rmtree(self.out, ignore_errors=True)
            found, lines = self.years(['"none"'] * 7, [""] * 7, [{"backlash": b} for b in [-0.6] * 5 + [-5.0, after]])
            self.assertEqual([line["kind"] for line in found], kinds, lines)

    def test_a_limit_that_was_lowered_is_no_change_of_the_machine(self):
        limits = ["tolerance_um = { B = 8.0 }\n"] * 4 + ["tolerance_um = { B = 1.2 }\n"]
        found, lines = self.years(['"none"'] * 5, limits, [{"backlash": -3.0}] * 5)
        self.assertEqual(len(found), 1, lines)
        self.assertIn("would to the limit of 8.00 um that campaign c3 states", found[0]["says"])

    def test_query_says_what_is_wrong(self):
        self.assertIn("nonio run SITE", self.nonio("machine", "list", self.site, expect=2).stderr)
        self.write("c", "2025-01-02", 1)
        self.night()
        for args, words in ((("S-042",), 'nearest: "S-0042"'), (("--axis", "Q"), 'no axis "Q"'),
                            (("--quantity", "B_maen"), 'nearest: "B_mean"'), (("--from", "2026-13-01"), "expected a day")):
            self.assertIn(words, self.nonio("machine", "list", self.out, *args, expect=2).stderr)

    def test_events(self):
        self.write("c", "2025-01-02", 1)
        self.night()
        one = ("--machine", "S-0042", "--kind", "crash", "--text", 'hit "the" vice, 4 µm', "--date", "2025-03-04")
        self.event(*one, "--axis", "Q", "--out", self.out, expect=2)
        self.assertIn("S-0042", self.event(*one[:1], "S-0O42", *one[2:], "--out", self.out, expect=2).stderr)
        self.assertFalse((self.site / "events.toml").exists())
        self.event(*one)
        self.event("--machine", "S-0042", "--kind", "repair", "--text", "new nut", "--by", "B. Sample")
        self.assertIn('2025-03-04  S-0042  crash  hit "the" vice, 4 µm', self.event().stdout)
        self.assertEqual(len(json.loads(self.event("--json").stdout)["events"]), 2)
        self.night()
        kept = sqlite3.connect(self.out / "history.sqlite").execute("SELECT day, kind, note FROM event ORDER BY item").fetchall()
        self.assertEqual(kept[0], ("2025-03-04", "crash", 'hit "the" vice, 4 µm'))
        before = (self.site / "events.toml").read_bytes()
        self.assertIn("one line", self.event(*one[:5], "a\nb", expect=2).stderr)
        self.assertIn("--kind", self.event("--text", "x", expect=2).stderr)
        self.assertEqual((self.site / "events.toml").read_bytes(), before)

    def test_ack(self):
        args = ["ack", self.site, "--finding", "reversal.constant", "--machine", "S-0042", "--by", "B", "--why", "nut is ordered",
                "--date", "2026-03-04"]
        self.nonio(*args, "--until", "2026-06-30", "--value", "-5.25", "--U", "0.4", "--quantity", "B_mean")
        self.assertIn("until = 2026-06-30\nvalue = -5.25\nU = 0.4\n", (self.site / "acknowledged.toml").read_text())
        self.assertIn("not before", self.nonio(*args, "--until", "2026-01-01", expect=2).stderr)
        self.assertIn("decimal point", self.nonio(*args, "--until", "2026-06-30", "--value", "5,2", expect=2).stderr)

    def test_forget(self):
        self.write("c", "2025-01-02", 1)
        self.write("d", "2025-01-03", 2)
        self.night()
        for path in (self.site / "d").iterdir():
            path.unlink()
        (self.site / "d").rmdir()
        self.assertIn("d has vanished", self.night(expect=1).stderr)
        (self.site / "site.toml").write_text("[limits]\nmissing_campaigns = 1\n")
        self.night()
        (self.site / "site.toml").write_text("# all limits are removed\n")
        self.night(expect=1)
        remove = ("machine", "remove", self.site, "--out", self.out, "--by", "B", "--why", "sold")
        self.assertIn('does not miss "c"', self.nonio(*remove, "d", "c", expect=2).stderr)
        self.assertFalse((self.site / "forgotten.toml").exists())
        self.nonio(*remove, "d")
        self.assertNotIn("vanished", self.night().stderr)


if __name__ == "__main__":
    unittest.main()
