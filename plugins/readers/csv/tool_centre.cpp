// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "rows.h"
#include "spatial.h"

namespace nonio::csv {
namespace {

/// Axis of right-handed rotation of the positions with increasing angle, from neighbors less than
/// half a revolution apart; nullopt if they do not rotate.
std::optional<Sense> turned_about(const std::vector<std::pair<double, Sense>>& places) {
  auto sorted = places;
  std::sort(sorted.begin(), sorted.end());
  Sense sum{};
  double size = 0.0;
  for (std::size_t i = 0; i + 2 < sorted.size(); ++i) {
    Sense a{}, b{};
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = sorted[i + 1].second[k] - sorted[i].second[k];
      b[k] = sorted[i + 2].second[k] - sorted[i + 1].second[k];
      size += a[k] * a[k];
    }
    if (sorted[i + 2].first - sorted[i].first > 6.28) continue;
    for (std::size_t k = 0; k < 3; ++k)
      sum[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
  }
  const double length = std::hypot(sum[0], sum[1], sum[2]);
  if (!(length > 1e-3 * size) || !(size > 1e-8)) return std::nullopt;
  for (double& x : sum) x /= length;
  return sum;
}

Sense turned(const Sense& v, const Sense& n, double angle) {
  const double c = std::cos(angle), s = std::sin(angle),
               along = (1.0 - c) * (n[0] * v[0] + n[1] * v[1] + n[2] * v[2]);
  Sense out{};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = c * v[k] + along * n[k] +
             s * (n[(k + 1) % 3] * v[(k + 2) % 3] - n[(k + 2) % 3] * v[(k + 1) % 3]);
  return out;
}

/// Rows of kind rtcp: a gauge with its direction (nx, ny, nz; or tx, ty, tz at axis position 0 if
/// it rotates with the axis), or the center from a probe.
class ToolCentreRows {
 public:
  ToolCentreRows(const Table& table, Observations& obs) : table_(table), obs_(obs) {
    probe_ = table.column("dx_um") != nullptr;
    turns_ = table.column("tx") != nullptr;
  }

  Expected<void> read() {
    if (auto fits = one_layout(); !fits) return fits;
    if (turns_ && !find_axis())
      return fail(
          "expected places that go round with the angle where a gauge turns with the axis "
          "(tx, ty, tz): x_mm, y_mm, z_mm are the positions of the linear axes in machine "
          "coordinates");
    for (std::size_t row = 0; row < table_.size(); ++row)
      if (auto put = probe_ ? put_probe(row) : put_gauge(row); !put) return put;
    return {};
  }

 private:
  double number(const char* column, std::size_t row) const { return (*table_.column(column))[row]; }
  std::string name(std::size_t row) const {
    const auto names = table_.words.find("line");
    return names == table_.words.end() ? obs_.measurement : names->second[row];
  }
  Sense place(std::size_t row) const {
    return {number("x_mm", row) * per_mm, number("y_mm", row) * per_mm,
            number("z_mm", row) * per_mm};
  }

  Expected<void> one_layout() {
    const auto has = [&](std::initializer_list<const char*> names) {
      return std::count_if(names.begin(), names.end(),
                           [&](const char* n) { return table_.column(n) != nullptr; });
    };
    const auto n = has({"nx", "ny", "nz"}), t = has({"tx", "ty", "tz"}),
               d = has({"dx_um", "dy_um", "dz_um"}), y = has({"deviation_um"});
    const bool gauge = y == 1 && d == 0 && ((n == 3 && t == 0) || (n == 0 && t == 3));
    if (gauge || (d == 3 && y + n + t == 0)) return {};
    return fail(
        "expected deviation_um with nx, ny, nz (a stationary gauge) or with tx, ty, tz (a "
        "gauge that turns with the axis, as it points with the axis at 0), or dx_um, dy_um, dz_um "
        "(a probe: centre found less centre commanded)");
  }

  bool find_axis() {
    std::map<std::string, std::vector<std::pair<double, Sense>>> lines;
    for (std::size_t row = 0; row < table_.size(); ++row)
      if (const Sense at = place(row); std::isfinite(at[0] + at[1] + at[2]))
        lines[name(row) + " " + std::to_string(run(row))].emplace_back(
            number("angle_deg", row) * per_deg, at);
    for (const auto& [line, places] : lines)
      if (const auto about = turned_about(places)) {
        about_ = *about;
        return true;
      }
    return false;
  }
  int run(std::size_t row) const {
    const auto *runs = table_.column("run"), *directions = table_.column("direction");
    return 2 * static_cast<int>(runs == nullptr ? 1.0 : (*runs)[row]) +
           (directions != nullptr && (*directions)[row] < 0.0 ? 1 : 0);
  }

  std::uint32_t line_of(const std::string& name, const Sense& sense) {
    for (std::size_t l = 0; l < obs_.lines.size(); ++l)
      if (obs_.lines[l].name == name) return static_cast<std::uint32_t>(l);
    obs_.lines.push_back({name, sense});
    return static_cast<std::uint32_t>(obs_.lines.size() - 1);
  }

  void put(std::size_t row, const std::string& line, const Sense& sense, double deviation) {
    const Sense at = place(row);
    obs_.axes[0].position.push_back(number("angle_deg", row) * per_deg);
    if (const auto* direction = table_.column("direction"))
      obs_.axes[0].approach.push_back(static_cast<std::int8_t>((*direction)[row]));
    for (std::size_t k = 0; k < 3; ++k) obs_.axes[1 + k].position.push_back(at[k]);
    obs_.line.push_back(line_of(line, sense));
    obs_.sense.push_back(sense);
    obs_.deviation.push_back(deviation);
    put_common(obs_, table_, row);
  }

  /// The deviation is the commanded minus the measured position.
  Expected<void> put_probe(std::size_t row) {
    const Sense at = place(row),
                found{number("dx_um", row), number("dy_um", row), number("dz_um", row)};
    if (!std::isfinite(at[0] + at[1] + at[2] + found[0] + found[1] + found[2])) {
      ++obs_.missing;
      return {};
    }
    for (std::size_t k = 0; k < 3; ++k) {
      Sense sense{};
      sense[k] = 1.0;
      put(row, name(row) + " found " + "xyz"[k], sense, -found[k] * per_um);
    }
    return {};
  }

  Expected<void> put_gauge(std::size_t row) {
    const char* const columns[] = {turns_ ? "tx" : "nx", turns_ ? "ty" : "ny",
                                   turns_ ? "tz" : "nz"};
    Sense sense{number(columns[0], row), number(columns[1], row), number(columns[2], row)};
    const double size = std::hypot(sense[0], sense[1], sense[2]);
    if (!(std::fabs(size - 1.0) <= 1e-3))
      return fail(
          at_line(table_.line[row], columns[0],
                  "expected a direction of length 1, found a length of " + std::to_string(size)));
    for (double& x : sense) x /= size;
    const Sense at = place(row);
    const double deviation = number("deviation_um", row);
    if (!std::isfinite(deviation + at[0] + at[1] + at[2])) {
      ++obs_.missing;
      return {};
    }
    if (turns_) sense = turned(sense, about_, number("angle_deg", row) * per_deg);
    put(row, name(row), sense, deviation * per_um);
    return {};
  }

  const Table& table_;
  Observations& obs_;
  bool probe_ = false, turns_ = false;
  Sense about_{0.0, 0.0, 1.0};
};

}  // namespace

Expected<Observations> read_tool_centre(const ReadInput& input) {
  const Measurement& m = input.measurement;
  const Axis* axis = input.campaign.machine.axis(m.axis);
  if (axis == nullptr || !axis->rotary)
    return fail("measurement \"" + m.id + "\": expected a rotary axis, found " +
                (m.axis.empty() ? "none" : "\"" + m.axis + "\""));
  std::vector<ColumnSpec> columns{{"angle_deg", Kind::place, true}, {"x_mm", Kind::number, true},
                                  {"y_mm", Kind::number, true},     {"z_mm", Kind::number, true},
                                  {"direction", Kind::sign},        {"line", Kind::word}};
  for (const char* name : {"nx", "ny", "nz", "tx", "ty", "tz"})
    columns.push_back({name, Kind::place});
  for (const char* name : {"dx_um", "dy_um", "dz_um", "deviation_um"})
    columns.push_back({name, Kind::number});
  NONIO_TRY(const auto table, table_of(input, with_common(columns)));
  Observations obs = begin(m, table);
  obs.axes = {
      {m.axis, true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  if (auto read = ToolCentreRows(table, obs).read(); !read)
    return in_file(Expected<Observations>(fail(read.error())), input);
  return in_file(complete(std::move(obs)), input);
}

}  // namespace nonio::csv
