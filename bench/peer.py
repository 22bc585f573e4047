# SPDX-License-Identifier: Apache-2.0
"""peer.py SITE OUT: the same job as a careful Python programmer would write it with NumPy and
ReportLab: ISO 230-2 and VDI/DGQ 3441, results.json, readings.json, CSVs, a two-page PDF with embedded
fonts and four plots, and the tables of four controls. One process; fonts are loaded once."""
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
    points = {"mean+": mu, "mean-": md, "mean": mean, "B": b, "s+": su, "s-": sd, "R": r, "S": s, "Ps": ps}
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


def report(meta, x, up, down, iso, vdi, points):
    buffer = io.BytesIO()
    c = canvas.Canvas(buffer, pagesize=A4, pageCompression=1, invariant=1)
    c.setFont("Bold", 16)
    c.drawString(50, 790, "Calibration report")
    c.setFont("Sans", 9)
    for i, line in enumerate((meta["campaign"]["id"], meta["campaign"]["customer"], meta["machine"]["model"])):
        c.drawString(50, 770 - 12 * i, line)
    rows = [["ISO 230-2", "um"]] + [[k, f"{v:.3f}"] for k, v in iso.items()]
    other = [["VDI/DGQ 3441", "um"]] + [[k, f"{v:.3f}"] for k, v in vdi.items()]
    style = TableStyle([("FONT", (0, 0), (-1, -1), "Sans", 8), ("FONT", (0, 0), (-1, 0), "Bold", 8),
                        ("GRID", (0, 0), (-1, -1), 0.25, colors.grey)])
    for data, at in ((rows, 50), (other, 300)):
        table = Table(data, colWidths=[120, 60], style=style)
        _, height = table.wrapOn(c, 300, 500)
        table.drawOn(c, at, 730 - height)
    blue, orange, grey = colors.HexColor("#0060a0"), colors.HexColor("#c05000"), colors.lightgrey
    runs = [(y, grey, 0.4, True) for y in np.concatenate([up.T, down.T])]
    mu, md = points["mean+"], points["mean-"]
    plot(c, 60, 270, 480, 150, x, runs + [(mu, blue, 1.2, False), (md, orange, 1.2, False)], "All runs")
    band = [(m + s * 2 * d, col, 0.5, False) for m, d, col in ((mu, points["s+"], blue), (md, points["s-"], orange))
            for s in (-1, 1)]
    plot(c, 60, 60, 480, 150, x, band + [(mu, blue, 1.2, True), (md, orange, 1.2, True)], "ISO 230-2")
    c.showPage()
    half = (abs(points["B"]) + points["Ps"]) / 2
    m = points["mean"]
    plot(c, 60, 640, 480, 120, x, [(m, blue, 1.2, True), (m + half, grey, .8, False), (m - half, grey, .8, False)], "VDI")
    plot(c, 60, 480, 480, 120, x, [(points["B"], orange, 1.0, True)], "Reversal")
    head = ["target mm", "mean+", "mean-", "B", "s+", "s-", "R"]
    data = [head] + [[f"{x[i]:.3f}"] + [f"{points[n][i]:.3f}" for n in head[1:]] for i in range(len(x))]
    table = Table(data, style=style)
    _, height = table.wrapOn(c, 500, 450)
    table.drawOn(c, 60, 450 - height)
    c.showPage()
    c.save()
    return buffer.getvalue()


def tables(x, points):
    mean, b = points["mean"] / 1e3, points["B"].mean() / 1e3
    grid = np.arange(x[0], x[-1] + 1e-9, 50.0)
    even = np.interp(grid, x, mean)
    text = "%_N_AX1_EEC_INI\nCHANDATA(1)\n" + "".join(
        f"$AA_ENC_COMP[0,{i},AX1]={v:.6f}\n" for i, v in enumerate(even))
    text += f"$AA_ENC_COMP_STEP[0,AX1]=50\n$AA_ENC_COMP_MIN[0,AX1]={grid[0]}\n$AA_ENC_COMP_MAX[0,AX1]={grid[-1]}\nM17\n"
    com = "BEGIN AXIS_X.COM MM\n" + "".join(f"{i:<5}{p:+.4f} {v:+.4f}\n" for i, (p, v) in enumerate(zip(x, mean)))
    pulses = np.rint(-even * 1000).astype(int)
    fanuc = "%\n" + "".join(f"N{10040 + i}P{d}\n" for i, d in enumerate(np.diff(pulses, prepend=pulses[0]))) + "%\n"
    up, down = points["mean+"] / 1e3, points["mean-"] / 1e3
    comp = "".join(f"{t:.6f} {t + u:.6f} {t + d:.6f}\n" for t, u, d in zip(x, up, down))
    return {"X-EEC.ini": text, "X.COM": com + "[END]\n", "config.cma": "BEGIN CONFIG.CMA\n* X AXIS_X\n[END]\n",
            "fanuc.txt": fanuc + f"N1851P{round(-b * 1000)}\n", "X.comp": comp}


def write(folder, files):
    """As Nonio does: whole or not at all."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        temporary = folder / ("." + name)
        with open(temporary, "wb") as file:
            file.write(data if isinstance(data, bytes) else data.encode())
            file.flush()
            os.fsync(file.fileno())
    for name in files:
        os.replace(folder / ("." + name), folder / name)
    handle = os.open(folder, os.O_RDONLY)
    os.fsync(handle)
    os.close(handle)


def campaign(path, out):
    meta = tomllib.loads((path / "campaign.toml").read_text())
    rows, x, up, down = read(path / meta["measurement"][0]["file"])
    iso, vdi, points = evaluate(up, down)
    files = {"report.pdf": report(meta, x, up, down, iso, vdi, points), **tables(x, points)}
    files["readings.json"] = json.dumps(rows)
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["target_mm", *points])
    writer.writerows(zip(x, *points.values()))
    files["points.csv"] = text.getvalue()
    files["values.csv"] = "".join(f"{k},{v:.12g}\n" for k, v in {**iso, **vdi}.items())
    files["results.json"] = json.dumps({
        "campaign": meta["campaign"]["id"], "iso230-2": iso, "vdi-dgq-3441": vdi,
        "points": [dict(zip(points, map(float, row))) for row in zip(*points.values())],
        "outputs": {n: hashlib.sha256(d if isinstance(d, bytes) else d.encode()).hexdigest()
                    for n, d in files.items()}}, indent=1)
    write(out / meta["campaign"]["id"], files)


if __name__ == "__main__":
    for manifest in sorted(pathlib.Path(sys.argv[1]).rglob("campaign.toml")):
        campaign(manifest.parent, pathlib.Path(sys.argv[2]))
