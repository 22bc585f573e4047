// SPDX-License-Identifier: Apache-2.0
// Part programs of a measurement in HEIDENHAIN conversational language.
#include "nonio/sdk/plugin.h"

#include "programs.h"

namespace nonio::program_heidenhain {
namespace {

using programs::Program;

class Blocks {
 public:
  void add(const std::string& text) { out_ += std::to_string(number_++) + " " + text + "\n"; }
  std::string take() { return std::move(out_); }

 private:
  int number_ = 0;
  std::string out_;
};

std::string signed_position(const Program& p, std::size_t axis, double si) {
  const std::string text = programs::position(p.path, axis, si);
  return text.front() == '-' ? text : "+" + text;
}

std::string program_name(const std::string& path) {
  std::string name = "NONIO_";
  for (const char c : path)
    name += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
  return name;
}

std::string format(const Program& p, const Settings&) {
  Blocks blocks;
  const std::string name = program_name(p.path.name);
  blocks.add("BEGIN PGM " + name + " MM");
  for (const std::string& line : p.about) blocks.add("; " + line);
  blocks.add("TOOL CALL 0 Z");
  for (const math::MeasuringMove& move : p.path.moves) {
    std::string line = "L";
    for (std::size_t a = 0; a < p.path.axes.size(); ++a)
      line += " " + p.path.axes[a] + signed_position(p, a, move.to[a]);
    // M91: machine coordinates in this block.
    blocks.add(line + " R0 F" + programs::number(p.feed) + " M91");
    if (move.dwell > 0.0) {
      blocks.add("CYCL DEF 9.0 DWELL TIME");
      blocks.add("CYCL DEF 9.1 DWELL " + programs::number(move.dwell));
    }
    if (move.stop) blocks.add("STOP");
  }
  blocks.add("M30");
  blocks.add("END PGM " + name + " MM");
  return blocks.take();
}

Expected<OutputResult> write(const OutputInput& in) {
  return programs::written(in, {"program-heidenhain", ".h", format, false});
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"program-heidenhain", "1.0.0",
                 "Part programs of the measurement in HEIDENHAIN conversational language.",
                 programs::options({}), true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::program_heidenhain
