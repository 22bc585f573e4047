# SPDX-License-Identifier: Apache-2.0
"""Shards that hand their results over as packs: the bytes of one run without shards, for everybody who reads them; and packs that
are damaged, hostile, half-written or handed over twice."""
import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import sqlite3
import subprocess
import time
import unittest

from nightly import NONIO, NightTest, tree

KILLS = int(os.environ.get("NONIO_KILLS", "4" if os.environ.get("NONIO_LONG") else "2"))
SEED = int(os.environ.get("NONIO_SEED", "22"))
SAMPLES = pathlib.Path(os.environ["NONIO_SAMPLES"])


class Packs(NightTest):
    def setUp(self):
        super().setUp()
        self.parts = self.root / "parts"
        self.scratch = self.root / "scratch"
        self.scratch.mkdir()

    def nonio(self, *args, expect=0):
        done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=300)
        self.assertIn(done.returncode, expect if isinstance(expect, tuple) else (expect,), done.stderr + done.stdout)
        return done

    def shard(self, i, shards, *args, expect=(0, 1)):
        return self.nonio("run", self.site, "--out", self.parts, "--shard", f"{i}/{shards}", "--pack", "--scratch", self.scratch, *args,
                          expect=expect)

    def plan(self, shards, *args):
        return self.nonio("run", "plan", self.site, "--out", self.parts, "--shards", shards, *args)

    def merge(self, expect=(0, 1)):
        return self.nonio("run", "merge", self.parts, "--wait", "0", expect=expect)

    def night(self, shards, *args):
        """The same night whole into `out`, and in packs into `parts`."""
        self.run_nonio(*args, "--jobs", "2")
        self.plan(shards, *args)
        for i in range(shards):
            self.shard(i, shards)
        self.merge()
        self.assertEqual(list(self.scratch.iterdir()), [], "nothing stays on the host")

    def some_campaigns(self, n=4):
        for i in range(n):
            self.campaign(f"c{i}", extra="[instrument]\nmaker = \"L\"\nserial = \"9\"\nU_fixed_um = 0.2\nU_per_m_um = 0.5\n")
        self.campaign("twin", seed="c1")
        (self.campaign("wrong") / "x.csv").write_text("run,direction,target_mm,deviation_um\n1,+,1O8.9,1.0\n")

    def packs(self):
        return sorted((self.parts / ".nonio" / "packs").glob("*.sqlar"))

    def folders(self, out=None):
        return sorted(p.parent.name for p in (out or self.parts).glob("*/run.json"))

    def outside_packs(self, out):
        return {k: v for k, v in tree(out).items() if not k.startswith(".nonio/packs/")}

    def same(self, what="", packed=None):
        """Summary, history and pages, byte for byte; then all files of all campaigns, written out into a copy."""
        whole, parts = tree(self.out), self.outside_packs(self.parts)
        known = {k: v for k, v in whole.items() if k.split("/")[0] not in self.folders(self.out) or k in parts}
        self.assertEqual(sorted(k for k in known.keys() | parts.keys() if known.get(k) != parts.get(k)), [], what)
        for page in ("summary.json", "summary.txt", "history.sqlite", "index.html"):
            self.assertIn(page, parts)
        if packed is not None:
            self.assertEqual(sorted(set(self.folders(self.out)) - set(self.folders())), sorted(packed), what)
        copy = self.root / "copy"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(self.parts, copy)
        self.nonio("export", "--all", "--out", copy, "--quiet")
        copied = self.outside_packs(copy)
        self.assertEqual(sorted(k for k in whole.keys() | copied.keys() if whole.get(k) != copied.get(k)), [], what)

    def test_runs_in_packs_equal_whole_runs(self):
        """First; one changed; unchanged; forced; one that fails for a reason that may pass: in packs, whole, and in folders again."""
        self.some_campaigns()
        everything = ["c0", "c1", "c2", "c3", "twin", "wrong"]
        self.night(1, "--date", "2026-11-01")
        self.same("first", everything)
        self.campaign("c2", seed=99)
        self.night(3, "--date", "2026-11-02")
        self.same("changed", everything)
        self.assertEqual(self.ids("done", self.parts), ["c2"])
        self.assertEqual(self.ids("unchanged", self.parts), ["c0", "c1", "c3", "twin"])
        names = [p.name for p in self.packs()]
        self.night(2, "--date", "2026-11-03")
        self.same("unchanged", everything)
        self.assertEqual([p.name for p in self.packs()], names, "an unchanged night writes no pack")
        # A run without shards, and one whose shards write folders, remove from the packs the campaigns that they change.
        self.campaign("c1", seed=7)
        for out in (self.out, self.parts):
            self.run_nonio("--date", "2026-11-04", out=out)
        self.same("whole", ["c0", "c2", "c3", "wrong"])  # the twin of c1 is done too
        (self.site / "c0" / "x.csv").unlink()
        (self.site / "c0" / "x.csv").mkdir()
        self.night(2, "--date", "2026-11-05")
        self.same("a failure")
        self.night(2, "--date", "2026-11-06", "--force")
        self.same("forced", everything)
        self.assertEqual(self.folders(), [])
        (self.site / "c0" / "x.csv").rmdir()
        self.campaign("c0", seed=8)
        self.night(2, "--date", "2026-11-07")
        self.same("mended", everything)
        self.assertFalse([p for p in self.parts.glob("c*") if p.is_dir()], "no empty folders")
        (self.parts / "history.sqlite").unlink()  # made again from the packs alone: the same rows
        self.night(2, "--date", "2026-11-08")
        self.same("history made again", everything)

    def test_the_samples(self):
        """With certificates, drafts, histories in reports, several languages; in folders by digests."""
        shutil.rmtree(self.site)
        shutil.copytree(SAMPLES, self.site)
        if not os.environ.get("NONIO_LONG"):
            for campaign in sorted(p.parent for p in self.site.glob("*/campaign.toml"))[1::2]:
                shutil.rmtree(campaign)
        with open(self.site / "site.toml", "a", encoding="utf-8") as file:
            file.write('\n[results]\nfolders = "hashed"\n')
        self.night(3, "--date", "2026-11-01")
        whole, parts = tree(self.out), self.outside_packs(self.parts)
        self.nonio("export", "--all", "--out", self.parts, "--quiet")
        self.assertGreater(len(whole), 2 * len(parts), "most results lie in packs")
        parts = self.outside_packs(self.parts)
        self.assertEqual(sorted(k for k in whole.keys() | parts.keys() if whole.get(k) != parts.get(k)), [])

    def test_every_reader_reads_packs(self):
        self.some_campaigns()
        self.night(2, "--date", "2026-11-01")
        report = f"Report: {self.out}/c1/report.pdf\n"  # a packed one cannot be opened
        self.assertEqual(self.nonio("show", self.parts / "c1").stdout, self.nonio("show", self.out / "c1").stdout.replace(report, ""))
        self.assertEqual(self.nonio("show", self.parts / "wrong", expect=1).stdout, self.nonio("show", self.out / "wrong", expect=1).stdout)
        self.assertIn("is neither a folder nor a machine", self.nonio("show", self.parts / "no-such", expect=2).stderr)
        opened = self.nonio("show", "--open", self.parts / "c1", expect=1).stderr
        self.assertIn(".sqlar; `nonio export c1 --out OUT` writes it out", opened)
        page = [self.nonio("status", "--actions", out, "--site", self.site, "--page", "index.html").stdout for out in (self.out, self.parts)]
        self.assertEqual(*page)
        self.assertEqual(*(self.run_nonio("--dry-run", out=out, expect=1).stdout for out in (self.out, self.parts)))
        # A plain SQLite archive, in which whoever has SQLite finds the files; without a clock.
        (pack, *_) = self.packs()
        database = sqlite3.connect(f"file:{pack}?mode=ro", uri=True)
        rows = database.execute("SELECT name, mode, mtime, sz, data FROM sqlar").fetchall()
        database.close()
        for name, mode, mtime, size, data in rows:
            self.assertEqual((mode, mtime, size), (0o100644, 0, len(data)))
            self.assertEqual(data, (self.out / name).read_bytes())
        # A link of a page leads to a file after the file was exported.
        self.nonio("export", "c1", "--out", self.parts)
        self.assertEqual((self.parts / "c1" / "report.pdf").read_bytes(), (self.out / "c1" / "report.pdf").read_bytes())

    def test_same_input_same_pack(self):
        self.some_campaigns(2)
        packs = []
        for jobs in ("1", "3"):
            shutil.rmtree(self.parts, ignore_errors=True)
            self.plan(1, "--date", "2026-11-01")
            self.shard(0, 1, "--jobs", jobs)
            (pack,) = self.packs()
            packs.append((pack.name, pack.read_bytes()))
            self.assertIn(hashlib.sha256(pack.read_bytes()).hexdigest()[:16], pack.name)
        self.assertEqual(*packs)

    def test_killed_at_any_moment_and_started_again(self):
        print(f"seed {SEED}, {KILLS} kills", flush=True)
        rng = random.Random(SEED)
        self.some_campaigns()
        self.run_nonio("--date", "2026-11-01", expect=1)
        self.plan(2, "--date", "2026-11-01")
        command = [NONIO, "run", str(self.site), "--out", str(self.parts), "--quiet", "--pack", "--scratch", str(self.scratch), "--shard"]
        kills, seconds = 0, 1.0
        for _ in range(20 * KILLS):
            if kills == KILLS:
                break
            if kills == KILLS // 2:  # what was handed over before stays
                self.plan(2, "--date", "2026-11-01")
            began = time.monotonic()
            shard = subprocess.Popen([*command, f"{rng.randrange(2)}/2"], stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                shard.wait(rng.uniform(0.0, seconds))
                seconds = max(0.3, time.monotonic() - began)
            except subprocess.TimeoutExpired:
                os.killpg(shard.pid, signal.SIGKILL)
                shard.wait()
                kills += 1
            for pack in self.packs():
                self.assertIn(hashlib.sha256(pack.read_bytes()).hexdigest()[:16], pack.name, "half a pack")
        for folder in self.scratch.iterdir():
            shutil.rmtree(folder)
        for i in range(2):
            self.shard(i, 2)
        self.merge()
        self.same()
        self.assertEqual(sorted(p.name for p in (self.parts / ".nonio" / "packs").iterdir() if p.name.startswith(".")), [])

    def test_a_shard_twice_at_once_also_one_without_packs(self):
        self.some_campaigns()
        self.run_nonio("--date", "2026-11-01", expect=1)
        self.plan(1, "--date", "2026-11-01")
        command = [NONIO, "run", str(self.site), "--out", str(self.parts), "--quiet", "--shard", "0/1"]
        all_of_it = [subprocess.Popen([*command, *more], stderr=subprocess.PIPE, text=True)
                     for more in (["--pack"], ["--pack", "--jobs", "1"], [])]
        for one in all_of_it:
            _, said = one.communicate(timeout=300)
            self.assertEqual(one.returncode, 1, said)
            self.assertNotIn("nonio", said)
        self.merge()
        self.same()

    def test_a_plan_is_withdrawn_or_planned_again_and_packs_stay(self):
        self.some_campaigns(6)
        self.plan(2, "--date", "2026-11-01")
        self.shard(0, 2)
        done = self.nonio("run", self.site, "--out", self.parts, "--shard", "0/2", "--pack", "--json", expect=(0, 1)).stdout
        self.assertNotIn('"event":"campaign"', done, "what was handed over is not done twice")
        planned = json.loads(self.nonio("run", "plan", self.site, "--out", self.parts, "--shards", "2", "--json").stdout.splitlines()[-1])
        self.assertLess(planned["to_do"], 8)
        self.nonio("run", "cancel", self.parts)
        self.run_nonio(out=self.parts, expect=1)
        self.run_nonio("--date", "2026-11-01", expect=1)
        self.same()

    def test_get(self):
        self.some_campaigns()
        self.night(2, "--date", "2026-11-01")
        to = self.root / "to"
        self.nonio("export", "c0", "c1", "--out", self.parts, "--to", to)
        for name in ("c0", "c1"):
            self.assertEqual(tree(to / name), tree(self.out / name))
        self.assertEqual(self.folders(), [], "the output folder stays as it was")
        self.nonio("export", "c0", "--out", self.parts, "--to", to)  # what is there is not written again
        (to / "c0" / "results.json").write_text("mine")
        refused = self.nonio("export", "c0", "--out", self.parts, "--to", to, expect=1).stderr
        self.assertIn("c0/results.json exists with different content; nothing was written", refused)
        self.assertEqual((to / "c0" / "results.json").read_text(), "mine")
        listed = [json.loads(line) for line in self.nonio("export", "--list", "--out", self.parts, "--json").stdout.splitlines()]
        self.assertEqual([entry["id"] for entry in listed], self.folders(self.out))
        self.assertTrue(all(entry["packed"] for entry in listed))
        self.assertIn("run.json", self.nonio("export", "c0", "--list", "--out", self.parts).stdout)
        # From a folder as from a pack.
        self.nonio("export", "c0", "--out", self.out, "--to", self.root / "from-folder")
        self.assertEqual(tree(self.root / "from-folder" / "c0"), tree(self.out / "c0"))
        self.assertIn("no results of no-such", self.nonio("export", "no-such", "--out", self.parts, expect=1).stderr)
        for args in ([], ["--all", "c0"], ["--list", "--to", "x"], ["../c0"]):
            self.nonio("export", *args, "--out", self.parts, expect=2)
        self.assertIn("expected --shard", self.run_nonio("--pack", expect=2).stderr)
        self.assertIn("expected --pack", self.run_nonio("--shard", "0/1", "--scratch", str(self.scratch), expect=2).stderr)
        self.plan(1)
        self.assertIn("not merged yet", self.nonio("export", "c0", "--out", self.parts, expect=2).stderr)

    def change(self, pack, *statements):
        database = sqlite3.connect(pack)
        for statement in statements:
            database.execute(*statement) if isinstance(statement, tuple) else database.execute(statement)
        database.commit()
        database.close()

    def test_a_damaged_pack_is_named_with_campaign_and_file(self):
        self.some_campaigns(2)
        self.run_nonio("--date", "2026-11-01", expect=1)
        self.plan(1, "--date", "2026-11-01")
        self.shard(0, 1)
        (pack,) = self.packs()
        sound = pack.read_bytes()
        at = sound.index((self.out / "c1" / "results.json").read_bytes()[:200]) + 100
        pack.write_bytes(sound[:at] + bytes([sound[at] ^ 1]) + sound[at + 1:])
        said = self.merge(expect=1).stderr
        self.assertIn(f"{pack.name} is damaged at c1/results.json", said)
        self.assertIn("--shard 0/1", said)
        pack.write_bytes(sound[: len(sound) // 2])
        self.assertIn(f"{pack.name} is damaged", self.merge(expect=1).stderr)
        pack.unlink()
        self.assertIn("shard 0 of 1 has not reported", self.merge(expect=1).stderr)
        self.shard(0, 1)  # does it again
        self.assertEqual(pack.read_bytes(), sound)
        self.merge()
        self.same()
        # After the merge: a damaged report is made again; a missing pack fails its campaign, which is not taken for a new one.
        at = sound.index((self.out / "c1" / "report.pdf").read_bytes()[-200:])
        pack.write_bytes(sound[:at] + bytes([sound[at] ^ 1]) + sound[at + 1:])
        refused = self.nonio("export", "c1", "--out", self.parts, "--to", self.root / "to", expect=1).stderr
        self.assertIn(f"{pack.name} is damaged at c1/report.pdf", refused)
        self.assertFalse((self.root / "to").exists())
        self.run_nonio("--date", "2026-11-02", out=self.parts)
        self.assertEqual(self.ids("done", self.parts), ["c1"])
        self.assertEqual((self.parts / "c1" / "report.pdf").read_bytes(), (self.out / "c1" / "report.pdf").read_bytes())
        pack.unlink()
        self.campaign("c0", seed=4)
        self.run_nonio("--date", "2026-11-03", out=self.parts, expect=1)
        self.assertIn(f"{pack.name} is not there", json.dumps(self.summary(self.parts)["failed"]))
        pack.write_bytes(sound)
        catalogue = self.parts / ".nonio" / "packs" / "catalogue"
        text = catalogue.read_text()
        catalogue.write_text(text.replace("c0", "c9"))
        self.assertIn("catalogue, the index of the packs, is damaged", self.run_nonio(out=self.parts, expect=2).stderr)
        catalogue.write_text(text)
        self.run_nonio("--date", "2026-11-03", out=self.parts)
        self.assertEqual(self.ids("failed", self.parts), ["wrong"])

    def test_a_hostile_pack_writes_nothing_elsewhere(self):
        self.some_campaigns(1)
        self.night(1, "--date", "2026-11-01")
        (pack,) = self.packs()
        sound = pack.read_bytes()
        to = self.root / "to" / "below"
        record = json.loads((self.out / "c0" / "run.json").read_text())

        def refuses(word, *statements):
            pack.write_bytes(sound)
            self.change(pack, *statements)
            before = set(p for p in self.root.rglob("*") if self.scratch not in p.parents)
            said = self.nonio("export", "c0", "--out", self.parts, "--to", to, expect=1).stderr
            self.assertIn(word, said)
            self.assertEqual(set(p for p in self.root.rglob("*") if self.scratch not in p.parents), before, word)

        def named(name):
            text = json.dumps({**record, "files": {**record["files"], name: record["files"]["results.json"]}})
            digest = hashlib.sha256(text.encode()).hexdigest()
            return [("INSERT INTO sqlar SELECT ?, mode, mtime, sz, data FROM sqlar WHERE name = 'c0/results.json'", (f"c0/{name}",)),
                    ("UPDATE sqlar SET data = ?, sz = ? WHERE name = 'c0/run.json'", (text.encode(), len(text))),
                    ("UPDATE digest SET sha256 = ? WHERE name = 'c0/run.json'", (digest,)),
                    ("INSERT INTO digest SELECT ?, sha256 FROM digest WHERE name = 'c0/results.json'", (f"c0/{name}",))]

        for name in ("../../../evil", "/tmp/nonio-evil", "a/b", ".hidden", "..", "run.json/x"):
            refuses("expected a plain name", *named(name))
            refuses("does not name", named(name)[0])
        refuses("is not a plain file", "UPDATE sqlar SET mode = 41471 WHERE name = 'c0/results.json'")  # a symlink
        refuses("it states that it has 9000000000000 bytes", "UPDATE sqlar SET sz = 9000000000000 WHERE name = 'c0/results.json'")
        refuses("it states that it has -1 bytes", "UPDATE sqlar SET sz = -1 WHERE name = 'c0/results.json'")
        refuses("do not have their digest", "UPDATE sqlar SET data = zeroblob(sz) WHERE name = 'c0/results.json'")
        refuses("is damaged", "ALTER TABLE sqlar RENAME TO t", "CREATE VIEW sqlar AS SELECT * FROM t")
        refuses("is damaged", "DROP TABLE digest")
        pack.unlink()
        pack.symlink_to("/etc/passwd")
        self.assertIn("is not a file", self.nonio("export", "c0", "--out", self.parts, "--to", to, expect=1).stderr)
        # A symbolic link in the folder of the export leads elsewhere: it is not followed.
        pack.unlink()
        pack.write_bytes(sound)
        (to / "c0").mkdir(parents=True)
        target = self.root / "target"
        target.write_text("mine")
        (to / "c0" / "results.json").symlink_to(target)
        self.assertIn("different content", self.nonio("export", "c0", "--out", self.parts, "--to", to, expect=1).stderr)
        self.assertEqual(target.read_text(), "mine")


if __name__ == "__main__":
    unittest.main(verbosity=2)
