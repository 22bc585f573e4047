# SPDX-License-Identifier: Apache-2.0
"""Readings as laboratories have them: a table per target, instruments out of range, turns, gauges along an axis."""
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

NONIO = os.environ["NONIO"]
HERE = pathlib.Path(__file__).resolve().parent
SEED = int(os.environ.get("NONIO_SEED") or random.SystemRandom().randrange(10 ** 6))
HEAD = """format = 1
[campaign]
id = "field"
date = 2026-03-04
[machine]
asset = "F-1"
control = "linuxcnc"
"""


class Field(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-field-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def results(self, manifest, files, status=0):
        campaign = self.folder / "site/field"
        campaign.mkdir(parents=True, exist_ok=True)
        (campaign / "campaign.toml").write_text(HEAD + manifest)
        for name, text in files.items():
            (campaign / name).write_text(text)
        done = subprocess.run([NONIO, "run", self.folder / "site", "--out", self.folder / "out", "--quiet"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return json.loads((self.folder / "out/field/results.json").read_text())

    @staticmethod
    def values(results, plugin="iso230-2"):
        return {name: v["value"] for name, v in next(a for a in results["analyses"] if a["plugin"] == plugin)["values"].items()}

    @staticmethod
    def findings(results):
        return {f["id"] for a in results["analyses"] + results.get("tables", []) for f in a.get("findings", [])}

    def test_a_table_for_each_target_is_read_as_the_same_readings_in_one_file(self):
        print(f"seed {SEED} (NONIO_SEED)", file=sys.stderr)
        rng = random.Random(SEED)
        targets, blocks, ranges, flat = [12.0, 30.5, 49.0], [], [], ["run,direction,target_mm,position_mm"]
        line = 1
        for target in targets:
            block = [f"## Target {target} mm, both directions", "", "Test | Pos | Neg | Diff", "--- | --- | --- | ---"]
            for run in range(1, 6):
                plus, minus = (round(target + rng.gauss(0.01, 0.002), 4) for _ in "+-")
                block.append(f"{run} | {plus:.4f} | {minus:.4f} | {plus - minus:.4f}")
                flat += [f"{run},+,{target},{plus:.4f}", f"{run},-,{target},{minus:.4f}"]
            block += ["AVG | 0 | 0 | 0", ""]
            ranges.append(f"{line + 4}-{line + 8}")
            line += len(block)
            blocks += block
        axis = '[machine.axes.X]\nkind = "linear"\n[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.{}"\n'
        options = ('reader = "long-table"\n[options.long-table]\ncolumns = ["cycle", "value +", "value -", "ignore"]\nheading = "## Target"\n'
                   f'values = "positions"\ntarget_unit = "mm"\nvalue_unit = "mm"\nseparator = "|"\ntables = {json.dumps(ranges)}\n')
        wanted = self.values(self.results(axis.format("csv"), {"x.csv": "\n".join(flat) + "\n"}))
        got = self.values(self.results(axis.format("md") + options, {"x.md": "\n".join(blocks)}))
        self.assertEqual(set(got), set(wanted))
        for name, value in wanted.items():
            self.assertAlmostEqual(got[name], value, places=9)
        self.assertIn("R", wanted)

    def test_a_row_that_the_instrument_could_not_measure_is_counted_and_the_others_are_read(self):
        table = "".join(f"{5 * k}.0 | {'Out of range' if k == 1 else f'{5 * k + 0.002 * k:.4f}'}\n" for k in range(1, 9))
        results = self.results(
            '[machine.axes.X]\nkind = "linear"\n[options.wide-table]\ncolumns = ["target", "1 +"]\nvalues = "positions"\n'
            'target_unit = "mm"\nvalue_unit = "mm"\nseparator = "|"\n[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.md"\n'
            'reader = "wide-table"\n', {"x.md": table})
        points = next(a for a in results["analyses"] if a["plugin"] == "iso230-2")["points"]
        self.assertEqual([(p["target"], p["mean+"]) for p in points if p.get("n+")], [(5.0 * k, 2.0 * k) for k in range(2, 9)])
        self.assertIn("Readings were not taken in lines 1.", json.dumps(results))
        self.assertIn("readings.missing", self.findings(results))

    def test_one_turn_is_enough_for_an_axis_that_turns_further(self):
        axis = ('[machine.axes.B]\nkind = "rotary"\ntravel = [-{0}, {0}]\n[[measurement]]\nid = "B"\nkind = "axis"\naxis = "B"\nfile = "b.csv"\n')

        def table(span, first=0.0):
            rows = ["run,direction,target_deg,deviation_arcsec"]
            for run in (1, 2, 3):
                for k in range(9):
                    rows.append(f"{run},+,{first + span * k / 8:.4f},{20 * (k % 3) + run}")
            return "\n".join(rows) + "\n"

        self.assertNotIn("plausibility.span-against-travel", self.findings(self.results(axis.format(9000), {"b.csv": table(360.0, -20.0)})))
        self.assertNotIn("plausibility.span-against-travel", self.findings(self.results(axis.format(9000), {"b.csv": table(1080.0)})))
        self.assertIn("plausibility.span-against-travel", self.findings(self.results(axis.format(9000), {"b.csv": table(4.0)})))
        self.assertIn("plausibility.span-against-travel", self.findings(self.results(axis.format(170), {"b.csv": table(4.0)})))

    def test_each_line_of_a_gauge_has_its_own_zero(self):
        campaign = self.folder / "gauge"
        shutil.copytree(HERE / "gauge", campaign)
        rows = [line.split(",") for line in (campaign / "gauge.csv").read_text().splitlines()[2:]]
        errors = [float(far[-1]) for far in rows[1::2]]
        done = subprocess.run([NONIO, "model", "compare", campaign, "--json"], capture_output=True, text=True, check=True)
        part = json.loads(done.stdout)["parts"][0]
        (scale,) = part["model"]["parameters"]
        # One unknown per line and the scale: the mean error of a length over its length of 25 mm.
        self.assertAlmostEqual(scale["value"], sum(errors) / len(errors) / 0.025, places=6)
        self.assertEqual(part["redundancy"], len(rows) - len(errors) - 1)
        moved = [",".join(r[:-1] + [str(float(r[-1]) + 7 * (k // 2))]) for k, r in enumerate(rows)]
        (campaign / "gauge.csv").write_text("line,run,X_mm,X_dir,nx,ny,nz,deviation_um\n" + "\n".join(moved) + "\n")
        done = subprocess.run([NONIO, "model", "compare", campaign, "--json"], capture_output=True, text=True, check=True)
        self.assertAlmostEqual(json.loads(done.stdout)["parts"][0]["model"]["parameters"][0]["value"], scale["value"], places=6)

    def test_an_offset_that_accuracy_does_not_contain_is_reported(self):
        axis = '[machine.axes.X]\nkind = "linear"\n[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n'

        def table(offset):
            return "run,direction,target_mm,deviation_um\n" + "".join(
                f"{run},{way},{40 * k},{offset + (k * k) % 7 + run}\n" for run in (1, 2) for way in "+-" for k in range(8))
        for offset, reported in ((-310.0, True), (250.0, True), (-2.0, False)):
            results = self.results(axis, {"x.csv": table(offset)})
            found = [f for f in results["analyses"][0]["findings"] if f["id"] == "deviation.offset"]
            self.assertEqual(bool(found), reported, offset)
            if found:
                values = [offset + (k * k) % 7 + run for run in (1, 2) for k in range(8)]
                self.assertAlmostEqual(found[0]["evidence"]["offset_um"], sum(values) / len(values), places=6)

    def test_placements_of_a_square_are_compared(self):
        machine = ('[instrument]\nmaker = "m"\nmodel = "m"\nserial = "1"\nU_fixed_um = 1.0\n[machine.axes.X]\nkind = "linear"\n'
                   '[machine.axes.Y]\nkind = "linear"\n[[square]]\nid = "s"\nerror_urad = 0.0\nU_urad = 20.0\n[run]\nanalyses = ["square"]\n')

        def finding(slopes):
            manifest, files = machine, {}
            for k, slope in enumerate(slopes):
                for axis, lateral, tilt in (("X", "Y", 30.0), ("Y", "X", slope - 30.0)):
                    name = f"{axis.lower()}{k}.csv"
                    manifest += (f'[[measurement]]\nid = "Q{axis} p{k}"\nkind = "straightness"\naxis = "{axis}"\nlateral = "{lateral}"\nsquare = "s"\n'
                                 f'file = "{name}"\n')
                    files[name] = "run,direction,target_mm,deviation_um\n" + "".join(f"1,+,{100 * i},{0.1 * tilt * i}\n" for i in range(4))
            found = [f for a in self.results(manifest, files)["analyses"] for f in a["findings"] if f["id"] == "square.placements"]
            self.assertLessEqual(len(found), 1)
            return found[0] if found else None

        far = finding((100.0, 140.0, 300.0))
        self.assertEqual(far["severity"], "attention")
        for name, wanted in (("low_urad", -300.0), ("high_urad", -100.0), ("mean_urad", -180.0), ("s_urad", 105.83005244), ("count", 3)):
            self.assertAlmostEqual(far["evidence"][name], wanted, places=6)
        self.assertEqual(finding((100.0, 110.0))["severity"], "info")
        self.assertIsNone(finding((100.0,)))

    def test_repeats_from_one_side_are_called_neither_absent_nor_a_direction(self):
        campaign = self.folder / "probe"
        campaign.mkdir()
        (campaign / "campaign.toml").write_text(
            HEAD + '[machine.axes.Y]\nkind = "linear"\n[[measurement]]\nid = "Y"\nkind = "axis"\naxis = "Y"\norder = "as-listed"\nfile = "y.csv"\n')
        (campaign / "y.csv").write_text("run,direction,target_mm,deviation_um\n" + "".join(f"{k},+,52,{7 - 12 / k:.2f}\n" for k in range(1, 25)))
        done = subprocess.run([NONIO, "model", "compare", campaign], capture_output=True, text=True, check=True).stdout
        self.assertIn("each run has too few readings", done)
        self.assertNotIn("no repeated readings", done)
        self.assertNotIn("direction of approach", done)
        self.assertIn("slowly with time", done)


if __name__ == "__main__":
    unittest.main()
