// SPDX-License-Identifier: Apache-2.0
#include "spatial.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "rows.h"

namespace nonio::csv {

Expected<Span> span_of(const Campaign& campaign, const Measurement& m) {
  const auto bad = [&](const std::string& message) {
    return fail("measurement \"" + m.id + "\": " + message);
  };
  Span span;
  double square = 0.0;
  for (const auto& [axis, from] : m.from) {
    const auto to = m.to.find(axis);
    if (to == m.to.end()) return bad("`from` has axis " + axis + ", `to` has not");
    if (to->second == from) continue;
    const Axis* known = campaign.machine.axis(axis);
    if (known != nullptr && known->rotary)
      return bad("expected linear axes in `from` and `to`, found the rotary axis " + axis);
    const std::size_t coordinate = coordinates.find(axis.empty() ? ' ' : axis[0]);
    if (coordinate == coordinates.npos)
      return bad("expected axes named X, Y, Z (or X1, Y2, ...) in `from` and `to`, found " + axis);
    for (const Span::Side& side : span.sides)
      if (side.coordinate == coordinate)
        return bad("axes " + side.axis + " and " + axis + " go along the same coordinate");
    span.sides.push_back({axis, coordinate, from, to->second});
    square += (to->second - from) * (to->second - from);
  }
  for (const auto& [axis, to] : m.to)
    if (!m.from.contains(axis)) return bad("`to` has axis " + axis + ", `from` has not");
  if (span.sides.size() < 2)
    return bad("expected `from` and `to` to differ in at least two axes, found " +
               std::to_string(span.sides.size()));
  std::sort(span.sides.begin(), span.sides.end(),
            [](const auto& a, const auto& b) { return a.coordinate < b.coordinate; });
  span.length = std::sqrt(square);
  return span;
}

void spread(Observations& obs, const Span& span) {
  const Observations::AxisColumn along = std::move(obs.axes.front());
  obs.axes.clear();
  obs.lines.front().sense = {};
  for (const Span::Side& side : span.sides) {
    const double slope = (side.to - side.from) / span.length;
    obs.lines.front().sense[side.coordinate] = slope;
    Observations::AxisColumn column{side.axis, false, along.position, along.approach};
    for (double& position : column.position) position = side.from + slope * position;
    if (slope < 0.0)
      for (std::int8_t& approach : column.approach) approach = static_cast<std::int8_t>(-approach);
    obs.axes.push_back(std::move(column));
  }
}

namespace {

std::vector<std::string> other_rotary_axes(const Campaign& campaign, const std::string& axis) {
  std::vector<std::string> names;
  for (const Axis& other : campaign.machine.axes)
    if (other.rotary && other.name != axis) names.push_back(other.name);
  return names;
}

}  // namespace

Expected<Observations> read_ball_centres(const ReadInput& input) {
  const Measurement& m = input.measurement;
  const Axis* axis = input.campaign.machine.axis(m.axis);
  if (axis == nullptr || !axis->rotary)
    return fail("measurement \"" + m.id + "\": expected a rotary axis, found " +
                (m.axis.empty() ? "none" : "\"" + m.axis + "\""));
  std::vector<ColumnSpec> columns{{"angle_deg", Kind::place, true},
                                  {"x_mm", Kind::number, true},
                                  {"y_mm", Kind::number, true},
                                  {"z_mm", Kind::number, true},
                                  {"direction", Kind::sign}};
  const auto others = other_rotary_axes(input.campaign, m.axis);
  for (const std::string& other : others) columns.push_back({other + "_deg", Kind::place});
  NONIO_TRY(const auto table, table_of(input, with_common(columns)));
  Observations obs = begin(m, table);
  obs.axes = {
      {m.axis, true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  for (std::size_t k = 0; k < 3; ++k) {
    Observations::Line line{m.id + " " + "xyz" [k], {}};
    line.sense[k] = 1.0;
    obs.lines.push_back(line);
  }
  std::vector<const std::vector<double>*> also;
  for (const std::string& other : others)
    if (const auto* column = table.column(other + "_deg")) {
      also.push_back(column);
      obs.axes.push_back({other, true, {}, {}});
    }
  const auto* direction = table.column("direction");
  for (std::size_t row = 0; row < table.size(); ++row) {
    const Sense centre{(*table.column("x_mm"))[row] * per_mm, (*table.column("y_mm"))[row] * per_mm,
                       (*table.column("z_mm"))[row] * per_mm};
    if (!std::isfinite(centre[0] + centre[1] + centre[2])) {
      ++obs.missing;
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      obs.axes[0].position.push_back((*table.column("angle_deg"))[row] * per_deg);
      if (direction != nullptr)
        obs.axes[0].approach.push_back(static_cast<std::int8_t>((*direction)[row]));
      for (std::size_t c = 0; c < 3; ++c) obs.axes[1 + c].position.push_back(centre[c]);
      for (std::size_t c = 0; c < also.size(); ++c)
        obs.axes[4 + c].position.push_back((*also[c])[row] * per_deg);
      obs.deviation.push_back(centre[k]);
      obs.line.push_back(static_cast<std::uint32_t>(k));
      put_common(obs, table, row);
    }
  }
  return in_file(complete(std::move(obs)), input);
}

namespace {

std::vector<std::pair<std::string, bool>> possible_axes(const Campaign& campaign) {
  std::vector<std::pair<std::string, bool>> axes;
  for (const Axis& axis : campaign.machine.axes) axes.emplace_back(axis.name, axis.rotary);
  for (const char c : coordinates)
    if (campaign.machine.axis(std::string(1, c)) == nullptr)
      axes.emplace_back(std::string(1, c), false);
  return axes;
}

/// `sense` is kept for all readings if a line has several directions.
class GeneralLines {
 public:
  explicit GeneralLines(Observations& obs) : obs_(obs) {}
  void put(const std::string& name, const Sense& sense) {
    const auto [at, fresh] =
        numbers_.try_emplace(name, static_cast<std::uint32_t>(obs_.lines.size()));
    if (fresh) obs_.lines.push_back({name, sense});
    differ_ |= obs_.lines[at->second].sense != sense;
    obs_.line.push_back(at->second);
    obs_.sense.push_back(sense);
  }
  void finish() {
    if (!differ_) obs_.sense.clear();
  }

 private:
  Observations& obs_;
  std::map<std::string, std::uint32_t> numbers_;
  bool differ_ = false;
};

}  // namespace

Expected<Observations> read_general(const ReadInput& input) {
  const auto possible = possible_axes(input.campaign);
  std::vector<ColumnSpec> columns{{"deviation_um", Kind::number, true},
                                  {"nx", Kind::place, true},
                                  {"ny", Kind::place, true},
                                  {"nz", Kind::place, true},
                                  {"line", Kind::word}};
  const auto coordinate = [](const auto& axis) {
    return axis.first + (axis.second ? "_deg" : "_mm");
  };
  for (const auto& axis : possible) {
    columns.push_back({coordinate(axis), Kind::place});
    columns.push_back({axis.first + "_dir", Kind::motion});
  }
  NONIO_TRY(const auto table, table_of(input, with_common(columns)));
  Observations obs = begin(input.measurement, table);
  std::vector<std::pair<const std::vector<double>*, const std::vector<double>*>> sources;
  for (const auto& axis : possible)
    if (const auto* position = table.column(coordinate(axis))) {
      obs.axes.push_back({axis.first, axis.second, {}, {}});
      sources.emplace_back(position, table.column(axis.first + "_dir"));
    } else if (table.column(axis.first + "_dir") != nullptr) {
      return in_file(Expected<Observations>(fail(
                         at_line(0, axis.first + "_dir",
                                 "expected the coordinate \"" + coordinate(axis) + "\" with it"))),
                     input);
    }
  if (obs.axes.empty())
    return in_file(Expected<Observations>(
                       fail("missing column: expected a coordinate, such as \"X_mm\", found none")),
                   input);
  GeneralLines lines(obs);
  for (std::size_t row = 0; row < table.size(); ++row) {
    const Sense sense{(*table.column("nx"))[row], (*table.column("ny"))[row],
                      (*table.column("nz"))[row]};
    const double size = std::hypot(sense[0], sense[1], sense[2]);
    if (!(std::fabs(size - 1.0) <= 1e-3))
      return in_file(
          Expected<Observations>(fail(at_line(
              table.line[row], "nx",
              "expected nx, ny, nz of length 1, found a length of " + std::to_string(size)))),
          input);
    const double deviation = (*table.column("deviation_um"))[row];
    if (!std::isfinite(deviation)) {
      ++obs.missing;
      continue;
    }
    for (std::size_t k = 0; k < obs.axes.size(); ++k) {
      const auto [position, direction] = sources[k];
      obs.axes[k].position.push_back((*position)[row] * (obs.axes[k].rotary ? per_deg : per_mm));
      if (direction != nullptr)
        obs.axes[k].approach.push_back(static_cast<std::int8_t>((*direction)[row]));
    }
    const auto names = table.words.find("line");
    lines.put(names == table.words.end() ? obs.measurement : names->second[row],
              {sense[0] / size, sense[1] / size, sense[2] / size});
    obs.deviation.push_back(deviation * per_um);
    put_common(obs, table, row);
  }
  lines.finish();
  return in_file(complete(std::move(obs)), input);
}

const std::vector<std::string_view>& spatial_names() {
  static const std::vector<std::string_view> names{
      "diagonal", "step",  "moved", "angle_deg",    "x_mm",     "y_mm", "z_mm",
      "nx",       "ny",    "nz",    "deviation_um", "tx",       "ty",   "tz",
      "dx_um",    "dy_um", "dz_um", "x_um",         "y_um",     "z_um", "x1_um",
      "x2_um",    "y1_um", "y2_um", "speed_rpm",    "length_mm"};
  return names;
}

}  // namespace nonio::csv
