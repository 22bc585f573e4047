# SPDX-License-Identifier: Apache-2.0
"""What Nonio signs, looked at by pdfsig, openssl, qpdf, xmlsec1, xmllint; and a key in a SoftHSM token."""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

from signing import PASSWORD, SigningTest, run

# Folder with catalog.xml and dcc/v3.3.0/dcc.xsd; the schemas are not part of the project.
SCHEMAS = pathlib.Path(os.environ.get("NONIO_DCC_SCHEMAS", "/nonexistent"))


def needs(*programs):
    missing = [p for p in programs if shutil.which(p) is None]
    return unittest.skipIf(missing, "not installed: " + ", ".join(missing))


def parts(pdf):
    """The bytes of a PDF that are signed, and the signature."""
    a, b, c, d = map(int, re.search(rb"/ByteRange \[(\d+) (\d+) (\d+) (\d+)\]", pdf).groups())
    return pdf[a:b] + pdf[c:c + d], bytes.fromhex(pdf[b + 1:c - 1].decode())


class Programs(SigningTest):
    def signed(self, kind="P-256", **kwargs):
        keys = self.keys(kind=kind)
        self.site_toml(keys, **kwargs)
        self.signed_campaign("c1")
        self.run_nonio(expect=0)
        return keys, self.out / "c1" / "report.pdf"

    @needs("qpdf")
    def test_qpdf(self):
        _, report = self.signed()
        self.assertIn("No syntax or stream encoding errors found", run("qpdf", "--check", report).stdout)

    def test_openssl(self):
        for kind in ("P-256", "RSA-3072"):
            keys, report = self.signed(kind)
            content, cms = parts(report.read_bytes())
            (self.root / "content").write_bytes(content)
            (self.root / "cms").write_bytes(cms)
            run("openssl", "cms", "-verify", "-cades", "-binary", "-inform", "DER", "-in", self.root / "cms", "-content",
                self.root / "content", "-CAfile", keys.ca, "-out", "/dev/null")
            printed = run("openssl", "cms", "-cmsout", "-print", "-inform", "DER", "-in", self.root / "cms").stdout
            self.assertIn("signingCertificateV2", printed)
            self.assertNotIn("signingTime", printed)
            shutil.rmtree(self.out)

    @needs("pdfsig", "certutil")
    def test_pdfsig(self):
        keys, report = self.signed("RSA-3072")
        data_base = self.root / "nss"
        data_base.mkdir()
        run("certutil", "-N", "-d", f"sql:{data_base}", "--empty-password")
        run("certutil", "-A", "-d", f"sql:{data_base}", "-n", "root", "-t", "CT,C,C", "-i", keys.ca)
        said = run("pdfsig", "-nssdir", data_base, report).stdout
        self.assertIn("Signature is Valid", said)
        self.assertIn("Total document signed", said)
        self.assertIn("Certificate is Trusted", said)
        self.assertIn("ETSI.CAdES.detached", said)

    @needs("pdfdetach")
    def test_attachments(self):
        _, report = self.signed()
        folder = self.root / "attached"
        folder.mkdir()
        run("pdfdetach", "-saveall", "-o", folder, report)
        self.assertEqual((folder / "x.csv").read_bytes(), (self.site / "c1" / "x.csv").read_bytes())
        self.assertEqual((folder / "dcc.xml").read_bytes(), (self.out / "c1" / "dcc.xml").read_bytes())
        self.assertEqual(sorted(p.name for p in folder.iterdir()),
                         ["campaign.toml", "dcc.xml", "results.json", "site-settings.toml", "templates.json", "x.csv"])

    @needs("xmlsec1")
    def test_xmlsec(self):
        for kind in ("P-256", "RSA-3072"):
            keys, report = self.signed(kind)
            dcc = report.parent / "dcc.xml"
            check = ["xmlsec1", "--verify", "--trusted-pem", keys.ca, "--enabled-reference-uris", "empty,same-doc"]
            run(*check, dcc)
            changed = self.root / "changed.xml"
            changed.write_text(dcc.read_text().replace("<si:value>", "<si:value>1", 1))
            self.assertNotEqual(run(*check, changed, check=False).returncode, 0)
            shutil.rmtree(self.out)

    @needs("xmllint")
    def test_schema(self):
        if not (SCHEMAS / "catalog.xml").exists():
            self.skipTest("NONIO_DCC_SCHEMAS names no folder with the schemas")
        _, report = self.signed()
        done = run("xmllint", "--nonet", "--noout", "--schema", SCHEMAS / "dcc/v3.3.0/dcc.xsd", report.parent / "dcc.xml",
                   check=False, env={**os.environ, "XML_CATALOG_FILES": str(SCHEMAS / "catalog.xml")})
        self.assertEqual(done.returncode, 0, done.stderr)

    @needs("softhsm2-util", "pkcs11-tool")
    def test_a_key_in_a_token(self):
        module = next((p for p in map(pathlib.Path, ("/usr/lib/softhsm/libsofthsm2.so",)) if p.exists()), None)
        if module is None:
            self.skipTest("no libsofthsm2.so")
        keys = self.keys()
        tokens = self.root / "tokens"
        tokens.mkdir()
        config = self.root / "softhsm2.conf"
        config.write_text(f"directories.tokendir = {tokens}\nobjectstore.backend = file\nlog.level = ERROR\n")
        environment = {**os.environ, "SOFTHSM2_CONF": str(config)}
        pin = "123456"
        run("softhsm2-util", "--init-token", "--free", "--label", "lab", "--pin", pin, "--so-pin", "5678", env=environment)
        run("openssl", "pkcs8", "-topk8", "-nocrypt", "-in", keys.folder / "ada.key", "-out", keys.folder / "ada.p8")
        run("softhsm2-util", "--import", keys.folder / "ada.p8", "--token", "lab", "--label", "calib", "--id", "01",
            "--pin", pin, env=environment)
        run("openssl", "x509", "-in", keys.folder / "ada.pem", "-outform", "DER", "-out", keys.folder / "ada.der")
        run("pkcs11-tool", "--module", module, "--login", "--pin", pin, "--write-object", keys.folder / "ada.der", "--type",
            "cert", "--id", "01", "--label", "calib", env=environment)
        (keys.folder / "pin").touch(mode=0o600)
        (keys.folder / "pin").write_text(pin)
        self.site_toml(keys, key=f'pkcs11 = "pkcs11:token=lab;object=calib"\nmodule = "{module}"',
                       password=f'password_file = "{keys.folder}/pin"')
        self.signed_campaign("c1")
        self.run_nonio(expect=0, env=environment)
        self.assert_holds(self.out / "c1" / "report.pdf", self.out / "c1" / "dcc.xml")
        (keys.folder / "pin").write_text("654321")
        self.assertIn("wrong PIN", self.run_nonio("--force", expect=1, env=environment).stderr +
                      str(self.summary()["notes"]))


if __name__ == "__main__":
    unittest.main(verbosity=2)
