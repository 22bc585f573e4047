# SPDX-License-Identifier: Apache-2.0
"""A plugin that misbehaves fails its campaign, never the run."""
import os
import pathlib
import shutil
import subprocess
import unittest

from nightly import NONIO, PLUGINS, NightTest, manifest, tree


class Isolation(NightTest):
    def bad(self, kind, how):
        """A campaign whose `kind` of plugin does `how`."""
        run = '[run]\nanalyses = ["iso230-2", "bad-analysis"]\noutputs = ["json", "bad-output"]\n'
        self.campaign(f"{kind}-{how}", run=run, extra=f'[options.bad-{kind}]\nhow = "{how}"\n')
        return f"{kind}-{how}"

    def test_each_misbehaviour_is_one_failed_campaign(self):
        expected = {
            ("analysis", "segfault"): "analysis bad-analysis (measurement X): signal 11",
            ("analysis", "abort"): "signal 6",
            ("analysis", "exit"): "analysis bad-analysis (measurement X): ended the process",
            ("analysis", "loop"): "no end within the limit of 6 s",
            ("analysis", "throw"): "analysis bad-analysis threw an exception: thrown on purpose",
            ("analysis", "throw-int"): "threw an exception of an unknown kind",
            ("analysis", "leak"): "out of memory",
            ("analysis", "nan"): "analysis bad-analysis gave a value A that is not a number",
            ("analysis", "error"): "analysis bad-analysis: an error on purpose",
            ("output", "segfault"): "output bad-output: signal 11",
            ("output", "escape"): 'the file name "../escaped.txt"',
            ("output", "absolute"): 'the file name "/tmp/escaped.txt"',
            ("output", "overwrite"): 'the file name "results.json"',
            ("output", "twice"): 'the file name "a.txt", which is already taken',
        }
        if "NONIO_TEST_NO_MEMORY_LIMIT" in os.environ:
            del expected["analysis", "leak"]
        good_run = '[run]\nanalyses = ["iso230-2"]\noutputs = ["json"]\n'
        for name in ("good-1", "good-2"):
            self.campaign(name, run=good_run)
        (self.site / "site.toml").write_text("[limits]\nseconds = 6\nmemory_MB = 300\n")
        self.run_nonio("--plugin-path", str(PLUGINS / "bad"), expect=0)
        alone = {k: v for k, v in tree(self.out).items() if k.startswith("good") and "run.json" not in k}

        names = {self.bad(*what): words for what, words in expected.items()}
        other = self.root / "other"
        self.run_nonio("--plugin-path", str(PLUGINS / "bad"), out=other, expect=1)
        self.assertEqual(sorted(self.ids("failed", other)), sorted(names))
        self.assertEqual(sorted(self.ids("done", other)), ["good-1", "good-2"])
        for name, words in names.items():
            results = self.results(name, other)
            self.assertEqual(results["status"], "failed")
            self.assertIn(words, results["errors"][0]["message"])
        together = {k: v for k, v in tree(other).items() if k.startswith("good") and "run.json" not in k}
        self.assertEqual(alone, together)
        self.assertFalse([p for p in other.rglob("*") if "escaped" in p.name])
        self.assertFalse(os.path.exists("/tmp/escaped.txt"))

    def test_what_a_reader_gives_is_checked_before_anybody_indexes_by_it(self):
        expected = {
            "line": "reading 2 of line 4000000; expected 0 to 0",
            "no-lines": "readings of no line; expected one line at least",
            "u-zero": "an uncertainty of a reading that is not a number above 0",
            "u-nan": "an uncertainty of a reading that is not a number above 0",
            "approach": "an approach that is none of +1, -1 and 0",
            "sense": "a direction of sensing that is not a number",
            "well": None,
        }
        for how in expected:
            self.campaign(f"reader-{how}", run='[run]\nanalyses = ["iso230-2"]\noutputs = []\n',
                          extra='[[measurement]]\nid = "Y"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n'
                                f'reader = "bad-reader"\n[options.bad-reader]\nhow = "{how}"\n')
        self.run_nonio("--plugin-path", str(PLUGINS / "bad"), expect=1)
        for how, words in expected.items():
            errors = [e["message"] for e in self.results(f"reader-{how}")["errors"]]
            self.assertEqual(errors, [] if words is None else ["reader bad-reader gave " + words], how)

    def test_a_question_that_brings_the_process_down_names_who_was_asked(self):
        run = '[run]\nanalyses = ["iso230-2", "bad-analysis"]\noutputs = ["json", "bad-output"]\n'
        asked = ", asked whether it applies: signal 11"
        expected = {"analysis-asked-segfault": "analysis bad-analysis (measurement X)" + asked,
                    "analysis-asked-throw": "analysis bad-analysis threw an exception: thrown on purpose",
                    "output-asked-segfault": "output bad-output" + asked,
                    "output-asked-throw": "output bad-output threw an exception: thrown on purpose",
                    "reader-segfault": "reader bad-reader (measurement X), asked whether it reads this file: signal 11",
                    "reader-throw": "reader bad-reader threw an exception: thrown on purpose"}
        for name in expected:
            folder = self.campaign(name, run=run)
            if name.startswith("reader"):
                (folder / "x.csv").write_text(f"# asked to {name[7:]}\n" + (folder / "x.csv").read_text())
        self.run_nonio("--plugin-path", str(PLUGINS / "bad"), expect=1)
        for name, words in expected.items():
            self.assertIn(words, self.results(name)["errors"][0]["message"])

    def test_what_lacks_a_function_is_refused_with_its_name(self):
        """Its file with it: half of what it brings would be another plugin than was meant."""
        self.campaign("a")
        plain = self.root / "plain"
        self.run_nonio(out=plain, expect=0)
        done = self.run_nonio("--plugin-path", str(PLUGINS / "incomplete"), expect=0)
        why = "registers the output incomplete without `applies`, a function that every output has"
        self.assertIn("plugin test_incomplete.so " + why, done.stderr)
        self.assertIn("plugin test_incomplete.so " + why, self.summary()["notes"])
        self.assertEqual((self.out / "a/results.json").read_bytes(), (plain / "a/results.json").read_bytes())
        self.campaign("b", run='[run]\noutputs = ["incomplete"]\n')
        self.run_nonio("--plugin-path", str(PLUGINS / "incomplete"), expect=1)
        self.assertIn(why, self.results("b")["errors"][0]["message"])

    @unittest.skipIf("NONIO_TEST_NO_MEMORY_LIMIT" in os.environ, "nothing stops the parser there")
    def test_a_manifest_that_brings_its_parser_down(self):
        (self.site / "site.toml").write_text("[limits]\nmemory_MB = 64\n")
        keys = "".join(f"{i:x}.a=0\n" for i in range(98_000))  # just below 1 MB, the largest that is read
        self.campaign("large", text=manifest("large", extra="[options.iso230-2]\n" + keys))
        for name in "az":
            self.campaign(name)
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("failed"), ["large"])
        self.assertIn("reading campaign.toml", self.results("large")["errors"][0]["message"])
        self.assertEqual(self.ids("done"), ["a", "z"])

    def test_wrong_abi_is_refused_before_any_call(self):
        self.campaign("a")
        done = self.run_nonio("--plugin-path", str(PLUGINS / "wrong_abi"), expect=0)
        self.assertIn('was built for "nonio-sdk 0; another compiler"', done.stderr)

    def test_crash_while_loading_is_refused(self):
        self.campaign("a")
        done = self.run_nonio("--plugin-path", str(PLUGINS / "dies_on_load"), expect=0)
        self.assertIn("did not survive loading: signal 11", done.stderr)

    def test_what_a_refused_reader_would_have_read_has_failed(self):
        """A program without its readers, in whose place is a library of another build."""
        self.campaign("a")
        program = self.root / "program"
        own = pathlib.Path(NONIO).resolve().parents[1]
        shutil.copytree(own / "lib", program / "lib", symlinks=True)
        (program / "bin").mkdir()
        shutil.copy2(NONIO, program / "bin")
        (program / "share").symlink_to(own / "share")
        reader = next(program.rglob("readers.so"))
        reader.unlink()
        shutil.copy(next((PLUGINS / "wrong_abi").glob("*.so")), reader)
        done = subprocess.run([program / "bin" / "nonio", "run", self.site, "--out", self.out],
                              capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 1, done.stderr + done.stdout)
        self.assertEqual(self.ids("failed"), ["a"])
        message = self.results("a")["errors"][0]["message"]
        self.assertIn('no reader takes measurements of kind "axis"', message)
        self.assertIn('readers.so was built for "nonio-sdk 0; another compiler"', message)

    def test_a_refused_plugin_might_have_read_a_file_of_an_unknown_format(self):
        folder = self.campaign("a")
        (folder / "x.csv").write_text("what no reader knows\n")
        self.run_nonio("--plugin-path", str(PLUGINS / "wrong_abi"), expect=1)
        message = self.results("a")["errors"][0]["message"]
        self.assertIn("no reader recognizes the format of this file", message)
        self.assertIn('was built for "nonio-sdk 0; another compiler"', message)

    def test_duplicate_name_names_both_files(self):
        self.campaign("a")
        done = self.run_nonio("--plugin-path", str(PLUGINS / "twin"), expect=2)
        self.assertIn("two plugins are the analysis iso230-2", done.stderr)
        self.assertIn("test_twin.so", done.stderr)
        self.assertIn("analyses.so", done.stderr)


if __name__ == "__main__":
    unittest.main()
