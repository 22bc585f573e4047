// SPDX-License-Identifier: Apache-2.0
#include "lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "artefacts.h"
#include "nonio/math/square.h"

namespace nonio::rigid_body {

using math::BudgetLine;
using math::Corner;
using math::RigidLine;

namespace {

bool linear(const Campaign& c, const std::string& name) {
  const Axis* axis = c.machine.axis(name);
  return axis != nullptr && !axis->rotary && coordinate_of(name) < 3;
}

RigidLine::Kind kind_of(const Measurement& m) {
  if (m.kind == "straightness") return RigidLine::Kind::across;
  if (m.kind == "angle") return RigidLine::Kind::angle;
  return m.kind == "step-diagonal" ? RigidLine::Kind::mirror : RigidLine::Kind::along;
}

BudgetLine::Kind budget_kind(RigidLine::Kind kind) {
  if (kind == RigidLine::Kind::across) return BudgetLine::Kind::lateral;
  return kind == RigidLine::Kind::angle ? BudgetLine::Kind::angle : BudgetLine::Kind::length;
}

Corner place_of(const Observations& o, const Measurement& m, std::size_t row) {
  Corner at;
  at.fill(std::numeric_limits<double>::quiet_NaN());
  for (const auto& [axis, position] : m.at)
    if (const std::size_t k = coordinate_of(axis); k < 3) at[k] = position;
  for (const auto& column : o.axes)
    if (const std::size_t k = coordinate_of(column.axis); k < 3 && !column.rotary)
      at[k] = column.position[row];
  return at;
}

int way_of(const Observations& o, std::size_t row) {
  for (const auto& column : o.axes)
    if (column.approach.size() == o.size() && column.approach[row] != 0)
      return column.approach[row] > 0 ? 1 : -1;
  return 1;
}

const Square* square_of(const Campaign& c, const std::string& name) {
  for (const Square& s : c.squares)
    if (s.name == name) return &s;
  return nullptr;
}

bool certified(const Campaign& c, const std::string& name) {
  const Square* square = square_of(c, name);
  return square != nullptr && square->error && square->U;
}

/// The lines of a square that compare its axes, if `m` is one of these lines. The square must be
/// reversed or certified.
std::optional<math::SquareLines> on_square(const Campaign& c, const Measurement& m) {
  if (m.square.empty()) return std::nullopt;
  for (math::SquareLines& s : math::squares_of(c)) {
    const auto all = s.all();
    if (std::none_of(all.begin(), all.end(),
                     [&](std::size_t i) { return c.measurements[i].id == m.id; }))
      continue;
    if (s.whole() && (!s.turned.empty() || certified(c, s.square))) return std::move(s);
  }
  return std::nullopt;
}

struct Reader {
  const AnalysisInput& in;
  Lines& out;
  std::size_t unknowns = 0;
  std::map<std::string, std::size_t> named{};  ///< unknowns of squares (setup and error) by name

  std::size_t unknown(const std::string& name) {
    const auto [at, fresh] = named.try_emplace(name, unknowns);
    if (fresh) ++unknowns;
    return at->second;
  }

  /// On a face of a square, the slope is that of the axis plus the setup, which is common to both
  /// faces. The error of the square is added on the second face, with opposite sign if reversed
  /// (square.h).
  void share_square(const Measurement& m, RigidLine& line) {
    const auto square = on_square(in.campaign, m);
    if (!square) {
      if (!m.square.empty()) out.free_slope.push_back(m.id);
      return;
    }
    const bool first = m.axis == square->first;
    const std::size_t k = coordinate_of(m.axis);
    std::vector<double> way;
    for (const auto& r : line.readings) way.push_back(r.at[k] - line.readings.front().at[k]);
    line.own_slope = false;
    auto turned = way;
    for (double& w : turned) w *= first ? 1.0 : -1.0;
    line.shared.push_back({unknown("set-up " + square->square + " " + square->first + " " +
                                   square->second + (m.square_turned ? " turned" : "")),
                           std::move(turned)});
    if (first) return;
    for (double& w : way) w *= m.square_turned ? -1.0 : 1.0;
    line.shared.push_back({unknown("error " + square->square), std::move(way)});
  }

  void state_squares() {
    for (const Square& square : in.campaign.squares) {
      const auto error = named.find("error " + square.name);
      if (error == named.end() || !certified(in.campaign, square.name)) continue;
      RigidLine line;
      line.kind = RigidLine::Kind::stated;
      line.readings.push_back({{}, {}, 0, *square.error, *square.U / 2.0});
      line.shared.push_back({error->second, {1.0}});
      out.stated.push_back({out.lines.size(), square.name, square.name});
      out.budget.push_back(stated_budget(1, out.lines.size()));
      out.lines.push_back(std::move(line));
      out.measurement_of_line.push_back(0);
    }
  }

  void take(const Measurement& m, const Observations& o) {
    const std::vector<double> times = math::reading_times(o);
    std::vector<std::size_t> order(o.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
    if (m.kind == "step-diagonal" && o.time.empty())  // in order along the beam, not of the rows
      std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const auto when = [&](std::size_t row) {
          const Corner at = place_of(o, m, row);
          double along = 0.0;
          for (std::size_t k = 0; k < 3; ++k) along += at[k] * o.sense_of(row)[k];
          return std::pair(o.run_of(row), along);
        };
        return when(a) < when(b);
      });
    const std::size_t group = out.group_of(m.kind, m.kind == "angle");
    for (std::uint32_t l = 0; l < o.lines.size(); ++l) {
      RigidLine line;
      line.kind = kind_of(m);
      line.group = group;
      if (line.kind == RigidLine::Kind::angle)
        line.of = coordinate_of(m.axis), line.about = coordinate_of(m.lateral);
      for (const std::size_t row : order)
        if (o.line_of(row) == l)
          line.readings.push_back({place_of(o, m, row),
                                   line.kind == RigidLine::Kind::angle ? Corner{} : o.sense_of(row),
                                   way_of(o, row), o.deviation[row]});
      if (line.readings.empty()) continue;
      if (m.kind == "straightness") share_square(m, line);
      out.budget.push_back(budget_line(line));
      out.lines.push_back(std::move(line));
    }
    out.used.push_back(m.id);
    out.tables.push_back(&o);
  }

  BudgetLine budget_line(const RigidLine& line) {
    BudgetLine b;
    b.kind = budget_kind(line.kind);
    b.group = out.lines.size();  // each line has its own setup
    const auto along = [&](const math::RigidReading& r) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        if (std::isfinite(r.at[k])) sum += r.at[k] * r.sense[k];
      return sum;
    };
    double zero = std::numeric_limits<double>::infinity();
    for (const auto& r : line.readings) zero = std::min(zero, along(r));
    for (const auto& r : line.readings) b.length.push_back(along(r) - zero);
    std::vector<std::string> axes;
    std::vector<double> direction;
    for (const Axis& axis : in.campaign.machine.axes)
      if (const std::size_t k = coordinate_of(axis.name); !axis.rotary && k < 3)
        if (const double c = line.readings.front().sense[k]; std::fabs(c) > 1e-9)
          axes.push_back(axis.name), direction.push_back(c);
    if (b.kind == BudgetLine::Kind::length) put_expansion(b, in.campaign, axes, direction);
    return b;
  }
};

void find_box(Lines& out) {
  out.low.fill(std::numeric_limits<double>::infinity());
  out.high.fill(-std::numeric_limits<double>::infinity());
  for (const RigidLine& line : out.lines)
    for (const auto& r : line.readings)
      for (std::size_t k = 0; k < 3 && line.kind != RigidLine::Kind::stated; ++k)
        if (std::isfinite(r.at[k])) {
          out.low[k] = std::min(out.low[k], r.at[k]);
          out.high[k] = std::max(out.high[k], r.at[k]);
        }
  for (std::size_t k = 0; k < 3; ++k)
    if (!(out.low[k] <= out.high[k])) out.low[k] = out.high[k] = 0.0;
}

/// Readings without a stated coordinate are assumed at the center of the volume.
void centre(Lines& out) {
  for (std::size_t l = 0; l < out.lines.size(); ++l) {
    bool any = false;
    for (auto& r : out.lines[l].readings)
      for (std::size_t k = 0; k < 3; ++k)
        if (!std::isfinite(r.at[k])) {
          r.at[k] = (out.low[k] + out.high[k]) / 2.0;
          any |= out.high[k] > out.low[k] && out.lines[l].kind != RigidLine::Kind::angle;
        }
    const std::string& id = out.used[out.measurement_of_line[l]];
    if (any && std::find(out.centred.begin(), out.centred.end(), id) == out.centred.end())
      out.centred.push_back(id);
  }
}

}  // namespace

std::size_t Lines::group_of(const std::string& kind, bool angle) {
  const auto found = std::find(groups.begin(), groups.end(), kind);
  if (found != groups.end()) return static_cast<std::size_t>(found - groups.begin());
  groups.push_back(kind);
  angular.push_back(angle);
  return groups.size() - 1;
}

bool is_taken(const Campaign& c, const Measurement& m) {
  if (m.kind == "artefact") return true;
  if (m.kind == "diagonal" || m.kind == "step-diagonal")
    return std::all_of(m.from.begin(), m.from.end(),
                       [&](const auto& end) { return linear(c, end.first); });
  if (m.kind == "axis") return linear(c, m.axis);
  if (m.kind == "straightness")
    return linear(c, m.axis) && coordinate_of(m.lateral) < 3 && m.reversal_of.empty();
  return m.kind == "angle" && linear(c, m.axis) && coordinate_of(m.lateral) < 3 && !m.foot;
}

bool shows_squareness(const Campaign& c, const Measurement& m) {
  return m.kind == "diagonal" || m.kind == "step-diagonal" || m.kind == "artefact" ||
         on_square(c, m).has_value();
}

Lines lines_of(const AnalysisInput& in) {
  Lines out;
  Reader reader{in, out};
  for (std::size_t i = 0; in.all != nullptr && i < in.all->size(); ++i) {
    const Measurement& m = in.campaign.measurements[i];
    if (!state_of(m).empty() && state_of(m) != state_of(in.measurement)) continue;
    if ((*in.all)[i].size() == 0 || m.kind.starts_with("artefact")) continue;
    if (!is_taken(in.campaign, m)) {
      out.left_out.push_back(m.id);
      continue;
    }
    reader.take(m, (*in.all)[i]);
    out.measurement_of_line.resize(out.lines.size(), out.used.size() - 1);
  }
  if (in.all != nullptr) take_artefacts(in, reader.unknowns, out);
  reader.state_squares();
  find_box(out);
  centre(out);
  return out;
}

}  // namespace nonio::rigid_body
