# SPDX-License-Identifier: Apache-2.0
"""The terminal and summary.txt speak the language of site.toml; JSON, errors and --help are English."""
import json
import shutil
import unittest

from verbs import VerbTest, manifest, readings

WORDS = {"de": {"summary": "Kampagne", "title": "Lose bei der Umkehr", "verdict": "Urteil: ", "missing": "es fehlt",
                "complete": "vollständig (nichts fehlt)", "floor": "Rauschgrenze", "value": "Wert",
                "attention": "NEU SEIT DEM LETZTEN LAUF", "added": "hinzugefügt"},
         "en": {"summary": "campaign", "title": "Lost motion at reversal", "verdict": "verdict: ", "missing": "missing",
                "complete": "complete (nothing missing)", "floor": "noise floor", "value": "value",
                "attention": "NEW SINCE THE LAST RUN", "added": "added"},
         "it": {"summary": "campagna", "title": "Gioco all'inversione", "verdict": "verdetto: ", "missing": "manca",
                "complete": "completo (non manca nulla)", "floor": "rumore di fondo", "value": "valore",
                "attention": "NUOVO DALL'ULTIMA ESECUZIONE", "added": "aggiunto"}}


class Languages(VerbTest):
    def setUp(self):
        super().setUp()
        self.out = self.site.parent / "out"
        self.campaign(manifest(effects=["scale:X"]), x=readings(backlash=-6.0))

    def speak(self, language):
        (self.site / "site.toml").write_text(f'format = 1\nlanguage = "{language}"\n')

    def test_summary_and_show_speak_the_language_of_the_site(self):
        for language, words in WORDS.items():
            with self.subTest(language):
                self.speak(language)
                shutil.rmtree(self.out, ignore_errors=True)
                self.nonio("run", self.site, "--out", self.out, "--quiet")
                summary = (self.out / "summary.txt").read_text()
                for name in ("summary", "title", "attention"):
                    self.assertIn(words[name], summary)
                for folder in (self.out / "c", self.folder):
                    shown = self.nonio("show", folder, "--all", "--quiet").stdout
                    self.assertIn(words["title"], shown)
                    self.assertIn(words["value"], shown)

    def test_json_of_a_run_is_english_in_every_language(self):
        titles = set()
        for language in WORDS:
            self.speak(language)
            self.nonio("run", self.site, "--out", self.out, "--force", "--quiet")
            summary = json.loads((self.out / "summary.json").read_text())
            titles.add(summary["attention"][0]["reason"])
            self.assertIn("one backlash value compensates it", (self.out / "c/results.json").read_text())
        self.assertEqual(1, len(titles), titles)
        self.assertIn("Lost motion at reversal", titles.pop())

    def test_explain_speaks_the_language_and_its_json_english(self):
        plain = None
        for language, words in WORDS.items():
            with self.subTest(language):
                self.speak(language)
                shown = self.nonio("model", "explain", self.folder, "--quiet").stdout
                self.assertIn(words["verdict"] + words["missing"] + " backlash:X", shown)
                self.assertIn(words["floor"], shown)
                said = self.nonio("model", "explain", self.folder, "--quiet", "--json").stdout
                plain = plain or said
                self.assertEqual(plain, said)

    def test_a_model_with_nothing_missing_is_called_complete(self):
        self.campaign(manifest(effects=["scale:X", "backlash:X"]), x=readings(backlash=-6.0))
        for language, words in WORDS.items():
            with self.subTest(language):
                self.speak(language)
                self.assertIn(words["verdict"] + words["complete"],
                              self.nonio("model", "explain", self.folder, "--quiet").stdout)
        said = json.loads(self.nonio("model", "explain", self.folder, "--quiet", "--json").stdout)
        self.assertEqual("nothing", said["verdict"]["kind"])

    def test_model_add_speaks_the_language(self):
        for language, words in WORDS.items():
            with self.subTest(language):
                self.speak(language)
                self.assertIn("backlash:X " + words["added"],
                              self.nonio("model", "add", self.folder, "backlash:X", "--quiet").stdout)
                self.nonio("model", "drop", self.folder, "backlash:X", "--quiet")

    def test_run_and_check_speak_the_language(self):
        said = {"de": ("1 Kampagne, 1 auszuwerten", "1 ausgewertet, 0 unverändert, 0 fehlgeschlagen; Handlung erforderlich, Zeilen der Arbeitsliste: ",
                       "unverändert  c: nichts geändert", "1 Kampagne geprüft: kein Fehler"),
                "en": ("1 campaign, 1 to do", "1 done, 0 unchanged, 0 failed; actions required in the worklist: ", "unchanged  c: nothing changed",
                       "1 campaign checked: no error"),
                "it": ("1 campagna, 1 da elaborare", "elaborate: 1, invariate: 0, non riuscite: 0; azioni richieste nella lista di lavoro: ",
                       "invariata  c: nessuna modifica", "1 campagna controllata: nessun errore")}
        for language, (planned, counts, unchanged, checked) in said.items():
            with self.subTest(language):
                self.speak(language)
                done = self.nonio("run", self.site, "--out", self.out, "--force")
                self.assertIn(planned, done.stderr)
                self.assertIn(counts, done.stdout)
                self.assertIn(unchanged, self.nonio("run", self.site, "--out", self.out, "--dry-run").stdout)
                self.assertIn(checked, self.nonio("check", self.site).stdout)

    def test_run_states_an_action_in_the_language(self):
        limit = manifest(effects=["scale:X"]).replace('active_table', 'tolerance_um = { B = 3.0 }\nactive_table', 1)
        self.campaign(limit, x=readings(backlash=-6.0))
        for language, words in {"de": r"Handlung erforderlich  c \(X B \d,\d+ um\): ", "en": r"action required  c \(X B \d\.\d+ um\): ",
                                "it": r"azione richiesta  c \(X B \d,\d+ um\): "}.items():
            with self.subTest(language):
                self.speak(language)
                shutil.rmtree(self.out, ignore_errors=True)
                self.assertRegex(self.nonio("run", self.site, "--out", self.out).stdout, words)

    def test_show_states_the_range_of_an_axis(self):
        for language, words in {"de": "Messung X, 0 bis 370 mm", "en": "Measurement X, 0 to 370 mm", "it": "X, da 0 a 370 mm"}.items():
            with self.subTest(language):
                self.speak(language)
                self.assertIn(words, self.nonio("show", self.folder, "--quiet").stdout)

    def test_help_is_english(self):
        self.speak("de")
        self.assertIn("nightly job", self.nonio("run", "--help").stdout)

    def test_a_language_without_words_is_refused(self):
        self.speak("fr")
        done = self.nonio("run", self.site, "--out", self.out, expect=2)
        self.assertIn("language", done.stderr)
        self.assertIn("fr", done.stderr)


if __name__ == "__main__":
    unittest.main()
