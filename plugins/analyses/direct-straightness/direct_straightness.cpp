// SPDX-License-Identifier: Apache-2.0
// Straightness of a line of motion, measured directly: with straightness optics, a straightedge and
// its reversal, a taut wire, or by integration of a level or autocollimator.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "nonio/math/budget.h"
#include "nonio/math/distributions.h"
#include "nonio/math/measured_line.h"
#include "nonio/math/straightness.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

namespace nonio::direct_straightness {

namespace {

/// Deviations perpendicular to the line of motion, e = D y, from the means y of one or two
/// measurements.
struct Points {
  std::string name;
  std::vector<double> x, e;             ///< positions and deviations, m
  std::vector<double> artefact;         ///< deviations of the straightedge, m; empty without a
                                        ///< reversal
  std::vector<std::vector<double>> by;  ///< D: one row per point, one column per mean
  std::vector<double> u;                ///< standard uncertainty of each mean by repetition
  double dof = 0.0;                     ///< smallest of the measurements; 0 without repetition
  std::vector<math::BudgetLine> lines;
  std::vector<math::MeasuredLine> measured;  ///< in the order of `lines`
  std::vector<std::string> uses;
  int direction = 0;  ///< direction of approach, +1 or -1; 0 for the mean of
                      ///< both
  bool integrated = false;
};

using PointsOrRefusal = tl::expected<Points, Finding>;

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

/// Component along which a rotation about one axis moves a point on the other axis, by the vector
/// product: {'Y', 1} for +Y. {'?', 0} if the axes are equal or not X, Y, Z.
std::pair<char, double> moved_along(char about, char axis) {
  static constexpr std::string_view order = "XYZ";
  const std::size_t a = order.find(about), b = order.find(axis);
  if (a == order.npos || b == order.npos || a == b) return {'?', 0.0};
  return {order[3 - a - b], (b + 3 - a) % 3 == 1 ? 1.0 : -1.0};
}

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

std::optional<std::size_t> reversal_of(const AnalysisInput& in) {
  const auto& all = in.campaign.measurements;
  for (std::size_t i = 0; in.all != nullptr && i < all.size(); ++i)
    if (all[i].reversal_of == in.measurement.id) return i;
  return std::nullopt;
}

/// The motion is (y1 + y2)/2, the straightedge (y1 - y2)/2. Returns a finding on failure.
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

/// A level or autocollimator whose base is moved in steps of its own length. A reading belongs to
/// the center of the base. The points are the ends of the base at each position.
PointsOrRefusal from_angles(const AnalysisInput& in) {
  const auto side = side_of(in.observations, in.measurement.id);
  if (!side) return tl::unexpected<Finding>(side.error());
  const double foot = *in.measurement.foot;
  const auto& stops = side->line.stops;
  constexpr double slack = 0.01;  // relative to the base: 1 % of the effect of an angle
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

PointsOrRefusal points_of(const AnalysisInput& in) {
  return in.measurement.kind == "angle" ? from_angles(in) : from_lengths(in);
}

std::vector<double> by_means(const Points& p, const std::vector<double>& by_points) {
  std::vector<double> row(p.u.size(), 0.0);
  for (std::size_t i = 0; i < by_points.size(); ++i)
    for (std::size_t k = 0; k < row.size(); ++k) row[k] += by_points[i] * p.by[i][k];
  return row;
}

using math::StraightLine;

bool applies(const Campaign&, const Measurement& m) {
  return m.kind == "straightness" ? m.reversal_of.empty() : m.kind == "angle" && m.foot.has_value();
}

struct Lines {
  math::Straightness least_squares, minimum_zone, end_points;
};

Expected<Lines> lines_of(const Points& p) {
  auto lsq = math::straightness_about(StraightLine::least_squares, p.x, p.e);
  auto zone = math::straightness_about(StraightLine::minimum_zone, p.x, p.e);
  auto ends = math::straightness_about(StraightLine::end_points, p.x, p.e);
  for (const auto* s : {&lsq, &zone, &ends})
    if (!*s) return fail(s->error());
  return Lines{std::move(*lsq), std::move(*zone), std::move(*ends)};
}

class Report {
 public:
  Report(const Points& p, const math::ReadingModel& model, Evaluation& e)
      : p_(p),
        model_(model),
        e_(e),
        known_(p.dof > 0.0),
        budget_(model, *std::max_element(p.u.begin(), p.u.end()), p.dof,
                p.integrated ? Quantity::small_angle : Quantity::deviation) {}

  void value(const char* name, double v, Quantity q, const std::vector<double>& by_points) {
    if (!known_) return e_.values.push_back({name, v, q});
    const auto [u, shares] = of(by_points);
    e_.values.push_back(budget_.value(name, v, q, u, shares));
  }

  /// Noise alone makes a width too large, the more, the more pairs of points compete for it: those
  /// within three standard uncertainties of an end.
  void width(const char* name, const math::Straightness& s) {
    if (!known_) return e_.values.push_back({name, s.width, Quantity::deviation});
    const auto [u, shares] = of(s.width_by);
    const auto near = [&, scatter = 3.0 * u](double end) {
      return static_cast<std::size_t>(std::count_if(
          s.rest.begin(), s.rest.end(), [&](double d) { return std::fabs(d - end) <= scatter; }));
    };
    const auto [low, high] = std::minmax_element(s.rest.begin(), s.rest.end());
    const double of_many = math::factor_of_largest(near(*low) * near(*high), 1e6) / 2.0;
    e_.values.push_back(budget_.value(name, s.width, Quantity::deviation, of_many * u, shares));
  }

  /// The points about the least-squares line: d = (I - H) e, with the hat matrix H.
  void series(const math::Straightness& s, const std::string& axis) {
    Series out{p_.name + "_LSQ", axis, Quantity::length, Quantity::deviation, p_.x, s.rest, {}};
    if (known_) {
      std::vector<double> u;
      std::vector<math::Shares> shares;
      const std::size_t n = p_.x.size();
      double middle = 0.0;
      for (const double x : p_.x) middle += x / static_cast<double>(n);
      for (std::size_t i = 0; i < n; ++i) {
        std::vector<double> row(n);
        for (std::size_t k = 0; k < n; ++k)
          row[k] = (i == k ? 1.0 : 0.0) - 1.0 / static_cast<double>(n) -
                   s.slope_by[k] * (p_.x[i] - middle);
        const auto [u_of, shares_of] = of(row);
        u.push_back(u_of);
        shares.push_back(shares_of);
      }
      budget_.put(out, u, shares);
    }
    e_.series.push_back(std::move(out));
  }

  void close() {
    if (known_ && model_.missing.empty()) e_.budget = budget_.budget();
  }

 private:
  std::pair<double, math::Shares> of(const std::vector<double>& by_points) const {
    const std::vector<double> row = by_means(p_, by_points);
    double square = 0.0;
    for (std::size_t i = 0; i < row.size(); ++i) square += row[i] * row[i] * p_.u[i] * p_.u[i];
    return {std::sqrt(square), model_.shares(row)};
  }

  const Points& p_;
  const math::ReadingModel& model_;
  Evaluation& e_;
  bool known_;
  math::BudgetOf budget_;
};

PointTable table(const Points& p, const Lines& lines) {
  PointTable t;
  t.columns = {{"target", Quantity::length, p.x}, {"mean", Quantity::deviation, p.e}};
  if (p.measured.size() == 1 && !p.integrated && p.direction == 0) {
    PointTable::Column plus{"mean+", Quantity::deviation, {}},
        minus{"mean-", Quantity::deviation, {}};
    for (const auto& stop : p.measured.front().stops)
      plus.values.push_back(stop.plus), minus.values.push_back(stop.minus);
    t.columns.push_back(std::move(plus));
    t.columns.push_back(std::move(minus));
  }
  if (!p.artefact.empty()) t.columns.push_back({"straightedge", Quantity::deviation, p.artefact});
  t.columns.push_back({"about_LSQ", Quantity::deviation, lines.least_squares.rest});
  t.columns.push_back({"about_MZ", Quantity::deviation, lines.minimum_zone.rest});
  t.columns.push_back({"about_ends", Quantity::deviation, lines.end_points.rest});
  return t;
}

std::vector<const Observations*> observations_of(const AnalysisInput& in, const Points& p) {
  std::vector<const Observations*> out{&in.observations};
  for (std::size_t i = 0; in.all != nullptr && i < in.all->size(); ++i)
    if (!p.uses.empty() && in.campaign.measurements[i].id == p.uses.front())
      out.push_back(&(*in.all)[i]);
  return out;
}

void judge_noise(const Points& p, const Lines& lines, Evaluation& e) {
  double most = 0.0;
  for (std::size_t i = 0; i < p.by.size(); ++i) {
    double square = 0.0;
    for (std::size_t k = 0; k < p.u.size(); ++k)
      square += p.by[i][k] * p.by[i][k] * p.u[k] * p.u[k];
    most = std::max(most, std::sqrt(square));
  }
  constexpr double range_of_many = 4.0;  // expected range of 30 normal values is 4 sigma
  if (most == 0.0 || lines.minimum_zone.width > range_of_many * most) return;
  e.findings.push_back(
      {.id = "straightness.noise",
       .evidence = {{"straightness", lines.minimum_zone.width, Quantity::deviation},
                    {"noise", range_of_many * most, Quantity::deviation}}});
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  Evaluation e;
  const auto points = points_of(in);
  if (!points) {
    e.findings.push_back(points.error());
    return e;
  }
  const Points& p = *points;
  NONIO_TRY(const auto lines, lines_of(p));
  e.uses = p.uses;
  const math::HeldLimits limits = math::limits_held(in.campaign, observations_of(in, p));
  const math::ReadingModel model = math::reading_model(in.campaign, limits.environment, p.lines);
  e.findings.insert(e.findings.end(), limits.findings.begin(), limits.findings.end());
  if (!model.missing.empty()) e.findings.push_back(math::missing_finding(model.missing));
  if (p.dof == 0.0) e.findings.push_back({.id = "straightness.no-uncertainty", .attention = true});
  Report report(p, model, e);
  report.width("straightness_MZ", lines.minimum_zone);
  report.width("straightness_LSQ", lines.least_squares);
  report.width("straightness_ends", lines.end_points);
  report.value("slope", lines.least_squares.b, Quantity::small_angle, lines.least_squares.slope_by);
  report.series(lines.least_squares, in.measurement.axis);
  report.close();
  e.points = table(p, lines);
  judge_noise(p, lines, e);
  e.notes.push_back({p.integrated         ? "method.straightness-angles"
                     : p.artefact.empty() ? "method.straightness"
                                          : "method.straightness-reversal",
                     {},
                     {{"name", p.name}}});
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"direct-straightness", "1.0.0",
            "Straightness of a line of motion about three reference straight lines."};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::direct_straightness
