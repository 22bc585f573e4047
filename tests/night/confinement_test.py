# SPDX-License-Identifier: Apache-2.0
"""Plugins compute and nothing else: each hostile act is one refused result, and nothing else changes."""
import ctypes
import json
import os
import pathlib
import shutil
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
        """With plugins from beside the program a worker does many campaigns."""
        wanted = self.reference()
        own = pathlib.Path(NONIO).resolve().parents[1]
        program = self.root / "program"
        shutil.copytree(own / "lib", program / "lib", symlinks=True)
        (program / "bin").mkdir()
        shutil.copy2(NONIO, program / "bin")
        (program / "share").symlink_to(own / "share")
        plugins = next(program.rglob("csv-reader.so")).parent
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
        self.assertIn("a plugin prints: ", done.stderr)
        self.assertIn("the rest is dropped", done.stderr)
        self.assertLess(len(done.stderr), 100_000)

    def on_load(self, how, *args, expect):
        start = time.monotonic()
        done = self.run_nonio("--plugin-path", str(PLUGINS / f"on_load_{how}"), *args, expect=expect)
        return done, time.monotonic() - start

    def test_harm_while_loading_is_refused_and_the_night_goes_on(self):
        self.campaign("a")
        for how, words in {"quits": "did not survive loading: ended the process",
                           "kills": "did not survive loading: tried what no plugin may do",
                           "starts": "did not survive loading: tried what no plugin may do",
                           "rounds": "changed the rounding mode of the process while it was loaded"}.items():
            done, _ = self.on_load(how, "--force", expect=0)
            self.assertIn(words, done.stderr, how)
            self.assertEqual(self.ids("done"), ["a"])

    def test_prints_while_loading_stay_out_of_the_stream(self):
        self.campaign("a")
        done, _ = self.on_load("prints", "--json", expect=0)
        self.assertNotIn("forged", done.stdout)

    def test_loading_that_hangs_costs_its_limit_once(self):
        for i in range(3):
            self.campaign(f"c{i}")
        done, seconds = self.on_load("hangs", expect=0)
        self.assertIn("did not survive loading: no answer within 10 s", done.stderr)
        self.assertLess(seconds, 18.0)

    @unittest.skipUnless(os.geteuid() == 0, "only root is refused")
    def test_root_loads_no_plugin_that_others_can_change(self):
        self.campaign("a")
        plugins = self.root / "plugins"
        shutil.copytree(PLUGINS / "hostile", plugins)
        plugins.chmod(0o777)
        args = ("--plugin-path", str(plugins))
        done = self.run_nonio(*args, expect=2)
        self.assertIn(f"root would run code that other users can change: {plugins}", done.stderr)
        self.run_nonio(*args, "--root", expect=0)
        plugins.chmod(0o755)
        self.assertIn("this runs as root", self.run_nonio(*args, "--force", expect=0).stderr)

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
                if "test_hostile.so" in maps:
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
