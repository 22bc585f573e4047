#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every finding plausibility.* withholds the controller tables and the certificate's number until a person accepts it with a
reason: in the manifest for tables, at the approval for the number. The findings are those of
templates/words, so that a new one without a case here fails. Skipped without openssl."""
import datetime
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import mutants
import tired
from mutants import HEAD, POSITION, change_run, copy_pass, copy_run, csv, flip, positions, scaled

NONIO = os.environ["NONIO"]
SOURCE = pathlib.Path(os.environ["NONIO_DOCS"]).parent
SAMPLE = SOURCE / "samples" / "certificates"
REASON = "seen, and right"
LONG = bool(os.environ.get("NONIO_LONG"))
CONTROL = ["siemens-840d", "heidenhain-tnc", "fanuc", "linuxcnc", "rotary-vectors-heidenhain", "rotary-vectors-linuxcnc"]


def findings():
    information = {"directions-opposed"}  # withholds nothing
    words = (SOURCE / "templates" / "words" / "en" / "plausibility.toml").read_text(encoding="utf-8")
    return [f for f in re.findall(r'\[finding\."plausibility\.([a-z-]+)"\]', words) if f not in information]


def rows(seed, travel=1000.0):
    return [[r, d, t, float(f"{v:.3f}")] for r, d, t, v in mutants.rows_of(random.Random(seed), travel=travel)]


def with_columns(data, head, *columns):
    return csv([r + [c(i) for c in columns] for i, r in enumerate(data)], HEAD + head)


def ball(coordinate, scale=1.0):
    """A ball that turns about the axis along a coordinate (0: x), radius 200 mm."""
    lines = ["angle_deg,x_mm,y_mm,z_mm"]
    for k in range(12):
        turn = math.radians(30 * k)
        around = [200 * math.cos(turn), 200 * math.sin(turn)]
        at = [0.0, 0.0, 0.0]
        at[(coordinate + 1) % 3], at[(coordinate + 2) % 3] = around
        lines.append(f"{30 * k}," + ",".join(f"{scale * (a + 300 + 0.001 * ((7 * k + 3 * i) % 5)):.4f}"
                                             for i, a in enumerate(at)))
    return "\n".join(lines) + "\n"


def rtl(data, serial="", date="", expansion=""):
    """Rows of mutants as a laser's file."""
    targets = sorted({r[2] for r in data})
    lines = ["HEADER::", "File type  : rtl", "Owner      : Linear", "", "TARGET DATA::", f"Target-count: {len(targets)}",
             "Targets :", *(f"{t:.6f}" for t in targets), "Flags: 0 0 2 1", "", "USER-TEXT::", "Machine:",
             f"Serial No:{serial}", f"Date:{date}", "By:", "Axis:", "Location:", "TITLE:", "", "RUNS::", "Run-count:10", "",
             "DEVIATIONS::", "Run Target Data:"]
    lines += [f"{2 * r - (d == '+')} {targets.index(t) + 1} {v:.3f}" for r, d, t, v in data]
    if expansion:
        lines += ["", "ENVIRONMENT::", f"Exp coeff  : {expansion} {expansion} 0"]
    return "\n".join(lines + ["", "EOF::", ""])


def waves():
    """A pitch of 5.08 mm, seen at 47 targets."""
    rng = random.Random(508)
    return csv([[run, d, 1.3 * i, 4 * math.sin(6.28318 * 1.3 * i / 5.08) + rng.gauss(0, 0.3) - 3 * (d == "-")]
                for run in range(1, 6) for d in "+-" for i in range(47)[::1 if d == "+" else -1]])


def plate(change, times=1):
    """Nine holes; `change` returns the nominal and the measured place of one."""
    rng = random.Random(9)
    lines = ["nominal_x_mm,nominal_y_mm,measured_x_mm,measured_y_mm"]
    for x in (50, 150, 250):
        for y in (50, 150, 250):
            p = [float(x), float(y)]
            nominal, measured = change(p, [c + rng.gauss(0, 0.002) for c in p])
            lines += [",".join(f"{c:.4f}" for c in [*nominal, *measured])] * times
    return (lambda text: sub(("[instrument]", Y_AXIS + "[instrument]"))(text) +
            '[[measurement]]\nid = "plate"\nkind = "part"\nfile = "p.csv"\n', {"p.csv": "\n".join(lines) + "\n"})


def sub(*pairs):
    def change(text):
        for old, new in pairs:
            assert old in text, old
            text = text.replace(old, new, 1)
        return text
    return change


Y_AXIS = '[machine.axes.Y]\nkind = "linear"\ntravel = [0.0, 1000.0]\nscrew_pitch_mm = 10.0\nexpansion_um_per_m_K = 11.5\n'
C_AXIS = '[machine.axes.C]\nkind = "rotary"\n'
SECOND = ('[[measurement]]\nid = "{0}"\nkind = "{1}"\naxis = "{0}"\nfile = "{2}"\nfeed_mm_per_min = 3000\ndwell_s = 4\n'
          'over_travel_mm = 2\n')


def cases():
    """finding -> (change of the manifest, files); every other file is that of an ordinary axis."""
    same = lambda text: text
    number = iter(range(1000, 2000))
    own = lambda: rows(next(number))
    turn = lambda r: [x if x[0] != 3 else x[:3] + [y[3]] for x, y in zip(r, [
        z for k in range(0, len(r), 11) for z in r[k:k + 11][::-1]])]
    def moved(r):
        """One pass, of which each row has the reading of the next target."""
        one = sorted((x for x in r if x[0] == 2 and x[1] == "+"), key=lambda x: x[2])
        value = {a[2]: b[3] for a, b in zip(one, one[1:] + one[-1:])}
        return [x[:3] + [value[x[2]]] if x[0] == 2 and x[1] == "+" else x for x in r]
    bump = lambda r: [x[:3] + [x[3] + 12 * math.exp(-((x[2] - 300) / 120) ** 2)] for x in r]
    drift = lambda text: text.replace("drift_um = 0.6", "drift_um = 190")
    tomorrow = (datetime.date.today() + datetime.timedelta(days=60)).isoformat()
    shared, twice = csv(own()), csv(own())
    joint = lambda r: [x if x[2] < 500 else x[:3] + [x[3] + 12 - 8 * (x[1] == "-")] for x in r]
    one, other = own(), own()
    half = [[*x[:3], y[3]] if x[2] > 500 else x for x, y in zip(one, other)]
    read = lambda change, **how: (same, {"x.csv": csv(change(own()), **how)})
    return {
        "deviation-grows-with-position": read(lambda r: positions(1000.0)(r, None), head=POSITION),
        "deviation-too-large": read(lambda r: [x[:3] + [x[3] * 150] for x in r]),
        "deviation-beyond-pitch": (sub(("screw_pitch_mm = 10.0", "screw_pitch_mm = 1.0")),
                                   {"x.csv": csv([x[:3] + [x[3] + (520 if 450 < x[2] < 550 else 0)] for x in own()])}),
        "scatter-too-large": read(lambda r: [x[:3] + [x[3] + 350 * (x[0] - 3)] for x in r]),
        "readings-all-equal": read(lambda r: scaled(1, 0)(r, None)),
        "deviation-below-uncertainty": (sub(("U_fixed_um = 0.1", "U_fixed_um = 100")), {}),
        "deviation-too-small": (sub(("U_fixed_um = 0.1\nU_per_m_um = 0.5", "U_fixed_um = 0.001\nU_per_m_um = 0.0")),
                                {"x.csv": csv(scaled(1, 1e-3)(own(), None), digits=6)}),
        "span-against-travel": read(lambda r: scaled(1 / 25.4)(r, None), target="{:.5f}"),
        "span-against-pitch": (sub(("screw_pitch_mm = 10.0", "screw_pitch_mm = 10000")), {}),
        "span-of-another-unit": (lambda text: text + SECOND.format("X", "axis", "y.csv").replace('id = "X"', 'id = "X two"'),
                                 {"y.csv": csv(scaled(1 / 25.4)(own(), None), target="{:.5f}")}),
        "no-scatter": read(lambda r: [list(x) for run in range(1, 6) for x in copy_run(r, 1, run) if x[0] == run]),
        "passes-identical": read(lambda r: copy_run(r, 1, 2)),
        "direction-against-order": read(lambda r: change_run(r, 4, flip)),
        "directions-swapped": read(lambda r: sorted(change_run(r, 2, flip), key=lambda x: (x[2], x[1], x[0]))),
        "file-cut-short": (same, {"x.csv": csv(own())[:-2]}),
        "file-of-another-campaign": (same, {"x.csv": shared}),
        "file-twice": (lambda text: sub(("[instrument]", Y_AXIS + "[instrument]"))(text) + SECOND.format("Y", "axis", "y.csv"),
                       {"x.csv": twice, "y.csv": twice}),
        "readings-twice": (lambda text: sub(("[instrument]", Y_AXIS + "[instrument]"))(text) +
                           SECOND.format("Y", "axis", "y.csv"), {"x.csv": csv(rows(77)), "y.csv": csv(rows(77), end="\r\n")}),
        "unknown-axis": (sub(('axis = "X"\nfile', 'axis = "V"\nfile')), {}),
        "temperature": (same, {"x.csv": with_columns(own(), ["material_c"], lambda i: 68.4)}),
        "humidity": (same, {"x.csv": with_columns(own(), ["humidity_pct"], lambda i: 0.45)}),
        "environment-varies": (same, {"x.csv": with_columns(own(), ["air_c"], lambda i: 20.5 if i != 30 else 120)}),
        "pace": (same, {"x.csv": with_columns(own(), ["time_s"], lambda i: 8000 * i)}),
        "times-against-order": (same, {"x.csv": with_columns(own(), ["time_s"], lambda i: 9 * i - (250 if i > 54 else 0))}),
        "day-to-come": (sub(("date = 2026-04-14\nend_date = 2026-04-15", f"date = {tomorrow}")), {}),
        "calibrated-later": (sub(("calibrated = 2026-01-12", "calibrated = 2026-05-01")), {}),
        "unusual-statement": (sub(("misalignment_mm = 0.5", "misalignment_mm = 60")), {}),
        "uncertainty-beyond-deviation": (drift, {}),
        "targets-outside-travel": read(lambda r: [[x[0], x[1], x[2] + 200, x[3]] for x in r]),
        "place-outside-travel": (lambda text: sub(("[instrument]", Y_AXIS + "[instrument]"), ("at = { Y = 250", "at = { Y = 2500"))(text), {}),
        "pass-order-turned": read(lambda r: sorted(turn(bump(r)), key=lambda x: (x[0], x[1], x[2]))),
        "pass-sign-turned": read(lambda r: [x if x[:2] != [3, "+"] else x[:3] + [-x[3]] for x in bump(r)]),
        "pass-of-another-size": read(lambda r: change_run(r, 3, lambda x: x[:3] + [x[3] / 1000])),
        "comment-unit": (same, {"x.csv": "# deviations in nm\n" + csv(own())}),
        "name-of-another": (sub(("[instrument]", Y_AXIS + "[instrument]")), {"x.csv": "# axis: Y\n" + csv(own())}),
        "other-serial": (same, {"x.csv": rtl(own(), serial="no-such-machine")}),
        "other-day": (same, {"x.csv": rtl(own(), date="2019-04-14 10:00:00")}),
        "other-expansion": (same, {"x.csv": rtl(own(), expansion="23.800000")}),
        "pitch-in-inch": (sub(("screw_pitch_mm = 10.0", "screw_pitch_mm = 0.3937")), {}),
        "period-against-pitch": (sub(("screw_pitch_mm = 10.0", "screw_pitch_mm = 0.2")), {"x.csv": waves()}),
        "span-of-one-axis": (lambda text: sub(("[instrument]", Y_AXIS + "[instrument]"))(text) +
                             '[[measurement]]\nid = "D1"\nkind = "diagonal"\nfrom = { X = 0, Y = 0 }\nto = { X = 800, Y = 600 }\n'
                             'file = "d.csv"\n', {"d.csv": csv([[r, d, 80.0 * i, (7 * i + 3 * r) % 5 + 0.1 * i]
                                                               for r in (1, 2) for d in "+-" for i in range(11)])}),
        "pace-against-test": (same, {"x.csv": with_columns(own(), ["time_s"], lambda i: 0.15 * i)}),
        "pass-of-means": read(lambda r: r + [[6, *x[1:3], sum(y[3] for y in r if y[1:3] == x[1:3]) / 5] for x in r[:22]]),
        "reading-far-off": read(lambda r: [x if i != 40 else x[:3] + [46083.0] for i, x in enumerate(r)]),
        "mark-among-readings": read(lambda r: [x if i % 7 else x[:3] + [0.0] for i, x in enumerate(
            [y[:3] + [y[3] + 40] for y in r])]),
        "targets-against-order": read(lambda r: tired.exchanged(r, 2)),
        "two-curves": read(lambda r: tired.half_of_another(r, 4)),
        "two-reversals": read(joint),
        "stretch-twice": (lambda text: sub(("[instrument]", Y_AXIS + "[instrument]"))(text) +
                          SECOND.format("Y", "axis", "y.csv"), {"x.csv": csv(one), "y.csv": csv(half)}),
        "ball-circle": (lambda text: sub(("[instrument]", C_AXIS + "[instrument]"))(text) +
                        SECOND.format("C", "ball-centres", "c.csv").split("feed")[0], {"c.csv": ball(2, 1 / 25.4)}),
        "axis-direction": (lambda text: sub(("[instrument]", C_AXIS + "[instrument]"))(text) +
                           SECOND.format("C", "ball-centres", "c.csv").split("feed")[0], {"c.csv": ball(0)}),
        "part-columns-exchanged": plate(lambda p, m: (m, p)),
        "part-as-nominal": plate(lambda p, m: (p, [p[0], m[1]])),
        "part-rows-twice": plate(lambda p, m: (p, m), times=2),
        # Last: each case has the readings of its place.
        "rows-shifted": read(lambda r: moved([x[:3] + [x[3] + 9 * math.sin(x[2] / 150) + 5 * math.cos(x[2] / 47)] for x in r])),
        "direction-turned": read(lambda r: [x if x[1] != "-" else x[:3] + [-x[3]] for x in bump(r)]),
    }


class Stopped(unittest.TestCase):
    """One run makes drafts of all; then each is approved, or refused."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="nonio-stopped-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.root = pathlib.Path(cls.folder.name)
        cls.site, cls.out = cls.root / "site", cls.root / "out"
        shutil.copytree(SAMPLE, cls.site, ignore=shutil.ignore_patterns("keys", "*.sqlite", "adjusted"))
        subprocess.run(["bash", str(cls.site / "make-key.sh")], check=True, capture_output=True)
        text = (SAMPLE / "adjusted" / "campaign.toml").read_text()
        before, after = text.index('[[measurement]]\nid = "X before"'), text.index('[[measurement]]\nid = "X after"')
        text = (text[:before] + text[after:]).replace("800.0", "1000.0").replace("x-after.csv", "x.csv").replace(
            'id = "X after"', 'id = "X"').replace('adjustment = "after"\n', "").replace('axis = "X"\n', 'axis = "X"\n', 1)
        text = text.replace("customer_data", 'conditions = "as found"\ncustomer_data')
        text = re.sub(r"tolerance_um = .*\n", "", text)
        run = '[run]\noutputs = ["json", "certificate", "siemens-840d", "rotary-vectors"]\n'
        cls.cases = cases()
        for k, (finding, (change, files)) in enumerate(cls.cases.items()):
            for state in ("held", "accepted"):
                folder = cls.site / f"{finding}-{state}"
                folder.mkdir()
                manifest = change(text).replace('id = "adjusted"', f'id = "{finding}-{state}"') + run
                (folder / "campaign.toml").write_text(manifest)
                for name, data in {"x.csv": csv(rows(k)), **files}.items():
                    if state == "accepted" and finding != "file-of-another-campaign":  # other bytes, the same readings
                        data = data + "\n" if data.startswith("HEADER") else "# accepted\n" + data
                    (folder / name).write_text(data, newline="")
        cls.night()
        for finding in cls.cases:  # all its findings are accepted, also others that the slip causes
            manifest = cls.site / f"{finding}-accepted" / "campaign.toml"
            doubts = cls.doubts(f"{finding}-accepted")
            manifest.write_text(manifest.read_text() + "".join(
                f'[[tables.accept]]\nfinding = "{d}"\nreason = "{REASON}"\n' for d in sorted(doubts)))
        cls.night()

    @classmethod
    def night(cls):
        done = subprocess.run([NONIO, "run", str(cls.site), "--out", str(cls.out), "--quiet"], capture_output=True,
                              text=True, timeout=600)
        assert done.returncode in (0, 1), done.stderr

    @classmethod
    def results(cls, campaign):
        return json.loads((cls.out / campaign / "results.json").read_text())

    @classmethod
    def doubts(cls, campaign):
        return {f["id"] for a in cls.results(campaign)["analyses"] for f in a["findings"]
                if f["id"].startswith("plausibility.")}

    def tables(self, campaign):
        return sorted(f.name for f in (self.out / campaign).iterdir() if f.name.startswith(tuple(CONTROL)))

    def release(self, campaign, reasons, *more):
        given = [*(f"{r}={REASON}" for r in sorted(reasons)), *more]
        done = subprocess.run([NONIO, "certificate", "approve", str(self.site / campaign), "--by", "B. Sample"] +
                              [part for reason in given for part in ("--reason", reason)],
                              capture_output=True, text=True, timeout=300)
        return done.returncode, done.stdout + done.stderr

    def waiting(self):
        """Findings that a person must answer, of each draft."""
        done = subprocess.run([NONIO, "certificate", "approve", str(self.site), "--list", "--json"], capture_output=True,
                              text=True, timeout=300)
        return {d["campaign"]: {f["id"] for f in d["findings"] if f["severity"] == "attention"} for d in json.loads(done.stdout)["drafts"]}

    def numbers(self):
        done = subprocess.run([NONIO, "certificate", "list", str(self.site), "--json"], capture_output=True, text=True, timeout=300)
        return {c["campaign"] for c in json.loads(done.stdout)["certificates"]}

    def test_every_finding_has_a_case(self):
        self.assertEqual(sorted(findings()), sorted(self.cases))

    def test_no_table_before_a_person_says_why(self):
        for finding in self.cases:
            with self.subTest(finding=finding):
                name = f"{finding}-held"
                self.assertEqual(self.results(name)["errors"], [])
                self.assertIn("plausibility." + finding, self.doubts(name))
                self.assertEqual(self.tables(name), [])
                withheld = json.dumps([o["findings"] for o in self.results(name)["outputs"] if "findings" in o] +
                                      [self.results(name)])
                self.assertIn("table.withheld", withheld)
                self.assertIn("plausibility." + finding, withheld)

    def test_tables_with_reasons(self):
        for finding in self.cases:
            with self.subTest(finding=finding):
                name = f"{finding}-accepted"
                content = self.results(name)
                self.assertEqual(content["errors"], [])
                self.assertIn("plausibility." + finding, self.doubts(name))
                self.assertNotIn("table.withheld", json.dumps(content))
                accepted = [f["evidence"].get("accepted") for a in content["analyses"] for f in a["findings"]
                            if f["id"] == "plausibility." + finding]
                self.assertEqual(set(accepted), {REASON})

    def test_no_number_before_a_person_says_why(self):
        never = {"day-to-come", "calibrated-later", "unknown-axis", "readings-all-equal"}  # see below
        waiting, before, drafts = self.waiting(), self.numbers(), []
        for k, finding in enumerate(self.cases):
            with self.subTest(finding=finding):
                name = f"{finding}-accepted"  # accepting the tables does not accept the certificate
                attention, doubt = waiting.get(name, set()), "plausibility." + finding
                if attention:
                    self.assertIn(doubt, attention)
                status, said = self.release(name, attention - {doubt})
                self.assertNotEqual(status, 0, said)
                if not (self.out / name / "certificate-draft.pdf").exists():
                    self.assertIn(finding, never)
                    self.assertIn("certificate.", json.dumps(self.results(name)))
                    continue
                drafts.append((name, attention))
                self.assertIn(doubt, said)
                nothing = ("", " ", "-", "?")
                for reason in nothing if LONG else [nothing[k % len(nothing)]]:
                    self.assertNotEqual(self.release(name, attention - {doubt}, f"{doubt}={reason}")[0], 0)
        self.assertEqual(self.numbers(), before)
        for name, attention in drafts if LONG else drafts[::6]:
            with self.subTest(name):
                status, said = self.release(name, attention)
                self.assertEqual(status, 0, said)
                self.assertIn(name, self.numbers())


if __name__ == "__main__":
    if shutil.which("openssl") is None:
        print("skipped: no openssl program")
        sys.exit(77)
    unittest.main()
