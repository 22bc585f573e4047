#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""controllers, diff, apply and plan sign-probe, on tables written by hand or by the night."""
import json
import math
import unittest

from bench import BenchTest, wave

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
        text = self.nonio("controllers", "pmac").stdout
        self.assertIn("documented", text)
        self.nonio("controllers", "pmax", expect=2)


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
        self.assertIn("--control", self.nonio("diff", nothing, nothing, expect=2).stderr)
        self.nonio("diff", ini, self.site / "missing", expect=2)
        self.nonio("diff", ini, ini, "--control", "no-such", expect=2)

    def test_apply_predicts(self):
        self.one_axis(TARGETS, wave, wave, control="linuxcnc", extra="[options.linuxcnc]\ntype = 1\n")
        for factor, after in ((-1.0, 0.0), (1.0, 2.0), (0.0, 1.0)):
            table = self.comp("linuxcnc-X.comp", lambda x: factor * wave(x))
            p = self.json_of("apply", table, self.folder, expect=1 if after > 1.0 else 0)["predictions"][0]
            E = max(map(wave, TARGETS)) - min(map(wave, TARGETS))
            self.assertAlmostEqual(p["before"]["E_um"], E, places=6)
            self.assertAlmostEqual(p["after"]["E_um"], after * E, delta=0.01)

    def test_a_table_that_was_on_is_renewed(self):
        # the axis is wrong by `wave`; a table that takes half of it away was on
        present = self.comp("linuxcnc-X.comp", lambda x: -0.5 * wave(x))
        self.one_axis(TARGETS, lambda x: 0.5 * wave(x), lambda x: 0.5 * wave(x), control="linuxcnc",
                      extra="[options.linuxcnc]\ntype = 1\n")
        new = self.site / "new"
        found = self.json_of("apply", present, self.folder, "--was-on", "--out", new)
        self.assertLess(found["predictions"][0]["after"]["E_um"], 0.01)
        rows = [list(map(float, line.split())) for line in (new / "linuxcnc-X.comp").read_text().splitlines()]
        for x, up, down in rows:  # all of it, not the rest
            self.assertAlmostEqual(up * 1e3, -wave(x), places=3)
            self.assertAlmostEqual(down * 1e3, -wave(x), places=3)
        self.assertAlmostEqual(found["tables"][0]["largest_um"], max(abs(0.5 * wave(x)) for x in TARGETS), delta=0.01)
        self.nonio("apply", present, self.folder, "--out", new, expect=2)

    def test_backlash_of_the_present_files_is_counted(self):
        # 10 um in the parameter, 3 um still lost: 13 um
        self.one_axis(TARGETS, wave, lambda x: wave(x) + 3.0, control="siemens-840d")
        eec, md = self.site / "eec.ini", self.site / "md.ini"
        eec.write_text("%_N_AX1_EEC_INI\nCHANDATA(1)\n$AA_ENC_COMP[0,0,AX1]=0\n$AA_ENC_COMP[0,1,AX1]=0\n"
                       "$AA_ENC_COMP_STEP[0,AX1]=400\n$AA_ENC_COMP_MIN[0,AX1]=0\n$AA_ENC_COMP_MAX[0,AX1]=400\n"
                       "$AA_ENC_COMP_IS_MODULO[0,AX1]=0\nM17\n")
        md.write_text("%_N_AX1_TEA_INI\nCHANDATA(1)\n$MA_BACKLASH[0,AX1]=0.010\nM17\n")
        found = self.json_of("apply", "%s,%s" % (eec, md), self.folder, "--was-on", "--out", self.site / "n")
        self.assertEqual(found["tables"][0]["present"]["backlash_um"], 10.0)
        self.assertAlmostEqual(found["tables"][0]["new"]["backlash_um"], 13.0, places=3)
        self.assertIn("]=0.013\n", (self.site / "n" / "siemens-840d-X-backlash.ini").read_text())
        self.assertLess(found["predictions"][0]["after"]["B_um"], 0.01)

    def test_every_format_is_read_back(self):
        """What the night writes, apply predicts the same of."""
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
            self.assertAlmostEqual(E["after"]["E_um"], written["E"], places=6, msg=control + options)


class Probe(BenchTest):
    def test_two_stops_and_three_answers(self):
        self.one_axis(TARGETS, wave, wave)
        p = self.json_of("plan", "sign-probe", self.folder, "--out", self.site / "p")["probes"][0]
        pairs = [(abs(wave(b) - wave(a)), a, b) for a in TARGETS[1:] for b in TARGETS if b > a]
        self.assertEqual((p["from_mm"], p["to_mm"]), max(pairs)[1:])
        self.assertAlmostEqual(p["without_table_um"], wave(p["to_mm"]) - wave(p["from_mm"]), places=6)
        self.assertAlmostEqual(p["wrong_sign_um"], 2.0 * p["without_table_um"], places=9)
        text = (self.site / "p" / "sign-probe-X.nc").read_text()
        self.assertEqual(text.count("M0\n"), 2)
        self.assertEqual(text.splitlines()[1], "G1 X0.0000 F1000")
        self.assertTrue(text.endswith("M30\n"))

    def test_the_probe_tells_a_wrong_sign(self):
        """The readings that it promises, from an axis with the table that it is about."""
        self.one_axis(TARGETS, wave, wave)
        p = self.json_of("plan", "sign-probe", self.folder)["probes"][0]
        for sign, key in ((-1.0, "right_sign_um"), (1.0, "wrong_sign_um"), (0.0, "without_table_um")):
            def actual(x):
                return x + sign * wave(x) * 1e-3 + wave(x + sign * wave(x) * 1e-3) * 1e-3
            reading = (actual(p["to_mm"]) - actual(p["from_mm"]) - (p["to_mm"] - p["from_mm"])) * 1e3
            self.assertAlmostEqual(reading, p[key], delta=0.02)

    def test_in_the_language_of_the_control(self):
        self.one_axis(TARGETS, wave, wave, control="heidenhain-tnc")
        self.nonio("plan", "sign-probe", self.folder, "--out", self.site / "p")
        lines = (self.site / "p" / "sign-probe-X.H").read_text().splitlines()
        self.assertEqual(lines[0], "0 BEGIN PGM SIGN_PROBE MM")
        self.assertEqual(sum(l.endswith("STOP") for l in lines), 2)

    def test_an_axis_that_is_too_good_shows_nothing(self):
        noise = iter([0.3, -0.4, 0.1, 0.5, -0.2] * 100)
        self.one_axis(TARGETS, lambda x: next(noise), lambda x: next(noise))
        p = self.json_of("plan", "sign-probe", self.folder, expect=1)["probes"][0]
        self.assertFalse(p["shows"])
        self.one_axis([0.0, 10.0], wave, wave)
        self.assertIn("3 targets", self.nonio("plan", "sign-probe", self.folder, expect=1).stderr)


if __name__ == "__main__":
    unittest.main()
