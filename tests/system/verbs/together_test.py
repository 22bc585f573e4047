# SPDX-License-Identifier: Apache-2.0
"""`nonio model explain` of several campaigns together: effects below the noise of each, by which campaigns they have."""
import base64
import hashlib
import json
import math
import os
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "bench"))
import fleet
import plates

NONIO = os.environ["NONIO"]
SEED = int(os.environ.get("NONIO_SEED") or random.SystemRandom().randrange(10 ** 6))


def explain(*arguments, status=0):
    done = subprocess.run([NONIO, "model", "explain", *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == status, (done.returncode, done.stdout, done.stderr)
    return done


class Together(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        print(f"seed {SEED} (NONIO_SEED)", file=sys.stderr)

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-together-")
        self.addCleanup(folder.cleanup)
        self.site = pathlib.Path(folder.name) / "site"
        self.rng = random.Random(SEED)

    def answer(self, *arguments):
        return json.loads(explain(*(arguments or [self.site]), "--json", "--quiet").stdout)

    def reversals(self):
        """Mean over the campaigns of mean(+) - mean(-), um."""
        each = []
        for file in sorted(self.site.glob("*/x.csv")):
            rows = [line.split(",") for line in file.read_text().splitlines()[1:]]
            mean = {way: [float(r[3]) for r in rows if r[1] == way] for way in "+-"}
            each.append(sum(mean["+"]) / len(mean["+"]) - sum(mean["-"]) / len(mean["-"]))
        return each

    def test_a_drift_does_not_hide_what_is_constant_in_a_pass(self):
        """The drift looks like a zero of each pass, which takes the lost motion with it unless the drift is known."""
        head = ('format = 1\n[campaign]\nid = "{0}"\ncustomer = "C"\ndate = 2026-0{1}-15\n[machine]\nmaker = "M"\n'
                'model = "T"\nserial = "1"\n[machine.axes.X]\nkind = "linear"\n[[measurement]]\nid = "X"\nkind = "axis"\n'
                'axis = "X"\nfile = "x.csv"\n')
        for number in (1, 2):
            rows, t = ["time_s,run,direction,target_mm,deviation_um"], 0
            for run in range(1, 6):
                for way, targets in (("+", range(0, 801, 80)), ("-", range(800, -1, -80))):
                    for x in targets:
                        d = 5 * x / 1000 + 20 * t / 3600 - (1.5 if way == "-" else 0) + self.rng.gauss(0, 0.25)
                        rows.append(f"{t},{run},{way},{x},{d:.2f}")
                        t += 20
            folder = self.site / f"c{number}"
            folder.mkdir(parents=True)
            (folder / "campaign.toml").write_text(head.format(folder.name, number))
            (folder / "x.csv").write_text("\n".join(rows) + "\n")
        named = {e["effect"]: e for e in self.answer()["effects"]}
        self.assertIn("backlash:X", named)
        value = named["backlash:X"]["parameters"][0]
        self.assertLess(abs(value["value"] - 1.5), 4 * value["u"] + 0.05, value)

    def test_an_effect_of_half_the_noise_that_all_have(self):
        fleet.fleet(self.site, "shared", "backlash:X", 0.5, 12, 0.0, self.rng)
        answer = self.answer()
        effect, = answer["effects"]
        self.assertEqual((effect["effect"], effect["per_campaign"]), ("backlash:X", "shared"))
        self.assertEqual(answer["verdict"]["kind"], "missing")
        self.assertEqual((answer["verdict"]["same"], answer["verdict"]["differs"]), (["backlash:X"], []))
        self.assertEqual(answer["observations"], 12 * 210)
        self.assertEqual([c["campaign"] for c in answer["campaigns"]], [f"c{n:04d}" for n in range(12)])
        b, = effect["parameters"]
        mean = sum(self.reversals()) / 12  # of equal weight, up to the noise floor of each campaign
        self.assertLess(abs(b["value"] - mean), 1.5 * b["u"])
        self.assertLess(answer["rms_after_um"], answer["model"]["rms_um"])
        self.assertAlmostEqual(answer["rms_after_um"] / answer["noise_floor_um"], 1.0, delta=0.1)

    def test_one_campaign_alone_does_not_show_what_all_show(self):
        fleet.fleet(self.site, "shared", "periodic:X", 0.25, 24, 0.0, self.rng)
        alone = [json.loads(explain(c, "--json", "--quiet").stdout)["verdict"]["kind"] for c in sorted(self.site.iterdir())]
        self.assertLess(alone.count("missing"), 24)
        self.assertEqual([e["effect"] for e in self.answer()["effects"]], ["periodic:X"])

    def test_what_one_campaign_shows_is_not_denied(self):
        self.rng = random.Random(31)
        named = 0
        for n in range(4):
            site = self.site / str(n)
            fleet.fleet(site, "none", "backlash:X", 0.0, 12, 0.0, self.rng)
            path = site / "c0005" / "x.csv"
            head, *rows = path.read_text().splitlines()
            fields = [row.split(",") for row in rows]
            noise = statistics.stdev(float(f[3]) for f in fields)
            for f in fields:
                f[3] = f"{float(f[3]) + (-1 if f[1] == '+' else 1) * 0.5 * noise:.3f}"
            path.write_text("\n".join([head] + [",".join(f) for f in fields]) + "\n")
            verdict = self.answer(site)["verdict"]
            alone = json.loads(explain(site / "c0005", "--json", "--quiet").stdout)["verdict"]["kind"]
            self.assertFalse(verdict["kind"] == "nothing" and alone == "missing", verdict)
            named += "c0005" in verdict["says"] and "backlash:X" in verdict["says"]
        self.assertGreaterEqual(named, 2)

    def test_other_targets_are_no_other_machine(self):
        """A curve has another straight line through 11 targets than through 41: its slope is no scale that differs."""
        right = 0
        for n in range(3):
            site = self.site / str(n)
            for k, targets in enumerate((21, 11, 26, 41)):
                rows = ["run,direction,target_mm,deviation_um"]
                for run in range(1, 6):
                    for way in "+-":
                        for i in range(targets):
                            x = 1000.0 * i / (targets - 1)
                            at = x / 500 - 1
                            y = 3.0 * at + 4.0 * (at ** 3 - at) + 2.0 * math.cos(3 * at) + (-2 if way == "+" else 2) + self.rng.gauss(0, 0.3)
                            rows.append(f"{run},{way},{x:.3f},{y:.4f}")
                folder = site / f"n{k}"
                folder.mkdir(parents=True)
                (folder / "x.csv").write_text("\n".join(rows) + "\n")
                (folder / "campaign.toml").write_text(
                    f'format = 1\n[campaign]\nid = "n{k}"\ndate = 202{k}-03-11\n[machine]\nserial = "1"\n[machine.axes.X]\nkind = "linear"\n'
                    '[[measurement]]\nid = "x"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n')
            verdict = self.answer(site)["verdict"]
            right += {"pitch-curve:X", "scale:X"} <= set(verdict["same"]) and not verdict["differs"]
        self.assertGreaterEqual(right, 2)

    def test_another_part_of_the_travel_is_no_other_machine(self):
        """A curve has other knots over another part of the travel, and a growth another middle: neither is a difference."""
        for effect, size in (("pitch-curve:X", 6.0), ("growth-drift:X", 3.0), ("periodic:X", 1.0)):
            right = 0
            for n in range(3):
                site = self.site / f"{effect[:-2]}{n}"
                fleet.fleet(site, "shared", effect, size, 12, 0.0, self.rng, fleet.TRAVELS)
                verdict = self.answer(site)["verdict"]
                right += verdict["same"] == [effect] and not verdict["differs"]
            self.assertGreaterEqual(right, 2, effect)

    def test_a_bow_over_a_shorter_travel_is_no_scale(self):
        """A parabola over 10..560 mm has another slope than over 10..790 mm; each campaign's model has its curve."""
        for k in range(6):
            last = 790.0 if k < 4 else 560.0
            rows = ["run,direction,target_mm,deviation_um"]
            for run in range(1, 6):
                for way in "+-":
                    for i in range(11):
                        x = 10.0 + (last - 10.0) * i / 10
                        y = 2.0 * ((x - 400.0) / 390.0) ** 2 + (-1.0 if way == "+" else 1.0) + self.rng.gauss(0, 0.25)
                        rows.append(f"{run},{way},{x:.3f},{y:.4f}")
            folder = self.site / f"m{k}"
            folder.mkdir(parents=True)
            (folder / "x.csv").write_text("\n".join(rows) + "\n")
            (folder / "campaign.toml").write_text(
                f'format = 1\n[campaign]\nid = "m{k}"\ndate = 202{k}-03-11\n[machine]\nserial = "1"\n[machine.axes.X]\nkind = "linear"\n'
                '[[measurement]]\nid = "x"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n'
                '[model]\neffects = ["backlash:X", "pitch-curve:X"]\n')
        self.assertNotIn("scale:X", [e["effect"] for e in self.answer()["effects"]])

    def test_an_effect_that_appears(self):
        right = 0  # each decision errs in one of a hundred fleets by its level: in two of three fleets it may not
        for n in range(3):
            site = self.site / str(n)
            first = fleet.fleet(site, "appears", "pitch-curve:X", 0.8, 12, 0.0, self.rng)
            effect, = self.answer(site)["effects"]
            self.assertEqual(effect["effect"], "pitch-curve:X")
            if effect["per_campaign"] == "changed":
                self.assertIn("appears between", effect["says"])
                between = [effect["values"][0]["to"], effect["values"][1]["from"]]
                right += between == [f"c{first - 1:04d}", f"c{first:04d}"]
        self.assertGreaterEqual(right, 2)

    def test_an_effect_that_differs(self):
        fleet.fleet(self.site, "differs", "backlash:X", 0.8, 12, 0.0, self.rng)
        effect, = self.answer()["effects"]
        if effect["per_campaign"] == "own":  # a sample of halves can be a first and a last half
            values = [v["parameters"][0] for v in effect["values"]]
            for one, mean in zip(values, self.reversals()):
                # Noise that seems to wander gives readings other weights than a mean does: 0.3 u in one of a hundred campaigns.
                self.assertLess(abs(one["value"] - mean), 1.5 * one["u"])
        self.assertIn(effect["per_campaign"], ("own", "changed"))
        self.assertEqual(self.answer()["verdict"]["differs"], ["backlash:X"])

    def test_what_the_readings_do_not_separate_has_a_plan(self):
        fleet.fleet(self.site, "shared", "zero-drift:X", 0.25, 4, 0.0, random.Random(1))
        answer = self.answer()
        effect, = answer["effects"]
        plan, = answer["plans"]
        one, other = plan["separates"]
        self.assertEqual(one, effect["effect"])
        self.assertIn(other, effect["aliases"])
        self.assertIn(plan["campaign"], [c["campaign"] for c in answer["campaigns"]])
        self.assertIn(plan["readings"], (42, 126))  # 21 targets from both sides, once or three times
        pause = 10 * 209 if "pause" in plan["plan"] else 0  # as long as the test: 210 readings, 10 s apart
        self.assertAlmostEqual(plan["duration_s"], pause + 10 * plan["readings"], delta=30)
        printed = " ".join(explain(self.site).stdout.split())
        self.assertIn(f"({plan['campaign']}): {plan['says']}", printed)

    def test_what_to_measure_next_over_axes_machines_and_parts(self):
        """One list, in which measurements that separate something come first, by their duration."""
        fleet.fleet(self.site, "shared", "zero-drift:X", 0.25, 4, 0.0, random.Random(1))
        for sample in ("04-drift-parallel", "06-long-axis"):
            shutil.copytree(ROOT / "samples" / "site" / sample, self.site / sample)
        (self.site / "plate").mkdir()
        plates.plate(self.site / "plate" / "P1.csv", plates.grid(100), plates.errors("squareness:XY", 4.0), 1.0, 0.0, self.rng)
        plates.write(self.site / "plate", [("P1", 0)])
        answer = self.answer()
        alone = ["04-drift-parallel Y", "06-long-axis X", "plate XY"]
        self.assertEqual(sorted(answer["alone"]), alone)
        self.assertNotIn("left_out", answer)
        following = answer["next"]
        self.assertLessEqual({*alone, "c0001 X"}, {f"{n['campaign']} {n['part']}" for n in following})
        self.assertIn("turned-part", [n["plan"] for n in following])
        self.assertEqual(following, sorted(following, key=lambda n: (n["power"] < 4, n["duration_s"] if n["power"] >= 4 else -n["power"])))
        printed = " ".join(explain(self.site, "--quiet").stdout.split())
        self.assertIn("What to measure next, over all campaigns, cheapest first 1. " + following[0]["campaign"], printed)
        for number, one in enumerate(following[:8], 1):
            self.assertIn(f"{number}. {one['campaign']}, {one['part']}: {one['says']}", printed)

    def test_campaigns_of_different_axes_have_their_measurements_too(self):
        for sample in ("04-drift-parallel", "06-long-axis"):
            shutil.copytree(ROOT / "samples" / "site" / sample, self.site / sample)
        answer = self.answer()
        self.assertEqual(answer["parts"], [])
        page = self.site.parent / "page.html"
        self.assertIn("there are none", explain(self.site, "--page", page, status=2).stderr)
        self.assertFalse(page.exists())
        self.assertEqual({n["campaign"] for n in answer["next"]}, {"04-drift-parallel", "06-long-axis"})

    def test_nothing_is_found_where_there_is_nothing(self):
        fleet.fleet(self.site, "none", "", 0.0, 10, 0.3, random.Random(5))
        answer = self.answer()
        self.assertEqual((answer["verdict"]["kind"], answer["effects"]), ("nothing", []))

    def test_an_effect_of_some_models_only_is_searched_in_all(self):
        fleet.fleet(self.site, "shared", "backlash:X", 3.0, 2, 0.0, self.rng)
        manifest = self.site / "c0000" / "campaign.toml"
        manifest.write_text(manifest.read_text() + '[model]\neffects = ["backlash:X"]\n')
        answer = self.answer()
        self.assertEqual(answer["verdict"]["same"], ["backlash:X"])
        self.assertEqual(answer["model"]["effects"], [])

    def test_the_model_of_each_campaign_is_taken_off(self):
        fleet.fleet(self.site, "shared", "backlash:X", 1.0, 6, 0.0, self.rng)
        for manifest in self.site.glob("*/campaign.toml"):
            manifest.write_text(manifest.read_text() + '[model]\neffects = ["backlash:X"]\n')
        answer = self.answer()
        self.assertEqual((answer["model"]["effects"], answer["verdict"]["kind"]), (["backlash:X"], "nothing"))

    def test_machine_and_period_choose_campaigns(self):
        fleet.fleet(self.site, "shared", "backlash:X", 1.0, 8, 0.0, self.rng)
        for manifest in sorted(self.site.glob("*/campaign.toml"))[:3]:
            manifest.write_text(manifest.read_text().replace('"M-1"', '"M-2"'))
        of = self.answer(self.site, "--machine", "M-2")
        self.assertEqual([c["campaign"] for c in of["campaigns"]], ["c0000", "c0001", "c0002"])
        of = self.answer(self.site, "--since", "2020-03-01", "--until", "2020-05-31")
        self.assertEqual([c["campaign"] for c in of["campaigns"]], ["c0003", "c0004"])
        self.assertEqual(of["alone"], ["c0002 X"])

    def replace(self, campaigns, old, new):
        for manifest in campaigns:
            text = manifest.read_text()
            self.assertIn(old, text)
            manifest.write_text(text.replace(old, new))

    def test_machines_are_joined_only_if_their_model_is_the_same(self):
        fleet.fleet(self.site, "shared", "backlash:X", 1.0, 8, 0.0, self.rng)
        manifests = sorted(self.site.glob("*/campaign.toml"))
        for file in self.site.glob("c000[4-7]/x.csv"):  # another machine, with a larger reversal error
            rows = [line.split(",") for line in file.read_text().splitlines()]
            for row in rows[1:]:
                row[3] = f"{float(row[3]) + (-40 if row[1] == '+' else 40):.3f}"
            file.write_text("\n".join(map(",".join, rows)) + "\n")
        self.replace(manifests[4:], '"M-1"', '"M-2"')
        each = {part["part"]: part for part in self.answer()["parts"]}
        self.assertEqual(sorted(each), ["M-1 X", "M-2 X"])
        for part, first in (("M-1 X", 0), ("M-2 X", 4)):
            effect, = (e for e in each[part]["effects"] if e["effect"] == "backlash:X")
            self.assertEqual([c["campaign"] for c in each[part]["campaigns"]], [f"c{n:04d}" for n in range(first, first + 4)])
            self.assertEqual(effect["per_campaign"], "shared")
        alone = " ".join(explain(self.site / "c0000", self.site / "c0004").stdout.split())
        self.assertIn("runs also across machines of the same stated maker and model): c0000 X, c0004 X.", alone)
        self.replace(manifests, 'asset = ', 'model = "VM 1"\nasset = ')
        together = self.answer()
        self.assertEqual((together["part"], together["machines"]), ("X", ["M-1", "M-2"]))
        effect, = (e for e in together["effects"] if e["effect"] == "backlash:X")
        self.assertEqual(effect["per_campaign"], "own")
        self.assertRegex(effect["says"], r"from .* in c000[4-7] \(M-2, .* to .* in c000[0-3] \(M-1, ")
        self.assertIn("2 machines: M-1, M-2", explain(self.site).stdout)

    def test_sides_are_separate_and_adjustments_are_two_measurements(self):
        fleet.fleet(self.site, "shared", "backlash:X", 1.0, 6, 0.0, self.rng)
        manifests = sorted(self.site.glob("*/campaign.toml"))
        for n, manifest in enumerate(manifests[1:], 1):  # c0001 gets the readings of c0000 as its first file
            if n == 1:
                shutil.copy(manifests[0].parent / "x.csv", manifest.parent / "found.csv")
                text = manifest.read_text()
                start = text.index("[[measurement]]")
                second = text[start:].replace('"X"', '"X left"', 1) + 'adjustment = "after"\n'
                first = text[start:].replace("x.csv", "found.csv") + 'adjustment = "before"\n'
                manifest.write_text(text[:start] + first + second + '[model]\neffects = ["scale:X@adjustment"]\n')
        answer = self.answer()
        self.assertEqual([(c["campaign"], c.get("adjustment")) for c in answer["campaigns"]],
                         [("c0000", None), ("c0001", "before"), ("c0001", "after")] + [(f"c000{n}", None) for n in range(2, 6)])
        self.assertEqual([c["observations"] for c in answer["campaigns"]], [210] * 7)
        self.assertIn("X in 6 campaigns", explain(self.site).stdout)
        self.replace(manifests, 'kind = "linear"', 'kind = "linear"\nslave = "X2"')
        self.replace(manifests[1:2], 'adjustment = "before"', 'side = "master"')
        self.replace(manifests[1:2], 'adjustment = "after"', 'side = "slave"')
        self.replace(manifests[1:2], '@adjustment', '@side')
        self.replace(manifests[2:4], 'axis = "X"\n', 'axis = "X"\nside = "master"\n')
        self.replace(manifests[4:], 'axis = "X"\n', 'axis = "X"\nside = "slave"\n')
        each = {part["part"]: [c["campaign"] for c in part["campaigns"]] for part in self.answer()["parts"]}
        self.assertEqual(each, {"X master": ["c0001", "c0002", "c0003"], "X slave": ["c0001", "c0004", "c0005"]})

    def test_the_page_shows_all_residuals_over_four_axes(self):
        fleet.fleet(self.site, "shared", "backlash:X", 2.0, 5, 0.0, random.Random(3))
        for campaign in self.site.iterdir():  # temperatures in four of five
            file, warm = campaign / "x.csv", campaign.name != "c0002"
            head, *rows = file.read_text().splitlines()
            file.write_text("\n".join([head + ",material_c"] + [f"{row},{20 + 0.01 * i if warm else ''}" for i, row in enumerate(rows)]) + "\n")
        page = self.site.parent / "residuals.html"
        answer = self.answer(self.site, "--page", page)
        text = page.read_text()
        charts = text.split('<svg class="chart"')[1:]
        axes = [re.search('data-x="([^"]*)"', chart).group(1) for chart in charts]
        self.assertEqual(axes, ["Position of X / mm", "Time from the first reading / min", "Material temperature / °C",
                                "Number of the reading, campaigns in order of date"])
        for axis, chart in zip(axes, charts):
            with_readings = [f"c{n:04d}" for n in range(5) if n != 2 or "temperature" not in axis]
            self.assertEqual(re.findall(r"<title>(c\d{4}) \(20\d\d-\d\d-05\)</title>", chart), with_readings)
        self.assertIn("1050 readings of 5 campaigns (1050 drawn)", text)
        script = re.search("<script>(.*?)</script>", text, re.S).group(1)
        self.assertIn("sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(), text)
        self.assertNotIn("http://", text.replace("http://www.w3.org", ""))
        # The frame of the chart contains the residuals: the largest is some 3.5 times the noise, not the effect.
        low, high = map(float, re.search('data-frame="([^"]*)"', charts[0]).group(1).split()[-2:])
        self.assertTrue(2.5 * answer["noise_floor_um"] < high < 6 * answer["noise_floor_um"], (low, high))
        done = explain(self.site / "c0000", "--page", page, status=2)
        self.assertIn("--page is for several campaigns", done.stderr)

    def test_screens_and_refusals(self):
        fleet.fleet(self.site, "shared", "backlash:X", 1.0, 3, 0.0, self.rng)
        text = explain(self.site / "c0000", self.site / "c0001").stdout
        self.assertIn("X in 2 campaigns, c0000 to c0001: 420 readings", text)
        self.assertIn("backlash:X: the same in all campaigns", text)
        self.assertIn("--since: expected a day as YYYY-MM-DD", explain(self.site, "--since", "1.3.2026", status=2).stderr)
        self.assertIn("--auto is for one campaign", explain(self.site, "--auto", status=2).stderr)
        self.assertIn("expected two campaigns or more; found 0 (3 are not of this machine or period)",
                      explain(self.site, "--machine", "M-9", status=2).stderr)
        once = self.answer(self.site / "c0000", self.site / "c0001")
        self.assertEqual(self.answer(self.site / "c0000", self.site / "c0001", self.site / "c0000/"), once)
        shutil.copytree(self.site / "c0001", self.site.parent / "copy")
        self.assertIn("its readings would count twice", explain(self.site, self.site.parent / "copy", status=2).stderr)
        (self.site / "c0001/x.csv").write_text("run,direction\n1,+\n")
        answer = explain(self.site, "--json", "--quiet", status=1)
        self.assertEqual(len(json.loads(answer.stdout)["campaigns"]), 2)
        self.assertIn("c0001", json.loads(answer.stdout)["errors"][0]["message"])
        shutil.rmtree(self.site / "c0001"), shutil.rmtree(self.site / "c0002")
        (self.site / "empty").mkdir()
        self.assertIn("no campaign.toml in it or below it", explain(self.site / "c0000", self.site / "empty", status=2).stderr)


if __name__ == "__main__":
    unittest.main()
