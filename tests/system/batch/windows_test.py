# SPDX-License-Identifier: Apache-2.0
"""What PCs with Windows leave in a site that they share: line ends, byte-order marks, code pages, files of programs, long paths,
names in capital letters, files that are open or still being copied. docs/howto-windows.md states the same."""
import fcntl
import pathlib
import unittest

from nightly import NightTest


class WindowsTest(NightTest):
    def manifest(self, folder):
        return next(pathlib.Path(folder).glob("campaign.toml"))

    def of_windows(self, folder, encoding="utf-8", mark=b"\xef\xbb\xbf"):
        for path in pathlib.Path(folder).iterdir():
            text = path.read_text().replace("date = ", 'customer = "Societ\u00e0 Rossi"\ndate = ', 1)
            path.write_bytes(mark + text.replace("\n", "\r\n").encode(encoding))

    def status(self, campaign):
        return self.results(campaign)["status"]

    def test_line_ends_and_byte_order_marks_change_nothing(self):
        self.campaign("plain", seed=1)
        self.of_windows(self.campaign("windows", seed=1))
        self.run_nonio(expect=None)
        of = lambda name: [(a["plugin"], a["values"]) for a in self.results(name)["analyses"]]
        self.assertEqual(of("plain"), of("windows"))
        self.assertNotEqual("failed", self.status("windows"))
        self.assertEqual("Societ\u00e0 Rossi", self.results("windows")["campaign"]["customer"])

    def test_an_old_code_page_is_named_with_its_remedy(self):
        self.of_windows(self.campaign("ansi"), "cp1252", b"")
        self.run_nonio(expect=1)
        self.assertIn("save it with the encoding UTF-8, not ANSI", self.results("ansi")["errors"][0]["message"])

    def test_files_of_programs_are_no_campaigns_and_no_readings(self):
        folder = pathlib.Path(self.campaign("a"))
        for place in (self.site, folder):
            for name in ("Thumbs.db", "desktop.ini", "~$x.xlsx", "x.csv.tmp", ".~lock.x.ods#"):
                (place / name).write_bytes(b"\x00\xd0\xcf\x11")
        self.run_nonio(expect=None)
        self.assertNotEqual("failed", self.status("a"))
        self.assertEqual([], [e for e in self.results("a")["errors"]])

    def test_a_manifest_with_another_name_is_named(self):
        for name, other in (("b", "Campaign.TOML"), ("c", "campaign.toml.txt")):
            manifest = self.manifest(self.campaign(name))
            manifest.rename(manifest.parent / other)
        self.campaign("a")
        said = self.run_nonio(expect=None).stderr
        for other in ("b/Campaign.TOML", "c/campaign.toml.txt"):
            self.assertIn(f"{other} is not read: expected a file called campaign.toml", said)

    def test_long_paths_and_letters_with_accents(self):
        folder = pathlib.Path(self.campaign("a"))
        long_ = self.site / ("langer ordner " * 14).strip() / ("Pr\u00fcfung & \u00e8 " * 10).strip()
        long_.mkdir(parents=True)
        folder.rename(long_ / ("tief" * 20))
        self.assertGreater(len(str(next(self.site.rglob("campaign.toml")))), 260)
        self.run_nonio(expect=None)
        self.assertNotEqual("failed", self.status("a"))

    def test_a_file_that_a_program_keeps_locked_is_read(self):
        folder = pathlib.Path(self.campaign("a"))
        files = [open(path, "r+b") for path in folder.iterdir()]
        for file in files:
            fcntl.flock(file, fcntl.LOCK_EX)
            fcntl.lockf(file, fcntl.LOCK_EX)
        self.run_nonio(expect=None)
        for file in files:
            file.close()
        self.assertNotEqual("failed", self.status("a"))

    def test_what_is_still_being_copied_is_evaluated_again(self):
        folder = pathlib.Path(self.campaign("a"))
        readings = next(p for p in folder.iterdir() if p.suffix == ".csv")
        whole = readings.read_bytes()
        readings.write_bytes(whole[:len(whole) // 2])
        self.run_nonio(expect=None)
        half = self.results("a")
        readings.write_bytes(whole)
        self.run_nonio(expect=None)
        self.assertNotEqual(half["analyses"], self.results("a")["analyses"])
        self.assertNotEqual("failed", self.status("a"))


if __name__ == "__main__":
    unittest.main()
