# SPDX-License-Identifier: Apache-2.0
"""A campaign that deviates from its method: either the certificate states it, or no certificate is made."""
import json
import pathlib
import re
import shutil
import unittest

from programs_test import needs
from signing import SigningTest, run

SAMPLE = pathlib.Path(__file__).resolve().parents[3] / "samples" / "certificates"
NOTHING = "othing was added to the method"
STANDARD = "ISO 230-2:2014, accuracy"
ZEROS = ("U_fixed_um", "U_per_m_um", "misalignment_mm", "temperature_range_K", "temperature_difference_K",
         "expansion_range_um_per_m_K", "drift_um")
# How the test was made: these keys are optional.
HOW = r"(?m)^(?:warm_up|sensors|feed_mm_per_min|dwell_s|over_travel_mm|at|tool_offset|workpiece_offset|compensation) = .*\n"


def same(x):
    return x


def put(key, value):
    def change(text):
        assert re.search(rf"(?m)^{key} = ", text), key
        return re.sub(rf"(?m)^{key} = .*$", lambda _: f"{key} = {value}", text)
    return change


@needs("pdftotext")
class Paper(SigningTest):
    """One campaign per case, of which only the state after the adjustment is checked; all in one run."""

    def setUp(self):
        super().setUp()
        shutil.rmtree(self.site)
        shutil.copytree(SAMPLE, self.site, ignore=shutil.ignore_patterns("keys", "*.sqlite", "adjusted"))
        run("bash", self.site / "make-key.sh")
        self.site_text(lambda text: text.replace('["it", "en"]', '["en"]'))

    def site_text(self, change):
        path = self.site / "site.toml"
        path.write_text(change(path.read_text("utf-8")), "utf-8")

    def made(self, name, change=same, rows=same, material=None):
        folder = self.site / name
        shutil.copytree(SAMPLE / "adjusted", folder)
        text = (folder / "campaign.toml").read_text("utf-8").replace('id = "adjusted"', f'id = "{name}"')
        head, _, after = text.split("[[measurement]]\n")
        text = re.sub(HOW, "", head + "[[measurement]]\n" + after.replace('adjustment = "after"\n', ""))
        (folder / "campaign.toml").write_text(change(text), "utf-8")
        (folder / "x-before.csv").unlink()
        lines = (folder / "x-after.csv").read_text("utf-8").splitlines()
        table = rows([line.split(",") for line in lines[2:]])
        if material is not None:
            table = [[*row[:4], material, *row[5:]] for row in table]
        # Each its own readings: a file that two campaigns share is a doubt of its own.
        (folder / "x-after.csv").write_text("\n".join([f"# {name}", lines[1], *(",".join(r) for r in table)]) + "\n", "utf-8")

    def files(self, name, ending):
        return list((self.out / name).glob(f"certificate*.{ending}"))

    def said(self, name):
        paper, = self.files(name, "pdf")
        return re.sub(r"\s+", " ", run("pdftotext", paper, "-").stdout)

    def assert_no_paper(self, name, why):
        self.assertEqual(self.files(name, "pdf") + self.files(name, "xml"), [], name)
        self.assertIn(why, json.dumps(self.results(name)), name)

    def test_a_method_that_was_not_followed(self):
        def drifting(rows):
            return [[r, d, t, f"{float(v) + 0.15 * i:.3f}", *more] for i, (r, d, t, v, *more) in enumerate(rows)]

        def one_side_lost(rows):
            lost = rows[3][2]
            return [row for row in rows if row[1:3] != ["-", lost]]

        def four_at_pitch(rows):
            targets = sorted({row[2] for row in rows}, key=float)[:8:2]
            return [[r, d, f"{100 * (1 + targets.index(t))}", *more] for r, d, t, *more in rows if r in "12" and t in targets]
        self.made("plain")
        self.made("left-out", lambda text: text + '\n[options.iso230-2]\nincomplete_targets = "leave-out"\n'
                  '[options.vdi-dgq-3441]\nincomplete_targets = "leave-out"\n', one_side_lost)
        self.made("short", rows=four_at_pitch)
        self.made("drifting", rows=drifting)
        self.made("one-direction", rows=lambda rows: [row for row in rows if row[1] == "+"])
        self.made("excluded", lambda text: text + "exclude = [20, 21, 22]\n")
        self.made("excluded-why", lambda text: text + 'exclude = [20, 21, 22]\nexclude_reason = "beam interrupted"\n')
        self.run_nonio()
        for name in ("plain", "left-out", "short", "drifting", "one-direction", "excluded-why"):
            with self.subTest(name):
                self.assertNotIn(NOTHING, self.said(name))
        self.assertIn(STANDARD, self.said("plain"))
        for words in ("Evaluated: 8 of 9 targets.", "1 of 9 targets were left out"):
            self.assertIn(words, self.said("left-out"))
        for words in ("requires 5", "whole multiples of 10 mm apart", "non-standard test plan"):
            self.assertIn(words, self.said("short"))
        self.assertNotIn(STANDARD, self.said("short"))
        self.assertNotIn(STANDARD, self.said("left-out"))
        self.assertIn("non-standard test plan", self.said("left-out"))
        self.assertIn("drifted by", self.said("drifting"))
        self.assertIn("Approached in direction + only.", self.said("one-direction"))
        self.assertNotIn(STANDARD, self.said("one-direction"))
        self.assert_no_paper("excluded", "exclude_reason")
        self.assertIn("Reason: beam interrupted", self.said("excluded-why"))
        self.assertIn("line 20", self.said("excluded-why"))

    def test_what_names_nothing(self):
        for i, serial in enumerate((" ", "-", "\u2014", "?")):
            self.made(f"serial-{i}", put("serial", f'"{serial}"'))
        self.run_nonio()
        for i in range(4):
            with self.subTest(i):
                self.assert_no_paper(f"serial-{i}", "machine.serial")

    def test_no_decision_without_an_uncertainty(self):
        def zeros(text):
            for key in ZEROS:
                text = put(key, "0.0")(text)
            return text
        self.made("zeros", zeros)
        self.run_nonio()
        self.assert_no_paper("zeros", "uncertainty.")
        for decided in self.results("zeros")["conformity"]:
            self.assertEqual(decided["decision"], "cannot be decided")

    def test_stated_limits_are_held_against_the_readings(self):
        self.made("cool")
        self.made("hot", material="34.30")
        self.run_nonio()

        def value(name):
            values = next(a["values"] for a in self.results(name)["analyses"] if a["plugin"] == "iso230-2")
            return values["A"]["U"]
        self.assertGreater(value("hot"), 2 * value("cool"))
        # The paper's own U, not only that of the results.
        self.assertIn("14.3", self.said("hot"))
        self.assertNotIn("14.3", self.said("cool"))

    def test_days(self):
        self.made("later", put("calibrated", "2026-04-20"))
        self.made("long-ago", put("calibrated", "2015-01-12"))
        self.made("to-come", lambda text: put("end_date", "2062-04-15")(put("date", "2062-04-14")(text)))
        self.run_nonio()
        for name, why in (("later", "calibrated"), ("to-come", "still to come")):
            with self.subTest(name):
                self.assert_no_paper(name, why)
        # A calibration of long ago is for a person to accept, with a reason.
        self.assertEqual([p.name for p in self.files("long-ago", "pdf")], ["certificate-draft.pdf"])
        self.assertIn("--reason=traceability.calibrated-long-ago=as found", self.release("long-ago"))

    def test_pages_and_dcc_say_the_same(self):
        self.site_text(lambda text: text.replace('["en"]', '["it", "en"]'))
        self.made("both")
        self.run_nonio()
        paper = self.said("both")
        xml, = self.files("both", "xml") or [None]
        if xml is None:  # signed with its number only
            run(*self.release("both"))
            xml, = self.files("both", "xml")
        dcc = xml.read_text("utf-8")
        for words in ("SP-01 rev. 0", "In use; guideways clean", "Padova, hall 2", "SO-2026-0001", "A. Sample"):
            self.assertIn(words, paper)
            self.assertIn(words, dcc)
        for mark in ('lang="it"', 'lang="en"', "basic_temperature", "influenceCondition", "ISO 14253-1:2017"):
            self.assertIn(mark, dcc)
        for kind in ("si:valueExpandedMU", "si:valueExpandedMUXMLList"):
            found = [u for text in re.findall(rf"<{kind}>([^<]*)<", dcc) for u in text.split()]
            self.assertTrue(found, kind)
            for u in found:
                self.assertLessEqual(len(u.replace(".", "").lstrip("0")), 2, f"{kind} {u}")

    @needs("zbarimg", "pdftoppm")
    def test_the_code_is_read_from_paper(self):
        """By another program, from a picture of 300 dots per inch."""
        self.made("plain")
        issued = self.issued("plain")
        self.assertEqual(self.code("plain"), f"{issued['number']}\n{issued['date']}\nSHA-256 {issued['readings_sha256']}")

    @needs("zbarimg", "pdftoppm")
    def test_the_code_opens_the_page_that_verifies(self):
        address = "https://www.example.org/a/verify.html?x=1"
        template = self.site / "templates" / "certificate.toml"
        template.parent.mkdir()
        shipped = (pathlib.Path(__file__).resolve().parents[3] / "templates" / "certificate.toml").read_text("utf-8")
        template.write_text(f'{shipped}\n[verification]\naddress = "{address}"\n', "utf-8")
        self.made("plain")
        issued = self.issued("plain")
        self.assertEqual(self.code("plain"), f"{address}#number={issued['number']}&date={issued['date']}&readings={issued['readings_sha256']}")

    def issued(self, name):
        self.run_nonio()
        run(*self.release(name))
        return self.results(name)["certificate"]

    def code(self, name):
        run("pdftoppm", "-r", "300", "-f", "1", "-l", "1", "-gray", self.out / name / "certificate.pdf", self.root / "page")
        page, = self.root.glob("page*.pgm")
        return run("zbarimg", "--quiet", "--raw", page).stdout.rstrip("\n")

    def release(self, name):
        from signing import NONIO
        draft = json.loads(run(NONIO, "certificate", "approve", self.site / name, "--list", "--json").stdout)["drafts"][0]
        findings = sorted({f["id"] for f in draft["findings"] if f["severity"] == "attention"})
        return [NONIO, "certificate", "approve", self.site / name, "--by", "B. Sample", *(f"--reason={f}=as found" for f in findings)]


if __name__ == "__main__":
    unittest.main(verbosity=2)
