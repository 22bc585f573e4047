# SPDX-License-Identifier: Apache-2.0
"""Every campaign of a site is found or reported as missing: no folder, file or share drops a campaign silently or ends the
run."""
import errno
import hashlib
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import threading
import time
import unittest

from nightly import NightTest, manifest, tree

FAULTS = os.environ["NONIO_TEST_FAULTS"]
QUICK = '[run]\nanalyses = ["iso230-2"]\noutputs = []\n'
# Sanitizers want to be the first library of the process.
can_inject = unittest.skipIf("NONIO_TEST_NO_MEMORY_LIMIT" in os.environ, "no LD_PRELOAD beside a sanitizer")


def with_faults(*rules):
    return {**os.environ, "LD_PRELOAD": FAULTS, "NONIO_FAULTS": " ".join(rules)}


class Survey(NightTest):
    def campaigns(self, *names):
        for name in names:
            self.campaign(name, campaign_id=name.replace("/", "-"), run=QUICK)

    def failed(self):
        return {e["folder"]: e["errors"][0]["message"] for e in self.summary()["failed"]}

    def seen(self, done):
        return {entry["folder"] for entry in map(json.loads, done.stdout.splitlines()) if "folder" in entry}

    # 1. Folders that cannot be listed

    @can_inject
    def test_a_folder_that_cannot_be_listed_is_a_failed_entry(self):
        self.campaigns("a", "b/1", "b/2", "c")
        for code in (errno.EIO, errno.ESTALE, errno.EACCES, errno.EMFILE):
            done = self.run_nonio("--quiet", "--force", expect=1, env=with_faults(f"open:site/b:{code}"))
            self.assertEqual(sorted(self.ids("done")), ["a", "c"])
            self.assertIn(os.strerror(code), self.failed()["b"])
            self.assertIn("the folder b cannot be listed", done.stderr)
        done = self.run_nonio("--quiet", "--force", expect=1, env=with_faults(f"open:site/b:{errno.ENOENT}"))
        self.assertEqual(sorted(self.ids("done")), ["a", "c"])
        self.assertIn("it went away", self.failed()["b"])
        self.assertFalse((self.out / "b").exists())
        self.run_nonio(expect=0)
        self.assertEqual(len(self.ids("done") + self.ids("unchanged")), 4)
        # Now they are known, and missed.
        self.run_nonio("--quiet", expect=1, env=with_faults(f"open:site/b:{errno.EIO}"))
        missed = {v["campaign"]: v["message"] for v in self.summary()["vanished"]}
        self.assertEqual(set(missed), {"b-1", "b-2"})
        self.assertIn("was not seen", missed["b-1"])

    @can_inject
    def test_a_site_that_cannot_be_listed_is_refused(self):
        self.campaigns("a")
        done = self.run_nonio(expect=2, env=with_faults(f"open:/site:{errno.EIO}"))
        self.assertIn(os.strerror(errno.EIO), done.stderr)

    def test_folders_deeper_than_there_are_descriptors(self):
        deep = "/".join(["d"] * 150)
        self.campaigns("a", deep)
        done = self.run_nonio("--dry-run", "--json", expect=0,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64)))
        self.assertEqual(self.seen(done), {"a", deep})

    @can_inject
    def test_a_folder_that_comes_and_goes_hides_no_other(self):
        names = [f"c{i:02}" for i in range(40)]
        self.campaigns(*names)
        # At the worst moment: it was in the list, and is away when it is opened.
        for i in (0, 19, 39):
            done = self.run_nonio("--dry-run", "--json", env=with_faults(f"open:site/c{i:02}:{errno.ENOENT}"))
            self.assertIn(done.returncode, (0, 1), done.stderr)
            self.assertLessEqual(set(names) - {f"c{i:02}"}, self.seen(done))
        # At any moment.
        stop = threading.Event()

        def restless():
            while not stop.is_set():
                for i in range(20):
                    folder = self.site / f"c{i:02}" / "new" / "deeper"
                    folder.mkdir(parents=True, exist_ok=True)
                    shutil.rmtree(folder.parent, ignore_errors=True)

        thread = threading.Thread(target=restless)
        thread.start()
        try:
            for _ in range(20):
                done = self.run_nonio("--dry-run", "--json")
                self.assertIn(done.returncode, (0, 1), done.stderr)
                self.assertLessEqual(set(names), self.seen(done))
        finally:
            stop.set()
            thread.join()

    # 2. Files and shares that stop a run

    def test_a_manifest_above_1_MB_is_refused_unread(self):
        self.campaigns("a")
        (self.site / "huge").mkdir()
        with open(self.site / "huge" / "campaign.toml", "wb") as file:
            file.truncate(64 << 30)
        # A program that reads it does not take the machine with it.
        bounded = None if "NONIO_TEST_NO_MEMORY_LIMIT" in os.environ else (lambda: resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30)))
        self.run_nonio(expect=1, preexec_fn=bounded)
        self.assertEqual(self.ids("done"), ["a"])
        self.assertIn("expected at most 1 MB", self.failed()["huge"])
        os.truncate(self.site / "huge" / "campaign.toml", 0)
        (self.site / "site.toml").write_bytes(b"#" * 1000001)
        self.assertIn("expected at most 1 MB", self.run_nonio(expect=2).stderr)

    @can_inject
    def test_what_hangs_is_a_failed_entry_and_keeps_its_results(self):
        self.campaigns("a", "b", "c", "d/1")
        (self.site / "site.toml").write_text("[limits]\ndisk_seconds = 1\n")
        self.run_nonio(expect=0)
        before = tree(self.out / "b")
        for place, folder in (("site/d", "d"), ("b/campaign.toml", "b"), ("b/x.csv", "b")):
            done = self.run_nonio("--quiet", expect=1, env=with_faults(f"open:{place}:hang"))
            self.assertIn("no answer within 1 s", self.failed()[folder])
            self.assertIn("no answer within 1 s", done.stderr)
            self.assertLessEqual({"a", "c"}, set(self.ids("unchanged")))
        self.assertIn("the results of run 1 stay", self.failed()["b"])
        self.assertEqual(self.ids("failed"), ["b"])
        self.assertEqual(tree(self.out / "b"), before)
        self.run_nonio(expect=0)
        self.assertEqual(len(self.ids("unchanged")), 4)

    @can_inject
    def test_SIGTERM_ends_a_survey_that_hangs(self):
        self.campaigns("a", "b")
        for place in ("/site", "site/b", "b/campaign.toml"):
            night = subprocess.Popen(self.command(), env=with_faults(f"open:{place}:hang"),
                                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            time.sleep(1.5)
            began = time.monotonic()
            night.send_signal(signal.SIGTERM)
            _, words = night.communicate(timeout=30)
            self.assertEqual(night.returncode, 130, words)
            self.assertLess(time.monotonic() - began, 5.0)
            self.assertNotIn("campaign.id", words)
        self.run_nonio(expect=0)

    SIGNING = '[signing]\npkcs12 = "key.p12"\npassword_env = "KEY_PASSWORD"\n'

    def hanging(self, rule, after=None):
        return {**with_faults(rule), "KEY_PASSWORD": "secret", **({"NONIO_FAULTS_AFTER": str(after)} if after else {})}

    @can_inject
    def test_SIGTERM_ends_a_run_whose_own_files_hang(self):
        """Also where they hung after they were read before."""
        self.campaigns("a", "b")
        (self.site / "templates").mkdir()
        (self.site / "templates" / "x.toml").write_text("")
        (self.site / "key.p12").write_bytes(b"key")
        (self.site / "key.p12").chmod(0o600)
        (self.site / "site.toml").write_text(self.SIGNING)
        end = self.out / "b" / "run.json"
        for rule, after in (("open:site/site.toml", None), ("stat:site/site.toml", None),
                            ("open:templates/x.toml", None), ("stat:site/certificates.sqlite", None),
                            ("stat:key.p12", None), ("stat:site/certificates.sqlite", end)):
            shutil.rmtree(self.out, ignore_errors=True)
            night = subprocess.Popen(self.command(), env=self.hanging(rule + ":hang", after),
                                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            time.sleep(1.5)
            self.assertIsNone(night.poll(), rule)
            began = time.monotonic()
            night.send_signal(signal.SIGTERM)
            _, words = night.communicate(timeout=30)
            self.assertEqual(night.returncode, 130, rule + words)
            self.assertLess(time.monotonic() - began, 2.0, rule)
        self.assertTrue(end.exists())
        self.run_nonio(expect=0, env=self.hanging(""))

    @can_inject
    def test_a_register_or_key_that_hangs_costs_its_limit(self):
        self.campaigns("a", "b")
        (self.site / "key.p12").write_bytes(b"key")
        (self.site / "key.p12").chmod(0o600)
        (self.site / "site.toml").write_text(self.SIGNING + "[limits]\ndisk_seconds = 1\n")
        reference = self.root / "reference"
        date = ("--date", "2026-11-03")
        self.run_nonio(*date, out=reference, expect=0, env=self.hanging(""))
        began = time.monotonic()
        for fault in ("hang", errno.ESTALE):
            shutil.rmtree(self.out, ignore_errors=True)
            rule = f"stat:site/certificates.sqlite:{fault}"
            words = "no answer within" if fault == "hang" else os.strerror(errno.ESTALE)
            self.assertIn(words, self.run_nonio(*date, expect=2, env=self.hanging(rule)).stderr)
            # When all is done: a summary that does not know what was issued is none.
            done = self.run_nonio(*date, expect=1, env=self.hanging(rule, self.out / "b" / "run.json"))
            self.assertIn(words, done.stderr)
            self.assertIn("the same command goes on where it stopped", done.stderr)
            self.assertFalse((self.out / "summary.json").exists())
            self.run_nonio(expect=0, env=self.hanging(""))
            self.assertEqual(tree(self.out), tree(reference))
        self.run_nonio(expect=0, env=self.hanging("stat:key.p12:hang"))
        self.assertIn("nothing can be signed: the signing key: no answer within 1 s", "".join(self.summary()["notes"]))
        self.assertLess(time.monotonic() - began, 40.0)

    @can_inject
    def test_SIGTERM_in_a_long_survey(self):
        """Campaigns that were not looked at yet have no id: they are not taken for so many with one id."""
        for i in range(6000):
            folder = self.site / f"a-folder-with-a-long-name-{i:04}"
            folder.mkdir()
            (folder / "campaign.toml").write_text(manifest(f"c{i:04}"))
        night = subprocess.Popen(self.command("--quiet"), env=with_faults("open:campaign.toml:slow"),
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(2)
        night.send_signal(signal.SIGTERM)
        words = night.stderr.read()
        night.stderr.close()
        _, status, used = os.wait4(night.pid, 0)
        night.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(night.returncode, 130, words)
        self.assertNotIn("campaign.id", words)
        self.assertLess(used.ru_maxrss, 150_000)  # kB; the message of each with all names: 200 MB more

    def test_one_id_in_very_many_folders_is_reported_briefly(self):
        for i in range(3000):
            folder = self.site / f"f{i:04}"
            folder.mkdir()
            (folder / "campaign.toml").write_text(manifest("same"))
        done = self.run_nonio("--quiet", expect=1)
        self.assertEqual(len(done.stderr.splitlines()), 3000)
        message = self.summary()["failed"][0]["errors"][0]["message"]
        self.assertIn("f0000, f0001, f0002, f0003 and 2996 more folders", message)
        self.assertLess((self.out / "summary.json").stat().st_size, 3000 * 700)

    # 5. site.toml

    @can_inject
    def test_a_site_toml_that_cannot_be_looked_at_is_an_error(self):
        self.campaigns("a")
        (self.site / "site.toml").write_text("[limits]\nseconds = 5\n")
        for call in ("stat", "open"):
            done = self.run_nonio(expect=2, env=with_faults(f"{call}:site/site.toml:{errno.ESTALE}"))
            self.assertIn("site.toml", done.stderr)
            self.assertIn(os.strerror(errno.ESTALE), done.stderr)
        self.assertFalse(self.out.exists())

    def test_a_site_toml_that_is_a_dangling_link_is_an_error(self):
        self.campaigns("a")
        os.symlink(self.root / "nowhere.toml", self.site / "site.toml")
        self.assertIn("site.toml", self.run_nonio(expect=2).stderr)
        (self.site / "site.toml").unlink()
        (self.site / "site.toml").mkdir()
        self.assertIn("not a file", self.run_nonio(expect=2).stderr)
        self.assertFalse(self.out.exists())

    # 8. Campaigns that no longer exist

    def test_vanished_campaigns_are_named(self):
        self.campaigns("a", "b", "c", "d")
        self.run_nonio(expect=0)
        kept = self.root / "kept"
        kept.mkdir()
        for name in "ab":
            (self.site / name).rename(kept / name)
        (self.site / "c" / "campaign.toml").rename(kept / "campaign.toml")
        done = self.run_nonio("--quiet", expect=1)
        for name in "abc":
            self.assertIn(f"campaign {name} has vanished", done.stderr)
        self.assertEqual([v["campaign"] for v in self.summary()["vanished"]], ["a", "b", "c"])
        self.assertEqual(self.summary()["counts"]["vanished"], 3)
        self.assertIn("MISSING SINCE AN EARLIER RUN", (self.out / "summary.txt").read_text())
        self.assertEqual(self.ids("unchanged"), ["d"])
        self.run_nonio(expect=1)  # until the campaign is removed from the output folder or restored
        shutil.rmtree(self.out / "a")
        (kept / "b").rename(self.site / "b")
        (kept / "campaign.toml").rename(self.site / "c" / "campaign.toml")
        self.run_nonio(expect=0)
        self.assertEqual(self.ids("unchanged"), ["b", "c", "d"])
        shutil.rmtree(self.site)  # as when a disk is not mounted
        self.site.mkdir()
        self.assertEqual(self.run_nonio("--quiet", expect=1).stderr.count("has vanished"), 3)

    def test_a_campaign_that_got_another_id_or_folder(self):
        self.campaigns("a", "b")
        self.run_nonio(expect=0)
        (self.site / "a").rename(self.site / "moved")
        self.run_nonio(expect=0)
        self.assertEqual(self.reason("done", "a"), "moved from a")
        self.campaign("b", campaign_id="other", run=QUICK)
        self.assertIn("its folder b is the campaign other now", self.run_nonio("--quiet", expect=1).stderr)
        shutil.rmtree(self.out / "b")
        self.run_nonio("--quiet", expect=0)

    def test_a_manifest_that_breaks_keeps_its_id(self):
        self.campaign("folder", campaign_id="good", run=QUICK)
        self.run_nonio(expect=0)
        text = (self.site / "folder" / "campaign.toml").read_text()
        (self.site / "folder" / "campaign.toml").write_text("[[[")
        for _ in range(2):  # the second time it is unchanged
            self.run_nonio(expect=1)
            self.assertEqual((self.ids("failed"), self.summary()["vanished"]), (["good"], []))
        self.assertEqual(self.summary()["failed"][0]["folder"], "folder")
        (self.site / "folder" / "campaign.toml").write_text(text)
        self.run_nonio(expect=0)
        self.assertEqual(self.ids("done"), ["good"])

    def test_a_broken_manifest_stays_failed_without_being_done_again(self):
        self.campaign("folder", text="[[[")
        self.run_nonio(expect=1)
        before = (self.out / "folder" / "run.json").stat().st_mtime_ns
        done = self.run_nonio("--quiet", expect=1)
        self.assertIn("folder (unchanged)", done.stderr)
        self.assertEqual((self.out / "folder" / "run.json").stat().st_mtime_ns, before)

    def test_what_is_nearly_a_campaign_is_remarked_on(self):
        self.campaigns("a")
        for name in ("Campaign.toml", "campaign.toml.txt"):
            (self.site / name.split(".")[0]).mkdir(exist_ok=True)
            (self.site / name.split(".")[0] / name).write_text(manifest("x"))
        (self.root / "elsewhere" / "2026" / "one").mkdir(parents=True)
        (self.root / "elsewhere" / "2026" / "one" / "campaign.toml").write_text(manifest("one"))
        os.symlink(self.root / "elsewhere", self.site / "linked")
        os.symlink(self.root / "elsewhere", self.site / "a" / "data")  # within a campaign: its own business
        done = self.run_nonio("--quiet", expect=0)
        for words in ("Campaign/Campaign.toml is not read", "campaign/campaign.toml.txt is not read",
                      "the folder linked is a link"):
            self.assertIn(words, done.stderr)
            self.assertTrue([n for n in self.summary()["notes"] if words in n], words)
        self.assertNotIn("a/data", done.stderr)

    # 9. Two folders with one id

    def test_a_copied_folder_does_not_take_the_results_away(self):
        self.campaign("first", campaign_id="same")
        self.campaigns("other")
        self.run_nonio(expect=0)
        before = tree(self.out / "same")
        shutil.copytree(self.site / "first", self.site / "copy")
        for _ in range(2):
            done = self.run_nonio("--quiet", expect=1)
            self.assertIn("is used by copy and first", done.stderr)
            self.assertIn("the results of run 1 stay", done.stderr)
            self.assertEqual(tree(self.out / "same"), before)
            self.assertEqual(self.ids("failed"), ["same", "same"])
        shutil.rmtree(self.site / "copy")
        self.run_nonio(expect=0)
        self.assertIn("same", self.ids("unchanged"))

    # Sites of a million: OUT/ab/<id>

    def test_hashed_folders_hold_the_same_results(self):
        self.campaigns("a", "b", "c")
        self.run_nonio(expect=0)
        flat = {name: tree(self.out / name) for name in "abc"}
        (self.site / "site.toml").write_text('[results]\nfolders = "hashed"\n')
        done = self.run_nonio(expect=2)  # results are never moved
        self.assertIn("site.toml wants them in OUT/ab/<id>", done.stderr)
        shutil.rmtree(self.out / ".nonio")
        self.assertIn("site.toml wants them in OUT/ab/<id>", self.run_nonio(expect=2).stderr)
        shutil.rmtree(self.out)
        self.run_nonio(expect=0)
        place = {n: self.out / hashlib.sha256(n.encode()).hexdigest()[:2] / n for n in "abc"}
        for name in "abc":
            found = tree(place[name])
            self.assertEqual(found["results.json"], flat[name]["results.json"])
            self.assertFalse((self.out / name).exists())
        self.run_nonio(expect=0)
        self.assertEqual(self.ids("unchanged"), ["a", "b", "c"])
        shutil.rmtree(self.site / "b")
        self.assertIn("nonio machine remove SITE b", self.run_nonio("--quiet", expect=1).stderr)
        shutil.rmtree(place["b"])
        self.run_nonio(expect=0)
        (self.site / "site.toml").write_text("# folders by id\n")
        for _ in range(2):
            self.assertIn("site.toml wants them in OUT/<id>", self.run_nonio(expect=2).stderr)
            shutil.rmtree(self.out / ".nonio", ignore_errors=True)

    # 10. Names and files that confuse

    def test_names_that_the_run_uses_itself(self):
        self.campaigns("list.nonio-tmp", "b")
        self.campaign("c", campaign_id="summary.json", run=QUICK)
        self.campaign("summary.txt", text="[[[")
        self.campaign("d", campaign_id="machines", run=QUICK)
        self.campaign("index.html", run=QUICK)
        self.run_nonio("--quiet", expect=1)
        self.assertEqual(sorted(self.ids("done")), ["b", "list.nonio-tmp"])
        self.assertEqual(len(self.ids("failed")), 4)
        self.assertTrue((self.out / "index.html").is_file())
        self.assertTrue((self.out / "summary.txt").is_file())
        self.run_nonio("--quiet", expect=1)
        self.assertEqual(sorted(self.ids("unchanged")), ["b", "list.nonio-tmp"])

    def test_a_folder_name_that_is_no_UTF_8(self):
        name = os.fsdecode(b"gr\xfcn")
        folder = self.campaign("x", campaign_id="green", run=QUICK)
        os.rename(folder, self.site / name)
        self.run_nonio(expect=0)
        self.assertEqual(self.summary()["done"][0]["folder"], "gr\\xfcn")
        done = self.run_nonio("--dry-run", "--json", expect=0)
        self.assertEqual(json.loads(done.stdout.splitlines()[-1])["reason"], "nothing changed")
        self.run_nonio(expect=0)
        self.assertEqual(self.ids("unchanged"), ["green"])

    def test_tables_within_tables_do_not_end_the_program(self):
        self.campaigns("a")
        deep = ".".join("a" * 100000)
        for text in (deep + " = 1\n", f"[{deep}]\nb = 1\n", "a = " + "{a = " * 5000 + "1" + "}" * 5000 + "\n",
                     "".join(f"a.k{i} = 1\n" for i in range(70000))):
            (self.site / "site.toml").write_text(text)
            self.assertIn("site.toml", self.run_nonio(expect=2).stderr)

    def test_a_template_folder_that_leads_back_is_an_error(self):
        self.campaigns("a")
        (self.site / "templates").mkdir()
        os.symlink(".", self.site / "templates" / "loop")
        self.assertIn("templates/loop is a link to one of its parent folders", self.run_nonio(expect=2).stderr)
        (self.site / "templates" / "loop").unlink()
        os.symlink("self", self.site / "templates" / "self")
        self.assertIn("cannot read the templates", self.run_nonio(expect=2).stderr)
        (self.site / "templates" / "self").unlink()
        self.run_nonio(expect=0)


if __name__ == "__main__":
    unittest.main()
