#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The generator: the same bytes each time, nights that follow one another, quantities, and the sample made by it.

With a program as argument, laboratory_test.py PROGRAM: it evaluates the small laboratory and that of twelve crashes, whose jumps
oracle.py must find in results.json.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import life  # noqa: E402 (this folder is no package)
import make_laboratory  # noqa: E402
import oracle  # noqa: E402
import physics  # noqa: E402
import presets  # noqa: E402
import quantities  # noqa: E402

SAMPLE = HERE.parents[2] / "samples" / "laboratory"
PROGRAM = None


def files_of(folder):
    """{path: bytes} of what the generator writes; a README is a person's."""
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file() and f.name != "README.md"}


def campaigns_of(files):
    """{campaign: (folder, {name: bytes})}"""
    out = {}
    for path, content in files.items():
        folder, _, name = path.rpartition("/")
        if folder:
            out.setdefault(folder.rpartition("/")[2], (folder, {}))[1][name] = content
    return out


def made(folder, preset, seed, until=None, **sizes):
    lab = presets.build(preset, seed, **sizes)
    truth = make_laboratory.write(lab, folder, physics.day_of(until) if until else lab.night)
    return files_of(folder), truth


class Temporary(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)


class Files(Temporary):
    def test_same_seed_same_bytes_another_seed_other_readings(self):
        first, truth = made(self.folder / "a", "mixed", 7)
        again, truth_again = made(self.folder / "b", "mixed", 7)
        other, _ = made(self.folder / "c", "mixed", 8)
        self.assertEqual(first, again)
        self.assertEqual(truth, truth_again)
        readings = {p: c for p, c in first.items() if p.endswith(".csv")}
        self.assertEqual([p for p, c in readings.items() if other.get(p) == c], [])

    def test_runs_follow_one_another(self):
        """A campaign exists from its day on (or from when its files arrived), with the same bytes, until it is removed."""
        lab = presets.build("mixed", 9)
        entered = {p.ident: p.entered for m in lab.machines for p in m.plans}
        gone = {p.ident for m in lab.machines if m.vanishes is not None for p in m.plans}
        before, late, earlier = {}, 0, "2021-11-22"
        for until in ("2022-11-22", "2023-11-22", "2024-11-22", "2025-11-22", "2026-11-21", "2026-11-22"):
            files, truth = made(self.folder / "site", "mixed", 9, until)
            now, day = campaigns_of(files), physics.day_of(until)
            last = day >= lab.night
            self.assertEqual(set(now), {c for c, e in entered.items() if e <= day and not (last and c in gone)}, until)
            self.assertEqual({v["campaign"] for v in truth["vanished"]}, gone if last else set())
            for campaign in set(now) & set(before):
                self.assertEqual(now[campaign][1], before[campaign][1], campaign)
            dates = {c: f[1]["campaign.toml"].split(b"\ndate = ")[1][:10].decode() for c, f in now.items()}
            late += sum(dates[c] <= earlier and c not in before for c in now)
            before, earlier = now, until
        self.assertGreater(len(gone), 0)
        self.assertGreater(late, 0)

    def test_what_is_true_does_not_know_the_future(self):
        _, early = made(self.folder / "a", "mixed", 2, "2025-11-22")
        ids = {p["campaign"] for s in early["series"] for p in s["points"]}
        for c in early["changes"]:
            self.assertIn(c["before"], ids)

    def test_a_folder_of_another_program_is_left_alone(self):
        (self.folder / "site").mkdir()
        (self.folder / "site" / "site.toml").write_text("[laboratory]\nname = \"Earnest\"\n")
        with self.assertRaises(SystemExit):
            made(self.folder / "site", "quiet", 1, machines=1)
        self.assertEqual(list(files_of(self.folder / "site")), ["site.toml"])

    def test_keys_of_a_history_only_when_asked(self):
        lab = presets.build("small", 1)
        make_laboratory.write(lab, self.folder / "a", lab.night)
        self.assertNotIn("[[alias]]", (self.folder / "a" / "site.toml").read_text())
        lab = presets.build("small", 1)
        make_laboratory.write(lab, self.folder / "b", lab.night, known=True)
        self.assertIn("[[alias]]", (self.folder / "b" / "site.toml").read_text())

    def test_the_sample_is_what_its_generator_writes(self):
        files, _ = made(self.folder / "site", "small", 1)
        self.assertEqual(files, files_of(SAMPLE))
        self.assertLess(sum(map(len, files.values())), 1_500_000)

    def test_no_two_of_many_have_the_same_readings(self):
        files, _ = made(self.folder / "site", "huge", 1, machines=40)
        readings = [c for p, c in files.items() if p.endswith(".csv")]
        self.assertEqual(len(readings), 800)
        self.assertEqual(len(set(readings)), 800)


class Laboratories(Temporary):
    def test_the_laboratory_of_twelve_crashes(self):
        files, truth = made(self.folder / "site", "lab", 1)
        self.assertEqual((len(truth["machines"]), len(campaigns_of(files))), (60, 510))
        crashes = [c for c in truth["changes"] if "crash" in c["kinds"]]
        self.assertEqual(len(crashes), 12)
        self.assertEqual(len({c["machine"] for c in crashes}), 12)
        for c in crashes:
            self.assertAlmostEqual(c["quantities"]["B_mean"]["size"], -4.0, delta=0.1)
        self.assertTrue(any(c["declared"] for c in crashes) and not all(c["declared"] for c in crashes))

    def test_a_truth_names_only_campaigns_that_measured_the_quantity(self):
        for seed in (3, 137):
            _, truth = made(self.folder / "site", "mixed", seed)
            for s in truth["series"]:
                ids = {p["campaign"] for p in s["points"]}
                for g in s["segments"]:
                    self.assertLessEqual({g["from"], g["to"]}, ids, (seed, s["machine"], s["axis"], s["quantity"]))
            everything = {p["campaign"] for s in truth["series"] for p in s["points"]}
            for c in truth["changes"] + truth["instruments"]:
                self.assertLessEqual({c["after"], c["before"]}, everything)

    def test_nothing_happens_where_all_is_quiet(self):
        _, truth = made(self.folder / "site", "quiet", 1)
        self.assertEqual(truth["changes"], [])
        self.assertEqual({g["law"] for s in truth["series"] for g in s["segments"]}, {"none"})
        self.assertGreater(len(truth["instruments"]), 0)

    def test_the_stories_are_true(self):
        """Of the sample: what its README says happened, and where."""
        _, truth = made(self.folder / "site", "small", 1)
        main = {(c["machine"], c["axis"], "+".join(c["kinds"])): c for c in truth["changes"]}
        self.assertEqual(set(main), {("LAB-02", "X", "crash"), ("LAB-03", "Z", "crash"), ("LAB-03", "Z", "repair"),
                                     ("LAB-05", "X", "compensation"), ("LAB-08", "Y", "crash"), ("LAB-10", "X-in-Z", "crash"),
                                     ("LAB-11", "C", "crash"), ("INV-0012", "XY", "moved")})
        self.assertAlmostEqual(main["LAB-02", "X", "crash"]["quantities"]["B_mean"]["size"], -4.3, delta=0.1)
        self.assertAlmostEqual(main["INV-0012", "XY", "moved"]["quantities"]["squareness:XY"]["size"], 25.0)
        self.assertEqual([b["machine"] for b in truth["breaks"]].count("LAB-09"), 3)
        self.assertEqual({m["campaign"][-8:] for m in truth["moved"]}, {"inv-0012"})
        comparators = [i for i in truth["instruments"] if i["machine"] == "LAB-06"]
        self.assertEqual(len(comparators), 1)
        self.assertAlmostEqual(comparators[0]["size"], 4.8)


class OfQuantities(unittest.TestCase):
    def test_weights_give_back_what_a_curve_is_made_of(self):
        """Each coefficient is recovered, and the others are zero: sinusoids are fitted together with all four shapes."""
        targets = [50.0 * i + 10.0 * (0.37 * i % 1.0) for i in range(21)]  # all phases of a period of 10 mm
        w = quantities.weights(targets, period=10.0)
        self.assertEqual(set(w), {"scale", "curve_2", "curve_3", "cyclic_cos", "cyclic_sin", "B_mean"})
        middle, length = (targets[0] + targets[-1]) / 2, targets[-1] - targets[0]
        z = [2 * (x - middle) / length for x in targets]
        curve = [1.0 + 2.0 * v + 3.0 * (3 * v * v - 1) / 2 - 4.0 * (5 * v ** 3 - 3 * v) / 2 for v in z]
        for name, wanted in (("curve_2", 3.0), ("curve_3", -4.0), ("cyclic_cos", 0.0), ("cyclic_sin", 0.0), ("B_mean", -2.5)):
            self.assertAlmostEqual(quantities.value(w[name], [y - 1.25 for y in curve], [y + 1.25 for y in curve]), wanted, 9, name)
        line = [0.004 * x for x in targets]
        self.assertAlmostEqual(quantities.value(w["scale"], line, line), 4.0, 9)

    def test_repetition_is_the_scatter_of_many(self):
        noise, targets = physics.Noise(5), [100.0 * i + 3.0 * (i % 3) for i in range(11)]
        w = quantities.weights(targets)
        for name in ("scale", "B_mean", "curve_2"):
            values = []
            for _ in range(2000):
                rows = {d: [0.0] * 11 for d in "+-"}
                for _ in range(5):
                    shared = 0.3 * noise.normal()
                    for d in "+-":
                        own = 0.2 * noise.normal()
                        rows[d] = [y + (shared + own + 0.5 * noise.normal()) / 5 for y in rows[d]]
                values.append(quantities.value(w[name], rows["+"], rows["-"]))
            s = (sum(v * v for v in values) / len(values)) ** 0.5
            self.assertAlmostEqual(s / quantities.repetition(w[name], 5, 0.5, 0.2, 0.3), 1.0, delta=0.06, msg=name + ", seed 5")

    def test_readings_scatter_around_what_is_true_as_the_truth_says(self):
        lab, pulls = presets.build("quiet", 6, machines=9), {}
        for machine in lab.machines:
            for _, set_up, measured in life.realise(lab.seed, machine):
                for m in measured:
                    if m.axis.new["rho"]:  # of these u is a rule of thumb
                        continue
                    w = life.quantities_of(m.axis, m.places)
                    true = life.true_values(m.axis, w, m.places, m.day, warmer=set_up.warmer)
                    seen = {n: quantities.value(v, *physics.means(m.readings, m.places)) for n, v in w.items()}
                    seen["scale"] -= set_up.slope(m.axis, m.axis.travel[1] - m.axis.travel[0])
                    s = m.axis.state(m.day)
                    for name, value in seen.items():
                        u = quantities.repetition(w[name], m.runs, s["s"], s["own"], s["shared"])
                        pulls.setdefault(name, []).append((value - true[name]) / u)
        for name in ("scale", "B_mean", "curve_2", "curve_3", "cyclic_cos"):
            rms = (sum(p * p for p in pulls[name]) / len(pulls[name])) ** 0.5
            self.assertAlmostEqual(rms, 1.0, delta=4.0 / (2 * len(pulls[name])) ** 0.5, msg="%s of %d, seed 6" % (name, len(pulls[name])))

    def test_wear_begins_again_with_new_parts(self):
        axis = life.Axis("X", (0.0, 1000.0), 11, b=-2.0)
        axis.installed, axis.wear = 0.0, {"b": life.linear(-1.0), "s": life.linear(0.1)}
        axis.happens(365.25, "crash", add={"b": -4.0})
        axis.happens(730.5, "repair", parts=["b"])
        for day, b in ((0.0, -2.0), (365.0, -3.0), (366.0, -7.0), (730.0, -8.0), (731.0, -2.0), (1095.75, -3.0)):
            self.assertAlmostEqual(axis.state(day)["b"], b, delta=0.01)
        self.assertAlmostEqual(axis.state(1095.75)["s"], 0.6 * 2.718281828 ** 0.3)  # the nut is new, the guide is not

    def test_a_table_takes_out_what_was_measured(self):
        lab = presets.build("small", 1)
        machine = next(m for m in lab.machines if m.asset == "LAB-05")
        done = life.realise(lab.seed, machine)
        found, left = next(measured for _, _, measured in done if len(measured) == 2)
        w = life.quantities_of(found.axis, found.places)["B_mean"]
        b = [quantities.value(w, *physics.means(m.readings, m.places)) for m in (found, left)]
        self.assertLess(abs(b[1]), 0.1 * abs(b[0]))


class WithTheProgram(Temporary):
    def run_night(self, site):
        out = self.folder / "out"
        done = subprocess.run([PROGRAM, "run", str(site), "--out", str(out), "--jobs", "2", "--quiet"], capture_output=True, text=True,
                              env=dict(os.environ, NONIO_ALLOW_ROOT="1", LC_ALL="C"))
        self.assertEqual(done.returncode, 0, done.stderr)
        counts = json.loads((out / "summary.json").read_text())["counts"]
        self.assertEqual(counts["failed"], 0)
        return out, counts

    def setUp(self):
        super().setUp()
        if PROGRAM is None:
            self.skipTest("no program given")

    def test_the_sample_is_done_without_errors(self):
        out, counts = self.run_night(SAMPLE)
        self.assertEqual((counts["campaigns"], counts["done"]), (104, 104))
        # Figures of its README.
        for campaign, measurement, name, figure in (
                ("2023-02-lab-03", "Z", "B_mean", "-1.61"), ("2024-02-lab-03", "Z", "B_mean", "-2.71"), ("2024-06-lab-03", "Z", "B_mean", "-5.31"),
                ("2025-06-lab-03", "Z", "B_mean", "-1.69"), ("2025-07-lab-02", "X", "B_mean", "-3.10"), ("2026-01-lab-02", "X", "B_mean", "-7.52"),
                ("2023-02-lab-04", "X", "B_mean", "-1.62"), ("2026-10-lab-04", "X", "B_mean", "-7.46"), ("2025-01-lab-05", "X found", "A", "15.49"),
                ("2025-01-lab-05", "X left", "A", "3.57"), ("2025-01-lab-08", "Y", "A", "5.78"), ("2025-07-lab-08", "Y", "A", "11.54"),
                ("2023-07-lab-10", "X2", "B_mean", "-2.66"), ("2026-07-lab-10", "X2", "B_mean", "-5.39"), ("2024-07-lab-11", "C", "A", "10.57"),
                ("2025-01-lab-11", "C", "A", "18.16"), ("2026-01-inv-0012", "X", "squareness:XY.c", "7.7"),
                ("2026-07-inv-0012", "X", "squareness:XY.c", "33.0")):
            result = json.loads((out / campaign / "results.json").read_text())
            found = [a["values"][name]["value"] for a in result["analyses"] if a["measurement"] == measurement and name in a["values"]]
            self.assertEqual(["%.*f" % (len(figure.partition(".")[2]), v) for v in found], [figure], (campaign, measurement, name))
            self.assertIn(figure, (SAMPLE / "README.md").read_text())
        found = oracle.series(out)
        for axis, figures in (("X", ("-1.80", "-1.53")), ("Y", ("-1.70", "-1.42"))):
            values = [p[3] for machine in ("LAB-01", "INVENTED-01") for p in found.get((machine, axis), [])]
            self.assertEqual(tuple("%.2f" % f(values) for f in (min, max)), figures)

    def test_the_crashes_of_the_laboratory_are_in_its_results(self):
        _, truth = made(self.folder / "site", "lab", 1)
        out, counts = self.run_night(self.folder / "site")
        self.assertEqual(counts["done"], 510)
        found = oracle.jumps(oracle.series(out), 3.0)
        planted = {(c["machine"], c["axis"], c["after"], c["before"]) for c in truth["changes"] if "crash" in c["kinds"]}
        self.assertEqual({f[:4] for f in found}, planted)
        for *_, size, in_u in found:
            self.assertTrue(-5.2 < size < -3.8 and 20.0 < in_u < 40.0, (size, in_u))


if __name__ == "__main__":
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        PROGRAM = sys.argv.pop(1)
    unittest.main()
