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

# The control of docs/howto-plugin.md, word for word.
howto=$plugin/../../../docs/howto-plugin.md
block() { # LANGUAGE: the first such block of the section about controls
  sed -n '/^## A control of your own/,/^## An effect/p' "$howto" | sed -n "/^\`\`\`$1\$/,/^\`\`\`\$/p" | sed '/^```/d'
}
mkdir -p "$work/control" "$work/controls/b"
block cmake > "$work/control/CMakeLists.txt"
block cpp > "$work/control/my_control.cpp"
"$cmake" -S "$work/control" -B "$work/control/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$work/prefix" > "$work/configure-control.log"
"$cmake" --build "$work/control/build"
"$work/prefix/bin/nonio" controllers my-control --plugin-path "$work/control/build" | grep -q 'Manual, page 12'
sed -e 's/"a"/"b"/' -e 's/^\[machine\.axes/[machine]\ncontrol = "my-control"\n&/' -e '/^\[run\]/,$d' \
  "$work/site/a/campaign.toml" > "$work/controls/b/campaign.toml"
printf 'run,direction,target_mm,deviation_um\n1,+,0,0\n1,-,0,3\n1,+,100,-7.2\n1,-,100,-4.2\n' > "$work/controls/b/x.csv"
"$work/prefix/bin/nonio" run "$work/controls" --out "$work/out2" --plugin-path "$work/control/build"
grep -q '^2 100.0 0.0057 0' "$work/out2/b/my-control-X.txt"  # -(mean of both directions), in mm
