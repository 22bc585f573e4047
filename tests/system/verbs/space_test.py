# SPDX-License-Identifier: Apache-2.0
"""compare, explain, model on machines with several axes: the samples' stories, what is refused."""
import json
import math
import pathlib
import random
import re
import shutil
import unittest

from verbs import VerbTest

SAMPLES = pathlib.Path(__file__).resolve().parents[3] / "samples" / "site"


class Space(VerbTest):
    def sample(self, name):
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(SAMPLES / name, self.folder)

    def edit(self, old, new):
        path = self.folder / "campaign.toml"
        text = path.read_text()
        self.assertIn(old, text)
        path.write_text(text.replace(old, new))

    def part(self, verb, *args, **keys):
        done = self.json_of(verb, self.folder, *args, **keys)
        return done["parts"][0] if "parts" in done else done

    def results(self, folder):
        """What the analysis model-fit found."""
        out = folder.parent / "out"
        shutil.rmtree(out, ignore_errors=True)
        self.nonio("run", folder.parent, "--out", out, expect=0)
        path, = out.glob("*/results.json")
        return next(a for a in json.loads(path.read_text())["analyses"] if a["plugin"] == "model-fit")

    def test_the_diagonals_show_more_than_squareness(self):
        self.sample("17-straight-or-square")
        compared = self.part("compare")
        self.assertEqual(compared["axis"], "XY")
        self.assertEqual(compared["measurements"], ["X1", "X2", "Y", "D1", "D2"])
        self.assertGreater(compared["rms_um"], 3 * compared["noise_floor_um"])
        failing = {place["line"]: place for place in compared["fails"] if place["where"] == "position"}
        self.assertTrue({"D1", "D2"} <= set(failing))

    def test_straightness_of_both_axes_is_found_and_the_error_falls_to_the_floor(self):
        self.sample("17-straight-or-square")
        said = self.json_of("explain", self.folder, "--auto")
        self.assertEqual({step["effect"] for step in said["steps"]}, {"straightness:EYX", "straightness:EXY"})
        self.assertEqual(said["verdict"]["kind"], "nothing")
        self.assertLess(abs(said["model"]["rms_um"] / said["noise_floor_um"] - 1), 0.1)
        square = next(p for p in said["model"]["parameters"] if p["effect"] == "squareness:XY")
        self.assertEqual(square["unit"], "urad")
        self.assertLess(abs(square["value"] - 12.0), 0.5)  # slopes of both curves belong to it
        # Odd parts of both on two diagonals: what is not in the data is not claimed.
        self.assertTrue(any("cannot separate" in w and "straightness" in w for w in said["warnings"]))

    def test_the_pitch_of_the_axis_that_moves_is_not_called_unstated(self):
        """A straightness has the phase of the one screw that turns; diagonals have none, and are not told to state one."""
        def pages(sample, effects):
            self.sample(sample)
            path = self.folder / "campaign.toml"
            text = re.sub(r"\n\[(model|run)\]\n([^\[\n][^\n]*\n)*", "\n", path.read_text())
            path.write_text(text + f'\n[model]\neffects = {json.dumps(effects)}\n[run]\nanalyses = ["model-fit"]\n'
                            'outputs = ["model-html"]\n')
            out = self.site.parent / "out"
            self.nonio("run", self.site, "--out", out, "--force", expect=None)
            return {p.name: p.read_text("utf-8") for p in (out / sample).glob("*.html")}

        straight = next(t for n, t in pages("12-straightness", ["straightness:EYX"]).items() if "EYX" in n)
        self.assertEqual(float(re.search(r'"period":\s*([\d.]+)', straight)[1]), 10.0)
        for text in pages("17-straight-or-square", ["squareness:XY"]).values():
            self.assertNotIn("Screw pitch not stated", text)
            self.assertIn("Several axes move: no phase of a single screw.", text)

    def test_on_one_column_it_is_yaw(self):
        self.sample("18-one-column")
        said = self.json_of("explain", self.folder)
        self.assertEqual((said["verdict"]["kind"], said["verdict"]["effect"]), ("missing", "yaw:X"))
        said = self.json_of("explain", self.folder, "--auto")
        self.assertEqual([step["effect"] for step in said["steps"]], ["yaw:X"])
        self.assertEqual(said["verdict"]["kind"], "nothing")

    def test_with_x_in_the_middle_only_yaw_and_straightness_are_one_alias_group(self):
        self.sample("18-one-column")
        one, two = ((self.folder / f"x{k}.csv").read_text().splitlines() for k in (1, 2))
        middle = []
        for a, b in zip(one, two):
            head, x = a.rpartition(",")[::2]
            mean = (float(x) + float(b.rpartition(",")[2])) / 2 if head[:1].isdigit() else None
            middle.append(a if mean is None else f"{head},{mean:.4f}")
        (self.folder / "x1.csv").write_text("\n".join(middle) + "\n")
        self.edit("at = { Y = 0 }", "at = { Y = 1500 }")
        text = (self.folder / "campaign.toml").read_text()
        begin = text.index('[[measurement]]\nid = "X2"')
        (self.folder / "campaign.toml").write_text(text[:begin] + text[text.index("[[measurement]]", begin + 1):])
        said = self.json_of("explain", self.folder)
        self.assertEqual(said["verdict"]["kind"], "missing")
        first = said["candidates"][0]
        self.assertTrue({"yaw:X", "straightness:EYX"} <= {first["effect"], *first["aliases"]}, first)
        answers = self.results(self.folder)
        finding, = (f for f in answers["findings"] if f["id"] == "model.missing-or-alias")
        self.assertEqual({finding["evidence"]["effect"], *finding["evidence"]["aliases"].split(", ")}, {first["effect"], *first["aliases"]})
        self.assertTrue(said["plans"])
        best = said["plans"][0]
        self.assertGreaterEqual(best["power"], 4.0)
        self.assertIn(best["plan"], {"straightness-line", "other-line", "half-diagonal"})
        self.assertTrue(best["says"])
        # The alias remains where the model is complete, and the straightness line is advised only
        # for what it senses.
        said = self.json_of("explain", self.folder, "--auto")
        self.assertEqual(said["verdict"]["kind"], "nothing")
        kept = {r["effect"]: set(r["by"]) for r in said["replaceable"]}
        self.assertTrue(any({"yaw:X", "straightness:EYX"} <= {effect, *by} for effect, by in kept.items()), kept)
        self.assertIn(said["replaceable"][0]["effect"], said["verdict"]["says"])
        self.assertNotIn("straightness:EYX (", said.get("no_sign", ""))

    def volume(self, extra=()):
        """Lines of X, Y, Z and four body diagonals of a machine with two squarenesses and one scale, and lines of `extra`."""
        size, at = {"X": 800, "Y": 600, "Z": 500}, {"X": "Y = 300, Z = 250", "Y": "X = 400, Z = 250", "Z": "X = 400, Y = 300"}
        place = "{{ X = {}, Y = {}, Z = {} }}".format
        lines = [("PPP", (0, 0, 0), (800, 600, 500)), ("NPP", (800, 0, 0), (0, 600, 500)), ("PNP", (0, 600, 0), (800, 0, 500)),
                 ("PPN", (0, 0, 500), (800, 600, 0)), *extra]
        text = 'format = 1\n[campaign]\nid = "v"\n[machine]\nmodel = "M"\nserial = "S"\nstructure = "bridge"\n'
        text += "".join(f'[machine.axes.{a}]\nkind = "linear"\ntravel = [0.0, {size[a]}.0]\n' for a in size)
        text += "".join(f'[[measurement]]\nid = "{a}"\nkind = "axis"\naxis = "{a}"\nat = {{ {at[a]} }}\nfile = "{a}.csv"\n' for a in size)
        text += "".join(f'[[measurement]]\nid = "{n}"\nkind = "diagonal"\nfrom = {place(*a)}\nto = {place(*b)}\nfile = "{n}.csv"\n'
                        for n, a, b in lines)
        text += "[simulation]\nseed = 5\n"
        text += "".join(f'[[cycle]]\nmeasurement = "{a}"\nfrom_mm = 0\nto_mm = {size[a]}\nstep_mm = {size[a] // 10}\nruns = 3\nnoise_um = 0.5\n'
                        for a in size)
        text += "".join(f'[[cycle]]\nmeasurement = "{n}"\nsteps = 12\nruns = 3\nnoise_um = 0.5\n' for n, _, _ in lines)
        for name, value in (("squareness:XZ", "c_urad = -28.0"), ("squareness:XY", "c_urad = -12.0"), ("scale:Z", "a_um_per_m = -18.0")):
            text += f'[[effect]]\nname = "{name}"\n{value}\n'
        truth = self.folder.parent / "truth.toml"
        truth.write_text(text)
        self.nonio("simulate", truth, "--out", self.folder)
        return self.part("explain")

    def test_the_advised_measurement_separates(self):
        said = self.volume()
        first = said["candidates"][0]
        self.assertEqual(("squareness:XZ", ["roll:X"]), (first["effect"], first["aliases"]))
        plan = said["plans"][0]
        self.assertGreaterEqual(plan["power"], 4.0)
        # A straightness line has a slope of its own and senses neither.
        self.assertEqual(("half-diagonal", "XY"), (plan["plan"], plan["of"]))
        shutil.rmtree(self.folder)
        first = self.volume([("H", (0, 0, 0), (800, 300, 0))])["candidates"][0]
        self.assertEqual(("squareness:XZ", []), (first["effect"], first["aliases"]))

    def test_what_shows_only_next_to_others_is_not_named_first(self):
        """The wave of the screw in circles: added alone it leaves the RMS as it is."""
        for name in ("40-circles", "41-circle-one-way"):
            with self.subTest(sample=name):
                self.sample(name)
                said = self.part("explain")
                before, first = said["model"]["rms_um"], said["candidates"][0]
                self.assertLess(first["rms_um"], 0.8 * before, first)
                wave, = (c for c in said["candidates"] if c["effect"] == "periodic:X")
                self.assertGreater(wave["rms_um"], 0.99 * before)
                if said["verdict"]["kind"] == "missing":
                    self.assertEqual(said["verdict"]["effect"], first["effect"])

    def circle(self, runs=(1, 2), ways=(1, -1), lateral_um=0.0, backlash_um=0.0):
        """Readings of a ball bar of 150 mm; scatter of 0.2 um, fixed seed."""
        self.sample("40-circles")
        drawn = random.Random(4)
        rows = ["run,direction,angle_deg,deviation_um"]
        for run in runs:
            for way in ways:
                for angle in range(2, 362, 4)[::way]:
                    t = math.radians(angle)
                    towards_x = math.copysign(1, -way * math.sin(t))  # X moves in this direction
                    value = (lateral_um * math.sin(t) + backlash_um * math.cos(t)) * towards_x / 2 + drawn.gauss(0, 0.2)
                    rows.append(f"{run},{'+' if way > 0 else '-'},{angle},{value:.3f}")
        (self.folder / "circle.csv").write_text("\n".join(rows) + "\n")

    def test_runs_of_a_circle_repeat_each_other(self):
        self.circle(backlash_um=6)
        said = self.part("explain")
        self.assertLess(abs(said["noise_floor_um"] - 0.2), 0.04)
        self.assertEqual(said["verdict"]["effect"], "backlash:X")

    def test_lateral_play_is_found_in_circles(self):
        self.circle(lateral_um=6)
        said = self.part("explain")
        self.assertEqual((said["verdict"]["kind"], said["verdict"]["effect"]), ("missing", "lateral-play:EYX"))
        value, = said["candidates"][0]["parameters"]
        self.assertLess(abs(value["value"] - 6), 0.2)

    def test_a_circle_is_not_told_to_be_read_at_other_targets(self):
        self.sample("41-circle-one-way")
        said = " ".join(self.part("explain")["next"])
        self.assertIn("in the other direction", said)
        self.assertNotIn("targets", said)

    def test_states_of_the_machine_are_not_mixed(self):
        self.sample("13-gantry-diagonals")
        parts = self.json_of("compare", self.folder)["parts"]
        self.assertEqual([part["axis"] for part in parts], ["XY 00", "XY final"])
        for part in parts:
            self.assertEqual(part["measurements"][:3], ["X1", "X2", "Y"])
        self.assertNotIn("D1 final", parts[0]["measurements"])

    def test_model_add_and_drop_in_space(self):
        self.sample("17-straight-or-square")
        before = (self.folder / "campaign.toml").read_bytes()
        change = self.json_of("model", "add", self.folder, "straightness:EYX")
        self.assertLess(change["after"]["rms_um"], change["before"]["rms_um"])
        self.nonio("model", "drop", self.folder, "straightness:EYX")
        self.assertEqual((self.folder / "campaign.toml").read_bytes(), before)
        for effect, words in (("straightness:QYX", "expected what the effect can be of"),
                              ("straightnes:EYX", 'nearest: "straightness:EYX"'),
                              ("line-slope:D1", "in every model"),
                              ("straightness:EZX", "no measurement of this campaign can show")):
            done = self.nonio("model", "add", self.folder, effect, expect=None)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(words, done.stderr + done.stdout)
            self.assertEqual((self.folder / "campaign.toml").read_bytes(), before)

    def test_what_is_left_in_space_has_its_place(self):
        self.sample("15-step-diagonal")  # nothing in the model: more is left than three effects say
        for part in self.json_of("explain", self.folder)["parts"]:
            self.assertIn(part["verdict"]["kind"], ("missing", "unknown", "unrepeatable"))
            self.assertTrue(part["fails"])
            self.assertTrue(all(place["says"] for place in part["fails"]))

    def test_ball_centres(self):
        self.sample("14-rotary-table")
        parts = {part["axis"]: part for part in self.json_of("compare", self.folder)["parts"]}
        self.assertEqual(set(parts), {"C", "B"})
        names = {(p["effect"], p["name"]) for p in parts["C"]["model"]["parameters"]}
        self.assertEqual(names, {("centre:C", "c1"), ("centre:C", "c2"), ("direction:C", "d1"), ("direction:C", "d2")})
        self.assertEqual(parts["C"]["model"]["effects"], [])

    def test_the_run_evaluates_the_model_in_space(self):
        self.sample("17-straight-or-square")
        fit = self.results(self.folder)
        self.assertIn("model.missing", [f["id"] for f in fit["findings"]])
        out = self.folder.parent / "out"
        self.assertTrue((out / "17-straight-or-square").glob("*.pdf"))


if __name__ == "__main__":
    unittest.main()
