// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/square.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/distributions.h"
#include "nonio/math/straightness.h"

namespace nonio::math {

namespace {

constexpr std::size_t fewest_stops = 3;
constexpr double as_good_as_normal = 1e6;  ///< degrees of freedom that are practically infinite

/// Name of the squareness of a plane by its axes in alphabetical order, and its sign relative to t.
struct SquarePlane {
  char first, second;
  const char* name;
  double sign;
};
constexpr SquarePlane square_planes[] = {
    {'X', 'Y', "C0Y", -1.0}, {'X', 'Z', "B0Z", 1.0}, {'Y', 'Z', "A0Z", -1.0}};

const SquarePlane* square_plane_of(const Measurement& m) {
  if (m.axis.empty() || m.lateral.empty()) return nullptr;
  for (const SquarePlane& p : square_planes)
    if ((m.axis[0] == p.first && m.lateral[0] == p.second) ||
        (m.axis[0] == p.second && m.lateral[0] == p.first))
      return &p;
  return nullptr;
}

struct SquareFace {
  MeasuredLine line;
  int direction = 0;
  double slope = 0.0;
  std::vector<double> by;  ///< derivatives of the slope by the means
};

tl::expected<SquareFace, NoSquareness> square_face_of(const Observations& o, const Measurement& m) {
  SquareFace f{measured_line(o, 0), 0, 0.0, {}};
  if (f.line.stops.size() < fewest_stops) return tl::unexpected(NoSquareness{"too-few", m.id});
  const auto direction = f.line.direction();
  if (!direction) return tl::unexpected(NoSquareness{"incomplete", m.id});
  f.direction = *direction;
  std::vector<double> x, e;
  for (const auto& stop : f.line.stops)
    x.push_back(stop.position), e.push_back(stop.mean(f.direction));
  const auto fit = straightness_about(StraightLine::least_squares, x, e);
  if (!fit) return tl::unexpected(NoSquareness{"incomplete", m.id});
  f.slope = fit->b;
  f.by = fit->slope_by;
  return f;
}

BudgetLine line_of_face(const SquareFace& f, std::size_t group) {
  BudgetLine line;
  line.kind = BudgetLine::Kind::lateral;
  line.zeroed = f.line.zeroed;
  line.u = f.line.u_mean(f.direction);
  line.dof = static_cast<double>(f.line.dof);
  line.visits = f.line.visits(f.direction);
  line.walk_seen = f.line.walk_seen;
  line.group = group;
  for (const auto& stop : f.line.stops)
    line.length.push_back(stop.position - f.line.stops.front().position);
  return line;
}

/// The angle error of the square is an error of the readings on the second face, which it tilts.
ReadingModel::Input error_of_square(const ReadingModel& model, double U) {
  ReadingModel::Input input;
  input.is = {.id = "square",
              .u = U / 2.0,
              .quantity = Quantity::small_angle,
              .distribution = Distribution::normal,
              .correlation = Correlation::device,
              .source = "square.U_urad"};
  input.of_line.assign(model.lines.size(), 0.0);
  input.of_line[1] = U / 2.0;
  std::vector<double> pattern(model.readings(), 0.0);
  const std::vector<double>& way = model.lines[1].length;
  for (std::size_t i = 0; i < way.size(); ++i)
    pattern[model.lines[0].length.size() + i] = U / 2.0 * way[i];
  input.patterns.push_back(std::move(pattern));
  return input;
}

const Square* square_named(const Campaign& c, const std::string& name) {
  for (const Square& s : c.squares)
    if (s.name == name) return &s;
  return nullptr;
}

}  // namespace

std::vector<std::size_t> SquareLines::all() const {
  std::vector<std::size_t> out = unturned;
  out.insert(out.end(), turned.begin(), turned.end());
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<SquareLines> squares_of(const Campaign& campaign) {
  std::vector<SquareLines> out;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    const SquarePlane* plane =
        m.kind == "straightness" && !m.square.empty() ? square_plane_of(m) : nullptr;
    if (plane == nullptr) continue;
    const bool is_first = m.axis[0] == plane->first;
    const std::string state = state_of(m), &first = is_first ? m.axis : m.lateral,
                      &second = is_first ? m.lateral : m.axis;
    auto at = std::find_if(out.begin(), out.end(), [&](const SquareLines& s) {
      return s.square == m.square && s.state == state && s.first == first && s.second == second;
    });
    if (at == out.end())
      at = out.insert(out.end(), {m.square, state, plane->name, first, second, {}, {}});
    auto& lines = m.square_turned ? at->turned : at->unturned;
    lines.insert(is_first ? lines.begin() : lines.end(), i);
  }
  return out;
}

tl::expected<Squareness, NoSquareness> squareness_of(const Campaign& campaign,
                                                     const std::vector<Observations>& all,
                                                     const SquareLines& s) {
  const Square* square = square_named(campaign, s.square);
  if (!s.whole()) return tl::unexpected(NoSquareness{"one-line", s.square});
  const bool turned = !s.turned.empty();
  if (!turned && (square == nullptr || !square->error))
    return tl::unexpected(NoSquareness{"unknown", s.square});
  std::vector<std::size_t> lines = s.unturned;
  lines.insert(lines.end(), s.turned.begin(), s.turned.end());

  Squareness out;
  std::vector<double> sums{0.0, 0.0}, row;
  std::vector<BudgetLine> budget;
  std::vector<const Observations*> observations;
  const double sign = square_plane_of(campaign.measurements[lines.front()])->sign,
               share = turned ? 0.5 : 1.0;
  double variance = 0.0;
  bool known = true;
  out.dof = INFINITY;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const auto face = square_face_of(all[lines[k]], campaign.measurements[lines[k]]);
    if (!face) return tl::unexpected(face.error());
    sums[k / 2] += face->slope;
    budget.push_back(line_of_face(*face, k));
    observations.push_back(&all[lines[k]]);
    const BudgetLine& line = budget.back();
    known = known && line.dof > 0.0;
    out.dof = std::min(out.dof, line.dof);
    out.largest_u = std::max(out.largest_u, line.u);
    for (std::size_t i = 0; i < face->by.size(); ++i) {
      row.push_back(sign * share * face->by[i]);
      const double u = line.zeroed && i == 0 ? 0.0 : line.u;
      variance += row.back() * row.back() * u * u;
    }
  }
  const HeldLimits limits = limits_held(campaign, observations);
  out.findings = limits.findings;
  out.model = reading_model(campaign, limits.environment, std::move(budget));
  if (turned) {
    out.value = sign * (sums[0] + sums[1]) / 2.0;
    out.of_square = (sums[0] - sums[1]) / 2.0;
  } else {
    out.value = sign * (sums[0] - *square->error);
    if (square->U)
      out.model.inputs.push_back(error_of_square(out.model, *square->U));
    else
      out.model.missing.push_back("square.U_urad");
  }
  out.u = known ? std::sqrt(variance) : 0.0;
  out.shares = out.model.shares(row);
  if (!known) out.dof = 0.0;
  return out;
}

OneQuantity one_quantity(double a, const Expanded& of_a, double b, const Expanded& of_b) {
  const double va = of_a.u * of_a.u, vb = of_b.u * of_b.u, sum = va + vb;
  OneQuantity out;
  out.difference = a - b;
  // Welch-Satterthwaite for the difference, and for the mean with weights vb/sum and va/sum.
  const double dof =
      std::min(as_good_as_normal, sum * sum / (va * va / of_a.dof + vb * vb / of_b.dof));
  out.p = f_upper(out.difference * out.difference / sum, 1.0, dof);
  out.value = (a * vb + b * va) / sum;
  const double u2 = va * vb / sum;
  out.u = std::sqrt(u2);
  const double pa = va * vb * vb / (sum * sum), pb = vb * va * va / (sum * sum);
  out.dof = std::min(as_good_as_normal, u2 * u2 / (pa * pa / of_a.dof + pb * pb / of_b.dof));
  return out;
}

}  // namespace nonio::math
