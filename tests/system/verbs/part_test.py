# SPDX-License-Identifier: Apache-2.0
"""A part as a measurement: holes of a plate that the machine made name its errors."""
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "bench"))
import plates

NONIO = os.environ["NONIO"]
SEED = int(os.environ.get("NONIO_SEED") or random.SystemRandom().randrange(10 ** 6))


class Part(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        print(f"seed {SEED} (NONIO_SEED)", file=sys.stderr)

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-part-")
        self.addCleanup(folder.cleanup)
        self.top = pathlib.Path(folder.name)
        self.rng = random.Random(SEED)

    def campaign(self, name, story, size=4.0, holes=100, parts=(("P1", 0), ("P2", 90)), known=False, temperature=0.0, turn=0.0):
        folder = self.top / name
        folder.mkdir(parents=True)
        holes = plates.grid(holes) if isinstance(holes, int) else holes
        for part, turned in parts:
            plates.plate(folder / f"{part}.csv", holes, plates.errors(story, size), 1.0,
                         math.radians(turned), self.rng, temperature, turn)
        plates.write(folder, parts, known=known)
        return folder

    def explain(self, folder):
        return plates.explain(NONIO, folder)

    def test_squareness_of_the_machine(self):
        answer = self.explain(self.campaign("a", "squareness:XY"))
        self.assertEqual(answer["verdict"]["kind"], "missing")
        self.assertEqual(answer["together"], ["squareness:XY"])
        times = {"zero-drift", "warm-up", "growth-drift", "run-jump"}  # the order of the rows is that of the measuring machine
        self.assertFalse(times & {c["effect"].split(":")[0] for c in answer["candidates"]})
        candidate = next(c for c in answer["candidates"] if c["effect"] == "squareness:XY")
        c, = candidate["parameters"]
        truth = 4.0 * math.sqrt(12) / plates.SIZE * 1e3  # urad: -size sqrt(12) y / SIZE is -c y
        self.assertLess(abs(c["value"] - truth), 4 * c["u"])

    def yaw(self, name, parts):
        """Plates of a machine whose X carriage turns by 0.7 urad/mm, and whose guide bends with it."""
        def error(x, y):
            return -0.7e-3 * x * y, 0.35e-3 * x * x
        folder = self.top / name
        folder.mkdir()
        for part, turned in parts:
            plates.plate(folder / f"{part}.csv", plates.grid(49), error, 0.5, math.radians(turned), self.rng)
        plates.write(folder, parts)
        manifest = folder / "campaign.toml"
        manifest.write_text(manifest.read_text().replace("[machine]", '[machine]\nstructure = "single-column"'))
        return folder

    def test_yaw_is_named_on_one_plate_and_on_turned_plates(self):
        for name, parts in (("one", [("P1", 0)]), ("two", [("P1", 0), ("P2", 90)])):
            folder = self.yaw(name, parts)
            self.assertIn("yaw:X", self.explain(folder)["together"], name)
            subprocess.run([NONIO, "model", "explain", folder, "--auto", "--quiet"], capture_output=True, check=True)
            done = subprocess.run([NONIO, "model", "compare", folder, "--json"], capture_output=True, text=True, check=True)
            part, = json.loads(done.stdout)["parts"]
            self.assertLess(part["rms_um"], 0.65, name)  # noise 0.5 um; 4 standard deviations of the RMS of 98 readings

    def test_without_repeats_nothing_found_is_not_complete(self):
        text = subprocess.run([NONIO, "model", "explain", self.campaign("a", "none", parts=[("P1", 0)])],
                              capture_output=True, text=True, check=True).stdout
        self.assertNotIn("complete (nothing missing)", text)

    def test_a_plate_without_errors_is_complete(self):
        rng = self.rng
        self.rng = random.Random(11)
        answer = self.explain(self.campaign("a", "none"))
        self.rng = rng
        self.assertEqual((answer["verdict"]["kind"], answer.get("together", [])), ("nothing", []))

    def test_place_turn_and_temperature_of_a_plate_are_no_errors(self):
        self.rng = random.Random(12)
        answer = self.explain(self.campaign("a", "none", temperature=7.0))
        self.assertEqual(answer["verdict"]["kind"], "nothing")
        # With temperatures that are stated, and wrong, the size is one of the axes.
        answer = self.explain(self.campaign("b", "none", known=True, temperature=7.0))
        self.assertTrue({"scale:X", "scale:Y"} <= set(answer["together"]), answer["together"])

    def test_a_frame_that_is_turned_is_no_scale(self):
        """Half the square of 9 mrad is 40 um/m: eight times the U of a scale."""
        self.rng = random.Random(13)
        for k, parts in enumerate(((("P1", 0),), (("P1", 0), ("P2", 90)))):
            answer = self.explain(self.campaign(str(k), "none", parts=parts, known=True, turn=9e-3))
            self.assertNotEqual(answer["verdict"]["kind"], "missing", answer["verdict"])
        answer = self.explain(self.campaign("bowed", "straightness:EYX", turn=-9e-3))
        self.assertEqual(answer["together"], ["straightness:EYX"])

    def test_four_columns_show_a_bow(self):
        for columns in (4, 5):
            holes = [(round(plates.SIZE * (i / (columns - 1) - 0.5), 3), 50.0 * k - 200.0) for i in range(columns) for k in range(9)]
            answer = self.explain(self.campaign(str(columns), "straightness:EYX", holes=holes, parts=(("P1", 0),)))
            self.assertIn("straightness:EYX", answer["together"])

    def test_how_a_part_lay_is_not_followed_over_the_years(self):
        self.campaign("site/a", "none")
        with open(self.top / "site/a/campaign.toml", "a", encoding="utf-8") as text:
            text.write('[run]\nanalyses = ["model-fit"]\n')
        subprocess.run([NONIO, "run", self.top / "site", "--out", self.top / "out"], capture_output=True, check=True)
        results = (self.top / "out/a/results.json").read_text()
        self.assertIn("body-turn:P1 Z", results)
        self.assertFalse([q for q in json.loads(results).get("followed", []) if "body-" in q["quantity"]])

    def test_an_export_with_names_of_features(self):
        folder = self.campaign("a", "squareness:XY")
        plain = self.explain(folder)
        rows = (folder / "P1.csv").read_text().splitlines()
        rows[0] = "Merkmal," + rows[0].replace("nominal_x_mm", "Soll X")
        (folder / "P1.csv").write_text("\n".join([rows[0]] + [f"H{k},{row}" for k, row in enumerate(rows[1:])]) + "\n")
        done = subprocess.run([NONIO, "model", "explain", folder], capture_output=True, text=True, check=False)
        self.assertIn('P1.csv:1: unknown column "Merkmal"', done.stderr)
        self.assertIn('option columns: "Merkmal = ignore"', done.stderr)
        with open(folder / "campaign.toml", "a", encoding="utf-8") as text:
            text.write('[options.csv]\ncolumns = ["Merkmal = ignore", "Soll X = nominal_x_mm"]\n')
        self.assertEqual(self.explain(folder)["verdict"], plain["verdict"])

    def test_an_error_of_the_plate_turns_with_it(self):
        """What is in both plates at the same holes, however they lay, is no effect of the machine."""
        folder = self.campaign("a", "straightness:EYX", parts=(("P1", 0), ("P2", 0)))
        self.assertEqual(self.explain(folder)["together"], ["straightness:EYX"])
        plates.write(folder, [("P1", 0), ("P2", 90)])  # the same files, said to lie across each other
        answer = self.explain(folder)
        self.assertEqual(answer["together"], ["part-straightness:EYX"])

    def test_one_plate_has_a_plan_that_separates_machine_and_fixture(self):
        for story, plans in (("squareness:XY", [("turned-part", None)]),
                             ("pitch-curve:Y", [("turned-part", None), ("moved-part", "Y")]),
                             ("straightness:EYX", [("turned-part", None), ("moved-part", "X")])):
            with self.subTest(story):
                folder = self.campaign(story.split(":")[0], story, parts=[("P1", 0)])
                answer = self.explain(folder)
                self.assertEqual([(p["plan"], p.get("of")) for p in answer["plans"]], plans)
                for plan in answer["plans"]:
                    self.assertEqual(plan["separates"], [story, f"part-{story}"])
                    self.assertEqual(plan["readings"], 200)
                    self.assertEqual(plan["duration_s"], 1800 + 100 * 60)
                    self.assertGreater(plan["power"], 4.0)
                self.assertIn("turned by 90 deg about its middle (200 readings, 130 min)", answer["next"][0])

    def test_parts_of_several_campaigns_of_one_machine_are_explained_together(self):
        one, two = (self.campaign(name, "straightness:EYX", size=1.0, parts=[(part, turned)])
                    for name, part, turned in (("a", "P1", 0), ("b", "P2", 90)))
        done = subprocess.run([NONIO, "model", "explain", one, two, "--json", "--quiet"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        answer = json.loads(done.stdout)
        verdict, = answer["alone_verdicts"]
        self.assertEqual((verdict["part"], verdict["effect"]), ("a, b XY", "straightness:EYX"))
        self.assertEqual(verdict["together"], ["straightness:EYX"])
        self.assertFalse([plan for plan in answer["next"] if plan["plan"] == "turned-part"])  # it was turned

    def test_parts_of_a_machine_that_changed_between_two_campaigns_are_not_joined(self):
        one, two = (self.campaign(name, story, parts=[(part, 0)])
                    for name, story, part in (("a", "squareness:XY", "P1"), ("b", "none", "P2")))
        done = subprocess.run([NONIO, "model", "explain", one, two, "--json", "--quiet"], capture_output=True, text=True, check=False)
        answer = json.loads(done.stdout)
        self.assertEqual(answer["parts_differ"], ["a, b"])
        self.assertEqual([(v["part"], v.get("effect")) for v in answer["alone_verdicts"]], [("a XY", "squareness:XY"), ("b XY", None)])

    def test_a_stretch_of_the_parts_turns_with_them(self):
        """A measuring machine whose X scale is wrong by 20 um/m: not of the machine that made the plates."""
        folder = self.top / "stretch"
        folder.mkdir()
        for part, turned in (("P1", 0), ("P2", 90)):
            angle = math.radians(turned)

            def error(x, y):
                along = 20e-3 * (x * math.cos(angle) + y * math.sin(angle))  # um, in the direction of the part's X
                return along * math.cos(angle), along * math.sin(angle)
            plates.plate(folder / f"{part}.csv", plates.grid(100), error, 1.0, angle, self.rng, 0.0)
        plates.write(folder, (("P1", 0), ("P2", 90)), known=True)
        self.assertEqual(self.explain(folder)["together"], ["part-scale:X"])

    def test_the_temperatures_of_a_plate_separate_two_scales(self):
        """An X scale that is wrong by 20 um/m, or a part that shrank and a wrong Y scale."""
        folder = self.top / "size"
        folder.mkdir()
        plates.plate(folder / "P1.csv", plates.grid(100), lambda x, y: (20e-3 * x, 0.0), 1.0, 0.0, self.rng, 0.0)
        plates.write(folder, [("P1", 0)])
        answer = self.explain(folder)
        plan = answer["plans"][0]
        self.assertEqual((plan["plan"], plan["readings"], sorted(plan["separates"])), ("known-size", 0, ["scale:X", "scale:Y"]))
        self.assertIn("Stating the temperatures of the parts", answer["next"][0])
        plates.write(folder, [("P1", 0)], known=True)
        answer = self.explain(folder)
        self.assertEqual(answer["verdict"]["effect"], "scale:X")
        self.assertNotIn("scale:Y", next(c for c in answer["candidates"] if c["effect"] == "scale:X")["aliases"])
        # The squared distance of the explanations, which differ by half of the scale in each coordinate.
        self.assertGreater(plan["power"], 4.0)

    def test_the_plan_does_what_it_predicts(self):
        """With the plate that was planned, the same error of the fixture instead is named as such."""
        size = 1.0
        folder = self.campaign("one", "straightness:EYX", size=size, parts=[("P1", 0)])
        plan = self.explain(folder)["plans"][0]
        # RMS of the part of two plates that the wrong hypothesis does not explain, from its own fit of noiseless plates.
        self.assertEqual(plan["plan"], "turned-part")
        two = self.campaign("two", "straightness:EYX", size=size)
        answer = self.explain(two)
        self.assertEqual(answer["together"], ["straightness:EYX"])
        candidate = next(c for c in answer["candidates"] if c["effect"] == "straightness:EYX")
        self.assertNotIn("part-straightness:EYX", candidate["aliases"])
        # Evidence is about the squared distance of the explanations, less the price of the curve.
        self.assertAlmostEqual(plan["power"], size * math.sqrt(200), delta=0.35 * size * math.sqrt(200))

    def test_the_page_shows_the_residuals_over_the_order_of_machining(self):
        folders = [self.campaign(name, "none", parts=[("P1", 0), ("P2", 90)]) for name in ("a", "b")]
        before = self.explain(folders[0])
        manifest = folders[0] / "campaign.toml"
        manifest.write_text(manifest.read_text().replace('file = "P1.csv"', 'file = "P1.csv"\norder = "as-listed"'))
        page = self.top / "page.html"
        command = [NONIO, "model", "explain", *map(str, folders), "--page", str(page), "--quiet"]
        subprocess.run(command, check=True, capture_output=True)
        text = page.read_text()
        of_both, = text.split("<h2>")[1:]  # one machine made them
        self.assertIn('data-x="Number of the coordinate in the order of machining"', of_both)
        self.assertIn("No order of machining is stated for a/P2, b/P1, b/P2: write", of_both)
        # The order is no time: it changes nothing of the explanation.
        self.assertEqual(self.explain(folders[0]), before)

    def test_no_room_for_another_place(self):
        folder = self.campaign("a", "pitch-curve:Y", parts=[("P1", 0)])
        manifest = folder / "campaign.toml"
        manifest.write_text(manifest.read_text().replace("travel = [-500.0, 500.0]", "travel = [-260.0, 260.0]"))
        self.assertEqual([p["plan"] for p in self.explain(folder)["plans"]], ["turned-part"])

    def test_fixture_and_machine_are_separated_by_turned_plates(self):
        def bent(x, y):
            return -30e-3 * y, 4.0 * (2.0 * x / plates.SIZE) ** 2
        folder = self.top / "a"
        folder.mkdir()
        for part, turned in (("P1", 0), ("P2", 90)):
            plates.plate(folder / f"{part}.csv", plates.grid(100), bent, 0.5, math.radians(turned), self.rng)
            rows = (folder / f"{part}.csv").read_text().splitlines()
            for k, row in enumerate(rows[1:], 1):
                x, y, mx, my = map(float, row.split(","))
                rows[k] = f"{x:.3f},{y:.3f},{mx:.6f},{my + 3e-3 * (2.0 * x / plates.SIZE) ** 2:.6f}"  # in the frame of the plate
            (folder / f"{part}.csv").write_text("\n".join(rows) + "\n")
        plates.write(folder, (("P1", 0), ("P2", 90)))
        answer = self.explain(folder)
        self.assertLessEqual({"squareness:XY", "straightness:EYX", "part-straightness:EYX"}, set(answer["together"]),
                             answer["verdict"])
        self.assertLessEqual(len(answer["together"]), 4)
        # The model without them is wrong at the edges of the plates; no reading is suspect for that, and rows have no order in time.
        self.assertEqual(answer["suspects"], [])
        said = json.dumps(answer)
        self.assertNotIn("random walk", said)
        self.assertNotIn("Add times", said)

    def test_a_wrong_feature_is_named_by_its_place(self):
        folder = self.campaign("a", "squareness:XY", size=2.0)
        rows = (folder / "P1.csv").read_text().splitlines()
        x, y, mx, my = map(float, rows[38].split(","))
        # Away from the shift of the plate: an error that hides it is not found yet.
        rows[38] = f"{x:.3f},{y:.3f},{mx + math.copysign(0.06, mx - x):.6f},{my:.6f}"
        (folder / "P1.csv").write_text("\n".join(rows) + "\n")
        answer = self.explain(folder)
        self.assertEqual(answer["together"], ["squareness:XY"])
        self.assertLessEqual(len(answer["suspects"]), 3)
        suspect = next(x for x in answer["suspects"] if x["line"] == 39)
        self.assertNotIn("direction", suspect)
        self.assertIn("line 39: the feature at", suspect["says"])

    def test_an_unseen_plate_is_predicted(self):
        seen = self.campaign("seen", "pitch-curve:Y")
        other = self.campaign("other", "pitch-curve:Y")
        plates.write(seen, [("P1", 0), ("P2", 90)], self.explain(seen)["together"])
        done = subprocess.run([NONIO, "model", "compare", other, "--model-of", seen, "--json"], capture_output=True, text=True, check=True)
        part, = json.loads(done.stdout)["parts"]
        self.assertLess(part["rms_um"], 1.2)
        self.assertGreater(part["sd_um"], 2.0)
        self.assertGreater(part["inside_U"], 0.9)
        text = subprocess.run([NONIO, "model", "compare", other, "--model-of", seen], capture_output=True, text=True, check=True).stdout
        self.assertIn("are reduced to", text)
        none = self.campaign("none", "none")
        text = subprocess.run([NONIO, "model", "compare", none, "--model-of", seen], capture_output=True, text=True, check=True).stdout
        self.assertIn("the model does not help with readings that it has not seen", text)

    def test_what_a_curve_does_not_reach_is_not_predicted(self):
        self.rng = random.Random(14)
        seen = self.campaign("seen", "straightness:EYX", known=True, parts=(("P1", 0),))
        plates.write(seen, (("P1", 0),), model=["straightness:EYX"], known=True)
        inside = plates.grid(100)
        larger = inside + [(x + plates.SIZE, y) for x, y in inside if x > 1.0 - plates.SIZE / 2]
        unseen = self.campaign("unseen", "straightness:EYX", known=True, holes=larger, parts=(("P1", 0),))
        done = subprocess.run([NONIO, "model", "compare", unseen, "--model-of", seen, "--json"], capture_output=True, text=True, check=True)
        part, = json.loads(done.stdout)["parts"]
        self.assertEqual(part["left_out"], 2 * (len(larger) - len(inside)))
        self.assertGreater(part["inside_U"], 0.9)
        self.assertIn(f"{part['left_out']}, not counted", part["says"])
        other_place = self.campaign("other-place", "straightness:EYX", known=True, holes=[(x + 2 * plates.SIZE, y) for x, y in inside], parts=(("P1", 0),))
        done = subprocess.run([NONIO, "model", "compare", other_place, "--model-of", seen], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("all 200 readings are outside the places that the model was fitted to", done.stderr)

    def test_mistakes(self):
        folder = self.campaign("a", "none")
        manifest = folder / "campaign.toml"
        text = manifest.read_text()
        for change, wanted in ((("turned_deg = 90", "turned_deg = 30\ntemperatures_c = [20.0]"), "expected two temperatures"),
                               (("turned_deg = 90", "turnd_deg = 90"), 'nearest: "turned_deg"')):
            manifest.write_text(text.replace(*change))
            done = subprocess.run([NONIO, "model", "explain", folder], capture_output=True, text=True, check=False)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(wanted, done.stderr)
        manifest.write_text(text)
        rows = (folder / "P1.csv").read_text().splitlines()
        rows[4] = rows[4].replace(rows[4].split(",")[2], "999.0")
        (folder / "P1.csv").write_text("\n".join(rows) + "\n")
        done = subprocess.run([NONIO, "model", "explain", folder], capture_output=True, text=True, check=False)
        self.assertIn("P1.csv:5: measured_x: expected a place within 10 mm of the nominal one", done.stderr)


if __name__ == "__main__":
    unittest.main()
