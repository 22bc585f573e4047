# SPDX-License-Identifier: Apache-2.0
"""help, version, man page, completion; the nearest word for a mistyped one."""
import json
import pathlib
import re
import shutil
import subprocess
import unittest

from verbs import NONIO, VerbTest, manifest, readings


def verb_paths():
    """Every verb with the words that lead to it, as the completion lists them."""
    script = subprocess.run([NONIO, "completion", "bash"], capture_output=True, text=True, check=True).stdout
    return [path.split()[1:] for path in re.findall(r'^ +"(nonio [a-z -]+)"\) ;;$', script, re.MULTILINE)]


class Help(VerbTest):
    def test_plain_program_shows_its_help_and_fails(self):
        plain, asked = self.nonio(expect=2), self.nonio("help")
        self.assertEqual((plain.stdout, plain.stderr), ("", asked.stdout))
        self.assertEqual(asked.stdout, self.nonio("--help").stdout)
        for group in ("Every night:", "Campaigns:", "Certificates:", "The error model:", "At the machine:", "Plugins:"):
            self.assertIn(f"\n{group}\n", asked.stdout)

    def test_help_of_every_verb_is_that_of_the_verb(self):
        paths = verb_paths()
        self.assertGreater(len(paths), 25)
        for words in paths:
            shown = self.nonio("help", *words).stdout
            self.assertEqual(shown, self.nonio(*words, "--help").stdout)
            self.assertIn("Usage: nonio " + " ".join(words), shown)
        program = self.nonio("help").stdout
        for words in paths:
            if len(words) == 1:
                self.assertRegex(program, rf"(?m)^  {words[0]} +\S")

    def test_lines_of_help_fit_a_wide_terminal(self):
        for words in verb_paths():
            for line in self.nonio("help", *words).stdout.splitlines():
                self.assertLessEqual(len(line), 120, f"{words}: {line}")

    def test_version_says_where_things_are(self):
        said = json.loads(self.nonio("version", "--json").stdout)
        self.assertEqual(self.nonio("--version").stdout, f"nonio {said['version']}\n")
        plain = self.nonio("version").stdout
        for text in (said["abi"], *said["plugins"], *said["templates"]):
            self.assertIn(text, plain)
        self.assertEqual(said["abi"], json.loads(self.nonio("plugin", "list", "--json").stdout)["abi"])


class Mistyped(VerbTest):
    def refused(self, *words):
        done = self.nonio(*words, expect=2)
        self.assertEqual(done.stdout, "")
        return done.stderr

    def test_verbs_and_options(self):
        for words, nearest in ((["rnu"], "run"), (["plan", "tripels"], "triples"), (["model", "ad"], "add"),
                               (["run", self.site, "--ot", "x"], "--out"), (["help", "exlpain"], "explain"),
                               (["--verison"], "--version"), (["completion", "bsh"], "bash"),
                               (["plan", "triples", "--x=1", "--y=1", "--even=prefr"], "prefer"),
                               (["new", "capmaign", "x"], "campaign")):
            self.assertIn(f'(nearest: "{nearest}")', self.refused(*words), words)

    def test_what_is_nothing_like_a_verb_gets_the_list(self):
        self.assertIn("there are run, ", self.refused("xyzzyxyzzy"))
        self.assertIn("expected a verb: triples, program, rotary, table, sign-probe", self.refused("plan"))
        self.assertIn("there is no verb below it", self.refused("help", "run", "x"))

    def test_values_that_begin_with_a_dash_are_not_options(self):
        self.assertIn("--why", self.refused("certificate", "list", self.site, "--why", "--broken"))
        self.assertNotIn("no option", self.refused("certificate", "list", self.site, "--why", "--broken"))

    def test_plugins_effects_and_kinds(self):
        self.campaign(manifest(effects=[]), x=readings(backlash=-6.0))
        self.assertIn('nearest: "effect"', self.refused("plugin", "new", "efect", "mine"))
        self.assertIn('nearest: "linuxcnc"', self.refused("table", "controls", "linuxnc"))
        self.assertIn('nearest: "backlash:X"', self.refused("model", "add", self.folder, "backlsh:X"))
        for control in ("simens", "program-simens"):
            self.assertIn('nearest: "siemens"', self.refused(
                "plan", "program", "--axis", "X=0:8", "--control", control, "--out", self.site / "p"))
        table = self.site / "t.comp"
        table.write_text("0 0 0\n")
        self.assertIn('nearest: "linuxcnc"', self.refused("table", "diff", table, table, "--control", "linuxnc"))

    def test_one_plugin_of_a_library(self):
        files = {pathlib.Path(f["path"]): f["plugins"] for f in json.loads(self.nonio("plugin", "list", "--json").stdout)["files"]}
        effects = next(path for path in files if path.name == "effects.so")
        self.assertIn("effect backlash 1.0.0", files[effects])
        listed = self.nonio("plugin", "list", "--quiet").stdout
        for path, plugins in files.items():
            self.assertIn("".join(f"\n    {plugin}" for plugin in plugins) + "\n", listed.split(str(path))[1])
        done = self.nonio("plugin", "check", effects, "--plugin", "backlash", "--only", "names", "--json")
        self.assertEqual({"effect backlash"}, {check["plugin"] for check in json.loads(done.stdout)["checks"]})
        refused = self.nonio("plugin", "check", effects, "--plugin", "backlsh", expect=2).stderr
        self.assertIn('there is no plugin "backlsh"', refused)
        self.assertIn('nearest: "backlash"', refused)

    def test_names_in_the_manifest(self):
        for key, wrong, nearest in (("analyses", "iso230-3", "iso230-2"), ("outputs", "pdf-reprot", "pdf-report")):
            self.campaign(manifest(effects=None, extra=f'[run]\n{key} = ["{wrong}"]\n'), x=readings())
            shown = " ".join(self.nonio("show", self.folder, expect=1).stdout.split())
            self.assertIn(f'nearest: "{nearest}"', shown)
            if key == "analyses":
                self.assertIn("measurement X: None of the selected analyses evaluates", shown)


class Pages(VerbTest):
    def test_man_page_has_every_verb_and_no_warning(self):
        page = self.nonio("help", "--man").stdout
        for words in verb_paths():
            self.assertIn(".SS nonio " + " ".join(words).replace("-", "\\-"), page)
        if shutil.which("groff") is None:
            self.skipTest("groff is not installed: the man page was not formatted")
        done = subprocess.run(["groff", "-man", "-ww", "-z"], input=page, capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    BASH = """
source <("$NONIO" completion bash) && cd "$SITE" && complete -p nonio
t() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _nonio; echo "${COMPREPLY[*]}"; }
t nonio ru
t nonio plan ""
t nonio plan triples --max-p
t nonio plan triples --even = pr
t nonio completion ""
t nonio model compare ""
t nonio table probe c --out ""
"""

    def test_bash(self):
        self.campaign(manifest(), x=readings())
        (self.site / "file.txt").write_text("")
        done = subprocess.run(["bash", "--norc", "-c", self.BASH], capture_output=True, text=True, check=False,
                              env={"NONIO": NONIO, "SITE": str(self.site), "PATH": "/usr/bin:/bin"})
        self.assertEqual(done.stderr, "")
        self.assertEqual(done.stdout.splitlines(), [
            "complete -F _nonio nonio", "run", "triples program rotary table sign-probe --help", "--max-points", "prefer",
            "bash zsh", "c", "c"])

    ZSH = r"""
zmodload zsh/zpty && cd $SITE
zpty z 'zsh -f -i'
zpty -w z 'PS1="% "; fpath=($SITE/functions $fpath); autoload -Uz compinit; compinit -u -D; PATH=$SITE:$PATH; echo RE""ADY'
zpty -r z out '*READY*'
for line in $LINES_TO_COMPLETE; do
  zpty -w -n z "${line//_/ }"$'\t'
  sleep 1
  out=""; while zpty -r -t z chunk; do out+=$chunk; done
  print -r -- "${(V)out}"
  zpty -w -n z $'\C-u'
  sleep 0.2
  while zpty -r -t z chunk; do :; done
done
zpty -d z
"""

    def test_zsh(self):
        if shutil.which("zsh") is None:
            self.skipTest("zsh is not installed: its completion was not tried")
        functions = self.site / "functions"
        functions.mkdir()
        script = functions / "_nonio"
        script.write_text(self.nonio("completion", "zsh").stdout)
        subprocess.run(["zsh", "-n", script], check=True)
        (self.site / "nonio").symlink_to(NONIO)
        typed = {"nonio_plan_t": "triples", "nonio_run_--o": "--out", "nonio_completion_b": "bash",
                 "nonio_explain_fun": "functions"}
        done = subprocess.run(
            ["zsh", "-f", "-c", self.ZSH.replace("$LINES_TO_COMPLETE", " ".join(typed))], capture_output=True,
            text=True, timeout=120, check=False,
            env={"SITE": str(self.site), "PATH": "/usr/bin:/bin", "TERM": "xterm", "HOME": str(self.site)})
        for line, expected in zip(done.stdout.splitlines()[-len(typed):], typed.values(), strict=True):
            self.assertIn(expected, line, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
