# SPDX-License-Identifier: Apache-2.0
"""Archives of a site and of its output: complete, also during a run; damage; older states; former versions."""
import hashlib
import io
import json
import os
import random
import shutil
import sqlite3
import stat
import subprocess
import tarfile
import unittest

from numbered import NumberedTest, number
from signing import NONIO, run

SEED = int(os.environ.get("NONIO_SEED", str(random.randrange(10**6))))
LIST = ".nonio-backup.sha256"


class Backup(NumberedTest):
    def backup(self, folder, name, expect=0):
        file = self.root / name
        done = run(NONIO, "backup", folder, file, check=False)
        self.assertEqual(done.returncode, expect, done.stderr)
        return file if expect == 0 else done.stderr

    def restore(self, file, folder, *args, expect=0):
        done = run(NONIO, "restore", file, folder, *args, check=False)
        self.assertEqual(done.returncode, expect, done.stdout + done.stderr)
        return done

    @staticmethod
    def content(folder):
        """Names with bytes, permissions and targets of links."""
        found = {}
        for path in sorted(folder.rglob("*")):
            name = path.relative_to(folder).as_posix()
            if path.is_symlink():
                found[name] = ("link", os.readlink(path))
            elif path.is_dir():
                found[name] = ("folder", stat.S_IMODE(path.stat().st_mode))
            elif name not in (".nonio/lock", ".nonio/user"):
                found[name] = (path.read_bytes(), stat.S_IMODE(path.stat().st_mode), int(path.stat().st_mtime))
        return found

    def test_every_file_comes_back_as_it_was(self):
        print(f"seed {SEED} (NONIO_SEED)", flush=True)
        rng = random.Random(SEED)
        folder = self.root / "folder"
        (folder / "deep" / ("long " * 20) / ("name" * 25)).mkdir(parents=True)
        (folder / "empty").mkdir(mode=0o700)
        for name, size in (("a", 0), ("b.csv", 511), ("c", 512), ("deep/d", 513), (f"deep/{'long ' * 20}/{'name' * 25}/{'x' * 200}", 70000),
                           ("grün ü.txt", 3 << 20), (".hidden", 5), ("certificates.sqlite-journal", 9)):
            path = folder / name
            path.write_bytes(rng.randbytes(size))
            path.chmod(rng.choice((0o600, 0o644, 0o755)))
            os.utime(path, (10 ** 9, rng.randrange(10 ** 9)))
        (folder / "link").symlink_to("deep/d")
        (folder / "away").symlink_to("/nonexistent/" + "y" * 120)
        (folder / ".half.nonio-tmp").write_text("half")
        file = self.backup(folder, "folder.tar")
        self.assertEqual(stat.S_IMODE(file.stat().st_mode) & 0o077, 0)
        self.restore(file, self.root / "back")
        for command in (("backup", "folder", "again.tar"), ("restore", "again.tar", "relative/to/here")):
            subprocess.run([NONIO, *command], cwd=self.root, check=True, stdout=subprocess.DEVNULL)
        self.assertEqual(self.content(self.root / "relative/to/here"), self.content(self.root / "back"))
        wanted = self.content(folder)
        del wanted[".half.nonio-tmp"]
        self.assertEqual(self.content(self.root / "back"), wanted)
        # Other programs read it: an independent reader of tar, and the digests as coreutils check them.
        with tarfile.open(file) as tar:
            tar.extractall(self.root / "python", filter="fully_trusted") if hasattr(tarfile, "fully_trusted_filter") else tar.extractall(self.root / "python")
        subprocess.run(["sha256sum", "--quiet", "--strict", "-c", LIST], cwd=self.root / "python", check=True)
        (self.root / "python" / LIST).unlink()
        self.assertEqual(self.content(self.root / "python"), wanted)
        subprocess.run(["tar", "-tf", file], check=True, stdout=subprocess.DEVNULL)

    def test_what_is_behind_a_link_is_named(self):
        folder, elsewhere = self.root / "folder", self.root / "elsewhere"
        for path in (folder / "own/c1", elsewhere / "c2"):
            path.mkdir(parents=True)
            (path / "campaign.toml").write_text("format = 1\n")
        (folder / "inside").symlink_to("own")
        (folder / "2025").symlink_to(elsewhere)
        (folder / "own/relative").symlink_to("../../elsewhere/c2/campaign.toml")
        os.mkfifo(folder / "pipe")
        for given in (folder, self.root / "way"):  # also where the folder is behind a link itself
            if given != folder:
                given.symlink_to(folder)
            done = subprocess.run([NONIO, "backup", given, self.root / f"{given.name}.tar", "--json", "--quiet"], capture_output=True, text=True, check=True)
            self.assertEqual([{"name": "2025", "link_to": str(elsewhere)}, {"name": "own/relative", "link_to": "../../elsewhere/c2/campaign.toml"}, {"name": "pipe"}],
                             sorted(json.loads(done.stdout)["left_out"], key=lambda one: one["name"]))
            self.assertIn(f"2025 is a link to {elsewhere}, which is outside of the folder: what it contains is not in the backup", done.stderr)
            self.assertNotIn("inside", done.stderr)

    def test_what_is_damaged_or_foreign_is_refused_before_anything_is_written(self):
        folder = self.root / "folder"
        folder.mkdir()
        for k in range(4):
            (folder / f"f{k}").write_bytes(bytes([65 + k]) * 1500)
        good = self.backup(folder, "good.tar")
        bytes_ = good.read_bytes()
        bad, back = self.root / "bad.tar", self.root / "back"
        at = bytes_.index(b"C" * 1500)
        digest = bytes_.index(hashlib.sha256(b"B" * 1500).hexdigest().encode())
        for name, data, words in (("byte", bytes_[:at] + b"x" + bytes_[at + 1:], "f2 does not have its SHA-256"),
                                  ("digest", bytes_[:digest] + b"0" * 64 + bytes_[digest + 64:], "f1 does not have its SHA-256"),
                                  ("cut", bytes_[:at + 700], "cut short"), ("no end", bytes_[:-1024], "cut short"),
                                  ("empty", b"", "cut short"), ("text", b"not an archive\n" * 100, "no archive")):
            bad.write_bytes(data)
            self.assertIn(words, self.restore(bad, back, expect=2).stderr, name)
            self.assertFalse(back.exists(), name)

        def made(*members):
            out = io.BytesIO()
            with tarfile.open(fileobj=out, mode="w", format=tarfile.PAX_FORMAT) as tar:
                listed = ""
                for info, data in members:
                    info.size = len(data)
                    tar.addfile(info, io.BytesIO(data))
                    if info.isreg():
                        listed += f"{hashlib.sha256(data).hexdigest()}  {info.name}\n"
                info = tarfile.TarInfo(LIST)
                info.size = len(listed)
                tar.addfile(info, io.BytesIO(listed.encode()))
            bad.write_bytes(out.getvalue())

        def link(name, to, kind=tarfile.SYMTYPE):
            info = tarfile.TarInfo(name)
            info.type, info.linkname = kind, to
            return info
        for member, words in ((tarfile.TarInfo("../f"), "outside of its folder"), (tarfile.TarInfo("/f"), "outside of its folder"),
                              (tarfile.TarInfo("a/../../f"), "outside of its folder"), (link("f", "g", tarfile.LNKTYPE), "something else"),
                              (link("f", "", tarfile.FIFOTYPE), "something else")):
            made((member, b""))
            self.assertIn(words, self.restore(bad, back, expect=2).stderr)
        made((link("x", str(self.root / "outside")), b""), (tarfile.TarInfo("x/f"), b"through a link"))
        self.restore(bad, back, expect=2)
        for first, second in ((link("up", ".."), link("up/planted", "/etc/passwd")), (link("up/planted", "/etc/passwd"), link("up", ".."))):
            made((first, b""), (second, b""))
            self.assertIn("below a link", self.restore(bad, back, expect=2).stderr)
            self.assertFalse((self.root / "planted").is_symlink())
        made((tarfile.TarInfo("x"), b"1"), (tarfile.TarInfo("x"), b"2"))
        self.assertIn("twice", self.restore(bad, back, expect=2).stderr)
        self.assertEqual([p.name for p in self.root.iterdir() if p.name in ("outside", "f", "back")], [])
        back.mkdir()
        self.restore(good, back)
        self.assertEqual(0o700, back.stat().st_mode & 0o777, "there may be keys in it")
        self.assertIn("has content", self.restore(good, back, expect=2).stderr)
        self.assertIn("exists already", self.backup(folder, "good.tar", expect=2))
        self.assertIn("in the folder itself", self.backup(folder, "folder/in.tar", expect=2))
        rng = random.Random(SEED)
        for _ in range(200 if os.environ.get("NONIO_LONG") else 40):  # no byte changes a file silently
            at = rng.randrange(len(bytes_))
            bad.write_bytes(bytes_[:at] + bytes([bytes_[at] ^ (1 << rng.randrange(8))]) + bytes_[at + 1:])
            shutil.rmtree(back)
            done = run(NONIO, "restore", bad, back, check=False)
            self.assertIn(done.returncode, (0, 2), (SEED, at, done.stderr))
            if done.returncode == 0:
                self.assertEqual({p.name: p.read_bytes() for p in back.iterdir()}, {p.name: p.read_bytes() for p in folder.iterdir()}, (SEED, at))
            else:
                back.mkdir(exist_ok=True)

    def test_archives_of_a_run_in_progress_are_each_a_state_from_which_the_next_run_goes_on(self):
        names = [f"c{k:02}" for k in range(24)]
        for name in names:
            self.signed_campaign(name)
        going = subprocess.Popen([NONIO, "run", self.site, "--out", self.out, "--jobs", "2", "--quiet"], env=self.environment,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(going.wait)
        self.addCleanup(going.kill)
        taken = []
        while going.poll() is None and len(taken) < (6 if os.environ.get("NONIO_LONG") else 3):
            if not self.out.exists():
                continue
            k = len(taken)
            taken.append((self.backup(self.out, f"out{k}.tar"), self.backup(self.site, f"site{k}.tar")))
        self.assertIn(going.wait(), (0, 1))
        self.assertGreater(len(taken), 0, "the run was over before an archive was written")
        counts = []
        self.site.rename(self.root / "lost")  # an output folder goes on with a copy of its site where the site is no longer there
        for out, site in taken:
            folder = self.root / f"state{len(counts)}"
            self.restore(site, folder / "site")
            self.restore(out, folder / "out")
            counts.append(0)
            if (folder / "site/certificates.sqlite").exists():  # else the run had issued nothing yet
                audit = json.loads(run(NONIO, "certificate", "audit", folder / "site", "--json").stdout)
                self.assertTrue(audit["sound"], audit)
                counts[-1] = audit["certificates"]
            again = run(NONIO, "run", folder / "site", "--out", folder / "out", "--quiet", check=False, env=self.environment)
            self.assertEqual(again.returncode, 0, again.stderr)
            states = json.loads(run(NONIO, "certificate", "list", folder / "site", "--json").stdout)["certificates"]
            self.assertEqual(sorted(e["campaign"] for e in states if e["state"] == "issued"), names)
            self.assertEqual(sorted(e["number"] for e in states), [number(k + 1) for k in range(len(names))])
        self.assertEqual(counts, sorted(counts))

    def test_an_older_register_names_what_was_issued_since(self):
        self.signed_campaign("c1")
        self.night()
        site = self.backup(self.site, "site.tar")
        self.restore(site, self.root / "same", "--out", self.out)
        self.signed_campaign("c2")
        self.signed_campaign("c3")
        self.night()
        done = self.restore(site, self.root / "older", "--out", self.out, "--json", expect=1)
        since = json.loads(done.stdout)["issued_since"]
        self.assertEqual(sorted(e["number"] for e in since), [number(2), number(3)])
        self.assertEqual({e["campaign"] for e in since}, {"c2", "c3"})
        self.assertIn("Restore a newer backup of the site", done.stderr)
        # The run says the same and draws no number; with the newest state it goes on.
        for name in ("c2", "c3"):
            shutil.copytree(self.site / name, self.root / "older" / name)
        refused = run(NONIO, "run", self.root / "older", "--out", self.out, "--quiet", check=False, env=self.environment)
        self.assertNotEqual(refused.returncode, 0)
        newest = self.backup(self.site, "newest.tar")
        self.restore(newest, self.root / "newest", "--out", self.out)

    def test_states_of_former_versions_are_taken_over_or_made_again(self):
        self.signed_campaign("c1")
        self.night()
        before = self.issued_files()
        with sqlite3.connect(self.site / "certificates.sqlite") as register:
            for sql in ("DROP TABLE journal", "DROP TABLE site", "DROP TABLE drafts", "PRAGMA user_version = 1"):
                register.execute(sql)
        register.close()
        (self.site / "certificates.sqlite.identity").unlink()
        with sqlite3.connect(self.out / "history.sqlite") as store:
            (rows,) = store.execute("SELECT count(*) FROM evaluation").fetchone()
            store.execute("UPDATE store SET value = '6' WHERE name = 'schema'")
            store.execute("PRAGMA user_version = 6")
        store.close()
        site, out = self.backup(self.site, "site.tar"), self.backup(self.out, "out.tar")
        shutil.rmtree(self.site)
        shutil.rmtree(self.out)
        self.restore(site, self.site)
        self.restore(out, self.out)
        asked = run(NONIO, "machine", "list", self.out, check=False)
        self.assertIn("`nonio run` makes it again", asked.stderr)
        self.night()
        self.assertEqual(self.issued_files(), before)
        self.assertEqual(self.states(), {number(1): "issued"})
        with sqlite3.connect(self.out / "history.sqlite") as store:
            self.assertEqual(store.execute("SELECT count(*) FROM evaluation").fetchone(), (rows,))
        store.close()
        # Each former version of the history is made again from the results; 1 to 3 had fewer tables.
        shown = lambda: json.loads(run(NONIO, "machine", "history", self.out, "--json").stdout)["series"]
        wanted = shown()
        for version in range(1, 7):
            with sqlite3.connect(self.out / "history.sqlite") as store:
                store.execute("UPDATE store SET value = ? WHERE name = 'schema'", (version,))
                store.execute(f"PRAGMA user_version = {version}")
                if version < 4:
                    store.execute("DROP TABLE evaluation")
            store.close()
            self.night()
            self.assertEqual(wanted, shown(), version)
            self.assertEqual(self.issued_files(), before)


if __name__ == "__main__":
    unittest.main()
