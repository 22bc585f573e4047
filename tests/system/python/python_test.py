# SPDX-License-Identifier: Apache-2.0
"""The package nonio: the numbers and words of the program, effects written in Python, and no need of pandas."""
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

import nonio

NONIO = os.environ["NONIO"]
SITE = pathlib.Path(__file__).resolve().parents[3] / "samples/site"
SEED = int(os.environ.get("NONIO_SEED") or random.SystemRandom().randrange(10 ** 6))


def program(*arguments, status=0):
    done = subprocess.run([NONIO, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == status, (done.returncode, done.stdout, done.stderr)
    return done


def rows(table):
    """A table of either kind as a list of dicts; NaN and None are None."""
    columns = {name: list(table[name]) for name in table}
    return [{name: None if value is None or value != value else value for name, value in zip(columns, row)}
            for row in zip(*columns.values())]


def backlash(name="own", columns=None):
    return nonio.Effect(name, {"b": "um"}, columns or (lambda readings: [[d / 2 for d in readings["direction"]]]))


class Package(unittest.TestCase):
    def test_results_are_those_of_the_program(self):
        for name in ("02-constant-reversal", "09-tolerances", "13-gantry-diagonals", "14-rotary-table", "42-heat"):
            with self.subTest(name):
                wanted = json.loads(program("show", SITE / name, "--json").stdout)
                results = nonio.read(SITE / name).evaluate()
                for key in ("campaign", "status", "errors", "analyses", "conformity"):
                    self.assertEqual(results.json.get(key), wanted.get(key))
                values = [(r["measurement"], r["analysis"], r["name"], r["value"], r["U"]) for r in rows(results.values)]
                self.assertEqual(values, [(a.get("measurement"), a["plugin"], n, v["value"], v.get("U"))
                                          for a in wanted["analyses"] for n, v in a["values"].items()])
                first = next(a for a in wanted["analyses"] if "points" in a and "measurement" in a)
                self.assertEqual([{k: v for k, v in row.items() if v is not None}
                                  for row in rows(results.points(first["measurement"], first["plugin"]))], first["points"])

    def test_models_are_those_of_the_program(self):
        for name in ("02-constant-reversal", "13-gantry-diagonals"):
            campaign = nonio.read(SITE / name)
            self.assertEqual(campaign.compare().json, json.loads(program("model", "compare", SITE / name, "--json").stdout))
            self.assertEqual(campaign.explain(), json.loads(program("model", "explain", SITE / name, "--json").stdout))

    def test_readings(self):
        table = rows(nonio.read(SITE / "02-constant-reversal").readings("Z"))
        text = (SITE / "02-constant-reversal/z.csv").read_text().splitlines()
        for row in table:
            run, direction, target, deviation = text[row["file_line"] - 1].split(",")[:4]
            self.assertEqual((row["run"], "+" if row["Z_dir"] > 0 else "-"), (int(run), direction))
            self.assertEqual((row["Z_mm"], row["deviation_um"]), (float(target), float(deviation)))

    def test_an_effect_of_ones_own_is_fitted_as_the_catalogue_is(self):
        campaign, own = nonio.read(SITE / "02-constant-reversal"), backlash()
        mine = campaign.fit("scale:Z", own["Z"], effects=[own])
        theirs = campaign.fit("scale:Z", "backlash:Z")
        values = [[(r["name"], r["value"], r["u"], r["unit"]) for r in rows(fit.parameters)] for fit in (mine, theirs)]
        self.assertEqual(values[0], values[1])
        self.assertEqual(mine.json["parts"][0]["rms_um"], theirs.json["parts"][0]["rms_um"])
        for r in rows(mine.readings):
            self.assertAlmostEqual(r["reading_um"], r["model_um"] + r["residual_um"], places=9)
        found = {c["effect"]: c.get("score") for c in campaign.explain(effects=[own])["candidates"]}
        self.assertEqual(found["own:Z"], found["backlash:Z"])

    def test_a_wave_that_was_put_in_is_found(self):
        print(f"seed {SEED} (NONIO_SEED)", file=sys.stderr)
        rng = random.Random(SEED)
        truth = {"a": rng.uniform(3, 9), "b": rng.uniform(-9, -3), "period": rng.uniform(310, 420)}
        with tempfile.TemporaryDirectory(prefix="nonio-python-") as folder:
            folder = pathlib.Path(folder)
            shutil.copytree(SITE / "02-constant-reversal", folder / "c")
            lines = ["run,direction,target_mm,deviation_um"]
            for run in range(1, 6):
                for direction in "+-":
                    for k in range(41):
                        x = 25.0 * (k if direction == "+" else 40 - k)
                        phase = 2 * math.pi * x / truth["period"]
                        wave = truth["a"] * math.sin(phase) + truth["b"] * math.cos(phase)
                        lines.append(f"{run},{direction},{x},{wave + rng.gauss(0, 0.5):.4f}")
            (folder / "c/z.csv").write_text("\n".join(lines) + "\n")

            def columns(readings, period):
                phases = [2 * math.pi * x / period for x in readings["target"]]
                return [[math.sin(p) for p in phases], [math.cos(p) for p in phases]]

            own = nonio.Effect("wave", {"a": "um", "b": "um"}, columns, shapes={"period": ("mm", range(200, 600, 20))})
            fit = nonio.read(folder / "c").fit(own["Z"], effects=[own])
            for row in rows(fit.parameters):
                self.assertLess(abs(row["value"] - truth[row["name"]]), 6 * row["u"] + 1e-9, (row, truth))
            self.assertLess(fit.json["parts"][0]["rms_um"], 0.6)

    def test_errors_have_the_words_of_the_program(self):
        with self.assertRaises(nonio.Error) as caught:
            nonio.read(SITE / "08-broken-file")
        wanted = json.loads(program("show", SITE / "08-broken-file", "--json", status=1).stdout)["errors"][0]
        self.assertEqual((caught.exception.message, caught.exception.file, caught.exception.line), (wanted["message"], wanted["file"], wanted["line"]))
        self.assertIn(str(caught.exception), program("model", "compare", SITE / "08-broken-file", status=1).stderr)
        partial = nonio.read(SITE / "08-broken-file", partial=True)
        self.assertEqual([str(e) for e in partial.errors], [str(caught.exception)])
        self.assertEqual(partial.evaluate().status, "failed")
        campaign = nonio.read(SITE / "02-constant-reversal")
        for call, words in ((lambda: nonio.read("nowhere"), "there is no folder nowhere"),
                            (lambda: campaign.fit("skale:Z"), 'there is no effect "skale" (nearest: "scale:Z")'),
                            (lambda: campaign.readings("Q"), 'there is no measurement "Q"'),
                            (lambda: campaign.evaluate().points("Q"), 'there is no analysis "iso230-2" of measurement "Q"')):
            with self.assertRaisesRegex(nonio.Error, re.escape(words)):
                call()

    def test_faults_of_an_effect_are_named(self):
        campaign = nonio.read(SITE / "02-constant-reversal")
        for columns, words in ((lambda r: [], "effect own: expected 1 columns, one for each parameter, found 0"),
                               (lambda r: [[1.0]], "effect own: expected 130 values in a column, one for each reading, found 1"),
                               (lambda r: 1 / 0, "effect own: ZeroDivisionError: division by zero"),
                               (lambda r: "text", "effect own: expected a list of columns, each of numbers"),
                               (lambda r: [[math.nan] * 130], "own")):
            own = backlash(columns=columns)
            with self.assertRaisesRegex(nonio.Error, re.escape(words)):
                campaign.fit(own["Z"], effects=[own])
        with self.assertRaisesRegex(nonio.Error, 'unknown unit "furlong"'):
            bad = nonio.Effect("own", {"b": "furlong"}, lambda r: [])
            campaign.fit(bad["Z"], effects=[bad])
        with self.assertRaisesRegex(nonio.Error, 'there is an effect "backlash" already'):
            bad = backlash("backlash")
            campaign.fit(bad["Z"], effects=[bad])

    def test_several_threads(self):
        own = backlash()
        campaign = nonio.read(SITE / "02-constant-reversal")
        wanted = campaign.fit(own["Z"], effects=[own]).json
        got = []
        threads = [threading.Thread(target=lambda: got.append(campaign.fit(own["Z"], effects=[own]).json)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(got, [wanted] * 4)

    def test_without_pandas(self):
        code = (f"import sys; sys.modules['pandas'] = None; import nonio; c = nonio.read({str(SITE / '09-tolerances')!r}); "
                "v = c.evaluate().values; print(type(v).__name__, v['value'][0], len(c.readings('X')['run']))")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        kind, value, count = done.stdout.split()
        first = json.loads(program("show", SITE / "09-tolerances", "--json").stdout)["analyses"][0]["values"]["A"]["value"]
        self.assertEqual((kind, float(value), int(count)), ("dict", first, 110))


if __name__ == "__main__":
    unittest.main()
