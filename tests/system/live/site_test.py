# SPDX-License-Identifier: Apache-2.0
"""`nonio serve SITE`: the worklist, entries, certificates, runs, and the workbench of each campaign."""
import fcntl
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time
import urllib.parse

import unittest

from live import LiveTest, NONIO, ROOT, SAMPLES, Server, Stream, json_of, nonio

DATE = "2026-11-23"


def processes_that_make_pages(out):
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            arguments = (process / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if b"--page=-" in arguments and os.fsencode(out) in arguments:
            yield int(process.name)


class SiteStream(Stream):
    path = "/api/site/events"


class Sites(LiveTest):
    def setUp(self):
        super().setUp()
        self.small = self.site.parent / "small"
        self.small.mkdir()
        shutil.copy(SAMPLES / "site.toml", self.small)
        for name in ("02-constant-reversal", "03-opposed-sinusoids"):
            shutil.copytree(SAMPLES / name, self.small / name)
        shutil.copytree(SAMPLES / "machines", self.small / "machines")
        self.out = self.site.parent / "out"

    def night(self, *more):
        nonio("run", self.small, "--out", self.out, "--quiet", "--date", DATE, *more, expect=None)

    def until_run_ends(self, s):
        return s.until("/api/site/state", lambda state: not state["running"], "done")

    def test_the_worklist_is_that_of_the_terminal(self):
        self.night()
        with Server(self.small, "--out", self.out) as s:
            got = s.get("/api/site")
            wanted = json_of("morning", self.out, expect=None)
            self.assertGreater(len(wanted["lines"]), 0)
            self.assertEqual({k: got[k] for k in wanted}, wanted)
            self.assertIn("nonio status --actions", got["command"])
            state = s.get("/api/site/state")
            s.until("/api/campaigns", lambda a: [c["folder"] for c in a["campaigns"]] == ["03-opposed-sinusoids", "02-constant-reversal"], "listed, the newest first")
            self.assertEqual(state["night"], {"state": "complete", "night": 1, "date": DATE, "last": 1, "last_date": DATE})
            pages = [p.relative_to(self.out) for p in (*self.out.glob("*.html"), *self.out.glob("machines/*.html"), self.out / "due.ics")]
            self.assertGreater(len(pages), 5)
            for page in pages:  # nothing was entered since: the same bytes
                status, headers, body = s.request("GET", f"/site/{page}")
                self.assertEqual((status, body), (200, (self.out / page).read_bytes()), page)
                self.assertEqual(headers["Content-Type"], "application/octet-stream")
            for name in ("..%2Fsummary.json", "summary.json", "%2Fetc%2Fpasswd", "none.html", "..%2F..%2Fsmall%2Fsite.toml", ".nonio", "machines%2Fx.html"):
                self.assertEqual(s.request("GET", f"/site/{name}")[0], 404, name)
            self.assertEqual(s.request("GET", "/site/index.html", token=False)[0], 403)
            self.assertEqual(s.request("GET", "/", token=False)[0], 200)

    def test_pages_of_machines_come_from_one_process_which_may_end(self):
        self.night()
        with Server(self.small, "--out", self.out) as s:
            page = "machines/" + next((self.out / "machines").glob("*.html")).name
            same = (self.out / page).read_bytes()

            def served():
                self.assertEqual(s.request("GET", f"/site/{page}")[2], same)
                return list(processes_that_make_pages(self.out))
            first, = served()
            self.assertEqual(served(), [first])
            os.kill(first, signal.SIGKILL)
            served()
            second, = served()
            self.assertNotEqual(first, second)
        deadline = time.monotonic() + 30
        while left := list(processes_that_make_pages(self.out)):
            self.assertLess(time.monotonic(), deadline, left)
            time.sleep(0.1)

    def test_metrics_of_the_last_run_for_programs_with_the_token(self):
        with Server(self.small, "--out", self.out) as s:
            self.assertEqual(s.request("GET", "/metrics")[0], 503)  # no run yet
            self.night()
            status, headers, body = s.request("GET", "/metrics", headers={"Authorization": f"Bearer {s.token}"}, token=False)
            self.assertEqual((status, headers["Content-Type"]), (200, "application/openmetrics-text; version=1.0.0; charset=utf-8"))
            same = subprocess.run([NONIO, "status", self.out, "--metrics"], capture_output=True, check=True).stdout

            def without_age(text):
                return [line for line in text.splitlines() if not line.startswith(b"nonio_last_run_age_seconds")]
            self.assertEqual(without_age(body), without_age(same))
            self.assertIn(b"nonio_campaigns{", body)
            for headers in ({}, {"Authorization": "Bearer " + s.token[:-1] + "x"}, {"Authorization": "Basic " + s.token}, {"Authorization": s.token},
                            {"Authorization": f"Bearer {s.token}", "X-Nonio-Token": "0" * 32}, {"Authorization": f"Bearer {s.token}", "Origin": "http://other"}):
                self.assertEqual(s.request("GET", "/metrics", headers=headers, token=False)[0], 403, headers)
            if shutil.which("promtool"):
                subprocess.run(["promtool", "check", "metrics"], input=body, check=True)
            else:
                print("promtool is not installed: its check is skipped", flush=True)
        with Server(self.small) as s:
            self.assertEqual(s.get("/metrics", expect=409)["id"], "no_out")

    def test_without_an_output_folder_it_says_so(self):
        with Server(self.small) as s:
            self.assertEqual("no_out", s.get("/api/site", expect=409)["id"])
            self.assertEqual(s.get("/api/site/state")["night"]["state"], "none")
            self.assertEqual(s.request("GET", "/site/index.html")[0], 404)
            self.assertEqual(s.request("GET", "/site/results/02-constant-reversal/results.json")[0], 404)

    def test_files_of_the_results(self):
        self.night()
        (self.out / "02-constant-reversal/link").symlink_to(self.out / "summary.json")
        with Server(self.small, "--out", self.out) as s:
            status, headers, body = s.request("GET", "/site/results/02-constant-reversal/results.json")
            self.assertEqual((status, body), (200, (self.out / "02-constant-reversal/results.json").read_bytes()))
            self.assertEqual(headers["Content-Type"], "application/octet-stream")
            for campaign, name in (("02-constant-reversal", "link"), ("02-constant-reversal", "none"), (".nonio", "night.json"), ("..", "site.toml"),
                                   ("02-constant-reversal", "..%2F..%2Fsmall%2Fsite.toml"), ("%2Fetc", "passwd"), ("machines", "..")):
                self.assertEqual(s.request("GET", f"/site/results/{campaign}/{name}")[0], 404, (campaign, name))

    def test_the_workbench_of_a_campaign(self):
        with Server(self.small) as s:
            answer = s.post("/api/open", {"campaign": "02-constant-reversal"})
            self.assertEqual(answer["path"], "/c/02-constant-reversal/")
            self.assertIn(b"/app.js", s.request("GET", answer["path"], token=False)[2])
            self.assertIn(b"/site.js", s.request("GET", "/", token=False)[2])
            first, second = "/c/02-constant-reversal/api/", "/c/03-opposed-sinusoids/api/"
            for at in (first, second):
                s.until(at + "state", lambda state: state.get("bench") == "open", "open")
            s.post(second + "model", {"model": []})
            self.assertEqual(s.get(second + "state")["campaign"]["id"], "03-opposed-sinusoids")
            fit = s.until(first + "parts/Z/fit", lambda a: a.get("status") != 409, "fitted")
            self.assertEqual(fit["compare"], json_of("compare", self.small / "02-constant-reversal")["parts"][0])
            for wrong in ("none", "../site", "", ".", "02-constant-reversal/..", "/etc"):
                self.assertEqual(s.post("/api/open", {"campaign": wrong}, expect=404)["status"], 404)
                self.assertEqual(s.request("GET", f"/c/{urllib.parse.quote(wrong, safe='')}/api/state")[0], 404, wrong)
            self.assertEqual(s.get("/api/state", expect=404)["status"], 404, "no campaign at the root of a site")

    def test_a_campaign_is_opened_by_the_id_of_its_results(self):
        text = (self.small / "02-constant-reversal/campaign.toml").read_text()
        (self.small / "02-constant-reversal/campaign.toml").write_text(text.replace('id = "02-constant-reversal"', 'id = "another-name"'))
        self.night()
        with Server(self.small, "--out", self.out) as s:
            self.assertEqual(s.post("/api/open", {"campaign": "another-name"})["path"], "/c/02-constant-reversal/")

    def test_entries_need_edit_and_are_those_of_the_verbs(self):
        event = {"machine": "S-0102", "axis": "Z", "kind": "crash", "text": "--help; $(rm -rf /) 'hit'", "date": "2026-11-01", "by": "-x"}
        with Server(self.small) as s:
            for path, body in (("event", event), ("ack", {}), ("run", {}), ("run/cancel", {}), ("release", {"campaign": "c", "by": "x"})):
                self.assertEqual("read_only", s.post("/api/" + path, body, expect=403)["id"])
            self.assertEqual(s.get("/api/event")["events"], [])
            self.assertEqual(s.get("/api/ack")["acknowledged"], [])
        self.assertFalse((self.small / "events.toml").exists())
        with Server(self.small, "--edit") as s:
            answer = s.post("/api/event", event)
            self.assertIn("nonio machine event", answer["command"])
            told = s.get("/api/event")["events"]
            self.assertEqual(told, json_of("event", self.small)["events"])
            # Who has the token can state any name.
            stated = lambda entry: entry | {"by": entry["by"] + " (not authenticated)"}
            self.assertEqual({k: told[0][k] for k in event}, stated(event))
            known = {"finding": "reversal.constant", "machine": "S-0102", "until": "2027-01-01", "by": "B. Sample", "why": "nut is ordered"}
            s.post("/api/ack", known)
            self.assertIn("nut is ordered", (self.small / "acknowledged.toml").read_text())
            self.assertEqual({k: s.get("/api/ack")["acknowledged"][0][k] for k in known}, stated(known))
            self.assertIn("YYYY-MM-DD", s.post("/api/ack", {"finding": "f", "machine": "m", "until": "soon", "by": "b", "why": "w"}, expect=422)["error"])
            self.assertIn("takes back no", s.post("/api/ack", {"withdraw": True, "finding": "reversal.constant", "machine": "S-0103", "by": "b"}, expect=422)["error"])
            s.post("/api/ack", {"withdraw": True, "finding": "reversal.constant", "machine": "S-0102", "by": "B. Sample"})
            self.assertEqual(s.get("/api/ack")["acknowledged"], [])
            for path in ("ack", "event"):
                self.assertEqual(s.post("/api/" + path, {}, expect=400)["status"], 400, "an empty body lists nothing")
            self.assertEqual(s.post("/api/event", {"machine": 7, "kind": "crash"}, expect=400)["status"], 400)
            self.assertIn("error", s.post("/api/release", {"campaign": "02-constant-reversal", "by": "B. Sample"}, expect=None) | {"error": ""})

    def laboratory(self):
        """Instead of the small site one with lines that ask for something."""
        shutil.rmtree(self.small)
        shutil.copytree(ROOT / "samples/laboratory", self.small, ignore=lambda _, names: [n for n in names if n.startswith("LAB-") and n != "LAB-02"])
        self.night()

    def test_what_is_entered_counts_at_once_and_every_page_hears_of_it(self):
        self.laboratory()
        with Server(self.small, "--edit", "--out", self.out) as s:
            line = next(l for l in s.get("/api/site")["lines"] if l.get("machine") and l["state"] == "new" and l["kind"] not in ("lost", "failed"))
            state = lambda: next(l for l in s.get("/api/site")["lines"] if l["id"] == line["id"])
            stream = SiteStream(s)
            events = stream.events()
            s.post("/api/ack", {"finding": line["id"], "machine": line["machine"], "until": "2099-01-01", "by": "B. Sample", "why": "nut is ordered"})
            self.assertEqual(next(e for e in events if e[1] == "worklist")[2]["version"], s.get("/api/site/state")["version"])
            now = state()
            self.assertEqual((now["state"], now["by"], now["until"], now["why"]), ("known", "B. Sample (not authenticated)", "2099-01-01", "nut is ordered"))
            page = s.request("GET", "/site/index.html")[2].decode()
            self.assertIn(f'class="known" data-line="{line["id"]}"', page)
            self.assertIn("nut is ordered", page)
            self.assertNotIn("nut is ordered", (self.out / "index.html").read_text(), "the night's own page is the night's")
            # On a terminal; the page hears of it too.
            nonio("machine", "ack", self.small, "--withdraw", "--finding", line["id"], "--machine", line["machine"], "--by", "B. Sample")
            next(e for e in events if e[1] == "worklist")
            self.assertEqual(state()["state"], "new")
            stream.close()

    def test_the_page_shows_what_the_next_run_reports(self):
        self.laboratory()
        lines = json_of("morning", self.out, expect=None)["lines"]
        line = next(l for l in lines if l.get("machine") and l["state"] == "new" and l["kind"] not in ("lost", "failed"))
        nonio("machine", "ack", self.small, "--finding", line["id"], "--machine", line["machine"], "--until", "2099-01-01", "--by", "B. Sample", "--why", "nut is ordered", "--date", DATE)
        nonio("machine", "event", self.small, "--machine", line["machine"], "--kind", "other", "--text", "moved", "--date", "2026-01-01")
        with Server(self.small, "--out", self.out) as s:
            now = s.get("/api/site")["lines"]
        self.assertEqual(json_of("morning", self.out, expect=None)["lines"], lines, "without --site it is the night's")
        self.night()
        self.assertEqual(json_of("morning", self.out, expect=None)["lines"], now)

    def test_a_run_with_progress(self):
        with Server(self.small, "--edit", "--out", self.out) as s:
            stream = SiteStream(s)
            events = stream.events()
            begun = s.post("/api/run", expect=202)
            self.assertIn("nonio run", begun["command"])
            next(e for e in events if e[1] == "run")
            state = self.until_run_ends(s)
            self.assertEqual((state["run"]["state"], state["run"]["done"], state["run"]["to_do"]), ("done", 2, 2))
            self.assertTrue((self.out / "02-constant-reversal/results.json").exists())
            self.assertEqual(s.get("/api/site")["schema"], "nonio-morning/1")
            next(e for e in events if e[1] == "worklist")
            stream.close()

    def test_one_campaign_is_run_again(self):
        self.night()
        with Server(self.small, "--edit", "--out", self.out) as s:
            self.assertEqual(s.post("/api/run", {"campaign": "none"}, expect=404)["status"], 404)
            self.assertEqual(s.post("/api/run/cancel", expect=409)["status"], 409)
            begun = s.post("/api/run", {"campaign": "02-constant-reversal"}, expect=202)
            self.assertIn("--only=02-constant-reversal", begun["command"])
            run = self.until_run_ends(s)["run"]
            self.assertEqual((run["state"], run["campaign"], run["same_results"]), ("done", "02-constant-reversal", True))
            file = next((self.small / "02-constant-reversal").glob("*.csv"))
            lines = file.read_text().splitlines()
            (self.small / "02-constant-reversal" / file.name).write_text("\n".join(lines[:-1] + [lines[-1] + "9"]) + "\n")
            s.post("/api/run", {"campaign": "02-constant-reversal"}, expect=202)
            state = self.until_run_ends(s)
            self.assertEqual((state["run"]["state"], state["run"]["same_results"], state["night"]["night"]), ("done", False, 1))
            # While another process runs the site, a run is refused with the message of the verb.
            with open(self.out / ".nonio/lock") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                s.post("/api/run", {"campaign": "02-constant-reversal"}, expect=202)
                run = self.until_run_ends(s)["run"]
                self.assertEqual(run["state"], "refused")
                self.assertIn("another run", run["message"])

    def test_a_run_is_cancelled(self):
        with Server(self.site, "--edit", "--out", self.out) as s:
            s.post("/api/run", expect=202)
            self.assertEqual(s.post("/api/run", expect=409)["status"], 409)
            s.until("/api/site/state", lambda state: state["run"]["stage"] == "campaigns", "evaluating")
            s.post("/api/run/cancel", expect=202)
            state = self.until_run_ends(s)
            self.assertEqual(state["run"]["state"], "cancelled")
            s.until("/api/site/state", lambda state: state["night"]["state"] == "cut-short", "cut short")
            nonio("run", self.site, "--out", self.out, "--quiet", expect=None)
            self.assertEqual(json.loads((self.out / ".nonio/night.json").read_text())["state"], "complete")

    def test_a_run_in_the_meantime_is_reported(self):
        self.night()
        with Server(self.small, "--out", self.out) as s:
            file = self.out / ".nonio/night.json"
            text = file.read_text()
            with open(self.out / ".nonio/lock") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                night = json.loads(text)
                file.write_text(json.dumps({**night, "state": "running", "night": 2, "last": night["end"]}))
                state = s.until("/api/site/state", lambda state: state["night"]["state"] == "running", "running")
                self.assertEqual((state["night"]["night"], state["night"]["last"], state["night"]["last_date"]), (2, 1, DATE))
                self.assertGreater(len(s.get("/api/site")["lines"]), 0, "the results of the night before")
            s.until("/api/site/state", lambda state: state["night"]["state"] == "cut-short", "cut short")
            file.write_text(text)
            nonio("run", "plan", self.small, "--out", self.out, "--shards", "2", "--date", DATE)
            s.until("/api/site/state", lambda state: state["night"]["state"] == "planned", "planned")
            nonio("run", "cancel", self.out)
            file.write_text(text)
            s.until("/api/site/state", lambda state: state["night"]["state"] == "complete", "complete")

    def test_the_end_of_the_server_ends_a_run(self):
        s = Server(self.site, "--edit", "--out", self.out)
        s.post("/api/run", expect=202)
        s.end()
        self.assertEqual(s.process.returncode, 0)

    def test_a_dropped_file_is_verified(self):
        with Server(self.small) as s:
            for kind, data in (("application/pdf", b"%PDF-1.7 no certificate"), ("application/xml", b"<a/>"), ("application/json", b"{}")):
                status, _, body = s.request("POST", "/api/verify", data, {"Content-Type": kind})
                answer = json.loads(body)
                self.assertIn(status, (200, 422), body)
                self.assertFalse(answer.get("holds", False), answer)
            self.assertEqual(s.request("POST", "/api/verify", b"%PDF", {"Content-Type": "text/html"})[0], 415)
        self.assertEqual(list(pathlib.Path("/tmp").glob("nonio-live-??????/certificate*")), [])


class Certificates(LiveTest):
    """Of a site that signs, with a key that is made here."""

    def setUp(self):
        super().setUp()
        self.lab = self.site.parent / "certificates"
        shutil.copytree(ROOT / "samples/certificates", self.lab)
        subprocess.run([self.lab / "make-key.sh"], check=True, capture_output=True)
        self.out = self.site.parent / "out"
        nonio("run", self.lab, "--out", self.out, "--quiet", expect=None)

    def verified(self, s, file, kind):
        return json.loads(s.request("POST", "/api/verify", file.read_bytes(), {"Content-Type": kind})[2])

    def test_draft_release_verify_and_again(self):
        with Server(self.lab, "--out", self.out, "--edit") as s:
            drafts = s.get("/api/drafts")["drafts"]
            self.assertEqual([d["campaign"] for d in drafts], ["adjusted"])
            self.assertEqual(s.request("GET", "/site/results/adjusted/certificate-draft.pdf")[2][:5], b"%PDF-")
            asking = {(f["measurement"] + ": " if f["measurement"] else "") + f["id"] for f in drafts[0]["findings"] if f["severity"] == "attention"}
            stream = SiteStream(s)
            answer = s.post("/api/release", {"campaign": "adjusted", "by": "B. Sample"})
            self.assertEqual((answer["state"], set(answer["without_reason"])), ("lacking", asking))
            answer = s.post("/api/release", {"campaign": "adjusted", "by": "B. Sample", "reasons": {key: "as found" for key in asking}})
            self.assertEqual((answer["state"], answer["number"]), ("issued", "S-0001"))
            # Names without a password prove nothing.
            self.assertIn("B. Sample (name not authenticated, account", " ".join(nonio("certificate", "list", self.lab).stdout.split()))
            told = s.get("/api/findings?campaign=adjusted")
            shown = " ".join(nonio("show", self.out / "adjusted").stdout.split())
            # A draft has the decisions, too.
            warnings = lambda findings: {f["title"] for f in findings if f["severity"] == "attention"}
            self.assertTrue(warnings(told["findings"]))
            self.assertLessEqual(warnings(told["findings"]), warnings(drafts[0]["findings"]))
            for f in told["findings"]:
                for sentence in [f["title"]] + (f["says"] + f["advice"] if f["severity"] == "attention" else []):
                    self.assertIn(" ".join(sentence.split()), shown)
            self.assertEqual("no_result", s.get("/api/findings?campaign=../adjusted", expect=404)["id"])
            next(e for e in stream.events() if e[1] == "drafts")
            stream.close()
            self.assertEqual(s.get("/api/drafts")["drafts"], [])
            pdf, xml = self.out / "adjusted/certificate.pdf", self.out / "adjusted/certificate.xml"
            for file, kind in ((pdf, "application/pdf"), (xml, "application/xml")):
                self.assertTrue(self.verified(s, file, kind)["holds"], file)
            issued = {p: p.read_bytes() for p in (pdf, xml)}
            forged = self.out.parent / "forged.pdf"
            forged.write_bytes(issued[pdf].replace(b"S-0001", b"S-0002"))
            self.assertFalse(self.verified(s, forged, "application/pdf")["holds"])
            # The campaign again: its number is not drawn twice.
            s.post("/api/run", {"campaign": "adjusted"}, expect=202)
            run = s.until("/api/site/state", lambda state: not state["running"], "done")["run"]
            self.assertEqual(run["state"], "done", run)
            self.assertEqual({p: p.read_bytes() for p in issued}, issued)
            self.assertEqual(len(json_of("certificates", self.lab)["certificates"]), 1)
            # Other readings: the draft of an amendment, and no number yet.
            manifest = self.lab / "adjusted/campaign.toml"
            manifest.write_text(manifest.read_text().replace("B = 3.0", "B = 5.0").replace("customer_data", 'amendment = "The tolerance was wrong."\ncustomer_data'))
            s.post("/api/run", {"campaign": "adjusted"}, expect=202)
            s.until("/api/site/state", lambda state: not state["running"], "done")
            drafts = s.get("/api/drafts")["drafts"]
            self.assertEqual([d.get("replaces") for d in drafts], ["S-0001"])
            self.assertEqual(len(json_of("certificates", self.lab)["certificates"]), 1)

            # The number in force is found as long as its successor is a draft, and no longer after its withdrawal.
            def listed(query="", found=1):
                return s.until(f"/api/campaigns?{query}", lambda a: a["found"] == found, f"{query}: {found}")["campaigns"]
            self.assertEqual([c["certificate"] for c in listed("search=S-0001")], ["S-0001"])
            # A copied folder does not get what another one was given.
            shutil.copytree(self.lab / "adjusted", self.lab / "copy")
            copy = next(c for c in listed(found=2) if c["folder"] == "copy")
            self.assertEqual((copy["state"], copy.get("certificate"), copy["files"]), ("failed", None, []))
            self.assertIn("adjusted", copy["message"])
            shutil.rmtree(self.lab / "copy")
            instruments = lambda: s.request("GET", "/site/instruments.html")[2].decode()
            self.assertIn("<td>S-0001</td>", instruments())
            nonio("certificate", "withdraw", self.lab, "S-0001", "--why", "wrong machine", "--by", "B. Sample")
            listed("search=S-0001", found=0)
            self.assertIn("<td>S-0001 (not in force)</td>", instruments())
            drafts = [d["campaign"] for d in s.get("/api/drafts")["drafts"]]
            s.until("/api/site", lambda a: [x["campaigns"] for x in a["lines"] if x["id"].startswith("worklist.draft")] == ([drafts] if drafts else []), f"drafts {drafts}")


if __name__ == "__main__":
    unittest.main()
