#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`table session`: from a backup and readings to the verdict by the commands that it prints, on axes of known errors whose
control is replayed by independent parsers."""
import math
import os
import pathlib
import random
import shlex
import shutil
import unittest

from bench import axis_csv
from parsers import OPTIONS, STEP, TABLE, Table, siemens
from truth import FOUR, StateBench, Truth

SEEDS = [int(s) for s in os.environ.get("SEEDS", "21").split(",")]
LONG = bool(os.environ.get("NONIO_LONG"))
TURN = random.randrange(2)  # of two cases each control has one, in the next run of the tests perhaps the other


class Session(StateBench):
    def step(self, answer, name):
        return next((s["state"] for s in answer["steps"] if s["step"] == name), None)

    def go(self, command, expect=0, **words):
        """Runs the command that the session printed, with what it leaves open filled in."""
        for mark, text in words.items():
            command = command.replace(mark.replace("_", "-"), str(text))
        self.commands += 1
        args = shlex.split(command)
        self.assertEqual(args[0], "nonio")
        return self.json_of(*args[1:], expect=expect)

    def begin(self, control, seed, shape="wave"):
        """The machine as it is met: a backup, readings, and nothing typed but number and reference point."""
        self.tearDown(), self.setUp()
        self.commands = 0
        truth = Truth(seed, shape)
        before, backup = self.backup(control, truth)
        truth.lost *= 1.7  # the reversal has grown since
        saved = self.site.parent / "saved"
        shutil.rmtree(saved, ignore_errors=True)
        saved.mkdir()
        for f in backup.split(","):
            shutil.copy(f, saved)
        shutil.rmtree(self.site / "old")
        keys = (self.site / "machines" / "S-1.toml").read_text().count("=") - 2  # without format and asset
        self.assertLessEqual(keys, 2)
        readings = self.site.parent / "x.csv"
        readings.write_text(truth.readings(1, before))
        self.commands += 1
        self.nonio("new", "campaign", self.site / "now", "--id", "now", "--asset", "S-1", "--date", "2024-11-20", "--control", control,
                   "--file", "X=%s" % readings, "--customer", "Rossi", "--operator", "B", "--machine", "FP", "--instrument", "laser")
        more = ["--set", OPTIONS[control].strip().replace(" ", "")] if control in OPTIONS else []
        files = ",".join(str(saved / os.path.basename(f)) for f in backup.split(","))
        return truth, before, " ".join(map(shlex.quote, ["nonio", "table", "session", str(self.site / "now"), "--backup", files] + more))

    def check_file(self, truth, table):
        path = self.site.parent / "after.csv"
        path.write_text(truth.readings(1, table))
        return path

    def test_four_commands_and_two_keys_to_the_verdict(self):
        for number, control in enumerate(FOUR):
            days = ("2024-11-20", "2024-11-21")  # of the check: measured, loaded and checked on one day, too
            for seed in SEEDS:
                for day in days if LONG else (days[(number + TURN) % 2],):
                    with self.subTest(control=control, seed=seed, day=day):
                        truth, before, first = self.begin(control, seed)
                        answer = self.go(first)
                        self.assertEqual([s["state"] for s in answer["steps"]], ["done"] * 4 + ["missing"], answer)
                        table = TABLE[control](self.files(control, self.site / "now" / "load"))
                        self.assertLess(truth.E(1, table), 1.7 + STEP.get(control, 0.0))
                        again = self.json_of(*shlex.split(first)[1:])
                        self.assertEqual(again, answer, "a session has no state of its own")
                        answer = self.go(answer["command"], YYYY_MM_DD="2024-11-20")
                        self.assertEqual((self.step(answer, "loading"), self.step(answer, "check")), ("done", "missing"))
                        answer = self.go(answer["command"] + " --checked " + day, FILE=self.check_file(truth, table))
                        self.assertEqual(answer["verdict"]["answer"], "worked", answer)
                        self.assertLessEqual(self.commands, 4)
                        ids = {f["id"] for f in answer["verdict"]["findings"]}
                        self.assertLessEqual({"before-after.worked", "before-after.reversal-as-predicted"}, ids)
                        # Where it is now follows from the site alone, without the backup.
                        last = self.json_of("table", "session", self.site / "now", *(
                            ["--set", "extended=true"] if control == "fanuc" else []))
                        self.assertEqual(last["verdict"]["answer"], "worked", last)
                        self.nonio("check", self.site)

    def test_what_went_wrong_is_named(self):
        """The control as it may have been loaded: the verdict names it, and the status is 1."""
        kinds = {"not-active": lambda new, old: old,
                 "nothing": lambda new, old: Table([(x, 0.0) for x, _ in new.plus]),
                 "wrong-sign": lambda new, old: Table([(x, -v) for x, v in new.plus], [(x, -v) for x, v in new.minus], -new.backlash),
                 "twice": lambda new, old: Table([(x, 2 * v) for x, v in new.plus], [(x, 2 * v) for x, v in new.minus], new.backlash)}
        found = {}
        controls = ("siemens-840d", "linuxcnc")
        for number, (kind, as_loaded) in enumerate(kinds.items()):
            for control in controls if LONG else (controls[(number + TURN) % 2],):
                with self.subTest(control=control, kind=kind):
                    truth, before, first = self.begin(control, 31)
                    answer = self.go(first)
                    table = TABLE[control](self.files(control, self.site / "now" / "load"))
                    answer = self.go(answer["command"], YYYY_MM_DD="2024-11-21")
                    answer = self.go(answer["command"] + " --checked 2024-11-22", expect=1,
                                     FILE=self.check_file(truth, as_loaded(table, before)))
                    found[control, kind] = [f["id"] for f in answer["verdict"]["findings"]]
                    self.assertEqual(answer["verdict"]["answer"], "failed")
                    self.assertIn("command", answer)
                    named = {"not-active": "before-after.not-active", "nothing": "worklist.table-removed",
                             "wrong-sign": "worklist.table-wrong-sign", "twice": "worklist.table-twice"}[kind]
                    self.assertIn(named, found[control, kind])
                    # Corrected and measured again: the same command, and the readings in place of the first ones.
                    (self.site / "now-check" / "after.csv").write_text(truth.readings(1, table))
                    self.assertEqual(self.go(answer["command"])["verdict"]["answer"], "worked")
        print(found)

    def test_each_refusal_is_a_step_that_names_what_ends_it(self):
        truth, before, first = self.begin("siemens-840d", 41)
        args = shlex.split(first)[1:]
        at = args.index("--backup")
        files = args[at + 1].split(",")
        answer = self.json_of(*args[:at])
        self.assertEqual(answer["steps"][0]["state"], "missing")
        self.assertIn("--backup FILE,...", answer["command"])
        answer = self.json_of(*args[:at], "--backup", files[0], expect=1)
        self.assertEqual(answer["steps"][-1]["state"], "refused")
        self.assertIn("MD32450", answer["steps"][-1]["says"])
        answer = self.json_of(*args[:at], "--backup", self.site / "nothing.ini", expect=1)
        self.assertEqual((answer["steps"][-1]["step"], answer["steps"][-1]["state"]), ("backup", "refused"))
        self.assertIn("nothing.ini", answer["steps"][-1]["says"])
        self.nonio(*args, "--loaded", "2024-11-19", expect=2)
        self.nonio(*args, "--loaded", "soon", expect=2)
        self.nonio(*args, "--checked", "2024-11-22", expect=2)
        # Without an asset the loading cannot be recorded.
        text = (self.site / "now" / "campaign.toml").read_text()
        (self.site / "now" / "campaign.toml").write_text(text.replace('asset = "S-1"', 'maker = "Rossi"') + "[options.siemens-840d.axes.X]\nnumber = 1\n")
        answer = self.json_of(*args, "--loaded", "2024-11-21", expect=1)
        self.assertEqual((answer["steps"][-1]["step"], answer["steps"][-1]["state"]), ("loading", "refused"))
        self.assertIn("asset in [machine]", answer["steps"][-1]["says"])
        (self.site / "now" / "campaign.toml").write_text(text)
        # A check of other targets is not compared, and of a folder that exists nothing is written over.
        answer = self.go(self.json_of(*args)["command"], YYYY_MM_DD="2024-11-21")
        path = self.check_file(truth, before)
        path.write_text("\n".join(l for l in path.read_text().splitlines() if ",%.3f," % truth.targets[2] not in l) + "\n")
        answer = self.go(answer["command"] + " --checked 2024-11-22", FILE=path, expect=1)
        self.assertEqual(answer["verdict"]["answer"], "not decided")
        self.assertIn("before-after.stops", [f["id"] for f in answer["verdict"]["findings"]])
        answer = self.json_of(*args, "--check", path, expect=1)
        self.assertIn("now-check exists", answer["steps"][-1]["says"])

    def test_without_all_targets_nothing_is_predicted(self):
        truth, before, first = self.begin("siemens-840d", 42)
        path = self.site / "now" / "x.csv"
        path = path if path.exists() else next((self.site / "now").glob("*.csv"))
        mark = ",-,%.3f," % truth.targets[3]
        path.write_text("\n".join(l for l in path.read_text().splitlines() if mark not in l) + "\n")
        answer = self.go(first)
        says = next(s["says"] for s in answer["steps"] if s["step"] == "table")
        self.assertIn("is not predicted, because targets were left out", says)
        told = self.nonio(*shlex.split(first)[1:]).stdout + str(answer)
        told += self.nonio("table", "insert", shlex.split(first)[shlex.split(first).index("--backup") + 1], "--with", self.site / "now",
                           "--out", self.site.parent / "left").stdout
        self.assertNotRegex(told, r"(?i)\bnan\b")

    def test_a_later_measurement_is_named_before_loading_and_a_check_goes_before_it(self):
        truth, before, first = self.begin("linuxcnc", 61)
        later = self.campaign_of("later", "2025-06-01", "linuxcnc", truth.readings(1, before))
        said = self.nonio(*shlex.split(first)[1:]).stderr
        self.assertIn("older than that of campaign later of 2025-06-01", said)
        table = TABLE["linuxcnc"](self.files("linuxcnc", self.site / "now" / "load"))
        answer = self.json_of(*shlex.split(first)[1:], "--loaded", "2024-11-21", expect=1)
        self.assertEqual(answer["verdict"]["answer"], "failed", "measured with the old table")
        self.assertIn("later", next(s["says"] for s in answer["steps"] if s["step"] == "check"))
        answer = self.json_of(*shlex.split(first)[1:], "--check", self.check_file(truth, table), "--checked", "2024-11-22")
        self.assertEqual(answer["verdict"]["answer"], "worked")
        self.assertEqual(self.json_of(*shlex.split(first)[1:])["verdict"]["answer"], "worked")

    def test_one_axis_of_several_and_a_rotary_one(self):
        """X, and a rotary axis whose angles are in arcsec over deg: each has its own path, and the check campaign one axis."""
        self.record(["X", "Y", "C"], "", asset="S-1")
        targets = [30.0 * i for i in range(13)]
        of = {"C": lambda t: 9.0 * math.sin(math.radians(t)), "X": lambda t: 5.0 * math.sin(t / 60.0)}
        folder = self.site / "now"
        folder.mkdir()
        text = 'format = 1\n[campaign]\nid = "now"\ndate = 2024-11-20\n[machine]\nasset = "S-1"\ncontrol = "siemens-840d"\n'
        for axis, unit in (("X", "mm"), ("C", "deg")):
            (folder / (axis + ".csv")).write_text(axis_csv(targets, of[axis], lambda t, a=axis: of[a](t) + 4.0, unit))
            text += '[machine.axes.%s]\nkind = "%s"\nactive_table = "none"\nactive_backlash_%s = "none"\n' % (axis, "rotary" if axis == "C" else "linear", unit)
            text += '[[measurement]]\nid = "%s 1"\nkind = "axis"\naxis = "%s"\nfile = "%s.csv"\n' % (axis, axis, axis)
        (folder / "campaign.toml").write_text(text)
        saved = self.site.parent / "saved.ini"
        saved.write_text("%_N_NC_TEA_INI\nCHANDATA(1)\n$MA_BACKLASH[0,AX1]=0\n$MA_BACKLASH[0,AX3]=0\n" + "".join(
            "$AA_ENC_COMP[0,0,AX{0}]=0\n$AA_ENC_COMP[0,1,AX{0}]=0\n$AA_ENC_COMP_STEP[0,AX{0}]=360\n$AA_ENC_COMP_MIN[0,AX{0}]=0\n"
            "$AA_ENC_COMP_MAX[0,AX{0}]=360\n$AA_ENC_COMP_IS_MODULO[0,AX{0}]=0\n".format(n) for n in (1, 3)) + "M17\n")
        args = ["table", "session", folder, "--backup", saved]
        self.assertIn("expected --axis, one of X, C", self.nonio(*args, expect=2).stderr)
        for axis, unit, scale, day in (("C", "deg", 3.6, "2024-11-22"), ("X", "mm", 1.0, "2024-11-23")):
            if axis == "X":  # the file saved before C was loaded would bring its old table back
                answer = self.json_of(*args, "--axis", axis, expect=1)
                self.assertIn("another table of C than machines/S-1.toml states since 2024-11-21", answer["steps"][-1]["says"])
                self.assertIn("save the backup again", answer["steps"][-1]["says"])
                saved.write_text((folder / "load" / "saved.ini").read_text())
            answer = self.json_of(*args, "--axis", axis)
            self.assertEqual(self.step(answer, "loading"), "missing", answer)
            table = siemens({"t": "\n".join(p.read_text() for p in (folder / "load").glob("*.ini"))}, {"X": 1, "C": 3}[axis])
            # Ends of the scale: the table in um over mm, or 1e-3 deg over deg.
            left = {d: [of[axis](t) + (4.0 if d == "-" else 0.0) + scale * table.added(t, d) for t in targets] for d in "+-"}
            self.assertLess(max(left["+"] + left["-"]) - min(left["+"] + left["-"]), 1.0)
            after = self.site.parent / ("%s-after.csv" % axis)
            after.write_text(axis_csv(targets, *(lambda t, d=d, l=left: dict(zip(targets, l[d]))[t] + 1e-6 for d in "+-"), unit))
            answer = self.json_of(*args, "--axis", axis, "--loaded", "2024-11-21", "--check", after, "--checked", day)
            self.assertEqual(answer["verdict"]["answer"], "worked", answer)
            check = (self.site / "now-check" / "campaign.toml").read_text()
            self.assertEqual(check.count("[[measurement]]"), 1)
            self.assertIn("active_backlash_" + unit, check)
            (self.site / "now-check").rename(self.site / ("now-check-" + axis))
            path = self.site / ("now-check-" + axis) / "campaign.toml"
            path.write_text(path.read_text().replace('"now-check"', '"now-check-%s"' % axis.lower()))
        self.nonio("check", self.site)

    def test_on_the_terminal_in_three_languages(self):
        truth, before, first = self.begin("linuxcnc", 51)
        for language, words in (("en", ("missing  loading", "nonio table session")), ("de", ("fehlt    Laden", "Vorzeichenprobe")),
                                ("it", ("manca    caricamento", "prova del segno"))):
            (self.site / "site.toml").write_text('language = "%s"\n' % language)
            said = self.nonio(*shlex.split(first)[1:]).stdout
            for word in words:
                self.assertIn(word, " ".join(said.split()) if " " in word and "  " not in word else said)
            self.assertNotIn("session.", said)


if __name__ == "__main__":
    unittest.main()
