// SPDX-License-Identifier: Apache-2.0
// Circles: radial deviation over the angle from the first axis of the plane to the second.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"
#include "rows.h"
#include "spatial.h"

namespace nonio::csv {

namespace {

constexpr double circle_turn = 2.0 * std::numbers::pi, circle_deg = std::numbers::pi / 180.0;

using CircleRuns = std::map<std::pair<std::uint32_t, int>, std::vector<std::size_t>>;

struct Circle {
  std::string first, second;
  std::size_t u = 0, v = 0;
  double centre_u = 0.0, centre_v = 0.0, radius = 0.0;
};

Expected<Circle> circle_of(const Measurement& m) {
  Circle c;
  for (const auto& [axis, from] : m.from) {
    const auto to = m.to.find(axis);
    if (to != m.to.end() && to->second != from)
      c.first = axis, c.centre_u = from, c.radius = to->second - from;
    else
      c.second = axis, c.centre_v = from;
  }
  c.u = coordinate_of(c.first), c.v = coordinate_of(c.second);
  if (c.u > 2 || c.v > 2 || !(c.radius > 0.0))
    return fail("measurement \"" + m.id +
                "\": expected `plane`, `radius_mm` and `centre` of the circle");
  return c;
}

CircleRuns runs_of(const Table& table) {
  CircleRuns runs;
  const auto* run = table.column("run");
  const auto& direction = *table.column("direction");
  for (std::size_t row = 0; row < table.size(); ++row)
    runs[{run == nullptr ? 1 : static_cast<std::uint32_t>((*run)[row]),
          direction[row] > 0 ? 1 : -1}]
        .push_back(row);
  return runs;
}

/// Excludes the arcs of `over_travel_deg` of runs longer than a revolution. Error: the angle is not
/// monotonic, or the run is longer than this option allows.
Expected<std::vector<std::size_t>> evaluated(const Table& table,
                                             const std::vector<std::size_t>& rows, int direction,
                                             double over_travel) {
  constexpr double slack = 1e-9;
  const auto& angle = *table.column("angle_deg");
  double least = INFINITY, most = -INFINITY;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    least = std::min(least, angle[rows[i]]), most = std::max(most, angle[rows[i]]);
    if (i > 0 && (angle[rows[i]] - angle[rows[i - 1]]) * direction < 0.0)
      return fail(at_line(table.line[rows[i]], "angle_deg",
                          "expected angles that " + std::string(direction > 0 ? "grow" : "fall") +
                              " in direction " + (direction > 0 ? "+" : "-") +
                              ", row by row (beyond 360 or below 0, if the start is not at 0)"));
  }
  if (most - least <= 360.0 + slack) return rows;
  if (!(over_travel > 0.0) || most - least > 360.0 + 2.0 * over_travel + 1.0)
    return fail(at_line(table.line[rows.front()], "angle_deg",
                        "expected at most 360 deg in a run, or the angle before and after it as "
                        "`over_travel_deg` in the manifest; found " +
                            fixed_text(most - least, 3) + " deg"));
  const double middle = 0.5 * (least + most);
  std::vector<std::size_t> kept;
  for (const std::size_t row : rows)
    if (std::fabs(angle[row] - middle) <= 180.0 + slack) kept.push_back(row);
  return kept;
}

/// At a reversal point, the direction is that of the preceding motion.
std::int8_t approach_of(double speed, double before) {
  constexpr double at_rest = 1e-9;
  return (std::fabs(speed) > at_rest ? speed : before) > 0.0 ? std::int8_t{1} : std::int8_t{-1};
}

void put_row(Observations& obs, const Circle& c, double t, int d, double deviation) {
  const double cosine = std::cos(t), sine = std::sin(t);
  obs.axes[0].position.push_back(c.centre_u + c.radius * cosine);
  obs.axes[1].position.push_back(c.centre_v + c.radius * sine);
  obs.axes[0].approach.push_back(approach_of(-d * sine, cosine));
  obs.axes[1].approach.push_back(approach_of(d * cosine, sine));
  std::array<double, 3> sense{};
  sense[c.u] = cosine, sense[c.v] = sine;
  obs.sense.push_back(sense);
  obs.deviation.push_back(deviation);
}

Expected<Observations> read_rows_of(const ReadInput& input, const Circle& circle,
                                    const Table& table) {
  const Measurement& m = input.measurement;
  Observations obs = begin(m, table);
  if (auto ok = put_channels(obs, table); !ok) return fail(ok.error());
  obs.axes = {{circle.first, false, {}, {}}, {circle.second, false, {}, {}}};
  const auto& deviation = *table.column("deviation_um");
  std::uint64_t arcs = 0;
  std::map<int, std::size_t> line_of;
  for (const auto& [key, rows] : runs_of(table)) {
    const auto [run, direction] = key;
    NONIO_TRY(const auto kept,
              evaluated(table, rows, direction, m.over_travel.value_or(0.0) / circle_deg));
    arcs += rows.size() - kept.size();
    // Runs in one direction are one line, so that they repeat each other.
    const auto [line, fresh] = line_of.try_emplace(direction, obs.lines.size());
    if (fresh) obs.lines.push_back({m.id + (direction > 0 ? " +" : " -"), {}});
    for (const std::size_t row : kept) {
      if (!std::isfinite(deviation[row])) {
        ++obs.missing;
        continue;
      }
      put_row(obs, circle, (*table.column("angle_deg"))[row] * circle_deg, direction,
              deviation[row] * 1e-6);
      obs.line.push_back(static_cast<std::uint32_t>(line->second));
      obs.run.push_back(run);
      put_further_columns(obs, table, row);
      obs.lines[line->second].sense = obs.sense.back();
    }
  }
  if (arcs > 0) obs.notes.push_back({"csv.over-travel", {count("rows", arcs)}});
  return complete(std::move(obs));
}

}  // namespace

Expected<Observations> read_circle(const ReadInput& input) {
  NONIO_TRY(const auto circle, circle_of(input.measurement));
  auto table = read_table(input.bytes, with_channels({{"direction", Kind::sign, true},
                                                      {"angle_deg", Kind::place, true},
                                                      {"deviation_um", Kind::number, true},
                                                      {"run", Kind::whole},
                                                      {"time_s"},
                                                      {"material_c"},
                                                      {"air_c"},
                                                      {"pressure_hpa"},
                                                      {"humidity_pct"}}));
  auto obs =
      table ? read_rows_of(input, circle, *table) : Expected<Observations>(fail(table.error()));
  if (!obs) obs.error().file = input.measurement.file;
  return obs;
}

}  // namespace nonio::csv
