// SPDX-License-Identifier: Apache-2.0
// Part programs of a measurement in ISO 6983 G-code.
#include "nonio/sdk/plugin.h"

#include "programs.h"

namespace nonio::program_gcode {
namespace {

using programs::Program;

std::string dwell(double seconds, const std::string& word) {
  if (word == "X") return "G4 X" + programs::number(seconds);
  if (word == "P-ms") return "G4 P" + programs::number(seconds * 1e3);
  return "G4 P" + programs::number(seconds);
}

std::string format(const Program& p, const Settings& options) {
  std::string out;
  for (const std::string& line : p.about) out += "(" + line + ")\n";
  const std::string offset = options.text("work_offset", "G54");
  const bool machine = offset == "G53";
  if (machine)
    out +=
        "(G53: machine coordinates whatever offset is active; some controls move so)\n"
        "(at rapid, whatever F states: rapid override down)\n";
  out += "G21 G17 G90 G94 G40 G49 G80\nG61\n" + (machine ? "" : offset + "\n");
  out += "F" + programs::number(p.feed) + "\n";
  const std::string word = options.text("dwell_word", "P-s");
  for (const math::MeasuringMove& move : p.path.moves) {
    out += machine ? "G53 G1" : "G1";
    for (std::size_t a = 0; a < p.path.axes.size(); ++a)
      out += " " + p.path.axes[a] + programs::position(p.path, a, move.to[a]);
    out += "\n";
    if (move.dwell > 0.0) out += dwell(move.dwell, word) + "\n";
    if (move.stop) out += "M0\n";
  }
  return out + "M30\n";
}

Expected<OutputResult> write(const OutputInput& in) {
  return programs::written(in, {"program-gcode", ".ngc", format, true});
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {
      "program-gcode", "1.0.0", "Part programs of the measurement in ISO G-code.",
      programs::options(
          {one_of({"P-s", "P-ms", "X"},
                  {"dwell_word", std::string("P-s"), "",
                   "G4: P-s (LinuxCNC), P-ms (P in milliseconds: Fanuc), X (seconds: Fanuc)."}),
           one_of({"G53", "G54", "G55", "G56", "G57", "G58", "G59"},
                  {"work_offset", std::string("G54"), "",
                   "Offset that is set to the machine's zero; G53: none, each move is in machine "
                   "coordinates."})}),
      true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::program_gcode
