#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a backup states about the state of its control: for `table diff`, against later campaigns, and in inch."""
import json
import math
import os
import pathlib
import re
import shutil
import unittest

from parsers import OPTIONS, TABLE
from truth import FOUR, StateBench, Truth


class Backup(StateBench):
    def prepared(self, control, seed, **more):
        truth = Truth(seed, "wave")
        before, backup = self.backup(control, truth)
        return truth, before, backup, self.campaign_of("now", "2024-11-20", control, truth.readings(1, before), **more)

    def test_diff_takes_the_state_from_the_backup(self):
        """Both tables by the independent parsers: their largest difference is what diff prints."""
        for control in FOUR:
            truth, before, backup, now = self.prepared(control, 11)
            self.nonio("table", "insert", backup, "--with", now, "--out", self.site / "load")
            new = TABLE[control](self.files(control, self.site / "load"))
            largest = max(abs(new.added(x, d) - before.added(x, d) -
                              (new.backlash - before.backlash) * (0.5 if d == "+" else -0.5))
                          for x, _ in new.plus + before.plus for d in "+-")
            for order in ((backup, now), (now, backup)):
                done = self.nonio("table", "diff", *order, "--json")
                self.assertIn("were taken as the ones that were active during the measurement", done.stderr)
            (table,) = self.json_of("table", "diff", backup, now)["tables"]
            self.assertAlmostEqual(table["largest_um"], largest, delta=0.02, msg=control)
            self.tearDown(), self.setUp()

    def test_diff_refuses_what_insert_refuses(self):
        truth, before, backup, now = self.prepared("siemens-840d", 12)
        mine = self.site / "mine"
        mine.mkdir()
        for f in backup.split(","):
            text = pathlib.Path(f).read_text().replace("2022-11-01, campaign old", "2024-11-20, campaign now")
            (mine / os.path.basename(f)).write_text(text)
        files = ",".join(str(mine / os.path.basename(f)) for f in backup.split(","))
        said = self.nonio("table", "diff", files, now, expect=1).stderr
        self.assertIn("made from campaign now", said)
        self.assertIn("active_table in [machine.axes.X] of campaign.toml", said)
        said = self.nonio("table", "diff", backup.split(",")[0], now, expect=1).stderr
        self.assertIn("MD32450", said)

    def test_insert_refuses_readings_of_which_run_makes_no_table(self):
        control = "siemens-840d"
        truth, before, backup, now = self.prepared(control, 17)
        rows = (now / "x.csv").read_text().splitlines()
        first = {r.split(",", 1)[1].rsplit(",", 1)[0]: r.rsplit(",", 1)[1] for r in rows[1:] if r.startswith("1,")}
        copied = [("%s,%s" % (r.rsplit(",", 1)[0], first[r.split(",", 1)[1].rsplit(",", 1)[0]]) if r.startswith("2,") else r) for r in rows]
        (now / "x.csv").write_text("\n".join(copied) + "\n")
        args = ["table", "insert", backup, "--with", now, "--out", self.site / "load"]
        said = self.nonio(*args, expect=1).stderr
        self.assertIn("plausibility.passes-identical", said)
        self.assertIn("[[tables.accept]]", said)
        path = now / "campaign.toml"
        text = path.read_text()
        head, tail = text.split("[[measurement]]", 1)
        path.write_text(head + '[[tables.accept]]\nfinding = "plausibility.passes-identical"\nreason = "seen"\n[[measurement]]' + tail)
        self.nonio(*args)

    def test_insert_names_a_later_measurement_of_the_axis(self):
        control = "linuxcnc"
        truth, before, backup, now = self.prepared(control, 13)
        quiet = lambda: self.assertNotIn("measured again later", self.nonio("table", "insert", backup, "--with", now).stderr)
        quiet()
        later = self.campaign_of("later", "2024-12-01", control, truth.readings(1, before))
        text = (later / "campaign.toml").read_text()
        said = self.nonio("table", "insert", backup, "--with", now).stderr
        self.assertIn("measurement of 2024-11-20 that is used is older than that of campaign later of 2024-12-01", said)
        self.assertIn(str(later.resolve()), said)
        self.assertNotIn("measured again", self.nonio("table", "insert", backup, "--with", later).stderr)
        # Of another machine, of another axis, without a file of readings, of an earlier day, not readable.
        for one, other in (('asset = "S-1"', 'asset = "S-2"'), ('axis = "X"', 'axis = "Y"'), ('file = "x.csv"', 'file = "y.csv"'),
                           ("2024-12-01", "2024-11-19"), ("format = 1", "format = ")):
            (later / "campaign.toml").write_text(text.replace(one, other))
            quiet()
        # By maker and serial of the record; in another folder of the site.
        self.record([], 'maker = "Rossi"\nserial = "7"\n[axes.X]\nnumber = 0\n')
        (later / "campaign.toml").write_text(text.replace('asset = "S-1"', 'maker = "Rossi"\nserial = "7"'))
        deep = self.site / "2024" / "rossi"
        deep.parent.mkdir()
        later.rename(deep)
        self.assertIn(str(deep.resolve()), self.nonio("table", "insert", backup, "--with", now).stderr)

    def test_on_a_terminal_the_state_is_asked_for(self):
        control = "siemens-840d"
        truth, before, backup, now = self.prepared(control, 16)
        mine = self.site / "mine"
        mine.mkdir()
        for f in backup.split(","):  # loaded after the measurement: what was active is not known
            text = pathlib.Path(f).read_text().replace("2022-11-01, campaign old", "2024-11-20, campaign now")
            (mine / os.path.basename(f)).write_text(text)
        files = ",".join(str(mine / os.path.basename(f)) for f in backup.split(","))
        args = ["table", "insert", files, "--with", now, "--out", self.site / "load"]
        self.assertIn("active_table in [machine.axes.X]", self.nonio(*args, expect=1).stderr, "no terminal, no question")
        record = next((self.site / "machines").glob("*.toml"))
        known = record.read_text()
        said, status = self.answered(args, [backup.split(",")[0], "%.6f" % (before.backlash * 1e-3)])
        self.assertEqual(status, 0, said)
        self.assertIn("Value of MD32450 of X then, mm (or none)", said)
        table = TABLE[control](self.files(control, self.site / "load"))
        self.assertLess(truth.E(1, table), 1.7)
        shutil.rmtree(self.site / "load")
        # The answer is in the record of the machine: a second time nothing is asked.
        text = record.read_text()
        state = text.split("[[axes.X.state]]")[-1]
        self.assertIn('source = "answer"', state)
        self.assertIn("since = 2024-11-20", state)
        self.assertIn("backlash_mm = %.6g" % (before.backlash * 1e-3), state)
        self.nonio(*args)
        again = TABLE[control](self.files(control, self.site / "load"))
        self.assertEqual([again.added(x) for x in truth.targets], [table.added(x) for x in truth.targets])
        shutil.rmtree(self.site / "load")
        record.write_text(known)
        # "none" is an answer: then the table is that of the readings as they are.
        said, status = self.answered(args, ["none", "none"])
        self.assertEqual(status, 0, said)
        table = TABLE[control](self.files(control, self.site / "load"))
        self.assertLess(max(truth.error(1, x, d, before) + table.added(x, d) for x in truth.targets for d in "+-") -
                        min(truth.error(1, x, d, before) + table.added(x, d) for x in truth.targets for d in "+-"), 1.7)
        shutil.rmtree(self.site / "load")
        self.assertIn('table = "none"', record.read_text().split("[[axes.X.state]]")[-1])
        record.write_text(known)
        for answers, word in ((["nothing.ini"], "nothing.ini"), ([""], "no answer"), (["none", "1 mm"], "expected the backlash value")):
            said, status = self.answered(args, answers)
            self.assertEqual(status, 1, said)
            self.assertIn(word, said)
            self.assertFalse((self.site / "load").exists())
        (self.site / "site.toml").write_text('language = "de"\n')
        self.assertIn("Tabelle, die bei der Messung von X am 2024-11-20 wirksam war", self.answered(args, ["none", "none"])[0])

    def test_wear_in_addition_to_a_table_that_is_not_stated(self):
        """The worklist names the table that would explain the change, and what would remain of it."""
        control, truth = "linuxcnc", Truth(17, "line")
        old = truth.e[0] = lambda x: 0.03 * x + 6.0 * math.sin(x / 150.0)
        wear = lambda x: 3.0 * math.sin(x / 90.0)
        truth.e[1] = lambda x: old(x) + wear(x)
        table, _ = self.backup(control, truth)
        self.campaign_of("later", "2024-11-20", control, truth.readings(1, table))
        self.run_all(None)
        lines = json.loads((self.out / "summary.json").read_text())["lines"]
        said = [l["says"] for l in lines if "If the table of" in l["says"]]
        self.assertEqual(len(said), 1, [l["says"] for l in lines])
        of = re.search(r"the table of 2022-11-01 was loaded, it explains the change of the curve \(([\d.]+) um rms\) but for ([\d.]+) um rms", said[0])
        left = [wear(x) for x in truth.targets]
        rms = lambda v: math.sqrt(sum((a - sum(v) / len(v)) ** 2 for a in v) / len(v))
        self.assertAlmostEqual(float(of[2]), rms(left), delta=0.3)
        self.assertAlmostEqual(float(of[1]), rms([wear(x) + table.added(x) for x in truth.targets]), delta=0.5)

    def in_inch(self, text):
        """The same table of LinuxCNC in inch."""
        return "".join(" ".join("%.9f" % (float(w) / 25.4) for w in l.split()) + "\n" for l in text.splitlines())

    def test_a_backup_in_inch_is_read_or_refused_by_name(self):
        control = "linuxcnc"
        truth, before, backup, now = self.prepared(control, 14)
        file = pathlib.Path(backup)
        promised = self.json_of("table", "insert", backup, "--with", now)
        inch = self.site / "inch"
        inch.mkdir()
        comp, ini = inch / file.name, inch / "machine.ini"
        comp.write_text(self.in_inch(file.read_text()))
        said = self.nonio("table", "insert", comp, "--with", now, expect=1).stderr
        self.assertIn("25.4 times as much", said)
        self.assertIn("active_table in [machine.axes.X] of campaign.toml", said)
        ini.write_text("[TRAJ]\nLINEAR_UNITS = inch\n")
        said = self.nonio("table", "insert", "%s,%s" % (comp, ini), "--with", now, expect=None)
        self.assertNotEqual(said.returncode, 0)
        self.assertIn('LINEAR_UNITS = inch, option units is mm: state units = "inch" under [options.linuxcnc]', said.stderr)
        (now / "campaign.toml").write_text((now / "campaign.toml").read_text() + '[options.linuxcnc]\nunits = "inch"\n')
        load = self.site / "load"
        read = self.json_of("table", "insert", "%s,%s" % (comp, ini), "--with", now, "--out", load)
        for key in ("E_um", "M_um"):
            self.assertAlmostEqual(read["predictions"][0]["after"][key], promised["predictions"][0]["after"][key], delta=0.02)
        # What is written is in inch too, and leaves what was promised on the axis.
        rows = [[25.4 * float(w) for w in l.split()] for l in (load / file.name).read_text().splitlines()]
        table = TABLE[control]({file.name: "".join("%.9f %.9f %.9f\n" % tuple(r) for r in rows)})
        self.assertLess(truth.E(1, table), 1.7)
        self.assertIn("25.4", self.nonio("table", "insert", backup, "--with", now, expect=1).stderr, "mm read as inch")

    def test_inch_of_siemens_heidenhain_and_fanuc(self):
        truth, before, backup, now = self.prepared("siemens-840d", 15)
        eec, md = map(pathlib.Path, backup.split(","))
        extra = self.site / "MD.INI"
        for name in ("$MN_SCALING_SYSTEM_IS_METRIC", "$MA_CEC_SCALING_SYSTEM_METRIC[AX1]"):
            for value in (1, 0):
                extra.write_text("%%_N_INITIAL_INI\nCHANDATA(1)\n%s=%d\nM17\n" % (name, value))
                done = self.nonio("table", "insert", "%s,%s,%s" % (eec, md, extra), "--with", now, expect=None)
                self.assertEqual(done.returncode == 0, value == 1, done.stderr)
                if value == 0:
                    self.assertIn(name.split("[")[0] + " = 0", done.stderr)
                    self.assertIn("in inch", done.stderr)
        self.tearDown(), self.setUp()
        truth, before, backup, now = self.prepared("heidenhain-tnc", 15)
        files = backup.split(",")
        com = next(pathlib.Path(f) for f in files if f.endswith(".COM"))
        text = com.read_text()
        com.write_text(re.sub(r"^(BEGIN \S+) MM", r"\1 INCH", text))
        self.assertIn("line 1 states INCH", self.nonio("table", "insert", backup, "--with", now, expect=2).stderr)
        self.tearDown(), self.setUp()
        truth, before, backup, now = self.prepared("fanuc", 15)
        prm = next(pathlib.Path(f) for f in backup.split(",") if f.endswith(".prm"))
        text = prm.read_text()
        for bits, good in (("00000000", True), ("00000001", False), ("10000000", True)):
            prm.write_text(text.replace("%\n", "%%\nN1001P%s\n" % bits, 1))
            done = self.nonio("table", "insert", backup, "--with", now, expect=None)
            self.assertEqual(done.returncode == 0, good, bits + done.stderr)
            if not good:
                self.assertIn("parameter 1001#0 (INM) is 1", done.stderr)
                self.assertIn("detection_unit_um", done.stderr)
        # With the units of an inch machine the numbers are pulses of 2.54 um.
        (now / "campaign.toml").write_text((now / "campaign.toml").read_text().replace(
            OPTIONS["fanuc"], OPTIONS["fanuc"] + "detection_unit_um = 2.54\ninterval_unit_um = 2.54\n"))
        prm.write_text(text.replace("%\n", "%\nN1001P00000001\n", 1))
        (table,) = self.json_of("table", "diff", prm, prm, "--axis", "X", "--control", "fanuc", "--set", "extended=true",
                                "--set", "detection_unit_um=2.54", "--set", "interval_unit_um=2.54")["tables"]
        self.assertAlmostEqual(table["present"]["backlash_um"], 2.54 * int(re.search(r"N1851A1P(-?\d+)", text)[1]), places=6)
        largest = max(abs(v) for _, v in before.plus)
        self.assertAlmostEqual(table["present"]["largest_um"], 2.54 * largest, places=6)


if __name__ == "__main__":
    unittest.main()
