# SPDX-License-Identifier: Apache-2.0
"""Bad input gets an error that names its place; one bad campaign never stops the others."""
import os
import unittest

from nightly import NightTest, manifest, readings


class Input(NightTest):
    def errors(self, campaign_id):
        return self.results(campaign_id)["errors"]

    def test_two_campaigns_with_one_id(self):
        self.campaign("first", campaign_id="same")
        self.campaign("second", campaign_id="same")
        self.campaign("other")
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("failed"), ["same", "same"])
        message = self.errors("same")[0]["message"]
        self.assertIn("first", message)
        self.assertIn("second", message)
        self.assertEqual(self.ids("done"), ["other"])

    def test_targets_that_differ_in_a_last_digit_are_one(self):
        """What a file computed: two targets of one reading each would leave A, B and R without a value."""
        run = '[run]\nanalyses = ["iso230-2"]\noutputs = []\n'
        for name, shift in (("clean", 0.0), ("digit", 1e-9), ("micron", 1e-3)):
            self.campaign(name, run=run, seed="clean")
            path = self.site / name / "x.csv"
            rows = path.read_text("utf-8").splitlines()
            target = rows[0].split(",").index("target_mm")
            for i in range(1, len(rows), 2):  # every other reading
                cells = rows[i].split(",")
                if cells[0].isdigit():
                    cells[target] = "%.12f" % (float(cells[target]) + shift)
                    rows[i] = ",".join(cells)
            path.write_text("\n".join(rows) + "\n", encoding="utf-8")
        self.run_nonio(expect=0)
        results = {name: self.results(name) for name in ("clean", "digit", "micron")}
        values = {name: {k: v["value"] for k, v in r["analyses"][0]["values"].items()} for name, r in results.items()}
        self.assertIn("A", values["clean"])
        self.assertEqual(values["digit"], values["clean"])
        points = {name: len(r["analyses"][0]["points"]) for name, r in results.items()}
        self.assertEqual(points["digit"], points["clean"])
        self.assertTrue([n for n in results["digit"]["notes"] if "within 0.0001 mm (0.02 arcsec)" in n])
        self.assertNotIn("notes", results["clean"])
        # A micrometre is another target, and stays one.
        self.assertGreater(points["micron"], points["clean"])

    def test_what_a_spreadsheet_calls_missing_is_missing(self):
        self.campaign("good", run='[run]\nanalyses = ["iso230-2"]\noutputs = []\n')
        path = self.site / "good" / "x.csv"
        rows = path.read_text("utf-8").splitlines()
        deviation = next(i for i, c in enumerate(rows[0].split(",")) if c.startswith("deviation"))
        taken = len(rows) - 1
        for row, word in ((3, "#N/A"), (5, "#N/D"), (7, "#NV"), (9, "#n/a")):
            cells = rows[row].split(",")
            cells[deviation] = word
            rows[row] = ",".join(cells)
        # In a file whose first column is the reading, it is no comment either.
        swapped = [",".join([r.split(",")[deviation]] + [c for i, c in enumerate(r.split(",")) if i != deviation]) for r in rows]
        for text in (rows, swapped):
            path.write_text("\n".join(text) + "\n", encoding="utf-8")
            self.run_nonio("--force", expect=0)
            findings = {f["id"]: f for f in self.results("good")["analyses"][0]["findings"]}
            evidence = findings["readings.missing"]["evidence"]
            self.assertEqual((evidence["missing"], evidence["taken"]), (4, taken - 4))

    def test_broken_manifest_names_the_line(self):
        self.campaign("bad", text=manifest("bad").replace("kind = \"linear\"", "kind = linear"))
        self.campaign("good")
        self.run_nonio(expect=1)
        self.assertEqual(self.errors("bad")[0]["file"], "campaign.toml")
        self.assertEqual(self.errors("bad")[0]["line"], 8)
        self.assertEqual(self.ids("done"), ["good"])

    def test_files_outside_the_campaign(self):
        (self.root / "secret.csv").write_text("run,direction,target_mm,deviation_um\n1,+,0,1\n")
        for name, file in (("up", "../../secret.csv"), ("root", "/etc/hostname"), ("link", "link.csv")):
            folder = self.campaign(name, text=manifest(name).replace("x.csv", file))
            if name == "link":
                os.symlink(self.root / "secret.csv", folder / "link.csv")
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("failed"), ["link", "root", "up"])

    def test_unknown_plugin_and_option_name_the_nearest(self):
        self.campaign("analysis", run='[run]\nanalyses = ["iso230-3"]\n')
        self.campaign("option", extra="[options.iso230-2]\nediton = 2006\n")
        self.campaign("owner", extra="[options.iso-230]\nedition = 2006\n")
        self.run_nonio(expect=1)
        self.assertIn('nearest: "iso230-2"', self.errors("analysis")[0]["message"])
        self.assertIn('nearest: "edition"', self.errors("option")[0]["message"])
        self.assertIn('there is no plugin "', self.errors("owner")[0]["message"])

    def place(self, campaign_id):
        error = self.errors(campaign_id)[0]
        return error["file"], error.get("line"), error["message"]

    def test_every_mistake_of_a_manifest_names_its_line(self):
        self.campaign("output", run='[run]\noutputs = ["jsno"]\n')
        self.campaign("reader", text=manifest("reader").replace('file = "x.csv"', 'file = "x.csv"\nreader = "cvs"'))
        self.campaign("file", text=manifest("file").replace("x.csv", "y.csv"))
        self.campaign("axes", run='[run]\noutputs = ["fanuc"]\n[options.fanuc]\naxes = ["Q number=1"]\n')
        self.campaign("customer", text=manifest("customer").replace(
            "date = 2026-11-03", 'customer = "😀"'))
        self.campaign("newline", text=manifest("newline").replace(
            "date = 2026-11-03", 'customer = "a\\nb"'))
        self.run_nonio(expect=1)
        for name, line, words in (("output", 17, 'nearest: "json"'), ("reader", 16, "measurement.X.reader"),
                                  ("file", 15, "measurement.X.file"), ("axes", 19, "no axis Q"),
                                  ("customer", 4, "campaign.customer"), ("newline", 4, "a line break")):
            file, found, message = self.place(name)
            self.assertEqual((file, found), ("campaign.toml", line), name + ": " + message)
            self.assertIn(words, message)

    def test_mistakes_of_the_site_are_reported_once_with_their_line(self):
        self.campaign("a")
        for text, line, words in (('[run]\nanalyses = ["iso230-3"]\n', 2, 'nearest: "iso230-2"'),
                                  ('[run]\noutputs = [\n"jsn"]\n', 2, 'nearest: "json"'),
                                  ("[options.absent]\nx = 1\n", 2, "there is no plugin"),
                                  ("[options.iso230-2]\nedition = 2007\n", 2, "expected one of")):
            (self.site / "site.toml").write_text(text)
            done = self.run_nonio(expect=2)
            self.assertIn(f"site.toml:{line}: ", done.stderr)
            self.assertIn(words, done.stderr)
            self.assertFalse(self.out.exists())

    def test_a_table_that_was_not_requested_does_not_fail_the_campaign(self):
        small = '[options.siemens-840d]\naxes = ["X number=1"]\nmax_points = 3\n'
        self.campaign("any", extra=small)
        self.campaign("asked", run='[run]\noutputs = ["siemens-840d"]\n', extra=small)
        self.campaign("control", text=manifest("control").replace(
            'model = "M"', 'control = "siemens-840d"') + small)
        self.run_nonio(expect=1)
        self.assertEqual(sorted(self.ids("failed")), ["asked", "control"])
        self.assertIn("the control takes 3", self.errors("asked")[0]["message"])
        results = self.results("any")
        self.assertEqual((results["status"], results["errors"]), ("attention", []))
        table = next(t for t in results["tables"] if t["plugin"] == "siemens-840d")
        self.assertEqual([f["id"] for f in table["findings"]], ["table.not-written"])
        self.assertIn("the control takes 3", table["findings"][0]["evidence"]["why"])
        self.assertIn("report.pdf", [o["file"] for o in results["outputs"]])

    def test_drift_reaches_the_tables_without_analyses(self):
        folder = self.campaign("a", run='[run]\nanalyses = []\n')
        rows = (folder / "x.csv").read_text().splitlines()
        for i, row in enumerate(rows[1:], 1):
            run, direction, target, deviation = row.split(",")
            rows[i] = f"{run},{direction},{target},{float(deviation) + 6 * int(run):.3f}"
        (folder / "x.csv").write_text("\n".join(rows) + "\n")
        self.run_nonio(expect=0)
        results = self.results("a")
        self.assertEqual((results["status"], results["analyses"]), ("attention", []))
        for table in results["tables"]:
            found = {f["id"]: f["advice"] for f in table["findings"]}
            self.assertIn("Do not compensate yet", found["table.refused-drift"], table["plugin"])

    def test_files_that_are_no_text_say_so(self):
        cases = {"empty": (b"", "empty file"), "blank": (b"\n \r\n", "empty file"),
                 "utf16": (readings(1).encode("utf-16-le"), "UTF-16"),
                 "utf16-cut": (readings(1).encode("utf-16")[:-1], "half a character at its end")}
        for name, (data, _) in cases.items():
            (self.campaign(name) / "x.csv").write_bytes(data)
        self.run_nonio(expect=1)
        for name, (_, words) in cases.items():
            self.assertIn(words, self.errors(name)[0]["message"])

    def test_what_excel_saves_as_unicode_text_is_read(self):
        text = readings(1).replace(",", "\t")
        for name, data in {"plain": readings(1).encode(), "le": text.encode("utf-16"), "be": b"\xfe\xff" + text.encode("utf-16-be"),
                           "sep": ("sep=\t\r\n" + text).encode()}.items():
            (self.campaign(name) / "x.csv").write_bytes(data)
        self.run_nonio(expect=0)
        values = [[a["values"] for a in self.results(name)["analyses"]]
                  for name in ("plain", "le", "be", "sep")]
        self.assertTrue(values[0])
        self.assertEqual(values[1:], [values[0]] * 3)

    def test_files_of_the_e1733a_are_refused_by_their_names(self):
        suffixes = ("Lin", "Ang", "str", "Squ", "Par", "rot", "Way", "Fla", "Dia", "LTB", "ATB", "STB", "LDA")
        for s in suffixes:
            folder = self.campaign("k-" + s.lower())
            (folder / "campaign.toml").write_text((folder / "campaign.toml").read_text().replace("x.csv", "x." + s))
            (folder / ("x." + s)).write_bytes(b"E1733A\x00\x01\x02")
        self.run_nonio(expect=1)
        for s in suffixes:
            error = self.results("k-" + s.lower())["errors"][0]
            self.assertEqual(error["file"], "x." + s)
            self.assertIn("Keysight's laser program E1733A", error["message"])
            self.assertIn("column map", error["message"])

    def test_what_no_analysis_evaluates_is_said(self):
        table = '[[measurement]]\nid = "T"\nkind = "observations"\nfile = "t.csv"\n'
        (self.campaign("a", extra=table) / "t.csv").write_text(
            "X_mm,nx,ny,nz,deviation_um\n0,0,1,0,1\n10,0,1,0,2\n", encoding="utf-8")
        self.run_nonio(expect=0)
        results = self.results("a")
        self.assertIn("observations", results["notes"][0])
        self.assertEqual({a["measurement"] for a in results["analyses"]}, {"X"})

    def test_without_uncertainty_nothing_conforms(self):
        tolerance = "[machine.axes.X.tolerance_um]\nA = 1000.0\nQ = 1.0\n"
        self.campaign("a", extra=tolerance)
        self.run_nonio(expect=0)
        results = self.results("a")
        iso = next(a for a in results["analyses"] if a["plugin"] == "iso230-2")
        self.assertEqual(iso["values"]["A"]["decision"], "cannot be decided")
        reasons = {c["name"]: c["reason"] for c in results["conformity"]}
        self.assertEqual(reasons, {"A": "no-uncertainty", "Q": "no-value"})

    def test_broken_site_file_stops_before_anything_is_written(self):
        self.campaign("a")
        (self.site / "site.toml").write_text("[limits]\nsecond = 5\n")
        done = self.run_nonio(expect=2)
        self.assertIn('site.toml:2: unknown key limits.second (nearest: "seconds")', done.stderr)
        self.assertFalse(self.out.exists())

    def test_results_are_never_written_among_the_readings(self):
        folder = self.campaign("a", run='[run]\noutputs = ["csv"]\n')
        (folder / "values.csv").write_text("mine")
        for out in (self.site, folder, folder / "below"):
            done = self.run_nonio(out=out, expect=2)
            self.assertIn("expected another folder", done.stderr)
        self.run_nonio(out=self.site.parent, expect=0)  # the site's parent folder is accepted
        self.assertEqual((folder / "values.csv").read_text(), "mine")

    def test_a_pipe_does_not_stop_the_run(self):
        for name in ("x.csv", "campaign.toml"):
            folder = self.campaign("bad-" + name[0])
            (folder / name).unlink()
            os.mkfifo(folder / name)
        self.campaign("good")
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("done"), ["good"])
        self.assertIn("not a file", self.errors("bad-x")[0]["message"])
        self.run_nonio(expect=1)

    def test_a_folder_without_an_id_gives_way(self):
        self.campaign("A B", text="nonsense")
        self.campaign("one", campaign_id="a-b")
        self.run_nonio(expect=1)
        self.assertEqual(self.ids("done"), ["a-b"])
        self.assertEqual(self.ids("failed"), ["a-b.2"])

    def test_unknown_control_names_the_nearest(self):
        self.campaign("a", text=manifest("a").replace('model = "M"', 'control = "siemens-840"'))
        self.run_nonio(expect=1)
        self.assertIn('nearest: "siemens-840d"', self.errors("a")[0]["message"])

    def test_a_linked_campaign_is_not_passed_over_in_silence(self):
        self.campaign("a")
        (self.root / "elsewhere").mkdir()
        (self.root / "elsewhere" / "campaign.toml").write_text(manifest("linked"))
        os.symlink(self.root / "elsewhere", self.site / "link")
        self.assertIn("the campaign link is a link", self.run_nonio(expect=0).stderr)

    def test_quiet_still_names_a_campaign_that_stays_failed(self):
        self.campaign("a", text="nonsense")
        self.run_nonio("--quiet", expect=1)
        self.assertIn("failed    a", self.run_nonio("--quiet", expect=1).stderr)

    def test_empty_output_name(self):
        import subprocess
        from nightly import NONIO
        done = subprocess.run([NONIO, "run", str(self.site), "--out", ""], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        done = subprocess.run([NONIO, "run", "--plugin-path", str(self.root), str(self.site), "--out",
                               str(self.out)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_empty_site(self):
        self.run_nonio(expect=0)
        self.assertEqual(self.summary()["counts"]["campaigns"], 0)


if __name__ == "__main__":
    unittest.main()
