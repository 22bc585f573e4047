// SPDX-License-Identifier: Apache-2.0
#include "points.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/straightness.h"

namespace nonio::direct_straightness {

namespace {

using Text = std::pair<std::string, std::string>;
constexpr std::size_t fewest = 3;

tl::unexpected<Finding> refuse(std::string id, std::vector<Number> evidence,
                               std::vector<Text> texts = {}) {
  return tl::unexpected<Finding>(Finding{.id = "straightness." + std::move(id),
                                         .attention = true,
                                         .evidence = std::move(evidence),
                                         .texts = std::move(texts)});
}

char letter(const std::string& axis) { return axis.empty() ? '?' : axis[0]; }

/// Component along which a turn about one axis moves a point that lies along the other: the vector
/// product of their directions. "+Y", "-Z".
std::pair<char, double> moved_along(char about, char axis) {
  static constexpr std::string_view order = "XYZ";
  const std::size_t a = order.find(about), b = order.find(axis);
  if (a == order.npos || b == order.npos || a == b) return {'?', 0.0};
  return {order[3 - a - b], (b + 3 - a) % 3 == 1 ? 1.0 : -1.0};
}

/// One measurement: its means at the stops.
struct Side {
  math::MeasuredLine line;
  int direction = 0;
};

tl::expected<Side, Finding> side_of(const Observations& o, const std::string& id) {
  Side s{math::measured_line(o, 0), 0};
  const std::size_t least = o.angular ? fewest - 1 : fewest;
  if (s.line.stops.size() < least)
    return refuse("too-few",
                  {{"stops", static_cast<double>(s.line.stops.size()), Quantity::count},
                   {"least", static_cast<double>(least), Quantity::count}},
                  {{"which", id}});
  const auto direction = s.line.direction();
  const auto& stops = s.line.stops;
  const auto from = [](int d) {
    return [d](const math::MeasuredLine::Stop& p) { return (d > 0 ? p.n_plus : p.n_minus) > 0; };
  };
  const bool both = std::any_of(stops.begin(), stops.end(), from(1)) &&
                    std::any_of(stops.begin(), stops.end(), from(-1));
  if (!direction || (both && *direction != 0)) {
    const auto at = std::find_if(stops.begin(), stops.end(),
                                 [](const auto& p) { return p.n_plus == 0 || p.n_minus == 0; });
    return refuse("incomplete", {{"at", at->position, Quantity::length}}, {{"which", id}});
  }
  s.direction = *direction;
  return s;
}

void put_side(Points& p, const Side& s, math::BudgetLine::Kind kind) {
  math::BudgetLine line;
  line.kind = kind;
  line.zeroed = s.line.zeroed;
  line.u = s.line.u_mean(s.direction);
  line.dof = static_cast<double>(s.line.dof);
  line.visits = s.line.visits(s.direction);
  line.walk_seen = s.line.walk_seen;
  line.group = p.lines.size();
  for (const auto& stop : s.line.stops) {
    line.length.push_back(stop.position - s.line.stops.front().position);
    p.u.push_back(line.zeroed && line.length.size() == 1 ? 0.0 : line.u);
  }
  p.dof = p.lines.empty() ? line.dof : std::min(p.dof, line.dof);
  p.measured.push_back(s.line);
  p.lines.push_back(std::move(line));
}

/// The measurement with the straightedge turned over, if there is one.
std::optional<std::size_t> reversal_of(const AnalysisInput& in) {
  const auto& all = in.campaign.measurements;
  for (std::size_t i = 0; in.all != nullptr && i < all.size(); ++i)
    if (all[i].reversal_of == in.measurement.id) return i;
  return std::nullopt;
}

/// e = (y1 + y2)/2; of the straightedge (y1 - y2)/2.
std::optional<Finding> reverse(Points& p, const AnalysisInput& in, std::size_t other,
                               const Side& first) {
  const std::string& id = in.campaign.measurements[other].id;
  const Observations& o = (*in.all)[other];
  if (o.size() == 0) return refuse("no-reversal", {}, {{"which", id}}).value();
  const auto second = side_of(o, id);
  if (!second) return second.error();
  const auto &one = first.line.stops, &two = second->line.stops;
  for (std::size_t i = 0; i < std::max(one.size(), two.size()); ++i)
    if (i >= one.size() || i >= two.size() ||
        std::fabs(one[i].position - two[i].position) > math::same_stop) {
      const auto& longer = i < one.size() ? one : two;
      return refuse("reversal-stops", {{"at", longer[i].position, Quantity::length}},
                    {{"which", id}})
          .value();
    }
  put_side(p, *second, math::BudgetLine::Kind::lateral);
  p.uses.push_back(id);
  const std::size_t n = one.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double a = one[i].mean(first.direction), b = two[i].mean(second->direction);
    p.e[i] = (a + b) / 2.0;
    p.artefact.push_back((a - b) / 2.0);
    p.by[i].assign(2 * n, 0.0);
    p.by[i][i] = p.by[i][n + i] = 0.5;
  }
  return std::nullopt;
}

PointsOrRefusal from_lengths(const AnalysisInput& in) {
  const auto side = side_of(in.observations, in.measurement.id);
  if (!side) return tl::unexpected<Finding>(side.error());
  Points p;
  p.name = {'E', letter(in.measurement.lateral), letter(in.measurement.axis)};
  p.direction = side->direction;
  const std::size_t n = side->line.stops.size();
  for (std::size_t i = 0; i < n; ++i) {
    p.x.push_back(side->line.stops[i].position);
    p.e.push_back(side->line.stops[i].mean(side->direction));
    p.by.emplace_back(n, 0.0).at(i) = 1.0;
  }
  put_side(p, *side, math::BudgetLine::Kind::lateral);
  if (const auto other = reversal_of(in))
    if (auto refused = reverse(p, in, *other, *side)) return tl::unexpected<Finding>(*refused);
  return p;
}

/// A level or autocollimator whose foot was moved by its own length. The reading belongs to the
/// middle of the foot; the points are the ends of its places.
PointsOrRefusal from_angles(const AnalysisInput& in) {
  const auto side = side_of(in.observations, in.measurement.id);
  if (!side) return tl::unexpected<Finding>(side.error());
  const double foot = *in.measurement.foot;
  const auto& stops = side->line.stops;
  constexpr double slack = 0.01;  // of the foot: 1 % of an angle's effect
  for (std::size_t i = 1; i < stops.size(); ++i)
    if (std::fabs(stops[i].position - stops[i - 1].position - foot) > slack * foot)
      return refuse("foot", {{"foot", foot, Quantity::length},
                             {"step", stops[i].position - stops[i - 1].position, Quantity::length},
                             {"at", stops[i - 1].position, Quantity::length}});
  const auto [lateral, sign] =
      moved_along(letter(in.measurement.lateral), letter(in.measurement.axis));
  Points p;
  p.name = {'E', lateral, letter(in.measurement.axis)};
  p.direction = side->direction;
  p.integrated = true;
  std::vector<double> angles;
  for (const auto& stop : stops) angles.push_back(sign * stop.mean(side->direction));
  p.e = math::integrated(angles, foot);
  for (std::size_t i = 0; i <= stops.size(); ++i) {
    p.x.push_back(stops.front().position + foot * (static_cast<double>(i) - 0.5));
    std::vector<double>& row = p.by.emplace_back(stops.size(), 0.0);
    std::fill(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(i), sign * foot);
  }
  put_side(p, *side, math::BudgetLine::Kind::angle);
  return p;
}

}  // namespace

PointsOrRefusal points_of(const AnalysisInput& in) {
  return in.measurement.kind == "angle" ? from_angles(in) : from_lengths(in);
}

std::vector<double> by_means(const Points& p, const std::vector<double>& by_points) {
  std::vector<double> row(p.u.size(), 0.0);
  for (std::size_t i = 0; i < by_points.size(); ++i)
    for (std::size_t k = 0; k < row.size(); ++k) row[k] += by_points[i] * p.by[i][k];
  return row;
}

}  // namespace nonio::direct_straightness
