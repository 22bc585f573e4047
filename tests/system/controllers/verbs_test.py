#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""controllers, diff, apply and plan sign-probe, on tables written by hand or by a run."""
import json
import math
import os
import shutil
import unittest
import unittest.mock

from bench import BenchTest, axis_csv, wave

TARGETS = [50.0 * i for i in range(9)]


class Controllers(BenchTest):
    def test_lists_what_each_can_take(self):
        of = {c["name"]: c for c in self.json_of("controllers")["controllers"]}
        self.assertGreaterEqual(set(of), {
            "aerotech", "ecmc", "fagor-8055", "fanuc", "haas-classic", "heidenhain-tnc", "klipper", "linuxcnc",
            "marlin", "mitsubishi", "pmac", "siemens-840d", "twincat-cnc", "twincat-nc-ptp", "twincat-volumetric"})
        self.assertEqual(of["siemens-840d"]["sign"], "error")
        self.assertTrue(of["siemens-840d"]["takes"]["bidirectional"])
        self.assertEqual(of["fanuc"]["increment"], [-7, 7])
        self.assertEqual(of["linuxcnc"]["points"], 256)
        self.assertTrue(of["twincat-volumetric"]["takes"]["volumetric"])
        for name in ("fagor-8055", "haas-classic", "twincat-volumetric"):
            self.assertNotIn("sign", of[name], "nobody knows it")
        for c in of.values():
            self.assertTrue(c["facts"], c["name"])
        text = self.nonio("table", "controls", "pmac").stdout
        self.assertIn("documented", text)
        self.nonio("table", "controls", "pmax", expect=2)


    def test_a_sample_plugin_that_is_not_built_is_an_error_that_states_how(self):
        for options, start in (("", 'machine.control: there is no controller "klipper"'),
                               ("[options.klipper]\naxes = []\n", 'options.klipper: there is no plugin "klipper"')):
            self.one_axis(TARGETS, wave, wave, options, control="klipper")
            with unittest.mock.patch.dict(os.environ, NONIO_PLUGIN_PATH=""):
                error = self.run_site(expect=1)["errors"][0]["message"]
            self.assertTrue(error.startswith(start + "; it is a sample plugin: build share/doc/nonio/examples/plugins with CMake"), error)
            self.assertIn("--plugin-path", error)


class Tables(BenchTest):
    def comp(self, name, correction):
        """A LinuxCNC table of type 1: what is added, um over mm, the same in both directions."""
        path = self.site / name
        path.write_text("".join("%g %.6f %.6f\n" % (x, correction(x) * 1e-3, correction(x) * 1e-3) for x in TARGETS))
        return path

    def test_difference_by_hand(self):
        old = self.comp("old.comp", lambda x: 0.0)
        new = self.comp("new.comp", lambda x: {100.0: 2.0, 150.0: -3.0}.get(x, 0.0))
        d = self.json_of("diff", old, new, "--control", "linuxcnc", "--set", "type=1", "--axis", "X")["tables"][0]
        self.assertEqual((d["output"], d["by"]), ("X", ["X"]))
        self.assertAlmostEqual(d["largest_um"], 3.0, places=5)  # the control keeps floats
        self.assertEqual(d["at_mm"], 150.0)
        self.assertAlmostEqual(d["range_um"], 5.0, places=5)
        self.assertAlmostEqual(d["new"]["largest_step_um"], 5.0, places=5)
        self.assertEqual(d["new"]["largest_step_from_mm"], 100.0)
        self.assertAlmostEqual(d["new"]["largest_slope_um_per_m"], 100.0, places=4)
        self.assertEqual(d["present"]["largest_um"], 0.0)

    def put(self, name, text):
        path = self.site / name
        path.write_text(text)
        return path

    def test_a_list_of_twincat_by_either_key_of_its_axis(self):
        body = "kw.ssfk.unit 1\nkw.ssfk.interval 100000\nkw.ssfk.kw_startpos -200000\nkw.ssfk.kw_nr_max 3\nkw.ssfk.bilateral 1\n" + "".join(
            f"kw.ssfk.table[{i}].{side} {v}\n" for side, column in (("pos", (0, 30, -40)), ("neg", (0, 55, 70))) for i, v in enumerate(column))
        one, other = (self.put(f"{key}.lis", f"kopf.{key} 3\n" + body) for key in ("achs_nr", "log_achs_nr"))
        d = self.json_of("diff", one, other)["tables"][0]
        self.assertEqual((d["output"], d["largest_um"], d["new"]["largest_um"]), ("3", 0.0, 7.0))
        both = self.put("both.lis", "kopf.achs_nr 3\nkopf.log_achs_nr 4\n" + body)
        self.assertIn("controller twincat-cnc: both.lis, line 1: ", self.nonio("diff", both, one, expect=2).stderr)
        neither = self.put("neither.lis", body)
        self.assertIn("controller twincat-cnc: neither.lis, line 1: no kopf.achs_nr", self.nonio("diff", neither, one, expect=2).stderr)

    def test_the_type_of_a_comp_file_by_its_entries(self):
        nothing = self.put("a.comp", "".join(f"{x} 0 0\n" for x in (0, 120, 240)))
        trims = self.put("b.comp", "0 0 0\n80 -0.2 -0.2\n200 0.3 0.3\n360 0 0\n")
        positions = self.put("c.comp", "0 0.004 0.004\n100 100.01 100.02\n200 199.99 200\n")
        d = self.json_of("diff", nothing, trims)["tables"]
        self.assertEqual(len(d), 1)
        self.assertAlmostEqual(d[0]["largest_um"], 300.0, places=4)
        d = self.json_of("diff", nothing, trims, "--axis", "B")["tables"][0]
        self.assertAlmostEqual(d["largest_arcsec"], 0.3 * 3600, places=4)
        d = self.json_of("diff", positions, positions, "--axis", "X")["tables"][0]
        self.assertAlmostEqual(d["new"]["largest_um"], 20.0, places=4)
        refused = self.nonio("diff", positions, positions, "--control", "linuxcnc", "--axis", "X", "--set", "type=1", expect=2).stderr
        self.assertIn("controller linuxcnc: c.comp, line 1: columns 2 and 3 are actual positions: state type = 0", refused)

    def test_compensation_tables_of_pmac_as_makers_write_them(self):
        of = ("--control", "pmac", "--axis", "X", "--set", "axes=X number=2 counts_per_mm=1000")
        plain = self.put("a.pmc", "#2 DEFINE COMP 4,4000\n-160 320,0,0\n")
        forms = ("; one line\n#2 DEFINE COMP 4 #2,#2,4000 ; comment\n-160,320,0,0\n#7 DEFINE COMP 2,2000\n1 2\n",
                 "#2\nDELETE COMP\ndefine comp 4,4000\n-160\n320\n0\n0\n", "#2 def comp 4,#2,4000\n-160,320 // here\n0,0\n")
        for k, text in enumerate(forms):
            d = self.json_of("diff", self.put(f"form{k}.pmc", text), plain, *of)["tables"]
            self.assertEqual([(t["output"], t["largest_um"], t["present"]["largest_um"]) for t in d], [("X", 0.0, 20.0)], text)
        # motor 5 by the position of motor 2, which has other counts
        cross = self.put("cross.pmc", "#5 DEFINE COMP 4,#2,#5,4000\n-160 320 0 0\n")
        d = self.json_of("diff", cross, cross, "--control", "pmac", "--axis", "X", "--axis", "Y",
                         "--set", "axes=X number=2 counts_per_mm=1000, Y number=5 counts_per_mm=500")["tables"][0]
        self.assertEqual((d["output"], d["by"], d["new"]["largest_um"], d["new"]["largest_step_from_mm"]), ("Y", ["X"], 40.0, 1.0))
        for text, line, words in (("#2 DEFINE COMP 4,4000\n1 2 3\n", 2, "expected 4 entries of motor 2, found 3"),
                                  ("#2 DEFINE COMP 4,4000\n1 2 3 4 5\n", 2, "expected 4 entries of motor 2, found more"),
                                  ("#2 DEFINE COMP 4,4000\n1 2 x 4\n", 2, "found 2 before X"),
                                  ("#2\n#2 DEFINE BLCOMP 4,4000\n1 2 3 4\n", 2, "only DEFINE COMP is read, found DEFINE BLCOMP"),
                                  ("#2 DEFINE COMP 2.3,4000,4000\n1\n", 1, "tables of two axes are not read")):
            bad = self.put("bad.pmc", text)
            self.assertIn(f"controller pmac: bad.pmc, line {line}: ", error := self.nonio("diff", bad, plain, *of, expect=2).stderr)
            self.assertIn(words, error)
        self.assertIn("controller pmac: a.pmc, line 1: axis 2: how many counts has the encoder?", self.nonio("diff", plain, plain, expect=2).stderr)

    def test_a_table_alone_and_two_axes_of_one_kind(self):
        saved = self.put("printer.cfg", "[printer]\n#*# <---- SAVE_CONFIG ---->\n#*# [skew_correction plate]\n#*# xy_skew = -0.00125\n")
        found = self.json_of("diff", saved)
        self.assertEqual([(t["output"], t["by"], t["present"]["largest_slope_um_per_m"]) for t in found["tables"]][0], ("X", ["Y"], 1250.0))
        text = self.nonio("diff", saved).stdout
        self.assertIn("adds up to 1250 um", text)
        self.assertNotIn("differ", text)
        self.assertNotIn("new", text)
        both = self.put("both.pmc", "#1 DEFINE COMP 4,4000\n160 320 0 0\n#2 DEFINE COMP 4,4000\n160 352 0 0\n")
        one = self.put("one.pmc", "#2 DEFINE COMP 4,4000\n160 352 0 0\n")
        motors = ("--control", "pmac", "--set", "axes=X number=1 counts_per_mm=1000, Y number=2 counts_per_mm=1000")
        for other, axes, wanted in ((both, "X=Y", ("X=Y", 2.0, 2.0, 20.0)), (one, "X=Y", ("X=Y", 2.0, 2.0, 20.0)), (both, "Y=X", ("Y=X", 2.0, 2.0, 22.0))):
            (d,) = self.json_of("diff", both, other, "--axis", axes, *motors)["tables"]
            self.assertEqual((d["output"], d["largest_um"], d["at_mm"], d["present"]["largest_um"]), wanted)
        self.assertIn("the new table has none of axis X", self.nonio("diff", both, one, "--axis", "Y=X", *motors, expect=2).stderr)

    def test_tables_of_siemens_of_any_size_and_as_part_program(self):
        entries = [0.001 * (i % 9) for i in range(640)]
        encoder = "%_N_AX_EEC_INI\nCHANDATA(1)\n" + "".join(f"$AA_ENC_COMP[0,{i},X1]={v:g}\n" for i, v in enumerate(entries)) + (
            "$AA_ENC_COMP_STEP[0,X1]=1.0\n$AA_ENC_COMP_MIN[0,X1]=0.0\n$AA_ENC_COMP_MAX[0,X1]=639.0\n$AA_ENC_COMP_IS_MODULO[0,X1]=0\nM17\n")
        large = self.put("large.ini", encoder)
        found = self.json_of("diff", large, large)
        self.assertEqual((found["control"], found["tables"][0]["new"]["largest_um"]), ("siemens-840d", 8.0))
        error = self.nonio("diff", large, large, "--set", "max_points=500", expect=2).stderr
        self.assertIn("controller siemens-840d: large.ini, line 503: alarm 12400", error)
        self.assertIn("option max_points", error)
        table = "".join(f"$AN_CEC[2,{i}]={v}\n" for i, v in enumerate((0.0, 0.011, 0.03))) + (
            "$AN_CEC_INPUT_AXIS[2]=(Z1)\n$AN_CEC_OUTPUT_AXIS[2]=(Z1)\n$AN_CEC_STEP[2]=100\n$AN_CEC_MIN[2]=0\n$AN_CEC_MAX[2]=200\n"
            "$AN_CEC_DIRECTION[2]=1\n$AN_CEC_IS_MODULO[2]=0\n")
        archive = self.put("archive.ini", "%_N_NC_CEC_INI\nCHANDATA(1)\n" + table + "M17\n")
        for end in ("M17\n", "M0\n\nM17\n", "M30\n"):
            d = self.json_of("diff", self.put("program.spf", "; set\n" + table + end), archive)["tables"]
            self.assertEqual([(t["output"], t["largest_um"], t["present"]["largest_um"]) for t in d], [("Z1", 0.0, 30.0)])
        for text, line, words in ((table, 10, "no M17 at the end"), (table.replace("MODULO[2]=0", "MODULO[2]=-1") + "M17\n", 10, "IS_MODULO is 0 or 1"),
                                  ("%_N_NC_CEC_INI\n" + table + "M17\n", None, "assignment before CHANDATA")):
            error = self.nonio("diff", self.put("bad.spf", text), archive, "--control", "siemens-840d", expect=2).stderr
            self.assertIn(words, error)
            if line:
                self.assertIn(f"bad.spf, line {line}: ", error)

    def test_a_file_of_no_known_control(self):
        other = self.put("other.dat", "unit = mm\n[X]\n-100.0, 0.003, 0.012\n0.0, 0.0, 0.009\n")
        error = self.nonio("diff", other, other, expect=2).stderr
        self.assertIn("other.dat: no control known to Nonio could have written it; known are ", error)
        self.assertIn(" aerotech, ", error)
        self.assertNotIn("--control", error)

    def test_the_control_is_known_by_its_files_or_asked_for(self):
        old = self.comp("linuxcnc-X.comp", lambda x: 1.0)
        self.assertEqual(self.json_of("diff", old, old, "--axis", "X", "--set", "type=1")["control"], "linuxcnc")
        ini = self.site / "backup.ini"
        ini.write_text("%_N_AX1_EEC_INI\nCHANDATA(1)\n" + "".join(
            "$AA_ENC_COMP[0,%d,AX1]=%g\n" % (i, 0.001 * i) for i in range(3)) +
            "$AA_ENC_COMP_STEP[0,AX1]=50.0\n$AA_ENC_COMP_MIN[0,AX1]=0.0\n$AA_ENC_COMP_MAX[0,AX1]=100.0\n"
            "$AA_ENC_COMP_IS_MODULO[0,AX1]=0\nM17\n")
        found = self.json_of("diff", ini, ini)
        self.assertEqual((found["control"], found["tables"][0]["output"]), ("siemens-840d", "AX1"))
        self.assertEqual(self.json_of("diff", ini, ini, "--axis", "X")["tables"][0]["output"], "X")
        nothing = self.site / "nothing.txt"
        nothing.write_text("hello\n")
        self.assertIn("no control known to Nonio", self.nonio("table", "diff", nothing, nothing, expect=2).stderr)
        self.nonio("table", "diff", ini, self.site / "missing", expect=2)
        self.nonio("table", "diff", ini, ini, "--control", "no-such", expect=2)

    def test_a_saved_skew_of_klipper(self):
        """printer.cfg as SKEW_PROFILE SAVE leaves it, against SET_SKEW with the lengths of a parallelogram of that lean."""
        saved, lengths, twice = (self.site / name for name in ("printer.cfg", "skew.cfg", "twice.cfg"))
        saved.write_text("[skew_correction]\n\n#*# <------- SAVE_CONFIG ------->\n#*# [skew_correction first]\n"
                         "#*# xy_skew = -0.00354\n#*# xz_skew = 0.0\n#*# yz_skew = 0.0\n")
        side, along, angle = 90.0, 100.0, math.pi / 2 - math.atan(-0.00354)
        ac, bd = (math.sqrt(side ** 2 + along ** 2 + sign * 2 * side * along * math.cos(angle)) for sign in (1, -1))
        lengths.write_text(f"SET_SKEW XY={ac:.9f},{bd:.9f},{along:.9f}\n")
        xy = next(t for t in self.json_of("table", "diff", saved, lengths)["tables"] if t["by"] == ["Y"])
        self.assertAlmostEqual(xy["present"]["largest_slope_um_per_m"], 3540.0, places=3)
        self.assertAlmostEqual(xy["new"]["largest_slope_um_per_m"], 3540.0, places=3)
        self.assertLess(xy["largest_um"], 1e-3)
        twice.write_text(saved.read_text() + "#*# [skew_correction second]\n#*# xy_skew = 0.1\n")
        self.assertIn("two saved profiles, first and second",
                      self.nonio("table", "diff", twice, twice, "--control", "klipper", expect=2).stderr)

    def test_blocks_of_newer_fanuc_controls(self):
        """N03620Q1A1P40 is N03620A1P40."""
        rows = {3620: 33, 3621: 33, 3622: 34, 3623: 1, 3624: 50000, 3625: 0}
        old = "%\n" + "".join(f"N{n:05d}A1P{v}\n" for n, v in rows.items()) + "N10033P2\nN10034P-1\n%\n"
        new = old.replace("A1P", "Q1A1P").replace("N10033P", "N10033Q0P").replace("N10034P", "N10034Q1P")
        a, b, wrong = (self.site / name for name in ("old.prm", "new.prm", "wrong.prm"))
        a.write_text(old), b.write_text(new), wrong.write_text(new.replace("Q1A1P34", "Q7A1P34"))
        arguments = ("--control", "fanuc", "--axis", "X", "--set", "axes=X number=1")
        self.assertEqual(self.json_of("table", "diff", a, b, *arguments)["tables"],
                         self.json_of("table", "diff", a, a, *arguments)["tables"])
        self.assertIn("not a block: N03622Q7A1P34",
                      self.nonio("table", "diff", wrong, a, *arguments, expect=2).stderr)

    def test_apply_predicts(self):
        self.one_axis(TARGETS, wave, wave, control="linuxcnc", extra="[options.linuxcnc]\ntype = 1\n")
        for factor, after in ((-1.0, 0.0), (1.0, 2.0), (0.0, 1.0)):
            table = self.comp("linuxcnc-X.comp", lambda x: factor * wave(x))
            p = self.json_of("apply", table, self.folder, expect=1 if after > 1.0 else 0)["predictions"][0]
            E = max(map(wave, TARGETS)) - min(map(wave, TARGETS))
            self.assertAlmostEqual(p["before"]["E_um"], E, places=6)
            self.assertAlmostEqual(p["after"]["E_um"], after * E, delta=0.05)  # not below U of the reversal

    def test_a_table_that_was_on_is_renewed(self):
        # the axis is wrong by `wave`; a table that takes half of it away was on
        self.active_stated = False
        present = self.comp("linuxcnc-X.comp", lambda x: -0.5 * wave(x))
        self.one_axis(TARGETS, lambda x: 0.5 * wave(x), lambda x: 0.5 * wave(x), control="linuxcnc",
                      extra="[options.linuxcnc]\ntype = 1\n")
        new = self.site / "new"
        found = self.json_of("apply", present, self.folder, "--active-table", "--out", new)
        self.assertLess(found["predictions"][0]["after"]["E_um"], 0.05)
        rows = [list(map(float, line.split())) for line in (new / "linuxcnc-X.comp").read_text().splitlines()]
        whole = lambda x: wave(0.0) - wave(x)  # zero at the reference point
        for x, up, down in rows:  # all of it, not the rest
            self.assertAlmostEqual(up * 1e3, whole(x), places=3)
            self.assertAlmostEqual(down * 1e3, whole(x), places=3)
        self.assertAlmostEqual(found["tables"][0]["largest_um"], max(abs(whole(x) + 0.5 * wave(x)) for x in TARGETS),
                               delta=0.01)
        self.nonio("table", "predict", present, self.folder, "--out", new, expect=2)
        # The campaign may state the same file.
        self.active_stated = True
        self.one_axis(TARGETS, lambda x: 0.5 * wave(x), lambda x: 0.5 * wave(x), control="linuxcnc",
                      extra="[options.linuxcnc]\ntype = 1\n")
        text = (self.folder / "campaign.toml").read_text()
        (self.folder / "campaign.toml").write_text(text.replace('active_table = "none"', 'active_table = "active.comp"'))
        shutil.copy(present, self.folder / "active.comp")
        self.assertEqual(self.json_of("apply", present, self.folder, "--active-table")["tables"], found["tables"])
        # The campaign states that none was active: one of the two is wrong.
        self.active_stated = True
        self.one_axis(TARGETS, wave, wave, control="linuxcnc")
        done = self.nonio("table", "predict", present, self.folder, "--active-table", "--out", self.site / "other", expect=2)
        self.assertIn('states active_table = "none" of axis X', done.stderr)

    def test_backlash_of_the_present_files_is_counted(self):
        # 10 um in the parameter, 3 um still lost: 13 um
        self.active_stated = False
        self.one_axis(TARGETS, wave, lambda x: wave(x) + 3.0, control="siemens-840d")
        eec, md = self.site / "eec.ini", self.site / "md.ini"
        eec.write_text("%_N_AX1_EEC_INI\nCHANDATA(1)\n$AA_ENC_COMP[0,0,AX1]=0\n$AA_ENC_COMP[0,1,AX1]=0\n"
                       "$AA_ENC_COMP_STEP[0,AX1]=400\n$AA_ENC_COMP_MIN[0,AX1]=0\n$AA_ENC_COMP_MAX[0,AX1]=400\n"
                       "$AA_ENC_COMP_IS_MODULO[0,AX1]=0\nM17\n")
        md.write_text("%_N_AX1_TEA_INI\nCHANDATA(1)\n$MA_BACKLASH[0,AX1]=0.010\nM17\n")
        found = self.json_of("apply", "%s,%s" % (eec, md), self.folder, "--active-table", "--out", self.site / "n")
        self.assertEqual(found["tables"][0]["present"]["backlash_um"], 10.0)
        self.assertAlmostEqual(found["tables"][0]["new"]["backlash_um"], 13.0, places=3)
        self.assertIn("]=0.013\n", (self.site / "n" / "siemens-840d-X-backlash.ini").read_text())
        after = found["predictions"][0]["after"]
        self.assertLess(after["B_um"], 0.05)
        self.assertGreaterEqual(after["E_um"], after["B_um"])

    def test_every_format_is_read_back(self):
        """What the run writes, apply predicts of it."""
        below = [-x for x in TARGETS[::-1]]
        for control, options, file in (
                ("siemens-840d", "", "siemens-840d-X-EEC.ini,siemens-840d-X-backlash.ini"),
                ("siemens-840d", "directions = true", "siemens-840d-X-CEC.ini"),
                ("heidenhain-tnc", "", "heidenhain-tnc-X.COM,heidenhain-tnc-X.txt"),
                ("heidenhain-tnc", 'layout = "itnc530"', "heidenhain-tnc-X.COM,heidenhain-tnc-X.txt"),
                ("fanuc", "", "fanuc-X.prm"),
                ("fanuc", "directions = true", "fanuc-X.prm"),
                ("linuxcnc", "", "linuxcnc-X.comp"),
                ("twincat-cnc", "", "twincat-cnc-X.lis"),
                ("twincat-cnc", "directions = true", "twincat-cnc-X.lis"),
                ("twincat-nc-ptp", "", "twincat-nc-ptp-X.st"),
                ("twincat-volumetric", 'sign = "error"', "twincat-volumetric-X.csv"),
                ("fagor-8055", 'sign = "correction"', "fagor-8055-X.txt"),
                ("haas-classic", 'sign = "error"', "haas-classic-X.txt"),
                ("mitsubishi", "", "mitsubishi-X.txt"),
                ("pmac", 'axes = ["X counts_per_mm=2000"]', "pmac-X.pmc,pmac-X.txt"),
                ("aerotech", "", "aerotech-X.cal"),
                ("ecmc", "release = 9", "ecmc-X.corr")):
            targets = below if control == "haas-classic" else TARGETS
            self.one_axis(targets, wave, lambda x: wave(x) + 3.0, "[options.%s]\n%s\n" % (control, options), control)
            results = self.run_site()
            written = {p["name"]: p["predicted"] for t in results["tables"] for p in t["predictions"]}
            files = ",".join(str(self.out / "c" / name) for name in file.split(","))
            found = self.json_of("apply", files, self.folder)
            self.assertEqual(found["control"], control)
            E = found["predictions"][0]
            self.assertLess(E["after"]["M_um"], 0.35 * E["before"]["M_um"], control + options)
            # The prediction is the effect of the files, but at least U of the reversal that they compensate.
            self.assertLess(E["after"]["E_um"], written["E"] + 1e-6, control + options)
            self.assertLess(written["E"], E["after"]["E_um"] + 0.05, control + options)


class Probe(BenchTest):
    def test_two_stops_and_three_answers(self):
        self.one_axis(TARGETS, wave, wave)
        p = self.json_of("table", "probe", self.folder, "--out", self.site / "p")["probes"][0]
        pairs = [(abs(wave(b) - wave(a)), a, b) for a in TARGETS[1:] for b in TARGETS if b > a]
        self.assertEqual((p["from_mm"], p["to_mm"]), max(pairs)[1:])
        self.assertAlmostEqual(p["without_table_um"], wave(p["to_mm"]) - wave(p["from_mm"]), places=6)
        self.assertAlmostEqual(p["wrong_sign_um"], 2.0 * p["without_table_um"], places=9)
        text = (self.site / "p" / "sign-probe-X.nc").read_text()
        self.assertEqual(text.count("M0\n"), 2)
        self.assertTrue(text.endswith("M30\n"))
        # It moves a machine: dry run first, unit and plane said, every offset and cycle switched off, a rest before it is read.
        comments, code = text.split("G21 ", 1)
        self.assertIn("(DRY RUN FIRST", comments)
        self.assertIn("(positions are those of the machine: no offset may be active)", comments)
        self.assertEqual(code.splitlines()[:4], ["G17 G90 G94 G40 G49 G80", "G61", "G54", "F1000"])
        stops = ["G1 X%s\nG4 P5\nM0\n" % float(p[k]) for k in ("from_mm", "to_mm")]
        self.assertTrue(code.endswith("F1000\nG1 X0.0\n" + "".join(stops) + "M30\n"), code)

    def test_what_the_writer_of_programs_refuses_is_refused_here(self):
        """X1 and a number behind it would be another position of X."""
        self.one_axis(TARGETS, wave, wave, axis="X1")
        done = self.nonio("table", "probe", self.folder, "--out", self.site / "p", expect=2)
        self.assertIn("axis X1: expected a single letter", done.stderr)
        self.assertFalse((self.site / "p").exists())

    def test_dwell_and_writer_can_be_said(self):
        self.one_axis(TARGETS, wave, wave, control="siemens-840d")
        self.nonio("table", "probe", self.folder, "--out", self.site / "p", "--set", "dwell_s=3")
        text = (self.site / "p" / "sign-probe-X.mpf").read_text()
        self.assertIn("G710 G90 G94 G40 G500 D0\n", text)
        self.assertIn("DRY RUN FIRST", text)
        self.assertEqual(text.count("G4 F3\nM0\n"), 2)
        self.nonio("table", "probe", self.folder, "--out", self.site / "p", "--control", "gcode")
        self.assertIn("G21 ", (self.site / "p" / "sign-probe-X.nc").read_text())

    def test_the_probe_finds_a_wrong_sign(self):
        """The readings that it promises, from an axis with the table that it is about."""
        self.one_axis(TARGETS, wave, wave)
        p = self.json_of("table", "probe", self.folder)["probes"][0]
        for sign, key in ((-1.0, "right_sign_um"), (1.0, "wrong_sign_um"), (0.0, "without_table_um")):
            def actual(x):
                return x + sign * wave(x) * 1e-3 + wave(x + sign * wave(x) * 1e-3) * 1e-3
            reading = (actual(p["to_mm"]) - actual(p["from_mm"]) - (p["to_mm"] - p["from_mm"])) * 1e3
            self.assertAlmostEqual(reading, p[key], delta=0.02)

    def test_in_the_language_of_the_control(self):
        self.one_axis(TARGETS, wave, wave, control="heidenhain-tnc")
        self.nonio("table", "probe", self.folder, "--out", self.site / "p")
        lines = (self.site / "p" / "sign-probe-X.H").read_text().splitlines()
        self.assertEqual(lines[0], "0 BEGIN PGM NONIO_sign_probe_X MM")
        words = [l.split(" ", 1)[1] for l in lines]
        self.assertIn("; DRY RUN FIRST, without instrument, at low override", words)
        self.assertIn("TOOL CALL 0 Z", words)
        moves = [w for w in words if w.startswith("L ")]
        self.assertEqual(len(moves), 3)
        self.assertTrue(all(w.endswith(" R0 F1000 M91") for w in moves), moves)
        stops = [i for i, w in enumerate(words) if w == "STOP"]
        self.assertEqual([words[i - 1] for i in stops], ["CYCL DEF 9.1 DWELL 5"] * 2)

    def test_the_probe_moves_in_machine_coordinates_whatever_the_control(self):
        for control, of_axis in (("linuxcnc", ""), ("fanuc", ""), ("twincat-cnc", ""), ("aerotech", ""),
                                 ("mitsubishi", "")):
            self.one_axis(TARGETS, wave, wave, of_axis, control=control)
            self.nonio("table", "probe", self.folder, "--out", self.site / "p")
            text = (self.site / "p" / "sign-probe-X.nc").read_text()
            moves = [l for l in text.splitlines() if "G1 X" in l]
            self.assertEqual(len(moves), 3)
            self.assertTrue(all(m.startswith("G53 G1 X") for m in moves), text)
            self.assertNotIn("G54", text)
            for word in ("(machine: not named in the manifest)", "moves X, the other axes stay", "G21 G17 G90 G94 G40 G49 G80"):
                self.assertIn(word, text)
        self.one_axis(TARGETS, wave, wave, control="siemens-840d")
        self.nonio("table", "probe", self.folder, "--out", self.site / "p")
        moves = [l for l in (self.site / "p" / "sign-probe-X.mpf").read_text().splitlines() if l.startswith("G1")]
        self.assertEqual([m.split(" X")[0] for m in moves], ["G1 SUPA"] * 3)

    def test_no_program_for_a_control_without_gcode(self):
        for control in ("ecmc", "pmac", "twincat-nc-ptp"):
            self.one_axis(TARGETS, wave, wave, control=control)
            self.nonio("table", "probe", self.folder)  # the moves are printed
            done = self.nonio("table", "probe", self.folder, "--out", self.site / "p", expect=2)
            self.assertIn("runs no part programs in G-code", done.stderr)
            self.assertFalse((self.site / "p").exists())

    def test_the_probe_stays_within_the_travel(self):
        said = '[options.linuxcnc]\naxes = ["X from_mm=0 to_mm=%d"]\n'
        self.one_axis(TARGETS, wave, wave, said % 60, control="linuxcnc")
        done = self.nonio("table", "probe", self.folder, "--out", self.site / "p", expect=1)
        self.assertRegex(done.stderr, r"the travel is 0(\.0+)? mm to 60(\.0+)? mm")
        self.assertFalse((self.site / "p").exists())
        self.one_axis(TARGETS, wave, wave, said % 400, control="linuxcnc")
        self.nonio("table", "probe", self.folder, "--out", self.site / "p")

    def test_an_axis_that_is_too_good_shows_nothing(self):
        noise = iter([0.3, -0.4, 0.1, 0.5, -0.2] * 100)
        self.one_axis(TARGETS, lambda x: next(noise), lambda x: next(noise))
        p = self.json_of("table", "probe", self.folder, expect=1)["probes"][0]
        self.assertFalse(p["shows"])
        self.one_axis([0.0, 10.0], wave, wave)
        self.assertIn("3 targets", self.nonio("table", "probe", self.folder, expect=1).stderr)


class Gantry(BenchTest):
    """X has a scale on each side: master and slave are two axes of the control, and have a table each."""

    def gantry(self, axis="", sides=("", ""), extra="", control="siemens-840d", structure="gantry"):
        self.record(["X", "Y"])
        text = ('format = 1\n[campaign]\nid = "c"\n[machine]\nasset = "S-1"\nstructure = "%s"\ncontrol = "%s"\n' % (structure, control)
                + self.none_active("X", "linear") + axis + "\n" + self.none_active("Y", "linear"))
        if "slave" in axis and "axes.X2" not in axis:
            text += self.none_active("X2", "linear")
        for name, side, at, size in (("X1", sides[0], 300, 1.0), ("X2", sides[1], 8700, -2.0)):
            error = lambda x, size=size: size * wave(x)
            (self.folder / (name + ".csv")).write_text(axis_csv(TARGETS, error, error))
            text += ('[[measurement]]\nid = "%s"\nkind = "axis"\naxis = "X"\nfile = "%s.csv"\nat = { Y = %d }\n%s\n'
                     % (name, name, at, 'side = "%s"' % side if side else ""))
        (self.folder / "campaign.toml").write_text(text + '[run]\nanalyses = ["iso230-2"]\noutputs = ["%s"]\n' % control + extra)

    def tables(self, control="siemens-840d"):
        results = self.run_site(expect=None)
        table = next(t for t in results["tables"] if t["plugin"] == control) if "tables" in results else {"findings": []}
        return ({p.name: p.read_text() for p in (self.out / "c").glob(control + "-*")},
                [f["id"] for f in table["findings"]], results)

    def test_nothing_is_written_before_the_sides_are_said(self):
        self.gantry()
        files, findings, _ = self.tables()
        self.assertEqual(files, {})
        self.assertEqual(findings, ["table.gantry-sides"])
        # One of them said is not enough.
        self.gantry('slave = "X2"', ("", "slave"))
        self.assertEqual(self.tables()[:2], ({}, ["table.gantry-sides"]))

    def test_master_and_slave_have_a_table_each(self):
        said = '[options.siemens-840d]\naxes = ["X2 number=4"]\n'
        self.gantry('slave = "X2"', ("master", "slave"), said)
        files, findings, results = self.tables()
        self.assertNotIn("table.two-measurements", findings)
        self.assertNotIn("table.gantry-sides", findings)
        master, slave = files["siemens-840d-X-EEC.ini"], files["siemens-840d-X2-EEC.ini"]
        self.assertIn("%_N_AX1_EEC_INI", master)
        self.assertNotIn("AX4", master)
        self.assertIn("%_N_AX4_EEC_INI", slave)
        self.assertNotIn("AX1", slave)
        entries = [[float(l.split("=")[1]) for l in text.splitlines() if l.startswith("$AA_ENC_COMP[")]
                   for text in (master, slave)]
        for a, b in zip(*entries):  # each from its own readings: the second side errs by -2 times the first
            self.assertAlmostEqual(b, -2.0 * a, delta=1.1e-6)
        # Each is predicted for the readings of its own side.
        after = {p["measurement"]: p["predicted"] for t in results["tables"] for p in t["predictions"] if p["name"] == "E"}
        self.assertEqual(set(after), {"X1", "X2"})
        self.assertTrue(all(abs(v) < 0.01 for v in after.values()), after)

    def test_a_slave_without_a_number_gets_no_table_under_a_guessed_one(self):
        self.gantry('slave = "X2"', ("master", "slave"))
        files, findings, _ = self.tables()
        self.assertIn("table.axis-number", findings)
        # Nor does the master get one: a table of one side alone turns the beam.
        self.assertIn("table.gantry-one-side", findings)
        self.assertEqual(files, {})
        # The record of the machine says it too; its place among the machine's axes does not.
        self.gantry('slave = "X2"\n[machine.axes.Z]\nkind = "linear"\n' + self.none_active("X2", "linear"), ("master", "slave"))
        self.assertIn("table.axis-number", self.tables()[1])
        self.record(["X", "Y", "X2"])
        self.assertIn("%_N_AX3_EEC_INI", self.tables()[0]["siemens-840d-X2-EEC.ini"])

    def test_a_control_that_counts_no_axes_needs_the_name_only(self):
        self.gantry('slave = "X2"', ("master", "slave"), control="heidenhain-tnc")
        files, findings, _ = self.tables("heidenhain-tnc")
        self.assertNotIn("table.axis-number", findings)
        self.assertIn("heidenhain-tnc-X2.COM", files)

    def test_a_side_wants_the_name_of_the_second_axis(self):
        self.gantry("", ("master", "slave"))
        done = self.nonio("run", self.site, "--out", self.out, expect=1)
        self.assertIn("expected [machine.axes.X] slave", done.stderr + (self.out / "c" / "results.json").read_text())

    def test_two_lines_of_another_machine_are_a_choice_as_before(self):
        self.gantry(structure="bridge")
        files, findings, _ = self.tables()
        self.assertIn("table.two-measurements", findings)
        self.assertEqual(len([n for n in files if n.endswith("EEC.ini")]), 2)


if __name__ == "__main__":
    unittest.main()
