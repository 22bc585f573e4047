# SPDX-License-Identifier: Apache-2.0
"""nonio new: sites and campaigns that run at once; nothing is written over; example readings say that they are."""
import json
import os
import pathlib
import pty
import signal
import time
import unittest

from verbs import NONIO, VerbTest, readings


class New(VerbTest):
    def run_site(self, site):
        out = self.here("out")
        self.nonio("run", site, "--out", out, "--quiet")
        summary = json.loads((out / "summary.json").read_text())
        return {c["id"]: c["status"] for c in summary["done"]}, out

    def here(self, *names):
        return pathlib.Path(self._folder.name).joinpath(*names)

    def test_a_new_site_runs_and_is_ok(self):
        lab = self.here("lab")
        said = json.loads(self.nonio("new", "site", lab, "--laboratory", 'Lab "Uno"', "--json").stdout)
        self.assertEqual((said["kind"], said["folder"], said["example"]), ("site", str(lab), True))
        self.assertEqual({pathlib.Path(f).name for f in said["files"]}, {"site.toml", "campaign.toml", "EXAMPLE-x.csv"})
        done, out = self.run_site(lab)
        self.assertEqual(done, {"first-campaign": "ok"})
        self.assertTrue((out / "first-campaign" / "report.pdf").stat().st_size > 10000)

    def test_every_example_has_readings_of_its_own(self):
        lab = self.here("lab")
        self.nonio("new", "site", lab, "--defaults")
        for name in ("second", "third"):
            self.nonio("new", "campaign", lab / name, "--defaults", "--axis", "X=0:500", "--axis", "Y=0:500")
        done, out = self.run_site(lab)
        self.assertEqual(done, {"first-campaign": "ok", "second": "ok", "third": "ok"})

    def test_maker_and_serial_or_asset_name_the_machine(self):
        lab = self.here("lab")
        self.nonio("new", "site", lab, "--defaults")
        for name, options in (("a", ("--maker", "Zayer", "--serial", "1234")), ("b", ("--asset", "S-7"))):
            self.nonio("new", "campaign", lab / name, "--defaults", *options)
        _, out = self.run_site(lab)
        machines = {m["machine"] for m in json.loads(self.nonio("machine", "history", out, "--json").stdout)["machines"]}
        self.assertEqual(machines, {"Zayer 1234", "S-7"})
        lines = json.loads(self.nonio("status", "--actions", out, "--json", expect=None).stdout)["lines"]
        self.assertEqual([l["campaigns"] for l in lines if l["id"].startswith("worklist.no-machine")], [["first-campaign"]])

    def test_every_commented_key_is_one(self):
        """With the # taken off, the files are still read without an error (but for placeholders)."""
        lab = self.here("lab")
        self.nonio("new", "site", lab)
        for path in (lab / "site.toml", lab / "first-campaign" / "campaign.toml"):
            lines = []
            for line in path.read_text().splitlines():
                bare = line.removeprefix("# ")
                is_key = line.startswith("# ") and (bare.startswith("[") or " = " in bare.split("#")[0])
                if is_key and not any(bare.startswith(w) for w in ("[signing]", "pkcs12", "password_file", "trust", "exclude", "teeth",
                                                                   "tolerance_arcsec")):
                    line = bare
                lines.append(line)
            path.write_text("\n".join(lines) + "\n")
        done = self.nonio("run", lab, "--out", self.here("out"), expect=None)
        self.assertNotIn("unknown key", done.stderr)
        self.assertNotIn("unknown option", done.stderr)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        results = json.loads((self.here("out") / "first-campaign" / "results.json").read_text())
        self.assertEqual(results["errors"], [])

    def test_what_a_certificate_wants_is_offered_with_its_meaning(self):
        lab = self.here("lab")
        self.nonio("new", "site", lab)
        texts = [path.read_text() for path in (lab / "first-campaign" / "campaign.toml", lab / "site.toml")]
        for key in ("feed_mm_per_min", "dwell_s", "over_travel_mm", "tool_offset", "workpiece_offset", "compensation",
                    "sphere_um", "probe_um", "issuer", "valid_until", "measures", "warm_up", "sensors", "conditions",
                    "no_other_deviations_by", "release", "two_persons"):
            with self.subTest(key):
                line, = (row for text in texts for row in text.splitlines() if row.startswith(f"# {key} = "))
                self.assertRegex(line, r"  # .{15}")

    def test_an_example_says_so_everywhere(self):
        folder = self.here("made", "rossi")
        self.nonio("new", "campaign", folder, "--customer", "Rossi", "--machine", "FP 12")
        done, out = self.run_site(folder.parent)
        results = json.loads((out / "rossi" / "results.json").read_text())
        self.assertEqual(results["campaign"]["customer"], "Rossi (EXAMPLE, NOT MEASURED)")
        self.assertEqual(results["campaign"]["machine"]["model"], "FP 12 (EXAMPLE, NOT MEASURED)")
        self.assertEqual(done["rossi"], "ok")
        self.assertIn("were not measured", (folder / "EXAMPLE-x.csv").read_text())
        self.assertIn("EXAMPLE READINGS, not measured", (folder / "campaign.toml").read_text())
        self.assertIn("EXAMPLE", self.nonio("show", folder).stdout)

    def test_readings_of_ones_own(self):
        source = self.here("laser.csv")
        source.write_text(readings(scale=30.0))
        folder = self.here("made", "own")
        self.nonio("new", "campaign", folder, "--axis", "X=0:400", "--file", f"X={source}", "--customer", "Rossi",
                   "--instrument", "Laser")
        self.assertEqual((folder / "laser.csv").read_bytes(), source.read_bytes())
        self.assertNotIn("EXAMPLE", (folder / "campaign.toml").read_text())
        self.assertEqual(self.run_site(folder.parent)[0]["own"], "ok")

    def test_several_axes_and_a_rotary_one(self):
        folder = self.here("made", "many")
        self.nonio("new", "campaign", folder, "--axis", "X=0:800", "--axis", "Y=-300:300", "--axis", "C=0:360")
        done, out = self.run_site(folder.parent)
        self.assertEqual(done["many"], "ok")
        results = json.loads((out / "many" / "results.json").read_text())
        measured = {a["measurement"]: a["values"]["A"]["unit"] for a in results["analyses"] if a["plugin"] == "iso230-2"}
        self.assertEqual(measured, {"X": "um", "Y": "um", "C": "arcsec"})

    def test_a_folder_alone(self):
        lab = self.here("lab")
        self.assertEqual(json.loads(self.nonio("new", lab, "--empty", "--json").stdout)["kind"], "site")
        self.assertEqual(os.listdir(lab), ["site.toml"])
        inside = json.loads(self.nonio("new", lab / "2026" / "Rossi FP12", "--json").stdout)
        self.assertEqual(inside["kind"], "campaign")
        self.assertIn('id = "rossi-fp12"', (lab / "2026" / "Rossi FP12" / "campaign.toml").read_text())

    def test_what_is_there_stays(self):
        (self.folder / "campaign.toml").write_text("mine")
        for words in (["campaign", self.folder], ["site", self.folder], [self.folder]):
            self.assertIn("exists", self.nonio("new", *words, expect=2).stderr)
        self.assertEqual(os.listdir(self.folder), ["campaign.toml"])
        self.assertEqual((self.folder / "campaign.toml").read_text(), "mine")

    def test_refused_without_a_trace(self):
        bad = self.here("bad.csv")
        bad.write_text(readings().replace("111,", "1l1,", 1))
        (self.site / "site.toml").write_text("")
        (self.folder / "campaign.toml").write_text('format = 1\n[campaign]\nid = "taken"\n')
        new = self.site / "new"
        for words, said in ((["--id", "Bad Id"], 'nearest: "bad-id"'), (["--id", "taken"], "expected another"),
                            (["--axis", "X=9:1"], "FROM below TO"), (["--axis", "X=0:1", "--axis", "X=0:2"], "twice"),
                            (["--file", f"X={bad}"], "bad.csv:"), (["--file", "X=/nowhere.csv"], "/nowhere.csv"),
                            (["--file", "x.csv"], "AXIS=PATH"), (["--date", "3.11.2026"], "date"),
                            (["--control", "simens-840d"], "siemens-840d"),
                            (["--customer", "a\nb"], "one line")):
            done = self.nonio("new", "campaign", new, *words, expect=2)
            self.assertIn(said, done.stderr, words)
            self.assertFalse(new.exists(), words)
        self.assertIn("1l1", self.nonio("new", "campaign", new, "--file", f"X={bad}", expect=2).stderr)


class Asked(VerbTest):
    def session(self, *words, answers=(), end=None):
        """The status and all that the terminal showed; each answer follows a question."""
        child, terminal = pty.fork()
        if child == 0:
            os.execv(NONIO, [NONIO, "new", *map(str, words)])
        shown = b""
        def until(what, seconds=60):
            nonlocal shown
            limit = time.monotonic() + seconds
            while what not in shown[seen:] and time.monotonic() < limit:
                try:
                    shown += os.read(terminal, 4096)
                except OSError:
                    return
        seen = 0
        for answer in answers:
            until(b": ")
            seen = len(shown)
            os.write(terminal, answer.encode() + b"\n")
            until(b"\n")  # its echo; the next question may already follow it
            seen = shown.index(b"\n", seen) + 1
        if end is not None:
            until(b": ")
            os.write(terminal, end)
        seen = len(shown)
        until(b"\0 never", 60)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        os.close(terminal)
        return status, shown.decode()

    def test_questions_with_defaults(self):
        folder = self.site / "Officine 7"
        status, shown = self.session("campaign", folder, answers=["", "Rossi", "", "2026-11-03", "Zayer", "FP 12", "0417", "", "",
                                                                  "X=0:800 C=0:360", "", ""])
        self.assertEqual(status, 0, shown)
        self.assertIn("[officine-7]", shown)
        text = (folder / "campaign.toml").read_text()
        for part in ('id = "officine-7"', '"Rossi (EXAMPLE', "date = 2026-11-03", 'maker = "Zayer"', '"0417"', "[machine.axes.C]"):
            self.assertIn(part, text)
        self.nonio("show", folder)

    def test_ends_without_writing(self):
        for end, status in ((b"\x04", 130), (b"\x03", -signal.SIGINT)):
            folder = self.site / "gone"
            self.assertEqual(self.session("campaign", folder, answers=["", "Rossi"], end=end)[0], status)
            self.assertFalse(folder.exists())

    def test_options_and_defaults_are_not_asked_for(self):
        status, shown = self.session("campaign", self.site / "quick", "--defaults")
        self.assertEqual(status, 0, shown)
        self.assertNotIn("Customer", shown)


if __name__ == "__main__":
    unittest.main()
