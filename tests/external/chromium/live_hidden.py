# SPDX-License-Identifier: Apache-2.0
"""live_hidden.py NONIO SOURCE_FOLDER BENCH_HIDDEN: twenty campaigns with hidden effects, solved on the page of `nonio serve`
in a real browser by clicking only what the page suggests: the same model and verdict as `nonio model explain --auto`.
It is run by hand and takes a minute; ctest checks the same of the interface (live.hidden)."""
import json
import subprocess
import sys
import tomllib

import live_browser
from live_browser import NONIO, SOURCE

HIDDEN = {"one": 8, "several": 4, "complete": 3, "outside": 2, "day-wave": 3}
BENCH = sys.argv[3]
WORDS = tomllib.loads((SOURCE / "templates/words/en/workbench.toml").read_text())


class Hidden(live_browser.LivePage):
    def model(self):
        return self.js("[...document.querySelectorAll('[data-group=\"effects.model\"] input[data-effect]')].map((e) => e.dataset.effect)")

    def ready(self):
        self.wait(lambda: self.js("document.body.dataset.ready") == "explained" and not self.js("document.getElementById('suggest').disabled"))

    def by_suggestion(self):
        for _ in range(20):
            self.ready()
            before = self.model()
            self.d.execute_script("document.getElementById('said').textContent = ''")
            self.click("suggest")
            self.wait(lambda: self.model() != before or self.text("said") == WORDS["job"]["none"], "one more effect, or none")
            if self.model() == before:
                return before
        raise AssertionError("no end")

    def test_who_clicks_each_suggestion_ends_where_auto_ends(self):
        for kind, count in HIDDEN.items():
            subprocess.run([BENCH, kind, str(count), "1", "--write", str(self.folder / kind)], check=True, stdout=subprocess.DEVNULL)
        folders = sorted(p.parent for p in self.folder.glob("*/*/campaign.toml"))
        self.assertEqual(sum(HIDDEN.values()), len(folders))
        found = 0
        for folder in folders:
            with self.subTest(folder.name):
                server = self.serve(folder)
                self.d.get("about:blank")
                self.d.get(server.address)
                model = self.by_suggestion()
                verdict, kinds = self.text("verdict"), self.js("document.getElementById('verdict').className")
                server.stop()
                subprocess.run([str(NONIO), "explain", str(folder), "--auto"], capture_output=True)
                said = json.loads(subprocess.run([str(NONIO), "explain", str(folder), "--json"], capture_output=True, text=True).stdout)
                self.assertEqual(said["model"]["effects"], model)
                self.assertIn(said["verdict"]["kind"], kinds.split())
                truth = json.loads(folder.with_name(folder.name + ".truth.json").read_text())
                right = sorted(model) == sorted(truth["model"] + truth["hidden"])
                found += right
                print(f"{folder.parent.name}/{folder.name}: {', '.join(model)}; {said['verdict']['kind']}{'' if right else ', hidden: ' + ', '.join(truth['hidden'])}; {verdict}", flush=True)
        print(f"{found} of {len(folders)} are the true model")


if __name__ == "__main__":
    sys.argv.pop(3)
    live_browser.main()
