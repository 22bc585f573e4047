// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/skew.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "nonio/controllers/replay.h"

namespace nonio::controllers {
namespace {

/// ISO 230-1: C0Y rotates +Y towards -X, B0Z rotates +Z towards +X, A0Z rotates +Z towards -Y.
struct Square {
  const char *plane, *value;
  double lean;  ///< rotation of the second axis towards the first, per unit of `value`
};
constexpr std::array<Square, 3> squares{
    {{"XY", "C0Y", -1.0}, {"XZ", "B0Z", 1.0}, {"YZ", "A0Z", -1.0}}};

double travel_of(const ControllerInput& in, const std::string& measurement,
                 const std::string& axis) {
  for (const Measurement& m : in.campaign.measurements) {
    const auto from = m.from.find(axis), to = m.to.find(axis);
    if (m.id == measurement && from != m.from.end() && to != m.to.end() &&
        from->second != to->second)
      return std::fabs(to->second - from->second);
  }
  return 0.1;  // any length, because the factor does not depend on it
}

}  // namespace

LoadedTable linear_table(std::string output, std::string input, double per_length) {
  return {.output = std::move(output),
          .input = {std::move(input)},
          .position = {{0.0, 1.0}},
          .plus = {0.0, per_length},
          .minus = {},
          .outside = LoadedTable::Outside::continues};
}

std::vector<Face> faces_of(const ControllerInput& in, OutputResult& result) {
  std::vector<Face> faces;
  for (const Square& s : squares) {
    const Results::Analysed* found = nullptr;
    double lean = 0.0;
    for (const Results::Analysed& a : in.results.analyses)
      for (const Value& v : a.evaluation.values)
        if (v.name == s.value) {
          if (found != nullptr && found->measurement != a.measurement)
            result.findings.push_back({.id = "table.two-measurements",
                                       .attention = true,
                                       .evidence = {{"measurements", 2.0, Quantity::count}},
                                       .texts = {{"axis", s.plane}},
                                       .measurement = a.measurement,
                                       .advice = "The last one is in the file."});
          found = &a, lean = s.lean * v.value;
        }
    if (found == nullptr) continue;
    const std::string first(1, s.plane[0]), second(1, s.plane[1]);
    const double a = travel_of(in, found->measurement, first);
    const double b = travel_of(in, found->measurement, second);
    const double twice = 2.0 * a * b * std::sin(lean);
    faces.push_back({s.plane, std::sqrt(a * a + b * b + twice), std::sqrt(a * a + b * b - twice), a,
                     first, second});
  }
  return faces;
}

bool has_squareness(const Campaign& campaign) {
  return std::any_of(
      campaign.measurements.begin(), campaign.measurements.end(),
      [](const Measurement& m) { return m.kind == "diagonal" || m.kind == "step-diagonal"; });
}

double skew_factor(double AC, double BD, double AD) {
  const double side = std::sqrt(2 * AC * AC + 2 * BD * BD - 4 * AD * AD) / 2.0;
  const double cosine = (AC * AC - side * side - AD * AD) / (2 * side * AD);
  return std::tan(std::numbers::pi / 2 - std::acos(cosine));
}

std::vector<LoadedTable> skew_tables(const std::map<std::string, double>& factors) {
  const auto factor = [&](const char* plane) {
    const auto it = factors.find(plane);
    return it == factors.end() ? 0.0 : it->second;
  };
  const double xy = factor("XY"), xz = factor("XZ"), yz = factor("YZ");
  std::vector<LoadedTable> tables;
  if (factors.count("XY") != 0) tables.push_back(linear_table("X", "Y", -xy));
  if (factors.count("XZ") != 0) tables.push_back(linear_table("X", "Z", -(xz - xy * yz)));
  if (factors.count("YZ") != 0) tables.push_back(linear_table("Y", "Z", -yz));
  return tables;
}

ControlTable skew_declared(std::string name) {
  ControlTable t;
  t.name = std::move(name);
  t.rotary = false;
  t.squareness = true;
  t.runs_gcode = false;
  t.facts = {{"formula", ControlTable::Confidence::documented,
              "x' = x - y xy - z (xz - xy yz), y' = y - z yz, of the firmware's source."},
             {"corners", ControlTable::Confidence::documented,
              "AC begins where both axes begin, AD is along the first axis of the plane."}};
  return t;
}

Expected<OutputResult> write_skew(const ControllerInput& in, const Writer& w,
                                  std::string (*text)(const std::vector<Face>&)) {
  OutputResult result;
  for (const Measurement& m : in.campaign.measurements)
    if (m.kind == "axis") result.notes.push_back(not_in_format(w.name, m.id));
  const auto faces = faces_of(in, result);
  if (faces.empty()) return result;
  std::set<std::string> axes;
  for (const Face& f : faces) axes.insert({f.first, f.second});
  bool stated = true;
  for (const std::string& axis : axes) stated = states_active(in, axis, {}, true, result) && stated;
  if (!stated) return result;
  Artifact file{w.name + "-skew.cfg", text(faces)};
  NONIO_TRY(const auto read, w.parse({{file}, in.campaign, in.options}));
  for (const Face& f : faces) {
    const double wanted = skew_factor(f.AC, f.BD, f.AD);
    double found = NAN;
    for (const LoadedTable& t : read)
      if (t.output == f.first && t.input.front() == f.second) found = -t.plus.back();
    if (!(std::fabs(found - wanted) < 2e-7))  // 6 decimals of mm, and a product of two factors
      return fail(w.name + ": plane " + f.plane + " cannot be read back");
    result.predictions.push_back({{},
                                  f.plane,
                                  std::fabs(std::atan(wanted)),
                                  std::fabs(std::atan(wanted) - std::atan(found)),
                                  Quantity::small_angle});
  }
  // The correction changes the commanded position, so it applies to both motors of an axis.
  for (const CrossJob& set : cross_jobs(in, SecondSide::moves_along, result))
    predict_lines(set, {.tables = read}, result);
  result.artifacts.push_back(std::move(file));
  note_facts(w, result);
  return result;
}

}  // namespace nonio::controllers
