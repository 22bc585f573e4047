# SPDX-License-Identifier: Apache-2.0
"""XLSX and ODS files as measurements: the same results as CSV, and messages that name sheet and row."""
import csv
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
import sheets

NONIO = os.environ["NONIO"]
ROOT = pathlib.Path(__file__).resolve().parents[3]
SEED = int(os.environ.get("NONIO_SEED") or random.SystemRandom().randrange(10 ** 6))


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


class Spreadsheet(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-sheet-")
        self.addCleanup(folder.cleanup)
        self.site, self.out = pathlib.Path(folder.name) / "site", pathlib.Path(folder.name) / "out"
        shutil.copytree(ROOT / "samples/site/02-constant-reversal", self.site / "a")
        self.manifest = self.site / "a/campaign.toml"
        text = self.manifest.read_text()
        self.file = next(p.name for p in (self.site / "a").glob("*.csv"))
        self.assertIn(f'file = "{self.file}"', text)
        with open(self.site / "a" / self.file, newline="") as file:
            lines = [line for line in file if not line.startswith("#")]
        self.rows = [[number(field) for field in row] for row in csv.reader(lines)]

    def use(self, name, more=""):
        self.manifest.write_text(self.manifest.read_text().replace(f'file = "{self.file}"', f'file = "{name}"') + more)
        self.file = name

    def results(self, status=0):
        done = subprocess.run([NONIO, "run", self.site, "--out", self.out, "--quiet"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return json.loads(next(self.out.glob("*/results.json")).read_text())

    def values(self):
        return {(a["plugin"], a["measurement"]): a["values"] for a in self.results()["analyses"]}

    def refusal(self):
        return self.results(1)["errors"][0]

    def make(self, name, rows, **more):
        book = {"Deckblatt": [["Messprotokoll"], [None, "Pruefer", "A."]], "Messwerte X": rows}
        (sheets.xlsx if name.endswith(".xlsx") else sheets.ods)(self.site / "a" / name, book, **more)
        self.use(name)

    def test_the_same_values_as_from_csv(self):
        expected = self.values()
        for name in ("x.xlsx", "x.ods"):
            with self.subTest(name):
                shutil.rmtree(self.out)
                self.make(name, [["Linie X, Laser"], [], *self.rows])
                self.assertEqual(self.values(), expected)
                self.assertTrue(expected)

    def test_files_of_other_programs(self):
        expected = self.values()
        for file in sorted((ROOT / "tests/fuzz/corpus/spreadsheet").glob("*.*s*")):
            with self.subTest(file.name):
                shutil.rmtree(self.out)
                shutil.copy(file, self.site / "a" / file.name)
                self.use(file.name)
                self.assertEqual(self.values(), expected)

    def test_formulas_and_rows_below(self):
        expected = self.values()
        shutil.rmtree(self.out)
        rows = [list(row) for row in self.rows]
        rows[1][3] = sheets.Formula(f"A1*2={rows[1][3]!r}")
        self.make("x.xlsx", [*rows, [], ["Mittelwert", 3.0]])
        self.assertEqual(self.values(), expected)
        shown = subprocess.run([NONIO, "show", self.site / "a", "--all"], capture_output=True, text=True, check=False)
        self.assertIn(f'Sheet "Messwerte X": rows 1 to {len(rows)} were read, those after the blank row', shown.stdout + shown.stderr)

    def test_messages_name_sheet_and_row(self):
        for value, wanted in (("abc", 'found "abc"'), ("#DIV/0!", "#DIV/0!"), (sheets.Date(46329.5), "2026-11-03T12:00:00"),
                              ("0,463", 'found "0,463" with a decimal comma')):
            with self.subTest(value):
                rows = [list(row) for row in self.rows]
                rows[4][3] = value
                self.make("x.xlsx", [["Titel"], *rows])
                error = self.refusal()
                self.assertIn('sheet "Messwerte X"', error["message"])
                self.assertIn(wanted, error["message"])
                self.assertEqual((error["file"], error["line"]), ("x.xlsx", 6))
                shutil.rmtree(self.out)

    def test_which_sheet(self):
        both = {"eins": self.rows, "zwei": self.rows}
        sheets.xlsx(self.site / "a/x.xlsx", both)
        self.use("x.xlsx")
        self.assertIn('expected one sheet with readings, found "eins", "zwei"; name one in [options.spreadsheet] sheet',
                      self.refusal()["message"])
        self.use("x.xlsx", '\n[options.spreadsheet]\nsheet = "zwei"\n')
        self.assertTrue(self.values())
        self.manifest.write_text(self.manifest.read_text().replace('"zwei"', '"drei"'))
        self.assertIn('there is no sheet "drei"; found "eins", "zwei"', self.refusal()["message"])

    def test_hostile_workbooks(self):
        entity = '<!DOCTYPE worksheet [<!ENTITY a SYSTEM "file:///etc/passwd">]>'
        self.make("x.xlsx", self.rows, doctype=entity)
        self.assertIn("document type or entities", self.refusal()["message"])
        with zipfile.ZipFile(self.site / "a/x.xlsx", "w", zipfile.ZIP_DEFLATED) as z:
            z.writestr("xl/workbook.xml", b" " * (300 << 20))
        self.assertIn("more than 256 MB", self.refusal()["message"])
        (self.site / "a/x.xlsx").write_bytes(b"PK\3\4 and no more")
        self.assertIn("no spreadsheet that can be opened", self.refusal()["message"])

    def test_mutants_are_read_or_refused(self):
        print(f"seed {SEED} (NONIO_SEED)", file=sys.stderr)
        rng = random.Random(SEED)
        self.make("x.xlsx", self.rows)
        whole = (self.site / "a/x.xlsx").read_bytes()
        expected = self.values()
        for _ in range(25 if os.environ.get("NONIO_LONG") else 8):  # unit.test_spreadsheet_reader tries thousands
            data = bytearray(whole)
            for _ in range(rng.choice((1, 3, 20))):
                data[rng.randrange(len(data))] = rng.randrange(256)
            if rng.random() < 0.2:
                del data[rng.randrange(len(data)):]
            (self.site / "a/x.xlsx").write_bytes(data)
            done = subprocess.run([NONIO, "run", self.site, "--out", self.out, "--quiet"], capture_output=True, text=True, check=False)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            results = json.loads(next(self.out.glob("*/results.json")).read_text())
            if results["status"] != "failed":  # the check sums of the archive find what was changed in a cell
                self.assertEqual({(a["plugin"], a["measurement"]): a["values"] for a in results["analyses"]}, expected)
            else:
                self.assertTrue(results["errors"][0]["message"])


if __name__ == "__main__":
    unittest.main()
