#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The scorer on histories that are right, and on ones that are wrong in one way each: it must see each of them, and only it."""
import copy
import datetime
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import make_laboratory  # noqa: E402 (this folder is no package)
import plain  # noqa: E402
import presets  # noqa: E402
import pulls  # noqa: E402
import score  # noqa: E402
import truth as truths  # noqa: E402
from parts import Noise  # noqa: E402

SCORE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "score.py")


def truth_of(preset, seed, **sizes):
    lab = presets.build(preset, seed, **sizes)
    with tempfile.TemporaryDirectory() as folder:
        return truths.rounded(make_laboratory.write(lab, pathlib.Path(folder) / "site", lab.night))


def told(truth, noise=None):
    """What a program would tell that knew everything; `noise`: with its uncertainty."""
    out = []
    for s in truth["series"]:
        changes = []
        for c in truth["changes"]:
            step = c["quantities"].get(s["quantity"]) if (c["machine"], c["axis"]) == (s["machine"], s["axis"]) else None
            if step and c["comparable"] and step["in_u"] >= score.LEAST:
                cause = "event" if c["declared"] else "table" if c["compensated"] else "undeclared"
                changes.append({"after": c["after"], "before": c["before"], "size": step["size"] + blur(noise, step["u"]), "u": step["u"],
                                "p": 1e-9, "p_adjusted": 1e-7, "cause": cause})
        segments = [{"from": g["from"], "to": g["to"], "value": 0.0, "u": 0.1, "slope_per_year": g["slope_per_year"] + blur(noise, 0.1),
                     "u_slope": 0.1} for g in s["segments"]]
        date, value = s["later"][2] if s["later"] else (None, None)  # it is no longer measured
        out.append({"machine": s["machine"], "axis": s["axis"], "quantity": s["quantity"], "unit": "um", "points": [], "model": "drift",
                    "segments": segments, "changes": changes, "smallest_change": 1.0,
                    "forecast": {"date": date, "value": value + blur(noise, 0.2), "u": 0.2, "answer": "keep"} if date else None})
    return {"schema": "nonio-history/1", "night": 1, "series": out, "machines": [], "vanished": copy.deepcopy(truth["vanished"])}


def blur(noise, u):
    return u * noise.normal() if noise else 0.0


def scored(truth, *nights):
    result = score.Score()
    result.add(truth, nights)
    return result


class OfKnownSites(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.truth = truth_of("mixed", 3)
        cls.quiet = truth_of("quiet", 4, machines=3)

    def setUp(self):
        self.history = told(self.truth)

    def first_change(self):
        s = next(s for s in self.history["series"] if s["changes"] and s["changes"][0]["cause"] == "undeclared")
        return s, s["changes"][0]

    def neighbours(self, s):
        points = next(t["points"] for t in self.truth["series"] if all(t[k] == s[k] for k in ("machine", "axis", "quantity")))
        ids = [p["campaign"] for p in points]
        return ids

    def test_a_right_history_has_no_fault(self):
        result = scored(self.truth, self.history)
        self.assertGreater(result.steps["all"].of, 5)
        self.assertEqual(result.steps["all"].hits, result.steps["all"].of)
        self.assertEqual((result.false, result.blamed, result.vanished_wrong), ([], [], []))
        self.assertEqual(result.causes.hits, result.causes.of)
        self.assertGreater(result.vanished.of, 0)
        self.assertEqual(result.vanished.hits, result.vanished.of)
        self.assertGreater(result.instruments.of, 0)
        self.assertEqual(result.instruments.hits, 0)

    def test_an_interval_too_late_is_not_named_and_false(self):
        s, change = self.first_change()
        ids = self.neighbours(s)
        k = ids.index(change["before"])
        change["after"], change["before"] = (ids[k], ids[k + 1]) if k + 1 < len(ids) else (ids[0], ids[1])
        result = scored(self.truth, self.history)
        self.assertEqual(result.steps["all"].hits, result.steps["all"].of - 1)
        self.assertEqual(result.missed, {"another interval": 1})
        self.assertEqual(len(result.false), 1)

    def test_the_wrong_machine_axis_or_quantity_is_not_named(self):
        for key, wrong in (("machine", "S-9999"), ("axis", "Q"), ("quantity", "elsewhere")):
            with self.subTest(key):
                self.history = told(self.truth)
                s, _ = self.first_change()
                n = len(s["changes"])
                s[key] = wrong
                result = scored(self.truth, self.history)
                self.assertEqual(result.steps["all"].hits, result.steps["all"].of - n)
                self.assertEqual(result.missed, {"no such series": n})
                self.assertEqual(len(result.false), n)

    def test_a_parameter_of_a_model_may_show_changes_of_the_machine_and_nothing_else(self):
        s, change = self.first_change()
        ids = self.neighbours(s)
        for at, false in (((change["after"], change["before"]), 0), ((ids[0], ids[1]), 1)):
            history = told(self.truth)
            history["series"].append(s | {"quantity": "backlash:X.b", "changes": [change | {"after": at[0], "before": at[1]}]})
            self.assertEqual(len(scored(self.truth, history).false), false)

    def test_a_change_that_is_not_reported_is_missed(self):
        s, _ = self.first_change()
        s["changes"], s["model"] = [], "level"
        result = scored(self.truth, self.history)
        self.assertEqual(result.steps["all"].hits, result.steps["all"].of - 1)
        self.assertEqual(result.missed, {"no change told, model level": 1})

    def test_a_wrong_size_and_a_wrong_cause_are_seen(self):
        _, change = self.first_change()
        change["size"] += 3.0 * change["u"]
        change["cause"] = "event"
        result = scored(self.truth, self.history)
        self.assertEqual(result.sizes.hits, result.sizes.of - 1)
        self.assertEqual(result.causes.hits, result.causes.of - 1)

    def test_a_machine_is_known_by_each_of_its_names(self):
        s, _ = self.first_change()
        s["machine"] = "Sample Machines " + s["machine"]
        result = scored(self.truth, self.history)
        self.assertEqual(result.steps["all"].hits, result.steps["all"].of)

    def test_an_instrument_taken_for_the_machine_is_seen_and_one_called_so_is_not(self):
        i = next(i for i in self.truth["instruments"] if not any(
            (c["machine"], c["after"], c["before"]) == (i["machine"], i["after"], i["before"]) for c in self.truth["changes"]))
        s = next(s for s in self.history["series"] if s["machine"] == i["machine"] and s["quantity"] == "scale")
        for cause, blamed in (("undeclared", 1), ("event", 1), ("instrument", 0)):
            with self.subTest(cause):
                s["changes"] = [{"after": i["after"], "before": i["before"], "size": i["size"], "u": 0.1, "cause": cause}]
                result = scored(self.truth, self.history)
                self.assertEqual(len(result.blamed), blamed)
                self.assertEqual(result.instruments.hits, blamed)
                self.assertEqual(any("instruments" in f for f in result.fails()), bool(blamed))

    def test_what_vanished_must_be_named_and_nothing_else(self):
        del self.history["vanished"][0]
        self.history["vanished"].append({"campaign": "is-there", "folder": "x", "last_seen_night": 1})
        result = scored(self.truth, self.history)
        self.assertEqual(result.vanished.hits, result.vanished.of - 1)
        self.assertEqual(result.vanished_wrong, ["is-there"])
        self.assertTrue(any(f.startswith("vanished") for f in result.fails()))

    def test_a_quiet_run_counts_once_when_it_reports_a_new_change(self):
        nothing = told(self.quiet)
        self.assertEqual([s["changes"] for s in nothing["series"] if s["changes"]], [])
        something = copy.deepcopy(nothing)
        ids = [p["campaign"] for p in self.quiet["series"][0]["points"]]
        reversal = next(s for s in something["series"] if s["quantity"] == "B_mean")
        reversal["changes"] = [{"after": ids[1], "before": ids[2], "size": 1.0, "u": 0.1, "cause": "undeclared"}]
        result = scored(self.quiet, nothing, something, something, nothing, something)
        self.assertEqual((result.quiet_nights.hits, result.quiet_nights.of), (1, 5))
        self.assertEqual(len(result.false), 1)
        self.assertEqual(scored(self.truth, told(self.truth)).quiet_nights.of, 0)

    def test_a_mail_counts_once_when_it_reports_a_new_change(self):
        def morning(*lines):
            return {"schema": "nonio-morning/1", "lines": [dict(zip(("id", "kind", "mail"), line)) for line in lines]}

        one, other = ("worklist.changed:A:X:1", "changed", True), ("worklist.changed:B:X:1", "changed", True)
        for mornings, hits in (((morning(), morning(one), morning(one), morning(one, other)), 2),
                               ((morning(("worklist.changed:A:X:1", "changed", False)), morning(("worklist.overdue:A", "overdue", True))), 0)):
            result = score.Score()
            result.add(self.quiet, [told(self.quiet)] * len(mornings), mornings)
            self.assertEqual((result.quiet_mails.hits, result.quiet_mails.of), (hits, len(mornings)))
        result = score.Score()
        result.add(self.quiet, [told(self.quiet)], [morning(one)] + [morning()] * 9)
        self.assertTrue(any(f.startswith("mails") for f in result.fails()))
        result = score.Score()
        result.add(self.truth, [told(self.truth)], [morning(one)])
        self.assertEqual(result.quiet_mails.of, 0)

    def test_too_many_false_quiet_runs_fail(self):
        nights, quiet = [], told(self.quiet)
        ids = [p["campaign"] for p in self.quiet["series"][0]["points"]]
        for k in range(60):
            night = copy.deepcopy(quiet)
            if k % 4 == 0:
                night["series"][k % len(night["series"])]["changes"] = [{"after": ids[0], "before": ids[1], "size": 1.0 + k, "u": 0.1,
                                                                          "cause": "undeclared"}]
            nights.append(night)
        self.assertTrue(any(f.startswith("quiet") for f in scored(self.quiet, *nights).fails()))
        self.assertFalse(any(f.startswith("quiet") for f in scored(self.quiet, *([quiet] * 60)).fails()))

    def test_another_schema_is_refused(self):
        self.history["schema"] = "nonio-history/2"
        with self.assertRaises(SystemExit):
            scored(self.truth, self.history)


class OfDrift(unittest.TestCase):
    """Slopes and forecasts blurred by what is said of them, by less and by more."""
    SEED = 20261122

    @classmethod
    def setUpClass(cls):
        cls.truths = [truth_of("drifting", seed, machines=6, count=5) for seed in range(4)]

    def cover(self, blurred):
        result = score.Score()
        for k, truth in enumerate(self.truths):
            history = told(truth, Noise("%d/%d" % (self.SEED, k)))
            for s, t in zip(history["series"], truth["series"]):
                for g, h in zip(s["segments"], t["segments"]):
                    g["slope_per_year"] = h["slope_per_year"] + blurred * (g["slope_per_year"] - h["slope_per_year"])
                value = t["later"][2][1]
                s["forecast"]["value"] = value + blurred * (s["forecast"]["value"] - value)
            result.add(truth, [history])
        return result

    def test_stated_uncertainties_that_hold_cover(self):
        result = self.cover(1.0)
        self.assertGreater(result.slopes.of, 300)
        self.assertEqual([f for f in result.fails() if "covered" in f], [], self.SEED)

    def test_uncertainties_too_small_or_too_large_do_not(self):
        for factor, words in ((1.3, ("slopes covered:", "forecasts covered:")), (0.6, ("slopes covered too often", "forecasts covered too often"))):
            fails = self.cover(factor).fails()
            for word in words:
                self.assertTrue(any(f.startswith(word) for f in fails), (factor, word, fails, self.SEED))

    def test_where_wear_is_no_line_a_slope_has_no_truth(self):
        t = {"segments": [{"from": "a", "to": "c", "law": "other", "slope_per_year": 1.0}, {"from": "d", "to": "e", "law": "none", "slope_per_year": 0.0}]}
        order = {c: [k] for k, c in enumerate("abcde")}
        self.assertIsNone(score.true_slope(t, order, {"from": "a", "to": "b"}))
        self.assertEqual(score.true_slope(t, order, {"from": "d", "to": "e"}), 0.0)
        self.assertIsNone(score.true_slope(t, order, {"from": "b", "to": "e"}))


class OfPulls(unittest.TestCase):
    """Made-up results.json of campaigns that share an instrument: u that is right, too small, and what is shared left out."""

    def rms(self, factor, keep_common):
        truth = truth_of("quiet", 4, machines=6)
        noise, shared, found = Noise("pulls"), Noise("instrument").normal(), {}
        for s in (s for s in truth["series"] if s["quantity"] == "B_mean"):
            for p in s["points"]:
                found.setdefault(p["campaign"], []).append(
                    {"measurement": p["measurement"], "axis": s["axis"], "quantity": "B_mean", "u": factor * 0.1,
                     "value": p["value"] + 0.1 * noise.normal() + 0.5 * shared, "common": [{"source": "i", "u": 0.5}] if keep_common else []})
        with tempfile.TemporaryDirectory() as folder:
            for campaign, of in found.items():
                (pathlib.Path(folder) / campaign).mkdir()
                (pathlib.Path(folder) / campaign / "results.json").write_text(json.dumps({"followed": of}))
            alone, pairs, absent = pulls.compare(folder, truth)
        self.assertNotIn("B_mean", absent)
        self.assertIn("scale", absent)
        return [(sum(v * v for v in p.values["B_mean"]) / len(p.values["B_mean"])) ** 0.5 for p in (alone, pairs)]

    def test_u_is_judged_and_what_is_shared_cancels(self):
        alone, pairs = self.rms(1.0, True)
        self.assertAlmostEqual(pairs, 1.0, delta=0.2)
        self.assertLess(alone, 2.0)
        self.assertAlmostEqual(self.rms(0.5, True)[1] / pairs, 2.0)
        self.assertAlmostEqual(self.rms(1.0, False)[1] / pairs, 1.0)
        self.assertGreater(self.rms(1.0, False)[0], 1.3 * alone)


class OfThePlainJudgement(unittest.TestCase):
    # Eight campaigns, um and years: a line by generalised least squares, computed elsewhere with numpy.
    T = (0.0, 0.5, 1.1, 1.6, 2.0, 2.6, 3.1, 3.5)
    Y = (-4.1, -4.3, -4.6, -4.5, -5.0, -5.3, -5.2, -5.6)
    U = (0.25, 0.25, 0.30, 0.25, 0.20, 0.20, 0.25, 0.20)

    def test_a_line_and_its_uncertainty(self):
        for sources, wanted in (([{}] * 8, ("-4.07657", "-0.42385", "0.16354", "0.07140", "2.2180", "-5.9839", "0.1973")),
                                ([{"a": 0.3}] * 8, ("-4.07657", "-0.42385", "0.34168", "0.07140", "2.2180", "-5.9839", "0.3591")),
                                ([{"a": 0.3}] * 4 + [{"b": 0.3}] * 4,
                                 ("-4.19257", "-0.35534", "0.31080", "0.11733", "1.6766", "-5.7916", "0.3901"))):
            points = [{"u": u, "common": c} for u, c in zip(self.U, sources)]
            inverse = plain.solve(plain.covariance(points), [[float(i == j) for j in range(8)] for i in range(8)])
            fit = plain.Fit(inverse, [[1.0] * 8, list(self.T)], self.Y)
            at = fit.at([1.0, 4.5])
            found = (*fit.b, fit.cov[0][0] ** 0.5, fit.cov[1][1] ** 0.5, fit.chi2, *at)
            self.assertEqual(tuple("%.*f" % (len(w.rpartition(".")[2]), f) for f, w in zip(found, wanted)), wanted)

    def judged(self, values, sources, left=(), events=()):
        points = [{"day": 738000 + 200 * k, "left": k in left, "campaign": "c%d" % k, "value": v, "u": 0.1, "common": {s: 1.0} if s else {}}
                  for k, (v, s) in enumerate(zip(values, sources))]
        return plain.judge(("M", "X", "scale", "{}", "um/m"), points, events, 0.001, line=False)["changes"]

    def test_a_step_is_found_and_that_of_an_instrument_is_not(self):
        values = [1.0, 1.1, 0.9, 1.0, 3.0, 3.1, 2.9, 3.0]
        found = self.judged(values, [None] * 8)
        self.assertEqual([(c["after"], c["before"], c["cause"]) for c in found], [("c3", "c4", "undeclared")])
        self.assertAlmostEqual(found[0]["size"], 2.0)
        self.assertEqual(self.judged(values, ["a"] * 4 + ["b"] * 4), [])
        self.assertEqual(len(self.judged(values, ["a"] * 8)), 1)

    def test_an_event_is_the_cause_of_its_step_and_of_no_other(self):
        event = {"machine": "M", "axis": "X", "kind": "crash", "date": datetime.date.fromordinal(738000 + 700)}
        values = [1.0, 1.1, 0.9, 1.0, 3.0, 3.1, 2.9, 3.0]
        self.assertEqual([c["cause"] for c in self.judged(values, [None] * 8, events=[event])], ["event"])
        self.assertEqual([c["cause"] for c in self.judged(values, [None] * 8, events=[event | {"axis": "Y"}])], ["undeclared"])
        self.assertEqual(self.judged([1.0] * 8, [None] * 8, events=[event]), [])


class Arithmetic(unittest.TestCase):
    def test_wilson(self):
        # Newcombe 1998, 81 of 263: 0.2553 to 0.3662; 15 of 148: 0.0624 to 0.1605; 0 of 20: 0 to 0.1611.
        for hits, of, low, high in ((81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611)):
            _, a, b = score.wilson(hits, of)
            self.assertAlmostEqual(a, low, 4)
            self.assertAlmostEqual(b, high, 4)
        self.assertIsNone(score.wilson(0, 0))

    def test_a_date_between_two(self):
        later = [["2026-01-01", 1.0], ["2026-01-11", 2.0], ["2026-01-21", 4.0]]
        for date, value in (("2026-01-01", 1.0), ("2026-01-06", 1.5), ("2026-01-11", 2.0), ("2026-01-16", 3.0), ("2026-01-21", 4.0)):
            self.assertAlmostEqual(score.at_date(later, date), value)
        self.assertIsNone(score.at_date(later, "2026-01-22"))
        self.assertIsNone(score.at_date(later, "2025-12-31"))

    def test_axes_and_quantities_by_the_names_of_the_control(self):
        self.assertTrue(score.same_axis("X1", "X") and not score.same_axis("X2", "X") and not score.same_axis("X", "X1")
                        and score.same_axis("X-in-Z", "X") and not score.same_axis("X-in-Z", "Z"))
        self.assertTrue(score.same_quantity("squareness:XY", "squareness:XY.c") and not score.same_quantity("B_mean", "B"))


class Command(unittest.TestCase):
    def test_check_is_the_exit_status(self):
        truth = truth_of("mixed", 5)
        history = told(truth)
        with tempfile.TemporaryDirectory() as folder:
            for k, vanished in enumerate((history["vanished"], [])):
                files = [os.path.join(folder, n) for n in ("truth.json", "history.json")]
                for file, document in zip(files, (truth, history | {"vanished": vanished})):
                    with open(file, "w", encoding="utf-8") as opened:
                        json.dump(document, opened)
                done = subprocess.run([sys.executable, "-B", SCORE, "--site", *files, "--json", "--check"], capture_output=True, text=True)
                document = json.loads(done.stdout)
                self.assertIn("steps", document)
                self.assertEqual(done.returncode, 1 if document["fails"] else 0, done.stderr)
                self.assertEqual(any(f.startswith("vanished") for f in document["fails"]), bool(k))


if __name__ == "__main__":
    unittest.main()
