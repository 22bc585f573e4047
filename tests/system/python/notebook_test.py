# SPDX-License-Identifier: Apache-2.0
"""The notebooks of samples: every code cell runs in its order, and prints what the file shows.

notebook_test.py [--update]   --update writes what the cells print into the files"""
import contextlib
import io
import json
import os
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
UPDATE = "--update" in sys.argv and not sys.argv.remove("--update")


def printed(cells):
    """(cell, its output) of each code cell; all of them share one namespace, as in Jupyter."""
    names = {}
    for cell in cells:
        if cell["cell_type"] != "code":
            continue
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile("".join(cell["source"]), "cell", "exec"), names)
        yield cell, out.getvalue()


class Notebooks(unittest.TestCase):
    maxDiff = None

    def test_cells_print_what_the_file_shows(self):
        notebooks = sorted((ROOT / "samples/notebooks").glob("*.ipynb"))
        self.assertTrue(notebooks)
        for path in notebooks:
            os.chdir(path.parent)
            notebook = json.loads(path.read_text("utf-8"))
            for number, (cell, out) in enumerate(printed(notebook["cells"]), 1):
                shown = "".join(text for output in cell["outputs"] for text in output.get("text", []))
                if UPDATE:
                    lines = out.splitlines(keepends=True)
                    cell["outputs"] = [{"name": "stdout", "output_type": "stream", "text": lines}] if lines else []
                    cell["execution_count"] = number
                else:
                    self.assertEqual(shown, out, f"{path.name}, code cell {number}")
            if UPDATE:
                path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", "utf-8")


if __name__ == "__main__":
    unittest.main()
