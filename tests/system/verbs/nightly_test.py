# SPDX-License-Identifier: Apache-2.0
"""The nightly run with a model: analysis model-fit, tables from the model, exclusions."""
import datetime
import json
import re
import shutil
import subprocess
import unittest

from verbs import VerbTest, manifest, readings


class Nightly(VerbTest):
    def night(self, *args, expect=0):
        out = self.site.parent / "out"
        self.nonio("run", self.site, "--out", out, "--quiet", *args, expect=expect)
        self.out = out / "c"
        return json.loads((self.out / "results.json").read_text())

    def fits(self, results):
        return [a for a in results["analyses"] if a["plugin"] == "model-fit"]

    RUN = '[run]\noutputs = ["json"]\n'

    def test_a_good_model_is_a_quiet_run(self):
        self.campaign(manifest(["scale:X", "backlash:X"], self.RUN), x=readings(scale=20, backlash=-6))
        fit = self.fits(self.night())[0]
        self.assertEqual(fit["measurement"], "X")
        self.assertEqual([f["id"] for f in fit["findings"]], [])
        b = fit["values"]["backlash:X.b"]
        self.assertLess(abs(b["value"] + 6), 2 * b["U"])
        self.assertTrue(0.3 < fit["values"]["rms"]["value"] < 0.7)
        self.assertEqual(fit["values"]["rms"]["unit"], "um")
        self.assertIn("U", fit["values"]["noise_floor"])

    def test_status_is_in_the_language_of_the_run(self):
        self.campaign(manifest(["scale:X", "backlash:X"], self.RUN), x=readings(scale=20, backlash=-6))
        (self.site / "site.toml").write_text('language = "de"\n')
        self.night("--date", "2026-11-03")
        out = self.out.parent
        for args, first in (((), "Lauf 1 vom 2026-11-03 ist abgeschlossen, vor 0,0 h: 1 Kampagne, 0 fehlgeschlagen"),
                            (("--language", "it"), "esecuzione 1 del 2026-11-03 è completa, 0,0 h fa: 1 campagna, 0 non riuscite")):
            self.assertEqual(first, self.nonio("status", out, *args, expect=0).stdout.split("\n")[0])

    def test_metrics_of_the_last_run(self):
        self.campaign(manifest(["scale:X", "backlash:X"], self.RUN), x=readings(scale=20, backlash=-6))
        self.night("--date", "2026-11-03")
        out = self.out.parent
        text = self.nonio("status", out, "--metrics", expect=0).stdout
        line = re.compile(r'([a-z_]+)(?:\{([a-z]+)="([^"\\]*)"\})? (-?[0-9.]+)')
        values, families, of = {}, set(), ""
        for row in text.splitlines():
            if row.startswith("# TYPE "):
                of = row.split()[2]
                self.assertNotIn(of, families)
                families.add(of)
            elif not row.startswith("#"):
                name, label, value, number = line.fullmatch(row).groups()
                self.assertEqual(name, of)
                values[name, value] = float(number)
        self.assertTrue(text.endswith("\n# EOF\n"))
        if shutil.which("promtool"):  # Debian: prometheus
            checked = subprocess.run(["promtool", "check", "metrics"], input=text, capture_output=True, text=True)
            self.assertEqual((0, ""), (checked.returncode, checked.stdout + checked.stderr))
        else:
            print("promtool is missing (scripts/install-dependencies --all): the metrics were not checked with it", flush=True)
        summary = json.loads((out / "summary.json").read_text())
        for state, count in summary["counts"].items():
            self.assertEqual(values["nonio_campaigns", state], count)
        self.assertEqual(sum(n for (name, _), n in values.items() if name == "nonio_worklist_lines"), len(summary["lines"]))
        self.assertLess(values["nonio_last_run_age_seconds", None], 600)
        self.assertTrue(0 < values["nonio_last_run_seconds", None] < 600)
        self.assertEqual((0, 0), tuple(values["nonio_certificates_due", w] for w in ("overdue", "30_days")))
        day = lambda n: (datetime.datetime.now(datetime.timezone.utc) + datetime.timedelta(days=n)).strftime("DTSTART;VALUE=DATE:%Y%m%d\r\n")
        (out / "due.ics").write_text(day(-2) + day(1) + day(29) + day(32) + day(400))
        text = self.nonio("status", out, "--metrics", expect=0).stdout
        self.assertIn('nonio_certificates_due{within="overdue"} 1\nnonio_certificates_due{within="30_days"} 2\n', text)
        self.assertIn("summary.json", self.nonio("status", self.site, "--metrics", expect=2).stderr)

    def test_what_fails_and_what_is_missing_are_findings(self):
        self.campaign(manifest(["scale:X"], self.RUN), x=readings(scale=20, backlash=-6))
        results = self.night()
        found = {f["id"]: f for f in self.fits(results)[0]["findings"]}
        self.assertEqual(found["model.missing"]["evidence"]["effect"], "backlash:X")
        fails = found["model.fails"]
        self.assertEqual((fails["severity"], fails["evidence"]["where"]), ("attention", "direction"))
        self.assertGreater(fails["evidence"]["share"], 0.9)
        self.assertIn("p", fails["evidence"])
        self.assertTrue(fails["advice"])
        self.assertEqual(results["status"], "attention")

    def test_without_a_model_it_runs_only_when_named(self):
        self.campaign(manifest(None, self.RUN), x=readings())
        self.assertEqual(self.fits(self.night()), [])
        self.campaign(manifest(None, '[run]\nanalyses = ["model-fit"]\noutputs = ["json"]\n'))
        results = self.night()
        self.assertEqual([a["plugin"] for a in results["analyses"]], ["model-fit"])
        self.campaign(manifest(["scale:X"], '[run]\nanalyses = ["iso230-2"]\noutputs = ["json"]\n'))
        self.assertEqual(self.fits(self.night()), [])

    def test_a_fit_that_is_impossible_is_a_finding(self):
        self.campaign(manifest(["scale:X", "pitch-curve:X", "zero-drift:X", "run-jump:X"], self.RUN),
                      x=readings(runs=1, targets=[0.0, 50.0]))
        results = self.night(expect=None)
        text = json.dumps(results)
        self.assertTrue("model.cannot-fit" in text or "does not apply" in text, text)

    def test_an_unknown_effect_fails_the_campaign_with_its_line(self):
        text = manifest(["scal:X"], self.RUN)
        self.campaign(text, x=readings())
        results = self.night(expect=1)
        error = results["errors"][0]
        self.assertEqual(text.splitlines()[error["line"] - 1][:7], "effects")
        self.assertIn('nearest: "scale:X"', error["message"])

    def test_excluded_lines_are_noted_and_do_not_count(self):
        text = manifest([], self.RUN).replace('file = "x.csv"\n', 'file = "x.csv"\nexclude = [5, 9]\n')
        self.campaign(text, x=readings())
        results = self.night(expect=None)
        self.assertEqual(sum("is excluded by the manifest" in n for n in results["notes"]), 2)
        found = [f for a in results["analyses"] for f in a["findings"] if f["id"] == "readings.excluded-without-reason"]
        self.assertTrue(found)
        self.assertIn("exclude_reason", found[0]["advice"])
        self.campaign(text.replace("exclude = [5, 9]", 'exclude = [5, 9]\nexclude_reason = "beam broken"'), x=readings())
        results = self.night(expect=None)
        self.assertEqual(sum("is excluded by the manifest: beam broken" in n for n in results["notes"]), 2)
        self.assertNotIn("readings.excluded-without-reason", json.dumps(results))

    def test_the_history_is_a_record_only(self):
        self.campaign(manifest(["scale:X"], self.RUN), x=readings(scale=20))
        self.night()
        plan = self.nonio("run", self.site, "--out", self.out.parent, "--dry-run").stdout
        self.assertIn("nothing changed", plan)
        (self.folder / "model-history.jsonl").write_text(
            '{"action":"add","effect":"scale:X","rms_before_um":3.0,"rms_after_um":0.5}\n')
        plan = self.nonio("run", self.site, "--out", self.out.parent, "--dry-run").stdout
        self.assertIn("nothing changed", plan)

    def columns(self, model, drift):
        run = '[run]\nanalyses = ["iso230-2"]\noutputs = ["linuxcnc"]\n'
        run += '[options.linuxcnc]\naxes = ["X drifted=1"]\n'
        self.campaign(manifest(["scale:X", "backlash:X", "zero-drift:X"], run, model),
                      x=readings(noise=0.05, scale=20, backlash=-6, drift=drift))
        results = self.night(expect=None)
        table = (self.out / "linuxcnc-X.comp").read_text()
        rows = [[float(x) for x in line.split()] for line in table.splitlines()
                if re.match(r"\s*-?\d", line)]
        self.assertEqual(len(rows), 11, table)
        return rows, results

    def test_drift_does_not_enter_a_table_of_the_model(self):
        still, _ = self.columns('compensate = "model"\n', 0.0)
        moved, results = self.columns('compensate = "model"\n', 30.0)
        for a, b in zip(still, moved):
            self.assertLess(max(abs(x - y) for x, y in zip(a, b)), 0.0003, (a, b))
        raw, _ = self.columns("", 30.0)
        self.assertGreater(max(abs(x - y) for a, b in zip(still, raw) for x, y in zip(a, b)), 0.002)
        self.assertIn("Tables contain the values of the model for scale:X, backlash:X", " ".join(results["notes"]))
        before = next(p for p in results["tables"][0]["predictions"] if p["name"] == "E")
        self.assertGreater(before["before"], 10.0)

    def test_a_model_without_compensable_effects_gives_no_table(self):
        run = '[run]\nanalyses = ["iso230-2"]\noutputs = ["linuxcnc"]\n'
        self.campaign(manifest(["zero-drift:X"], run, 'compensate = "model"\n'), x=readings(drift=9))
        results = self.night(expect=None)
        self.assertEqual([o["file"] for o in results["outputs"]], [])
        self.assertIn("no effect that a table can compensate", json.dumps(results))


if __name__ == "__main__":
    unittest.main()
