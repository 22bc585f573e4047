#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Gantries with tables of pitch on both sides and of one axis over the other: all files are loaded into a machine of known
errors whose beam is rigid, by parsers of their own.

    NONIO_SEED=7 ctest --test-dir build/ci -R controllers.cross -V
"""
import csv
import math
import os
import pathlib
import random
import re
import shutil
import unittest

import gantry_test
from gantry_test import LENGTH, SIDES, Machine
from parsers import Table, cec, siemens

SEED = int(os.environ.get("NONIO_SEED", random.SystemRandom().randrange(2**31)))
CONTROL = "siemens-840d"


class Loaded:
    """A machine of gantry_test with the tables of a control: U is driven on both sides, V is on the beam. The same
    interface, so that it can be measured and loaded again. `shift`: of the zero of the second side, um."""

    def __init__(self, machine, files, numbers, shift=0.0):
        self.machine, self.shift = machine, shift
        self.numbers = numbers
        self.backlash = machine.backlash
        com = [c for n, t in files.items() if n.endswith(".COM") for c in self.columns_of(t)]
        self.pitch = {a: next((t for i, o, t in com if i == o == k), self.pitch_of(files, k)) for a, k in numbers.items()}
        self.cross = [c for n, t in files.items() if "CEC" in n for c in cec(t)] + [c for c in com if c[0] != c[1]]

    @staticmethod
    def columns_of(text):
        """Tables of a .COM of Heidenhain: of each axis that has a column, by the axis of the file. X2 and Y2 are number 4."""
        number = lambda axis: 4 if axis[1:] == "2" else "XYZ".index(axis) + 1
        lines = text.splitlines()
        heads = [(m[0], m.start()) for m in re.finditer(r"\S+", lines[1])] + [("", None)]
        for (axis, start), (_, end) in list(zip(heads, heads[1:]))[3:]:
            points = [(float(l.split()[1]), -1e3 * float(l[start:end])) for l in lines[2:] if l[:1].isdigit() and l[start:end].strip()]
            if points:
                yield number(re.match(r"BEGIN AXIS_(\w+)\.COM", lines[0])[1]), number(axis), Table(points)

    @staticmethod
    def pitch_of(files, number):
        """An axis may have no table: its error is too small, or its readings were refused."""
        own = {n: t for n, t in files.items() if "EEC" in n and "AX%d" % number in t.splitlines()[0]}
        return siemens(own, number) if own else Table([(0.0, 0.0)])

    def added(self, axis, u, v):
        """Mean of both directions."""
        at = {"U": u, "U2": u, "V": v}
        own = self.pitch[axis]
        sum_ = (own.added(at[axis], "+") + own.added(at[axis], "-")) / 2
        by = {k: a for a, k in self.numbers.items()}
        return sum_ + sum(t.added(at[by[i]]) for i, o, t in self.cross if by.get(o) == axis) + (self.shift if axis == "U2" else 0.0)

    def along_u(self, u, v):
        one, two = self.added("U", u, v), self.added("U2", u, v)
        return self.machine.along_u(u, v) + one + (two - one) * (v - SIDES[0]) / (SIDES[1] - SIDES[0])

    def along_v(self, u, v):
        return self.machine.along_v(u, v) + self.added("V", u, v)


def diagonal(machine, falling, n=80):
    """Range along a diagonal, um."""
    way = math.hypot(LENGTH["U"], LENGTH["V"])
    c, s = LENGTH["U"] / way, LENGTH["V"] / way * (-1 if falling else 1)
    at = [(LENGTH["U"] * i / n, LENGTH["V"] * (n - i if falling else i) / n) for i in range(n + 1)]
    e = [c * machine.along_u(u, v) + s * machine.along_v(u, v) for u, v in at]
    return max(e) - min(e)


class Cross(gantry_test.Gantry):
    control = CONTROL
    test_y_driven_on_both_sides_is_x_in_a_mirror = test_y_on_two_lines_without_drives_is_refused_by_name_and_listed = None

    not_stated = no_run = False

    def measured(self, machine, seed, driven="X", extra="", active=None):
        """The program's tables of this machine, by name."""
        self.more, self.active = extra, active or {}
        results = self.write(machine, seed, driven, self.control)
        for again in range(1, 5):  # about one noise in a few hundred looks like rows that were shifted, and withholds all tables
            if not any(f["id"] == "table.withheld" for t in results.get("tables", []) for f in t["findings"]):
                break
            results = self.write(machine, seed + 7919 * again, driven, self.control)
        return results, {} if self.no_run else {o["file"]: (self.out / "c" / o["file"]).read_text() for o in results["outputs"] if o["plugin"] == self.control}

    def run_site(self, expect=0):
        path = self.folder / "campaign.toml"
        text = path.read_text().replace("[run]\n", '[run]\noutputs = ["%s", "csv"]\n' % self.control).replace('"iso230-2"', '"iso230-2", "iso230-6"') + self.more
        for axis, files in self.active.items():
            text = re.sub(r'(\[machine\.axes\.%s\]\nkind = "linear"\n)active_table = "none"\nactive_backlash_mm = "none"' % axis,
                          r'\1active_table = "%s"' % files, text)
        if self.not_stated:
            text = text.replace('active_table = "none"\nactive_backlash_mm = "none"\n', "")
        path.write_text(text)
        return {} if self.no_run else super().run_site(expect)

    @staticmethod
    def numbers(driven):
        return {"U": 1 if driven == "X" else 2, "V": 2 if driven == "X" else 1, "U2": 4}

    @staticmethod
    def shift_of(text):
        found = re.search(r"shift the zero of \w+ by ([-+][\d.]+) mm", text)
        return 1e3 * float(found[1]) if found else 0.0

    def test_squareness_in_the_table_or_as_shift_of_the_slaves_zero(self):
        print("seed", SEED, flush=True)
        for k in range(2):
            for driven in "XY":
                machine = Machine(random.Random(SEED + k))
                for choice in ("table", "slave-zero"):
                    with self.subTest(k=k, driven=driven, choice=choice, seed=SEED):
                        results, files = self.measured(machine, SEED + k, driven, '[options.siemens-840d]\nsquareness = "%s"\n' % choice)
                        (cross,) = [t for n, t in files.items() if "CEC" in n]
                        shift = self.shift_of(cross)
                        after = Loaded(machine, files, self.numbers(driven), shift)
                        predicted = {p["name"]: p for t in results["tables"] if t["plugin"] == self.control for p in t["predictions"] if p["name"][0] == "D"}
                        U = min(v["U"] for a in results["analyses"] if a["plugin"] == "iso230-6" for n, v in a["values"].items() if n == "E")
                        for name, falling in (("D1", False), ("D2", True)):
                            was, now = diagonal(machine, falling), diagonal(after, falling)
                            case = "%s: %.2f -> %.2f um, promised %.2f" % (name, was, now, predicted[name]["predicted"])
                            print(driven, choice, case)
                            self.assertLess(now, 0.2 * was + 2.5, case)
                            self.assertAlmostEqual(predicted[name]["before"], was, delta=1.5, msg=case)
                            # Less than U of the diagonal's E is never promised.
                            self.assertAlmostEqual(predicted[name]["predicted"], max(now, U), delta=2.0, msg=case)
                            self.assertGreater(predicted[name]["predicted"], U - 0.01, case)
                        if choice == "table":
                            self.assertIn("the squareness is in them", cross)
                            self.assertEqual(shift, 0.0)
                            continue
                        # At the ends of the beam: C0Y over the distance of the sides.
                        self.assertAlmostEqual(shift, machine.square * (SIDES[1] - SIDES[0]) * 1e-3, delta=4.0)
                        self.assertNotIn("the squareness is in them", cross)
                        self.assertIn("|==>|" if shift > 0 else "|<==|", cross)
                        self.assertLess(diagonal(after, True), diagonal(Loaded(machine, files, self.numbers(driven), -shift), True) + 0.5)
                        (note,) = [n for t in results["tables"] if t["plugin"] == self.control for n in t["notes"] if "shift the zero" in str(n)]
                        self.assertIn("%s2" % driven, str(note))

    def test_a_cross_table_that_was_active_is_removed_from_the_curves(self):
        """A worn gantry, measured with the tables of its first campaign: the new ones are complete."""
        for k in range(2):
            old, now = Machine(random.Random(SEED + k)), Machine(random.Random(SEED + 50 + k))
            _, files = self.measured(old, SEED + k)
            for n, t in files.items():
                (self.folder / n).write_text(t)
            active = {a: ",".join(n for n in files if re.search(r"-%s(-|Y)" % a, n)) for a in ("X", "Y", "X2")}
            active["Y"] = ",".join(n for n in files if "-Y-" in n or "CEC" in n)
            active["X2"] += ",siemens-840d-XY-CEC.ini"
            before = Loaded(now, files, self.numbers("X"))
            results, new = self.measured(before, SEED + 90 + k, active=active)
            self.assertEqual(results["errors"], [])
            after = Loaded(now, new, self.numbers("X"))
            for falling in (False, True):
                case = "k %d: %.2f without, %.2f with the old tables, %.2f with the new ones" % (
                    k, diagonal(now, falling), diagonal(before, falling), diagonal(after, falling))
                print(case)
                self.assertLess(diagonal(after, falling), 0.2 * diagonal(before, falling) + 2.5, case)
            table = next(t for t in results["tables"] if t["plugin"] == self.control)
            predicted = {p["name"]: p for p in table["predictions"] if p["name"][0] == "D"}
            U = min(v["U"] for a in results["analyses"] if a["plugin"] == "iso230-6" for n, v in a["values"].items() if n == "E")
            for name, falling in (("D1", False), ("D2", True)):
                self.assertAlmostEqual(predicted[name]["before"], diagonal(before, falling), delta=1.5)
                self.assertAlmostEqual(predicted[name]["predicted"], max(diagonal(after, falling), U), delta=2.0)

    def test_pitch_tables_first_and_their_reference_within_the_travel(self):
        """Pitch tables hold the beam as it is at their reference point, not as it is at the first target."""
        for driven in "XY":
            with self.subTest(driven=driven, seed=SEED):
                now, number = Machine(random.Random(SEED)), self.numbers(driven)
                other = "XY".replace(driven, "")
                extra = "".join('[options.siemens-840d.axes.%s]\nnumber = %d\nreference_mm = %g\n' % one for one in (
                    (driven, number["U"], LENGTH["U"] * 0.4), (driven + "2", number["U2"], LENGTH["U"] * 0.4), (other, number["V"], 0.0)))
                _, files = self.measured(now, SEED, driven, extra)
                pitch = {n: t for n, t in files.items() if "EEC" in n}
                for n, t in pitch.items():
                    (self.folder / n).write_text(t)
                active = {a: ",".join(n for n in pitch if "-%s-" % a in n) for a in ("X", "Y", driven + "2")}
                before = Loaded(now, pitch, number)
                results, new = self.measured(before, SEED + 90, driven, extra, {a: n for a, n in active.items() if n})
                self.assertEqual(results["errors"], [])
                after = Loaded(now, pitch | new, number)
                for falling in (False, True):
                    self.assertLess(diagonal(after, falling), 0.1 * diagonal(before, falling) + 2.5)

    # nonio table insert --axis XY: a backup whose tables were active

    FOREIGN = "$AN_CEC[20,0]=0.001\n$AN_CEC[20,1]=0.004\n$AN_CEC_INPUT_AXIS[20]=(AX1)\n$AN_CEC_OUTPUT_AXIS[20]=(AX3)\n" \
              "$AN_CEC_STEP[20]=6000\n$AN_CEC_MIN[20]=0\n$AN_CEC_MAX[20]=6000\n$AN_CEC_IS_MODULO[20]=0\n" \
              "$AN_CEC_DIRECTION[20]=0\n$AN_CEC_MULT_BY_TABLE[20]=0\n"

    def worn(self, k, driven="X", of="old"):
        """A gantry that was measured with the tables of its first campaign, which only the backup states."""
        old, now = Machine(random.Random(SEED + k)), Machine(random.Random(SEED + 50 + k))
        _, files = self.measured(old, SEED + k, driven)
        backup = self.site.parent / "backup"
        for old_files in (backup, self.out / "load"):
            shutil.rmtree(old_files, ignore_errors=True)
        backup.mkdir()
        for n, t in files.items():
            t = t.replace("campaign c", "campaign " + of).replace("2026-05-10", "2025-05-10" if of == "old" else "2026-05-10")
            (backup / n).write_text(t.replace("M17\n", self.FOREIGN + "M17\n") if "CEC" in n else t)
        before = Loaded(now, files, self.numbers(driven))
        self.not_stated = True
        self.measured(before, SEED + 90 + k, driven)
        self.not_stated = False
        return now, before, sorted(backup.iterdir())

    def insert(self, files, axis="XY", *more, expect=0):
        args = ["table", "insert", ",".join(map(str, files)), "--with", self.folder, "--axis", axis, "--out", self.out / "load", *more]
        return self.json_of(*args) if expect == 0 else self.nonio(*args, expect=expect).stderr

    def loaded(self, now, files, driven="X"):
        """All files in the control afterwards."""
        whole = {f.name: f.read_text() for f in files}
        whole |= {f.name: f.read_text() for f in (self.out / "load").iterdir()}
        return Loaded(now, whole, self.numbers(driven)), whole

    def test_insert_of_several_axes_over_tables_that_were_active(self):
        for control, k in (("siemens-840d", 0), ("heidenhain-tnc", 3)):
            self.control = control
            for driven in "XY":
                with self.subTest(control=control, k=k, driven=driven, seed=SEED):
                    now, before, files = self.worn(k, driven)
                    answer = self.insert(files, "XY", "--loaded", "2026-05-12")
                    after, whole = self.loaded(now, files, driven)
                    lines = {l["measurement"]: l for l in answer["lines"]}
                    for name, falling in (("D1", False), ("D2", True)):
                        was, bare, will = (diagonal(m, falling) for m in (before, now, after))
                        case = "%s: %.2f without, %.2f with the old, %.2f with the new tables, promised %.2f" % (name, bare, was, will, lines[name]["after_um"])
                        print(driven, case)
                        self.assertLess(will, 0.2 * bare + 2.5, case)
                        self.assertAlmostEqual(lines[name]["before_um"], was, delta=1.5, msg=case)
                        self.assertLess(abs(lines[name]["after_um"] - will), 3.0, case)
                    for p in answer["predictions"]:
                        self.assertLess(p["after"]["E_um"], 0.5 * p["before"]["E_um"] + 3.0, p)
                    self.assertEqual(set(answer["measured_with"]), {"X", "Y", driven + "2"})
                    record = (self.site / "machines" / "G-1.toml").read_text()
                    for axis in ("X", "Y", driven + "2"):
                        states = record.split("[[axes.%s.state]]" % axis)[1:]
                        self.assertEqual([re.search(r'since = (\S+)', s)[1] for s in states], ["2026-05-10", "2026-05-12"], axis)
                        self.assertIn("CEC.ini" if "siemens" in control else "-Y.COM", states[1].split("[[")[0])
                    if "siemens" not in control:
                        continue
                    # The table of another axis and the numbers of the backup are as they were.
                    (cross,) = [t for n, t in whole.items() if "CEC" in n]
                    self.assertIn(self.FOREIGN, cross)
                    old = (files[0].parent / next(n for n in whole if "CEC" in n)).read_text()
                    number = lambda t: sorted(re.findall(r"OUTPUT_AXIS\[(\d+)\]=\((AX\d)\)", t))
                    self.assertEqual(number(cross), number(old))
                    self.assertNotIn("campaign old", cross.replace(self.FOREIGN, ""))
                    self.assertNotIn("CHOSEN", cross)

    def test_on_a_terminal_the_state_of_each_axis_is_asked_for(self):
        self.control = "siemens-840d"
        now, before, files = self.worn(4, of="c")  # the backup is of later, so nothing states what was active
        args = ["table", "insert", ",".join(map(str, files)), "--with", self.folder, "--axis", "XY", "--out", self.out / "load"]
        self.assertIn("was made from campaign c", self.nonio(*args, expect=1).stderr)
        answers = []
        for axis in ("X", "Y", "X2"):
            own = [str(f) for f in files if "-%s-" % axis in f.name or "CEC" in f.name]
            lost = [re.search(r"MA_BACKLASH\[0,AX\d\]=(\S+)", f.read_text()) for f in files if "-%s-backlash" % axis in f.name]
            answers += [",".join(f for f in own if "backlash" not in f), lost[0][1] if lost else "none"]
        said, status = self.answered(args, answers)
        self.assertEqual(status, 0, said)
        for axis in ("X", "Y", "X2"):
            self.assertIn("Value of MD32450 of %s then" % axis, said)
        after, _ = self.loaded(now, files)
        for falling in (False, True):
            self.assertLess(diagonal(after, falling), 0.2 * diagonal(now, falling) + 2.5, said)
        record = (self.site / "machines" / "G-1.toml").read_text()
        self.assertEqual(record.count('source = "answer"'), 3)
        self.nonio(*args)  # nothing is asked again

    def check_campaign(self, machine, seed):
        """The same lines on this machine, four days after loading."""
        self.folder, mine = self.site / "check", self.folder
        self.folder.mkdir(exist_ok=True)
        record = self.site / "machines" / "G-1.toml"
        known = record.read_text()
        self.no_run = self.not_stated = True
        self.measured(machine, seed)
        self.no_run = self.not_stated = False
        path = self.folder / "campaign.toml"
        path.write_text(path.read_text().replace('id = "c"', 'id = "check"\npurpose = "check"').replace("2026-05-10", "2026-05-16"))
        record.write_text(known)
        self.folder = mine

    def test_session_of_several_axes(self):
        now, before, files = self.worn(1)
        backup = ",".join(map(str, files))
        session = lambda *more, expect=0: self.json_of("table", "session", self.folder, "--axis", "XY", *more, expect=expect)
        steps = lambda answer: {s["step"]: s["state"] for s in answer["steps"]}
        first = session("--backup", backup, "--out", self.out / "load")
        self.assertEqual(steps(first), {"backup": "done", "state": "done", "table": "done", "probe": "done", "loading": "missing"})
        self.assertIn("D1", next(s["says"] for s in first["steps"] if s["step"] == "table"))
        # A sign probe for the pitch table of each axis; the others need the diagonals.
        probes = next(s["says"] for s in first["steps"] if s["step"] == "probe")
        for axis in ("X", "Y", "X2"):
            self.assertRegex(probes, r"(^|; )%s: " % axis)
        for name in re.findall(r"(\S+): from \S+ mm to \S+ mm the instrument shows", probes):
            self.assertTrue(pathlib.Path(name).is_file(), probes)
        self.assertIn("checked by the diagonals", probes)
        self.assertIn("--loaded YYYY-MM-DD", first["command"])
        after, _ = self.loaded(now, files)
        second = session("--backup", backup, "--loaded", "2026-05-12")
        self.assertEqual(steps(second)["loading"], "done")
        self.assertEqual(steps(second)["check"], "missing")
        self.assertIn("purpose", second["todo"])
        # What was active and what was loaded is in the record now.
        third = session()
        self.assertEqual(steps(third)["loading"], "done")
        self.check_campaign(after, SEED + 7)
        # The same readings by --check: the session makes the campaign.
        made, text = self.site / "check", (self.site / "check" / "campaign.toml").read_text()
        of = dict(re.findall(r'id = "(D\d)"\n(?:(?!\[).*\n)*?file = "(.*)"', text))
        given = ",".join("%s=%s" % (d, shutil.copy(made / f, self.site.parent / ("after-" + f))) for d, f in sorted(of.items()))
        made.rename(self.site.parent / "kept")
        self.assertIn("--check D1=FILE,D2=FILE", session()["command"])
        self.assertIn("expected D1=FILE,D2=FILE", next(s["says"] for s in session("--check", files[0], expect=1)["steps"] if s["step"] == "check"))
        own = session("--check", given, "--checked", "2026-05-16")
        self.assertEqual(steps(own)["verdict"], "done", own)
        shutil.rmtree(self.folder.parent / (self.folder.name + "-check"))
        (self.site.parent / "kept").rename(made)
        last = session()
        self.assertEqual(steps(last)["verdict"], "done", last)
        self.assertEqual([s["says"] for s in own["steps"] if s["step"] == "verdict"], [s["says"] for s in last["steps"] if s["step"] == "verdict"])
        for name, falling in (("D1", False), ("D2", True)):
            said = next(s["says"] for s in last["steps"] if s["step"] == "verdict")
            found = re.search(name + r": range ([\d.]+) um before, ([\d.]+) um predicted, ([\d.]+) um after", said)
            self.assertAlmostEqual(float(found[3]), diagonal(after, falling), delta=1.5)
        # Nothing was loaded.
        self.check_campaign(before, SEED + 8)
        worse = session(expect=1)
        self.assertIn(steps(worse)["verdict"], ("failed", "open"))

    def test_insert_of_several_axes_is_refused_by_name(self):
        now, before, files = self.worn(0, of="c")
        self.assertIn("was made from campaign c", self.insert(files, expect=1))
        # The pitch tables state nothing; the cross tables do.
        for f in files:
            if "CEC" not in f.name:
                f.write_text(f.read_text().replace("campaign c", "campaign old").replace("2026-05-10", "2025-05-10"))
        said = self.insert(files, expect=1)
        self.assertIn("the tables of several axes were made from campaign c", said)
        self.assertRegex(said, r"CEC\.ini:\d+: ")
        for f in files:
            f.write_text(f.read_text().replace("campaign c", "campaign old"))
        self.assertIn("contains no table of axis X2", self.insert([f for f in files if "X2" not in f.name and "CEC" not in f.name], expect=1))
        self.assertIn("expected --axis", self.nonio("table", "insert", ",".join(map(str, files)), "--with", self.folder, expect=2).stderr)
        self.insert(files, "XY", "--set", "squareness=slave-zero", expect=1)
        for control, word in (("linuxcnc", "linuxcnc has no tables of one axis by the position of another"),
                              ("twincat-volumetric", "cannot be merged into a backup")):
            table = self.site.parent / ("linuxcnc-X.comp" if control == "linuxcnc" else "twincat-volumetric-XYZ.csv")
            self.assertIn(word, self.one_of(control, table), control)
        self.assertEqual(list(self.out.glob("load/*")), [])
        # Without diagonals there are no such tables.
        path = self.folder / "campaign.toml"
        text = path.read_text()
        path.write_text(re.sub(r'(?s)\[\[measurement\]\]\nid = "D\d".*?(?=\[\[measurement|\[run)', "", text))
        self.assertIn("diagonals over XY are missing", self.insert(files, expect=1))

    def one_of(self, control, table):
        """What `insert` says of a table that this control wrote itself."""
        path = self.folder / "campaign.toml"
        text = path.read_text()
        other = text.replace('control = "%s"' % self.control, 'control = "%s"' % control)
        plain = re.sub(r'outputs = \[.*\]\n', "", other)
        path.write_text(plain)
        try:
            if control == "linuxcnc":
                table.write_text("".join("%.6f %.6f %.6f\n" % (x, x + 0.001 * (x / 6000), x) for x in range(0, 6001, 300)))
            else:
                table.write_text("#\nX EXX EYX\n0 0 0\n6000 0.001 0.002\n")
            more = ["--set", "sign=error"] if "twincat" in control else []
            return self.insert([table], "XY", "--control", control, *more, expect=1)
        finally:
            path.write_text(text)

    def test_curves_with_their_uncertainty_as_csv(self):
        results, _ = self.measured(Machine(random.Random(SEED)), SEED)
        analysis = self.of(results, "diagonal-straightness")
        path = next((self.out / "c").glob("curves-*-diagonal-straightness.csv"))
        rows = list(csv.DictReader(path.read_text().splitlines()))
        for name, series in analysis["series"].items():
            mine = [r for r in rows if r["curve"] == name]
            self.assertEqual([float(r["position"]) for r in mine], series["position"], name)
            for column, key in (("value", "value"), ("U", "U")):
                for r, v in zip(mine, series[key]):
                    self.assertAlmostEqual(float(r[column]), v, delta=1e-6 * max(1.0, abs(v)))
            self.assertEqual({r["over"] for r in mine}, {series["over"]})
            self.assertEqual({r["unit"] for r in mine}, {series["unit"]})

    def test_without_a_known_gantry_the_choice_is_refused_by_name(self):
        self.more, self.active = '[options.siemens-840d]\nsquareness = "slave-zero"\n', {}
        results = self.write(Machine(random.Random(SEED)), SEED, "X", self.control, sides=False)
        table = next(t for t in results["tables"] if t["plugin"] == self.control)
        self.assertIn("table.slave-zero-unknown", [f["id"] for f in table["findings"]])
        self.assertFalse([o for o in results["outputs"] if "CEC" in o["file"]])


if __name__ == "__main__":
    unittest.main()
