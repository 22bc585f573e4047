#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes certificates as a laboratory issues them and renders every page for inspection by a person: gantry with diagonals,
rotary axes from ball centres, step diagonals, straightness, one axis before and after an adjustment, six axes with long
names; in five languages and in two at once, approved, with the key of samples/certificates.

    bench/certificate_pages.py NONIO FOLDER [--dpi 70] [--only WORD ...] [--accredited] [--drafts | --amended]

--accredited: with a smallest accredited uncertainty; --drafts: as they wait for an approval; --amended: each as one that
replaces an earlier one.
FOLDER/out/CAMPAIGN has the files, FOLDER/pages/CAMPAIGN-NN.png the pages, FOLDER/sheets contact sheets of eight pages. It
reports which first page has no frame for the signature and which certificate is missing, and then ends with status 1.
Requires pdftoppm."""
import argparse
import json
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[1]
SITE = ROOT / "samples" / "site"
LANGUAGES = [["de"], ["en"], ["es"], ["it"], ["zh"], ["it", "en"], ["de", "en"], ["es", "zh"]]
LONG = ("Vereinigte Werkzeugmaschinenfabriken Oberlausitz-Niederschlesien Aktiengesellschaft & Co. "
        "Kommanditgesellschaft")
STATED = ('feed_mm_per_min = 2000.0\ndwell_s = 3.0\nover_travel_mm = 2.0\ntool_offset = { Z = -120.0 }\n'
          'workpiece_offset = { X = 0.0, Y = 0.0, Z = 250.0 }\ncompensation = "off"\n')


def without_run(text):
    return re.sub(r"(?m)^\[run\]\n(?:.+\n?)*", "", text)


def complete(text, languages, analyses, outputs='"json", "certificate", "pdf-report"'):
    """The manifest of a sample with the additional keys that a certificate needs."""
    text = text.replace("[machine]\n", '[machine]\ndescription = "Machine tool"\ncondition = "In use"\n', 1)
    text = text.replace("[campaign]\n", '[campaign]\ncustomer_address = "Via degli Esempi 1, 10100 Torino"\n', 1)
    text = without_run(text)
    quoted = ", ".join(f'"{language}"' for language in languages)
    run = f'[run]\nanalyses = [{", ".join(analyses)}]\noutputs = [{outputs}]\n'
    if languages[0] == "it":  # reports are English or Italian
        run += '[options.pdf-report]\nlanguage = "it"\n'
    return (text.rstrip("\n") + "\n\n" + run + "\n[certificate]\nlanguages = [" + quoted + "]\n"
            'conditions = "Machine hall, no direct sun; 20 °C ± 1 K."\n')


def with_limits(text):
    """Limits for every axis, the way parts are measured, what an uncertainty needs, and a sensor."""
    if "[environment]" not in text:
        stated = (SITE / "09-tolerances" / "campaign.toml").read_text("utf-8")
        environment = re.search(r"\[environment\]\n(?:.+\n)+", stated)[0]
        text = text.replace("[[measurement]]", environment + "\n[[measurement]]", 1)
    text = re.sub(r"(\[machine\.axes\.[XYZ]\]\nkind = \"linear\"\n)", r"\1tolerance_um = { A = 30.0, R = 12.0, B = 6.0 }\n", text)
    text = re.sub(r"(kind = \"axis\"\n)", r"\1" + STATED.replace("\\", r"\\"), text)
    return text.replace("[environment]\n", '[[sensor]]\nmeasures = "material"\nmaker = "Sample Sensors"\nmodel = "Pt100"\n'
                        'serial = "T-17"\ncalibrated = 2026-01-12\ncertificate = "SO-2026-0009"\nissuer = "LAT 000"\n\n'
                        '[environment]\nwarm_up = "30 min of moves over the whole travel"\n'
                        'sensors = "on the table and on the column"\n', 1)


def long_names(text):
    for key, value in (("customer", LONG), ("maker", LONG), ("serial", "0417-2019-000000000000001234567890-B"),
                       ("model", "Fahrständer-Bohr- und Fräswerk mit zwei Drehtischen FBW 12000 / 4-6"),
                       ("customer_address", "Straße der Zusammenarbeit zwischen Hochschule und Handwerk 117, 02826 Görlitz"),
                       ("site", "Görlitz-Hagenwerder, Halle 12, Feld C bis F"), ("operator", "Dr.-Ing. A. Musterfrau-Beispielmann")):
        text = re.sub(rf'(?m)^{key} = ".*"$', f'{key} = "{value}"', text, count=1)
    return text


def six_axes():
    """Six axes of a large machine, X before and after an adjustment."""
    axes, measurements, files = "", "", {}
    linear = (SITE / "09-tolerances" / "x.csv").read_text("utf-8")
    for axis in "XYZW":
        axes += (f'[machine.axes.{axis}]\nkind = "linear"\nexpansion_um_per_m_K = 11.5\n'
                 'tolerance_um = { A = 14.0, B = 5.0, "R+" = 6.0 }\n\n')
    for axis in "BC":
        axes += f'[machine.axes.{axis}]\nkind = "rotary"\ntolerance_arcsec = {{ A = 30.0, B = 10.0 }}\n\n'
    for name, axis, adjustment in (("X as found", "X", "before"), ("X as left", "X", "after"), ("Y", "Y", ""), ("Z", "Z", ""),
                                   ("W", "W", ""), ("B", "B", ""), ("C", "C", "")):
        file = name.replace(" ", "-").lower() + ".csv"
        measurements += f'[[measurement]]\nid = "{name}"\nkind = "axis"\naxis = "{axis}"\nfile = "{file}"\n'
        measurements += f'adjustment = "{adjustment}"\n\n' if adjustment else "\n"
        if axis in "BC":
            files[file] = rotary_readings()
        else:
            files[file] = linear
    head = (SITE / "09-tolerances" / "campaign.toml").read_text("utf-8")
    instrument = re.search(r"\[instrument\]\n(?:.+\n)+", head)[0].rstrip() + "\nU_arcsec = 0.2\n\n"
    environment = re.search(r"\[environment\]\n(?:.+\n)+", head)[0].rstrip() + "\ndrift_arcsec = 0.2\n\n"
    start = head[head.index("format = 1"):head.index("[machine.axes")]
    return start + axes + instrument + environment + measurements, files


def rotary_readings():
    import math
    rows = ["run,direction,target_deg,deviation_arcsec,material_c"]
    for run in range(1, 6):
        for direction in "+-":
            for i in range(13) if direction == "+" else range(12, -1, -1):
                angle = 30 * i
                e = 6 * math.sin(math.radians(angle)) + (1.0 if direction == "+" else -1.0) + ((run * 7 + i * 5) % 11 - 5) * 0.12
                rows.append(f"{run},{direction},{angle},{e:.3f},20.{run}")
    return "\n".join(rows) + "\n"


def campaigns():
    """Name, languages, text, files."""
    kinds = {"gantry": ("13-gantry-diagonals", ['"iso230-2"', '"diagonal-straightness"']),
             "rotary": ("14-rotary-table", ['"rotary-kinematics"']),
             "steps": ("15-step-diagonal", ['"iso230-2"', '"step-diagonal"']),
             "straight": ("12-straightness", ['"iso230-2"', '"vdi-dgq-3441"']),
             "missing": ("11-missing-and-misread", ['"iso230-2"', '"vdi-dgq-3441"']),
             "long": ("06-long-axis", ['"iso230-2"', '"vdi-dgq-3441"']),
             "drift": ("04-drift-parallel", ['"iso230-2"', '"vdi-dgq-3441"']),
             "one": ("10-one-direction", ['"iso230-2"', '"vdi-dgq-3441"'])}
    for languages in LANGUAGES:
        end = "-".join(languages)
        for kind, (sample, analyses) in kinds.items():
            text = (SITE / sample / "campaign.toml").read_text("utf-8").replace(f'id = "{sample}"', f'id = "{kind}-{end}"', 1)
            text = without_run(text)
            tail = re.search(r"(?ms)^\[options\..*", text)
            options = tail[0] if tail else ""
            text = with_limits(complete(text[:tail.start()] if tail else text, languages, analyses)) + "\n" + options
            if languages == ["de", "en"]:
                text = long_names(text)
            yield f"{kind}-{end}", text, {p.name: p.read_bytes() for p in (SITE / sample).glob("*.csv")}
        text, files = six_axes()
        text = re.sub(r'(?m)^id = ".*"$', f'id = "six-{end}"', text, count=1)
        text = long_names(complete(text, languages, ['"iso230-2"', '"vdi-dgq-3441"']))
        yield f"six-{end}", text, {name: body.encode() for name, body in files.items()}


def run(*args, check=True):
    done = subprocess.run([str(a) for a in args], capture_output=True, text=True)
    if check and done.returncode:
        raise SystemExit(f"{args}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def page_rows(ppm):
    kind, width, height, _ = ppm[:40].split(maxsplit=4)[:4]
    assert kind == b"P6"
    width, height = int(width), int(height)
    pixels = ppm[-3 * width * height:]
    return width, [pixels[3 * y * width:3 * (y + 1) * width] for y in range(height)]


def write_png(path, width, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, len(rows), 8, 2, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 6)) + chunk(b"IEND", b""))


def sheet_of(pages, columns=4):
    width, height = max(w for w, _ in pages), max(len(rows) for _, rows in pages)
    out = []
    for at in range(0, len(pages), columns):
        line = pages[at:at + columns]
        for y in range(height):
            out.append(b"".join((rows[y] if y < len(rows) else b"\xff" * 3 * w).ljust(3 * width, b"\xff") + b"\x60\x60\x60" * 2
                                for w, rows in line).ljust(columns * 3 * (width + 2), b"\x60"))
        out += [b"\x60" * columns * 3 * (width + 2)] * 2
    return columns * (width + 2), out


def render(folder, dpi):
    """Names of the certificates whose first page has no frame for the signature."""
    without = []
    (folder / "pages").mkdir(exist_ok=True)
    (folder / "sheets").mkdir(exist_ok=True)
    for pdf in sorted((folder / "out").glob("*/certificate*.pdf")) + sorted((folder / "out").glob("*/report*.pdf")):
        name = pdf.parent.name + ("-report" if pdf.name.startswith("report") else "-draft" if "draft" in pdf.name else "")
        work = folder / "pages" / name
        run("pdftoppm", "-r", dpi, pdf, work)
        pages = []
        for ppm in sorted((folder / "pages").glob(f"{name}-*.ppm"), key=lambda p: int(p.stem.rsplit("-", 1)[1])):
            page = page_rows(ppm.read_bytes())
            ppm.unlink()
            write_png(ppm.with_suffix(".png"), *page)
            pages.append(page)
        for at in range(0, len(pages), 8):
            write_png(folder / "sheets" / f"{name}-{at // 8 + 1}.png", *sheet_of(pages[at:at + 8]))
        first = re.search(rb"/Type\s*/Page\b.*?endobj", pdf.read_bytes(), re.S)
        if pdf.name == "certificate.pdf" and (first is None or b"/NonioSignature" not in first[0]):
            print(f"{name}: no frame for the signature on the first page")
            without.append(name)
    return without


def release(nonio, site):
    for draft in json.loads(run(nonio, "certificate", "approve", site, "--list", "--json").stdout)["drafts"]:
        reasons = [part for f in draft["findings"] if f["severity"] == "attention"
                   for part in ("--reason", f"{f['id']}=as found")]
        done = run(nonio, "certificate", "approve", site / draft["folder"], "--by", "B. Sample", *reasons, check=False)
        if done.returncode:
            print(draft["campaign"], done.stdout, done.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nonio")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--dpi", default="70")
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--accredited", action="store_true")
    parser.add_argument("--drafts", action="store_true")
    parser.add_argument("--amended", action="store_true")
    wanted = parser.parse_args()
    site, out = wanted.folder / "site", wanted.folder / "out"
    shutil.rmtree(wanted.folder, ignore_errors=True)
    shutil.copytree(ROOT / "samples" / "certificates", site, ignore=shutil.ignore_patterns("keys", "*.sqlite", "adjusted"))
    run("bash", site / "make-key.sh")
    toml = (site / "site.toml").read_text("utf-8")
    toml = re.sub(r"(?m)^languages = .*\n", "", toml)
    if wanted.accredited:
        toml = toml.replace("[laboratory]\n", '[laboratory]\naccreditation = "LAT 123"\n', 1)
        toml += "\n[laboratory.cmc]\nfixed_um = 0.5\nper_m_um = 1.0\narcsec = 0.3\n"
    (site / "site.toml").write_text(toml, "utf-8")
    names = []
    for name, text, files in campaigns():
        if wanted.only and not any(word in name for word in wanted.only):
            continue
        (site / name).mkdir()
        (site / name / "campaign.toml").write_text(text, "utf-8")
        for file, body in files.items():
            (site / name / file).write_bytes(body)
        names.append(name)
    print(run(wanted.nonio, "run", site, "--out", out, check=False).stderr[-2000:])
    print((out / "summary.txt").read_text())
    if not wanted.drafts:
        release(wanted.nonio, site)
    if wanted.amended:
        for name in names:
            manifest = site / name / "campaign.toml"
            text = re.sub(r'(?m)^serial = "S-', 'serial = "T-', manifest.read_text("utf-8"), count=1)
            text = text.replace("[certificate]\n", '[certificate]\namendment = "The serial number was misread."\n', 1)
            manifest.write_text(text.replace('condition = "In use"', 'condition = "In use, guideways clean"'), "utf-8")
        run(wanted.nonio, "run", site, "--out", out, check=False)
        release(wanted.nonio, site)
    missing = []
    for name in names:
        if not (out / name / ("certificate-draft.pdf" if wanted.drafts else "certificate.pdf")).exists():
            missing.append(name)
            results = out / name / "results.json"
            for o in json.loads(results.read_text()).get("outputs", []) if results.exists() else []:
                for f in o.get("findings", []):
                    print("   ", f["id"], json.dumps(f.get("evidence"), ensure_ascii=False)[:400])
    without = render(wanted.folder, wanted.dpi)
    if not names:
        print("no kind has one of the words", *wanted.only)
    if missing:
        print("no certificate:", *missing)
    return 1 if missing or without or not names else 0


if __name__ == "__main__":
    sys.exit(main())
