# SPDX-License-Identifier: Apache-2.0
"""Plugins compute and nothing else: each hostile act is one refused result, and nothing else changes."""
import contextlib
import ctypes
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

from nightly import NONIO, PLUGINS, NightTest, tree

LANDLOCK = 444  # landlock_create_ruleset; with version flag it says the ABI
if ctypes.CDLL(None, use_errno=True).syscall(LANDLOCK, None, 0, 1) < 1:
    print("skipped: this kernel has no Landlock")
    sys.exit(77)

RUN = '[run]\nanalyses = ["iso230-2", "hostile"]\noutputs = ["csv", "heidenhain-tnc"]\n'
GOOD = '[run]\nanalyses = ["iso230-2"]\noutputs = ["csv", "heidenhain-tnc"]\n'


def processes_below(pid):
    try:
        mine = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return []
    return [int(p) for p in mine] + [q for p in mine for q in processes_below(int(p))]


class Confinement(NightTest):
    def hostile(self, how, path=""):
        self.campaign(f"m-{how}", run=RUN, extra=f'[options.hostile]\nhow = "{how}"\npath = "{path}"\n')
        return f"m-{how}"

    def night(self, *args, expect=1, **kwargs):
        return self.run_nonio("--plugin-path", str(PLUGINS / "hostile"), *args, expect=expect, **kwargs)

    def good_bytes(self, out=None):
        return {k: v for k, v in tree(out or self.out).items()
                if k.startswith(("a-good", "z-good")) and "run.json" not in k}

    def reference(self):
        for name in ("a-good", "z-good"):
            self.campaign(name, run=GOOD)
        out = self.root / "reference"
        self.night(out=out, expect=0)
        return self.good_bytes(out)

    def test_each_hostile_act_is_one_refused_result(self):
        wanted = self.reference()
        self.assertTrue(wanted)
        key = self.site / "key.p12"
        key.write_bytes(b"secret")
        (self.root / "victim").write_text("0 0\n")
        kernel, nothing = "analysis hostile (measurement X): tried what no plugin may do", None
        changed = "analysis hostile changed {} of the process; refused"
        acts = {"program": kernel, "process": kernel, "connect": kernel, "kill-parent": kernel,
                "kill-thread": kernel, "kill-all": kernel, "shared-memory": kernel, "memory-file": kernel,
                "growing-memory": kernel, "umask": kernel, "folder": kernel,
                "thread": "analysis hostile threw an exception: Resource temporarily unavailable",
                "quit": "analysis hostile (measurement X): ended the process",
                "rounding": changed.format("the rounding mode"), "locale": changed.format("the locale"),
                "signal-mask": changed.format("the signal mask"),
                # refused by the kernel, and so no harm done
                "read": nothing, "append": nothing, "make": nothing, "descriptors": nothing,
                "environment": nothing, "parent-environment": nothing}
        paths = {"program": self.root / "made", "make": self.root / "made", "read": key,
                 "append": self.root / "victim"}
        for how in acts:
            self.hostile(how, paths.get(how, ""))
        (self.site / "site.toml").write_text("[limits]\nmemory_MB = 300\n")
        shutil.rmtree(self.root / "reference")
        done = self.night("--jobs", "2", env={**os.environ, "KEY_PASSWORD": "secret"})
        for how, words in acts.items():
            results = self.results(f"m-{how}")
            errors = [e["message"] for e in results["errors"]]
            if words is nothing:
                self.assertEqual(errors, [], how)
            else:
                self.assertTrue(errors and words in errors[0], (how, errors))
        self.assertEqual({k: v for k, v in self.good_bytes().items() if not k.endswith("results.json")},
                         {k: v for k, v in wanted.items() if not k.endswith("results.json")})
        self.assertFalse((self.root / "made").exists())
        self.assertEqual((self.root / "victim").read_text(), "0 0\n")
        self.assertNotIn("forged", done.stdout)

    def test_no_process_is_left_and_no_lock_held(self):
        self.hostile("process")
        self.night()
        self.night(expect=1)  # its lock is free
        time.sleep(0.2)
        for cmdline in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                self.assertNotIn(str(self.out).encode(), cmdline.read_bytes())
            except OSError:
                pass

    def test_a_rounding_mode_of_one_changes_no_other(self):
        """With plugins in the program's own folder a worker evaluates many campaigns."""
        wanted = self.reference()
        own = pathlib.Path(NONIO).resolve().parents[1]
        program = self.root / "program"
        shutil.copytree(own / "lib", program / "lib", symlinks=True)
        (program / "bin").mkdir()
        shutil.copy2(NONIO, program / "bin")
        (program / "share").symlink_to(own / "share")
        plugins = next(program.rglob("readers.so")).parent
        shutil.copy(next((PLUGINS / "hostile").glob("*.so")), plugins)
        self.hostile("rounding")
        done = subprocess.run([program / "bin" / "nonio", "run", self.site, "--out", self.out, "--jobs", "1"],
                              capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(self.ids("failed"), ["m-rounding"])
        self.assertEqual(self.good_bytes(), wanted)

    def test_what_plugins_print_never_reaches_the_stream_of_json(self):
        self.hostile("print")
        self.hostile("print-much")
        done = self.night("--json", expect=0)
        for line in done.stdout.splitlines():
            self.assertNotEqual(json.loads(line).get("event"), "forged")
        self.assertIn("analysis hostile (measurement X) prints: ", done.stderr)
        self.assertIn("the rest is dropped", done.stderr)
        self.assertLess(len(done.stderr), 100_000)

    def on_load(self, how, *args, expect):
        start = time.monotonic()
        done = self.run_nonio("--plugin-path", str(PLUGINS / f"on_load_{how}"), *args, expect=expect)
        return done, time.monotonic() - start

    def test_harm_while_loading_is_refused_and_the_run_goes_on(self):
        self.campaign("a")
        for how, words in {"quits": "did not survive loading: ended the process",
                           "kills": "did not survive loading: tried what no plugin may do",
                           "kills-by-half": "did not survive loading: tried what no plugin may do",
                           "starts": "did not survive loading: tried what no plugin may do",
                           "rounds": "changed the rounding mode of the process while it was loaded"}.items():
            done, _ = self.on_load(how, "--force", expect=0)
            self.assertIn(words, done.stderr, how)
            self.assertEqual(self.ids("done"), ["a"])

    def test_memory_that_is_refused_once_while_an_output_prepares_is_no_note(self):
        self.campaign("a", run=GOOD)
        self.on_load("prepares-twice", expect=0)
        self.assertEqual([n for n in self.summary()["notes"] if "could not prepare" in n], [])

    def test_a_key_that_others_can_read_signs_nothing(self):
        self.campaign("a")
        key = self.site / "lab.p12"
        (self.site / "site.toml").write_text('[signing]\npkcs12 = "lab.p12"\npassword_env = "KEY_PASSWORD"\n')
        key.write_bytes(b"no key, but that comes second")
        note = lambda: next(n for n in self.summary()["notes"] if n.startswith("nothing can be signed"))
        for mode in (0o644, 0o640, 0o604, 0o620, 0o600, 0o400):
            key.chmod(mode)
            self.run_nonio("--force", env={**os.environ, "KEY_PASSWORD": "secret"}, expect=0)
            others = f"other users can get at the signing key {key} (mode {mode:04o})"
            (self.assertIn if mode & 0o077 else self.assertNotIn)(others, note())
            (self.assertIn if mode & 0o077 else self.assertNotIn)(f"chmod 600 {key}", note())

    def test_prints_while_loading_stay_out_of_the_stream(self):
        self.campaign("a")
        done, _ = self.on_load("prints", "--json", expect=0)
        self.assertNotIn("forged", done.stdout)
        self.assertIn('plugin test_on_load_prints.so prints: {"event":"forged"}', done.stderr)

    def test_loading_that_hangs_costs_its_limit_once(self):
        for i in range(3):
            self.campaign(f"c{i}")
        done, seconds = self.on_load("hangs", expect=0)
        self.assertIn("did not survive loading: no answer within 10 s", done.stderr)
        self.assertLess(seconds, 18.0)

    def verb(self, *args, plugins="hostile", expect=None):
        done = subprocess.run([NONIO, *map(str, args), "--plugin-path", str(PLUGINS / plugins)],
                              capture_output=True, text=True, timeout=120)
        if expect is not None:
            self.assertEqual(done.returncode, expect, done.stderr + done.stdout)
        return done

    def test_a_verb_prints_its_own_results_only(self):
        self.campaign("a")
        for args in (("plugins", "--json"), ("compare", self.site / "a", "--json")):
            done = self.verb(*args, plugins="on_load_prints", expect=0)
            self.assertNotIn("forged", json.dumps(json.loads(done.stdout)))
            self.assertIn("forged", done.stderr)

    def test_a_verb_outlives_what_plugins_do_while_they_are_loaded(self):
        self.campaign("a")
        for how, words in {"quits": "ended the process", "starts": "tried what no plugin may do",
                           "kills": "tried what no plugin may do"}.items():
            done = self.verb("model", "compare", self.site / "a", plugins=f"on_load_{how}", expect=0)
            self.assertIn("did not survive loading: " + words, done.stderr, how)

    def test_a_plugin_that_waits_until_it_was_tried_ends_the_verb_and_nothing_else(self):
        self.campaign("a")
        for how in ("kills-visited", "types-visited"):
            done = self.verb("model", "compare", self.site / "a", plugins=f"on_load_{how}", expect=2)
            self.assertIn("a plugin brought the process down in which it ran: tried what no plugin may do", done.stderr, how)

    def test_what_a_plugin_leaves_running_ends_with_the_verb(self):
        self.campaign("a")
        done = self.verb("model", "compare", self.site / "a", plugins="on_load_leaves-visited", expect=0)
        self.assertIn("it left a process", done.stderr)
        for command in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            with contextlib.suppress(OSError):
                self.assertNotIn(b"on_load_leaves-visited", command.read_bytes())

    @staticmethod
    def host_of(pid):
        """The plugin host, once a process computes: the eldest that has one filter of system calls; those that compute have two."""
        found = {"1": [], "2": []}
        for child in processes_below(pid):
            with contextlib.suppress(OSError, ValueError):
                status = dict(line.split(":\t", 1) for line in pathlib.Path(f"/proc/{child}/status").read_text().splitlines())
                begun = int(pathlib.Path(f"/proc/{child}/stat").read_text().rsplit(")", 1)[1].split()[19])
                found.get(status["Seccomp_filters"].strip(), []).append((begun, child))
        return min(found["1"])[1] if found["1"] and found["2"] else None

    def test_a_plugin_host_that_dies_is_made_anew(self):
        for i in range(60):
            self.campaign(f"c{i:02}", run=GOOD)
        reference = self.root / "reference"
        self.night("--date", "2026-11-03", out=reference, expect=0)
        run = subprocess.Popen(self.command("--date", "2026-11-03", "--plugin-path", str(PLUGINS / "hostile"), "--jobs", "2"),
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        killed = set()
        while run.poll() is None and len(killed) < 4:
            host = self.host_of(run.pid)
            if host and host not in killed:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(host, signal.SIGKILL)
                    killed.add(host)
        _, said = run.communicate(timeout=120)
        self.assertGreater(len(killed), 1)
        files = lambda out: {k: v for k, v in tree(out).items() if "/" in k and not k.startswith(".nonio") and not k.endswith("run.json")}
        if run.returncode == 1:  # one that was about to compute was killed too: its campaign says so
            for entry in self.summary()["failed"]:
                self.assertIn("signal 9", entry["reason"], said)
            self.night(expect=0)
        else:
            self.assertEqual(run.returncode, 0, said)
            self.assertEqual(tree(self.out), tree(reference))
        self.assertEqual(files(self.out), files(reference))

    def test_a_verb_outlives_what_plugins_of_the_program_do_while_they_are_loaded(self):
        """They are not tried in a child first: the process is made anew, and then all are."""
        self.campaign("a")
        own = pathlib.Path(NONIO).resolve().parents[1]
        for how, words in {"quits": "ended the process", "hangs": "no answer within 10 s"}.items():
            program = self.root / f"program-{how}"
            shutil.copytree(own / "lib", program / "lib", symlinks=True)
            (program / "bin").mkdir()
            shutil.copy2(NONIO, program / "bin")
            (program / "share").symlink_to(own / "share")
            plugins = next(program.rglob("readers.so")).parent
            shutil.copy(next((PLUGINS / f"on_load_{how}").glob("*.so")), plugins)
            done = subprocess.run([program / "bin" / "nonio", "compare", self.site / "a"], capture_output=True, text=True,
                                  timeout=120)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("did not survive loading: " + words, done.stderr, how)
            self.assertIn("noise floor", done.stdout)

    def test_the_key_is_hidden_from_plugins_in_runs_and_verbs(self):
        self.campaign("a", run=GOOD)
        folder = self.site / "keys"
        folder.mkdir()
        key = folder / "lab.p12"
        key.write_bytes(b"secret")
        (folder / "password").write_text("secret\n")
        reads = PLUGINS / "on_load_reads"
        for secret in (key, folder / "password"):
            environment = {**os.environ, "NONIO_TEST_KEY": str(secret)}
            (self.site / "site.toml").write_text("")
            said = lambda *args: subprocess.run([NONIO, *map(str, args), "--plugin-path", reads], env=environment,
                                                capture_output=True, text=True, timeout=120).stderr
            compare = ("compare", self.site / "a")
            self.assertIn("it has the key", said(*compare))  # site.toml does not name it as the key
            (self.site / "site.toml").write_text(
                '[signing]\npkcs12 = "keys/lab.p12"\npassword_file = "keys/password"\n')
            self.assertNotIn("it has the key", said(*compare))
            self.assertNotIn("it has the key", said("run", self.site, "--out", self.out))

    def test_the_hashes_of_passwords_are_hidden_from_plugins(self):
        self.campaign("a", run=GOOD)
        for name, hidden in (("users.toml", True), ("other.toml", False)):
            (self.site / name).write_text("format = 1\n")
            for args in (("compare", self.site / "a"), ("run", self.site, "--out", self.out, "--force")):
                said = subprocess.run([NONIO, *map(str, args), "--plugin-path", PLUGINS / "on_load_reads"], env={**os.environ, "NONIO_TEST_KEY": str(self.site / name)}, capture_output=True, text=True, timeout=120).stderr
                if hidden:
                    self.assertNotIn("it has the key", said)
                elif args[0] == "compare":  # in a run plugins read no file of a site at all
                    self.assertIn("it has the key", said)

    def test_a_verb_loads_what_hangs_once(self):
        start = time.monotonic()
        self.verb("plugin", "list", plugins="on_load_hangs")
        self.assertLess(time.monotonic() - start, 18.0)

    def test_no_plugin_code_in_the_process_of_a_verb(self):
        run = subprocess.Popen([NONIO, "plugin", "list", "--plugin-path", str(PLUGINS / "on_load_hangs")],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        with_plugins = set()
        for _ in range(30):
            for pid in [run.pid, *processes_below(run.pid)]:
                try:
                    if "test_on_load_hangs.so" in pathlib.Path(f"/proc/{pid}/maps").read_text():
                        with_plugins.add(pid)
                except OSError:
                    pass
            time.sleep(0.05)
        run.kill()
        run.wait()
        self.assertTrue(with_plugins)
        self.assertNotIn(run.pid, with_plugins)

    @unittest.skipUnless(os.geteuid() == 0, "only root is refused")
    def test_root_loads_no_plugin_that_others_can_change(self):
        self.campaign("a")
        plugins = self.root / "plugins"
        shutil.copytree(PLUGINS / "hostile", plugins)
        args = ("--plugin-path", str(plugins))
        for mode in (0o777, 0o775):
            plugins.chmod(mode)
            done = self.run_nonio(*args, expect=2)
            self.assertIn(f"root would run code that other users can change: {plugins}", done.stderr)
        self.run_nonio(*args, "--root", expect=0)
        plugins.chmod(0o755)
        self.assertIn("running as root is not needed", self.run_nonio(*args, "--force", expect=0).stderr)

    def test_no_plugin_code_in_the_main_process(self):
        """Nor in those that have files and register."""
        self.campaign("a", run=RUN, extra='[options.hostile]\nhow = "well"\n')
        for i in range(40):
            self.campaign(f"c{i}", run=GOOD)
        run = subprocess.Popen(self.command("--plugin-path", str(PLUGINS / "hostile"), "--jobs", "1"),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        seen, with_plugins, looked = set(), set(), 0
        while run.poll() is None:
            for pid in [run.pid, *processes_below(run.pid)]:
                try:
                    maps = pathlib.Path(f"/proc/{pid}/maps").read_text()
                except OSError:
                    continue
                seen.add(pid)
                # As code: to take its digest any process may map the file and read it.
                if any("x" in line.split()[1] for line in maps.splitlines() if line.endswith("test_hostile.so")):
                    with_plugins.add(pid)
                    status = pathlib.Path(f"/proc/{pid}/status")
                    try:
                        looked += "NoNewPrivs:\t1" in status.read_text()
                    except OSError:
                        pass
        self.assertNotIn(run.pid, with_plugins)
        self.assertTrue(with_plugins and seen - with_plugins - {run.pid})
        self.assertGreater(looked, 0)


if __name__ == "__main__":
    unittest.main()
