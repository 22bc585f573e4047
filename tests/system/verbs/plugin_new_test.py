# SPDX-License-Identifier: Apache-2.0
"""nonio plugin new: what it refuses. What it writes is built and run by the test docs.howto-plugin."""
import os
import pathlib
import subprocess
import tempfile
import unittest

NONIO = os.environ["NONIO"]


class PluginNew(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="nonio-plugin-new-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refusal(self, kind, name):
        """Its message; nothing may have been written."""
        before = sorted(self.folder.rglob("*"))
        done = subprocess.run([NONIO, "plugin", "new", kind, name], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        self.assertEqual(sorted(self.folder.rglob("*")), before)
        return done.stderr

    def test_nothing_is_written_over_what_is_there(self):
        (self.folder / "my-page").mkdir()
        self.assertIn("my-page exists", self.refusal("output", "my-page"))

    def test_a_wrong_kind_is_answered_with_the_right_one(self):
        self.assertIn('"output"', self.refusal("outptu", "another"))

    def test_a_name_that_no_program_takes(self):
        self.assertIn("expected small letters", self.refusal("output", "My Page"))


if __name__ == "__main__":
    unittest.main()
