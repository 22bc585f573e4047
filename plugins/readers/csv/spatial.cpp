// SPDX-License-Identifier: Apache-2.0
// Long: one layout after the other (step diagonals, ball centres, general), on common columns.
#include "spatial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "nonio/sdk/fields.h"
#include "table.h"

namespace nonio::csv {
using namespace reading;
namespace {

using Kind = ColumnSpec::Kind;
using Sense = std::array<double, 3>;

constexpr double per_mm = 1e-3, per_um = 1e-6, per_deg = 1.0 / deg_per_rad;
constexpr std::string_view coordinates = "XYZ";

/// Columns of time and air that every kind may have.
std::vector<ColumnSpec> with_common(std::vector<ColumnSpec> columns) {
  for (const char* name : {"time_s", "material_c", "air_c", "pressure_hpa", "humidity_pct"})
    columns.push_back({name});
  columns.push_back({"run", Kind::whole});
  return columns;
}

/// Columns of the table that need no conversion, for its row `row`.
void put_common(Observations& obs, const Table& table, std::size_t row) {
  const auto put = [&](const char* name, std::vector<double>& to) {
    if (const auto* column = table.column(name)) to.push_back((*column)[row]);
  };
  put("time_s", obs.time);
  put("material_c", obs.material);
  put("air_c", obs.air);
  put("pressure_hpa", obs.pressure);
  put("humidity_pct", obs.humidity);
  const auto* run = table.column("run");
  obs.run.push_back(run == nullptr ? 1 : static_cast<std::uint32_t>((*run)[row]));
  obs.source_line.push_back(table.line[row]);
}

Observations begin(const Measurement& m, const Table& table) {
  Observations obs;
  obs.measurement = m.id;
  if (table.empty_rows > 0)
    obs.notes.push_back({"csv.empty-rows", {count("rows", table.empty_rows)}});
  return obs;
}

Expected<Observations> complete(Observations obs) {
  if (obs.size() == 0)
    return fail("expected readings, found " + std::to_string(obs.missing) +
                " of which not one was taken");
  return obs;
}

Error at_line(std::uint64_t line, std::string column, std::string message) {
  Error error{std::move(message)};
  error.line = line;
  error.column = std::move(column);
  return error;
}

Expected<Table> table_of(const ReadInput& input, const std::vector<ColumnSpec>& columns) {
  auto table = read_table(input.bytes, columns);
  if (!table) table.error().file = input.measurement.file;
  return table;
}

template <class T>
Expected<T> in_file(Expected<T> result, const ReadInput& input) {
  if (!result && result.error().file.empty()) result.error().file = input.measurement.file;
  return result;
}

}  // namespace

Expected<Span> span_of(const Campaign& campaign, const Measurement& m) {
  const auto bad = [&](const std::string& message) {
    return fail("measurement \"" + m.id + "\": " + message);
  };
  Span span;
  double square = 0.0;
  for (const auto& [axis, from] : m.from) {
    const auto to = m.to.find(axis);
    if (to == m.to.end()) return bad("`from` has axis " + axis + ", `to` has not");
    if (to->second == from) continue;  // it stands still
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

/// The rows of one pass over one step diagonal, by step.
using Pass = std::map<std::uint32_t, std::size_t>;

struct Corner {
  const char* name;
  Sense sign;
};
constexpr std::array<Corner, 4> corners = {
    {{"PPP", {1, 1, 1}}, {"NPP", {-1, 1, 1}}, {"PNP", {1, -1, 1}}, {"PPN", {1, 1, -1}}}};

class StepDiagonals {
 public:
  StepDiagonals(const Table& table, const Span& span, Observations& obs)
      : table_(table), span_(span), obs_(obs) {}

  Expected<void> read() {
    for (const Span::Side& side : span_.sides) obs_.axes.push_back({side.axis, false, {}, {}});
    if (auto sorted = sort_rows(); !sorted) return sorted;
    std::vector<std::pair<std::size_t, const std::pair<const Key, Pass>*>> in_order;
    for (const auto& pass : passes_) {
      std::size_t first = table_.size();
      for (const auto& [step, row] : pass.second) first = std::min(first, row);
      in_order.emplace_back(first, &pass);
    }
    std::sort(in_order.begin(), in_order.end());
    for (const auto& [first, pass] : in_order)
      if (auto done = take(pass->first, pass->second); !done) return done;
    if (repeated_ > 0)
      obs_.notes.push_back(
          {"csv.repeated-rows", {count("rows", repeated_), count("line", first_repeated_)}});
    return {};
  }

 private:
  using Key = std::pair<std::uint32_t, std::string>;  ///< run, diagonal

  double number(const char* column, std::size_t row) const {
    const auto* values = table_.column(column);
    return values == nullptr ? 1.0 : (*values)[row];
  }
  const std::string& word(const char* column, std::size_t row) const {
    return table_.words.find(column)->second[row];
  }
  bool same(std::size_t a, std::size_t b) const {
    const double x = number("deviation_um", a), y = number("deviation_um", b);
    return word("moved", a) == word("moved", b) && (x == y || (std::isnan(x) && std::isnan(y)));
  }

  Expected<void> sort_rows() {
    for (std::size_t row = 0; row < table_.size(); ++row) {
      const Key key{static_cast<std::uint32_t>(number("run", row)), word("diagonal", row)};
      const auto step = static_cast<std::uint32_t>(number("step", row));
      const auto [at, fresh] = passes_[key].try_emplace(step, row);
      if (fresh) continue;
      if (!same(at->second, row))
        return fail(at_line(table_.line[row], "step",
                            "a second reading of diagonal " + key.second + ", step " +
                                std::to_string(step) + ", different from the one in line " +
                                std::to_string(table_.line[at->second]) +
                                "; expected one, or an identical repetition"));
      if (repeated_++ == 0) first_repeated_ = table_.line[row];
    }
    return {};
  }

  Expected<void> take(const Key& key, const Pass& pass) {
    const std::string who = "diagonal " + key.second +
                            (key.first == 1 ? "" : ", run " + std::to_string(key.first)) + ": ";
    const std::uint64_t line = table_.line[pass.rbegin()->second];
    const std::uint32_t steps = pass.rbegin()->first;
    if (steps % 3 != 0)
      return fail(at_line(
          line, "step",
          who + "expected a number of steps that 3 divides, found " + std::to_string(steps)));
    std::uint32_t expected = 1;
    for (const auto& [step, row] : pass)
      if (step != expected++)
        return fail(at_line(table_.line[row], "step",
                            who + "expected step " + std::to_string(expected - 1) + ", found " +
                                std::to_string(step) +
                                "; a step that was not read stands in the file without a value"));
    return walk(key, pass, who, steps / 3);
  }

  Expected<void> walk(const Key& key, const Pass& pass, const std::string& who, std::uint32_t n) {
    const Sense sign = std::find_if(corners.begin(), corners.end(), [&](const Corner& c) {
                         return c.name == key.second;
                       })->sign;
    Observations::Line line{obs_.measurement + " " + key.second +
                                (key.first == 1 ? "" : " run " + std::to_string(key.first)),
                            {}};
    for (std::size_t k = 0; k < 3; ++k)
      line.sense[k] = sign[k] * (span_.sides[k].to - span_.sides[k].from) / span_.length;
    obs_.lines.push_back(line);
    std::array<std::uint32_t, 3> moved{};
    for (const auto& [step, row] : pass) {
      const std::size_t axis = coordinates.find(word("moved", row)[0]);
      if (++moved[axis] > n)
        return fail(at_line(table_.line[row], "moved",
                            who + "expected " + std::to_string(n) + " moves of each axis in " +
                                std::to_string(3 * n) + " steps, found more of " +
                                word("moved", row)));
      put(row, sign, moved, n);
    }
    return {};
  }

  void put(std::size_t row, const Sense& sign, const std::array<std::uint32_t, 3>& moved,
           std::uint32_t n) {
    const double deviation = number("deviation_um", row);
    if (!std::isfinite(deviation)) {
      ++obs_.missing;
      return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Span::Side& side = span_.sides[k];
      const double start = sign[k] > 0.0 ? side.from : side.to, way = side.to - side.from;
      obs_.axes[k].position.push_back(start + sign[k] * way * moved[k] / n);
      obs_.axes[k].approach.push_back(sign[k] * way > 0.0 ? 1 : -1);
    }
    obs_.deviation.push_back(deviation * per_um);
    obs_.line.push_back(static_cast<std::uint32_t>(obs_.lines.size() - 1));
    put_common(obs_, table_, row);
  }

  const Table& table_;
  const Span& span_;
  Observations& obs_;
  std::map<Key, Pass> passes_;
  std::uint64_t repeated_ = 0, first_repeated_ = 0;
};

}  // namespace

Expected<Observations> read_step_diagonal(const ReadInput& input) {
  const auto span = span_of(input.campaign, input.measurement);
  if (!span) return fail(span.error());
  if (span->sides.size() != 3)
    return fail("measurement \"" + input.measurement.id +
                "\": expected `from` and `to` to differ in X, Y and Z");
  std::vector<std::string> names;
  for (const Corner& corner : corners) names.emplace_back(corner.name);
  static const std::vector<std::string> axes{"X", "Y", "Z"};
  const auto table = table_of(input, with_common({{"diagonal", Kind::word, true, names},
                                                  {"step", Kind::whole, true},
                                                  {"moved", Kind::word, true, axes},
                                                  {"deviation_um", Kind::number, true}}));
  if (!table) return fail(table.error());
  Observations obs = begin(input.measurement, *table);
  if (auto read = StepDiagonals(*table, *span, obs).read(); !read)
    return in_file(Expected<Observations>(fail(read.error())), input);
  return in_file(complete(std::move(obs)), input);
}

Expected<Observations> read_ball_centres(const ReadInput& input) {
  const Measurement& m = input.measurement;
  const Axis* axis = input.campaign.machine.axis(m.axis);
  if (axis == nullptr || !axis->rotary)
    return fail("measurement \"" + m.id + "\": expected a rotary axis, found " +
                (m.axis.empty() ? "none" : "\"" + m.axis + "\""));
  const auto table = table_of(input, with_common({{"angle_deg", Kind::place, true},
                                                  {"x_mm", Kind::number, true},
                                                  {"y_mm", Kind::number, true},
                                                  {"z_mm", Kind::number, true},
                                                  {"direction", Kind::sign}}));
  if (!table) return fail(table.error());
  Observations obs = begin(m, *table);
  obs.axes = {
      {m.axis, true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  for (std::size_t k = 0; k < 3; ++k) {
    Observations::Line line{m.id + " " + "xyz" [k], {}};
    line.sense[k] = 1.0;
    obs.lines.push_back(line);
  }
  const auto* direction = table->column("direction");
  for (std::size_t row = 0; row < table->size(); ++row) {
    const Sense centre{(*table->column("x_mm"))[row] * per_mm,
                       (*table->column("y_mm"))[row] * per_mm,
                       (*table->column("z_mm"))[row] * per_mm};
    if (!std::isfinite(centre[0] + centre[1] + centre[2])) {
      ++obs.missing;
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      obs.axes[0].position.push_back((*table->column("angle_deg"))[row] * per_deg);
      if (direction != nullptr)
        obs.axes[0].approach.push_back(static_cast<std::int8_t>((*direction)[row]));
      for (std::size_t c = 0; c < 3; ++c) obs.axes[1 + c].position.push_back(centre[c]);
      obs.deviation.push_back(centre[k]);
      obs.line.push_back(static_cast<std::uint32_t>(k));
      put_common(obs, *table, row);
    }
  }
  return in_file(complete(std::move(obs)), input);
}

namespace {

/// The direction about which places go round right-handed with the angle, from neighbours by angle
/// less than half a turn apart; none if they do not go round.
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

/// Rows of kind rtcp: a gauge (with nx, ny, nz as it points, or tx, ty, tz as it points with the
/// axis at 0 where it turns with it), or the whole centre as a probe found it.
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
          "(tx, ty, tz): x_mm, y_mm, z_mm are where the linear axes stand in machine "
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
        "expected deviation_um with nx, ny, nz (a gauge that stands still) or with tx, ty, tz (a "
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
  /// A sweep: run, and direction where the file says it.
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

  /// The deviation is that of the tool: commanded less found.
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
  const auto table = table_of(input, with_common(columns));
  if (!table) return fail(table.error());
  Observations obs = begin(m, *table);
  obs.axes = {
      {m.axis, true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  if (auto read = ToolCentreRows(*table, obs).read(); !read)
    return in_file(Expected<Observations>(fail(read.error())), input);
  return in_file(complete(std::move(obs)), input);
}

namespace {

/// An axis that a general table may have: those of the machine, and X, Y, Z.
std::vector<std::pair<std::string, bool>> possible_axes(const Campaign& campaign) {
  std::vector<std::pair<std::string, bool>> axes;
  for (const Axis& axis : campaign.machine.axes) axes.emplace_back(axis.name, axis.rotary);
  for (const char c : coordinates)
    if (campaign.machine.axis(std::string(1, c)) == nullptr)
      axes.emplace_back(std::string(1, c), false);
  return axes;
}

/// The number of a line, which is new if its name is; a reading that senses another way than the
/// first one of its line needs `sense` for all.
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

// Long: one layout, column by column, then row by row.
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
  const auto table = table_of(input, with_common(columns));
  if (!table) return fail(table.error());
  Observations obs = begin(input.measurement, *table);
  std::vector<std::pair<const std::vector<double>*, const std::vector<double>*>> sources;
  for (const auto& axis : possible)
    if (const auto* position = table->column(coordinate(axis))) {
      obs.axes.push_back({axis.first, axis.second, {}, {}});
      sources.emplace_back(position, table->column(axis.first + "_dir"));
    } else if (table->column(axis.first + "_dir") != nullptr) {
      return in_file(Expected<Observations>(fail(at_line(
                         0, axis.first + "_dir",
                         "expected the coordinate \"" + coordinate(axis) + "\" beside it"))),
                     input);
    }
  if (obs.axes.empty())
    return in_file(Expected<Observations>(
                       fail("missing column: expected a coordinate, such as \"X_mm\", found none")),
                   input);
  GeneralLines lines(obs);
  for (std::size_t row = 0; row < table->size(); ++row) {
    const Sense sense{(*table->column("nx"))[row], (*table->column("ny"))[row],
                      (*table->column("nz"))[row]};
    const double size = std::hypot(sense[0], sense[1], sense[2]);
    if (!(std::fabs(size - 1.0) <= 1e-3))
      return in_file(
          Expected<Observations>(fail(at_line(
              table->line[row], "nx",
              "expected nx, ny, nz of length 1, found a length of " + std::to_string(size)))),
          input);
    const double deviation = (*table->column("deviation_um"))[row];
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
    const auto names = table->words.find("line");
    lines.put(names == table->words.end() ? obs.measurement : names->second[row],
              {sense[0] / size, sense[1] / size, sense[2] / size});
    obs.deviation.push_back(deviation * per_um);
    put_common(obs, *table, row);
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
