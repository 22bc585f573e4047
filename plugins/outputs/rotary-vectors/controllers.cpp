// SPDX-License-Identifier: Apache-2.0
//
// Kinematic parameters under the names that controls have for them.
#include <algorithm>
#include <cmath>

#include "vectors.h"

namespace nonio::vectors {
namespace {

/// A table C on a tilting axis: A turns about X, B about Y. Coordinates in m.
struct TiltingTable {
  const Line *c = nullptr, *tilt = nullptr;
  std::size_t about = 0;   ///< coordinate along the tilting axis: 0 for A, 1 for B
  std::size_t across = 1;  ///< the other horizontal one
  std::array<double, 3> c_point{}, tilt_point{};
};

std::array<double, 3> point_at(const Line& line, std::size_t coordinate, double where) {
  std::array<double, 3> out{};
  const double way = (where - line.centre[coordinate].value) / line.direction[coordinate].value;
  for (std::size_t k = 0; k < 3; ++k) out[k] = line.centre[k].value + way * line.direction[k].value;
  return out;
}

bool along(const Line& line, std::size_t coordinate) {
  constexpr double near = 0.999;  // 2.6 deg: what leans more is another kind of machine
  return line.direction[coordinate].value > near;
}

bool compared(const Line& a, const Line& b) {
  const auto names = [](const Line& x, const Line& y) {
    return std::find(x.shares_reference.begin(), x.shares_reference.end(), y.measurement) !=
           x.shares_reference.end();
  };
  return names(a, b) || names(b, a);
}

/// The only C and the only A or B of the campaign; an axis measured twice is not chosen from.
TiltingTable tilting_table(const std::vector<Line>& lines) {
  TiltingTable t;
  for (const Line& line : lines) {
    const bool tilts = line.axis == "A" || line.axis == "B";
    const Line*& place = tilts ? t.tilt : t.c;
    if (!tilts && line.axis != "C") continue;
    if (place != nullptr) return {};
    place = &line;
  }
  if (t.c == nullptr || t.tilt == nullptr) return {};
  t.about = t.tilt->axis == "A" ? 0 : 1;
  t.across = 1 - t.about;
  return t;
}

/// Where the lines pass each other: C at the height of the tilting axis, that one beside C.
void meet(TiltingTable& t) {
  t.c_point = point_at(*t.c, 2, t.tilt->centre[2].value);
  t.tilt_point = point_at(*t.tilt, t.about, t.c_point[t.about]);
  t.c_point = point_at(*t.c, 2, t.tilt_point[2]);
}

std::string linuxcnc(const TiltingTable& t, const std::string& campaign) {
  const bool a = t.about == 0;
  const std::string module = a ? "xyzac-trt-kins" : "xyzbc-trt-kins";
  const auto set = [&](const std::string& pin, double si) {
    return "setp " + module + "." + pin + " " + millimetres(si) + "\n";
  };
  std::string out = "# " + campaign + ": offsets for " + module + ", mm (machine units: mm)\n";
  out += "# Documented by its source: C passes through x-rot-point, y-rot-point with ";
  out += t.tilt->axis + " at 0;\n# " + t.tilt->axis + " through " + (a ? "y" : "x") +
         "-rot-point + " + (a ? "y" : "x") + "-offset and z-rot-point + z-offset.\n";
  out += "# Only the sum of z-rot-point and z-offset counts: z-offset is set to 0.\n";
  out += "# INFERRED: that C was measured with " + t.tilt->axis +
         " at 0, and in machine coordinates without tool length.\n";
  out += "# The module takes both axes as parallel to the linear axes; they lean by\n";
  const double lean_c = std::hypot(t.c->direction[0].value, t.c->direction[1].value);
  const double lean_t = std::hypot(t.tilt->direction[t.across].value, t.tilt->direction[2].value);
  out += "# C " + component(lean_c * 1e3) + " mm/m, " + t.tilt->axis + " " +
         component(lean_t * 1e3) + " mm/m. tool-offset belongs to the tool.\n";
  out += set("x-rot-point", t.c_point[0]) + set("y-rot-point", t.c_point[1]) +
         set("z-rot-point", t.tilt_point[2]);
  out += set(a ? "y-offset" : "x-offset", t.tilt_point[t.across] - t.c_point[t.across]);
  return out + set("z-offset", 0.0);
}

/// From the machine's base to the tilting axis, and from there to C, as rows of the table.
std::string heidenhain(const TiltingTable& t, const std::string& campaign) {
  std::string out = "; " + campaign + ": values for a kinematics table (iTNC 530), mm\n";
  out += "; Documented: the columns KEY, AXIS, COORD and the keys Trans, MachAxis.\n";
  out +=
      "; INFERRED: order of the rows, signs, and the place of the machine's base. Compare with\n";
  out += "; the table that is in the control and change only its values; do not load this file.\n";
  out += "KEY       AXIS  COORD\n";
  const auto row = [&](const char* key, char axis, const std::string& coord) {
    out += std::string(key) + std::string(10 - std::string_view(key).size(), ' ') + axis +
           (coord.empty() ? "" : "     " + coord) + "\n";
  };
  for (std::size_t k = 0; k < 3; ++k) row("Trans", "XYZ"[k], millimetres(t.tilt_point[k]));
  row("MachAxis", t.tilt->axis[0], "");
  for (std::size_t k = 0; k < 3; ++k)
    row("Trans", "XYZ"[k], millimetres(t.c_point[k] - t.tilt_point[k]));
  row("MachAxis", 'C', "");
  return out;
}

}  // namespace

void write_controllers(const std::vector<Line>& lines, const std::string& campaign,
                       OutputResult& result) {
  TiltingTable t = tilting_table(lines);
  if (t.c == nullptr) return;
  const std::vector<std::pair<std::string, std::string>> names = {{"one", t.c->measurement},
                                                                  {"other", t.tilt->measurement}};
  if (!compared(*t.c, *t.tilt)) {
    result.findings.push_back({.id = "vectors.no-reference", .texts = names});
    return;
  }
  if (!along(*t.c, 2) || !along(*t.tilt, t.about)) {
    result.findings.push_back({.id = "vectors.other-sense", .attention = true, .texts = names});
    return;
  }
  meet(t);
  result.artifacts.push_back({"rotary-vectors-linuxcnc.hal", linuxcnc(t, campaign)});
  result.artifacts.push_back({"rotary-vectors-heidenhain.txt", heidenhain(t, campaign)});
  result.notes.push_back({.id = "vectors.linuxcnc-inferred", .texts = {{"axis", t.tilt->axis}}});
  result.notes.push_back({.id = "vectors.heidenhain-inferred"});
}

}  // namespace nonio::vectors
