# SPDX-License-Identifier: Apache-2.0
"""A reader of DCCs that follows only the conventions of Good Practice: it finds values by their refTypes (results, measured
and nominal values), and their units and U as D-SI has them. What it finds are the results of the run."""
import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

try:
    from lxml import etree
except ImportError:  # the same for what is used here
    import xml.etree.ElementTree as etree

NONIO = os.environ["NONIO"]
SAMPLES = pathlib.Path(os.environ["NONIO_SAMPLES"])
SPACES = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}
# Of D-SI, written down here and not taken from the program.
UNITS = {r"\micro\metre": "um", r"\milli\metre": "mm", r"\degree": "deg", r"\arcsecond": "arcsec", r"\micro\radian": "urad", r"\one": "",
         r"\micro\metre\metre\tothe{-1}": "um/m"}


def has(element, ref_type):
    return ref_type in element.get("refType", "").split()


def texts(element, path):
    return (element.findtext(path, "", SPACES) or "").split()


def numbers(element, path):
    return [float(text) for text in texts(element, path)]


class Quantity:
    """A si:real, or a si:realListXMLList whose lists have one entry for all values or one for each."""

    def __init__(self, element):
        self.name = element.findtext("dcc:name/dcc:content", "", SPACES)
        real, many = element.find("si:real", SPACES), element.find("si:realListXMLList", SPACES)
        if real is not None:
            self.texts = texts(real, "si:value")
            (self.unit,) = texts(real, "si:unit")
            inside = "si:measurementUncertaintyUnivariate/si:expandedMU/si:"
            self.U, self.k, self.p = (numbers(real, inside + n) for n in ("valueExpandedMU", "coverageFactor", "coverageProbability"))
        else:
            self.texts = texts(many, "si:valueXMLList")
            units = set(texts(many, "si:unitXMLList"))
            assert len(units) == 1
            self.unit = units.pop()
            inside = "si:measurementUncertaintyUnivariateXMLList/si:expandedMUXMLList/si:"
            self.U, self.k, self.p = (self.spread(numbers(many, inside + n)) for n in
                                      ("valueExpandedMUXMLList", "coverageFactorXMLList", "coverageProbabilityXMLList"))
        self.values = [float(text) for text in self.texts]
        assert len(self.U) == len(self.k) == len(self.p) and len(self.U) in (0, len(self.values))

    def spread(self, found):
        return found * len(self.texts) if len(found) == 1 else found


def rounding(text):
    """Half of the last digit of a number in a file, with a margin for binary numbers."""
    mantissa, _, exponent = text.lower().partition("e")
    places = len(mantissa.partition(".")[2])
    return 0.5000001 * 10.0 ** (int(exponent or 0) - places)


class Reader(unittest.TestCase):
    def test_values_are_found_by_their_ref_types(self):
        for sample in ("09-tolerances", "14-rotary-table"):
            with tempfile.TemporaryDirectory(prefix="nonio-dcc-") as folder:
                out = pathlib.Path(folder)
                site = out / "site"
                (site / "c").mkdir(parents=True)
                for path in (SAMPLES / sample).iterdir():
                    if path.is_file():
                        (site / "c" / path.name).write_bytes(path.read_bytes())
                (site / "site.toml").write_text('[laboratory]\nname = "L"\ncountry = "IT"\nauthoriser = "B. Sample"\n[options.dcc]\nsign = false\n'
                                                '[run]\noutputs = ["json", "dcc"]\n')
                manifest = site / "c/campaign.toml"
                manifest.write_text("".join(line for line in manifest.read_text().splitlines(True) if not line.startswith("outputs")))
                done = subprocess.run([NONIO, "run", site, "--out", out / "out", "--quiet"], capture_output=True, text=True, check=False)
                self.assertIn(done.returncode, (0, 1), done.stderr)
                (xml,) = (out / "out").glob("*/dcc.xml")
                with_U = self.compare(etree.parse(str(xml)).getroot(), json.loads((xml.parent / "results.json").read_text()))
                self.assertGreater(with_U, 8, sample)

    def compare(self, root, results):
        wanted = [a for a in results["analyses"] if a.get("values")]
        found = [r for r in root.iterfind(".//dcc:result", SPACES) if has(r, "basic_measurementResult")]
        self.assertEqual(len(found), len(wanted))
        self.assertGreater(len(found), 0)
        with_U = 0
        for result, analysis in zip(found, wanted):
            quantities = [Quantity(q) for q in result.iterfind("dcc:data/dcc:quantity", SPACES) if has(q, "basic_measuredValue")]
            self.assertEqual([q.name for q in quantities], list(analysis["values"]))
            for q in quantities:
                value = analysis["values"][q.name]
                self.assertEqual(UNITS[q.unit], value["unit"])
                self.assertLessEqual(abs(q.values[0] - value["value"]), rounding(q.texts[0]))
                if q.U:
                    with_U += 1
                    # Two significant digits, and the place of the value.
                    self.assertLessEqual(abs(q.U[0] - value["U"]), rounding(q.texts[0]), (q.name, q.U, value))
                    self.assertLessEqual(abs(q.U[0] - value["U"]), max(0.06 * value["U"], 0.6e-9), q.name)
                    self.assertEqual((q.k[0], q.p[0]), (value.get("k", 2), 0.95))
            for listed in result.iterfind("dcc:data/dcc:list", SPACES):
                self.compare_list(listed, analysis)
        return with_U

    def compare_list(self, listed, analysis):
        elements = listed.findall("dcc:quantity", SPACES)
        (nominal,) = (Quantity(q) for q in elements if has(q, "basic_nominalValue"))
        self.assertIn(UNITS[nominal.unit], ("mm", "deg"))
        for column in (Quantity(q) for q in elements if has(q, "basic_measuredValue")):
            self.assertEqual(len(column.values), len(nominal.values), column.name)
            if column.name not in (analysis.get("points") or [{}])[0]:
                continue
            points = {round(p["target"], 6): p[column.name] for p in analysis["points"] if column.name in p and p[column.name] is not None}
            for at, text in zip(nominal.values, column.texts):
                self.assertLessEqual(abs(float(text) - points[round(at, 6)]), rounding(text) + 1e-9, (column.name, at))
            self.assertTrue(all(math.isfinite(u) and u > 0 for u in column.U), column.name)


if __name__ == "__main__":
    unittest.main()
