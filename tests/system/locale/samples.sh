#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# samples.sh PROGRAM SITE PLUGIN-FOLDER LOCALE-FOLDER TAKER
set -euo pipefail
program=$1 site=$2 plugins=$3 locales=$4 taker=$5
if ! command -v localedef > /dev/null || [ ! -f /usr/share/i18n/locales/de_DE ]; then
  echo "skipped: no localedef or no source of de_DE (Debian package locales)"
  exit 77
fi
mkdir -p "$locales"
[ -d "$locales/de_DE.UTF-8" ] || localedef -i de_DE -f UTF-8 "$locales/de_DE.UTF-8"
export LOCPATH=$locales
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

night() {  # LOCALE FOLDER
  local status=0
  LC_ALL=$1 LD_PRELOAD=$taker ASAN_OPTIONS=verify_asan_link_order=0 "$program" run "$site" --out "$work/$2" --plugin-path "$plugins" > "$work/$2.log" 2>&1 || status=$?
  # One sample is broken on purpose: status 1.
  [ "$status" -eq 1 ] || { cat "$work/$2.log"; echo "status $status under $1, expected 1"; exit 1; }
}
# The number that the plugin wrote into every campaign of a folder, and how many campaigns there are.
numbers() { find "$work/$1" -name decimal-point.txt -exec cat {} + | sort | uniq -c | xargs; }

night C plain
night de_DE.UTF-8 comma
count=$(find "$work/plain" -name decimal-point.txt | wc -l)
[ "$count" -gt 0 ] && [ "$(numbers plain)" = "$count 1.5" ] && [ "$(numbers comma)" = "$count 1,5" ] || {
  echo "the locale did not take hold: expected '$count 1.5' and '$count 1,5'," \
    "found '$(numbers plain)' and '$(numbers comma)'"
  exit 1
}
# The results hold the digest of each file, hence of this one too, and run.json that of the results:
# one is put for the other.
digest() { printf '%s\n' "$1" | sha256sum | cut -d ' ' -f 1; }
digest_of() { sha256sum "$1" | cut -d ' ' -f 1; }
for folder in "$work"/comma/*/; do
  [ -f "$folder/results.json" ] || continue  # the pages of the machines
  before=$(digest_of "$folder/results.json")
  sed -i "s/$(digest 1,5)/$(digest 1.5)/" "$folder"/*.json
  sed -i "s/$before/$(digest_of "$folder/results.json")/" "$folder/run.json"
done
find "$work/plain" "$work/comma" -name decimal-point.txt -delete
diff -r "$work/plain" "$work/comma"
echo "the same bytes in $(find "$work/comma" -type f | wc -l) files"
