#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""certificate.py BENCH_CERTIFICATE: CPU time of a certificate, and of ReportLab making the same pages in the same session.

ReportLab is given what Nonio drew: every text, line, area and marker of its pages with its place, read before the
clock starts. So it has no layout to do, no words to find and no numbers to print. Fonts are loaded once and embedded as
ReportLab does it, for each document. To both the same signature is added, that of Nonio (OpenSSL, without a process
of its own). Needs python3-reportlab and qpdf."""
import io
import os
import re
import subprocess
import sys
import tempfile
import time

from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen import canvas

FONTS = "/usr/share/fonts/truetype/liberation2/"
ROUNDS = 5  # the least of all: a virtual machine is at times twice as slow
TOKEN = re.compile(rb"\((?:\\.|[^\\()])*\)|\[[^\]]*\]|[^\s()\[\]]+", re.DOTALL)
ESCAPED = re.compile(rb"\\(.)", re.DOTALL)


def to_unicode(cmap):
    return {int(a, 16): chr(int(b, 16)) for a, b in re.findall(rb"<(\w{4})> <(\w{4})>\n", cmap)}


def pages_of(path):
    """For each page the operators with their operands; texts as characters."""
    plain = subprocess.run(["qpdf", "--stream-data=uncompress", path, "-"], check=True, capture_output=True).stdout
    streams = [m.group(1) for m in re.finditer(rb"stream\n(.*?)\nendstream", plain, re.DOTALL)]
    maps = [to_unicode(s) for s in streams if b"begincmap" in s]
    pages = []
    for stream in streams:
        if b"BT " not in stream:
            continue
        page, operands, font = [], [], 0
        for token in TOKEN.findall(stream):
            if token.startswith(b"("):
                raw = ESCAPED.sub(lambda m: b"\r" if m.group(1) == b"r" else m.group(1), token[1:-1])
                operands.append("".join(maps[font][raw[i] << 8 | raw[i + 1]] for i in range(0, len(raw), 2)))
            elif token.startswith(b"/"):
                operands.append(token.decode())
                font = int(token[2:]) - 1 if token.startswith(b"/F") else font
            elif token.startswith(b"["):
                operands.append([float(v) for v in token[1:-1].split()])
            elif re.fullmatch(rb"[-\d.]+", token):
                operands.append(float(token))
            else:
                page.append((token.decode(), operands))
                operands = []
        pages.append(page)
    return pages


def draw(c, page):
    """One page through ReportLab's own calls."""
    path, place, upwards, clip = c.beginPath(), (0, 0), False, False
    paint = {"S": (1, 0), "f": (0, 1), "B": (1, 1), "b": (1, 1)}
    for op, v in page:
        if op == "m":
            path.moveTo(*v)
        elif op == "l":
            path.lineTo(*v)
        elif op == "c":
            path.curveTo(*v)
        elif op == "re":
            path.rect(*v)
        elif op == "h":
            path.close()
        elif op in paint:
            if op == "b":
                path.close()
            c.drawPath(path, *paint[op])
            path = c.beginPath()
        elif op == "W":
            clip = True
        elif op == "n":
            if clip:
                c.clipPath(path, 0, 0)
            path, clip = c.beginPath(), False
        elif op == "q":
            c.saveState()
        elif op == "Q":
            c.restoreState()
        elif op == "cm":
            c.transform(*v)
        elif op == "rg":
            c.setFillColorRGB(*v)
        elif op == "RG":
            c.setStrokeColorRGB(*v)
        elif op == "w":
            c.setLineWidth(*v)
        elif op == "d":
            c.setDash(*v)
        elif op == "J":
            c.setLineCap(int(v[0]))
        elif op == "gs":
            c.setFillAlpha(0.22)
        elif op in ("Td", "Tm"):
            place, upwards = v[-2:], op == "Tm"
        elif op == "Tf":
            c.setFont({"/F1": "Sans", "/F2": "Bold"}[v[0]], v[1])
        elif op == "Tj":
            if upwards:
                c.saveState()
                c.translate(*place)
                c.rotate(90)
                c.drawString(0, 0, v[0])
                c.restoreState()
            else:
                c.drawString(*place, v[0])


def document(pages):
    out = io.BytesIO()
    c = canvas.Canvas(out, pagesize=(595.28, 841.89), pageCompression=1, invariant=1)
    for page in pages:
        draw(c, page)
        c.showPage()
    c.save()
    return out.getvalue()


def main():
    bench = sys.argv[1]
    os.sched_setaffinity(0, {0})
    pdfmetrics.registerFont(TTFont("Sans", FONTS + "LiberationSans-Regular.ttf"))
    pdfmetrics.registerFont(TTFont("Bold", FONTS + "LiberationSans-Bold.ttf"))
    best, theirs = {}, float("inf")
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(ROUNDS):
            shown = subprocess.run([bench, folder, "5"], check=True, capture_output=True, text=True).stdout
            for name, value in re.findall(r"^(.+?) +([\d.]+) ms$", shown, re.MULTILINE):
                best[name] = min(float(value), best.get(name, float("inf")))
            pages = pages_of(f"{folder}/certificate.pdf")
            for _ in range(10):
                start = time.process_time()
                peer = document(pages)
                theirs = min(1e3 * (time.process_time() - start), theirs)
    both, unsigned = best["PDF and DCC"], best["PDF and DCC"] - best["DCC"]
    flate, plots = best["Flate of the pages"], both - best["the same without plots"]
    print(shown.splitlines()[0])
    for name, ms in (("PDF, unsigned", unsigned), ("of it plots, with their Flate", plots),
                     ("of it Flate of all pages", flate), ("fonts, once in a process", best["first PDF and DCC"] - both),
                     ("PDF in Chinese, unsigned", best["the same in Chinese"] - best["DCC"]), ("DCC", best["DCC"]),
                     ("room for a signature", best["room for a signature"]), ("CMS, P-256", best["CMS, P-256"]),
                     ("CMS, RSA-3072", best["CMS, RSA-3072"]), ("ReportLab, unsigned", theirs)):
        print(f"{name:32}{ms:8.2f} ms")
    print(f"ReportLab: pages {len(pages)}, bytes {len(peer)}")
    for name in ("unsigned", "P-256", "RSA-3072"):
        added = 0.0 if name == "unsigned" else best["room for a signature"] + best["CMS, " + name]
        print(f"{name}: Nonio {unsigned + added:.2f} ms, ReportLab {theirs + added:.2f} ms, "
              f"{(theirs + added) / (unsigned + added):.1f} times")


if __name__ == "__main__":
    main()
