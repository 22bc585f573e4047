# SPDX-License-Identifier: Apache-2.0
"""An analysis that the program does not know: what of its values is followed, and under which name."""
import sqlite3
import unittest

from nightly import NightTest, PLUGINS


class ForeignTest(NightTest):
    def test_values_in_the_budget_are_followed_by_their_own_names(self):
        self.campaign("a", run='compensation = "off"\n')
        self.run_nonio("--plugin-path", str(PLUGINS / "foreign_analysis"))
        followed = [q for q in self.results("a")["followed"] if q["quantity"].startswith("foreign:")]
        self.assertEqual([(q["quantity"], q["axis"], q["unit"], q["conditions"]) for q in followed],
                         [("foreign:first_deviation", "X", "um", {"compensation": "off"}),
                          ("foreign:C0Y", "X", "um", {"compensation": "off"})])
        with sqlite3.connect(self.out / "history.sqlite") as store:
            names = {name for name, in store.execute("SELECT quantity FROM result WHERE source = 'followed'")}
        self.assertFalse([name for name in names if "squareness" in name])
        self.assertIn("foreign:first_deviation", names)


if __name__ == "__main__":
    unittest.main()
