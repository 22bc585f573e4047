#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a bare install: the sh blocks of docs/howto-plugin.md, word for word, in an empty folder.
set -euo pipefail
cmake=$1 build=$2 howto=$3 compiler=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$cmake" --install "$build" --prefix "$work/prefix" > "$work/install.log"
export PREFIX=$work/prefix PATH="$work/prefix/bin:$(dirname "$cmake"):$PATH" CXX=$compiler CMAKE_GENERATOR=Ninja
unset NONIO_PLUGIN_PATH
mkdir "$work/empty"
cd "$work/empty"
chapter=
while IFS= read -r line; do
  case $line in
    '## '*) chapter=${line#'## '} ;;
    '```sh') commands= ;;
    '```') if [ -n "${commands+x}" ]; then
             began=$(date +%s.%N)
             bash -euo pipefail -c "$commands" > "$work/said.log" 2>&1 || { cat "$work/said.log"; echo "in: $chapter"; exit 1; }
             echo "$chapter: $(grep -c . <<< "$commands") commands, $(awk -v a="$began" -v b="$(date +%s.%N)" 'BEGIN { printf "%.1f", b - a }') s"
             unset commands
           fi ;;
    *) if [ -n "${commands+x}" ]; then commands+=$line$'\n'; fi ;;
  esac
done < "$howto"
grep -q '^1 0.0' tables/first/my-table-X.txt  # its first table

# Nothing is written over what is there, and a wrong kind is answered with the right one.
if nonio plugin new output my-page 2> "$work/refused"; then echo "my-page was written over"; exit 1; fi
grep -q 'my-page exists' "$work/refused"
if nonio plugin new outptu another 2> "$work/refused"; then echo "a kind outptu"; exit 1; fi
grep -q '"output"' "$work/refused"
