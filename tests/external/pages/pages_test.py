#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Pages in several scripts and certificates in all languages, rendered by pdftoppm, against the pictures in
references/ (grey of 16 levels).

    pages_test.py WRITE_SCRIPTS WRITE_CERTIFICATES [--update]

--update stores what is rendered now: look at every picture before it is committed."""
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

REFERENCES = pathlib.Path(__file__).resolve().parent / "references"
TILE = 8
# Mean difference of a tile, of 255. The same page has 0; the least of the lost parts below has 5.
TOLERANCE = 2.0
LEVELS = bytes(17 * round(grey / 17) for grey in range(256))
PAGES = {"zh": 100, "el": 100, "ru": 100} | {
    f"certificate-{languages}": 60 for languages in ("de", "en", "es", "it", "zh", "it-en")} | {
    "six-de": 60, "six-de-en": 60}
# The same pages with a part of a letter lost: they must not pass for what they are not.
LOST = {"zh-lost-parts": "zh", "el-lost-tonos": "el", "ru-lost-accent": "ru"}


def rendered(pdf, dpi):
    """Width and rows of the first page."""
    pgm = subprocess.run(["pdftoppm", "-r", str(dpi), "-gray", "-f", "1", "-l", "1", pdf],
                         check=True, capture_output=True).stdout
    kind, width, height, _ = pgm[:40].split(maxsplit=4)[:4]
    assert kind == b"P5"
    width, height = int(width), int(height)
    pixels = pgm[-width * height:].translate(LEVELS)
    return width, [pixels[y * width:(y + 1) * width] for y in range(height)]


def write_png(path, width, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packed = b"".join(b"\0" + bytes((row + b"\xff")[x] // 17 << 4 | (row + b"\xff")[x + 1] // 17
                                    for x in range(0, width, 2)) for row in rows)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, len(rows), 4, 0, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(packed, 9)) + chunk(b"IEND", b""))


def read_png(path):
    """As write_png writes them."""
    data, at, found = path.read_bytes(), 8, {}
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        found[kind] = data[at + 8:at + 8 + size]
        at += size + 12
    width, height = struct.unpack(">2I", found[b"IHDR"][:8])
    stride, packed = 1 + (width + 1) // 2, zlib.decompress(found[b"IDAT"])
    return width, [bytes(17 * v for byte in packed[y * stride + 1:(y + 1) * stride]
                         for v in (byte >> 4, byte & 15))[:width] for y in range(height)]


def difference(one, other):
    """Of the tile where they differ most; infinite if the sizes differ."""
    (width, rows), (other_width, other_rows) = one, other
    if (width, len(rows)) != (other_width, len(other_rows)):
        return float("inf")
    sums = {}
    for y, (a, b) in enumerate(zip(rows, other_rows)):
        if a != b:
            for x in range(width):
                if a[x] != b[x]:
                    key = y // TILE, x // TILE
                    sums[key] = sums.get(key, 0) + abs(a[x] - b[x])
    return max(sums.values(), default=0) / TILE ** 2


def main():
    if shutil.which("pdftoppm") is None:
        print("pdftoppm is not there")
        return 77
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        for program in sys.argv[1:3]:
            subprocess.run([program, folder], check=True)
        pages = {name: rendered(f"{folder}/{name}.pdf", dpi) for name, dpi in PAGES.items()}
        if "--update" in sys.argv:
            for name, page in pages.items():
                write_png(REFERENCES / f"{name}.png", *page)
        for name, page in pages.items():
            found = difference(page, read_png(REFERENCES / f"{name}.png"))
            print(f"{name}: {found:.1f}")
            if not found <= TOLERANCE:
                wrong.append(f"{name} looks different: {found:.1f}")
                write_png(pathlib.Path(f"{name}-now.png"), *page)
        for name, whole in LOST.items():
            found = difference(rendered(f"{folder}/{name}.pdf", PAGES[whole]), read_png(REFERENCES / f"{whole}.png"))
            print(f"{name}: {found:.1f}")
            if found <= TOLERANCE:
                wrong.append(f"{name} passes for {whole}: {found:.1f}")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
