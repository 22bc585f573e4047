// SPDX-License-Identifier: Apache-2.0
#include "passes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "nonio/math/axis_test.h"
#include "nonio/math/statistics.h"

namespace nonio::step_diagonal {
namespace {

constexpr double same_place = 1e-6;  // tolerance of positions, relative to the travel
constexpr std::string_view letters = "XYZ";

Number count(const char* name, std::size_t n) {
  return {name, static_cast<double>(n), Quantity::count};
}

/// One line of the observations, with its positions as numbers of moves of each axis.
struct Line {
  std::string name;
  std::array<int, 3> sign{};
  std::vector<std::size_t> rows;
  std::size_t n = 0;
  std::vector<std::array<std::size_t, 3>> moves;
};

Expected<void> place(Passes& p, const AnalysisInput& in) {
  const Observations& o = in.observations;
  if (o.axes.size() != 3) return fail("expected step diagonals over three axes");
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string& axis = o.axes[k].axis;
    const auto from = in.measurement.from.find(axis), to = in.measurement.to.find(axis);
    if (from == in.measurement.from.end() || to == in.measurement.to.end())
      return fail("expected `from` and `to` of axis " + axis + ", found none");
    p.axes.push_back(axis);
    p.readings.low[k] = std::min(from->second, to->second);
    p.readings.travel[k] = std::fabs(to->second - from->second);
  }
  return {};
}

std::size_t steps_of(const Passes& p, const Observations& o, const Line& line) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double> at;
    for (const std::size_t row : line.rows) at.push_back(o.axes[k].position[row]);
    std::sort(at.begin(), at.end());
    double gap = p.readings.travel[k];
    for (std::size_t i = 1; i < at.size(); ++i)
      if (at[i] - at[i - 1] > same_place * p.readings.travel[k])
        gap = std::min(gap, at[i] - at[i - 1]);
    n = std::max(n, static_cast<std::size_t>(std::llround(p.readings.travel[k] / gap)));
  }
  return n;
}

std::optional<std::size_t> count_moves(const Passes& p, const Observations& o, Line& line) {
  line.n = steps_of(p, o, line);
  for (const std::size_t row : line.rows) {
    std::array<std::size_t, 3> moves{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double travel = p.readings.travel[k];
      const double start = p.readings.low[k] + (line.sign[k] > 0 ? 0.0 : travel);
      const double steps =
          line.sign[k] * (o.axes[k].position[row] - start) / travel * static_cast<double>(line.n);
      if (!(std::fabs(steps - std::round(steps)) < 1e-3) || !(steps > -0.5) ||
          !(steps < static_cast<double>(line.n) + 0.5))
        return row;
      moves[k] = static_cast<std::size_t>(std::llround(steps));
    }
    if (moves[0] + moves[1] + moves[2] == 0) return row;
    line.moves.push_back(moves);
  }
  return std::nullopt;
}

std::vector<Line> lines_of(const Observations& o) {
  std::vector<Line> lines(o.lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    lines[i].name = o.lines[i].name;
    for (std::size_t k = 0; k < 3; ++k) lines[i].sign[k] = o.lines[i].sense[k] < 0.0 ? -1 : 1;
  }
  for (std::size_t row = 0; row < o.size(); ++row)
    lines[o.line.empty() ? 0 : o.line[row]].rows.push_back(row);
  return lines;
}

std::size_t in_order(const Line& line, const std::array<std::size_t, 3>& order) {
  math::StepDiagonals d;
  d.order = order;
  const auto broken = std::find_if(line.moves.begin(), line.moves.end(), [&](const auto& m) {
    return d.counts(m[0] + m[1] + m[2]) != m;
  });
  return static_cast<std::size_t>(broken - line.moves.begin());
}

std::string words(const std::array<std::size_t, 3>& order) {
  std::string out;
  for (const std::size_t k : order) out += letters[k];
  return out;
}

std::array<std::size_t, 3> order_of(const Line& line) {
  std::array<std::size_t, 3> order{0, 1, 2}, best = order;
  do
    if (in_order(line, order) > in_order(line, best)) best = order;
  while (std::next_permutation(order.begin(), order.end()));
  return best;
}

std::string place_of(const AnalysisInput& in, std::size_t row) {
  const auto& lines = in.observations.source_line;
  return in.measurement.file + (row < lines.size() ? ":" + std::to_string(lines[row]) : "");
}

Finding refused(const char* id, std::vector<Number> evidence,
                std::vector<std::pair<std::string, std::string>> texts) {
  return {.id = id, .attention = true, .evidence = std::move(evidence), .texts = std::move(texts)};
}

void refuse_order(Passes& p, const AnalysisInput& in, const std::vector<Line>& lines) {
  std::optional<std::array<std::size_t, 3>> first;
  for (const Line& line : lines) {
    if (first && in_order(line, *first) == line.moves.size()) continue;
    const auto order = order_of(line);
    const std::size_t kept = in_order(line, order);
    if (kept < line.moves.size())
      return p.refusal.push_back(
          refused("step-diagonal.order-broken", {},
                  {{"pass", line.name}, {"at", place_of(in, line.rows[kept])}}));
    if (first)
      return p.refusal.push_back(
          refused("step-diagonal.order-differs", {},
                  {{"pass", line.name},
                   {"order", words(order)},
                   {"first", words(*first)},
                   {"at", place_of(in, line.rows[in_order(line, *first)])}}));
    first = order;
  }
  if (first) p.readings.order = *first;
}

void refuse_missing(Passes& p, const std::vector<Line>& lines) {
  static constexpr std::array<std::pair<const char*, std::pair<int, int>>, 4> four{
      {{"PPP", {1, 1}}, {"NPP", {-1, -1}}, {"PNP", {-1, 1}}, {"PPN", {1, -1}}}};
  std::string missing;
  std::size_t found = 0;
  for (const auto& corner : four) {
    const bool there = std::any_of(lines.begin(), lines.end(), [&](const Line& l) {
      return std::pair(l.sign[0] * l.sign[1], l.sign[0] * l.sign[2]) == corner.second;
    });
    found += there ? 1 : 0;
    if (!there) missing += std::string(missing.empty() ? "" : ", ") + corner.first;
  }
  if (found < 4)
    p.refusal.push_back(refused("step-diagonal.too-few-diagonals", {count("found", found)},
                                {{"missing", missing}}));
}

void refuse_steps(Passes& p, const AnalysisInput& in, std::vector<Line>& lines) {
  for (Line& line : lines) {
    const auto uneven = count_moves(p, in.observations, line);
    if (!uneven && line.n == lines.front().n) continue;
    return p.refusal.push_back(refused(
        "step-diagonal.unequal-steps", {count("steps", line.n), count("first", lines.front().n)},
        {{"pass", line.name}, {"at", place_of(in, uneven.value_or(line.rows.front()))}}));
  }
  const std::size_t n = lines.front().n;
  if (n < 3 || n > math::most_diagonal_steps)
    p.refusal.push_back(refused("step-diagonal.steps",
                                {count("steps", n), count("most", math::most_diagonal_steps)}, {}));
  p.readings.n = n;
}

}  // namespace

Expected<Passes> passes_of(const AnalysisInput& in) {
  Passes p;
  const Observations& o = in.observations;
  if (auto placed = place(p, in); !placed) return fail(placed.error());
  std::vector<Line> lines = lines_of(o);
  lines.erase(
      std::remove_if(lines.begin(), lines.end(), [](const Line& l) { return l.rows.empty(); }),
      lines.end());
  refuse_missing(p, lines);
  if (lines.empty()) return p;
  refuse_steps(p, in, lines);
  if (p.refusal.empty()) refuse_order(p, in, lines);
  if (!p.refusal.empty()) return p;
  for (const Line& line : lines) {
    math::StepDiagonals::Pass pass{line.sign, std::vector<double>(3 * line.n, std::nan(""))};
    for (std::size_t i = 0; i < line.rows.size(); ++i) {
      const auto& m = line.moves[i];
      pass.reading[m[0] + m[1] + m[2] - 1] = o.deviation[line.rows[i]];
    }
    p.readings.passes.push_back(std::move(pass));
    p.names.push_back(line.name);
  }
  return p;
}

namespace {

double mean_of(std::span<const math::AxisTest::Reading> readings) {
  double sum = 0.0;
  for (const auto& r : readings) sum += r.deviation;
  return sum / static_cast<double>(readings.size());
}

math::AxisSeries series_of(const math::AxisTest& test, const std::vector<double>& times,
                           std::size_t axis) {
  math::AxisSeries s{axis, {}, {}, 0.0, {}};
  double squares = 0.0, dof = 0.0, share = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    double sum = 0.0, sides = 0.0, inverse = 0.0;
    for (const auto& readings : {test.plus(i), test.minus(i)}) {
      if (readings.empty()) continue;
      const double mean = mean_of(readings), n = static_cast<double>(readings.size());
      for (const auto& r : readings) squares += (r.deviation - mean) * (r.deviation - mean);
      dof += n - 1.0;
      sum += mean;
      sides += 1.0;
      inverse += 1.0 / n;
    }
    if (sides == 0.0 || (test.bidirectional() && sides < 2.0)) continue;
    for (const auto& readings : {test.plus(i), test.minus(i)})
      for (const auto& r : readings)
        s.visits.push_back({times[r.row], s.position.size(),
                            1.0 / (sides * static_cast<double>(readings.size()))});
    s.position.push_back(test.targets[i]);
    s.deviation.push_back(sum / sides);
    share += inverse / (sides * sides);
  }
  std::sort(s.visits.begin(), s.visits.end(),
            [](const auto& a, const auto& b) { return a.time < b.time; });
  if (dof > 0.0 && !s.position.empty())
    s.u = std::sqrt(squares / dof * share / static_cast<double>(s.position.size()));
  return s;
}

bool wanted(const AnalysisInput& in, const Measurement& m) {
  const auto ids = in.options.texts("lengths");
  if (!ids.empty()) return std::find(ids.begin(), ids.end(), m.id) != ids.end();
  return state_of(m) == state_of(in.measurement);
}

}  // namespace

Lengths lengths_of(const AnalysisInput& in, const Passes& passes) {
  Lengths out;
  if (in.all == nullptr) return out;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < in.all->size(); ++i) {
      const Measurement& m = in.campaign.measurements[i];
      if (m.kind == "axis" && m.axis == passes.axes[k] && (*in.all)[i].size() > 0 && wanted(in, m))
        candidates.push_back(i);
    }
    if (candidates.size() > 1)
      out.findings.push_back(refused("step-diagonal.lengths-ambiguous",
                                     {count("measurements", candidates.size())},
                                     {{"axis", passes.axes[k]}}));
    if (candidates.size() != 1) continue;
    const Observations& o = (*in.all)[candidates[0]];
    math::AxisSeries series = series_of(math::AxisTest::arrange(o), math::reading_times(o), k);
    if (series.position.size() < 2) continue;
    out.series.push_back(std::move(series));
    out.ids.push_back(in.campaign.measurements[candidates[0]].id);
  }
  return out;
}

std::vector<math::BudgetLine> budget_lines(const Passes& p, const Lengths& lengths,
                                           const Campaign& campaign) {
  const math::StepDiagonals& d = p.readings;
  std::vector<math::BudgetLine> lines;
  const std::array<double, 3> cosines{d.travel[0] / d.diagonal(), d.travel[1] / d.diagonal(),
                                      d.travel[2] / d.diagonal()};
  for (std::size_t k = 0; k < d.passes.size(); ++k) {
    math::BudgetLine line;
    line.zeroed = true;
    line.group = k;
    // A random walk also contributes to the scatter of increments: 1/(3 n) = 2 u^2.
    line.walk_seen = 1.0 / (6.0 * static_cast<double>(d.n));
    for (std::size_t t = 0; t <= 3 * d.n; ++t) {
      const auto moves = d.counts(t);
      double along = 0.0;
      for (std::size_t a = 0; a < 3; ++a)
        along +=
            cosines[a] * d.travel[a] * static_cast<double>(moves[a]) / static_cast<double>(d.n);
      line.length.push_back(along);
    }
    put_expansion(line, campaign, p.axes, cosines);
    lines.push_back(std::move(line));
  }
  for (const math::AxisSeries& s : lengths.series) {
    math::BudgetLine line;
    line.group = lines.size();
    line.in_residuals = false;  // the scatter is estimated from the passes
    line.visits = s.visits;
    for (const double x : s.position) line.length.push_back(x - s.position.front());
    const double whole = 1.0;
    put_expansion(line, campaign, {&p.axes[s.axis], 1}, {&whole, 1});
    lines.push_back(std::move(line));
  }
  return lines;
}

namespace {

using Vector3 = std::array<double, 3>;

double triple(const Vector3& a, const Vector3& b, const Vector3& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Readings of a pass if the carriage of `axis` rotates about e_w by a = shape(-1..1) over its
/// travel. The beam starts at P in direction u. The center R of rotation is at the position of the
/// axes that carry `axis`, and in the middle of those that it carries. Reading: a w.(u x (R - P))
/// minus its first value.
std::vector<double> turned(const math::StepDiagonals& d, const math::StepDiagonals::Pass& pass,
                           std::size_t axis, std::size_t w, double (*shape)(double)) {
  Vector3 u{}, start{}, about{};
  about[w] = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] = pass.sign[k] * d.travel[k] / d.diagonal();
    start[k] = pass.sign[k] > 0 ? 0.0 : d.travel[k];
  }
  std::vector<double> out;
  for (std::size_t t = 0; t <= 3 * d.n; ++t) {
    const auto moves = d.counts(t);
    Vector3 arm{};
    double part = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double way = static_cast<double>(moves[k]) / static_cast<double>(d.n),
                   at = pass.sign[k] > 0 ? way : 1.0 - way;
      arm[k] = (k > axis ? d.travel[k] / 2.0 : at * d.travel[k]) - start[k];
      if (k == axis) part = 2.0 * at - 1.0;
    }
    out.push_back(shape(part) * triple(about, u, arm));
  }
  const double zero = out.front();
  for (double& reading : out) reading -= zero;
  return out;
}

}  // namespace

math::ReadingModel::Input angles_input(const Passes& p, const math::ReadingModel& model,
                                       double angle) {
  const double u = angle / std::sqrt(6.0);
  math::ReadingModel::Input input;
  input.is = {.id = "angles",
              .with_length = true,
              .distribution = Distribution::normal,  // because several shapes are mixed
              .correlation = Correlation::device,
              .source = "options.step-diagonal.angle_urad"};
  input.of_line.assign(model.lines.size(), u);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::size_t w : {(axis + 1) % 3, (axis + 2) % 3})
      for (double (*shape)(double) :
           {+[](double a) { return a; }, +[](double a) { return 2.0 * a * a - 1.0; }}) {
        std::vector<double> pattern;
        for (const auto& pass : p.readings.passes)
          for (const double one : turned(p.readings, pass, axis, w, shape)) {
            pattern.push_back(u * one);
            input.is.u = std::max(input.is.u, std::fabs(pattern.back()));
          }
        pattern.resize(model.readings(), 0.0);  // lengths are measured at mid-travel
        input.patterns.push_back(std::move(pattern));
      }
  return input;
}

std::vector<const Observations*> observations_of(const AnalysisInput& in, const Lengths& lengths) {
  std::vector<const Observations*> out{&in.observations};
  for (std::size_t i = 0; in.all != nullptr && i < in.all->size(); ++i)
    if (std::find(lengths.ids.begin(), lengths.ids.end(), in.campaign.measurements[i].id) !=
        lengths.ids.end())
      out.push_back(&(*in.all)[i]);
  return out;
}

}  // namespace nonio::step_diagonal
