# SPDX-License-Identifier: Apache-2.0
"""The campaigns of a site on its page, by HTTP: lists, a dropped file as it would be read, forms, new campaigns, and requests
that may do nothing."""
import concurrent.futures
import json
import os
import pathlib
import random
import shutil
import sys
import tomllib
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
import sheets
from live import LiveTest, SAMPLES, Server, json_of, nonio

SEED = int(os.environ.get("NONIO_SEED", str(random.SystemRandom().randrange(1 << 32))))
KNOWN = ["run", "direction", "target_mm", "deviation_um"]
VALUES = {"campaign.date": "2026-11-20", "campaign.customer": 'Rossi "Torni" & figli', "machine.maker": "Zayer", "machine.serial": "0417",
          "instrument.model": "L 80", "instrument.U_fixed_um": "0,2", "instrument.U_per_m_um": "0.5", "axis.tolerance.A": "12", "axis.from": "0", "axis.to": "600",
          "axis.compensation": "none"}


def readings(names=KNOWN, seed=SEED, more=()):
    r = random.Random(seed)
    targets = [round(20 + 46 * i + r.uniform(-4, 4), 3) for i in range(11)]
    return [[*names, *more]] + [[run, way, t, round(r.gauss(0.003 * t, 0.25), 3), *["" for _ in more]]
                                for run in range(1, 6) for way in "+-" for t in (targets if way == "+" else targets[::-1])]


def text_of(rows, separator=",", mark="."):
    return "\n".join(separator.join(str(cell).replace(".", mark) for cell in row) for row in rows) + "\n"


class CampaignsOfASite(LiveTest):
    def setUp(self):
        super().setUp()
        print(f"seed {SEED}", flush=True)
        shutil.rmtree(self.site)
        self.site.mkdir()
        (self.site / "site.toml").write_text('[laboratory]\nname = "Sample"\n')
        self.out = self.site.parent / "out"

    def serve(self, *more):
        return Server(self.site, "--out", self.out, *more)

    def send(self, server, path, form, data, expect=200, headers=None):
        body = json.dumps(form).encode() + b"\n" + data
        status, _, answer = server.request("POST", path, body, {"Content-Type": "application/octet-stream", **(headers or {})})
        self.assertEqual(expect, status, f"{path}: {answer[:600]!r} {server.words()}")
        return json.loads(answer)

    def create(self, server, data=None, expect=200, name="x.csv", axis="X", values=None, **more):
        data = text_of(readings()).encode() if data is None else data
        return self.send(server, "/api/campaigns", {"name": name, "axis": axis, "values": {**VALUES, **(values or {})}, **more}, data, expect)

    def folders(self):
        return sorted(p.name for p in self.site.iterdir() if p.is_dir())

    # ---- what a person does ----
    def test_from_an_empty_site_to_results(self):
        with self.serve("--edit") as s:
            self.assertEqual((0, 0, []), tuple(s.until("/api/campaigns", lambda a: a["complete"], "complete")[k] for k in ("found", "all", "campaigns")))
            data = text_of(readings()).encode()
            made = self.create(s, data)
            folder = self.site / made["campaign"]
            self.assertEqual(data, (folder / "x.csv").read_bytes(), "the file is as it was dropped")
            manifest = tomllib.loads((folder / "campaign.toml").read_text())
            self.assertEqual('Rossi "Torni" & figli', manifest["campaign"]["customer"])
            self.assertEqual((0.2, [0, 600], {"A": 12}, "none", "none"), (manifest["instrument"]["U_fixed_um"], manifest["machine"]["axes"]["X"]["travel"], manifest["machine"]["axes"]["X"]["tolerance_um"],
                             manifest["machine"]["axes"]["X"]["active_table"], manifest["machine"]["axes"]["X"]["active_backlash_mm"]))
            listed = s.get("/api/campaigns")["campaigns"]
            self.assertEqual([(made["campaign"], "new", "Zayer 0417", "2026-11-20")], [(c["folder"], c["state"], c["machine"], c["day"]) for c in listed])
            s.post("/api/run", {"campaign": made["campaign"]}, 202)
            s.until("/api/site/state", lambda a: a.get("run", {}).get("state") == "done", "evaluated")
            self.assertEqual([made["campaign"]], [p.name for p in self.out.iterdir() if (p / "results.json").exists()])
            listed = s.until("/api/campaigns", lambda a: a["campaigns"][0]["state"] != "new", "has results")["campaigns"][0]
            results = json.loads((self.out / made["campaign"] / "results.json").read_text())
            self.assertEqual(results["status"], listed["state"])
            self.assertEqual(results["conformity"][0]["decision"], listed["verdict"])
            self.assertIn("results.json", listed["files"])
            self.assertFalse(listed["changed"])
            # What an editor changes is seen, too.
            text = (folder / "campaign.toml").read_text()
            (folder / "campaign.toml").write_text(text.replace('serial = "0417"', 'serial = "0418"'))
            changed = s.until("/api/campaigns", lambda a: a["campaigns"][0]["machine"] == "Zayer 0418", "read again")["campaigns"][0]
            self.assertTrue(changed["changed"])
            machines = s.get("/api/machines")["machines"]
            self.assertEqual([("Zayer 0418", 1)], [(m["machine"], m["campaigns"]) for m in machines])

    def test_what_the_site_knows_fills_the_form(self):
        with self.serve("--edit") as s:
            self.create(s)
            self.create(s, text_of(readings(seed=SEED + 1)).encode(), values={"campaign.date": "2026-11-21", "machine.serial": "9", "instrument.U_fixed_um": "0.3"})
            known = s.get("/api/records")
            self.assertEqual(["Zayer 9", "Zayer 0417"], [m["name"] for m in known["machines"]])
            self.assertEqual(["L 80"], [i["name"] for i in known["instruments"]])
            self.assertEqual("0.3", known["instruments"][0]["values"]["instrument.U_fixed_um"], "of the newest campaign")
            self.assertEqual(("0", "600", "12"), tuple(known["machines"][0]["values"]["machine.axes.X." + k] for k in ("from", "to", "tolerance.A")))

    def test_a_former_name_of_a_machine_is_no_machine(self):
        with self.serve("--edit") as s:
            self.create(s)
            other = self.create(s, values={"machine.serial": "O417"})
            s.until("/api/machines", lambda a: len(a["machines"]) == 2, "two machines")
            name = {m["serial"]: m["machine"] for m in s.get("/api/machines")["machines"]}
            (self.site / "site.toml").write_text(f'[laboratory]\nname = "Sample"\n[[alias]]\nname = "{name["O417"]}"\nasset = "{name["0417"]}"\nwhy = "read wrong"\n')
            s.until("/api/machines", lambda a: [m["machine"] for m in a["machines"]] == [name["0417"]], "one machine")
            self.assertTrue(other)

    def test_lists_are_searched_filtered_and_paged(self):
        r = random.Random(SEED)
        for n in range(60):
            folder = self.site / f"c{n}"
            folder.mkdir()
            (folder / "campaign.toml").write_text(f'format = 1\n[campaign]\nid = "c{n}"\ncustomer = "{r.choice(["Rossi", "Bianchi"])}"\ndate = 2026-01-{n % 28 + 1:02}\n'
                                                  f'[machine]\nmaker = "M"\nserial = "{n % 7}"\n[machine.axes.X]\nkind = "linear"\n'
                                                  '[[measurement]]\nid = "X"\nkind = "axis"\naxis = "X"\nfile = "x.csv"\n')
        (self.site / "c3/campaign.toml").write_text('id = "c3\n')
        with self.serve() as s:
            first = s.until("/api/campaigns?size=25", lambda a: a["complete"] and a["all"] == 60, "complete")
            self.assertEqual(25, len(first["campaigns"]))
            days = [c.get("day", "") for page in range(3) for c in s.get(f"/api/campaigns?size=25&page={page}")["campaigns"]]
            self.assertEqual(sorted(days, reverse=True), days)
            self.assertEqual(60, len(days))
            every = {c["folder"]: c for c in s.get("/api/campaigns?size=200")["campaigns"]}
            self.assertIn("message", every["c3"], "a broken manifest is listed with what is wrong")
            wanted = {f for f, c in every.items() if c.get("customer") == "Rossi" and c.get("machine") == "M 4"}
            self.assertTrue(wanted)
            self.assertEqual(wanted, {c["folder"] for c in s.get("/api/campaigns?size=200&search=rossi%20m%204")["campaigns"]} & {f for f, c in every.items() if c.get("machine") == "M 4"})
            self.assertEqual(["c1"], [c["folder"] for c in s.get("/api/campaigns?folder=c1")["campaigns"]])
            self.assertEqual(0, s.get("/api/campaigns?state=failed")["found"])
            self.assertEqual(60, s.get("/api/campaigns?state=new")["found"])
            self.assertEqual(s.get("/api/campaigns?page=999999999")["found"], 60)
            pages = [s.get(f"/api/machines?size=3&page={page}") for page in (0, 1, 2, 9)]
            self.assertEqual([[f"M {n}" for n in some] for some in ((0, 1, 2), (3, 4, 5), (6,), (6,))], [[m["machine"] for m in p["machines"]] for p in pages])
            self.assertEqual([(7, 7, 0), (7, 7, 1), (7, 7, 2), (7, 7, 2)], [(p["found"], p["all"], p["page"]) for p in pages])
            fitting = s.get("/api/machines?search=2026-01-28%20m")  # the newest campaigns are of four machines or fewer
            self.assertTrue(0 < fitting["found"] < 7 and all(m["day"] == "2026-01-28" for m in fitting["machines"]), fitting)
            self.assertEqual(0, s.get("/api/machines?search=nowhere")["found"])

    # ---- files ----
    def test_a_dropped_file_is_shown_as_a_run_would_read_it(self):
        rows = readings()
        sheets.xlsx(self.site.parent / "x.xlsx", {"Data": rows})
        sheets.ods(self.site.parent / "x.ods", {"Data": rows})
        files = {"x.csv": text_of(rows).encode(), "x.txt": text_of(rows, ";", ",").encode(), "x.xlsx": (self.site.parent / "x.xlsx").read_bytes(), "x.ods": (self.site.parent / "x.ods").read_bytes()}
        with self.serve() as s:
            for name, data in files.items():
                seen = self.send(s, "/api/preview", {"name": name, "columns": []}, data)
                self.assertEqual((110, 0, False), (seen["readings"], seen["missing"], seen["rotary"]), name)
                self.assertEqual([row[3] for row in rows[1:]], seen["points"]["deviation"], name)
                self.assertEqual([row[2] for row in rows[1:]], seen["points"]["position"], name)
            laser = SAMPLES.parents[1] / "plugins/readers/renishaw-rtl/cases/small/x.rtl"
            self.assertEqual("renishaw-rtl", self.send(s, "/api/preview", {"name": "x.rtl"}, laser.read_bytes())["reader"])
            turned = self.send(s, "/api/preview", {"name": "c.csv"}, b"run,direction,target_deg,deviation_arcsec\n1,+,0,1.5\n1,-,0,0.5\n")
            self.assertEqual((True, "arcsec"), (turned["rotary"], turned["points"]["deviation_unit"]))
            wrong = self.send(s, "/api/preview", {"name": "x.csv"}, b"run,direction,target_mm,deviation_um\n1,+,0,abc\n")
            self.assertEqual((2, "deviation_um"), (wrong["error"]["line"], wrong["error"]["column"]))
            self.assertNotIn("points", wrong)

    def test_columns_are_stated_once(self):
        names, more = ["Lauf", "Richtung", "Soll [mm]", "Abw = um"], ["Bemerkung"]
        rows = readings(names, more=more)
        columns = [f"{a} = {b}" for a, b in zip(names, KNOWN)] + ["Bemerkung = ignore"]
        path = self.site.parent / "x.xlsx"
        broken = [[name.replace("Soll ", "Soll\n") for name in rows[0]], *rows[1:]]  # as people break long names
        sheets.xlsx(path, {"Notes": [["Messung Halle 2"]], "Data": [["Messung Halle 2"], []] + broken})
        with self.serve("--edit") as s:
            for name, data in (("x.csv", text_of(rows, ";", ",").encode()), ("x.xlsx", path.read_bytes())):
                unknown = self.send(s, "/api/preview", {"name": name}, data)
                self.assertIn("error", unknown)
                self.assertEqual([*names, *more], unknown["rows"][0], "what a person maps is shown")
                read = self.send(s, "/api/preview", {"name": name, "columns": columns}, data)
                self.assertEqual([row[3] for row in rows[1:]], read["points"]["deviation"])
                made = self.create(s, data, name=name, columns=columns)
                manifest = tomllib.loads((self.site / made["campaign"] / "campaign.toml").read_text())
                reader = manifest["measurement"][0]["reader"]
                self.assertEqual(columns, manifest["options"][reader]["columns"])
                self.assertEqual(data, (self.site / made["campaign"] / name).read_bytes())
            self.assertEqual([columns], s.get("/api/records")["columns"], "offered for the next file")
        # Whatever reads campaigns reads these.
        self.assertEqual(0, json_of("check", self.site)["invalid"])
        # A column that is not there, or a name that is none, is an error and no guess.
        for wrong in (["Lauf = run", "Weg = target_mm"], ["Lauf = banana"], ["Lauf"], ["Lauf = run"]):
            (self.site.parent / "x.csv").write_text(text_of(rows, ";", ","))
            said = nonio("check", self.site.parent / "x.csv", *[a for c in wrong for a in ("--column", c)], expect=1)
            self.assertIn("x.csv", said.stderr)

    def test_columns_without_a_name_of_their_own_have_a_number(self):
        names = ["Lauf", "Richtung", "Wert", "Wert"]
        rows = [[*row, "" if k == 0 else "ok"] for k, row in enumerate(readings(names))]
        by_name = ["Lauf = run", "Richtung = direction", "#3 = target_mm", "#4 = deviation_um", "#5 = ignore"]
        by_number = [f"#{k + 1} = {known}" for k, known in enumerate([*KNOWN, "ignore"])]
        path = self.site.parent / "x.xlsx"
        sheets.xlsx(path, {"Data": [["Halle 2"], []] + rows})
        csv = text_of(rows, ";", ",").encode()
        with self.serve("--edit") as s:
            for name, data in (("x.csv", csv), ("x.xlsx", path.read_bytes())):
                for columns in (by_name, by_number) if name == "x.csv" else (by_name,):
                    read = self.send(s, "/api/preview", {"name": name, "columns": columns}, data)
                    self.assertEqual([row[3] for row in rows[1:]], read.get("points", read)["deviation"], f"{name} {columns}")
                made = self.create(s, data, name=name, columns=by_name)
                manifest = tomllib.loads((self.site / made["campaign"] / "campaign.toml").read_text())
                self.assertEqual(by_name, manifest["options"][manifest["measurement"][0]["reader"]]["columns"])
            # Readings never pass for names, and a number that is not there is no guess.
            for columns, data in ((by_number, csv.split(b"\n", 1)[1]), (by_name[:2] + ["#3 = target_mm", "#9 = deviation_um"], csv), (by_name[:3] + ["#3 = deviation_um"], csv), (["#0 = run"], csv), (["#x = run"], csv)):
                self.assertIn("error", self.send(s, "/api/preview", {"name": "x.csv", "columns": columns}, data), columns)

    def test_the_axis_of_the_form_is_tried_first(self):
        text = text_of(readings()).encode()
        with self.serve() as s:
            self.assertEqual("Z", self.send(s, "/api/preview", {"name": "x.csv", "axis": "Z"}, text)["axis"])
            turned = self.send(s, "/api/preview", {"name": "c.csv", "axis": "Z"}, b"run,direction,target_deg,deviation_arcsec\n1,+,0,1.5\n1,-,0,0.5\n")
            self.assertTrue(turned["rotary"], "the file is right where the form is not")
            for axis in ("../X", "--json", "", 3, "X Y"):
                self.assertIn("points", self.send(s, "/api/preview", {"name": "x.csv", "axis": axis}, text), axis)

    # ---- what may not be done ----
    def test_nothing_is_overwritten_and_no_request_waits_for_another(self):
        with self.serve("--edit") as s, concurrent.futures.ThreadPoolExecutor(8) as pool:
            made = list(pool.map(lambda n: self.create(s, text_of(readings(seed=SEED + n)).encode())["campaign"], range(8)))
            self.assertEqual(8, len(set(made)))
            self.assertEqual(sorted(made), self.folders())
            for n, folder in enumerate(made):
                self.assertEqual(text_of(readings(seed=SEED + n)), (self.site / folder / "x.csv").read_text())

    def test_a_refused_campaign_leaves_nothing(self):
        good = text_of(readings()).encode()
        with self.serve("--edit") as s:
            for expect, more in ((422, {"values": {"campaign.date": "20.11.2026"}}), (422, {"values": {"instrument.U_fixed_um": "1\n[run]"}}), (422, {"values": {"instrument.U_fixed_um": "nan"}}),
                                 (422, {"values": {"machine.maker": "a\nb"}}), (422, {"values": {"machine.maker": "x" * 501}}), (422, {"axis": "../X"}), (422, {"axis": ""}), (422, {"columns": "Lauf"}),
                                 (422, {"columns": ["a\nb"]}), (422, {"data": b""}), (422, {"data": b"no readings"}), (422, {"data": b"run,direction,target_mm,deviation_um\n1,+,0,abc\n"}),
                                 (422, {"values": {"axis.from": "600", "axis.to": "0"}}), (422, {"values": {"axis.from": "1", "axis.to": ""}}),
                                 (422, {"values": {"campaign.date": ""}})):
                self.create(s, **{"data": good, "expect": expect, **more})
            for name in ("../x.csv", "a/b.csv", "..", ".x.csv", "", "campaign.toml", "run.json", "a\\b.csv", "x.csv\n", "con?.csv", "x" * 200 + ".csv", "x.csv.", "/etc/passwd",
                         "site.toml", "Campaign.TOML", "model-history.jsonl", "users.toml", "audit.jsonl", "con.csv", "LPT1.csv"):
                self.create(s, good, 422, name=name)
                self.send(s, "/api/preview", {"name": name}, good, 422)
            self.send(s, "/api/campaigns", [], good, 400)
            self.assertEqual([], self.folders())
            self.assertEqual({"site"}, {p.name for p in self.site.parent.iterdir()} - {"out"})
            self.assertEqual(["audit.jsonl", "site.toml"], sorted(p.name for p in self.site.iterdir()))
            recorded = [json.loads(line) for line in (self.site / "audit.jsonl").read_text().splitlines()]
            self.assertEqual({"begins", "failed"}, {r["state"] for r in recorded})
            self.assertTrue(all("account" not in r for r in recorded), "this site has no users")
                # Nested so deeply that a copy would end the server.
            deep = b'{"name":"x.csv","v":' + b"[" * 200000 + b"]" * 200000 + b"}"
            for path in ("/api/preview", "/api/campaigns"):
                self.assertEqual(400, s.request("POST", path, deep + b"\nabc", {"Content-Type": "application/octet-stream"})[0])
            for path in ("/api/release", "/api/run", "/api/ack"):
                self.assertEqual(400, s.request("POST", path, deep, {"Content-Type": "application/json"})[0])
            self.assertIn(s.request("GET", "/c/bad%FF/api/state")[0], (400, 404))
            # Texts stay texts.
            hostile = '"]\n[run]\noutputs = []'.replace("\n", " ") + " \\ <script>"
            made = self.create(s, good, values={"campaign.customer": hostile, "machine.maker": "--help", "campaign.customer_address": "--set=x=y"})
            manifest = tomllib.loads((self.site / made["campaign"] / "campaign.toml").read_text())
            self.assertEqual((hostile, "--help", "--set=x=y"), (manifest["campaign"]["customer"], manifest["machine"]["maker"], manifest["campaign"]["customer_address"]))
            self.assertNotIn("run", manifest)
            # As people write numbers.
            made = self.create(s, good, values={"campaign.date": "2026-11-25", "instrument.U_fixed_um": "+,5", "instrument.U_per_m_um": "007."})
            manifest = tomllib.loads((self.site / made["campaign"] / "campaign.toml").read_text())
            self.assertEqual((0.5, 7), (manifest["instrument"]["U_fixed_um"], manifest["instrument"]["U_per_m_um"]))
            # What has the name of its folder already, and is none, is left alone.
            (self.site / (made["campaign"].replace("25", "26"))).write_text("a file")
            again = self.create(s, good, values={"campaign.date": "2026-11-26"})
            self.assertTrue(again["campaign"].endswith("-2"), again)

    def test_who_may_not_gets_nothing(self):
        body = json.dumps({"name": "x.csv", "axis": "X", "values": VALUES}).encode() + b"\n" + text_of(readings()).encode()
        file = {"Content-Type": "application/octet-stream"}
        with self.serve("--edit") as s:
            for path in ("/api/campaigns", "/api/machines", "/api/records"):
                self.assertEqual(403, s.request("GET", path, token=False)[0])
                self.assertEqual(403, s.request("GET", path, headers={"Origin": "https://evil.example"})[0])
            for path in ("/api/campaigns", "/api/preview"):
                self.assertEqual(403, s.request("POST", path, body, file, token=False)[0])
                self.assertEqual(403, s.request("POST", path, body, {**file, "Origin": "https://evil.example"})[0])
                self.assertEqual(403, s.request("POST", path, body, {**file, "Sec-Fetch-Site": "cross-site"})[0])
                self.assertEqual(421, s.request("POST", path, body, {**file, "Host": "evil.example"})[0])
                self.assertEqual(415, s.request("POST", path, body, {"Content-Type": "text/plain"})[0])
                answer = s.raw(f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{s.port}\r\nX-Nonio-Token: {s.token}\r\nContent-Type: application/octet-stream\r\nContent-Length: {(32 << 20) + 1}\r\n\r\n".encode())
                self.assertEqual(413, int(answer.split()[1]))
        with self.serve() as s:
            self.assertEqual(403, s.request("POST", "/api/campaigns", body, file)[0], "without --edit nothing is written")
            self.assertEqual(200, s.request("POST", "/api/preview", body, file)[0])
        self.assertEqual([], self.folders())


if __name__ == "__main__":
    unittest.main()
