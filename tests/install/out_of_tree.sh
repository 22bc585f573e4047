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
mkdir -p "$work/site/a"
cat > "$work/site/a/campaign.toml" <<'TOML'
format = 1
[campaign]
id = "a"
[machine.axes.X]
kind = "linear"
[[measurement]]
id = "X"
kind = "axis"
axis = "X"
file = "x.csv"
[run]
analyses = ["largest-deviation", "iso230-2"]
outputs = ["json"]
TOML
printf 'run,direction,target_mm,deviation_um\n1,+,0,1.5\n1,+,100,-7.25\n' > "$work/site/a/x.csv"
"$work/prefix/bin/nonio" plugins --quiet --plugin-path "$work/plugin"
"$work/prefix/bin/nonio" run "$work/site" --out "$work/out" --plugin-path "$work/plugin"
grep -q '"value": 7.25' "$work/out/a/results.json"
