// SPDX-License-Identifier: Apache-2.0
// Part programs of a measurement for SINUMERIK.
#include "nonio/sdk/plugin.h"

#include "programs.h"

namespace nonio::program_siemens {
namespace {

using programs::Program;

/// An axis name of several characters needs "=".
std::string word(const std::string& axis, const std::string& value) {
  return axis + (axis.size() > 1 ? "=" : "") + value;
}

std::string format(const Program& p, const Settings&) {
  std::string out;
  for (const std::string& line : p.about) out += "; " + line + "\n";
  // G500: no settable offset; D0: no tool offset; G60: exact stop.
  out += "G710 G90 G94 G40 G500 D0\nG60\nMSG(\"" + p.path.name + ": DRY RUN FIRST\")\n";
  // SUPA: no frames and no external, set or handwheel offsets in this block.
  const bool probe = p.path.moves.back().stop;
  for (const math::MeasuringMove& move : p.path.moves) {
    out += probe ? "G1 SUPA" : "G1";
    for (std::size_t a = 0; a < p.path.axes.size(); ++a)
      out += " " + word(p.path.axes[a], programs::position(p.path, a, move.to[a]));
    out += " F" + programs::number(p.feed) + "\n";
    // F of a G4 block is in seconds and does not change the feed.
    if (move.dwell > 0.0) out += "G4 F" + programs::number(move.dwell) + "\n";
    if (move.stop) out += "M0\n";
  }
  return out + "MSG()\nM30\n";
}

Expected<OutputResult> write(const OutputInput& in) {
  return programs::written(in, {"program-siemens", ".mpf", format, false, true});
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"program-siemens", "1.0.0", "Part programs of the measurement for SINUMERIK.",
                 programs::options({}), true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::program_siemens
