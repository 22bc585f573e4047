# SPDX-License-Identifier: Apache-2.0
"""Bad input of the methods in space, through the program: an error or a refusal that says where."""
import os
import pathlib
import re
import shutil
import unittest

from nightly import NightTest

SAMPLES = pathlib.Path(os.environ["NONIO_SAMPLES"])
GANTRY, TABLE, STEPS = "13-gantry-diagonals", "14-rotary-table", "15-step-diagonal"


def edited(path, change):
    path.write_text(change(path.read_text("utf-8")), "utf-8")


def lines(change):
    """A change of the list of lines, of which the first is line 1."""
    def of(text):
        rows = text.split("\n")
        change(rows)
        return "\n".join(rows)
    return of


def without(pattern):
    return lines(lambda rows: rows.__setitem__(slice(None), [r for r in rows if not re.match(pattern, r)]))


def replaced(old, new):
    def of(text):
        assert old in text, old
        return text.replace(old, new, 1)
    return of


def measurement_dropped(name):
    return lambda text: re.sub(r'\[\[measurement\]\]\nid = "%s"\n(?:.+\n)+' % name, "", text)


class Space(NightTest):
    def changed(self, sample, name, *changes):
        """A sample with its files changed; its campaign is called `name`."""
        folder = self.site / name
        shutil.copytree(SAMPLES / sample, folder)
        edited(folder / "campaign.toml", replaced(f'id = "{sample}"', f'id = "{name}"'))
        for file, change in changes:
            edited(folder / file, change)

    def evaluation(self, name, plugin, measurement):
        return next(a for a in self.results(name)["analyses"]
                    if (a["plugin"], a["measurement"]) == (plugin, measurement))

    def expect_refused(self, name, plugin, measurement, finding, *places):
        """The analysis has the finding, with these words in its evidence, and no curve."""
        a = self.evaluation(name, plugin, measurement)
        ids = [f["id"] for f in a["findings"]]
        self.assertIn(finding, ids, name)
        evidence = str(next(f for f in a["findings"] if f["id"] == finding)["evidence"])
        for place in places:
            self.assertIn(place, evidence, name)
        self.assertNotIn("series", a, name)
        self.assertEqual(set(a.get("values", {})) - {"S_n", "S_odd"}, set(), name)

    def expect_error(self, name, file, line, *says):
        error = self.results(name)["errors"][0]
        self.assertEqual((error["file"], error.get("line")), (file, line), error)
        for word in says:
            self.assertIn(word, error["message"])

    def test_diagonals(self):
        d1, d2 = "d1-00.csv", "d2-00.csv"
        self.changed(GANTRY, "unequal", (d1, lambda t: t.replace(",1500.000,", ",1600.000,")))
        self.changed(GANTRY, "not-read", (d2, without(r"\d,.,1500\.000,")))
        self.changed(GANTRY, "missing", ("campaign.toml", measurement_dropped("D2 00")))
        self.changed(GANTRY, "twice", ("campaign.toml", replaced('id = "D3 00"\nfile = "d3-00.csv"\nkind = "diagonal"\nfrom = { X = 0, Y = 0 }\nto = { X = 12000, Y = 4500 }', 'id = "D1b 00"\nfile = "d1-00.csv"\nkind = "diagonal"\nfrom = { X = 0, Y = 0 }\nto = { X = 12000, Y = 9000 }')))
        self.changed(GANTRY, "one-id", ("campaign.toml", replaced('id = "D1 final"', 'id = "D1 00"')))
        self.changed(GANTRY, "arcsec", (d1, replaced("deviation_um", "deviation_arcsec")))
        self.changed(GANTRY, "metres", (d1, lambda t: re.sub(r",(\d+)\.000,", lambda m: ",%.4f," % (float(m[1]) / 1000), t)))
        self.changed(GANTRY, "beyond", (d1, lambda t: t.replace(",15000.000,", ",15500.000,", 1)))
        self.changed(GANTRY, "other-targets", ("y.csv", lambda t: t.replace(",4500.000,", ",4512.000,")))
        self.changed(GANTRY, "one-x", ("campaign.toml", measurement_dropped("X2")))
        self.run_nonio(expect=1)
        refused = lambda name, *rest: self.expect_refused(name, "diagonal-straightness", "D1 00", *rest)
        refused("unequal", "diagonals.refused-stops", "d1-00.csv:6")
        refused("not-read", "diagonals.refused-stops", "31 / 30")
        refused("missing", "diagonals.refused-missing-diagonal", "D1 00")
        refused("twice", "diagonals.refused-sets", "D1 00, D1b 00")
        refused("metres", "diagonals.refused-stops", "d1-00.csv:")
        refused("other-targets", "diagonals.refused-pitch-points", "Y")
        refused("one-x", "diagonals.yaw-needed", "X1")
        text = (self.site / "one-id" / "campaign.toml").read_text("utf-8")
        second = [i + 1 for i, row in enumerate(text.split("\n")) if row.startswith("[[measurement]]")][6]
        self.expect_error("one-id", "campaign.toml", second + 1, "D1 00", "twice")  # its id
        self.expect_error("arcsec", d1, 2, "wrong unit", "deviation_um")
        self.expect_error("beyond", d1, 33, "15500.000")

    def test_yaw(self):
        yaw = ('[[measurement]]\nid = "yaw"\nkind = "angle"\naxis = "X"\nabout = "Z"\nfile = "yaw.csv"\n\n[run]')
        for name, header in (("good", "deviation_arcsec"), ("um", "deviation_um"), ("position", "position_deg")):
            self.changed(GANTRY, name, ("campaign.toml", measurement_dropped("X2")),
                         ("campaign.toml", replaced("[run]", yaw)))
            rows = [f"run,direction,target_mm,{header}"]
            rows += [f"{run},{d},{400 * i},{0.01 * i:.3f}" for run in (1, 2) for d in "+-" for i in range(31)]
            (self.site / name / "yaw.csv").write_text("\n".join(rows) + "\n", "utf-8")
        self.changed(GANTRY, "about", ("campaign.toml", replaced("[run]", yaw.replace('about = "Z"\n', ""))))
        self.run_nonio(expect=1)
        ecx = self.evaluation("good", "diagonal-straightness", "D1 00")["series"]["ECX"]
        self.assertAlmostEqual(ecx["value"][30], 0.3 * 4.84813681, 6)  # urad
        self.expect_error("um", "yaw.csv", 1, "wrong unit", "deviation_arcsec")
        self.expect_error("position", "yaw.csv", 1, "does not contain its angle")
        self.assertEqual(self.results("about")["errors"][0]["file"], "campaign.toml")
        self.assertIn("about", self.results("about")["errors"][0]["message"])

    def test_step_diagonals(self):
        file = "sd-00.csv"
        numbered = (SAMPLES / STEPS / file).read_text("utf-8").split("\n")
        line = lambda start: next(i + 1 for i, row in enumerate(numbered) if row.startswith(start))
        self.changed(STEPS, "unequal", (file, without(r"NPP,1(18|19|20),")))
        self.changed(STEPS, "missing", (file, without(r"PNP,")))
        self.changed(STEPS, "order", (file, lambda t: re.sub(r"(?m)^(PPN,\d+),([XY])", lambda m: m[1] + "," + "XY"["YX".index(m[2])], t)))
        self.changed(STEPS, "broken-order", (file, replaced("PNP,4,X", "PNP,4,Y")), (file, replaced("PNP,5,Y", "PNP,5,X")))
        self.changed(STEPS, "mm", (file, replaced("deviation_um", "deviation_mm")))
        self.changed(STEPS, "twice", (file, lambda t: t + "PPP,7,X,99.0\n"))
        self.changed(STEPS, "gap", (file, without(r"PPP,17,")))
        self.run_nonio(expect=1)
        refused = lambda name, *rest: self.expect_refused(name, "step-diagonal", "SD 00", *rest)
        refused("unequal", "step-diagonal.unequal-steps", f"{file}:{line('NPP,1,')}")
        refused("missing", "step-diagonal.too-few-diagonals", "PNP")
        refused("order", "step-diagonal.order-differs", f"{file}:{line('PPN,1,')}")
        refused("broken-order", "step-diagonal.order-broken", f"{file}:{line('PNP,4,')}")
        self.expect_error("mm", file, 2, "unknown column", "deviation_um")
        self.expect_error("twice", file, len(numbered), "step 7", str(line("PPP,7,")))
        self.expect_error("gap", file, line("PPP,17,"), "expected step 17")

    def test_ball_centres(self):
        self.changed(TABLE, "inch", ("c.csv", replaced("x_mm", "x_in")))
        self.changed(TABLE, "letters", ("c.csv", replaced("45,596.8527", "45,596,8527")))
        self.changed(TABLE, "repeated", ("c.csv", replaced("45,596", "0,596")))
        self.changed(TABLE, "linear", ("campaign.toml", replaced('[machine.axes.C]\nkind = "rotary"\ntravel = [0.0, 360.0]\nactive_table = "none"\nactive_backlash_deg = "none"', '[machine.axes.C]\nkind = "linear"')))
        self.changed(TABLE, "two", ("c.csv", lines(lambda rows: rows.__delitem__(slice(4, None)))))
        self.run_nonio(expect=1)
        self.expect_error("inch", "c.csv", 2, "unknown column", "x_mm")
        self.expect_error("letters", "c.csv", 4, "decimal comma")
        self.assertIn("rotary axis", self.results("linear")["errors"][0]["message"])
        self.expect_refused("repeated", "rotary-kinematics", "C", "rotary.repeated-angles")
        self.expect_refused("two", "rotary-kinematics", "C", "rotary.too-few")


if __name__ == "__main__":
    unittest.main()
