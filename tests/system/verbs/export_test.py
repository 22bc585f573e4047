# SPDX-License-Identifier: Apache-2.0
"""nonio export --format xlsx: read by openpyxl and by LibreOffice, and again by Nonio."""
import datetime
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

NONIO = os.environ["NONIO"]
ROOT = pathlib.Path(__file__).resolve().parents[3]
SITE = ROOT / "samples/site"
sys.path.append("/usr/lib/python3/dist-packages")  # of Debian, for another interpreter
try:
    import openpyxl
except ImportError:
    print("skipped: openpyxl is not installed (Debian package python3-openpyxl)")
    sys.exit(77)
OFFICE = shutil.which("soffice")


def nonio(*arguments, status=0):
    done = subprocess.run([NONIO, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == status, (done.returncode, done.stdout, done.stderr)
    return done


def rows(sheet):
    return [tuple(cell.value for cell in row) for row in sheet.iter_rows()]


def table(all_rows, first):
    """The rows below the heading that begins with `first`, by the names in it, up to a blank row."""
    at = next(k for k, row in enumerate(all_rows) if row[0] == first and row[1] == "Analysis")
    names = [name for name in all_rows[at] if name is not None]
    out = []
    for row in all_rows[at + 1:]:
        if all(value is None for value in row):
            break
        out.append(dict(zip(names, row)))
    return out


class Export(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-export-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def campaign(self, name):
        shutil.copytree(SITE / name, self.folder / name)
        return self.folder / name

    def book(self, source, *more):
        nonio("export", source, "--format", "xlsx", "--to", self.folder, "--quiet", *more)
        return openpyxl.load_workbook(next(self.folder.glob("*.xlsx")))

    def read_again(self, campaign, file, sheet):
        """Values of the campaign with a sheet of readings in place of its file."""
        manifest = campaign / "campaign.toml"
        text = manifest.read_text()
        shutil.copy(file, campaign / file.name)
        manifest.write_text(re.sub(r'^file = ".*"', f'file = "{file.name}"', text, flags=re.M)
                            + f'\n[options.spreadsheet]\nsheet = "{sheet}"\n')
        values = self.values(campaign)
        manifest.write_text(text)
        return values

    @staticmethod
    def values(campaign):
        results = json.loads(nonio("show", campaign, "--json").stdout)
        return {(a["plugin"], a["measurement"]): a["values"] for a in results["analyses"]}

    def test_every_number_is_that_of_results_json(self):
        for name in ("09-tolerances", "13-gantry-diagonals", "42-heat"):
            with self.subTest(name):
                results = json.loads(nonio("show", SITE / name, "--json").stdout)
                summary = rows(self.book(SITE / name)["Summary"])
                shown = {(r["Measurement"] or "", r["Analysis"].split(",")[0], r["Result"]): r
                         for r in table(summary, "Measurement") if r["Value"] is not None}
                expected = {(a.get("measurement", ""), a["plugin"], key): v
                            for a in results["analyses"] for key, v in a["values"].items()}
                self.assertEqual(set(shown), set(expected))
                for key, v in expected.items():
                    row = shown[key]
                    self.assertEqual(row["Value"], v["value"])
                    self.assertEqual((row["U"], row["k"], row["Tolerance"]), (v.get("U"), v.get("k"), v.get("tolerance")))
                    self.assertEqual(row["Unit"] or "", v["unit"])
                    words = {"cannot be decided": "indeterminate"}
                    self.assertEqual(row["Decision"], words.get(v.get("decision"), v.get("decision")))
                head = {row[0]: row[1] for row in summary[:12]}
                self.assertEqual(head["Date"], datetime.datetime.fromisoformat(results["campaign"]["date"]))
                self.assertEqual(head["Status"], {"attention": "action required", "ok": "ok"}[results["status"]])
                next(self.folder.glob("*.xlsx")).unlink()

    def test_budget_and_curves(self):
        results = json.loads(nonio("show", SITE / "13-gantry-diagonals", "--json").stdout)
        book = self.book(SITE / "13-gantry-diagonals")
        curves = [row[2:8] for row in rows(book["Curves"])[1:]]
        expected = [(name, s["over"], x, s["position_unit"], y, U)
                    for a in results["analyses"] for name, s in a.get("series", {}).items()
                    for x, y, U in zip(s["position"], s["value"], s["U"])]
        self.assertEqual(curves, expected)
        first = next(a for a in results["analyses"] if "budget" in a)
        lines = rows(book["Budget"])
        heading = [re.sub(r"^u in (.*?)( \(.*\))?$", r"\1", name) for name in lines[1] if name][8:]
        self.assertEqual(heading, list(first["budget"]["results"]))
        for k, c in enumerate(first["budget"]["contributions"]):
            self.assertEqual(lines[2 + k][1:3], (c["u"], c["unit"]))
            self.assertEqual(list(lines[2 + k][8:8 + len(heading)]),
                             [first["budget"]["results"][name]["u"][c["id"]] for name in heading])
        U = next(row for row in lines if row[0] == "U")
        self.assertEqual(list(U[8:8 + len(heading)]), [first["values"][name]["U"] for name in heading])

    def test_charts_show_the_means_and_the_readings(self):
        book = self.book(SITE / "09-tolerances")
        results = json.loads(nonio("show", SITE / "09-tolerances", "--json").stdout)
        points = results["analyses"][0]["points"]
        (chart,) = book["Charts"]._charts

        def cells(reference):
            sheet, area = reference.rsplit("!", 1)
            return [cell.value for (cell,) in book[sheet.strip("'")][area.replace("$", "")]]

        drawn = [(cells(s.xVal.numRef.f), cells(s.yVal.numRef.f)) for s in chart.series]
        targets = [p["target"] for p in points]
        self.assertEqual(drawn[:2], [(targets, [p["mean+"] for p in points]), (targets, [p["mean-"] for p in points])])
        self.assertEqual(len(drawn[2][0]), 110)
        readings = [row[3] for row in rows(book["Readings X"])[1:]]
        self.assertEqual(drawn[2][1], readings)

    def test_text_is_text(self):
        campaign = self.campaign("09-tolerances")
        manifest = campaign / "campaign.toml"
        hostile = ['=HYPERLINK("http://example.com")', "@SUM(1)", "+1", "a_x0041_b <&> \\u0022", "-2+3"]
        for key, text in zip(("customer", "site", "operator"), hostile):
            manifest.write_text(re.sub(rf'^{key} = .*$', f"{key} = {json.dumps(text)}", manifest.read_text(), flags=re.M))
        sheet = self.book(campaign)["Summary"]
        shown = {row[0].value: row[1] for row in sheet.iter_rows(max_row=8)}
        for name, text in zip(("Customer", "Location", "Operator"), hostile):
            self.assertEqual((shown[name].value, shown[name].data_type), (text, "s"))
        for row in sheet.iter_rows():
            for cell in row:
                self.assertIn(cell.data_type, "snd")

    def test_a_sequence_that_looks_like_a_character_is_kept(self):
        campaign = self.campaign("09-tolerances")
        manifest = campaign / "campaign.toml"
        manifest.write_text(re.sub(r"^customer = .*$", 'customer = "a_x0041_b"', manifest.read_text(), flags=re.M))
        value = self.book(campaign)["Summary"]["B3"].value
        # openpyxl 3.0 leaves such sequences as they are: the escape is what a spreadsheet program reads back.
        self.assertIn(value, ("a_x0041_b", "a_x005F_x0041_b"))

    def test_the_same_bytes_and_changes_are_kept(self):
        book = self.folder / "09-tolerances.xlsx"
        nonio("export", SITE / "09-tolerances", "--format", "xlsx", "--to", self.folder)
        first = book.read_bytes()
        book.unlink()
        nonio("export", SITE / "09-tolerances", "--format", "xlsx", "--to", self.folder)
        self.assertEqual(book.read_bytes(), first)
        nonio("export", SITE / "09-tolerances", "--format", "xlsx", "--to", self.folder)
        book.write_bytes(first + b"notes of a person")
        done = nonio("export", SITE / "09-tolerances", "--format", "xlsx", "--to", self.folder, status=1)
        self.assertIn("exists with different content", done.stderr)
        self.assertEqual(book.read_bytes(), first + b"notes of a person")

    def test_results_of_a_run(self):
        out, to = self.folder / "out", self.folder / "to"
        for name in ("09-tolerances", "08-broken-file"):
            shutil.copytree(SITE / name, self.folder / "site" / name)
        nonio("run", self.folder / "site", "--out", out, "--quiet", status=1)
        nonio("export", "--out", out, "--all", "--format", "xlsx", "--to", to, "--quiet")
        self.assertEqual({p.stem for p in to.glob("*.xlsx")}, {"09-tolerances", "08-broken-file"})
        stored = openpyxl.load_workbook(to / "09-tolerances.xlsx")
        self.assertNotIn("Readings X", stored.sheetnames)
        now = self.book(SITE / "09-tolerances")
        for sheet in ("Points", "Budget"):
            self.assertEqual(rows(stored[sheet]), rows(now[sheet]))
        self.assertIn("x.csv", str(rows(openpyxl.load_workbook(to / "08-broken-file.xlsx")["Summary"])))
        one = nonio("export", "09-tolerances", "--out", out, "--format", "xlsx", "--to", self.folder / "one", "--json")
        self.assertEqual(json.loads(one.stdout)["file"], "09-tolerances.xlsx")
        for wrong in (["nothing", "--format", "xlsx"], ["--format", "xlsx"], ["--all", "--format", "xlsx"],
                      ["09-tolerances"]):
            self.assertTrue(nonio("export", *wrong, status=2).stderr)

    def test_the_readings_are_read_again(self):
        campaign = self.campaign("02-constant-reversal")
        expected = self.values(campaign)
        self.book(campaign)
        file = self.folder / "02-constant-reversal.xlsx"
        self.assertEqual(self.read_again(campaign, file, "Readings Z"), expected)
        openpyxl.load_workbook(file).save(self.folder / "saved.xlsx")
        self.assertEqual(self.read_again(campaign, self.folder / "saved.xlsx", "Readings Z"), expected)

    @unittest.skipUnless(OFFICE, "LibreOffice is not installed (Debian package libreoffice-calc-nogui)")
    def test_libreoffice_reads_and_saves_it(self):
        campaign = self.campaign("02-constant-reversal")
        expected = self.values(campaign)
        self.book(campaign)
        home = self.folder / "office"
        for ending in ("ods", "xlsx"):
            subprocess.run([OFFICE, f"-env:UserInstallation=file://{home}", "--headless", "--convert-to", ending, "--outdir",
                            self.folder / ending, self.folder / "02-constant-reversal.xlsx"],
                           check=True, capture_output=True, timeout=300)
            saved = self.folder / ending / f"02-constant-reversal.{ending}"
            self.assertEqual(self.read_again(campaign, saved, "Readings Z"), expected)
        book = openpyxl.load_workbook(self.folder / "xlsx/02-constant-reversal.xlsx")
        self.assertEqual(len(book["Charts"]._charts), 1)
        ours = rows(openpyxl.load_workbook(self.folder / "02-constant-reversal.xlsx")["Summary"])
        self.assertEqual([r[:10] for r in rows(book["Summary"])], [r[:10] for r in ours])


if __name__ == "__main__":
    unittest.main()
