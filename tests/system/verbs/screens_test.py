# SPDX-License-Identifier: Apache-2.0
"""No screen of a German or an Italian site contains an English word, a decimal point, or two forms of a unit or of U.

Not checked, because these are English in every language (docs/site.md, `language`): messages of errors, --help, JSON."""
import os
import pathlib
import re
import shutil
import tempfile
import tomllib
import unittest

from verbs import VerbTest

os.environ["NONIO_ALLOW_ROOT"] = "1"  # its warning is English
ROOT = pathlib.Path(__file__).resolve().parents[3]
LONG = bool(os.environ.get("NONIO_LONG"))  # whole sites in both languages, else each in one of them
ENGLISH = {"the", "of", "and", "is", "are", "with", "without", "not", "for", "from", "by", "to", "that", "this", "which", "because", "has",
           "have", "been", "than", "its", "only", "when", "between", "written", "measurement", "reading", "readings",
           "axis", "machine", "file", "files", "warning", "error", "value", "table"}
ITALIAN = {"file"}  # is also a word of this language
# Words of commands, options, keys and names, which are the same in every language.
SAME = re.compile(r"`[^`]*`|\"[^\"]*\"|\[\[?\S+\]|\{[\w±%-]+\}|nonio( [a-z]+)+|--[a-z-]+|[a-z_.]+ = |\w+([.-][a-z]\w*)+|\S*[/_:=]\S*")
MICRO = "\N{MICRO SIGN}"
POINT = re.compile(r"(?<![\w.,-])-?\d+\.\d+(?![\w.]|-\d{4})")  # not of a version or of the number of a standard
BRACKETED = re.compile(r"\(U (= )?-?[\d.,]+( \S+)?\)")  # a value has its U after the sign of plus and minus


def english_in(line, language):
    words = re.findall(r"\b[A-Z]?[a-z]+\b", SAME.sub(" ", line))
    return {word.lower() for word in words} & ENGLISH - (ITALIAN if language == "it" else set())


def rtl(values):
    rows = "".join(f"1 {i} {v}\n" for i, v in enumerate(values, 1))
    return (f"HEADER::\nFile type  : rtl\nOwner      : Linear\nTARGET DATA::\nTarget-count: {len(values)}\nTargets :\n"
            + " ".join(str(100 * i) for i in range(len(values))) + "\nUSER-TEXT::\nMachine:\nSerial No:\nDate:\nBy:\n"
            + f"Axis:\nLocation:\nTITLE:\nRUNS::\nRun-count:1\nDEVIATIONS::\nRun Target Data:\n{rows}EOF::\n")


class Screens(VerbTest):
    def setUp(self):
        super().setUp()
        self.root = self.site.parent
        self.wrong, self.names = [], []  # names: of instruments, in any language

    def copy(self, sample, language):
        site = self.root / f"{sample}-{language}"
        shutil.copytree(ROOT / "samples" / sample, site)
        settings = site / "site.toml"
        settings.write_text(f'language = "{language}"\n' + settings.read_text(encoding="utf-8"), encoding="utf-8")
        shutil.rmtree(site / "08-broken-file", ignore_errors=True)  # its message is English
        for manifest in site.rglob("campaign.toml"):
            self.names += re.findall(r'^model = "(.* and .*)"', manifest.read_text(encoding="utf-8"), re.M)
        for log in site.glob("events.toml"):  # texts of a person
            log.write_text(re.sub(r'text = ".*"', 'text = "X"', log.read_text(encoding="utf-8")), encoding="utf-8")
        return site

    def screen(self, language, *args, expect=0, errors=True):
        done = self.nonio(*args, expect=expect)
        shown = done.stdout + (done.stderr if errors else "")
        self.assertTrue(shown, args)
        for name in self.names:
            shown = shown.replace(name, "NAME")
        for line in shown.splitlines():
            found = english_in(line, language)
            if POINT.search(SAME.sub(" ", line)):
                found.add("decimal point")
            if MICRO in line:
                found.add(MICRO)
            if BRACKETED.search(line):
                found.add("form of U")
            if found:
                self.wrong.append(f"{language}: nonio {' '.join(map(str, args))}\n    {line}\n    {', '.join(sorted(found))}")
        return shown

    def tearDown(self):
        super().tearDown()
        if self.wrong:
            self.fail(f"{len(self.wrong)} lines\n" + "\n".join(self.wrong))

    def test_the_words_are_not_of_the_other_languages(self):
        for language in ("de", "it"):
            for path in (ROOT / "templates/words" / language).glob("*.toml"):
                for text in texts_of(tomllib.loads(path.read_text(encoding="utf-8"))):
                    found = english_in(text, language)
                    if found:
                        self.wrong.append(f"{path.name}: {text}: {', '.join(sorted(found))}")

    def test_screens_of_a_site(self):
        for language in ("de", "it") if LONG else ("de",):
            site, out = self.copy("site", language), self.root / f"out-{language}"
            see = lambda *args, **more: self.screen(language, *args, **more)
            shown = see("run", site, "--out", out)
            lines = re.findall(r"^(?:Handlung erforderlich|azione richiesta)  ", shown, re.M)
            self.assertGreater(len(lines), 10)
            self.assertIn(f"; {len(lines)} {'mit Handlungsbedarf' if language == 'de' else 'con azione richiesta'}; ", shown)
            see("run", site, "--out", out, "--dry-run")
            see("status", out)
            see("check", site)
            for i, results in enumerate(sorted(p.parent for p in out.glob("*/results.json"))):
                see("show", results, *["--all"] * (i % 4 > 0))
            see("show", site / "15-step-diagonal", "--all")
            for campaign in ("17-straight-or-square", "18-one-column", "42-heat", "48-warm-axis", "50-turned-plates"):
                see("model", "explain", site / campaign, "--all")
                see("model", "compare", site / campaign)
            see("model", "add", site / "18-one-column", "yaw:X")
            see("model", "drop", site / "18-one-column", "yaw:X")
            self.tables(see, site, out)
            see("export", "--out", out, "--list")
            see("export", "--out", out, "09-tolerances", "--to", out / "unpacked")
            see("show", "S-0109", "--out", out)
            see("new", "campaign", site / "new", "--defaults")
            see("plan", "triples", "--x", 4000, "--y", 3000, "--language", language)

    def tables(self, see, site, out):
        before = [out / "09-tolerances" / f"siemens-840d-X-{part}.ini" for part in ("EEC", "backlash")]
        both = ",".join(map(str, before))
        see("table", "diff", before[0], "--axis", "X")
        see("table", "diff", before[0], out / "01-asymmetric-repeatability/siemens-840d-X-EEC.ini", "--axis", "X")
        see("table", "diff", both, site / "09-tolerances")
        see("table", "predict", both, site / "09-tolerances")
        later = site / "later"
        shutil.copytree(site / "09-tolerances", later)
        manifest = (later / "campaign.toml").read_text(encoding="utf-8")
        manifest = re.sub(r"^(active_table|active_backlash|date).*\n", "", manifest, flags=re.M)
        manifest = manifest.replace('id = "09-tolerances"', 'id = "later"\ndate = 2026-06-23')
        (later / "campaign.toml").write_text(manifest, encoding="utf-8")
        see("table", "insert", both, "--with", later, "--out", out / "load", "--loaded", "2026-06-24")
        see("table", "probe", later)
        see("table", "session", later, "--backup", both)

    def test_screens_of_a_laboratory(self):
        for language in ("de", "it") if LONG else ("it",):
            site, out = self.copy("laboratory", language), self.root / f"out-{language}"
            see = lambda *args, **more: self.screen(language, *args, **more)
            see("run", site, "--out", out)
            see("status", out)
            see("machine", "list", out)
            see("machine", "list", out, "LAB-04")
            see("machine", "history", out)
            see("machine", "history", out, "LAB-04")
            see("machine", "event", site)
            see("machine", "event", site, "--machine", "LAB-04", "--axis", "X", "--kind", "repair", "--text", "X")
            see("machine", "ack", site)
            see("machine", "ack", site, "--machine", "LAB-04", "--finding", "drift", "--until", "2099-01-01", "--by", "B", "--why", "X")
            see("machine", "ack", site)
            see("machine", "remove", site, "events.toml", "--by", "B", "--why", "X")

    def test_screens_of_certificates(self):
        for language in ("de", "it") if LONG else ("de",):
            site, out = self.copy("certificates", language), self.root / f"out-{language}"
            see = lambda *args, **more: self.screen(language, *args, **more)
            if os.system(f"'{site}/make-key.sh'") != 0:
                self.skipTest("openssl is not installed")
            see("certificate", "list", site)
            see("certificate", "approve", site, "--list")
            see("run", site, "--out", out)
            see("certificate", "approve", site, "--list")
            approve = ("certificate", "approve", site / "adjusted", "--by", "B. Sample")
            lacking = self.nonio(*approve, expect=1)
            keys = re.findall(r'^nonio certificate approve: (?!.*--reason)(.*?: [a-z0-9A-Z.-]+) ', lacking.stderr, re.M)
            see(*approve, expect=1)
            see(*approve, *(word for key in keys for word in ("--reason", f"{key}=X")))
            see("certificate", "list", site)
            see("certificate", "withdraw", site, "S-0001", "--why", "X", "--by", "B")
            see("certificate", "audit", site)
            for verbose in ([], ["--verbose"]):
                see("certificate", "verify", "--site", site, out / "adjusted/certificate.pdf", *verbose, expect=5)

    def test_import(self):
        for language in ("de", "it"):
            source, site = self.root / f"laser-{language}", self.root / f"site-{language}"
            source.mkdir()
            site.mkdir()
            (site / "site.toml").write_text(f'format = 1\nlanguage = "{language}"\n', encoding="utf-8")
            for name, values in {"FP12_x_20240302.rtl": [1, 2, 3], "FP12_Y_20240302.rtl": [1, 2, 4], "copy_Y_20240302.rtl": [1, 2, 4],
                                 "notes.rtl": [1], "FP13_X_20240302.rtl": [1, 2, 5], "FP13_x_20240302.rtl": [1, 2, 6]}.items():
                (source / name).write_text(rtl(values), encoding="utf-8")
            rule = ("--rule", "{machine}_{axis}_{date}.rtl", "--out", site)
            self.screen(language, "import", source, *rule, expect=None)
            self.screen(language, "import", source, *rule, expect=None)
            self.screen(language, "import", source, "--rule", "{machine}_{*}_{date}.rtl", "--out", site, "--dry-run", expect=None)


def texts_of(table):
    for value in table.values():
        if isinstance(value, dict):
            yield from texts_of(value)
        else:
            yield value


if __name__ == "__main__":
    unittest.main()
