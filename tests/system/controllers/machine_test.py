#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The machine as an object of the site: how its control counts its axes, and what was on while they were measured."""
import json
import re
import shutil
import unittest

from bench import BenchTest, axis_csv, wave

TARGETS = [50.0 * i for i in range(9)]


def half(x):
    return 0.5 * wave(x)


class MachineTest(BenchTest):
    def measured(self, control, axis="Z", axes=(("Z", "linear"),), machine="", options="", plus=wave, minus=wave,
                 of_axis=None, of_measurement="", date="2026-06-01"):
        """A campaign of one measured axis, written without the help of the bench: nothing is said that is not here.
        `of_axis`: statements on the measured axis; without them no compensation was active."""
        text = 'format = 1\n[campaign]\nid = "c"\ndate = %s\n[machine]\n%s' % (date, machine)
        if control:
            text += 'control = "%s"\n' % control
        for name, kind in axes:
            if of_axis is None or name != axis:
                text += self.none_active(name, kind)
            else:
                text += '[machine.axes.%s]\nkind = "%s"\n%s' % (name, kind, of_axis)
        text += '[[measurement]]\nid = "%s"\nkind = "axis"\naxis = "%s"\nfile = "a.csv"\n%s' % (axis, axis, of_measurement)
        (self.folder / "campaign.toml").write_text(text + options)
        (self.folder / "a.csv").write_text(axis_csv(TARGETS, plus, minus))

    def tables(self, control, expect=None):
        results = self.run_site(expect=expect)
        found = [t for t in results.get("tables", []) if t["plugin"] == control]
        return found[0] if found else {"findings": [], "notes": [], "predictions": []}, results

    def written(self):
        return {p.name for p in (self.out / "c").iterdir()}

    def findings(self, control):
        return [f["id"] for f in self.tables(control)[0]["findings"]]


class Number(MachineTest):
    COUNTED = (("fanuc", "", "fanuc-Z.prm", "N3620A3P"), ("siemens-840d", "", "siemens-840d-Z-EEC.ini", "[0,0,AX3]"),
               ("aerotech", "", "aerotech-Z.cal", ":START 3 "), ("twincat-cnc", "", "twincat-cnc-Z.lis", "kopf.achs_nr"),
               ("pmac", " counts_per_mm=2000", "pmac-Z.pmc", "#3 DEFINE"))

    def test_only_Z_measured_gets_no_table_under_a_guessed_number(self):
        for control, more, file, sign in self.COUNTED:
            options = '[options.%s]\naxes = ["Z%s"]\n' % (control, more or " step_mm=50")
            self.measured(control, options=options)
            table, _ = self.tables(control)
            self.assertEqual([f["id"] for f in table["findings"]], ["table.axis-number"], control)
            advice = table["findings"][0]["advice"]
            self.assertIn("number = ... under [axes.Z] of machines/<asset>.toml", advice)
            self.assertIn("number = ... under [options.NAME.axes.Z]", advice)
            self.assertFalse([n for n in self.written() if n.startswith(control)], control)
            self.measured(control, options='[options.%s]\naxes = ["Z number=3%s"]\n' % (control, more))
            self.assertNotIn("table.axis-number", self.findings(control))
            self.assertIn(sign, self.file(file))

    def test_a_place_among_the_axes_is_no_number(self):
        for axes in ((("X", "linear"), ("Z", "linear")), (("Z", "linear"), ("X", "linear"))):
            self.measured("fanuc", axes=axes)
            self.assertEqual(self.findings("fanuc"), ["table.axis-number"])

    def test_the_record_of_the_machine_says_it(self):
        for control, more, file, sign in self.COUNTED:
            self.record(["X", "Y", "Z"])
            self.measured(control, machine='asset = "S-1"\n',
                          options='[options.%s]\naxes = ["Z%s"]\n' % (control, more or " step_mm=50"))
            self.tables(control)
            self.assertIn(sign, self.file(file), control)
        # By maker and serial too.
        self.record(["Y", "Z"], 'maker = "Rossi"\nserial = "7"\n', asset="other")
        self.measured("fanuc", machine='maker = "Rossi"\nserial = "7"\n')
        self.tables("fanuc")
        self.assertIn("N3620A2P", self.file("fanuc-Z.prm"))

    def test_linuxcnc_names_no_joint_that_was_not_stated(self):
        self.measured("linuxcnc")
        self.tables("linuxcnc")
        ini = self.file("linuxcnc-Z.ini")
        self.assertNotIn("[JOINT_", ini)
        self.assertIn("the joint of Z is not stated", ini)
        self.assertIn("COMP_FILE = linuxcnc-Z.comp", ini)
        self.record(["X", "Y", "Z"], from_zero=True)
        self.measured("linuxcnc", machine='asset = "S-1"\n')
        self.tables("linuxcnc")
        self.assertIn("[JOINT_2]\n", self.file("linuxcnc-Z.ini"))

    def test_a_changed_record_does_its_campaigns_again(self):
        self.record(["X", "Z"])
        self.measured("fanuc", machine='asset = "S-1"\n')
        self.tables("fanuc")
        self.assertIn("N3620A2P", self.file("fanuc-Z.prm"))
        self.assertIn("1 campaign, 0 to do", self.nonio("run", self.site, "--out", self.out).stderr)
        self.record(["X", "Y", "Z"])
        self.tables("fanuc")
        self.assertIn("N3620A3P", self.file("fanuc-Z.prm"))
        (self.site / "machines" / "S-1.toml").unlink()
        self.assertIn("machines/S-1.toml is missing", self.nonio("run", self.site, "--out", self.out, expect=1).stderr)
        self.nonio("machine", "remove", self.site, "machines/S-1.toml", "--by", "B", "--why", "entered by mistake")
        self.assertEqual(self.findings("fanuc"), ["table.axis-number"])
        self.record(["Z"])
        self.tables("fanuc")
        self.assertIn("N3620A1P", self.file("fanuc-Z.prm"))

    def test_campaign_against_record(self):
        self.record(["X", "Y", "Z"], 'serial = "7"\ncontrol = "fanuc"\n')
        self.measured("fanuc", machine='asset = "S-1"\nserial = "7"\n', options='[options.fanuc]\naxes = ["Z number=1"]\n')
        _, results = self.tables("fanuc")
        (error,) = results["errors"]
        self.assertEqual(error["file"], "campaign.toml")
        line = (self.folder / "campaign.toml").read_text().splitlines()[error["line"] - 1]
        self.assertIn("number=1", line)
        self.assertIn("machines/S-1.toml:13", error["message"])
        # Two machines with one asset: one of them has another serial.
        self.measured("fanuc", machine='asset = "S-1"\nserial = "8"\n')
        self.assertIn('machine.serial: "8" contradicts machines/S-1.toml:3', self.tables("fanuc")[1]["errors"][0]["message"])
        self.measured("pmac", machine='asset = "S-1"\n')
        self.assertIn('machine.control: "pmac" contradicts machines/S-1.toml:4', self.tables("pmac")[1]["errors"][0]["message"])

    def test_a_record_is_of_its_control(self):
        self.record(["X", "Y", "Z"], 'control = "fanuc"\n')
        self.measured("", machine='asset = "S-1"\n')
        results = self.tables("fanuc")[1]
        self.assertEqual([t["plugin"] for t in results["tables"]], ["fanuc"], "tables of no other control")
        self.measured("", machine='asset = "S-1"\n', options='[run]\noutputs = ["siemens-840d"]\n')
        (error,) = self.tables("siemens-840d")[1]["errors"]
        self.assertIn("run.outputs", error["message"])
        self.assertIn("machines/S-1.toml", error["message"])
        (self.site / "site.toml").write_text('[run]\noutputs = ["fanuc", "siemens-840d"]\n')
        self.measured("", machine='asset = "S-1"\n')
        results = self.tables("fanuc")[1]
        self.assertEqual([t["plugin"] for t in results["tables"]], ["fanuc"])

    def test_options_for_a_fleet_pass_over_axes_that_a_campaign_has_not(self):
        (self.site / "site.toml").write_text('[options.fanuc]\naxes = ["X number=1", "Z number=3", "B number=9"]\n')
        self.measured("fanuc")
        self.run_site(expect=0)
        self.assertIn("N3620A3P", self.file("fanuc-Z.prm"))
        self.measured("fanuc", options='[options.fanuc]\naxes = ["Q number=4"]\n')
        self.assertIn("no axis Q", self.tables("fanuc")[1]["errors"][0]["message"], "the campaign's own slip")

    def test_the_number_of_another_axis_is_refused(self):
        self.record(["X", "Y"])
        for control, key, axis in (("fanuc", "number", 2), ("linuxcnc", "joint", 1)):
            self.measured(control, machine='asset = "S-1"\n', options='[options.%s]\naxes = ["Z %s=%d"]\n' % (control, key, axis))
            _, results = self.tables(control, expect=1)
            said = " ".join(e["message"] for e in results["errors"])
            self.assertIn("axis Z, %s=%d is the number of axis %s, machines/S-1.toml" % (key, axis, "XY"[axis - 1]), said)
            self.measured(control, machine='asset = "S-1"\n', options='[options.%s]\naxes = ["Z %s=7"]\n' % (control, key))
            self.assertEqual(self.tables(control)[1]["errors"], [])

    def test_one_axis_has_one_number(self):
        for entries in ('"Z number=3 number=4"', '"Z number=3", "Z number=4"'):
            self.measured("siemens-840d", options="[options.siemens-840d]\naxes = [%s]\n" % entries)
            _, results = self.tables("siemens-840d", expect=1)
            self.assertIn("axis Z has number=3 and number=4: which of them?", results["errors"][0]["message"])

    def test_an_asset_is_a_name_and_no_path(self):
        for asset in ("../S-1", "a/b", ".hidden", "a\\\\b"):
            self.measured("fanuc", machine='asset = "%s"\n' % asset)
            self.assertIn("machine.asset: expected up to 100 characters", self.tables("fanuc")[1]["errors"][0]["message"])

    def test_a_broken_record_fails_its_own_campaigns(self):
        self.record(["Z"])
        (self.site / "machines" / "S-2.toml").write_text('format = 1\nasset = "S-2"\n[axes.Z]\nnumbre = 1\n')
        self.measured("fanuc", machine='asset = "S-1"\n')
        shutil.copytree(self.folder, self.site / "d")
        text = (self.folder / "campaign.toml").read_text()
        (self.site / "d" / "a.csv").write_text(axis_csv(TARGETS, half, wave))  # other readings
        (self.site / "d" / "campaign.toml").write_text(text.replace('"c"', '"d"').replace("S-1", "S-2"))
        self.run_site(expect=1)
        self.assertIn("N3620A1P", self.file("fanuc-Z.prm"))
        (error,) = json.loads((self.out / "d" / "results.json").read_text())["errors"]
        self.assertEqual((error["file"], error["line"]), ("machines/S-2.toml", 4))


class WhatWasOn(MachineTest):
    SAID = 'control = "linuxcnc"\n'

    def comp(self, path, correction):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join("%g %.6f %.6f\n" % (x, correction(x) * 1e-3, correction(x) * 1e-3) for x in TARGETS))

    def eec(self, name, backlash=None):
        """A table of nothing in AX3, and its backlash in mm where it is said."""
        files = [self.folder / name]
        files[0].parent.mkdir(exist_ok=True)
        files[0].write_text("%_N_AX3_EEC_INI\nCHANDATA(1)\n$AA_ENC_COMP[0,0,AX3]=0\n$AA_ENC_COMP[0,1,AX3]=0\n"
                            "$AA_ENC_COMP_STEP[0,AX3]=400\n$AA_ENC_COMP_MIN[0,AX3]=0\n$AA_ENC_COMP_MAX[0,AX3]=400\n"
                            "$AA_ENC_COMP_IS_MODULO[0,AX3]=0\nM17\n")
        if backlash is not None:
            files.append(files[0].with_suffix(".md.ini"))
            files[1].write_text("%%_N_AX3_TEA_INI\nCHANDATA(1)\n$MA_BACKLASH[0,AX3]=%g\nM17\n" % backlash)
        return ",".join(map(str, files))

    def test_the_run_removes_the_active_compensation(self):
        self.comp(self.folder / "backup/z.comp", lambda x: -half(x))
        self.measured("linuxcnc", plus=half, minus=half, options="[options.linuxcnc]\ntype = 1\n",
                      of_axis='active_table = "backup/z.comp"\nactive_backlash_mm = "none"\n')
        table, results = self.tables("linuxcnc")
        rows = [list(map(float, l.split())) for l in self.file("linuxcnc-Z.comp").splitlines()]
        zero = wave(0.0)
        for x, up, down in rows:  # the whole of it, not the rest; a constant is the zero of the table
            self.assertAlmostEqual(up * 1e3 - rows[0][1] * 1e3, -(wave(x) - zero), places=3)
        predicted = {p["name"]: p for p in table["predictions"]}
        E = max(map(half, TARGETS)) - min(map(half, TARGETS))
        self.assertAlmostEqual(predicted["E"]["before"], E, places=4)
        self.assertLess(predicted["E"]["predicted"], 0.02)
        self.assertIn("the table of backup/z.comp was active", self.file("linuxcnc-Z.txt"))
        # The file is an input of the run: a change of it is noticed.
        self.comp(self.folder / "backup/z.comp", lambda x: 0.0)
        self.tables("linuxcnc")
        rows = [list(map(float, l.split())) for l in self.file("linuxcnc-Z.comp").splitlines()]
        self.assertAlmostEqual((rows[3][1] - rows[0][1]) * 1e3, -(half(TARGETS[3]) - half(0.0)), places=3)

    def test_without_a_stated_active_compensation_no_control_writes_a_table(self):
        """The table of what remained would replace the table that corrected the rest."""
        self.record(["X", "Y", "Z"])
        for control in ("siemens-840d", "heidenhain-tnc", "fanuc", "linuxcnc"):
            for stated, missing in (("", "active_table, active_backlash_mm"),
                                    ('active_table = "none"\n', "active_backlash_mm"),
                                    ("active_backlash_mm = 0.01\n", "active_table"),
                                    ('active_table = "none"\nactive_backlash_mm = "none"\n', None),
                                    ('active_table = "none"\nactive_backlash_mm = 0.0\n', None)):
                with self.subTest(control=control, stated=stated):
                    self.measured(control, machine='asset = "S-1"\n', of_axis=stated)
                    table, _ = self.tables(control)
                    refused = [f for f in table["findings"] if f["id"] == "table.active-not-stated"]
                    self.assertEqual([(f["severity"], f["evidence"]["missing"]) for f in refused], [("attention", missing)] if missing else [])
                    files = [n for n in self.written() if n.startswith(control)]
                    self.assertEqual(bool(files), missing is None, files)

    def test_compensation_on_wants_the_table_that_was(self):
        self.record(["Z"])
        self.measured("fanuc", machine='asset = "S-1"\n', of_axis="", of_measurement='compensation = "on"\n')
        self.assertEqual(self.findings("fanuc"), ["table.active-not-stated"])
        self.assertFalse([n for n in self.written() if n.startswith("fanuc")])
        self.measured("fanuc", machine='asset = "S-1"\n', of_axis="", of_measurement='compensation = "off"\n')
        self.assertNotIn("table.active-not-stated", self.findings("fanuc"))
        self.assertTrue([n for n in self.written() if n.startswith("fanuc")])

    def test_what_was_measured_after_an_adjustment_needs_a_statement(self):
        """Its table would replace the one that was loaded meanwhile."""
        self.record(["Z"])
        for stated, refused in (('adjustment = "after"\n', True), ('compensation = "on"\n', True), ('adjustment = "before"\n', False),
                                ('adjustment = "after"\ncompensation = "off"\n', False)):
            with self.subTest(stated=stated):
                self.measured("fanuc", machine='asset = "S-1"\n', of_axis='active_table = "none"\nactive_backlash_mm = "none"\n', of_measurement=stated)
                self.assertEqual("table.active-contradicted" in self.findings("fanuc"), refused)
                self.assertEqual(bool([n for n in self.written() if n.startswith("fanuc")]), not refused)

    def test_backlash_that_was_on_is_the_beginning_of_the_new_value(self):
        self.record(["X", "Y", "Z"])
        self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 3.0,
                      of_axis='active_table = "none"\nactive_backlash_mm = 0.010\n')
        self.tables("siemens-840d")
        self.assertIn("]=0.013\n", self.file("siemens-840d-Z-backlash.ini"))

    def test_the_record_says_it_for_later_days(self):
        state = 'table = "kept/z.ini,kept/z.md.ini"\nsince = %s\n'
        self.eec("../kept/z.ini", 0.010)
        for day, value in (("2026-05-31", "]=0.013\n"), ("2026-06-01", None), ("2026-06-02", None)):
            self.record(["X", "Y", "Z"])
            with open(self.site / "machines" / "S-1.toml", "a") as file:
                file.write(state % day)
            self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 3.0, of_axis="")
            if value is None:  # measured before that day: what was active then is not known
                self.assertEqual(self.findings("siemens-840d"), ["table.active-not-stated"], day)
                continue
            self.tables("siemens-840d")
            self.assertIn(value, self.file("siemens-840d-Z-backlash.ini"), day)

    def test_a_wrong_active_compensation_is_refused(self):
        self.record(["X", "Y", "Z"])
        for said, complaint in (('active_table = "missing.ini"\n', "missing.ini"), ('active_table = "../../x.ini"\n', "leads outside"),
                                ('active_table = "a.csv"\n', "active while axis Z was measured"),
                                ('active_backlash_mm = "no"\n', 'or "none"'), ('active_backlash_mm = 12\n', "-10 to 10")):
            self.measured("siemens-840d", machine='asset = "S-1"\n', of_axis=said)
            error = self.tables("siemens-840d", expect=1)[1]["errors"][0]
            self.assertIn(complaint, error["message"])
            self.assertEqual(error["file"], "campaign.toml", error)
            self.assertGreater(error.get("line", 0), 0, error)

    def test_apply_requires_the_backlash_of_another_file(self):
        """10 um in the parameter, 3 um still lost: 13 um. Taken as 0 it would be 3."""
        self.record(["X", "Y", "Z"])
        self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 3.0, of_axis="")
        table = self.eec("z.ini")
        new = self.site / "new"
        done = self.nonio("table", "predict", table, self.folder, "--active-table", "--out", new, expect=2)
        for word in ("MD32450", "--active-backlash", "active_backlash_mm", "[machine.axes.Z]"):
            self.assertIn(word, done.stderr)
        self.assertFalse(new.exists())
        for said, value in (("0.010", "]=0.013\n"), ("none", "]=0.003\n"), ("Z=0.010", "]=0.013\n")):
            self.nonio("table", "predict", table, self.folder, "--active-table", "--active-backlash", said, "--out", new)
            self.assertIn(value, (new / "siemens-840d-Z-backlash.ini").read_text())
        for wrong in ("much", "11", "X=0.01", "Z="):
            self.nonio("table", "predict", table, self.folder, "--active-table", "--active-backlash", wrong, expect=2)
        self.nonio("table", "predict", table, self.folder, "--active-backlash", "0", expect=2)
        # The backup, the campaign or the record of the machine may state it instead; two different values are refused.
        both = self.eec("z.ini", 0.010)
        self.nonio("table", "predict", both, self.folder, "--active-table", "--out", new)
        self.assertIn("]=0.013\n", (new / "siemens-840d-Z-backlash.ini").read_text())
        self.nonio("table", "predict", both, self.folder, "--active-table", "--active-backlash", "0.02", expect=2)
        self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 3.0, of_axis="active_backlash_mm = 0.010\n")
        self.nonio("table", "predict", table, self.folder, "--active-table", "--out", new)
        self.assertIn("]=0.013\n", (new / "siemens-840d-Z-backlash.ini").read_text())
        self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 3.0, of_axis="")
        with open(self.site / "machines" / "S-1.toml", "a") as file:
            file.write("backlash_mm = 0.010\nsince = 2026-01-01\n")
        self.nonio("table", "predict", table, self.folder, "--active-table", "--out", new)
        self.assertIn("]=0.013\n", (new / "siemens-840d-Z-backlash.ini").read_text())


def punched(text):
    """{(N, A): P} of a punched text, A 0 where there is none."""
    found = {}
    for line in text.splitlines():
        number = re.match(r"N(\d+)", line)
        for axis, value in re.findall(r"(?:A(\d+))?P(-?\d+)", line) if number else ():
            found[int(number[1]), int(axis or 0)] = int(value)
    return found


class Merge(MachineTest):
    """A table of Z let into the backup of a machine with three axes."""

    PITCH = {**{10000 + n: (n * 7) % 5 - 2 for n in range(0, 9)}, **{10020 + n: (n * 3) % 4 - 1 for n in range(0, 5)}}

    def punched_backup(self, z=(0, 0, 0, 0), end="\n"):
        """Axes X (1) with numbers 0..8 and Y (2) with 20..24; `z`: 3620, 3621, 3622, 3624 of axis 3."""
        of = {3620: (4, 22, z[0]), 3621: (0, 20, z[1]), 3622: (8, 24, z[2]), 3623: (1, 1, 1), 3624: (50000, 100000, z[3]),
              3605: (0, 0, 0), 1851: (3, -2, 5), 1420: (9000, 9000, 6000)}
        lines = ["%", "N0020P4"]
        lines += ["N%d%s" % (n, "".join("A%dP%d" % (a, v) for a, v in enumerate(values, 1))) for n, values in sorted(of.items())]
        lines += ["N%dP%d" % one for one in sorted({**{10000 + n: 0 for n in range(z[1], z[2] + 1) if z[3]}, **self.PITCH}.items())] + ["%"]
        path = self.site / "CNCPARAM.TXT"
        path.write_bytes((end.join(lines) + end).encode())
        return path

    def fanuc(self, more=""):
        self.record(["X", "Y", "Z"], more)
        self.measured("fanuc", machine='asset = "S-1"\n', axes=(("X", "linear"), ("Y", "linear"), ("Z", "linear")))

    def test_fanuc_numbers_of_other_axes_stay(self):
        self.fanuc()
        out = self.site / "load"
        for z, first in (((0, 0, 0, 0), 9), ((34, 30, 50, 50000), 30), ((15, 13, 17, 50000), 9), ((9, 9, 17, 50000), 9)):
            for end in ("\n", "\r\n"):
                backup = self.punched_backup(z, end)
                before = backup.read_bytes()
                done = self.json_of("merge", backup, "--with", self.folder, "--axis", "Z", "--out", out)
                after = (out / "CNCPARAM.TXT").read_bytes()
                was, now = punched(before.decode()), punched(after.decode())
                changed = {k for k in now if was.get(k) != now[k]}
                self.assertTrue(all(a == 3 or (a == 0 and n >= 10000) for n, a in changed), changed)
                low, high = now[3621, 3], now[3622, 3]
                self.assertEqual(low, first, z)
                points = {n - 10000 for n, a in changed if a == 0}
                self.assertTrue(points <= set(range(low, high + 1)), points)
                self.assertFalse(points & ({*range(0, 9)} | {*range(20, 25)}), "numbers of X and Y")
                self.assertEqual((now[3624, 3], now[3620, 3] - low), (50000, now[3620, 3] - low))
                # The lines without a value of Z are the same bytes, in the same order.
                kept = [l for l in before.split(b"\n") if b"A3P" not in l and not l.startswith(b"N100")]
                self.assertEqual(kept, [l for l in after.split(b"\n") if b"A3P" not in l and not l.startswith(b"N100")])
                self.assertEqual(before.count(b"\r"), before.count(b"\n") if end == "\r\n" else 0)
                self.assertEqual(after.count(b"\r"), after.count(b"\n") if end == "\r\n" else 0)
                self.assertEqual([t["output"] for t in done["tables"] if t["largest_um"] > 0], ["Z"])
        # What the table does is what the campaign's own file would do: of increments, from the reference on.
        self.tables("fanuc")
        own = punched(self.file("fanuc-Z.prm"))
        shift = now[3621, 3] - own[3621, 3]
        for (n, a), v in own.items():
            if n >= 10000:
                self.assertEqual(now[n + shift, 0], v)

    def test_fanuc_numbers_that_are_taken_and_refusals(self):
        self.fanuc('taken = ["9-99"]\n')
        self.json_of("merge", self.punched_backup(), "--with", self.folder, "--out", self.site / "load")
        self.assertEqual(punched((self.site / "load" / "CNCPARAM.TXT").read_text())[3621, 3], 100)
        self.tables("fanuc")
        self.assertIn("N3621A3P0\n", self.file("fanuc-Z.prm"), "0..8 are free as far as the record knows")
        self.assertIn("CHOSEN, not read from a backup: numbers 0 to 8", self.file("fanuc-Z.txt"))
        self.fanuc('taken = ["0-1023"]\n')
        self.assertIn("0..1023", self.nonio("table", "insert", self.punched_backup(), "--with", self.folder, expect=1).stderr)
        self.fanuc()
        path = self.punched_backup()
        path.write_text(path.read_text().replace("N3605A1P0A2P0A3P0", "N3605A1P0A2P0A3P00000001"))
        self.assertIn("3605#0", self.nonio("table", "insert", path, "--with", self.folder, expect=1).stderr)
        path.write_text("\n".join(l.split("A3P")[0] for l in self.punched_backup().read_text().splitlines()) + "\n")
        self.assertIn("no parameters of controlled axis 3", self.nonio("table", "insert", path, "--with", self.folder, expect=1).stderr)
        self.assertIn("expected", self.nonio("table", "insert", self.folder / "a.csv", "--with", self.folder, "--control", "fanuc", expect=2).stderr +
                      self.nonio("table", "insert", path, "--with", self.folder, "--axis", "Q", expect=1).stderr.replace("no measurement", "expected"))

    def archive(self, axes, directions=False):
        text = "%_N_NC_EEC_INI\nCHANDATA(1)\n; saved by hand\n"
        for n, size in axes:
            text += "".join("$AA_ENC_COMP[0,%d,AX%d]=%.4f\n" % (i, n, size * i) for i in range(5))
            text += ("$AA_ENC_COMP_STEP[0,AX%d]=100.0\n$AA_ENC_COMP_MIN[0,AX%d]=0.0\n$AA_ENC_COMP_MAX[0,AX%d]=400.0\n"
                     "$AA_ENC_COMP_IS_MODULO[0,AX%d]=0\n" % (n, n, n, n))
            text += "$MA_BACKLASH[0,AX%d]=0.00%d\n" % (n, n)
        return text + "M17\n"

    def test_siemens_archive_of_all_axes(self):
        self.record(["X", "Y", "Z"])
        self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 4.0, of_axis='active_table = "none"\nactive_backlash_mm = 0.003\n')
        for axes, end in (((1, 0.001), (2, 0.002), (3, 0.003)), "\n"), (((3, 0.003), (1, 0.001)), "\n"), (((1, 0.001), (2, 0.002)), "\r\n"):
            path = self.site / "EEC.INI"
            before = self.archive(axes).replace("\n", end)
            path.write_bytes(before.encode())
            self.json_of("merge", path, "--with", self.folder, "--out", self.site / "load")
            after = (self.site / "load" / "EEC.INI").read_bytes().decode()
            self.tables("siemens-840d")
            origin = [l.rstrip() + end.rstrip("\n") for n in ("siemens-840d-Z-EEC.ini", "siemens-840d-Z-backlash.ini")
                      for l in self.file(n).splitlines() if l.startswith(";")]
            other = lambda text: [l for l in text.split("\n") if "AX3" not in l and l not in origin]
            self.assertEqual(other(after), other(before))
            self.assertTrue(all(l in after.split("\n") for l in origin), after)
            self.assertIn("$MA_BACKLASH[0,AX3]=0.007", after)
            for line in self.file("siemens-840d-Z-EEC.ini").splitlines():
                if line.startswith("$"):
                    self.assertEqual(after.count(line + end), 1, line)

    def test_the_backup_is_the_active_table_and_its_comments_are_replaced(self):
        """Measured with the table of the backup active, which the campaign does not state."""
        self.record(["X", "Y", "Z"])
        whole = lambda x: 3.0 * wave(x)
        self.measured("siemens-840d", machine='asset = "S-1"\n', plus=whole, minus=lambda x: whole(x) + 4.0)
        self.tables("siemens-840d")
        backup = [self.site / n for n in ("siemens-840d-Z-EEC.ini", "siemens-840d-Z-backlash.ini")]
        for path in backup:  # the campaign of an earlier day
            path.write_text(self.file(path.name).replace("2026-06-01", "2024-11-01").replace("campaign c", "campaign old"))
        self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 3.0, of_axis="")
        done = self.nonio("table", "insert", ",".join(map(str, backup)), "--with", self.folder, "--out", self.site / "load")
        self.assertIn("were active during the measurement", done.stderr)
        eec, backlash = ((self.site / "load" / p.name).read_text() for p in backup)
        entries = lambda text: [float(l.split("=")[1]) for l in text.splitlines() if l.startswith("$AA_ENC_COMP[")]
        before = entries(backup[0].read_text())
        for new, old in zip(entries(eec), before):  # what was active and what remained
            self.assertAlmostEqual(new, old * 4.0 / 3.0, delta=2e-6)
        self.assertIn("=0.007", backlash)
        for text in (eec, backlash):
            self.assertNotIn("2024-11-01", text)
            self.assertIn("2026-06-01, campaign c", text)
        self.assertIn("was active", eec)
        # Without the backlash file nothing says what was in the parameter.
        done = self.nonio("table", "insert", backup[0], "--with", self.folder, "--out", self.site / "load2", expect=1)
        self.assertIn("MD32450", done.stderr)
        self.assertFalse((self.site / "load2").exists())

    def test_siemens_direction_tables_with_a_sag_table(self):
        def cec(t, i, o, direction, size):
            return ("".join("$AN_CEC[%d,%d]=%.4f\n" % (t, k, size * k) for k in range(3)) +
                    "$AN_CEC_INPUT_AXIS[%d]=(AX%d)\n$AN_CEC_OUTPUT_AXIS[%d]=(AX%d)\n$AN_CEC_STEP[%d]=200.0\n$AN_CEC_MIN[%d]=0.0\n"
                    "$AN_CEC_MAX[%d]=400.0\n$AN_CEC_DIRECTION[%d]=%d\n$AN_CEC_MULT_BY_TABLE[%d]=0\n$AN_CEC_IS_MODULO[%d]=0\n"
                    % (t, i, t, o, t, t, t, t, direction, t, t))
        head, sag = "%_N_NC_CEC_INI\nCHANDATA(1)\n", cec(4, 2, 3, 0, 0.01)  # where AX3's tables would come without a backup
        self.record(["X", "Y", "Z"])
        self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 4.0,
                      options="[options.siemens-840d]\ndirections = true\n")
        path = self.site / "CEC.INI"
        for own, numbers in (("", {0, 1}), (cec(7, 3, 3, -1, 0.02) + cec(9, 3, 3, 1, 0.03), {7, 9})):
            path.write_text(head + sag + own + "M17\n")
            found = self.json_of("merge", path, "--with", self.folder, "--out", self.site / "load")
            after = (self.site / "load" / "CEC.INI").read_text()
            self.assertIn(sag, after)
            self.assertEqual({int(n) for n in re.findall(r"AN_CEC_DIRECTION\[(\d+)\]=-?1\n", after)}, numbers)
            self.assertEqual({(t["output"], tuple(t["by"])): t["largest_um"] > 0 for t in found["tables"]},
                             {("Z", ("AX2",)): False, ("Z", ("Z",)): True})
        # Without a backup the record keeps the sag table's number free, or the text states that no backup was read.
        self.record(["X", "Y", "Z"], 'taken = ["4"]\n')
        error = self.tables("siemens-840d")[1]["errors"][0]["message"]
        self.assertIn("CEC tables 4 to 5 would meet those in use (4 to 4)", error)
        self.record(["X", "Y", "Z"])
        self.tables("siemens-840d")
        self.assertIn("CHOSEN, not read from a backup: CEC tables 4 to 5", self.file("siemens-840d-Z-CEC.ini"))

    def test_heidenhain_assignment_keeps_the_other_axes(self):
        def com(name, axis, size):
            rows = "".join("%-5d%-14s%-14s%+.4f\n" % (i, "%+.4f" % (100.0 * i), "", size * i) for i in range(5))
            return "BEGIN %s MM\n%-5s%-14s%-14s%s\n" % (name, "NR", "AXISPOS", "BACKLASH", axis) + rows + "[END]\n"
        columns = "BEGIN CONFIG.CMA MM\nNR   ACTIVE   X               Y               Z\n"
        axes = (("X", "linear"), ("Y", "linear"), ("Z", "linear"))
        self.measured("heidenhain-tnc", axes=axes)
        (self.site / "X.COM").write_text(com("AXIS_X.COM", "X", 0.001))
        (self.site / "OLDZ.COM").write_text(com("OLDZ.COM", "Z", 0.002))
        cma = self.site / "CONFIG.CMA"
        for cell, name, changed in (("OLDZ.COM", "OLDZ.COM", {"OLDZ.COM"}), ("", "AXIS_Z.COM", {"AXIS_Z.COM", "CONFIG.CMA"})):
            before = columns + "0             AXIS_OLD.COM\n1    *        AXIS_X.COM                      %s\n[END]\n" % cell
            cma.write_text(before)
            files = "%s,%s,%s" % (self.site / "X.COM", self.site / "OLDZ.COM", cma)
            out = self.site / ("load" + cell)
            done = self.json_of("merge", files, "--with", self.folder, "--out", out)
            self.assertEqual({p.name for p in out.iterdir() if not p.name.endswith(".txt")}, changed)
            self.assertTrue((out / name).read_text().startswith("BEGIN %s MM\n" % name))
            if "CONFIG.CMA" in changed:
                self.assertEqual((out / "CONFIG.CMA").read_text(), before.replace(
                    "1    *        AXIS_X.COM                      ", "1    *        AXIS_X.COM                      AXIS_Z.COM"))
            self.assertEqual([t["output"] for t in done["tables"] if t["largest_um"] > 0], ["Z"])
        self.assertIn("CONFIG.CMA", self.nonio("table", "insert", self.site / "X.COM", "--with", self.folder, expect=1).stderr)

    def test_siemens_axes_by_names_of_their_own_are_refused(self):
        self.record(["X", "Y", "Z"])
        self.measured("siemens-840d", machine='asset = "S-1"\n')
        path = self.site / "EEC.INI"
        path.write_text(self.archive(((1, 0.001), (3, 0.0))).replace("AX3", "Z1"))
        said = self.nonio("table", "insert", path, "--with", self.folder, "--out", self.site / "load", expect=1).stderr
        self.assertIn("calls an axis Z1: expected AX1", said)
        self.assertFalse((self.site / "load").exists())

    def test_aerotech_keeps_planes_and_the_other_axes(self):
        block = lambda n, size: (":START %d SAMPLEDIST=100.0 POSUNIT=PRIMARY CORUNIT=PRIMARY\n:START HOMEOFFSET=0\n" % n +
                                 "".join("%.4f\n" % (size * k) for k in range(5)) + ":END\n")
        plane = (":START2D 2 1 1 2 100.0 100.0 2\n:START2D POSUNIT=METRIC CORUNIT=METRIC/1000 OFFSETROW=0 OFFSETCOL=0\n"
                 "0 0  1 0\n0 2  1 2\n:END\n")
        self.record(["X", "Y", "Z"])
        self.measured("aerotech", machine='asset = "S-1"\n')
        path = self.site / "MACHINE.CAL"
        for end in ("\n", "\r\n"):
            for own in (block(3, 0.002), ""):
                before = "; the builder's words\n" + block(1, 0.001) + own + plane
                path.write_bytes(before.replace("\n", end).encode())
                found = self.json_of("merge", path, "--with", self.folder, "--out", self.site / "load")
                after = (self.site / "load" / "MACHINE.CAL").read_bytes().decode()
                self.assertEqual(after.count("\n"), after.count(end))
                after = after.replace(end, "\n")
                for kept in ("; the builder's words\n" + block(1, 0.001), plane):
                    self.assertIn(kept, after)
                self.tables("aerotech")
                new = self.file("aerotech-Z.cal")
                self.assertEqual(after.count(":START 3 "), 1)
                self.assertIn(new[new.index(":START"):], after)
                self.assertEqual({t["output"] for t in found["tables"] if t["largest_um"] > 0}, {"Z"})
        # What the words of a table say otherwise is another table: a turned sign, other units.
        for word in ("NEGCOR", "CORUNIT=METRIC/1000", "HOMEOFFSET=5", "OUTAXIS3"):
            path.write_text(block(1, 0.001).replace("HOMEOFFSET=0", "HOMEOFFSET=0 " + word))
            self.assertIn(word, self.nonio("table", "insert", path, "--with", self.folder, expect=None).stderr, word)

    def test_a_list_of_twincat_keeps_its_cross_table(self):
        def lis(n, size, more=""):
            return ("# the builder's words\nkopf.achs_nr %d\nkw.ssfk.unit 1\nkw.ssfk.interval 1000000\nkw.ssfk.kw_startpos 0\n"
                    "kw.ssfk.kw_nr_max 5\nkw.ssfk.bilateral 0\nkw.ssfk.modulo 0\n" % n +
                    "".join("kw.ssfk.table[%d].pos %d\n" % (k, size * k) for k in range(5)) + more)
        cross = ("kw.crosscomp.unit 1\nkw.crosscomp.last_index 1\nkw.crosscomp.master_ax_nr 1\nkw.crosscomp.n_cycles 0\n" +
                 "".join("kw.crosscomp.table[%d].setpoint %d\nkw.crosscomp.table[%d].correction %d\n" % (k, 10**6 * k, k, 7 * k)
                         for k in range(2)))
        self.record(["X", "Y", "Z"])
        self.measured("twincat-cnc", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 4.0,
                      options='[options.twincat-cnc]\ncross_sign = "error"\n')
        files = {"X.lis": lis(1, 30), "Z.lis": lis(3, 50, cross + "getriebe[0].lose 11\n")}
        for name, text in files.items():
            (self.site / name).write_text(text)
        both = "%s,%s" % (self.site / "X.lis", self.site / "Z.lis")
        found = self.json_of("merge", both, "--with", self.folder, "--out", self.site / "load")
        self.assertEqual([p.name for p in (self.site / "load").iterdir()], ["Z.lis"])
        after = (self.site / "load" / "Z.lis").read_text()
        self.assertIn("# the builder's words\nkopf.achs_nr 3\n", after)
        self.assertIn(cross + "getriebe[0].lose  40\n", after)
        self.tables("twincat-cnc")
        new = [l for l in self.file("twincat-cnc-Z.lis").splitlines() if l.startswith("kw.ssfk")]
        self.assertEqual([l for l in after.splitlines() if l.startswith("kw.ssfk")], new)
        self.assertEqual({(t["output"], tuple(t["by"])): t["largest_um"] > 0 for t in found["tables"]},
                         {("1", ("1",)): False, ("Z", ("Z",)): True, ("Z", ("1",)): False})
        alone = self.nonio("table", "insert", self.site / "X.lis", "--with", self.folder, expect=1).stderr
        self.assertIn("no list of axis 3 (kopf.achs_nr)", alone)

    def test_a_control_whose_files_contain_one_axis_gets_these_files(self):
        self.record(["X", "Y", "Z"], from_zero=True)
        self.measured("linuxcnc", machine='asset = "S-1"\n', of_axis="")
        path = self.site / "linuxcnc-Z.comp"
        path.write_text("0 0 0\n100 100 100\n")
        out = self.site / "load"
        self.json_of("table", "insert", path, "--with", self.folder, "--out", out)
        self.measured("linuxcnc", machine='asset = "S-1"\n')
        self.tables("linuxcnc")
        self.assertEqual((out / path.name).read_text(), self.file(path.name))
        # The file of another axis would be lost.
        other = self.site / "linuxcnc-X.comp"
        other.write_text("0 0.001 0.001\n100 100 100\n")
        said = self.nonio("table", "insert", "%s,%s" % (path, other), "--with", self.folder, expect=1).stderr
        self.assertIn("the table of X by X would change too", said)
        self.assertIn("give only files that contain the table of Z", said)

    def test_diff_of_the_control_and_a_campaign(self):
        self.record(["X", "Y", "Z"])
        self.measured("siemens-840d", machine='asset = "S-1"\n', minus=lambda x: wave(x) + 4.0)
        path = self.site / "EEC.INI"
        path.write_text(self.archive(((1, 0.001), (3, 0.0))))
        for order in ((path, self.folder), (self.folder, path)):
            (table,) = self.json_of("diff", *order)["tables"]
            self.assertEqual((table["output"], table["present"]["backlash_um"]), ("Z", 3.0))
            self.assertAlmostEqual(table["new"]["backlash_um"], 4.0, places=3)
            self.assertAlmostEqual(table["largest_um"], max(abs(wave(x) - wave(0.0)) for x in TARGETS), places=2)
        self.assertIn("axis Z: they differ by up to", self.nonio("table", "diff", path, self.folder).stdout)


if __name__ == "__main__":
    unittest.main()
