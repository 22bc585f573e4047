# SPDX-License-Identifier: Apache-2.0
"""What run_document.py accepts and refuses."""
import contextlib
import io
import pathlib
import tempfile
import unittest

import run_document


def fails(*lines):
    """What fails in a document of these lines, in one text."""
    with tempfile.TemporaryDirectory(prefix="nonio-runner-") as name, contextlib.redirect_stdout(io.StringIO()):
        folder = pathlib.Path(name) / "here"
        folder.mkdir()
        done = run_document.Run("it.md", "\n".join(lines) + "\n", run_document.Terminal(folder, folder))
        done.all()
        changed = ["changed"] if done.lines != list(lines) else []
        return "\n".join(done.failures + changed)


class RunDocument(unittest.TestCase):
    def test_output_is_compared_byte_for_byte(self):
        self.assertEqual(fails("```console", "$ echo a; echo b >&2", "a", "b", "```"), "")
        self.assertIn("changed", fails("```console", "$ echo a", "A", "```"))
        self.assertIn("changed", fails("```console", "$ echo a", "a", "b", "```"))
        self.assertIn("changed", fails("```console", "before", "$ echo a", "a", "```"))

    def test_output_in_a_list(self):
        self.assertEqual(fails("- so:", "", "  ```console", "  $ echo a; echo; echo b", "  a", "", "  b", "  ```"), "")

    def test_status(self):
        self.assertEqual(fails("```sh", "true", "exit 3  # status 3: three", "```"), "")
        self.assertEqual(fails("```console", "$ exit 3  # status 3", "```"), "")
        self.assertIn("it.md:3: status 1: false", fails("```sh", "true", "false", "```"))
        self.assertIn("status 0", fails("```sh", "true  # status 1", "```"))

    def test_a_line_goes_on_in_the_next(self):
        self.assertEqual(fails("```console", "$ echo a \\", "  b", "a b", "```", "```sh", "test a \\", "  = a", "```"), "")

    def test_the_commands_of_a_document_are_one_terminal(self):
        self.assertEqual(fails("```sh", "mkdir in; cd in; export word='a b'", "```", "text", "```console",
                               '$ basename "$PWD"; echo "$word"', "in", "a b", "```"), "")

    def test_a_block_can_be_a_file_and_the_project_gives_others(self):
        self.assertEqual(fails("<!-- file: in/a.toml -->", "```toml", "a = 1", "```", "<!-- here: b/c.md is README.md -->",
                               "```console", "$ cat in/a.toml; ls b", "a = 1", "c.md", "```"), "")
        self.assertIn("there is no nothing.md", fails("<!-- here: b is nothing.md -->"))

    def test_what_is_not_run_says_so_just_before(self):
        self.assertEqual(fails("<!-- not run: no time -->", "```sh", "false", "```"), "")
        self.assertIn("it.md:1", fails("<!-- not run: no time -->", "text", "```sh", "true", "```"))
        self.assertIn("it.md:1", fails("<!-- not run: no time -->", "<!-- file: a -->", "```toml", "a = 1", "```"))
        for wrong in ("<!-- not-run: no time -->", "<!-- not run -->", "<!-- here: a -->", "<!--"):
            self.assertIn("expected <!--", fails(wrong, "```sh", "true", "```"), wrong)
        self.assertIn("there is no command", fails("<!-- not run: no time -->", "```toml", "a = 1", "```"))

    def test_commands_cannot_hide(self):
        for command in ("nonio run site", "$ ls", "cmake --build x", "15 22 * * *  nonio run x", "sudo systemctl start x",
                        "A=1 python3 x.py", "export A=1", "build/dev/bin/nonio x", "./build-and-run"):
            self.assertIn("looks like a command", fails("```text", "other", command, "```"), command)
            self.assertIn("indented block", fails("text", "", "    " + command), command)
            self.assertIn("indented block", fails("text", "", "\t" + command), command)
            self.assertIn('block of ""', fails("```", command, "```"), command)
            self.assertIn('block of "bash"', fails("~~~bash", command, "~~~"), command)
        self.assertIn("there is no command", fails("```sh", "# only a comment", "```"))
        self.assertIn("there is no command", fails("```console", "nonio run", "```"))
        self.assertIn("no end", fails("```sh", "true"))

    def test_data_are_no_commands(self):
        for line in ("cd = 1", "nonio = 2", "1 2 3 4 5 6", "0 BEGIN PGM", 'file = "x.csv"', "1,+,13.225,-1.671"):
            self.assertEqual(fails("```text", line, "```"), "", line)


if __name__ == "__main__":
    unittest.main()
