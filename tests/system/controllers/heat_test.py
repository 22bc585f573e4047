#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Thermal compensations as the program writes them: emulators of their own run the recorded channels through each file, and what
each makes the axis add is the opposite of what the model says."""
import csv
import json
import math
import random
import re
import struct
import unittest

from bench import BenchTest

STEP, ROWS = 20.0, 700
MANIFEST = """format = 1
[campaign]
id = "c"
date = 2026-11-03
[machine]
maker = "M"
model = "T"
serial = "1"
{axes}
[[measurement]]
id = "warm"
kind = "thermal"
file = "warm.csv"
[model]
effects = [{effects}]
[run]
analyses = ["model-fit"]
outputs = ["heat-compensation"]
[options.heat-compensation]
{options}
"""


def follow(values, tau):
    y, out = values[0], []
    for v in values:
        for _ in range(20):
            y += STEP / 20 / tau * (v - y)
        out.append(y)
    return out


def record(rng):
    """Speed, bearing, front and back of the column; Z follows speed and bearing, Y bends with the column."""
    speed = []
    while len(speed) < ROWS:
        speed += [rng.choice([0, 3000, 6000, 9000])] * rng.randint(40, 120)
    speed = speed[:ROWS]
    bearing = follow([20 + 12 * (s / 9000) ** 2 for s in speed], 700.0)
    front = follow([v - 0.3 * (v - 20) for v in bearing], 1500.0)
    back = [20 + 0.8 * math.sin(i / 90.0) for i in range(ROWS)]
    z = [3.0 * b + 6.0 * l for b, l in zip(follow(bearing, 300.0), follow([(s / 9000) ** 2 for s in speed], 900.0))]
    y = [2.0 * (f - b) for f, b in zip(front, back)]
    return {"time_s": [i * STEP for i in range(ROWS)], "z_um": z, "y_um": y, "spindle_rpm": speed, "bearing_c": bearing,
            "front_c": front, "back_c": back}


class Signal:
    """A channel between its samples."""

    def __init__(self, columns, name):
        self.time, self.value = columns["time_s"], columns[name]

    def __call__(self, t):
        i = min(int(t / STEP), ROWS - 2)
        part = (t - self.time[i]) / STEP
        return self.value[i] + part * (self.value[i + 1] - self.value[i])


class Hal:
    """What the manual pages of the components say; the nets by their names."""

    def __init__(self, text):
        self.parameters, self.of_pin, self.order, self.kind = {}, {}, [], {}
        self.source = {}
        for line in text.splitlines():
            words = line.split("#")[0].split()
            if not words:
                continue
            if words[0] == "loadrt":
                for name in words[2].removeprefix("names=").split(","):
                    self.kind[name] = words[1]
            elif words[0] == "addf":
                self.order.append(words[1])
            elif words[0] == "setp":
                self.parameters[words[1]] = float(words[2])
            elif words[0] == "net":
                for pin in words[2:]:
                    if pin not in ("=>", "<="):
                        assert pin not in self.of_pin, pin
                        self.of_pin[pin] = words[1]
        self.signals = {name: 0.0 for name in self.of_pin.values()}
        assert set(self.order) == set(self.kind), "a component is not in the thread"

    def pin(self, name):
        return self.signals[self.of_pin[name]] if name in self.of_pin else self.parameters.get(name, 0.0)

    def cycle(self, inputs):
        self.signals.update(inputs)
        for name in self.order:
            kind, pin = self.kind[name], lambda p, n=name: self.pin(f"{n}.{p}")
            out = self.of_pin[name + ".out"]
            if kind == "lowpass":
                old = self.signals[out]
                value = pin("in") if pin("load") else old + (pin("in") - old) * pin("gain")
            elif kind == "sum2":
                value = pin("in0") * pin("gain0") + pin("in1") * pin("gain1") + pin("offset")
            elif kind == "scale":
                value = pin("in") * pin("gain") + pin("offset")
            elif kind == "abs":
                value = abs(pin("in"))
            elif kind == "mult2":
                value = pin("in0") * pin("in1")
            else:
                assert kind == "conv_float_s32", kind
                value = int(pin("in"))
            self.signals[out] = value

    def run(self, axis, columns, period):
        """mm that the axis adds, at each row."""
        channels = {f"heat-{name[:-2]}-c" if name.endswith("_c") else "heat-" + name.split("_")[0]: Signal(columns, name)
                    for name in columns if name.endswith(("_c", "_rpm"))}
        inputs = lambda t: {s: f(t) for s, f in channels.items() if s in self.signals}
        start = f"heat-{axis}-start"
        self.cycle({**inputs(0.0), start: 1})
        counts = lambda: self.pin(f"axis.{axis}.eoffset-counts")
        assert self.pin(f"axis.{axis}.eoffset-enable") == 1
        before, added, out = counts(), 0.0, []
        for i in range(ROWS):
            for k in range(round(STEP / period)):
                self.cycle({**inputs(i * STEP + k * period), start: 0})
                added += (counts() - before) * self.pin(f"axis.{axis}.eoffset-scale")
                before = counts()
                if k == 0:
                    out.append(added)
        return out


def klipper(text, columns, sensor):
    """As the firmware smooths and adjusts: the reference is the temperature at homing."""
    section = dict(re.findall(r"(?m)^(\w+): (\S+)$", text))
    assert "[z_thermal_adjust]" in text
    temperature, out = Signal(columns, sensor), []
    smoothed = reference = temperature(0.0)
    for i in range(ROWS):
        out.append(-float(section["temp_coeff"]) * (smoothed - reference))
        for k in range(20):
            smoothed += (temperature(i * STEP + k) - smoothed) * min(1.0 / float(section["smooth_time"]), 1.0)
    return out


class Block:
    """Structured text: declarations, assignments, IF ... THEN ... END_IF."""

    def __init__(self, text):
        text = re.sub(r"\(\*.*?\*\)", "", text, flags=re.S)
        head, body = re.split(r"END_VAR\s+(?=IF)", text)
        self.type = dict(re.findall(r"(\w+)\s*:\s*(REAL|LREAL|BOOL);", head))
        self.state = {name: False if kind == "BOOL" else 0.0 for name, kind in self.type.items()}
        self.code = compile(self.python(body.replace("END_FUNCTION_BLOCK", "")), "block", "exec")

    @staticmethod
    def python(body):
        lines, depth = [], 0
        for line in body.replace("\n", " ").replace("THEN", "THEN;").split(";"):
            line = line.strip()
            if not line:
                continue
            if line == "END_IF":
                depth -= 1
                continue
            words = re.sub(r"\b(NOT|OR|AND)\b", lambda m: m[0].lower(), line)
            for name, value in (("TRUE", "True"), ("FALSE", "False"), ("EXP", "math.exp"), ("ABS", "abs")):
                words = re.sub(rf"\b{name}\b", value, words)
            if words.startswith("IF "):
                lines.append("  " * depth + "if " + words[3:].removesuffix("THEN").strip() + ":")
                depth += 1
            else:
                target, value = words.split(":=")
                lines.append("  " * depth + f"{target.strip()} = single('{target.strip()}', {value.strip()})")
        return "\n".join(lines)

    def cycle(self, **inputs):
        self.state.update(inputs)
        single = lambda name, v: struct.unpack("f", struct.pack("f", v))[0] if self.type[name] == "REAL" else v
        names = {**self.state, "math": math, "abs": abs, "single": single}
        exec(self.code, {}, names)
        self.state = {name: names[name] for name in self.state}

    def run(self, columns, output, period=1.0, position=None):
        channels = {"in_" + name.rsplit("_", 1)[0]: Signal(columns, name) for name in columns if name.endswith(("_c", "_rpm"))}
        channels = {name: f for name, f in channels.items() if name in self.type}
        out = []
        at = lambda i: {"position": position[i]} if position else {}
        self.cycle(dt=0.0, reset=True, **at(0), **{n: f(0.0) for n, f in channels.items()})
        for i in range(ROWS):
            for k in range(round(STEP / period)):
                self.cycle(dt=period, reset=False, **at(i), **{n: f(i * STEP + k * period) for n, f in channels.items()})
                if k == 0:
                    out.append(1.0 * self.state[output])
        return out


class HeatCompensation(BenchTest):
    def setUp(self):
        super().setUp()
        self.seed = random.randrange(10**6)
        self.columns = record(random.Random(self.seed))

    def write(self, control, effects=("heat:bearing/z", "heat-source:spindle/z", "heat-difference:back-front/y"), options="",
              names=None, expect=0):
        names = names or {}
        rng = random.Random(self.seed + 1)
        rows = [",".join(names.get(n, n) for n in self.columns)]
        rows += [",".join(f"{v + (rng.gauss(0, 0.05) if n.endswith('_um') else 0.0):.5f}" for n, v in zip(self.columns, row))
                 for row in zip(*self.columns.values())]
        (self.folder / "warm.csv").write_text("\n".join(rows) + "\n")
        axes = "".join(f'[machine.axes.{a}]\nkind = "linear"\n' for a in "YZ")
        (self.folder / "campaign.toml").write_text(MANIFEST.format(
            axes=axes, effects=", ".join(f'"{e}"' for e in effects), options=f'control = "{control}"\n{options}'))
        self.answer = self.run_site(expect=expect)
        return self.out / "c"

    def model(self, part):
        """What the model says of each row less its first, um, and the RMS of it."""
        table = self.out / "model.csv"
        self.nonio("model", "compare", self.folder, "--csv", table)
        value = [float(r["model_um"]) for r in csv.DictReader(table.read_text().splitlines()) if r["part"] == "warm/" + part]
        mean = sum(value) / len(value)
        return [v - value[0] for v in value], math.sqrt(sum((v - mean) ** 2 for v in value) / len(value))

    def assert_opposite(self, added_mm, part, sign=-1.0):
        says, rms = self.model(part)
        rest = [1e3 * a - sign * v for a, v in zip(added_mm, says)]
        found = math.sqrt(sum(r * r for r in rest) / len(rest))
        self.assertLess(found, 0.05 * rms, f"seed {self.seed}: {part} {found} um of {rms} um")

    def test_linuxcnc(self):
        files = self.write("linuxcnc", options="period_s = 1.0\n")
        for axis in "YZ":
            added = Hal((files / f"heat-linuxcnc-{axis}.hal").read_text()).run(axis.lower(), self.columns, 1.0)
            self.assert_opposite(added, axis.lower())

    def test_klipper(self):
        files = self.write("klipper", effects=("heat:bearing/z",))
        self.assert_opposite(klipper((files / "heat-klipper-Z.cfg").read_text(), self.columns, "bearing_c"), "z")

    def test_siemens_in_single_precision(self):
        files = self.write("siemens")
        for axis in "YZ":
            data = (files / f"heat-siemens-{axis}.ini").read_text()
            self.assertIn(f"$MA_TEMP_COMP_TYPE[{axis}]=1 ", data)
            block = Block((files / f"heat-siemens-{axis}.scl").read_text())
            self.assertEqual(block.type["elapsed"], "REAL")
            self.assert_opposite(block.run(self.columns, "offset_mm", 0.5), axis.lower())

    def test_twincat(self):
        files = self.write("twincat")
        for axis in "YZ":
            block = Block((files / f"heat-twincat-{axis}.st").read_text())
            self.assert_opposite(block.run(self.columns, "correction_mm"), axis.lower(), sign=1.0)

    def test_a_stated_displacement_takes_precedence_over_a_name(self):
        files = self.write("twincat", effects=("heat:bearing/table_y", "heat:bearing/z"), options='axes = ["table_y = Z"]\n',
                           names={"y_um": "table_y_um"})
        self.assertIn("table_y", (files / "heat-twincat-Z.st").read_text())
        self.assertNotIn("Two displacements", json.dumps(self.answer))

    def test_a_sensor_that_counts_against_its_axis(self):
        files = self.write("twincat", effects=("heat:bearing/ch3", "heat-source:spindle/ch3"), options='axes = ["ch3 = -Z"]\n',
                           names={"z_um": "ch3_um"})
        block = Block((files / "heat-twincat-Z.st").read_text())
        self.assert_opposite(block.run(self.columns, "correction_mm"), "ch3", sign=-1.0)

    # Runs of an axis whose screw grows

    RUNS = MANIFEST.replace('kind = "thermal"', 'kind = "axis"\naxis = "X"').replace(
        "{axes}", '[machine.axes.X]\nkind = "linear"\nactive_table = "none"\nactive_backlash_mm = "none"')

    def write_runs(self, control, effects, material=False, ramp=False):
        """Ten runs over 800 mm in which X grows with its screw, late, and moves with its bed; the true value of each row, um."""
        rng, targets = random.Random(self.seed), [50.0 + 800.0 / 34 * i for i in range(35)]
        waves = [[1.5 * math.sin(i / (90 + 41 * k) + rng.uniform(0, 6)) + 0.7 * math.sin(i / (40 + 13 * k)) for i in range(ROWS)]
                 for k in range(2)]
        screw, bed = ([22 + v for v in wave] for wave in waves)
        if ramp:
            screw = [25 - 3 * math.exp(-i / 100) for i in range(ROWS)]
        late = screw if material else follow(screw, 300.0)
        zero = sum(late) / ROWS if material or ramp else late[0]  # as for tables
        self.columns = {"time_s": [i * STEP for i in range(ROWS)], "screw_c": screw, "bed_c": bed}
        head = "run,direction,target_mm,deviation_um,time_s,%s,bed_c" % ("material_c" if material else "screw_c")
        rows, self.target, self.true = [head], [], []
        for i in range(ROWS):
            back = i // 35 % 2
            x = targets[34 - i % 35 if back else i % 35]
            true = (11.0e-3 * (x - 150.0) * (late[i] - zero) + (0.0 if material or ramp else 1.5 * (bed[i] - bed[0])))
            self.target.append(x)
            self.true.append(true)
            rows.append("%d,%s,%.6f,%.5f,%g,%.4f,%.4f" % (i // 70 + 1, "-" if back else "+", x, true + rng.gauss(0, 0.05),
                                                         i * STEP, screw[i], bed[i]))
        (self.folder / "warm.csv").write_text("\n".join(rows) + "\n")
        (self.folder / "campaign.toml").write_text(self.RUNS.format(
            effects=", ".join('"%s"' % e for e in effects), options='control = "%s"' % control))
        self.answer = self.run_site(expect=None)
        return self.out / "c"

    def assert_runs(self, added_mm, text):
        """What the axis adds is the opposite of what it has, and leaves what the file states."""
        rms = lambda v: math.sqrt(sum((x - sum(v) / len(v)) ** 2 for x in v) / len(v))
        rest = [1e3 * a + t for a, t in zip(added_mm, self.true)]
        self.assertLess(rms(rest), 0.1 * rms(self.true), "seed %d" % self.seed)
        table = self.out / "model.csv"
        self.nonio("model", "compare", self.folder, "--csv", table)
        says = [float(r["model_um"]) for r in csv.DictReader(table.read_text().splitlines())]
        self.assertLess(rms([1e3 * a + v for a, v in zip(added_mm, says)]), 0.05 * rms(says), "seed %d" % self.seed)
        measured = [float(r.split(",")[3]) for r in (self.folder / "warm.csv").read_text().splitlines()[1:]]
        before, after = map(float, re.search(r"in this test: (\S+) um, with the compensation (\S+) um", text).groups())
        self.assertAlmostEqual(before, rms(measured), delta=0.01)
        self.assertAlmostEqual(after, rms([1e3 * a + m for a, m in zip(added_mm, measured)]),
                               delta=0.05 * after + 0.005)  # last digit of the file

    def straight_line(self, files, channels):
        """The axis adds SD43900 + SD43910 (P - SD43920) where bits 0 and 1 of MD32750 are set."""
        data = (files / "heat-siemens-X.ini").read_text()
        value = {name: float(v) for name, v in re.findall(r"(?m)^\$[MS]A_(\w+)\[X\]=(\S+)", data)}
        self.assertEqual(value["TEMP_COMP_TYPE"], 3)
        offset, slope = (Block((files / "heat-siemens-X.scl").read_text()).run(channels, output, 0.5)
                         for output in ("offset_mm", "slope"))
        largest = float(re.search(r"largest SD43910 in this test: ([0-9.]+)", data)[1])
        self.assertAlmostEqual(largest, max(map(abs, slope)), delta=0.05 * largest)
        return [k0 + k * (p - value["TEMP_COMP_REF_POSITION"]) for k0, k, p in zip(offset, slope, self.target)], data

    def test_siemens_straight_line_of_a_growing_screw(self):
        files = self.write_runs("siemens", ("heat-growth:screw", "heat:bed"))
        self.assert_runs(*self.straight_line(files, self.columns))
        notes = [n["id"] for o in self.answer["outputs"] for n in o.get("notes", [])] + [str(self.answer)]
        self.assertTrue(any("sign-inferred" in n or "inferred" in n for n in notes))

    def test_siemens_straight_line_of_the_material_temperature(self):
        files = self.write_runs("siemens", ("temperature:X",), material=True)
        self.assert_runs(*self.straight_line(files, {**self.columns, "material_c": self.columns["screw_c"]}))

    def test_twincat_adds_the_growth_at_its_position(self):
        text = (self.write_runs("twincat", ("heat-growth:screw", "heat:bed")) / "heat-twincat-X.st").read_text()
        self.assertIn("position := axisX.NcToPlc.ActPos", text)
        self.assert_runs([-v for v in Block(text).run(self.columns, "correction_mm", position=self.target)], text)

    def test_growth_is_refused_where_the_control_has_one_value(self):
        for control, finding in (("linuxcnc", "position"), ("klipper", "only-z"), ("heidenhain", "not-documented")):
            with self.subTest(control=control):
                files = self.write_runs(control, ("heat-growth:screw", "heat:bed"))
                self.assertIn("heat-compensation." + finding, self.findings())
                self.assertEqual(list(files.glob("heat-*")), [])

    def test_an_effect_by_groups_is_named(self):
        """A control has one value, so an effect with a value for each measurement is in no file."""
        once = self.RUNS
        again = once[once.index("[[measurement]]"):once.index("[model]")].replace('"warm"', '"again"').replace("warm.csv", "again.csv")
        self.RUNS = once.replace("[model]", again + "[model]")
        for effects, written, findings in ((("heat-growth:screw", "heat:bed@measurement"), 1, set()),
                                           (("heat-growth:screw@measurement",), 0, {"heat-compensation.no-effect"})):
            with self.subTest(effects=effects):
                self.write_runs("twincat", effects)
                rng, rows = random.Random(self.seed + 1), (self.folder / "warm.csv").read_text().splitlines()
                parts = [r.split(",") for r in rows[1:]]
                (self.folder / "again.csv").write_text("\n".join([rows[0]] + [",".join(
                    p[:3] + ["%.5f" % (float(p[3]) + rng.gauss(0, 0.2))] + p[4:]) for p in parts]) + "\n")
                self.answer = self.run_site(expect=None)
                self.assertEqual(self.answer["errors"], [])
                self.assertEqual(self.findings(), findings)
                self.assertEqual(len(list((self.out / "c").glob("heat-*"))), written)
                notes = [n for o in self.answer["tables"] for n in o.get("notes", [])]
                self.assertEqual(sum(effects[-1] in n and "a control has one" in n for n in notes), written, notes)

    def test_what_would_make_the_axis_worse_is_not_written(self):
        """The scale of a table is right for the mean of the test: a growth from the first reading on adds to it."""
        files = self.write_runs("siemens", ("scale:X", "heat-growth:screw"), ramp=True)
        finding, = (f for o in self.answer.get("tables", []) for f in o.get("findings", []) if f["id"] == "heat-compensation.no-gain")
        self.assertGreater(finding["evidence"]["after_um"], finding["evidence"]["before_um"])
        self.assertEqual(list(files.glob("heat-*")), [])

    def findings(self):
        return {f["id"] for o in self.answer.get("tables", []) for f in o.get("findings", [])}

    def test_what_a_control_cannot_have_is_refused_by_name(self):
        for control, effects, options, finding, files in (
                ("klipper", ("heat:bearing/z", "heat-source:spindle/z"), "", "one-sensor", []),
                ("klipper", ("heat:front/y",), "", "only-z", []),
                ("heidenhain", ("heat:bearing/z",), "", "not-documented", []),
                ("linuxcnc", ("settling:time/z",), "", "no-effect", []),
                ("linuxcnc", (), "", "no-model", [])):
            with self.subTest(control=control, finding=finding):
                self.write(control, effects, options)
                self.assertIn("heat-compensation." + finding, self.findings())
                self.assertEqual(sorted(p.name for p in (self.out / "c").glob("heat-*")), files)
        self.write("linuxcnc", ("heat:bearing/ch3",), names={"z_um": "ch3_um"})
        self.assertIn("heat-compensation.no-axis", self.findings())
        self.write("linuxcnc", ("heat:bearing/z",), names={"z_um": "z_arcsec", "y_um": "y_arcsec"})
        self.assertIn("heat-compensation.tilt", self.findings())
        self.assertEqual(list((self.out / "c").glob("heat-*")), [])

    def test_an_axis_that_the_machine_has_not(self):
        self.write("linuxcnc", options='axes = ["z = W"]\n', expect=1)
        self.assertIn("option axes", self.answer["errors"][0]["message"])


if __name__ == "__main__":
    unittest.main()
