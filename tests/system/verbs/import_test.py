# SPDX-License-Identifier: Apache-2.0
"""nonio import: what it takes, what it asks for, and what it leaves alone."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

NONIO = os.environ["NONIO"]


def rtl(readings, axis=""):
    rows = "".join(f"1 {i} {v}\n" for i, v in enumerate(readings, 1))
    return (f"HEADER::\nFile type  : rtl\nOwner      : Linear\nTARGET DATA::\nTarget-count: {len(readings)}\nTargets :\n"
            + " ".join(str(100 * i) for i in range(len(readings))) + "\nUSER-TEXT::\nMachine:\nSerial No:\nDate:\nBy:\n"
            + f"Axis:{axis}\nLocation:\nTITLE:\nRUNS::\nRun-count:1\nDEVIATIONS::\nRun Target Data:\n{rows}EOF::\n")


class Import(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="nonio-import-")
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        self.source, self.site = self.root / "laser", self.root / "site"
        self.source.mkdir()

    def file(self, name, text):
        path = self.source / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def run_import(self, *more, rule="{machine}_{axis}_{date}.rtl", status=0):
        done = subprocess.run([NONIO, "import", str(self.source), "--rule", rule, "--out", str(self.site), "--json", *more],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return json.loads(done.stdout) if done.stdout else done.stderr

    def tree(self):
        return sorted(str(p.relative_to(self.root)) for p in self.root.rglob("*"))

    def test_a_campaign_for_each_machine_and_day_that_can_be_run(self):
        self.file("week1/FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.file("week1/FP12_Y_20240302.rtl", rtl([1, 2, 4]))
        self.file("week2/FP14_X_2024-03-09.rtl", rtl([3, 2, 3]))
        said = self.run_import()
        self.assertEqual([c["id"] for c in said["campaigns"]], ["2024-03-02-fp12", "2024-03-09-fp14"])
        self.assertTrue(all(c["written"] for c in said["campaigns"]))
        self.assertEqual(said["campaigns"][0]["files"][1]["axis"], "Y")
        self.assertEqual(said["campaigns"][0]["files"][1]["readings"], 3)
        done = subprocess.run([NONIO, "run", str(self.site), "--out", str(self.root / "out")], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        results = json.loads((self.root / "out/2024-03-02-fp12/results.json").read_text(encoding="utf-8"))
        self.assertEqual({a["measurement"] for a in results["analyses"] if a["plugin"] == "iso230-2"}, {"X", "Y"})

    def test_a_dry_run_says_the_same_and_writes_nothing(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        before = self.tree()
        dry = self.run_import("--dry-run")
        self.assertEqual(self.tree(), before)
        wet = self.run_import()
        self.assertEqual(dry["campaigns"][0]["files"], wet["campaigns"][0]["files"])
        self.assertFalse(dry["campaigns"][0]["written"])

    def test_duplicates_are_found_by_content(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.file("back/FP12_X_20240302.rtl", rtl([1, 2, 3]))
        said = self.run_import()
        self.assertEqual(said["duplicates"], [{"file": "back/FP12_X_20240302.rtl",
                                               "why": "the same bytes as FP12_X_20240302.rtl"}])
        self.assertTrue(said["campaigns"][0]["written"])

    def test_the_same_readings_under_two_names_are_never_merged(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.file("FP12_Y_20240302.rtl", rtl([1, 2, 3], axis=" "))
        said = self.run_import(status=1)
        self.assertIn("the same readings as FP12_X_20240302.rtl", said["campaigns"][0]["files"][1]["lacks"][0])
        self.assertFalse(self.site.exists())

    def test_an_edited_copy_is_not_chosen_in_silence(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.file("edit/FP12_X_20240302.rtl", rtl([1, 2, 9]))
        said = self.run_import(status=1)
        lacks = " ".join(said["campaigns"][0]["files"][1]["lacks"])
        self.assertIn('another file is measurement "X"', lacks)
        self.assertFalse(self.site.exists())

    def test_an_axis_that_no_name_says_is_asked_for(self):
        self.file("FP12_20240302.rtl", rtl([1, 2, 3]))
        rule = "{machine}_{date}.rtl"
        said = self.run_import(rule=rule, status=1)
        self.assertTrue(said["campaigns"][0]["files"][0]["lacks"][0].startswith("axis: which axis"))
        self.assertFalse(self.site.exists())
        self.run_import("--partial", rule=rule, status=1)
        text = (self.site / "2024-03-02-fp12/campaign.toml").read_text(encoding="utf-8")
        self.assertIn("# to fill: axis", text)
        done = subprocess.run([NONIO, "run", str(self.site), "--out", str(self.root / "out")], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("axis is missing", (self.root / "out/2024-03-02-fp12/results.json").read_text(encoding="utf-8")
                      .replace("axis: is missing", "axis is missing"))

    def test_the_axis_in_the_file_may_not_contradict_the_name(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3], axis="Y"))
        self.file("FP12_Y_20240302.rtl", rtl([1, 2, 4], axis="Y"))
        said = self.run_import(status=1)
        self.assertIn("the file states axis Y, the manifest X", said["campaigns"][0]["files"][0]["lacks"][0])

    def test_what_is_there_is_not_touched(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.run_import()
        manifest = self.site / "2024-03-02-fp12/campaign.toml"
        manifest.write_text("mine", encoding="utf-8")
        said = self.run_import("--partial", status=1)
        self.assertIn("exists and is not changed", said["campaigns"][0]["lacks"][0])
        self.assertEqual(manifest.read_text(encoding="utf-8"), "mine")

    def test_a_second_time_there_is_nothing_to_do(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.run_import()
        manifest = self.site / "2024-03-02-fp12/campaign.toml"
        manifest.write_text(manifest.read_text("utf-8") + '[run]\noutputs = ["json"]\n', encoding="utf-8")
        before = {p: p.read_bytes() for p in self.site.rglob("*") if p.is_file()}
        for more in ((), ("--dry-run",), ("--partial",)):
            said = self.run_import(*more)["campaigns"][0]
            self.assertEqual((said["there"], said["written"], said["whole"], said["lacks"]), (True, False, True, []))
        self.assertEqual({p: p.read_bytes() for p in self.site.rglob("*") if p.is_file()}, before)
        # A file that came later, or another one of that name, is no repetition.
        self.file("FP12_Y_20240302.rtl", rtl([1, 2, 4]))
        self.assertIn("exists and is not changed", self.run_import(status=1)["campaigns"][0]["lacks"][0])
        (self.source / "FP12_Y_20240302.rtl").unlink()
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 9]))
        self.assertIn("exists and is not changed", self.run_import(status=1)["campaigns"][0]["lacks"][0])
        self.assertEqual({p: p.read_bytes() for p in self.site.rglob("*") if p.is_file()}, before)

    def test_a_link_for_a_campaign_is_not_followed(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.site.mkdir()
        (self.root / "elsewhere").mkdir()
        (self.site / "2024-03-02-fp12").symlink_to(self.root / "elsewhere")
        self.run_import(status=1)
        self.assertEqual(list((self.root / "elsewhere").iterdir()), [])

    def test_links_are_not_read(self):
        (self.root / "secret.rtl").write_text(rtl([1, 2, 3]), encoding="utf-8")
        (self.source / "FP12_X_20240302.rtl").symlink_to(self.root / "secret.rtl")
        self.run_import(status=1)
        self.assertFalse(self.site.exists())

    def test_a_name_of_two_readings_is_refused(self):
        self.file("FP_12_X_20240302.rtl", rtl([1, 2, 3]))
        self.file("a_b_c.rtl", rtl([1, 2, 4]))
        said = self.run_import(rule="{machine}_{part}.rtl", status=1)
        self.assertEqual({u["why"] for u in said["unmatched"]}, {"its name can be read in two ways by the pattern"})

    def test_a_rule_of_a_file(self):
        self.file("FP12/X/run.log", rtl([1, 2, 3]))
        self.file("FP12/old/X/run.log", rtl([1, 2, 7]))
        rule = self.root / "rule.toml"
        rule.write_text('pattern = "{machine}/{axis}/run.log"\ncampaign = "spring-{machine}"\nexclude = ["old/"]\n'
                        '[manifest.campaign]\ncustomer = "Rossi"\n[manifest.machine.axes.X]\nscrew_pitch_mm = 20.0\n',
                        encoding="utf-8")
        said = self.run_import(rule=str(rule))
        self.assertEqual(said["excluded"][0]["file"], "FP12/old/X/run.log")
        text = (self.site / "spring-fp12/campaign.toml").read_text(encoding="utf-8")
        self.assertIn("Rossi", text)
        self.assertIn("screw_pitch_mm", text)

    def rule(self, text):
        path = self.root / "rule.toml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    def files_of(self, said):
        return {f["file"]: f for c in said["campaigns"] for f in c["files"]}

    def test_a_small_letter_is_the_axis_and_is_said(self):
        self.file("week42/x/rawdata/x_230_2_edit.rtl", rtl([1, 2, 3]))
        self.file("week42/y/rawdata/y_230_2.rtl", rtl([1, 2, 4]))
        self.file("week42/y/rawdata/z_230_2.rtl", rtl([1, 2, 5]))
        said = self.run_import(rule="{week}/{axis}/rawdata/{axis}_230_2{*}.rtl")
        files = self.files_of(said)
        self.assertEqual({f: (v["axis"], v["measurement"]) for f, v in files.items()},
                         {"week42/x/rawdata/x_230_2_edit.rtl": ("X", "X"), "week42/y/rawdata/y_230_2.rtl": ("Y", "Y")})
        self.assertEqual(files["week42/x/rawdata/x_230_2_edit.rtl"]["assumed"], ['axis X for "x" in its name'])
        self.assertEqual([u["file"] for u in said["unmatched"]], ["week42/y/rawdata/z_230_2.rtl"])
        self.assertIn('axis = "X"', (self.site / "week42/campaign.toml").read_text("utf-8").replace("'", '"'))

    def test_places_that_end_by_themselves_need_nothing_between(self):
        self.file("target_w42_x_8A.rtl", rtl([1, 2, 3]))
        self.file("target_w42_y.rtl", rtl([1, 2, 4]))
        self.file("target_w42_x8.rtl", rtl([1, 2, 5]))  # axis X, or X8?
        said = self.run_import(rule="target_{week}_{axis}{*}.rtl")
        self.assertEqual({f: v["axis"] for f, v in self.files_of(said).items()},
                         {"target_w42_x_8A.rtl": "X", "target_w42_y.rtl": "Y"})
        self.assertEqual(said["unmatched"], [{"file": "target_w42_x8.rtl", "why":
                                              "its name can be read in two ways by the pattern"}])

    def test_a_word_that_is_no_axis_is_none(self):
        self.file("fp12_report_20240302.rtl", rtl([1, 2, 3]))
        said = self.run_import(status=1)
        self.assertEqual([u["file"] for u in said["unmatched"]], ["fp12_report_20240302.rtl"])

    def test_axes_that_the_rule_states(self):
        self.file("FP12_axis1_20240302.rtl", rtl([1, 2, 3]))
        self.file("FP12_laengs_20240302.rtl", rtl([1, 2, 4]))
        self.file("FP12_x_20240302.rtl", rtl([1, 2, 5]))
        rule = 'pattern = "{machine}_{axis}_{date}.rtl"\n[axes]\naxis1 = "X"\nlaengs = "Y"\n'
        said = self.run_import(rule=self.rule(rule))
        files = self.files_of(said)
        self.assertEqual({f: v["axis"] for f, v in files.items()},
                         {"FP12_axis1_20240302.rtl": "X", "FP12_laengs_20240302.rtl": "Y"})
        self.assertEqual(files["FP12_axis1_20240302.rtl"]["assumed"],
                         ['axis X for "axis1" in its name, as the rule states'])
        self.assertEqual([u["file"] for u in said["unmatched"]], ["FP12_x_20240302.rtl"])
        for wrong, words in (('[axes]\naxis1 = "x 1"\n', "expected an axis of capital letters and digits"),
                             ('axis = "X"\n[axes]\naxis1 = "X"\n', "expected the axis here or at {axis}")):
            self.assertIn(words, self.run_import(rule=self.rule('pattern = "{machine}_{axis}_{date}.rtl"\n' + wrong),
                                                 status=2))

    def test_one_axis_of_all_files_as_the_rule_states(self):
        self.file("FP12_20240302.rtl", rtl([1, 2, 3]))
        said = self.run_import(rule=self.rule('pattern = "{machine}_{date}.rtl"\naxis = "X"\n'))
        self.assertEqual(self.files_of(said)["FP12_20240302.rtl"]["assumed"], ["axis X, as the rule states"])
        self.assertTrue(said["campaigns"][0]["written"])

    def test_equal_readings_are_said_once(self):
        for n, comment in enumerate(("", "\n", "\n\n", "\n\n\n")):
            self.file(f"FP12/X/rawdata/x_{n}.rtl", rtl([1, 2, 3]) + comment)
        rule = "{machine}/{axis}/rawdata/{*}.rtl"
        said = self.run_import(rule=rule, status=1)
        lacks = [f["lacks"] for f in said["campaigns"][0]["files"]]
        self.assertEqual(lacks[0], [])
        self.assertEqual([len(one) for one in lacks[1:]], [1, 1, 1])
        self.assertEqual(lacks[1][0], 'the same readings as FP12/X/rawdata/x_0.rtl; exclude one of them, in the rule: '
                                      'exclude = ["FP12/X/rawdata/x_1.rtl"]')
        done = subprocess.run([NONIO, "import", str(self.source), "--rule", rule, "--out", str(self.site)],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.stdout.count("\n"), 7, done.stdout)
        exclude = ", ".join(f'"FP12/X/rawdata/x_{n}.rtl"' for n in (1, 2, 3))
        self.assertTrue(self.run_import(rule=self.rule(f'pattern = "{rule}"\nexclude = [{exclude}]\n'))
                        ["campaigns"][0]["written"])

    def test_the_machine_is_named_by_options_or_by_names_of_files(self):
        self.file("Zayer_0417_X_20240302.rtl", rtl([1, 2, 3]))
        rule = "{maker}_{serial}_{axis}_{date}.rtl"
        self.assertEqual(self.run_import("--dry-run", rule=rule)["campaigns"][0]["machine"], "Zayer 0417")
        self.assertEqual(self.run_import("--dry-run", "--asset", "S-7", rule=rule)["campaigns"][0]["machine"], "S-7")
        self.assertEqual(self.run_import("--dry-run", rule="{*}_{axis}_{date}.rtl")["campaigns"][0]["machine"], "")

    def test_many_files_that_follow_no_pattern_are_counted(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        for n in range(50):
            self.file(f"note{n}.txt", str(n))
        done = subprocess.run([NONIO, "import", str(self.source), "--rule", "{machine}_{axis}_{date}.rtl", "--out",
                               str(self.site), "--dry-run"], capture_output=True, text=True, check=False)
        self.assertIn("and 30 more (--json lists them all)", done.stdout)
        self.assertEqual(len(self.run_import("--dry-run")["unmatched"]), 50)

    def test_text_of_excel_and_a_mark_before_an_rtl(self):
        table = "run\tdirection\ttarget_mm\tdeviation_um\r\n1\t+\t0\t1,5\r\n1\t+\t10\t2,5\r\n"
        (self.source / "FP12_X_20240302.txt").write_bytes(table.encode("utf-16"))
        (self.source / "FP12_Y_20240302.txt").write_bytes(b"sep=;\r\n# gepr\xfcft\r\n" +
                                                          table.replace("\t", ";").replace("1,5", "1,7").encode())
        (self.source / "FP12_Z_20240302.txt").write_bytes(b"\xef\xbb\xbf" + rtl([1, 2, 4]).encode())
        said = self.run_import(rule="{machine}_{axis}_{date}.txt")
        self.assertEqual([(f["axis"], f["reader"], f["readings"]) for f in said["campaigns"][0]["files"]],
                         [("X", "csv", 2), ("Y", "csv", 2), ("Z", "renishaw-rtl", 3)])

    def test_a_long_table_with_two_tables(self):
        rows = "".join(f"{c};{p};{t};{t + c / 100:.3f}\n" for c in (1, 2) for p, t in enumerate((0, 10, 20), 1))
        back = "".join(f"{c};{p};{t};{t + c / 50:.3f}\n" for c in (1, 2) for p, t in ((3, 20), (2, 10), (1, 0)))
        self.file("x/target_x_230.csv", "Forward\n" + rows + "Backward\n" + back)
        rule = ('pattern = "{axis}/target_{axis}_{*}.csv"\ncampaign = "spring"\nreader = "long-table"\n'
                '[manifest.options.long-table]\ncolumns = ["cycle", "pos", "target", "value"]\nvalues = "positions"\n'
                'target_unit = "mm"\nvalue_unit = "mm"\nseparator = ";"\ntables = [%s]\n')
        said = self.run_import(rule=self.rule(rule % '"2-7 forward", "9-14 reverse"'))
        self.assertEqual(self.files_of(said)["x/target_x_230.csv"]["readings"], 12)
        done = subprocess.run([NONIO, "run", str(self.site), "--out", str(self.root / "out")], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        results = json.loads((self.root / "out/spring/results.json").read_text(encoding="utf-8"))
        iso = next(a for a in results["analyses"] if a["plugin"] == "iso230-2")
        self.assertAlmostEqual(iso["values"]["B_mean"]["value"], 15.0 - 30.0)

    def test_files_of_the_e1733a_are_refused_by_name(self):
        (self.source / "FP12_X_20240302.Lin").write_bytes(b"\x00\x01E1733A")
        said = self.run_import(rule="{machine}_{axis}_{date}.Lin", status=1)
        self.assertIn("Keysight's laser program E1733A", said["campaigns"][0]["files"][0]["lacks"][0])
        self.assertFalse(self.site.exists())

    def test_a_wrong_rule_is_named_with_its_line(self):
        rule = self.root / "rule.toml"
        rule.write_text('pattern = "{a}{b}.rtl"\npatern = "x"\n', encoding="utf-8")
        said = self.run_import(rule=str(rule), status=2)
        self.assertIn("rule.toml:1: pattern: expected something between {a} and {b}", said)
        self.assertIn("patern", said)

    def test_a_file_that_no_reader_takes_is_said(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]).replace(": rtl", ": rtx"))
        said = self.run_import(status=1)
        self.assertIn("dynamic capture", said["campaigns"][0]["files"][0]["lacks"][0])

    def test_the_site_may_not_lie_in_the_folder(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.site = self.source / "site"
        self.assertIn("outside of the folder", self.run_import(status=2))


if __name__ == "__main__":
    unittest.main()
