# SPDX-License-Identifier: Apache-2.0
"""help, version, man page, completion; the nearest word for a mistyped one."""
import json
import pathlib
import re
import shlex
import shutil
import subprocess
import unittest

from verbs import NONIO, VerbTest, manifest, readings


def table():
    """The table of commands that help, the manual page and completion are made from."""
    return json.loads(subprocess.run([NONIO, "help", "--json"], capture_output=True, text=True, check=True).stdout)


def verb_paths():
    """Every command with the words that lead to it."""
    return [c["command"].split()[1:] for c in table()["commands"]]


class Table(VerbTest):
    """Every command has help and examples that its own arguments allow; former names lead to it."""

    def test_at_most_fifteen_commands_at_the_top(self):
        top = [c for c in table()["commands"] if c["listed"] and len(c["command"].split()) == 2]
        self.assertLessEqual(len(top), 15)
        self.assertEqual(re.findall(r"(?m)^  (\S+) ", self.nonio("help").stdout), [c["command"].split()[1] for c in top])

    def test_every_command_and_argument_is_described(self):
        for c in table()["commands"]:
            self.assertTrue(c["summary"], c)
            if c["runs"]:
                self.assertTrue(c["examples"], c["command"])
            for a in c["arguments"]:
                self.assertTrue(a["help"] or a.get("hidden"), (c["command"], a))
                self.assertNotIn("\n", a["help"])

    def test_examples_are_calls_of_their_command(self):
        for c in table()["commands"]:
            for example in c["examples"]:
                with self.subTest(example):
                    words = shlex.split(re.split(r" [|>&]", example)[0])
                    path = c["command"].split()
                    self.assertEqual(words[:len(path)], path)
                    self.allowed(c["arguments"], words[len(path):])

    def allowed(self, arguments, words):
        """Every option exists and has a value of its kind; nothing that is required is missing."""
        options = {a["name"]: a for a in arguments if a["name"].startswith("-")}
        places = [a for a in arguments if not a["name"].startswith("-")]
        given, positional = set(), []
        words = iter(words)
        for word in words:
            if not word.startswith("--"):
                positional.append(word)
                continue
            name, equals, value = word.partition("=")
            self.assertIn(name, options)
            given.add(name)
            a = options[name]
            if a["kind"] != "flag" and not equals and "value_of_bare" not in a:
                value = next(words)
            if "choices" in a and value:
                self.assertIn(value, a["choices"])
            if a["kind"] in ("integer", "number"):
                float(value)
        self.assertGreaterEqual(len(positional), sum(a["required"] for a in places))
        if not any(a["kind"] == "list" for a in places):
            self.assertLessEqual(len(positional), len(places))
        self.assertLessEqual({a["name"] for a in options.values() if a["required"]}, given)

    def test_a_missing_argument_or_value_is_named_with_its_meaning_and_an_example(self):
        missing, valueless = 0, 0
        for command in table()["commands"]:
            words = command["command"].split()[1:]
            needed = [a for a in command["arguments"] if a["required"]]
            wrong = []
            if needed:
                wrong.append((words, f"{needed[0]['name']}.* is missing: ", needed[0]))
                missing += 1
            for a in command["arguments"]:
                if a["name"].startswith("--") and a["kind"] != "flag" and "value_of_bare" not in a:
                    wrong.append(([*words, a["name"]], f"{a['name']} requires a value, {a['name']} [A-Z|a-z0-9-]+: ", a))
                    valueless += 1
                    break
            for given, pattern, a in wrong:
                said = self.nonio(*given, expect=2).stderr
                self.assertRegex(said, f"^nonio {' '.join(words)}: {pattern}", given)
                self.assertIn(a["help"], said)
                self.assertEqual("examples" in command and bool(command["examples"]), "\nExample: nonio " in said, said)
        self.assertGreater(missing, 25)
        self.assertGreater(valueless, 30)

    def test_one_argument_too_many_is_named(self):
        said = self.nonio("run", self.site, "--out", "x", "one", "two", expect=2).stderr
        self.assertIn('unexpected argument "one"; expected nonio run SITE --out FOLDER [OPTIONS]', said)

    def test_former_names(self):
        known = {c["command"] for c in table()["commands"]}
        for alias in table()["aliases"]:
            old, new = alias["old"].split()[1:], alias["command"].split()
            command = " ".join(w for w in new if not w.startswith("--"))
            self.assertIn(command, known)
            self.assertEqual(self.nonio("help", *old).stdout, self.nonio("help", *command.split()[1:]).stdout)
            self.assertNotRegex(self.nonio("help").stdout, rf"(?m)^  {old[0]} " if len(old) == 1 else r"\Z.")
            self.assertIn(f"nonio {' '.join(old)}: there is no option --no-such",
                          self.nonio(*old, "--no-such", expect=2).stderr)

    def test_a_former_name_does_the_same_and_says_so_once(self):
        self.campaign(manifest(), x=readings(backlash=-6.0))
        now, before = self.nonio("model", "compare", self.folder), self.nonio("compare", self.folder)
        self.assertEqual((now.stdout, now.stderr), (before.stdout, before.stderr))
        now, before = self.nonio("table", "controls"), self.nonio("controllers")
        self.assertEqual(now.stdout, before.stdout)
        self.assertEqual(before.stderr, "'nonio controllers' is now 'nonio table controls'; the old name will be removed in "
                         "version 0.3\n" + now.stderr)
        self.assertEqual(self.nonio("release", self.site, "--list", "--json").stdout,
                         self.nonio("certificate", "approve", self.site, "--list", "--json").stdout)

    def test_contract_names_are_not_announced(self):
        quiet = {a["old"].split(" ", 1)[1] for a in table()["aliases"] if not a["announced"]}
        self.assertEqual(quiet, {"compare", "explain", "simulate", "verify", "plugins", "history"})

    def test_synonyms(self):
        known = {c["command"] for c in table()["commands"]}
        for word, command in table()["synonyms"].items():
            said = self.nonio(word, expect=2).stderr
            self.assertIn(f'(did you mean "{command}"?)', said)
            self.assertTrue(command in known or command.rsplit(" ", 1)[0] in known, command)
        for word, command in (("withdraw", "certificate withdraw"), ("triples", "plan triples"), ("audit", "certificate audit")):
            self.assertIn(f'"nonio {command}"', self.nonio(word, expect=2).stderr)


class Help(VerbTest):
    def test_plain_program_shows_its_help_and_fails(self):
        plain, asked = self.nonio(expect=2), self.nonio("help")
        self.assertEqual((plain.stdout, plain.stderr), ("", asked.stdout))
        self.assertEqual(asked.stdout, self.nonio("--help").stdout)
        for group in ("Prepare:", "Evaluate:", "Follow up:", "Program:"):
            self.assertIn(f"\n{group}\n", asked.stdout)

    def test_help_of_every_command_is_that_of_the_command(self):
        paths = verb_paths()
        self.assertGreater(len(paths), 40)
        for words in paths:
            shown = self.nonio("help", *words).stdout
            self.assertEqual(shown, self.nonio(*words, "--help").stdout)
            self.assertIn("Usage: nonio " + " ".join(words), shown)

    def test_lines_of_help_fit_a_terminal(self):
        for words in [[], *verb_paths()]:
            for line in self.nonio("help", *words).stdout.splitlines():
                self.assertLessEqual(len(line), 100, f"{words}: {line}")

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
        for words, nearest in ((["rnu"], "run"), (["plan", "tripels"], "triples"), (["modle"], "model"), (["model", "ad"], "add"),
                               (["run", self.site, "--ot", "x"], "--out"), (["help", "exlpain"], "explain"), (["certificate", "aprove"], "approve"),
                               (["--verison"], "--version"), (["completion", "bsh"], "bash"),
                               (["plan", "triples", "--x=1", "--y=1", "--even=prefr"], "prefer"),
                               (["new", "capmaign", "x"], "campaign")):
            self.assertIn(f'(nearest: "{nearest}")', self.refused(*words), words)

    def test_what_is_nothing_like_a_command_leads_to_the_list(self):
        self.assertIn("`nonio help` lists the commands", self.refused("xyzzyxyzzy"))
        self.assertIn("expected one of triples, program, rotary, table", self.refused("plan"))
        self.assertIn("there is no command below it", self.refused("help", "run", "x"))

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
        listed = self.nonio("plugin", "list", "--all").stdout
        for path, plugins in files.items():
            self.assertIn("".join(f"\n  {plugin}" for plugin in plugins) + "\n", listed.split(str(path))[1])
        one = self.nonio("plugin", "list", "backlash").stdout
        self.assertTrue(one.startswith("effect "), one)
        self.assertNotIn(".so", one)
        self.assertNotIn("[options.", self.nonio("plugin", "list").stdout)
        self.assertIn('nearest: "backlash"', self.refused("plugin", "list", "backlsh"))
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
            "complete -F _nonio nonio", "run", "triples program rotary table --help", "--max-points", "prefer",
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
                 "nonio_check_fun": "functions"}
        done = subprocess.run(
            ["zsh", "-f", "-c", self.ZSH.replace("$LINES_TO_COMPLETE", " ".join(typed))], capture_output=True,
            text=True, timeout=120, check=False,
            env={"SITE": str(self.site), "PATH": "/usr/bin:/bin", "TERM": "xterm", "HOME": str(self.site)})
        for line, expected in zip(done.stdout.splitlines()[-len(typed):], typed.values(), strict=True):
            self.assertIn(expected, line, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
