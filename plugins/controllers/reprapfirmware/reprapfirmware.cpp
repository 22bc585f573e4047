// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/skew.h"
#include "nonio/sdk/format.h"

namespace nonio::reprapfirmware {
namespace {

/// Letters of M556: X is the XY pair, Y the YZ pair, Z the XZ pair.
struct Pair {
  char letter;
  const char *plane, *output, *input;
};
constexpr std::array<Pair, 3> pairs{
    {{'X', "XY", "X", "Y"}, {'Y', "YZ", "Y", "Z"}, {'Z', "XZ", "X", "Z"}}};

constexpr double height = 1000.0;  // parameter S, mm

ControlTable declared() {
  ControlTable t = controllers::skew_declared("M556");
  t.runs_gcode = true;
  t.facts = {{"formula", ControlTable::Confidence::documented,
              "x' = x + y X/S + z Z/S, y' = y + z Y/S, of the firmware's source."},
             {"sign", ControlTable::Confidence::documented,
              "A positive deviation means that the angle of both axes is obtuse."}};
  return t;
}

// A plane without a result keeps the value in the control.
std::string text(const std::vector<controllers::Face>& faces) {
  std::string out = "M556 S" + fixed_text(height, 0);
  for (const Pair& pair : pairs)
    for (const controllers::Face& f : faces)
      if (f.plane == pair.plane)
        out += std::string(" ") + pair.letter +
               controllers::decimal(-controllers::skew_factor(f.AC, f.BD, f.AD) * height, 6);
  return out + "\n";
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  std::map<char, double> given;
  for (const Artifact& f : in.files)
    for (const auto line : controllers::lines_of(f.bytes)) {
      const auto words = controllers::words_of(line.substr(0, line.find(';')));
      if (words.empty() || words.front() != "M556") continue;
      for (const auto word : std::span(words).subspan(1)) {
        const auto v = controllers::real(word.substr(1));
        if (!v || std::string_view("SXYZ").find(word.front()) == std::string_view::npos)
          return fail(f.name + ": M556 with " + std::string(word) +
                      ", which is not understood; expected S, X, Y and Z with numbers");
        given[word.front()] = *v;
      }
    }
  if (given.empty()) return fail("no M556");
  const auto of = given.find('S');
  if (of == given.end() || !(of->second > 0.0)) return fail("M556 without a positive S");
  std::vector<LoadedTable> tables;
  for (const Pair& pair : pairs)
    if (const auto found = given.find(pair.letter); found != given.end())
      tables.push_back(
          controllers::linear_table(pair.output, pair.input, found->second / of->second));
  if (tables.empty()) return fail("M556 without X, Y or Z");
  return tables;
}

Expected<OutputResult> write(const ControllerInput& in) {
  const controllers::Writer writer{"reprapfirmware", declared(), {}, {}, parse};
  return controllers::write_skew(in, writer, text);
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"reprapfirmware", "1.0.0",
       "Skew correction (M556) for RepRapFirmware, from the squareness of the planes."},
      declared(), write, parse);
  controller.applies = controllers::has_squareness;
  registry.add(std::move(controller));
}

}  // namespace nonio::reprapfirmware
