#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the canonical compositions (NFC) of Latin, Greek and Cyrillic letters as C++ initialisers, sorted:
{first, second, composed}; second is 0 where one character stands for another. Unicode never changes them."""
import unicodedata

found = []
for code in range(0xA0, 0x2200):
    parts = unicodedata.decomposition(chr(code)).split()
    if not parts or parts[0].startswith("<"):
        continue
    composed = unicodedata.normalize("NFC", chr(code))
    if len(composed) > 1 or ord(composed) >= 0x2000:
        continue
    first, second = int(parts[0], 16), int(parts[1], 16) if len(parts) > 1 else 0
    if composed != chr(code):
        first, second = code, 0
    elif not unicodedata.name(chr(code)).startswith(("LATIN", "GREEK", "CYRILLIC")):
        continue
    found.append((first, second, ord(composed)))
for first, second, composed in sorted(found):
    print(f"{{0x{first:04X}, 0x{second:04X}, 0x{composed:04X}}},")
