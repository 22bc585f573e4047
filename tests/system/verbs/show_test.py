# SPDX-License-Identifier: Apache-2.0
"""nonio show, also of a machine and on the desktop; colours on a terminal only."""
import json
import os
import pathlib
import pty
import subprocess
import unittest

from verbs import NONIO, VerbTest, manifest, readings

INSTRUMENT = """[instrument]
U_fixed_um = 0.2
U_per_m_um = 0.5
[environment]
misalignment_mm = 0.5
temperature_range_K = 0.2
temperature_difference_K = 0.5
expansion_range_um_per_m_K = 1.0
drift_um = 0.2
"""


def on_terminal(*words, **environment):
    """What the program writes to a terminal, and its status."""
    child, terminal = pty.fork()
    if child == 0:
        os.execve(NONIO, [NONIO, *map(str, words)], {"TERM": "xterm", "PATH": os.environ["PATH"], **environment})
    shown = b""
    while True:
        try:
            part = os.read(terminal, 4096)
        except OSError:
            break
        if not part:
            break
        shown += part
    os.close(terminal)
    return shown, os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


class Nights(VerbTest):
    def setUp(self):
        super().setUp()
        self.out = self.site.parent / "out"
        text = manifest(effects=None, extra=INSTRUMENT)
        self.campaign(text.replace('kind = "linear"', 'kind = "linear"\nexpansion_um_per_m_K = 11.5\n'
                                   'tolerance_um = { A = 0.001, B = 100.0, F = 5.0 }', 1),
                      x=readings(backlash=-6.0, drift=9.0))

    def night(self, *words, expect=0):
        return self.nonio("run", self.site, "--out", self.out, *words, expect=expect)

    def broken(self):
        folder = self.site / "broken"
        folder.mkdir()
        (folder / "campaign.toml").write_text(manifest(effects=None, campaign_id="broken"))
        (folder / "x.csv").write_text("run,direction,target_mm,deviation_um\n1,+,O,1\n")


class Show(Nights):
    def test_campaign_and_its_results_say_the_same(self):
        now = self.nonio("show", self.folder).stdout
        self.assertEqual(os.listdir(self.folder.parent), ["c"])
        self.night()
        report = f"\nReport: {self.out}/c/report.pdf"
        self.assertEqual(now, self.nonio("show", self.out / "c").stdout.replace(report, ""))
        written = (self.out / "c" / "results.json").read_text()
        self.assertEqual(self.nonio("show", self.out / "c", "--json").stdout, written)
        self.assertEqual(self.nonio("show", self.folder, "--json").stdout, written)

    def test_what_it_says(self):
        self.night()
        results = json.loads((self.out / "c" / "results.json").read_text())
        shown = self.nonio("show", self.out / "c", "--all").stdout
        self.assertRegex(shown, r"^c  action required\n")
        self.assertRegex(shown, r"(?m)^    !  A +[\d.]+ +[\d.]+ +um +0\.001 +does not conform$")
        self.assertRegex(shown, r"(?m)^    ok B +[\d.]+ +[\d.]+ +um +100 +conforms$")
        self.assertLess(shown.index("does not conform"), shown.index("  conforms"))
        self.assertIn("axis X, F: there is no value", shown)
        found = [f for a in results["analyses"] for f in a["findings"]]
        self.assertTrue(any(f["id"].startswith("reversal.") for f in found))
        as_one = " ".join(shown.split())
        for finding in found:
            self.assertIn(" ".join(finding["advice"].split()), as_one)
        for output in results["outputs"]:
            self.assertIn(output["file"], shown)
        self.assertNotIn("{", shown)
        self.assertLessEqual(max(map(len, shown.splitlines())), 100)

    def test_what_matters_comes_first_and_once(self):
        self.night()
        results = json.loads((self.out / "c" / "results.json").read_text())
        shown = self.nonio("show", self.out / "c").stdout
        self.assertLess(len(shown.splitlines()), len(self.nonio("show", self.out / "c", "--all").stdout.splitlines()))
        self.assertRegex(shown, r"(?m)^    !  A .*does not conform$")
        self.assertNotRegex(shown, r"(?m)A\+ ")
        self.assertIn("axis X, F: there is no value", shown)
        self.assertIn(f"Report: {self.out}/c/report.pdf\n", shown)
        self.assertNotIn("values.csv", shown)
        self.assertNotIn("attention", shown)
        for a in results["analyses"]:
            for f in a["findings"]:
                if f["severity"] == "attention":
                    self.assertEqual(1, " ".join(shown.split()).count(" ".join(f["advice"].split())))

    def test_a_limit_of_no_axis_is_named_by_its_measurement(self):
        path = self.folder / "campaign.toml"
        path.write_text(path.read_text() + '[[measurement]]\nid = "flat"\nkind = "straightness"\naxis = "X"\nlateral = "Y"\n'
                        'file = "x.csv"\ntolerance_um = { nothing = 1.0 }\n')
        shown = self.nonio("show", self.folder).stdout
        self.assertIn("  flat, nothing: there is no value", shown)
        self.assertNotIn("Axis ,", shown)

    def test_a_machine(self):
        self.night()
        machine = json.loads(self.nonio("machine", "list", self.out, "--json").stdout)["machines"][0]["machine"]
        if machine:
            self.assertEqual(self.nonio("show", machine, "--out", self.out).stdout,
                             self.nonio("machine", "history", self.out, machine).stdout)
        self.assertIn("no machine", self.nonio("show", "nobody", "--out", self.out, expect=2).stderr)

    def test_a_failed_campaign_shows_its_errors(self):
        self.broken()
        self.night(expect=1)
        for folder in (self.site / "broken", self.out / "broken"):
            shown = self.nonio("show", folder, expect=1).stdout
            self.assertIn("failed", shown)
            self.assertIn("x.csv:2 (target_mm): expected a number", shown)

    def test_other_folders(self):
        self.night()
        self.assertIn(str(self.out / "ID"), self.nonio("show", self.out, expect=2).stderr)
        self.assertIn("campaign.toml", self.nonio("show", self.site, expect=2).stderr)
        (self.out / "c" / "results.json").write_text('{"schema": 7}')
        self.assertIn("results.json", self.nonio("show", self.out / "c", expect=2).stderr)

    def test_the_samples(self):
        site = pathlib.Path(__file__).resolve().parents[3] / "samples" / "site"
        for folder in sorted(site.glob("*/campaign.toml")):
            done = self.nonio("show", folder.parent, expect=1 if "08-broken" in str(folder) else 0)
            self.assertNotIn("{", done.stdout)
            self.assertLessEqual(max(map(len, done.stdout.splitlines())), 100, folder)


class Open(Nights):
    def open(self, *words, expect=0, **environment):
        done = subprocess.run([NONIO, "show", "--open", *map(str, words)], capture_output=True, text=True, check=False,
                              cwd=self.site.parent, env={"PATH": "/usr/bin:/bin", **environment})
        self.assertEqual(done.returncode, expect, done.stderr)
        return done

    def test_without_a_desktop_the_path_is_printed(self):
        self.night()
        report = str(self.out / "c" / "report.pdf")
        for words in ([self.out / "c"], [self.folder, "--out", self.out], [self.folder], [self.out], []):
            done = self.open(*words)
            self.assertEqual(done.stdout, report + "\n")
            self.assertIn("no desktop", done.stderr)

    def test_the_report_in_its_language(self):
        (self.site / "site.toml").write_text('[options.pdf-report]\nlanguage = "it"\n')
        self.night()
        self.assertEqual(self.open(self.out / "c").stdout, str(self.out / "c" / "report-it.pdf") + "\n")

    def test_on_a_desktop_it_is_opened(self):
        self.night()
        programs, opened = self.site.parent / "programs", self.site.parent / "opened"
        programs.mkdir()
        (programs / "xdg-open").write_text(f'#!/bin/sh\nprintf %s "$1" > {opened}.new && mv {opened}.new {opened}\n')
        (programs / "xdg-open").chmod(0o755)
        done = self.open(self.out / "c", DISPLAY=":9", PATH=f"{programs}:/usr/bin:/bin")
        self.assertEqual(done.stderr, "")
        for _ in range(200):
            if opened.exists():
                break
            subprocess.run(["sleep", "0.1"], check=True)
        self.assertEqual(opened.read_text() + "\n", done.stdout)
        self.assertIn("xdg-open is not installed", self.open(self.out / "c", DISPLAY=":9", PATH=str(self.site)).stderr)

    def test_what_cannot_be_opened(self):
        self.assertIn("--out", self.open(self.folder, expect=2).stderr)
        self.assertIn("there is no folder out", self.open(expect=2).stderr)
        self.night()
        (self.out / "c" / "report.pdf").unlink()
        self.assertIn("report.pdf", self.open(self.out / "c", expect=1).stderr)

    def test_a_run_without_a_report_opens_its_summary(self):
        self.broken()
        self.night(expect=1)
        listed = self.open(self.out)
        self.assertIn("failed    broken", listed.stderr)
        self.assertEqual(listed.stdout, str(self.out / "c" / "report.pdf") + "\n")
        self.assertEqual(self.open(self.out / "broken").stdout, str(self.out / "broken" / "results.json") + "\n")


class Colours(Nights):
    def test_on_a_terminal_only(self):
        self.broken()
        again = [["show", self.folder], ["help"], ["run", self.site, "--out", self.out, "--force"]]
        for words in again:
            done = self.nonio(*words, expect=None)
            self.assertNotIn("\033", done.stdout + done.stderr, words)
            shown = on_terminal(*words)[0]
            self.assertTrue(b"\033[1m" in shown or b"\033[31m" in shown, words)
            self.assertNotIn(b"\033[3", on_terminal(*words, NO_COLOR="1")[0], words)
            self.assertNotIn(b"\033[1m", on_terminal(*words, NO_COLOR="1")[0], words)
            self.assertNotIn(b"\033[3", on_terminal(*words, TERM="dumb")[0], words)

    def test_the_colour_shows_the_status(self):
        self.broken()
        shown, status = on_terminal("run", self.site, "--out", self.out)
        self.assertEqual(status, 1)
        self.assertIn(b"\033[31mfailed", shown)
        self.assertIn(b"\033[31mdoes not conform\033[0m", on_terminal("show", self.folder)[0])
        self.assertIn(b"\033[33maction required\033[0m", on_terminal("show", self.folder)[0])

    def test_never_in_json(self):
        for words in (["show", self.folder, "--json"], ["version", "--json"], ["run", self.site, "--out", self.out, "--json"]):
            self.assertNotIn(b"\033", on_terminal(*words)[0], words)


if __name__ == "__main__":
    unittest.main()
