# SPDX-License-Identifier: Apache-2.0
"""nonio check --only-templates: a site's own templates, laid over the installed ones."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

NONIO = os.environ["NONIO"]
INSTALLED = pathlib.Path(NONIO).resolve().parents[1] / "share" / "nonio" / "templates"


class TemplateCheck(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-templates-")
        self.addCleanup(folder.cleanup)
        self.site = pathlib.Path(folder.name)

    def change(self, name, old, new):
        text = (INSTALLED / name).read_text(encoding="utf-8")
        self.assertIn(old, text)
        path = self.site / "templates" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    def check(self):
        done = subprocess.run([NONIO, "check", "--only-templates", "--json", self.site], capture_output=True, text=True, timeout=60)
        answer = json.loads(done.stdout) if done.stdout else None
        return done, answer

    def complaint(self):
        done, answer = self.check()
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(len(answer["errors"]), 1, answer)
        return answer["errors"][0]["file"] + ": " + answer["errors"][0]["message"]

    def test_what_is_installed_is_whole(self):
        done, answer = self.check()
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertEqual(answer["outputs"], ["certificate", "pdf-report"])

    def test_words(self):
        self.change("words/it/certificate.toml", "{number} del", "{numero} del")
        self.assertIn("words/it/certificate.toml: the places in braces of \"amendment.replaces\"", self.complaint())

    def test_a_letter_that_the_fonts_lack(self):
        self.change("words/zh/results.toml", 'tolerance = "', 'tolerance = "\U0001f600')
        self.assertIn("words/zh/results.toml: results.tolerance", self.complaint())

    def test_a_missing_key(self):
        self.change("words/de/certificate.toml", "received = ", "empfangen = ")
        done, answer = self.check()
        self.assertEqual(done.returncode, 1)
        self.assertEqual(["missing" in e["message"] for e in answer["errors"]], [True, False], answer)

    def test_layout(self):
        self.change("certificate.toml", '"statements", ', "")
        self.assertIn("certificate.toml: the key \"blocks\" lacks \"statements\"", self.complaint())
        self.change("certificate.toml", "plots_per_row = 2", "plots_per_row = 9")
        self.assertIn("plots_per_row", self.complaint())

    def test_a_file_that_is_no_toml(self):
        (self.site / "templates").mkdir()
        (self.site / "templates" / "certificate.toml").write_text("blocks = [\n")
        done, _ = self.check()
        self.assertEqual(done.returncode, 2)
        self.assertIn("certificate.toml", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
