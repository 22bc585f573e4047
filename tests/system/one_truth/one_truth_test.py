# SPDX-License-Identifier: Apache-2.0
"""Nothing that the program prints is contradicted by another part of it: the relations of docs/dev/one-truth.md, over all
samples, random campaigns and a laboratory.

    NONIO_ONE_TRUTH=500 NONIO_SEED=7 ctest --test-dir build/ci -R one_truth -V     # so many random campaigns, of that seed
    NONIO_ONE_TRUTH_LABORATORY=200 ctest --test-dir build/ci -R one_truth.samples -V    # a made laboratory of about so many
"""
import csv
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

NONIO, SOURCE = os.environ["NONIO"], pathlib.Path(__file__).resolve().parents[3]
CAMPAIGNS = int(os.environ.get("NONIO_ONE_TRUTH", "24"))
SEED = int(os.environ.get("NONIO_SEED", random.SystemRandom().randrange(2**31)))
LABORATORY = int(os.environ.get("NONIO_ONE_TRUTH_LABORATORY", "24"))  # campaigns of the made laboratory, about

WORDS = [tomllib.loads(p.read_text("utf-8"))["results"] for p in sorted(SOURCE.glob("templates/words/*/results.toml"))]
# What a decision of results.json is called on paper, in any language and by any rule.
DECIDED = {"conforms": ("conforms", "pass"), "does not conform": ("does_not_conform", "fail"), "cannot be decided": ("cannot_be_decided",)}
ON_PAPER = {decision: {w[key] for w in WORDS for key in keys if key in w} for decision, keys in DECIDED.items()}

# Findings of one measurement of which at most one can be true.
EXCLUDE_EACH_OTHER = (
    {"reversal.lost-motion", "reversal.positive", "reversal.positive-uncompensated", "reversal.over-compensated"},
    {"before-after.worked", "before-after.mean-as-predicted", "before-after.not-active", "before-after.wrong-sign", "before-after.something-else"},
    {"before-after.worked", "before-after.reversal-as-predicted", "before-after.reversal-not-active", "before-after.reversal-wrong-sign",
     "before-after.reversal-something-else", "before-after.reversal-cannot-tell"},
    {"reversal.elastic", "plausibility.direction-turned"},
    {"drift.parallel", "repeatability.good"},
)


def run(*args, expect=(0, 1)):
    done = subprocess.run([NONIO, *map(str, args)], capture_output=True, text=True, timeout=900,
                          env={**os.environ, "NONIO_ALLOW_ROOT": "1", "LC_ALL": "C.UTF-8", "COLUMNS": "200"})
    if done.returncode not in expect:
        raise AssertionError(f"{args}: {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done


def as_printed(value, U):
    """U in two significant digits, the value in as many decimals, nine at most: the rule of every table."""
    decimals = min(9, 1 - math.floor(math.log10(U)))
    if round(U, decimals) >= 0.999999 * 10 ** (2 - decimals):  # 9.96 is 10
        decimals -= 1
    return tuple(f"{round(v, decimals) if decimals < 0 else v:.{max(0, decimals)}f}" for v in (value, U))


def page_lines(pdf):
    """The lines of a PDF, numbers as results.json writes them: a point, a hyphen as minus."""
    text = subprocess.run(["pdftotext", "-layout", str(pdf), "-"], capture_output=True, text=True, check=True).stdout
    return [re.sub(r"(?<=\d),(?=\d)", ".", line.replace("\u2212", "-")) for line in text.splitlines()]


def row_of(v):
    """What finds a value with its U in a line: a value halfway between two printed ones is either of them. None where its U
    is smaller than nine decimals (a direction)."""
    if v["U"] < 5e-10:
        return None
    last = 1e-11 * max(abs(v["value"]), v["U"])
    either = {as_printed(v["value"] + d, v["U"])[0] for d in (-last, 0.0, last)}
    if "tolerance" in v:  # more digits, until they show on which side of the limit the value is
        def side(x):
            return (abs(x) > v["tolerance"]) - (abs(x) < v["tolerance"])
        either = {next(text for n in range(12) if side(float(text := f"{float(v['value']):.{n + len(one.partition('.')[2])}f}")) == side(v["value"]))
                  if side(float(one)) != side(v["value"]) else one for one in either}
    either = sorted(re.sub(r"^-(?=[0.]*$)", "", text) for text in either)  # zero has no sign
    return re.compile(r"(?<![\d.\-])(?:%s)\s+%s(?![\d.])" % ("|".join(map(re.escape, either)), re.escape(as_printed(0.0, v["U"])[1])))


def values_of(results):
    for analysis in results["analyses"]:
        for name, v in analysis.get("values", {}).items():
            yield analysis, name, v


class Truth(unittest.TestCase):
    """The relations that hold for one site and its output folder."""
    whole = False

    def check_site(self, site, out):
        for folder in sorted(p.parent for p in out.glob("*/results.json")):
            with self.subTest(campaign=folder.name, seed=SEED):
                results = json.loads((folder / "results.json").read_text())
                self.check_csv(folder, results)
                self.check_pages(folder / "report.pdf", results)
                self.check_show(folder, results)
                self.check_findings(results)
                self.check_decisions(results)
                self.check_tables(folder, results, site)
        with self.subTest(site=site.name, seed=SEED):
            self.check_worklist(site, out)
            self.check_history(out)

    def check_csv(self, folder, results):
        """1. values.csv has the values, U and decisions of results.json, and no others."""
        path = folder / "values.csv"
        if not path.exists():
            return
        rows = {(r["measurement"], r["plugin"], r["name"]): r for r in csv.DictReader(path.read_text().splitlines())}
        wanted = {(a.get("measurement", ""), a["plugin"], name): v for a, name, v in values_of(results)}
        self.assertEqual(set(rows), set(wanted))
        for key, v in wanted.items():
            self.assertAlmostEqual(float(rows[key]["value"]), v["value"], delta=1e-9 * max(1, abs(v["value"])), msg=key)
            self.assertEqual(bool(rows[key]["U"]), "U" in v, key)
            if "U" in v:
                self.assertAlmostEqual(float(rows[key]["U"]), v["U"], delta=1e-9 * max(1, v["U"]), msg=key)
            self.assertEqual(rows[key]["decision"], v.get("decision", ""), key)

    def check_pages(self, pdf, results, certificate=False):
        """1. A table of a PDF has each value with its U in one row, and no other decision than that of results.json."""
        if not pdf.exists() or not shutil.which("pdftotext"):
            return
        lines = page_lines(pdf)
        for a, name, v in values_of(results):
            if not v.get("U", 0) > 0 or a["plugin"] == "model-fit":
                continue
            number = row_of(v)
            if number is None:
                continue
            rows = [line for line in lines if number.search(line)]
            self.assertTrue(rows, (pdf.name, a["plugin"], a.get("measurement"), name, number.pattern, v))
            if "decision" not in v or v["decision"] not in ON_PAPER or ":" in name:  # rules side by side have no column for it
                continue
            wanted = ON_PAPER[v["decision"]]
            judged = [line for line in rows if any(re.search(r"(?<!\w)%s\s*$" % re.escape(w), line) for w in wanted)]
            if not certificate:
                self.assertTrue(judged, (pdf.name, a["plugin"], a.get("measurement"), name, v, rows))
        told = {}
        for a, name, v in values_of(results):
            if v.get("U", 0) > 0 and "decision" in v:
                told.setdefault(row_of(v), set()).add(v["decision"])
        for line in lines:  # and the other way round: a row that ends with a decision is one of a value
            for number, decisions in told.items():
                if number is None or not number.search(line):
                    continue
                found = {d for d, words in ON_PAPER.items() for w in words if re.search(r"\s\s%s\s*$" % re.escape(w), line)}
                if len(found) == 1:
                    self.assertLessEqual(found, decisions, (pdf.name, line, decisions))

    def check_show(self, folder, results):
        """2. `show` prints every value with the U of results.json, each once for a measurement and analysis."""
        shown = run("show", folder, "--all", "--quiet").stdout
        measurement = plugin = part = None
        printed = {}
        known = {a["plugin"] for a in results["analyses"]}
        for line in shown.splitlines():
            if line.startswith(("Measurement ", "Measurements ")):  # of several, results.json names the first
                measurement = line.split(" ", 1)[1].split(",")[0].strip()
            head = re.match(r"  (\S+) \d+\.\d+\.\d+(?: (\S+))?$", line)
            if head:
                plugin, part = head[1] if head[1] in known else None, head[2]
            row = re.match(r"    (?:!  |\?  |ok |   )(\S+)\s+(-?\d[\d.]*(?:e[-+]?\d+)?)\s+(\d[\d.]*)\s+(\S+)", line)
            if row and plugin:
                key = (measurement, plugin, part, row[1])
                self.assertNotIn(key, printed)
                printed[key] = (row[2], row[3], row[4])
        for a, name, v in values_of(results):
            if "U" not in v or not v["U"] > 0:
                continue
            key = (a.get("measurement"), a["plugin"], a.get("part"), name)
            if key not in printed:
                continue
            value, U, unit = printed[key]
            self.assertEqual(unit, v["unit"], key)
            decimals = len(value.partition(".")[2]) or min(0, 1 - math.floor(math.log10(v["U"])))
            self.assertLessEqual(abs(float(value) - v["value"]), 0.51 * 10.0 ** -decimals, (key, value, v))
            self.assertLessEqual(abs(float(U) - v["U"]), 0.051 * v["U"] + 1e-12, (key, U, v))

    def check_findings(self, results):
        """3. No finding of a measurement excludes another one of it."""
        of = {}
        for a in results["analyses"]:
            for f in a.get("findings", []):
                of.setdefault(a.get("measurement", ""), set()).add(f["id"])
        for measurement, ids in of.items():
            for group in EXCLUDE_EACH_OTHER:
                self.assertLessEqual(len(ids & group), 1, (measurement, ids & group))

    def check_decisions(self, results):
        """4. Every decision is that of its value, U and limit by the stated rule; each has its finding."""
        for a, name, v in values_of(results):
            if "decision" not in v or "tolerance" not in v or not v.get("U"):
                continue
            guard = 1.65 * v["U"] / min(v.get("k", 2.0), 2.0)
            rounding = 5e-4 if a["plugin"] == "lengths" else 1e-9  # of a limit that depends on the length
            size = abs(v["value"])
            limit = v["tolerance"]
            if v["decision"] == "conforms":
                self.assertLessEqual(size, limit - guard + rounding, (name, v))
            elif v["decision"] == "does not conform":
                self.assertGreater(size, limit + guard - rounding, (name, v))
            elif v["decision"] == "cannot be decided":
                self.assertTrue(limit - guard - rounding <= size <= limit + guard + rounding, (name, v))

    def check_tables(self, folder, results, site):
        """5. A table is written only where no finding forbids it, and the tables as the control reads them give the
        prediction that is printed."""
        drifted = {a.get("measurement") for a in results["analyses"] for f in a.get("findings", [])
                   if f["id"].startswith("drift.") and f["severity"] == "attention"}
        for table in results.get("tables", []):
            files = [o["file"] for o in results["outputs"] if o["plugin"] == table["plugin"]]
            refused = {f["measurement"] for f in table.get("findings", []) if f["id"] in ("table.refused-drift", "table.active-not-stated") and "measurement" in f}
            for p in table.get("predictions", []):
                self.assertNotIn(p["measurement"], refused, table["plugin"])
                if p["measurement"] in drifted:
                    self.assertFalse(files, (table["plugin"], p))
            self.replay(folder, results, table, files, site)

    def replay(self, folder, results, table, files, site):
        axes = {p["measurement"] for p in table.get("predictions", []) if p["name"] == "E"}
        if table["plugin"] not in ("siemens-840d", "heidenhain-tnc", "fanuc", "linuxcnc") or len(axes) != 1:
            return
        source = [p.parent for p in site.glob("**/campaign.toml") if re.search(r'(?m)^id\s*=\s*"%s"' % re.escape(results["campaign"]["id"]), p.read_text())]
        if len(source) != 1 or any("CEC" in f or "CMA" in f for f in files):
            return
        given = ",".join(str(folder / f) for f in files if not f.endswith(".txt") or table["plugin"] == "heidenhain-tnc")
        done = run("table", "predict", given, source[0], "--control", table["plugin"], "--json", expect=(0, 1, 2))
        if done.returncode == 2:
            return  # these files do not say which axis they are of
        told = {q["measurement"]: q for q in json.loads(done.stdout)["predictions"]}
        for p in table["predictions"]:
            if p["measurement"] not in told or p["name"] not in "EBM":
                continue
            after = [v for k, v in told[p["measurement"]]["after"].items() if k.startswith(p["name"] + "_")]
            if after and after[0] is not None:
                # No prediction is smaller than U of what the table compensates; without a budget U of the reversal is not printed.
                U = max([v["U"] for a in results["analyses"] if a.get("measurement") == p["measurement"] and a["plugin"] == "iso230-2"
                         for n, v in a["values"].items() if n in ("E", "M", "B_mean") and "U" in v], default=p["before"])
                delta = 0.002 + 0.01 * abs(p["predicted"])
                self.assertGreaterEqual(p["predicted"], after[0] - delta, (table["plugin"], p, files))
                self.assertLessEqual(p["predicted"], max(after[0], U) + delta, (table["plugin"], p, files))

    def check_worklist(self, site, out):
        """6. The values that are out or open are those of the worklist's lines, in every view; the words that nothing has to
        be done need both to be empty."""
        told = json.loads(run("status", "--actions", out, "--json").stdout)
        lines = json.dumps(told)
        newest = {}
        for path in sorted(out.glob("*/results.json")):
            results = json.loads(path.read_text())
            machine = results["campaign"].get("asset") or (results["campaign"].get("maker", ""), results["campaign"].get("serial", ""))
            for c in results.get("conformity", []):
                key = (str(machine), c.get("axis") or c.get("measurement"), c["plugin"], c["name"])
                date = results["campaign"].get("date", "")
                if key not in newest or date >= newest[key][0]:
                    newest[key] = (date, results["campaign"]["id"], c)
        open_items = [(campaign, c) for _, campaign, c in newest.values() if c["decision"] not in ("conforms", "pass")]
        for campaign, c in open_items:
            self.assertIn(json.dumps(campaign), lines, (campaign, c))
        if self.whole:  # each campaign is the newest of its machine
            asked = {line.get("campaign") for line in told["lines"] if line["kind"] in ("failed", "out", "withheld", "undecided")}
            shown = {folder.name for folder in out.iterdir() if (folder / "results.json").exists()
                     and re.match(r"\S+  (action required|failed)\n", run("show", folder).stdout)}
            self.assertEqual(asked, shown)
        if open_items:
            for text in (run("status", "--actions", out).stdout, (out / "summary.txt").read_text()):
                self.assertNotRegex(text, r"[Nn]othing has to be done|nothing needs a decision|Nothing was judged")
            index = out / "index.html"
            if index.exists():
                self.assertNotRegex(index.read_text(), r"[Nn]othing has to be done|nothing needs a decision|Nothing was judged")

    def check_history(self, out):
        """7. A value has one U (of k = 2) in results and history; no forecast keeps the date of an axis that is out, or one that has
        passed; a line of what comes soon has the last value of the history."""
        by_campaign = {json.loads(p.read_text())["campaign"]["id"]: json.loads(p.read_text()) for p in out.glob("*/results.json")}
        told = json.loads(run("machine", "history", out, "--json").stdout)
        out_now = set()
        for results in by_campaign.values():
            for c in results.get("conformity", []):
                if c["decision"] == "does not conform":
                    out_now.add((results["campaign"]["id"], c.get("axis")))
        measured = {}  # of a machine's axis: another travel may have been measured later, or on the same day
        for s in told["series"]:
            measured.setdefault((s["machine"], s["axis"]), set()).update((p["date"], p["campaign"]) for p in s["points"])
        for s in told["series"]:
            for p in s["points"]:
                results = by_campaign.get(p["campaign"], {"analyses": []})
                stated = [2.0 * v["U"] / v.get("k", 2.0) for a, name, v in values_of(results)
                          if name == s["quantity"] and "U" in v and abs(v["value"] - p["value"]) < 1e-6]
                if stated:  # of several measurements with this value one
                    self.assertTrue(any(abs(p["U"] - U) <= 1e-6 * U for U in stated), (s["machine"], p, stated))
            if s["points"] and s.get("forecast"):
                last = s["points"][-1]
                if s["forecast"]["date"] < told["date"]:
                    self.assertIn(s["forecast"]["answer"], ("act", "overdue", "passed", "watch-now", "cannot-say"),
                                  (s["machine"], s["quantity"]))
                if (last["campaign"], s["axis"]) in out_now and not any(
                        date >= last["date"] and c != last["campaign"] for date, c in measured[s["machine"], s["axis"]]):
                    self.assertNotEqual(s["forecast"]["answer"], "keep", (s["machine"], s["quantity"], last))
        for line in json.loads(run("status", "--actions", out, "--json").stdout)["lines"]:
            if line["kind"] == "soon":
                last = [s["points"][-1]["value"] for s in told["series"] if s["points"] and not s.get("ended")
                        and (s["machine"], s["quantity"]) == (line["machine"], line["quantity"]) and s["axis"] in ("", line["axis"])]
                self.assertTrue(any(abs(v - line["value"]) < 1e-9 for v in last), (line, last))


class Samples(Truth):
    def test_all_samples(self):
        self.whole = True
        with tempfile.TemporaryDirectory(prefix="nonio-truth-") as folder:
            out = pathlib.Path(folder) / "out"
            run("run", SOURCE / "samples/site", "--out", out, "--quiet")
            self.check_site(SOURCE / "samples/site", out)

    def test_the_order_of_measurements_does_not_decide_what_is_after(self):
        source = SOURCE / "samples/site/13-gantry-diagonals"
        head, *blocks = re.split(r"(?m)^(?=\[\[measurement\]\]$)", (source / "campaign.toml").read_text())
        blocks[-1], table, rest = re.match(r"(?s)(.*?)((?m:^\[(?!\[))|$)(.*)", blocks[-1]).groups()
        blocks = [b.rstrip() + ('\nadjustment = "%s"' % ("after" if ' final"' in b else "before") if 'kind = "diagonal"' in b else "") + "\n\n" for b in blocks]
        found = []
        for order in (blocks, blocks[::-1]):
            with tempfile.TemporaryDirectory(prefix="nonio-truth-") as folder:
                site, out = pathlib.Path(folder) / "site", pathlib.Path(folder) / "out"
                shutil.copytree(source, site / source.name)
                (site / source.name / "campaign.toml").write_text(head + "".join(order) + table + rest)
                run("run", site, "--out", out, "--quiet")
                results = json.loads((out / source.name / "results.json").read_text())
                after = [a["measurement"] for a in results["analyses"] for f in a.get("findings", []) if f["id"] == "diagonals.remeasured"]
                self.assertEqual([m.split(" ")[1] for m in after], ["final"])
                tables = [p for p in (out / source.name).glob("*CEC.ini")]
                self.assertEqual(len(tables), 1)
                found.append(re.findall(r"(?m)^\$AN_CEC\[.*", tables[0].read_text()))
        self.assertGreater(len(found[0]), 20)
        self.assertEqual(*found)

    def test_the_laboratory(self):
        with tempfile.TemporaryDirectory(prefix="nonio-truth-") as folder:
            out = pathlib.Path(folder) / "out"
            run("run", SOURCE / "samples/laboratory", "--out", out, "--quiet", "--date", "2026-11-22")
            self.check_site(SOURCE / "samples/laboratory", out)


    def test_a_made_laboratory(self):
        """As many campaigns as NONIO_ONE_TRUTH_LABORATORY says, about: machines over years, with pages and files."""
        print(f"seed {SEED}, about {LABORATORY} campaigns", flush=True)
        with tempfile.TemporaryDirectory(prefix="nonio-truth-") as folder:
            site, out = pathlib.Path(folder) / "site", pathlib.Path(folder) / "out"
            per_machine = 8
            subprocess.run([sys.executable, "-B", SOURCE / "tests/support/laboratory/make_laboratory.py", "mixed", site, "--seed", str(SEED),
                            "--machines", str(max(3, LABORATORY // per_machine)), "--count", str(per_machine)], check=True)
            text = (site / "site.toml").read_text()
            (site / "site.toml").write_text(re.sub(r"(?m)^outputs = .*$", 'outputs = ["csv", "pdf-report"]', text))
            run("run", site, "--out", out, "--quiet")
            self.check_site(site, out)


def leaves(value):
    """Every text and number in a JSON value."""
    if isinstance(value, (dict, list)):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from leaves(inner)
    else:
        yield value


def unmatched(line, document):
    """The numbers of a printed line that are not in the JSON to the printed digits, without those inside of its texts."""
    texts = {s for s in leaves(document) if isinstance(s, str) and re.search(r"[^\W\d]", s)}
    for s in sorted((s for s in texts if s in line), key=len, reverse=True):
        line = re.sub(r"(?<!\w)%s(?!\w)" % re.escape(s), " ", line)
    numbers = [v for v in leaves(document) if isinstance(v, (int, float)) and not isinstance(v, bool)]
    for token in re.findall(r"< 0\.0001|-?\d+(?:\.\d+)?(?:e[-+]?\d+)?", line):
        decimals = len(token.partition(".")[2])
        zeros = 0 if "." in token else len(token) - len(token.rstrip("0"))
        half = 0.5 * 10.0 ** (zeros - decimals) * (1 + 1e-9)
        if not any(v < 1e-4 if token.startswith("<") else abs(v - float(token)) <= half for v in numbers):
            yield token


class Terminal(unittest.TestCase):
    """9. compare, explain and model show print no number that is not in their JSON."""

    def check(self, printed, document):
        """Every number of the text is in the document; returns the parts of the document."""
        parts = document.get("parts", [document])
        for line in printed.splitlines():
            self.assertEqual(list(unmatched(line, document)), [], line)
        for name, label in (("rms", "RMS"), ("noise_floor", "noise floor")):
            shown = [float(v) for v in re.findall(r"(?m)^  %s +(-?[\d.]+(?:e-?\d+)?) " % label, printed)]
            wanted = [v for part in parts for k, v in (part["model"] if name == "rms" else part).items() if k in (f"{name}_um", f"{name}_arcsec")]
            self.assertEqual(len(shown), len(wanted), label)
            for a, b in zip(shown, wanted):
                self.assertAlmostEqual(a, b, delta=0.006 * abs(b) + 1e-12, msg=label)
        return parts

    def text_of(self, command, folder, *options):
        return run("model", command, folder, "--quiet", *options, expect=(0, 1, 2)).stdout.replace(str(folder), folder.parent.name)

    def json_of(self, command, folder, *options):
        text = run("model", command, folder, "--quiet", "--json", *options, expect=(0, 1, 2)).stdout
        return json.loads(text) if text else None

    def test_all_samples(self):
        folders = sorted(p.parent for place in ("site", "tutorial") for p in (SOURCE / "samples" / place).rglob("campaign.toml"))
        self.assertGreater(len(folders), 30)
        for folder in folders if os.environ.get("NONIO_LONG") else folders[::3]:
            with self.subTest(campaign=folder.name):
                compared, explained = self.json_of("compare", folder), self.json_of("explain", folder, "--what-if")
                if compared is None:  # nothing that a model explains was measured
                    self.assertEqual([explained, self.text_of("compare", folder), self.text_of("explain", folder)], [None, "", ""])
                    continue
                self.check(self.text_of("compare", folder), compared)
                self.check(re.split(r"(?m)^history$", self.text_of("show", folder))[0], compared)
                parts = self.check(self.text_of("explain", folder, "--all", "--what-if"), explained)
                self.best_are_shown(self.text_of("explain", folder), parts)

    def best_are_shown(self, printed, parts):
        """Without --all, the candidates are those that the JSON marks; of the others there is the number."""
        with_evidence = [c for part in parts for c in part.get("candidates", []) if c.get("score", 0) > 0]
        best = [c["effect"] for c in with_evidence if c.get("best")]
        self.assertEqual(re.findall(r"(?m)^  (\S+:\S+) +#* +[-\d]", printed), best)
        self.assertEqual(sum(map(int, re.findall(r"(\d+)[^\n\d]*\(--all\)", printed))), len(with_evidence) - len(best))

    def test_several_campaigns(self):
        for folder in sorted((SOURCE / "samples/laboratory").glob("LAB-*"))[:3]:
            with self.subTest(machine=folder.name):
                printed = self.text_of("explain", folder)
                parts = self.check(printed, self.json_of("explain", folder))
                self.assertIn(parts[0]["verdict"]["says"], printed)


class Certificates(Truth):
    """The certificate of samples/certificates, issued with a key of its own."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="nonio-truth-")
        self.addCleanup(holder.cleanup)
        self.site, self.out = pathlib.Path(holder.name) / "site", pathlib.Path(holder.name) / "out"
        if not shutil.which("openssl"):
            self.skipTest("there is no openssl to make a key with")
        shutil.copytree(SOURCE / "samples/certificates", self.site, ignore=shutil.ignore_patterns("keys", "*.sqlite"))
        subprocess.run(["bash", self.site / "make-key.sh"], check=True, capture_output=True)

    def issued(self, reason):
        run("run", self.site, "--out", self.out, "--quiet")
        draft, = json.loads(run("certificate", "approve", self.site, "--list", "--json").stdout)["drafts"]
        findings = sorted({f["id"] for f in draft["findings"] if f["severity"] == "attention"})
        run("certificate", "approve", self.site / "adjusted", "--by", "B. Sample", *(part for f in findings for part in ("--reason", f"{f}={reason}")), expect=(0,))
        return self.out / "adjusted/certificate.pdf"

    def test_the_certificate_has_the_values_and_decisions_of_the_results(self):
        pdf = self.issued("as found")
        results = json.loads((self.out / "adjusted/results.json").read_text())
        self.check_pages(pdf, results, certificate=True)
        text = " ".join(" ".join(page_lines(pdf)).split())
        for c in results.get("conformity", []):
            if c["decision"] in ON_PAPER:
                self.assertTrue(any(w in text for w in ON_PAPER[c["decision"]]), c)
        self.assertNotIn("as found", text)

    def test_an_expired_calibration_is_on_the_paper_with_the_reason_of_its_approval(self):
        manifest = self.site / "adjusted/campaign.toml"
        text = manifest.read_text()
        date = re.search(r"(?m)^date = (\S+)", text)[1]
        expired = str(int(date[:4]) - 1) + date[4:]
        text = re.sub(r"(?m)^valid_until = .*\n", "", text)
        text = re.sub(r"(?m)^(calibrated = ).*$", r"\g<1>%d%s\nvalid_until = %s" % (int(date[:4]) - 2, date[4:], expired), text, count=1)
        manifest.write_text(text)
        pdf = self.issued("compared with the reference of Turin")
        for paper in (" ".join(" ".join(page_lines(pdf)).split()), (self.out / "adjusted/certificate.xml").read_text()):
            self.assertIn(expired, paper)
            self.assertIn("compared with the reference of Turin", paper)
            self.assertRegex(paper, r"(Approvato da|Approved by) B\. Sample")
        results = json.loads((self.out / "adjusted/results.json").read_text())
        self.assertEqual([r["finding"] for r in results["certificate"]["reasons"]], ["traceability.calibration-expired"])
        answers = json.loads(run("certificate", "verify", pdf, "--site", self.site, "--json", expect=(0, 3)).stdout)  # 3: there is no revocation list
        checks = {c["id"]: c["state"] for c in answers["checks"]}
        for check in ("content.values", "content.printed"):
            self.assertEqual(checks.get(check), "holds", answers)


CONTROLS = {"siemens-840d": "number = 1", "fanuc": "number = 1", "linuxcnc": "joint = 0", "heidenhain-tnc": None}


def random_campaign(rng, folder, i):
    """An axis with effects of any size: what it is made of is not known to what is tested."""
    rotary = rng.random() < 0.25
    axis, unit = ("C", "deg") if rotary else ("X", "mm")
    small = "arcsec" if rotary else "um"
    length = 360.0 if rotary else rng.choice([300.0, 800.0, 1400.0])
    n = rng.choice([9, 11, 13])
    targets = [round(length * (k + 0.25 * rng.uniform(-1, 1) * (0 < k < n - 1)) / (n - 1), 3) for k in range(n)]
    runs, s = rng.choice([2, 3, 5]), rng.choice([0.1, 0.3, 1.0])
    slope, wave, phase = rng.gauss(0, 6), rng.gauss(0, 3), rng.uniform(0, 6)
    lost, elastic, drift, wedge = rng.choice([0, rng.gauss(0, 4)]), rng.choice([0, 0, rng.gauss(0, 3)]), rng.choice([0, 0, 0, rng.gauss(0, 10)]), rng.choice([0, 0, 0, rng.gauss(0, 10)])
    rows, t, total = [f"run,direction,target_{unit},deviation_{small}"], 0, 2 * runs * n
    for r in range(1, runs + 1):
        for d in (1, -1):
            for x in targets if d > 0 else targets[::-1]:
                p = x / length
                v = slope * p + wave * math.sin(2 * math.pi * p + phase) + d / 2 * (lost + elastic * math.sin(2 * math.pi * p))
                rows.append(f"{r},{'+' if d > 0 else '-'},{x:g},{v + (drift + wedge * p) * t / total + rng.gauss(0, s):.3f}")
                t += 1
    control = rng.choice(list(CONTROLS))
    limits = rng.random() < 0.8
    machine = rng.choice([f'asset = "M-{i % 7}"\n', f'maker = "Maker"\nserial = "{i % 5}"\n', ""])
    text = (f'format = 1\n[campaign]\nid = "c{i}"\ncustomer = "Customer"\ndate = 2026-{1 + i % 9:02}-{1 + i % 27:02}\n[machine]\nmodel = "M"\n{machine}'
            f'control = "{control}"\n[machine.axes.{axis}]\nkind = "{"rotary" if rotary else "linear"}"\ntravel = [0, {length:g}]\n'
            + ("" if rotary else "expansion_um_per_m_K = 11.5\n")
            + (f'active_table = "none"\nactive_backlash_{unit} = "none"\n' if rng.random() < 0.8 else "")
            + (f"tolerance_{small} = {{ A = {rng.choice([6.0, 10.0, 20.0])}, B = {rng.choice([2.0, 4.0, 8.0])} }}\n" if limits else "")
            + ("[instrument]\nU_arcsec = 0.3\n[environment]\ndrift_arcsec = 0.3\n" if rotary else
               "[instrument]\nU_fixed_um = 0.2\nU_per_m_um = 0.5\n[environment]\nmisalignment_mm = 0.5\ntemperature_range_K = 0.2\n"
               "temperature_difference_K = 0.5\nexpansion_range_um_per_m_K = 1.0\ndrift_um = 0.4\n")
            + f'[[measurement]]\nid = "{axis}"\nkind = "axis"\naxis = "{axis}"\nfile = "x.csv"\n'
            + (f"[options.{control}.axes.{axis}]\n{CONTROLS[control]}\n" if CONTROLS[control] else ""))
    folder.mkdir(parents=True)
    (folder / "campaign.toml").write_text(text)
    (folder / "x.csv").write_text("\n".join(rows) + "\n")


class Random(Truth):
    def test_random_campaigns(self):
        print(f"seed {SEED}, {CAMPAIGNS} campaigns", flush=True)
        rng = random.Random(SEED)
        with tempfile.TemporaryDirectory(prefix="nonio-truth-") as folder:
            site, out = pathlib.Path(folder) / "site", pathlib.Path(folder) / "out"
            for i in range(CAMPAIGNS):
                random_campaign(rng, site / f"c{i}", i)
            run("run", site, "--out", out, "--quiet")
            self.check_site(site, out)

    def test_compare_explain_and_add_state_the_same_error(self):
        """8. One model has one RMS, in compare, explain and model add; a table leaves no more than there was."""
        rng = random.Random(SEED + 1)
        for i in range(max(2, CAMPAIGNS // 8)):
            with tempfile.TemporaryDirectory(prefix="nonio-truth-") as folder, self.subTest(i=i, seed=SEED):
                campaign = pathlib.Path(folder) / "c0"
                random_campaign(rng, campaign, 0)
                for _ in range(4):
                    explained = json.loads(run("model", "explain", campaign, "--json").stdout)
                    part, = explained.get("parts", [explained])
                    compared, = json.loads(run("model", "compare", campaign, "--json").stdout)["parts"]
                    rms = next(k for k in part["model"] if k.startswith("rms_"))
                    self.assertAlmostEqual(part["model"][rms], compared["model"][rms], delta=1e-6)
                    if "after_table" in compared:
                        after = compared["after_table"]
                        if set(after["takes"]) == set(compared["model"]["effects"]):  # else what remains may have hidden the rest
                            self.assertLessEqual(after[rms], after[rms.replace("rms_", "rms_before_")] * 1.0001)
                    if part["verdict"]["kind"] != "missing":
                        break
                    effect = part["verdict"]["effect"]
                    promised = next(c[rms] for c in part["candidates"] if c["effect"] == effect)
                    run("model", "add", campaign, effect, "--quiet")
                    obtained, = json.loads(run("model", "compare", campaign, "--json").stdout)["parts"]
                    self.assertAlmostEqual(promised, obtained["model"][rms], delta=0.02 * obtained["model"][rms])


if __name__ == "__main__":
    unittest.main()
