// SPDX-License-Identifier: Apache-2.0
//
// ISO 230-2, VDI/DGQ 3441 and the rules that have values of their own: eleven targets, five runs. The truth is the same evaluation of the
// same approaches, read by a perfect instrument in a perfect shop.
#include <cmath>

#include "coverage.h"

namespace nonio::coverage {
namespace {

struct Campaigns {
  Campaign campaign;
  std::vector<Observations> seen, real;
};

Campaigns axis(const Scenario& s, unsigned seed, double size) {
  Campaigns out;
  out.campaign = stated(s);
  out.campaign.measurements.push_back(named("X", "axis", "X"));
  constexpr std::size_t targets = 11;
  Line line;
  line.reversal = 2.0 * um * s.size;
  for (std::size_t i = 0; i < targets; ++i) {
    const double part = static_cast<double>(i) / (targets - 1.0);
    line.distance.push_back(s.size * part);
    line.mean.push_back(um * s.size * (6.0 * part + 2.0 * std::sin(9.0 * part)));
  }
  Day day(s, seed, size);
  const auto visits = there_and_back(targets, 5);
  const auto readings = day.measured(line, visits);
  Observations o;
  o.measurement = "X";
  o.axes = {{"X", false, {}, {}}};
  o.lines = {{"X", {1, 0, 0}}};
  for (const Visit& v : visits) {
    o.axes[0].position.push_back(line.distance[v.stop]);
    o.axes[0].approach.push_back(static_cast<std::int8_t>(v.direction));
    o.run.push_back(v.run);
  }
  Observations real = o;
  for (const Reading& r : readings) o.deviation.push_back(r.seen), real.deviation.push_back(r.real);
  out.seen.push_back(std::move(o));
  out.real.push_back(std::move(real));
  return out;
}

void compare(const Analysis& analysis, const Settings& settings, const Scenario& s, unsigned seed,
             double size, Tally& tally) {
  const Campaigns c = axis(s, seed, size);
  const Evaluation seen = evaluated(analysis, c.campaign, 0, c.seen, settings),
                   real = evaluated(analysis, c.campaign, 0, c.real, settings);
  for (std::size_t i = 0; i < seen.values.size(); ++i)
    if (const Value& v = seen.values[i]; v.U)
      tally.put(v.name, v.value - real.values[i].value, *v.U);
  for (std::size_t k = 0; k < seen.points.columns.size(); ++k) {
    const PointTable::Column& column = seen.points.columns[k];
    if (!column.U) continue;
    std::vector<double> error;
    double mean = 0.0;
    for (std::size_t i = 0; i < column.values.size(); ++i) {
      error.push_back(column.values[i] - real.points.columns[k].values[i]);
      mean += error.back() / static_cast<double>(column.values.size());
    }
    // Where the display was preset is no property of the axis: mean deviations have a common zero.
    const double zero = column.name.starts_with("mean") ? mean : 0.0;
    for (const double e : error) tally.put(column.name + "_i", e - zero, *column.U);
  }
}

void iso(const Scenario& s, unsigned seed, double size, Tally& tally) {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "iso230-2");
  compare(analysis, defaults(analysis), s, seed, size, tally);
}

void vdi(const Scenario& s, unsigned seed, double size, Tally& tally) {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "vdi-dgq-3441");
  compare(analysis, defaults(analysis), s, seed, size, tally);
}

/// Of rules with the formulas of these two no more is to be learnt.
void rules(const Scenario& s, unsigned seed, double size, Tally& tally) {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "positioning");
  Settings settings = defaults(analysis);
  settings.values["rules"] = std::vector<std::string>{"upr",   "vdi-3441",        "b5.54-1992",
                                                      "nmtba", "nmtba-no-offset", "jis-6330"};
  compare(analysis, settings, s, seed, size, tally);
}

}  // namespace

const std::vector<Method> axis_methods{
    {"ISO 230-2", iso}, {"VDI/DGQ 3441", vdi}, {"rules of positioning", rules}};

}  // namespace nonio::coverage
