# SPDX-License-Identifier: Apache-2.0
"""Campaigns with hidden effects (bench/hidden.cpp, fixed seeds), solved by following only the suggestions of the page: the
same model and the same verdict as `nonio model explain --auto`."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from live import Server, json_of, nonio

HIDDEN = {"one": 8, "several": 4, "complete": 3, "outside": 2, "day-wave": 3}


class Hidden(unittest.TestCase):
    def by_suggestion(self, folder):
        """Model and verdict, and how often the suggestion was taken."""
        with Server(folder) as server:
            server.opened()
            for taken in range(20):
                state = server.until("/api/state", lambda s: "job" not in s, "settled")
                before = state["model"]
                server.post("/api/suggest", expect=None)
                state = server.until("/api/state", lambda s: "job" not in s, "suggested")
                if state["model"] == before:
                    verdict = server.explained(state["parts"][0]["name"])["explain"]["verdict"]
                    return before, verdict, taken
        raise AssertionError(f"{folder}: no end")

    def test_who_takes_each_suggestion_ends_where_auto_ends(self):
        with tempfile.TemporaryDirectory(prefix="nonio-hidden-") as scratch:
            site = pathlib.Path(scratch)
            for kind, count in HIDDEN.items():
                subprocess.run([os.environ["NONIO_HIDDEN"], kind, str(count), "1", "--write", str(site / kind)], check=True,
                               stdout=subprocess.DEVNULL)
            folders = sorted(p.parent for p in site.glob("*/*/campaign.toml"))
            self.assertEqual(len(folders), sum(HIDDEN.values()))
            found = 0
            for folder in folders:
                with self.subTest(folder.name):
                    model, verdict, taken = self.by_suggestion(folder)
                    nonio("model", "explain", folder, "--auto", expect=None)
                    said = json_of("explain", folder, expect=None)
                    part = said["parts"][0] if "parts" in said else said
                    self.assertEqual(model, part["model"]["effects"])
                    self.assertEqual({k: v for k, v in verdict.items()}, part["verdict"])
                    truth = json.loads(folder.with_name(folder.name + ".truth.json").read_text())
                    found += sorted(model) == sorted(truth["model"] + truth["hidden"])
            # Of twenty; the same seeds, so the same ones each time.
            self.assertGreaterEqual(found, 15)


if __name__ == "__main__":
    unittest.main()
