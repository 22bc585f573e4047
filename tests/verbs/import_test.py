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

    def test_a_campaign_for_each_machine_and_day_that_a_night_can_run(self):
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
        self.assertIn("the file says axis Y, the manifest X", said["campaigns"][0]["files"][0]["lacks"][0])

    def test_what_is_there_is_not_touched(self):
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 3]))
        self.run_import()
        manifest = self.site / "2024-03-02-fp12/campaign.toml"
        manifest.write_text("mine", encoding="utf-8")
        said = self.run_import("--partial", status=1)
        self.assertIn("is there; it is left as it is", said["campaigns"][0]["lacks"][0])
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
        self.assertIn("is there; it is left as it is", self.run_import(status=1)["campaigns"][0]["lacks"][0])
        (self.source / "FP12_Y_20240302.rtl").unlink()
        self.file("FP12_X_20240302.rtl", rtl([1, 2, 9]))
        self.assertIn("is there; it is left as it is", self.run_import(status=1)["campaigns"][0]["lacks"][0])
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

    def test_a_wrong_rule_is_named_with_its_line(self):
        rule = self.root / "rule.toml"
        rule.write_text('pattern = "{a}{b}.rtl"\npatern = "x"\n', encoding="utf-8")
        said = self.run_import(rule=str(rule), status=2)
        self.assertIn("rule.toml:1: pattern: wanted something between {a} and {b}", said)
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
