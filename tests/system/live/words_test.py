# SPDX-License-Identifier: Apache-2.0
"""Words of the pages of `nonio serve`, from the sources: no server, no browser."""
import pathlib
import re
import tomllib
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]


class Words(unittest.TestCase):
    """Every word that the scripts ask for is there in every language, with the same places."""

    # Words that a script puts together: what they begin with, and where the program says what may follow. None: a list
    # in the script itself.
    SENT = {
        "event.kind_": ("engine/campaign/config/keys/logs.cpp", r"event_kinds\[\] = (.*?);", {}),
        "run.stage_": ("engine/batch/run.cpp", r"tell_stage\(events, (\"\w+\")\)", {"begin"}),
        "run.status_": ("engine/campaign/evaluation/status.cpp", r"to_text\(Status status\) \{(.*?)\n\}", {"none"}),
        "release.as_": ("engine/app/release_verb.cpp", r"one_of\(\s*(\{.*?\})", {"site"}),
        "verify.is_": ("engine/app/verify_verb.cpp", r"to_text\(sign::Check::State state\) \{(.*?)\n\}", {}),
        "space.is_": ("engine/campaign/config/keys/machine_of_campaign.h", r"structures\[\] = (.*?);", {}), "space.": None, "more.is_": ("engine/model/diagnosis/foresight.cpp", r"wanted\{(.*?)\}", {}), 
        "check.": ("engine/sign/src/*.cpp engine/certificates/content_check.cpp engine/certificates/verify.cpp engine/certificates/register_check.cpp", r"(?:add\(|Check check\{|State state\) \{|push_back\(\{|sign::Check\{)\s*(\"(?:signature|file|updates|signer|certificate|xml|register|content|attachments)[a-z.-]*\")", {"dcc", "dcc_none", "dcc_values", "signature_form", "signature_time", "xml_time"}),
        "chart.": None, "verify.": None, "verify.verdict_": None, "x.": None, "column.": None, "column.of_": None, "list.": None, "list.is_": None, "one.": None, "one.value_": None, "new.part_": None, "field.": None, "user.may_": None, "key.": None, "drawn.": None, "learn.step": None, "learn.hint.": None, "site.": None, "set.": None, "set.of_": None,
        "failing.": None, "kind.": None, "program.": None, "refused.": None,
    }

    def test_what_the_program_says_of_a_fit_is_what_the_page_looks_for(self):
        """The page recognises these sentences by their words, which the program's sources must therefore contain."""
        script = (SOURCE / "reports/workbench/page/net.js").read_text()
        forms = re.findall(r"\[/\^(.*?)/, \"(\w+)\"\]", script)
        self.assertEqual(8, len(forms))
        program = "".join(re.sub(r'"\s*\n\s*"', "", p.read_text()) for folder in ("engine/model/fit", "engine/live") for p in sorted((SOURCE / folder).glob("*.cpp")))
        for form, name in forms:
            fixed = max(re.split(r"\(\?<\w+>[^)]*\)|[$]", form), key=len).replace("\\", "").strip()
            self.assertGreater(len(fixed), 15, name)
            self.assertIn(fixed, program, name)

    def test_no_word_of_a_page_is_one_of_a_terminal_or_a_file(self):
        for language in ("en", "de", "it"):
            for name in ("workbench", "workbench-site", "site"):
                words = dict(self.flat(tomllib.loads((SOURCE / f"templates/words/{language}/{name}.toml").read_text())))
                self.assertGreater(len(words), 100)
                syntax = re.compile(r"nonio |\[\[|\.toml|\.jsonl|--\w|[a-z]_[a-z]|`")
                self.assertEqual([], [f"{language}/{name}: {k}: {v}" for k, v in words.items() if isinstance(v, str) and syntax.search(re.sub(r"\{\w+\}", "", v))])

    @staticmethod
    def flat(table, before=""):
        for key, value in table.items():
            yield from Words.flat(value, before + key + ".") if isinstance(value, dict) else [(before + key, value)]

    def test_words_are_complete(self):
        # Of the words of pictures the page has those of charts.
        read = lambda language: {k: v for name in ("workbench", "workbench-site", "pictures") for k, v in self.flat(
            tomllib.loads((SOURCE / f"templates/words/{language}/{name}.toml").read_text())) if name != "pictures" or k.startswith("chart.")}
        english = read("en")
        script = "".join(p.read_text() for p in sorted((SOURCE / "reports/workbench/page").glob("*.js")))
        script = re.sub(r"(querySelector(All)?|closest|matches)\(\"[^\"]*\"\)", "", script)  # what they ask of the page is no word
        begun = set(re.findall(r'"([a-z]+\.[a-z_.]*)" \+ ', script)) | set(re.findall(r"`([a-z]+\.[a-z_]*)\$\{", script))
        self.assertEqual(set(self.SENT), begun, "words that are put together")
        asked = set(re.findall(r'"([a-z]+\.[a-z_0-9]+)"(?! \+ )', script)) - {"index.html", "instruments.html", "due.ics", "run.json", "results.json", "audit.jsonl", "certificate.pdf", "certificate.incomplete"}
        self.assertGreater(len(asked), 100)
        self.assertEqual(set(), asked - set(english))
        for prefix, source in self.SENT.items():
            self.assertTrue([k for k in english if k.startswith(prefix)], prefix)
            if source is None:
                continue
            values = {v for text in re.findall(source[1], "".join(p.read_text() for one in source[0].split() for p in SOURCE.glob(one)), re.S) for v in re.findall(r'"([\w. -]+)"', text)}
            self.assertGreater(len(values), 1, f"{prefix}: {source[0]}")
            self.assertEqual(set(), {prefix + re.sub("[ .-]", "_", v) for v in values | set(source[2])} - set(english), "what the program sends has a word")
        made = (*self.SENT, "shell.", "entry.not_authenticated")  # the last one is for the server
        self.assertEqual([], [k for k in english if k not in asked and not k.startswith(made)], "words that nobody asks for")
        for language in ("de", "it"):
            other = read(language)
            self.assertEqual(set(english), set(other), language)
            places = lambda text: sorted(re.findall(r"\{\w+\}", text))
            self.assertEqual([], [k for k in english if places(english[k]) != places(other[k])], language)
            same = [k for k in english if other[k] == english[k] and k != "shell.title" and re.search(r"[a-z]{4}.* .*[a-z]{4}", re.sub(r"\{\w+\}", "", english[k]))]
            self.assertEqual([], same, f"{language}: not translated")


if __name__ == "__main__":
    unittest.main()
