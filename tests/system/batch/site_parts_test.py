# SPDX-License-Identifier: Apache-2.0
"""Every file of a site besides its campaigns, and earlier.json: lost, emptied, cut, swapped, wrong or renamed, one at a time.
Each loss is reported, no table that depended on it is written, nothing else changes, and what is restored or removed on
purpose leaves no trace. NONIO_SITE_MACHINES=60
for a laboratory, NONIO_SITE_ALL=1 for every file of the output folder, NONIO_LONG=1 for every way to be wrong."""
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import unittest

from nightly import NONIO, NightTest, given_out, readings, tree

# They say which night it was, and of which campaigns something was done.
NIGHTLY = {"summary.json", "summary.txt", ".nonio/night.json", ".nonio/machines.sqlite",
           ".nonio/history", ".nonio/site.json", ".nonio/lock", "history.json", "index.html"}
SEED = int(os.environ.get("NONIO_SEED", "41"))
MACHINES = int(os.environ.get("NONIO_SITE_MACHINES", "4"))
LONG = bool(os.environ.get("NONIO_LONG"))
RECORD = """format = 1
asset = "{asset}"
maker = "Mk"
serial = "{serial}"
control = "siemens-840d"
[axes.X]
number = 3
table = "none"
backlash_mm = 0.012
since = 2026-01-01
"""
BROKEN = {
    "syntax": lambda t: t.replace("= 0.012", "= 0.012.3"),
    "unknown key": lambda t: t.replace("backlash_mm", "backlash_mmm"),
    "wrong type": lambda t: t.replace("= 0.012", '= "0.012"'),
    "comma": lambda t: t.replace("= 0.012", "= 0,012"),
    "no asset": lambda t: re.sub("asset = .*\n", "", t),
    "no since": lambda t: re.sub("since = .*\n", "", t),
    "two keys": lambda t: t + "backlash_mm = 0.02\n",
    "open quote": lambda t: t.replace('"Mk"', '"Mk'),
    "empty": lambda t: "",
    "blank": lambda t: "\n\n",
    "cut in a line": lambda t: t[: len(t) // 2],
    "cut before an axis": lambda t: t[: t.index("[axes")],
    "Latin-1": lambda t: t.encode() + b"# M\xfcller\n",
    "UTF-16": lambda t: t.encode("utf-16"),
    "missing": lambda t: None,
}


def put(path, content):
    if content is None:
        path.unlink()
    elif isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(content, encoding="utf-8")


class SiteParts(NightTest):
    def setUp(self):
        super().setUp()
        print(f"NONIO_SEED={SEED}", flush=True)
        self.rng = random.Random(SEED)
        self.parts = {"site.toml": 'language = "en"\n[limits]\nmissing_campaigns = 9\n',
                      "events.toml": 'format = 1\n[[event]]\ndate = 2026-10-01\nmachine = "S-1"\nkind = "crash"\ntext = "hit"\n'
                                     '[[event]]\ndate = 2026-10-02\nmachine = "S-1"\nkind = "repair"\ntext = "nut"\n',
                      "acknowledged.toml": 'format = 1\n[[acknowledged]]\ndate = 2026-10-01\nfinding = "reversal.constant"\n'
                                           'machine = "S-1"\nuntil = 2027-01-01\nby = "B"\nwhy = "nut is ordered"\n',
                      "forgotten.toml": 'format = 1\n[[forgotten]]\ndate = 2026-10-01\ncampaign = "old"\nby = "B"\nwhy = "machine was sold"\n',
                      "causes/own.toml": 'format = 1\n[[cause]]\nname = "own"\ntitle = { en = "Own cause" }\naxis = "linear"\nexpression = "j*run"\n'
                                         'parameters = [{ name = "j", unit = "um" }]\nis = "Counts are lost."\nsize = "1 um"\nappearance = "Stairs"\n'
                                         'similar = "none"\nremedy = "Clean it"\nprior = "rare"\n',
                      "templates/words/en/own.toml": '[a]\nb = "own words"\nc = "more own words"\n'}
        for i in range(MACHINES):
            asset, serial = f"S-{i}", f"m{i}"
            self.parts[f"machines/{asset}.toml"] = RECORD.format(asset=asset, serial=serial)
            named = f'asset = "{asset}"\n' if i % 2 else f'maker = "Mk"\nserial = "{serial}"\n'
            self.campaign(f"c{i}", text=(
                f'format = 1\n[campaign]\nid = "c{i}"\ndate = 2026-11-03\n[machine]\nmodel = "M"\n{named}[machine.axes.X]\n'
                'kind = "linear"\nexpansion_um_per_m_K = 11.5\n[run]\noutputs = ["json", "siemens-840d"]\n'
                '[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n'), seed=i)
        for name, text in self.parts.items():
            (self.site / name).parent.mkdir(parents=True, exist_ok=True)
            (self.site / name).write_text(text)
        self.night("2026-11-10", expect=0)
        self.tables = self.backlash()
        self.assertEqual(len(self.tables), MACHINES, "the parts have tables that depend on them")

    def night(self, date, expect=None):
        return self.run_nonio("--date", date, "--quiet", expect=expect)

    def backlash(self):
        """Of each campaign the value that goes to the control."""
        found = {}
        for p in sorted(self.out.glob("c*/siemens-840d*backlash*")):
            found[p.parent.name] = re.search(r"BACKLASH\[0,AX3\]=(\S+)", p.read_text())[1]
        return found

    def lines(self):
        return [line for line in json.loads((self.out / "summary.json").read_text())["lines"] if line["kind"] in ("lost", "failed")]

    def forget(self, what, date):
        done = subprocess.run([NONIO, "machine", "remove", self.site, what, "--by", "B. Sample", "--why", "no longer used", "--date", date],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_wrong_record_changes_no_value(self):
        """In the first run too, where no earlier copy shows its machine."""
        name = "machines/S-0.toml"
        for fresh in (False, True):
            one_of_each_way = ["empty", "no since", "syntax", "UTF-16"]
            others = sorted(BROKEN.keys() - set(one_of_each_way))
            for what in one_of_each_way + ([] if fresh else others) if LONG else self.rng.sample([*BROKEN], 1 if fresh else 3):
                change = BROKEN[what]
                with self.subTest(what, fresh=fresh):
                    if fresh:
                        shutil.rmtree(self.out)
                    put(self.site / name, change(self.parts[name]))
                    done = self.night("2026-11-11", expect=1)
                    self.assertIn("machines/S-0.toml", done.stderr)
                    tables = self.backlash()
                    self.assertNotIn("c0", tables)
                    if not fresh:
                        self.assertEqual(tables, {c: v for c, v in self.tables.items() if c != "c0"})
                        copy = self.out / ".nonio/site" / name
                        self.assertEqual(copy.read_text(), self.parts[name])
                    for c, value in tables.items():
                        self.assertEqual(value, self.tables[c])
                    self.assertTrue(any("machines/S-0.toml" in line["says"] for line in self.lines()), self.lines())
                    put(self.site / name, self.parts[name])
                    self.night("2026-11-12", expect=0)
                    self.assertEqual(self.backlash(), self.tables)
                    self.assertEqual(self.lines(), [])

    def test_every_part_that_is_lost_is_reported_until_it_is_removed(self):
        before = tree(self.out)
        for name, text in self.parts.items():
            refused = name == "site.toml" or name.startswith("templates/")
            # Records of machines are read by one way: each is lost in another one.
            ways = ("missing", "empty", "cut", "a folder")
            number = int(name[len("machines/S-"):-len(".toml")]) if name.startswith("machines/") else None
            other = ways if LONG else [self.rng.choice(ways)]
            for what in other if number is None else [ways[number % len(ways)]]:
                with self.subTest(name, what=what):
                    path = self.site / name
                    path.unlink()
                    if what == "a folder":
                        path.mkdir()
                    elif what != "missing":
                        path.write_text("" if what == "empty" else text[: text.rstrip().rindex("\n") + 1])
                    done = self.night("2026-11-11")
                    self.assertIn(done.returncode, (1, 2), done.stderr)
                    self.assertIn(name, done.stderr)
                    if refused:
                        self.assertEqual(done.returncode, 2)
                        self.assertEqual(tree(self.out), before)
                    elif done.returncode == 1:
                        self.assertTrue(any(name in line["says"] for line in self.lines()), self.lines())
                        self.assertLessEqual(self.backlash().items(), self.tables.items())
                    if what == "a folder":
                        path.rmdir()
                    path.write_text(text)
                    self.night("2026-11-12", expect=0)
                    self.assertEqual(self.backlash(), self.tables)
                    before = tree(self.out)

    def test_removed_on_purpose(self):
        for day, name in enumerate(("acknowledged.toml", "templates", "machines/S-1.toml", "site.toml"), 11):
            with self.subTest(name):
                path = self.site / name
                shutil.rmtree(path) if path.is_dir() else path.unlink()
                self.assertIn(self.night(f"2026-11-{day}").returncode, (1, 2))
                self.forget(name, f"2026-11-{day}")
                done = self.night(f"2026-11-{day}")
                self.assertNotIn(name + " is missing", done.stderr)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertFalse((self.out / ".nonio/site" / name).is_file())
        (self.site / "acknowledged.toml").write_text(self.parts["acknowledged.toml"])
        self.night("2026-11-15", expect=0)
        (self.site / "acknowledged.toml").unlink()
        self.assertIn("acknowledged.toml is missing", self.night("2026-11-16", expect=1).stderr, "an older entry was for an earlier loss")

    def test_a_missing_folder_is_one_line(self):
        (self.site / "machines").rename(self.site / "Machines")
        done = self.night("2026-11-11", expect=1)
        self.assertIn(f"machines none of its {MACHINES} files exists any more", done.stderr)
        self.assertEqual(self.backlash(), {})
        self.assertEqual(len([line for line in self.lines() if line["kind"] == "lost"]), 1)
        (self.site / "Machines").rename(self.site / "machines")
        self.night("2026-11-12", expect=0)
        self.assertEqual(self.backlash(), self.tables)

    def test_a_renamed_file_is_named(self):
        (self.site / "templates/words/en/own.toml").rename(self.site / "templates/words/en/other.toml")
        self.assertIn("templates/words/en/other.toml has its contents", self.night("2026-11-11", expect=2).stderr)

    def test_an_edit_is_no_loss(self):
        name = "machines/S-0.toml"
        put(self.site / name, self.parts[name].replace("0.012", "0.010"))
        put(self.site / "events.toml", self.parts["events.toml"].replace('text = "hit"\n', 'text = "hit the vice"\n'))
        put(self.site / "site.toml", 'language = "de"\n')
        self.night("2026-11-11", expect=0)
        self.assertNotEqual(self.backlash()["c0"], self.tables["c0"])
        self.assertEqual((self.out / ".nonio/site" / name).read_text(), (self.site / name).read_text())

    def test_the_inventory_itself(self):
        inventory = self.out / ".nonio/site.json"
        contents = (None, "", "{", '{"schema": "nonio-site/1"}',
                    '{"schema": "nonio-site/1", "date": "2026-11-10", "night": 1, "files": {"machines/../../../x": {"sha256": ""}}}')
        for content in contents if LONG else self.rng.sample(contents, 2):
            with self.subTest(content):
                put(inventory, content)
                (self.site / "events.toml").unlink()
                done = self.night("2026-11-11", expect=1)
                self.assertIn("site.json is", done.stderr)
                self.assertIn("events.toml is missing", done.stderr)
                put(self.site / "events.toml", self.parts["events.toml"])
                self.night("2026-11-12", expect=0)

    def test_replaced_results_are_the_only_copy(self):
        (self.site / "c0/x.csv").write_text(readings("other"))
        self.night("2026-11-11", expect=0)
        earlier = self.out / "c0/earlier.json"
        whole = earlier.read_text()
        number = re.search(r'"value": ?(-?\d+\.\d{3})', whole)
        changed = whole[: number.start(1)] + "123.456" + whole[number.end(1):]
        rows = self.rows()
        contents = (None, "", whole[:-1], whole[: len(whole) // 2], changed)
        for content in contents if LONG else (changed, self.rng.choice(contents[:-1])):
            with self.subTest(content and len(content)):
                put(earlier, content)
                done = self.night("2026-11-12", expect=1)
                self.assertIn("earlier.json", done.stderr)
                self.assertEqual(self.rows(), rows, "the history keeps what it knows")
                put(earlier, whole)
                self.night("2026-11-13", expect=0)
                self.assertEqual(earlier.read_text(), whole)

    def test_every_file_of_the_output_folder(self):
        """What is lost there is made again to the byte, or reported by its name while nothing else changes."""
        (self.site / "c0/x.csv").write_text(readings("other"))
        self.night("2026-11-11", expect=0)
        self.night("2026-11-12", expect=0)
        want = given_out(self.out)
        names = sorted(n for n in want if not n.startswith("c") or n.startswith(("c0/", "c1/")))
        chosen = names if os.environ.get("NONIO_SITE_ALL") else sorted({"c0/earlier.json", *self.rng.sample(names, 9 if LONG else 3)})
        ways = ("missing", "empty", "cut", "swapped")
        outcome = {"made again": 0, "reported": 0}
        for name in chosen:
            for what in ways if LONG else self.rng.sample(ways, 2 if name == "c0/earlier.json" else 1):
                path = self.out / name
                bytes_before = path.read_bytes()
                if what == "missing":
                    path.unlink()
                elif what == "swapped":
                    path.write_bytes((self.out / names[(names.index(name) + 1) % len(names)]).read_bytes())
                else:
                    path.write_bytes(b"" if what == "empty" else bytes_before[: len(bytes_before) // 2])
                with self.subTest(name, what=what):
                    done = self.night("2026-11-12")
                    now = given_out(self.out)
                    others = {n for n in want if now.get(n) != want[n] and not n.endswith("/run.json")}
                    if done.returncode == 0:
                        outcome["made again"] += 1
                    else:
                        outcome["reported"] += 1
                        self.assertIn(pathlib.Path(name).name, done.stderr)
                    changed = others - NIGHTLY
                    if done.returncode:  # its campaign fails, and the page of its machine says so
                        changed = {n for n in changed if not n.startswith((name.split("/")[0] + "/", "machines/")) and n != name}
                    self.assertFalse(changed, done.stderr)
                path.parent.mkdir(exist_ok=True)
                path.write_bytes(bytes_before)
                self.night("2026-11-12")
        print(outcome, flush=True)
        self.assertTrue(all(outcome.values()), outcome)

    def rows(self):
        done = subprocess.run([NONIO, "machine", "list", self.out, "Mk m0", "--quantity", "B_mean", "--superseded", "--json"], capture_output=True, text=True)
        return done.stdout


if __name__ == "__main__":
    unittest.main()
