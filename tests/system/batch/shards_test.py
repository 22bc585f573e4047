# SPDX-License-Identifier: Apache-2.0
"""A run in shards: the bytes of an undivided run, whatever the order, number and end of the processes."""
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import time
import unittest

from nightly import NONIO, NightTest, readings, rows_of, tree

KILLS = int(os.environ.get("NONIO_KILLS", "4"))
SEED = int(os.environ.get("NONIO_SEED", "22"))
SAMPLES = pathlib.Path(os.environ["NONIO_SAMPLES"])


class Shards(NightTest):
    def plan(self, shards, *args, out=None, expect=0):
        return self.nonio("run", "plan", self.site, "--out", out or self.out, "--shards", shards, *args, expect=expect)

    def shard(self, i, shards, *args, out=None, expect=0):
        return self.nonio("run", self.site, "--out", out or self.out, "--shard", f"{i}/{shards}", *args, expect=expect)

    def merge(self, *args, out=None, expect=0):
        return self.nonio("run", "merge", out or self.out, "--wait", "0", *args, expect=expect)

    def nonio(self, *args, expect=None):
        done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=300)
        if expect is not None:
            self.assertIn(done.returncode, expect if isinstance(expect, tuple) else (expect,), done.stderr + done.stdout)
        return done

    def night(self, shards, *args, out=None, rng=None, expect=0):
        self.plan(shards, *args, out=out)
        order = list(range(shards))
        (rng or random.Random(SEED)).shuffle(order)
        for i in order:
            self.shard(i, shards, out=out, expect=(0, 1))
        return self.merge(out=out, expect=expect)

    def same(self, a, b, what=""):
        a, b = tree(a), tree(b)
        self.assertEqual(sorted(k for k in a.keys() | b.keys() if a.get(k) != b.get(k)), [], what)

    def some_campaigns(self, n=6):
        """Of machines with a history, and with one campaign that fails."""
        for i in range(n):
            self.campaign(f"c{i}", extra="[instrument]\nmaker = \"L\"\nserial = \"9\"\nU_fixed_um = 0.2\nU_per_m_um = 0.5\n")
        self.campaign("twin", seed="c1")
        (self.campaign("wrong") / "x.csv").write_text("run,direction,target_mm,deviation_um\n1,+,1O8.9,1.0\n")

    def test_number_and_order_of_the_shards_do_not_matter(self):
        """Three nights: first, with changes, forced."""
        rng = random.Random(SEED)
        print(f"seed {SEED}", flush=True)
        self.some_campaigns()
        outs = {shards: self.root / f"out-{shards}" for shards in (1, 7, 64)}
        for night, change in enumerate((None, "c2", None)):
            if change:
                self.campaign(change, seed=99)
            args = ["--date", f"2026-11-0{night + 1}", *(["--force"] if night == 2 else [])]
            self.run_nonio(*args, "--jobs", "1", expect=1)
            for shards, out in outs.items():
                if night == 2 and shards == 64:
                    continue
                self.night(shards, *args, out=out, rng=rng, expect=1)
                self.same(self.out, out, f"night {night + 1}, {shards} shards")

    def test_the_samples(self):
        shutil.rmtree(self.site)
        shutil.copytree(SAMPLES, self.site)
        self.run_nonio("--date", "2026-11-01", expect=1)
        self.night(7, "--date", "2026-11-01", out=self.root / "parts", expect=1)
        self.same(self.out, self.root / "parts")

    def test_an_older_processor_gives_the_same_bytes(self):
        """glibc's functions without FMA and AVX2 have other last bits; what is printed has not."""
        shutil.rmtree(self.site)
        shutil.copytree(SAMPLES, self.site)
        self.run_nonio("--date", "2026-11-01", expect=1)
        masked = dict(os.environ, GLIBC_TUNABLES="glibc.cpu.hwcaps=-AVX2,-AVX2_Usable,-FMA,-FMA_Usable,-FMA4,-FMA4_Usable")
        self.run_nonio("--date", "2026-11-01", out=self.root / "masked", expect=1, env=masked)
        self.same(self.out, self.root / "masked")

    def test_killed_at_any_moment_and_started_again(self):
        print(f"seed {SEED}, {KILLS} kills", flush=True)
        rng = random.Random(SEED)
        self.some_campaigns()
        self.run_nonio("--date", "2026-11-01", expect=1)
        parts = self.root / "parts"
        self.plan(2, "--date", "2026-11-01", out=parts)
        command = [NONIO, "run", str(self.site), "--out", str(parts), "--quiet", "--shard"]
        kills, seconds = 0, 1.0
        for _ in range(20 * KILLS):
            if kills == KILLS:
                break
            if kills == KILLS // 2:  # what the killed ones have stored is done anew
                self.plan(2, "--date", "2026-11-01", out=parts)
            began = time.monotonic()
            shard = subprocess.Popen([*command, f"{rng.randrange(2)}/2"], stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                shard.wait(rng.uniform(0.0, seconds))
                seconds = time.monotonic() - began
            except subprocess.TimeoutExpired:
                os.killpg(shard.pid, signal.SIGKILL)
                shard.wait()
                kills += 1
        for i in range(2):
            self.shard(i, 2, out=parts, expect=(0, 1))
        self.merge(out=parts, expect=1)
        self.same(self.out, parts)

    def test_a_shard_twice_at_once(self):
        self.some_campaigns()
        self.run_nonio("--date", "2026-11-01", expect=1)
        parts = self.root / "parts"
        self.plan(1, "--date", "2026-11-01", out=parts)
        command = [NONIO, "run", str(self.site), "--out", str(parts), "--quiet", "--shard", "0/1"]
        both = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(3)]
        for one in both:
            _, said = one.communicate(timeout=300)
            self.assertEqual(one.returncode, 1, said)
            self.assertNotIn("nonio", said)
        self.merge(out=parts, expect=1)
        self.same(self.out, parts)

    def test_what_is_missing_is_named(self):
        self.some_campaigns()
        parts = self.root / "parts"
        self.plan(3, "--date", "2026-11-01", out=parts)
        status = json.loads(self.nonio("status", parts, "--json", expect=0).stdout)
        self.assertEqual((status["state"], status["shards"], status["reported"]), ("planned", 3, 0))
        self.assertIn("shards 0, 1, 2 of 3 have not reported", self.merge(out=parts, expect=1).stderr)
        self.shard(0, 3, out=parts, expect=(0, 1))
        self.shard(2, 3, out=parts, expect=(0, 1))
        done = self.merge(out=parts, expect=1)
        self.assertIn("shard 1 of 3 has not reported", done.stderr)
        self.assertIn("--shard 1/3", done.stderr)
        self.assertFalse((parts / "summary.json").exists(), "half a night has no summary")
        self.shard(1, 3, out=parts, expect=(0, 1))
        # Results that were lost since are not believed because a record says that they were there.
        lost = sorted(p.parent for p in parts.glob("c*/run.json"))[0]
        shutil.move(lost, self.root / "lost")
        self.assertIn(f"the results of {lost.name} (shard ", self.merge(out=parts, expect=1).stderr)
        for i in range(3):
            self.shard(i, 3, out=parts, expect=(0, 1))
        self.merge(out=parts, expect=1)
        self.run_nonio("--date", "2026-11-01", expect=1)
        self.same(self.out, parts)
        self.assertIn("nothing to merge", self.merge(out=parts, expect=1).stderr)

    def test_what_does_not_fit_is_refused(self):
        self.campaign("a")
        self.out.mkdir()
        self.assertIn("nonio run plan", self.shard(0, 2, expect=2).stderr)
        self.assertIn("nonio run plan", self.merge(expect=2).stderr)
        for wrong in ("", "2/2", "x/2", "1/", "1", "0/0", "1/2/3"):
            done = self.nonio("run", self.site, "--out", self.out, "--shard", wrong, expect=2)
            self.assertIn("expected i/S", done.stderr, wrong)
        self.assertIn("goes with --jobs and --pack alone", self.shard(0, 2, "--force", expect=2).stderr)
        self.plan(2, "--date", "2026-11-01")
        self.assertIn("planned for 2 shards", self.shard(0, 3, expect=2).stderr)
        self.assertIn("not merged yet", self.run_nonio(expect=2).stderr)
        self.assertIn("not merged yet", self.run_nonio("--dry-run", expect=2).stderr)
        self.assertIn("not merged yet", self.run_nonio("--only", "a", expect=2).stderr)
        (self.site / "site.toml").write_text("format = 1\n[limits]\nseconds = 100\n")
        done = [self.shard(i, 2, expect=(0, 2)) for i in range(2)]  # one of them has nothing to do
        self.assertIn("was planned: site.toml", "".join(one.stderr for one in done))
        self.assertIn("was planned: site.toml", self.merge(expect=2).stderr)
        for args in ((), ("--date", "2026-11-02")):
            self.plan(2, *args)
        for i in range(2):
            self.shard(i, 2)
        self.merge()
        self.assertEqual(self.summary()["night"], 1)

    def test_a_plan_is_withdrawn_and_its_run_goes_on(self):
        self.some_campaigns()
        self.assertIn("no run is planned", self.nonio("run", "cancel", self.site, expect=2).stderr)
        self.plan(2, "--date", "2026-11-01")
        self.shard(0, 2, expect=(0, 1))
        self.nonio("run", "cancel", self.out, expect=0)
        self.run_nonio(expect=1)
        self.run_nonio("--date", "2026-11-01", out=self.root / "one", expect=1)
        self.same(self.out, self.root / "one")

    def test_the_site_changes_while_its_run_is_planned(self):
        """Readings are those at the time of reading; a new campaign waits for the next run; a removed one has failed."""
        for name in ("a", "b", "c"):
            self.campaign(name)
        self.plan(2, "--date", "2026-11-01")
        self.campaign("a", seed=7)
        self.campaign("new")
        shutil.rmtree(self.site / "b")
        for i in range(2):
            self.shard(i, 2, expect=(0, 1))
        self.merge(expect=1)
        self.assertEqual(self.ids("failed"), ["b"])
        self.assertEqual(self.ids("done"), ["a", "c"])
        self.campaign("b")
        self.night(3, "--date", "2026-11-02")
        self.assertEqual(self.ids("done"), ["b", "new"])
        self.assertEqual(self.ids("unchanged"), ["a", "c"])

    def test_vanished_campaigns_and_the_limit_of_them(self):
        for name in ("a", "b"):
            self.campaign(name)
        outs = [self.out, self.root / "parts"]
        for out in outs:
            self.run_nonio("--date", "2026-11-01", out=out, expect=0)
        shutil.rmtree(self.site / "b")
        self.run_nonio("--date", "2026-11-02", expect=1)
        self.night(2, "--date", "2026-11-02", out=outs[1], expect=1)
        self.same(*outs)
        (self.site / "site.toml").write_text("format = 1\n[limits]\nmissing_campaigns = 1\n")
        self.run_nonio("--date", "2026-11-03", expect=0)
        self.night(2, "--date", "2026-11-03", out=outs[1], expect=0)
        self.same(*outs)

    def test_histories_in_reports(self):
        """Those campaigns are written again by the merge."""
        text = ('format = 1\n[campaign]\nid = "{0}"\ndate = 2026-0{1}-01\n[machine]\nasset = "S-1"\n[machine.axes.X]\n'
                'kind = "linear"\n[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n'
                '[options.pdf-report]\nhistory = true\n')
        for i in range(1, 5):
            self.campaign(f"c{i}", text=text.format(f"c{i}", i))
        parts = self.root / "parts"
        self.run_nonio("--date", "2026-11-01", expect=0)
        self.night(3, "--date", "2026-11-01", out=parts)
        self.same(self.out, parts)
        self.assertEqual(rows_of(self.out / "history.sqlite"), rows_of(parts / "history.sqlite"))
        (self.site / "c2" / "x.csv").write_text(readings(5))
        self.run_nonio("--date", "2026-11-02", expect=0)
        self.night(3, "--date", "2026-11-02", out=parts)
        self.same(self.out, parts)

    def test_a_name_that_is_no_text(self):
        folder = os.fsencode(self.site) + b"/caf\xe9"
        os.mkdir(folder)
        for name, text in (("campaign.toml", None), ("x.csv", readings(1))):
            with open(os.path.join(folder, name.encode()), "w", encoding="utf-8") as file:
                file.write(text or 'format = 1\n[campaign]\nid = "a"\ndate = 2026-11-03\n[machine]\nmodel = "M"\n[machine.axes.X]\nkind = '
                           '"linear"\n[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n')
        self.run_nonio("--date", "2026-11-01", expect=0)
        self.night(2, "--date", "2026-11-01", out=self.root / "parts")
        self.same(self.out, self.root / "parts")


if __name__ == "__main__":
    unittest.main(verbosity=2)
