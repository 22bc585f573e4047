# SPDX-License-Identifier: Apache-2.0
"""The certificate of samples/certificates, as a customer gets it: with its own throwaway key, looked at by pdfsig,
openssl, qpdf, xmlsec1, xmllint, pdftotext and `nonio certificate verify`."""
import json
import os
import pathlib
import shutil
import subprocess
import unittest

from programs_test import SCHEMAS, needs, parts
from signing import NONIO, SigningTest, run

SAMPLE = pathlib.Path(__file__).resolve().parents[3] / "samples" / "certificates"


class Certificate(SigningTest):
    def setUp(self):
        super().setUp()
        shutil.rmtree(self.site)
        shutil.copytree(SAMPLE, self.site, ignore=shutil.ignore_patterns("keys", "*.sqlite"))
        run("bash", self.site / "make-key.sh")
        self.root_certificate = self.site / "keys" / "root.pem"
        self.pdf = self.out / "adjusted" / "certificate.pdf"
        self.dcc = self.out / "adjusted" / "certificate.xml"

    def issue(self, *args):
        self.run_nonio(*args, expect=0)
        run(NONIO, "certificate", "approve", self.site / "adjusted", "--by", "B. Sample",
            *(part for finding in self.findings() for part in ("--reason", f"{finding}=as found")))
        return self.pdf

    def findings(self):
        draft, = json.loads(run(NONIO, "certificate", "approve", self.site, "--list", "--json").stdout)["drafts"]
        return sorted({f["id"] for f in draft["findings"] if f["severity"] == "attention"})

    @needs("pdftotext")
    def test_every_page_of_a_draft_says_so(self):
        self.run_nonio(expect=0)
        self.assertFalse(self.pdf.exists())
        pages = run("pdftotext", self.out / "adjusted" / "certificate-draft.pdf", "-").stdout.split("\f")[:-1]
        self.assertGreater(len(pages), 1)
        for page in pages:
            self.assertIn("BOZZA", page)  # head or foot; the mark across it pdftotext reads letter by letter
            self.assertNotIn("S-0001", page)

    def test_it_holds(self):
        answers = {}
        for answer in self.assert_holds(self.issue(), self.dcc):
            answers[pathlib.Path(answer["file"]).suffix] = answer
        for check in ("content.values", "dcc.values", "dcc.signer", "signature.content", "certificate.chain"):
            self.assertEqual(self.state(answers[".pdf"], check), "holds", check)

    @needs("qpdf", "pdfsig", "certutil", "openssl")
    def test_others_accept_it(self):
        pdf = self.issue()
        self.assertIn("No syntax or stream encoding errors found", run("qpdf", "--check", pdf).stdout)
        content, cms = parts(pdf.read_bytes())
        (self.root / "content").write_bytes(content)
        (self.root / "cms").write_bytes(cms)
        run("openssl", "cms", "-verify", "-cades", "-binary", "-inform", "DER", "-in", self.root / "cms", "-content",
            self.root / "content", "-CAfile", self.root_certificate, "-out", "/dev/null")
        base = f"sql:{self.root / 'nss'}"
        (self.root / "nss").mkdir()
        run("certutil", "-N", "-d", base, "--empty-password")
        run("certutil", "-A", "-d", base, "-n", "root", "-t", "CT,C,C", "-i", self.root_certificate)
        said = run("pdfsig", "-nssdir", base, pdf).stdout
        for words in ("Signature is Valid", "Total document signed", "Certificate is Trusted"):
            self.assertIn(words, said)

    @needs("xmlsec1")
    def test_the_dcc_by_itself(self):
        self.issue()
        run("xmlsec1", "--verify", "--trusted-pem", self.root_certificate, "--enabled-reference-uris", "empty,same-doc", self.dcc)

    @needs("xmllint")
    def test_schema(self):
        if not (SCHEMAS / "catalog.xml").exists():
            self.skipTest("NONIO_DCC_SCHEMAS names no folder with the schemas")
        self.issue()
        done = run("xmllint", "--nonet", "--noout", "--schema", SCHEMAS / "dcc/v3.3.0/dcc.xsd", self.dcc, check=False,
                   env={**os.environ, "XML_CATALOG_FILES": str(SCHEMAS / "catalog.xml")})
        self.assertEqual(done.returncode, 0, done.stderr)

    @needs("pdftotext", "pdfdetach")
    def test_what_it_says_and_carries(self):
        pdf = self.issue()
        text = run("pdftotext", "-layout", pdf, "-").stdout
        for words in ("S-0001", "Committente / Customer", "prima della regolazione", "after adjustment", "S-0119 *",
                      "non conforme / does not", "Pagina 1 di", "SP-01 rev. 0"):
            self.assertIn(words, text)
        self.assertIn(self.results("adjusted")["certificate"]["number"], text)
        folder = self.root / "attached"
        folder.mkdir()
        run("pdfdetach", "-saveall", "-o", folder, pdf)
        for name in ("x-before.csv", "x-after.csv", "campaign.toml"):
            self.assertEqual((folder / name).read_bytes(), (self.site / "adjusted" / name).read_bytes())
        self.assertEqual((folder / "certificate.xml").read_bytes(), self.dcc.read_bytes())

    def test_what_is_missing_is_said_and_costs_no_number(self):
        manifest = self.site / "adjusted" / "campaign.toml"
        whole = manifest.read_text()
        manifest.write_text(whole.replace('customer_address = "Via degli Esempi 19, 35100 Padova"\n', "")
                            .replace('serial = "S-0119"\n', "").replace('customer_data = ["machine.serial"]\n', ""))
        self.run_nonio(expect=0)
        self.assertFalse(self.pdf.exists())
        findings = json.dumps(self.results("adjusted"))
        self.assertIn("campaign.customer_address", findings)
        self.assertIn("machine.serial", findings)
        manifest.write_text(whole)
        self.issue()
        self.assertEqual(self.results("adjusted")["certificate"]["number"], "S-0001")

    @needs("pdftotext", "xmllint")
    def test_a_circle(self):
        """Its values and its path on the first page, its causes by their symbols; in the DCC each value has a name."""
        shutil.rmtree(self.site / "adjusted")
        folder = self.site / "40-circles"
        shutil.copytree(SAMPLE.parent / "site" / "40-circles", folder)
        manifest = folder / "campaign.toml"
        text = manifest.read_text()
        for old, more in (('customer = "Esempio Quaranta S.r.l."', 'customer_address = "Via degli Esempi 40, 35100 Padova"'),
                          ('serial = "S-0140"', 'description = "Vertical machining centre"\ncondition = "In use"'),
                          ("drift_um = 0.8", '[certificate]\ncustomer_data = ["machine.serial"]\nconditions = "20.1 to 20.4 degC"')):
            self.assertIn(old, text)
            text = text.replace(old, f"{old}\n{more}")
        manifest.write_text(text + 'outputs = ["json", "certificate"]\n')
        self.run_nonio(expect=0)
        run(NONIO, "certificate", "approve", folder, "--by", "B. Sample",
            *(part for finding in self.findings() for part in ("--reason", f"{finding}=as found")))
        pdf, dcc = (self.out / "40-circles" / f"certificate.{kind}" for kind in ("pdf", "xml"))
        pages = run("pdftotext", "-layout", pdf, "-").stdout.split("\f")
        for words in ("G ccw", "G b", "17,8", "C0Y", "Percorso circolare", "/ Circular path"):
            self.assertIn(words, pages[0])
        for words in ("conforme / conforms", "non conforme / does not"):
            self.assertIn(words, pages[0])
        self.assertEqual(pages[1].count("1000 mm/min"), 2)  # once in each language
        for words in ("Cause, ciascuna da sola / Causes, each alone", "servo mismatch  ", "Inversione di X / Reversal of X"):
            self.assertIn(words, pages[1] + pages[2])
        names = {v: run("xmllint", "--xpath", f"string(//*[local-name()='quantity'][.//*[local-name()='content']='{v}'])", dcc).stdout
                 for v in ("G_b", "B_X", "lateral_Y", "bow_EYX", "cyclic_X", "centre_X", "spike_Y")}
        for value, words in (("G_b", "Bidirectional circular deviation"), ("B_X", "Reversal of X"), ("lateral_Y", "Lateral play of Y"),
                             ("bow_EYX", "Bow EYX over the diameter"), ("cyclic_X", "Cyclic error of X, amplitude"),
                             ("centre_X", "Least-squares centre, X"), ("spike_Y", "Reversal spike of Y")):
            self.assertIn(words, names[value])
        self.assert_holds(pdf, dcc)
        if (SCHEMAS / "catalog.xml").exists():
            done = run("xmllint", "--nonet", "--noout", "--schema", SCHEMAS / "dcc/v3.3.0/dcc.xsd", dcc, check=False,
                       env={**os.environ, "XML_CATALOG_FILES": str(SCHEMAS / "catalog.xml")})
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_changed_page_is_seen(self):
        pdf = self.issue().read_bytes()
        at = pdf.index(b"stream\r\n") + 40
        changed = self.root / "changed.pdf"
        changed.write_bytes(pdf[:at] + bytes([pdf[at] ^ 1]) + pdf[at + 1:])
        done = subprocess.run([NONIO, "certificate", "verify", "--site", self.site, changed], capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 1, done.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)
