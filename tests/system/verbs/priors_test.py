# SPDX-License-Identifier: Apache-2.0
"""`nonio export --format fleet` counts the effects of earlier campaigns, and `nonio model explain` weighs its candidates by
the counts: they make small effects easier to find, and change no printed evidence and no result of a run."""
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "bench"))
import fleet
import fleet_priors

NONIO = os.environ["NONIO"]
SITE_TOML = 'format = 1\n[run]\nanalyses = ["model-fit"]\noutputs = ["json"]\n'
EARLIER = ["backlash:X"] * 8 + ["periodic:X"] * 3 + [None] * 3


def nonio(*arguments, status=0):
    done = subprocess.run([NONIO, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == status, (done.returncode, done.stdout, done.stderr)
    return done


def explain(folder):
    return json.loads(nonio("model", "explain", folder, "--json", "--quiet").stdout)


class Priors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="nonio-priors-")
        cls.addClassCleanup(folder.cleanup)
        cls.root = pathlib.Path(folder.name)
        cls.site, cls.out = cls.root / "site", cls.root / "out"
        rng = random.Random(12)
        for n, effect in enumerate(EARLIER):
            cls.campaign(f"c{n:04d}", n, effect, 3.0, rng)
        (cls.site / "site.toml").write_text(SITE_TOML)
        nonio("run", cls.site, "--out", cls.out, "--quiet")
        cls.path = cls.site / "fleet.toml"
        nonio("export", "--format", "fleet", "--out", cls.out, "--to", cls.site)
        cls.text = cls.path.read_text()

    @classmethod
    def campaign(cls, name, number, effect, size, rng, model=""):
        fleet_priors.campaign(cls.site / name, number, effect, size, rng)
        manifest = cls.site / name / "campaign.toml"
        manifest.write_text(manifest.read_text().replace('asset = "M-1"', 'asset = "M-1"\nmaker = "Maker"\nmodel = "FP 12"') + model)

    def setUp(self):
        self.path.write_text(self.text)
        (self.site / "site.toml").write_text(SITE_TOML)

    def new(self, seed, effect="backlash:X", size=0.27):
        """A campaign after the count, with a small effect."""
        name = f"n{seed}"
        if not (self.site / name).exists():
            self.campaign(name, 900 + seed, effect, size, random.Random(seed))
        return self.site / name

    def test_counts_are_those_of_the_campaigns(self):
        counts = tomllib.loads(self.text)
        self.assertEqual((str(counts["from"]), str(counts["until"])), ("2020-01-05", "2021-02-05"))
        all_machines, of_model = counts["machines"]
        self.assertEqual((of_model["maker"], of_model["model"]), ("Maker", "FP 12"))
        self.assertEqual(of_model["campaigns"], [f"c{n:04d}" for n in range(14)])
        for machines in (all_machines, of_model):
            found = {e["name"]: e["found"] for e in machines["effect"]}
            self.assertEqual(found, {"backlash": [f"c{n:04d}" for n in range(8)], "periodic": [f"c{n:04d}" for n in range(8, 11)]})
        # An effect of 3 times the noise removes an RMS of so much; the noise is 0.3 to 3.2 um.
        for effect in of_model["effect"]:
            self.assertEqual(effect["unit"], "um")
            self.assertTrue(0.9 < effect["median"] < 9.6 and 0.0 < effect["spread"] < 9.6, effect)

    def test_a_significant_effect_of_the_model_counts_with_its_value(self):
        out = self.root / "out-of-model"
        self.campaign("fitted", 20, "backlash:X", 3.0, random.Random(3), '[model]\neffects = ["backlash:X", "scale:X"]\n')
        nonio("run", self.site, "--out", out, "--quiet")
        nonio("export", "--format", "fleet", "--out", out, "--to", self.root)
        of_all = tomllib.loads((self.root / "fleet.toml").read_text())["machines"][0]
        found = {e["name"]: e["found"] for e in of_all["effect"]}
        self.assertIn("c0020", found["backlash"])
        self.assertNotIn("c0020", found.get("scale", []))

    def test_the_pose_of_a_part_is_no_effect(self):
        out = self.root / "out-of-part"
        shutil.copytree(self.out, out)
        path = out / "c0000" / "results.json"
        results = json.loads(path.read_text())
        (fit,) = [a for a in results["analyses"] if a["plugin"] == "model-fit"]
        fit.setdefault("values", {}).update({name: {"value": 100.0, "unit": "urad", "U": 1.0} for name in ("body-turn:P.a", "worn:X.a")})
        path.chmod(0o644)
        path.write_text(json.dumps(results))
        nonio("export", "--format", "fleet", "--out", out, "--to", self.root)
        names = [e["name"] for e in tomllib.loads((self.root / "fleet.toml").read_text())["machines"][0]["effect"]]
        self.assertIn("worn", names)
        self.assertNotIn("body-turn", names)

    def test_the_answer_states_the_counts_and_no_other_evidence(self):
        folder = self.new(1, size=0.5)
        weighed = explain(folder)
        self.assertEqual({k: weighed["priors"][k] for k in ("file", "machines", "campaigns", "from", "until")},
                         {"file": "fleet.toml", "machines": "Maker FP 12", "campaigns": 14, "from": "2020-01-05", "until": "2021-02-05"})
        prior = {c["effect"]: c["prior"] for c in weighed["candidates"]}
        self.assertEqual([prior[e]["found"] for e in ("backlash:X", "periodic:X", "scale:X")], [8, 3, 0])
        self.assertGreater(prior["backlash:X"]["weight"], prior["periodic:X"]["weight"])
        self.assertGreater(prior["periodic:X"]["weight"], prior["scale:X"]["weight"])
        self.assertGreaterEqual(min(p["weight"] for p in prior.values()), 0.5)
        weights = [p["weight"] for p in prior.values()]
        self.assertLess(sum(weights) / len(weights), 1.001)
        printed = " ".join(nonio("model", "explain", folder).stdout.split())
        self.assertIn("14 campaigns of Maker FP 12 from 2020-01-05 to 2021-02-05 (fleet.toml)", printed)
        self.assertIn("backlash:X: found in 8 of 14 campaigns", printed)
        (self.site / "site.toml").write_text(SITE_TOML + "[explain]\npriors = false\n")
        plain = explain(folder)
        self.assertNotIn("priors", plain)
        evidence = {c["effect"]: [c["p"], c["score_alone"], c["score_within"]] for c in plain["candidates"]}
        for c in weighed["candidates"]:
            for value, known in zip([c["p"], c["score_alone"], c["score_within"]], evidence[c["effect"]]):
                self.assertAlmostEqual(value, known, delta=1e-9 + 1e-6 * abs(known), msg=c["effect"])
        self.assertEqual(weighed["verdict"]["effect"], plain["verdict"]["effect"])

    def test_a_small_effect_that_is_usual_is_found(self):
        with_counts = {n: explain(self.new(n))["verdict"].get("effect") for n in SMALL}
        self.path.unlink()
        without = {n: explain(self.new(n))["verdict"].get("effect") for n in SMALL}
        self.assertEqual(set(with_counts.values()), {"backlash:X"})
        self.assertEqual(set(without.values()), {None})

    def test_a_campaign_is_no_evidence_for_itself(self):
        counted = explain(self.site / "c0000")
        self.assertEqual(counted["priors"]["campaigns"], 13)
        self.assertEqual(counted["candidates"][0]["prior"]["found"], 7)
        together = json.loads(nonio("model", "explain", *(self.site / f"c{n:04d}" for n in range(8, 12)), "--json", "--quiet").stdout)
        self.assertEqual(together["priors"]["campaigns"], 10)
        prior = {c["effect"]: c["prior"]["found"] for c in together["candidates"]}
        self.assertEqual(prior["periodic:X"], 0)

    def test_few_campaigns_of_the_model_leave_all_machines(self):
        self.path.write_text(self.text.replace('model = "FP 12"', 'model = "another"'))
        answer = explain(self.new(1, size=0.5))
        self.assertNotIn("machines", answer["priors"])
        self.assertEqual(answer["priors"]["campaigns"], 14)

    def test_results_of_a_run_do_not_depend_on_it(self):
        results = {}
        for name in ("with", "without"):
            out = self.root / f"out-{name}"
            nonio("run", self.site, "--out", out, "--quiet")
            results[name] = {f.parent.name: f.read_bytes() for f in out.glob("*/results.json")}
            self.path.unlink(missing_ok=True)
        self.assertEqual(results["with"], results["without"])

    def test_mistakes(self):
        self.path.write_text(self.text.replace("unit =", "units =", 1))
        line = 1 + self.path.read_text()[:self.path.read_text().index("units =")].count("\n")
        done = nonio("model", "explain", self.site / "c0000", status=2)
        self.assertIn(f"fleet.toml:{line}:", done.stderr)
        self.assertIn("units", done.stderr)
        empty = self.root / "empty"
        empty.mkdir()
        self.assertIn("model-fit", nonio("export", "--format", "fleet", "--out", empty, "--to", self.site, status=2).stderr)
        self.assertIn("--to SITE", nonio("export", "--format", "fleet", "--out", self.out, status=2).stderr)


# Campaigns whose effect is near the limit of detection, by their seeds.
SMALL = (15, 17, 22)

if __name__ == "__main__":
    unittest.main()
