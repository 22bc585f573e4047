#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail
cmake=$1 build=$2 plugin=$3 compiler=$4 libdir=$5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$cmake" --install "$build" --prefix "$work/prefix" > "$work/install.log"
"$cmake" -S "$plugin" -B "$work/plugin" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$work/prefix" > "$work/configure.log"
"$cmake" --build "$work/plugin"
# Docs, the papers of plugins, and a sample that runs.
papers=$work/prefix/share/doc/nonio
for file in howto-plugin.md howto-instruments.md pictures/long-tables.svg plugins/readers/long-table/README.md examples/README.md examples/plugins/CMakeLists.txt; do
  [ -s "$papers/$file" ] || { echo "not installed: $file"; exit 1; }
done
[ -z "$(find "$papers" -empty -o -name '*.p12' -o -name '*.key')" ] || { echo "installed, and should not be: $(find "$papers" -empty)"; exit 1; }
mkdir "$work/tried"
cp -r "$papers/examples/site/02-constant-reversal" "$work/tried/"
"$work/prefix/bin/nonio" run "$work/tried" --out "$work/tried-out" --quiet
[ -s "$work/tried-out/02-constant-reversal/results.json" ]
mkdir -p "$work/site/a"
cat > "$work/site/a/campaign.toml" <<'TOML'
format = 1
[campaign]
id = "a"
[machine.axes.X]
kind = "linear"
active_table = "none"
active_backlash_mm = "none"
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
[run]
analyses = ["largest-deviation", "iso230-2"]
outputs = ["json", "elsewhere"]
[options.elsewhere.axes.X]
number = 1
TOML
printf 'run,direction,target_mm,deviation_um\n1,+,0,1.5\n1,+,100,-7.25\n' > "$work/site/a/x.csv"
"$work/prefix/bin/nonio" plugins --quiet --plugin-path "$work/plugin"
"$work/prefix/bin/nonio" run "$work/site" --out "$work/out" --plugin-path "$work/plugin"
grep -q '"value": 7.25' "$work/out/a/results.json"
grep -q '7.3 um' "$work/out/a/results.json"
grep -q '^2 100.*0\.00875' "$work/out/a/elsewhere-X.txt" || { cat "$work/out/a/elsewhere-X.txt"; exit 1; }
