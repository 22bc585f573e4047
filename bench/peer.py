# SPDX-License-Identifier: Apache-2.0
"""peer.py SITE OUT: the same job as a careful Python programmer would write it with NumPy and
ReportLab: ISO 230-2 and VDI/DGQ 3441 with U, decisions and findings, results.json, run.json, readings.json,
CSVs, a PDF with embedded fonts and four plots, and the tables of four controls, each read back from its
text. One process; fonts are loaded once."""
import csv
import hashlib
import io
import json
import os
import pathlib
import sys
import tomllib

import numpy as np
from reportlab.lib import colors
from reportlab.lib.pagesizes import A4
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen import canvas
from reportlab.platypus import Table, TableStyle

import peer_checks as checks

FONTS = "/usr/share/fonts/truetype/liberation2/"
pdfmetrics.registerFont(TTFont("Sans", FONTS + "LiberationSans-Regular.ttf"))
pdfmetrics.registerFont(TTFont("Bold", FONTS + "LiberationSans-Bold.ttf"))


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    targets = sorted({float(r["target_mm"]) for r in rows})
    place = {t: i for i, t in enumerate(targets)}
    runs = max(int(r["run"]) for r in rows)
    up, down = (np.full((len(targets), runs), np.nan) for _ in "+-")
    for r in rows:
        side = up if r["direction"] == "+" else down
        side[place[float(r["target_mm"])], int(r["run"]) - 1] = float(r["deviation_um"])
    return rows, np.array(targets), up, down


def evaluate(up, down, k=2.0):
    mu, md = np.nanmean(up, axis=1), np.nanmean(down, axis=1)
    su, sd = np.nanstd(up, axis=1, ddof=1), np.nanstd(down, axis=1, ddof=1)
    b, mean = mu - md, (mu + md) / 2
    ru, rd = 2 * k * su, 2 * k * sd
    r = np.maximum.reduce([k * su + k * sd + abs(b), ru, rd])
    both = np.concatenate([mu, md])
    high, low = np.concatenate([mu + k * su, md + k * sd]), np.concatenate([mu - k * su, md - k * sd])
    iso = {"A": high.max() - low.min(), "A+": (mu + k * su).max() - (mu - k * su).min(),
           "A-": (md + k * sd).max() - (md - k * sd).min(), "E": both.max() - both.min(),
           "E+": np.ptp(mu), "E-": np.ptp(md), "M": np.ptp(mean), "R": r.max(), "R+": ru.max(),
           "R-": rd.max(), "B": abs(b).max(), "B_mean": b.mean()}
    s, u = (su + sd) / 2, abs(b)
    ps = 6 * s
    vdi = {"P": (mean + (u + ps) / 2).max() - (mean - (u + ps) / 2).min(), "Pa": np.ptp(mean),
           "Ps_max": ps.max(), "Ps_mean": ps.mean(), "U_max": u.max(), "U_mean": u.mean()}
    points = {"mean+": mu, "mean-": md, "mean": mean, "B": b, "s+": su, "s-": sd, "R+": ru, "R-": rd, "R": r,
              "S": s, "U": u, "Ps": ps}
    return iso, vdi, points


def plot(c, x0, y0, w, h, x, curves, title):
    every = np.concatenate([y for y, *_ in curves])
    lo, hi = float(every.min()), float(every.max())
    span, reach = hi - lo or 1.0, float(x[-1] - x[0]) or 1.0
    px = x0 + (x - x[0]) / reach * w
    c.setFont("Bold", 8)
    c.drawString(x0, y0 + h + 6, title)
    c.setFont("Sans", 6)
    c.setStrokeColor(colors.lightgrey)
    for i in range(6):
        y = y0 + h * i / 5
        c.line(x0, y, x0 + w, y)
        c.drawRightString(x0 - 3, y - 2, f"{lo + span * i / 5:.1f}")
        c.drawCentredString(x0 + w * i / 5, y0 - 9, f"{x[0] + reach * i / 5:.0f}")
    for y, color, width, marks in curves:
        py = y0 + (y - lo) / span * h
        c.setStrokeColor(color)
        c.setLineWidth(width)
        path = c.beginPath()
        path.moveTo(px[0], py[0])
        for a, b in zip(px[1:], py[1:]):
            path.lineTo(a, b)
        c.drawPath(path)
        if marks:
            for a, b in zip(px, py):
                c.circle(a, b, 1.0, stroke=1, fill=0)


STYLE = TableStyle([("FONT", (0, 0), (-1, -1), "Sans", 7), ("FONT", (0, 0), (-1, 0), "Bold", 7),
                    ("GRID", (0, 0), (-1, -1), 0.25, colors.grey), ("TOPPADDING", (0, 0), (-1, -1), 1),
                    ("BOTTOMPADDING", (0, 0), (-1, -1), 1)])


def place(c, data, x, top, widths=None):
    """The bottom of a table whose top left corner is there."""
    table = Table(data, colWidths=widths, style=STYLE)
    _, height = table.wrapOn(c, 500, 700)
    table.drawOn(c, x, top - height)
    return top - height


def lines(c, x, y, texts):
    c.setFont("Sans", 7)
    for text in texts:
        c.drawString(x, y, text)
        y -= 9
    return y


def report(meta, x, up, down, job):
    buffer = io.BytesIO()
    c = canvas.Canvas(buffer, pagesize=A4, pageCompression=1, invariant=1)
    points = job["points"]
    c.setFont("Bold", 16)
    c.drawString(50, 800, "Calibration report")
    top = 790
    for at, section in ((50, "campaign"), (220, "machine"), (390, "instrument")):
        data = [[section, ""]] + [[k, str(v)] for k, v in meta[section].items() if not isinstance(v, dict)]
        top = min(top, place(c, data, at, 790))
    attention = [f["title"] for f in job["findings"] if f["severity"] == "attention"]
    attention += [f"{d['name']}: {d['decision']}" for d in job["conformity"] if d["decision"] != "conforms"]
    top = lines(c, 50, top - 12, attention)
    head = ["Symbol", "Value", "U", "Tolerance", "Decision"]
    for name, at in (("iso230-2", 50), ("vdi-dgq-3441", 310)):
        data = [[name, "um", "um", "um", ""], head]
        data += [[k, f"{v['value']:.2f}", f"{v['U']:.2f}", str(v.get("tolerance", "")), v.get("decision", "")]
                 for k, v in job["analyses"][name].items()]
        bottom = place(c, data, at, top - 6)
        top = top if name == "iso230-2" else bottom
    lines(c, 310, top - 12, job["comparison"])
    blue, orange, grey = colors.HexColor("#0060a0"), colors.HexColor("#c05000"), colors.lightgrey
    runs = [(y, grey, 0.4, True) for y in np.concatenate([up.T, down.T])]
    mu, md = points["mean+"], points["mean-"]
    plot(c, 60, 250, 480, 120, x, runs + [(mu, blue, 1.2, False), (md, orange, 1.2, False)], "All runs")
    band = [(m + s * 2 * d, col, 0.5, False) for m, d, col in ((mu, points["s+"], blue), (md, points["s-"], orange))
            for s in (-1, 1)]
    plot(c, 60, 60, 480, 150, x, band + [(mu, blue, 1.2, True), (md, orange, 1.2, True)], "ISO 230-2")
    lines(c, 60, 30, [f"{meta['campaign']['id']} - page 1 of 2"])
    c.showPage()
    half = (abs(points["B"]) + points["Ps"]) / 2
    m = points["mean"]
    plot(c, 60, 670, 480, 110, x, [(m, blue, 1.2, True), (m + half, grey, .8, False), (m - half, grey, .8, False)], "VDI")
    plot(c, 60, 525, 480, 110, x, [(points["B"], orange, 1.0, True)], "Reversal")
    y = 500
    for f in job["findings"]:
        y = lines(c, 60, y, [f["title"], f["words"], "-> " + f["advice"]])
    data = [["target mm", *points]] + [[f"{a:.3f}", *(f"{v:.3f}" for v in row)]
                                       for a, row in zip(x, zip(*points.values()))]
    y = place(c, data, 40, y - 4)
    data = [["Control", "", "before", "predicted"]]
    data += [[control, k, f"{v['before']:.3f}", f"{v['predicted']:.3f}"]
             for control, values in job["tables"].items() for k, v in values.items()]
    place(c, data, 60, y - 8)
    lines(c, 60, 30, [f"{meta['campaign']['id']} - page 2 of 2"])
    c.showPage()
    c.save()
    return buffer.getvalue()


def write(folder, files):
    """As Nonio does: whole or not at all, all written before the first is flushed."""
    folder.mkdir(parents=True, exist_ok=True)
    open_files = []
    for name, data in files.items():
        file = open(folder / ("." + name), "wb")
        file.write(data)
        file.flush()
        open_files.append(file)
    for file in open_files:
        os.fsync(file.fileno())
        file.close()
    handle = os.open(folder, os.O_RDONLY)
    for name in files:
        if name == "run.json":  # the others have their names for good before
            os.fsync(handle)
        os.replace(folder / ("." + name), folder / name)
    os.fsync(handle)
    os.close(handle)


def csv_text(rows):
    text = io.StringIO()
    csv.writer(text).writerows(rows)
    return text.getvalue()


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def campaign(path, out):
    manifest = (path / "campaign.toml").read_bytes()
    meta = tomllib.loads(manifest.decode())
    measurement = meta["measurement"][0]
    rows, x, up, down = read(path / measurement["file"])
    iso, vdi, points = evaluate(up, down)
    axis = meta["machine"]["axes"][measurement["axis"]]
    analyses, conformity = checks.with_uncertainty(iso, vdi, meta, axis, x, up)
    tables = checks.tables(meta, x, points)
    predicted = {control: checks.predict(control, tables, x, points) for control in checks.READ_BACK}
    job = {"points": points, "analyses": analyses, "conformity": conformity, "tables": predicted,
           "findings": checks.findings(x, up, down, points, iso, meta, axis),
           "comparison": [f"R+ = {iso['R+']:.2f}, R- = {iso['R-']:.2f}; VDI averages: Ps max = {vdi['Ps_max']:.2f} um",
                          f"mean reversal B = {iso['B_mean']:.2f} um; VDI gives sizes only: {vdi['U_mean']:.2f} um"]}
    files = {name: text.encode() for name, text in tables.items()}
    files["report.pdf"] = report(meta, x, up, down, job)
    files["readings.json"] = json.dumps({k: [r[k] for r in rows] for k in rows[0]}).encode()
    iso_columns = [k for k in points if k not in ("S", "U", "Ps")]
    for name, columns in (("iso230-2", iso_columns), ("vdi-dgq-3441", ["mean", "S", "U", "Ps"])):
        table = [["target_mm", *columns]] + [[f"{v:.12g}" for v in row] for row in zip(x, *(points[k] for k in columns))]
        files[f"points-X-{name}.csv"] = csv_text(table).encode()
    files["values.csv"] = csv_text([["plugin", "name", "value", "U", "tolerance", "decision"]] + [
        [plugin, k, f"{v['value']:.12g}", f"{v['U']:.12g}", v.get("tolerance", ""), v.get("decision", "")]
        for plugin, values in analyses.items() for k, v in values.items()]).encode()
    digests = {n: sha256(d) for n, d in files.items()}
    files["results.json"] = json.dumps({
        "campaign": {**meta["campaign"], "date": str(meta["campaign"]["date"])}, "analyses": analyses,
        "points": [{k: float(f"{v:.12g}") for k, v in zip(points, row)} for row in zip(*points.values())],
        "findings": job["findings"], "conformity": conformity, "tables": predicted, "outputs": digests},
        indent=1).encode()
    files["run.json"] = json.dumps({
        "folder": str(path), "inputs": {"campaign.toml": sha256(manifest),
                                        measurement["file"]: sha256((path / measurement["file"]).read_bytes())},
        "files": {n: [len(d), digests.get(n) or sha256(d)] for n, d in files.items()},
        "findings": [f["id"] for f in job["findings"]]}, indent=1).encode()
    write(out / meta["campaign"]["id"], files)


if __name__ == "__main__":
    for found in sorted(pathlib.Path(sys.argv[1]).rglob("campaign.toml")):
        campaign(found.parent, pathlib.Path(sys.argv[2]))
