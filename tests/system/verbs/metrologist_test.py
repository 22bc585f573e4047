# SPDX-License-Identifier: Apache-2.0
"""The metrologist's path: from an empty folder to a verified certificate, only with commands that a person types. Prompts
are answered on a terminal; the keys that the person writes into a file are counted, and so are the commands."""
import os
import pathlib
import pty
import random
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from verbs import NONIO, readings

if shutil.which("openssl") is None:
    print("skipped: no openssl program")
    sys.exit(77)

PROJECT = pathlib.Path(__file__).resolve().parents[3]
MOST_COMMANDS, MOST_KEYS = 12, 8
SEED = random.randrange(10**6)
# What a person judges and writes into campaign.toml: the line that is offered, and the line that is written.
BY_HAND = [("# misalignment_mm = 1.0", "misalignment_mm = 0.5"), ("# temperature_range_K = 0.2", "temperature_range_K = 0.2"),
           ("# temperature_difference_K = 1.5", "temperature_difference_K = 0.8"),
           ("# expansion_range_um_per_m_K = 1.0", "expansion_range_um_per_m_K = 1.0"), ("# drift_um = 1.0", "drift_um = 0.6"),
           ("# expansion_um_per_m_K = 11.5", "expansion_um_per_m_K = 11.5"),
           ("# tolerance_um = { A = 15.0, B = 6.0 }", "tolerance_um = { A = 20.0, B = 12.0 }"),
           ("# conditions = \"No cutting for four hours before the test.\"", "conditions = \"No cutting for four hours.\"")]
SITE = {"Laboratory, name": "Sample Laboratory", "Laboratory, address": "Via A 1, Torino", "Country (two letters)": "IT",
        "Person who approves certificates": "B. Sample", "Key that signs certificates": "keys/lab.p12",
        "File with the password": "keys/password", "PEM file with the root": "keys/root.pem"}
CAMPAIGN = {"Customer": "Esempio Uno S.p.A.", "Operator": "A. Sample", "Machine, maker": "Sample Machines", "Machine, model": "VM 1",
            "Machine, serial number": "S-0001", "Instrument, model": "Laser interferometer", "Axes with their travel": "X=0:400",
            "File of axis X": "x.csv", "Customer, address": "Via B 2, Padova", "Location of the machine": "Padova",
            "Instrument, maker": "Sample Optics", "Instrument, serial number": "L-001", "Instrument, day of its calibration": "2026-01-12",
            "Instrument, number of its calibration": "SO-1", "fixed part": "0.1", "part per metre": "0.5"}


def plain(line):
    """A command without its options."""
    return re.split(r" --| [|\\#]", line)[0].strip()


def commands_of_the_page():
    """Of docs/tutorial-first-certificate.md; there options take the place of prompts and editor."""
    page = (PROJECT / "docs/tutorial-first-certificate.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```(?:sh|console)\n(.*?)^```", page, re.M | re.S)
    return [plain(line) for block in blocks for line in re.findall(r"^(?:\$ )?((?:bash|nonio) .*)$", block, re.M)]


class Path(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="nonio-path-")
        self.folder = pathlib.Path(self._folder.name)
        self.addCleanup(self._folder.cleanup)
        self.commands, self.answers = [], 0
        print(f"seed {SEED}")
        (self.folder / "x.csv").write_text(readings(seed=SEED, runs=5, backlash=-6.0))
        (self.folder / "make-key.sh").write_text((PROJECT / "samples/certificates/make-key.sh").read_text())

    def type(self, line, answers=None, expect=(0,)):
        """A command as a person types it; `answers`: to prompts, by how they begin. What it prints."""
        self.commands.append(line)
        words = [NONIO if word == "nonio" else word for word in shlex.split(line)]
        environment = {**os.environ, "NONIO_ALLOW_ROOT": "1", "TERM": "dumb"}
        if answers is None:
            done = subprocess.run(words, cwd=self.folder, env=environment, capture_output=True, text=True, timeout=300)
            self.assertIn(done.returncode, expect, f"{line}\n{done.stdout}{done.stderr}")
            return done.stdout
        process, terminal = pty.fork()
        if process == 0:
            os.chdir(self.folder)
            os.execve(words[0], words, environment)
        said, left = "", dict(answers)
        while True:
            try:
                part = os.read(terminal, 4096).decode()
            except OSError:
                break
            if not part:
                break
            said += part
            if said.endswith(": "):
                asked = said.split("\n")[-1]
                # The longest beginning that fits: "Customer, address" is not "Customer".
                known = sorted((q for q in left if q in asked), key=len)
                if known:
                    self.answers += 1
                os.write(terminal, ((left.pop(known[-1]) if known else "") + "\n").encode())
        status = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
        self.assertEqual(({}, 0), (left, status), said)
        return said

    def edit(self, path, lines):
        """As in an editor: a key is written in place of the offered one, with the header of its table."""
        self.commands.append(f"$EDITOR {path}")
        text = (self.folder / path).read_text()
        for offered, written in lines:
            self.assertEqual(1, text.count(offered), offered)
            text = text.replace(offered, written)
        for table in ("environment", "certificate"):
            text = text.replace(f"# [{table}]\n", f"[{table}]\n")
        (self.folder / path).write_text(text)

    def test_from_an_empty_folder_to_a_verified_certificate(self):
        self.type("bash make-key.sh")
        self.type("nonio new site lab --empty", SITE)
        self.type("nonio new campaign lab/first", CAMPAIGN)
        self.edit("lab/first/campaign.toml", BY_HAND)
        self.assertIn("no error", self.type("nonio check lab"))
        self.type("nonio run lab --out out")
        self.assertIn("conforms", self.type("nonio show out/first"))
        self.assertTrue((self.folder / "out/first/certificate-draft.pdf").is_file())
        # Each finding that the person has read gets a reason.
        found = re.findall(r"warning +(\S+: \S+)", self.type("nonio certificate approve lab --list"))
        self.assertIn("X: reversal.lost-motion", found)
        reasons = " ".join(f'--reason "{finding}=as found"' for finding in found)
        self.assertIn("issued for first", self.type(f'nonio certificate approve lab/first --by "B. Sample" {reasons}'))
        # 3: valid; a throwaway key has neither time stamp nor revocation list.
        self.assertIn("VALID", self.type("nonio certificate verify out/first/certificate.pdf --site lab", expect=(0, 3)))
        self.assertEqual([plain(line) for line in self.commands if not line.startswith("$EDITOR")], commands_of_the_page())
        keys = len(BY_HAND)
        print(f"{len(self.commands)} commands, {keys} keys typed by hand, {self.answers} answers to prompts")
        self.assertLessEqual(len(self.commands), MOST_COMMANDS, self.commands)
        self.assertLessEqual(keys, MOST_KEYS)

    def test_nothing_is_asked_twice(self):
        self.type("bash make-key.sh")
        self.type("nonio new site lab --empty", SITE)
        self.type("nonio new campaign lab/first", CAMPAIGN)
        again = {q: a for q, a in CAMPAIGN.items() if not q.startswith("Instrument,") or q == "Instrument, model"}
        del again["fixed part"], again["part per metre"]
        said = self.type("nonio new campaign lab/second", again)
        self.assertIn("Instrument, serial number [L-001]: ", said)
        blocks = [(self.folder / "lab" / c / "campaign.toml").read_text().split("[instrument]")[1].split("[[sensor]]")[0]
                  for c in ("first", "second")]
        self.assertEqual(*blocks)

    def test_without_a_terminal_keys_are_given_as_options(self):
        site = 'nonio new site lab --empty --laboratory L --address A --country IT --set laboratory.authoriser="B. Sample"'
        self.type(site)
        text = (self.folder / "lab/site.toml").read_text()
        self.assertIn('\nauthoriser = "B. Sample"', text)
        self.assertIn("\n# [signing]", text)
        self.type("nonio new campaign lab/first --defaults --set environment.drift_um=0.5 --set campaign.site=Padova")
        text = (self.folder / "lab/first/campaign.toml").read_text()
        self.assertIn("\n[environment]\n", text)
        self.assertIn("\ndrift_um = 0.5 ", text)
        self.assertIn('\nsite = "Padova"', text)
        self.type("nonio new campaign lab/second --defaults --set environment.drift=0.5", expect=(2,))
        self.type("nonio new campaign lab/third --defaults --set environment.drift_um=half", expect=(2,))
        self.assertEqual(["first", "site.toml"], sorted(p.name for p in (self.folder / "lab").iterdir()))


if __name__ == "__main__":
    unittest.main()
