#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which sources the clang-tidy gate reads: scripts/check-tidy --list in repositories made for it."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "check-tidy"


class Gate(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.root)
        (self.root / "scripts").mkdir()
        shutil.copy(PROGRAM, self.root / "scripts")
        self.write("engine/a/include/nonio/own.h", "int own();\n")
        self.write("engine/a/src/own.cpp", '#include "nonio/own.h"\n')
        self.write("engine/a/src/user.cpp", "#include <nonio/own.h>\n")
        self.write("engine/a/include/nonio/only.h", '#include "nonio/own.h"\n')
        self.write("tests/unit/only_test.cpp", '#include "nonio/only.h"\n')
        self.write("bench/speed.cpp", "int main() {}\n")

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def git(self, *arguments):
        identity = ["-c", "user.name=t", "-c", "user.email=t@localhost", "-c", "init.defaultBranch=main"]
        subprocess.run(["git", *identity, *arguments], cwd=self.root, check=True, capture_output=True)

    def begin(self):
        self.git("init")
        self.commit("one")

    def commit(self, word):
        self.git("add", "-A")
        self.git("commit", "-m", word)

    def listed(self, *arguments):
        environment = {**os.environ, "GIT_CEILING_DIRECTORIES": str(self.root.parent)}
        done = subprocess.run([self.root / "scripts" / "check-tidy", "--list", *arguments], check=True,
                              capture_output=True, text=True, env=environment)
        *sources, word = done.stdout.splitlines()
        return [s for s in sources if s], word

    def test_a_branch_is_held_against_main(self):
        self.begin()
        self.git("checkout", "-b", "work")
        self.write("bench/speed.cpp", "int main() { return 0; }\n")
        self.commit("two")
        self.assertEqual(self.listed(), (["bench/speed.cpp"], "tidy: against main, 1 sources"))

    def test_what_is_not_committed_is_read_too(self):
        self.begin()
        self.write("engine/a/src/new.cpp", "int x;\n")
        self.assertEqual(self.listed()[0], ["engine/a/src/new.cpp"])

    def test_a_header_is_read_through_the_source_of_its_name(self):
        self.begin()
        self.write("engine/a/include/nonio/own.h", "int own(int);\n")
        self.assertEqual(self.listed()[0], ["engine/a/src/own.cpp"])

    def test_a_header_without_one_is_read_through_a_source_that_includes_it(self):
        self.begin()
        self.write("engine/a/include/nonio/only.h", "int only();\n")
        self.assertEqual(self.listed()[0], ["tests/unit/only_test.cpp"])

    def test_a_file_that_only_moved_is_not_read_and_one_that_moved_and_changed_is(self):
        text = "".join(f"int f{i}();\n" for i in range(30))
        self.write("engine/a/src/long.cpp", text)
        self.begin()
        self.git("checkout", "-b", "work")
        self.git("mv", "engine/a/src/user.cpp", "engine/a/src/moved.cpp")
        self.git("mv", "engine/a/src/long.cpp", "engine/a/src/longer.cpp")
        self.write("engine/a/src/longer.cpp", text + "int g();\n")
        self.commit("two")
        self.assertEqual(self.listed()[0], ["engine/a/src/longer.cpp"])

    def test_on_main_itself_the_last_commit_is_read(self):
        self.begin()
        self.write("bench/speed.cpp", "int main() { return 0; }\n")
        self.commit("two")
        self.assertEqual(self.listed(), (["bench/speed.cpp"], "tidy: the last commit, 1 sources"))

    def test_without_history_nothing_is_read_and_the_reason_is_printed(self):
        for begin, word in ((lambda: None, "no git history"), (self.begin, "no earlier commit")):
            begin()
            sources, said = self.listed()
            self.assertEqual(sources, [])
            self.assertIn(word, said)
            self.assertIn("--all", said)

    def test_all_reads_tests_and_benches_too(self):
        self.begin()
        self.assertEqual(self.listed("--all")[0], ["bench/speed.cpp", "engine/a/src/own.cpp", "engine/a/src/user.cpp",
                                                   "tests/unit/only_test.cpp"])

    def test_a_commit_that_is_not_there_is_an_error(self):
        self.begin()
        with self.assertRaises(subprocess.CalledProcessError):
            self.listed("--since", "nowhere")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
