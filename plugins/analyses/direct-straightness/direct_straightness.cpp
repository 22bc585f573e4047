// SPDX-License-Identifier: Apache-2.0
//
// Straightness of a line of motion, measured by itself: with straightness optics, a straightedge and
// its reversal, a taut wire, or a level or autocollimator by integration.
#include <cmath>

#include "nonio/math/budget.h"
#include "nonio/math/straightness.h"
#include "points.h"

namespace nonio::direct_straightness {

namespace {

using math::StraightLine;

bool applies(const Campaign&, const Measurement& m) {
  return m.kind == "straightness" ? m.reversal_of.empty() : m.kind == "angle" && m.foot.has_value();
}

/// The three lines, and what is said of them.
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

/// Results with their uncertainty, where the readings have a repetition.
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

  /// The points about the least-squares line: d = (I - H) e.
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

/// The scatter alone makes points look as crooked: what stands then for the value.
void judge_noise(const Points& p, const Lines& lines, Evaluation& e) {
  double most = 0.0;
  for (std::size_t i = 0; i < p.by.size(); ++i) {
    double square = 0.0;
    for (std::size_t k = 0; k < p.u.size(); ++k)
      square += p.by[i][k] * p.by[i][k] * p.u[k] * p.u[k];
    most = std::max(most, std::sqrt(square));
  }
  constexpr double range_of_many = 4.0;  // expected range of 30 normal values, in units of sigma
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
  const auto lines = lines_of(p);
  if (!lines) return fail(lines.error());
  e.uses = p.uses;
  const math::HeldLimits limits = math::limits_held(in.campaign, observations_of(in, p));
  const math::ReadingModel model = math::reading_model(in.campaign, limits.environment, p.lines);
  e.findings.insert(e.findings.end(), limits.findings.begin(), limits.findings.end());
  if (!model.missing.empty()) e.findings.push_back(math::missing_finding(model.missing));
  if (p.dof == 0.0) e.findings.push_back({.id = "straightness.no-uncertainty", .attention = true});
  Report report(p, model, e);
  report.value("straightness_MZ", lines->minimum_zone.width, Quantity::deviation,
               lines->minimum_zone.width_by);
  report.value("straightness_LSQ", lines->least_squares.width, Quantity::deviation,
               lines->least_squares.width_by);
  report.value("straightness_ends", lines->end_points.width, Quantity::deviation,
               lines->end_points.width_by);
  report.value("slope", lines->least_squares.b, Quantity::small_angle,
               lines->least_squares.slope_by);
  report.series(lines->least_squares, in.measurement.axis);
  report.close();
  e.points = table(p, *lines);
  judge_noise(p, *lines, e);
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
