// SPDX-License-Identifier: Apache-2.0
// Squareness and straightness of two axes from the diagonals of their rectangle.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "nonio/math/budget.h"
#include "nonio/math/diagonals.h"
#include "nonio/math/distributions.h"
#include "nonio/math/square.h"
#include "sets.h"

namespace nonio::diagonal_straightness {

namespace {

using math::BudgetLine;
using math::MeanCurve;

class Lines {
 public:
  Lines(const Collected& c, const Campaign& campaign) : c_(c), r_(c.readings), in_(campaign) {}

  std::vector<BudgetLine> all() {
    const double step_x = r_.Lx / static_cast<double>(r_.n),
                 step_y = r_.Ly / static_cast<double>(r_.n);
    for (const math::PitchLine& y : r_.Y) put(along(y, step_y), 0, {0.0, 1.0});
    std::size_t group = 1;
    for (std::size_t k = 0; k < r_.X.size(); ++k) {
      if (k > 0 && r_.X[k].across != r_.X[k - 1].across) ++group;
      put(along(r_.X[k], step_x), group, {1.0, 0.0});
    }
    ++group;
    for (const MeanCurve& yaw : r_.ECX)
      put_other(along(yaw, step_x), BudgetLine::Kind::angle, group);
    for (const math::GridLine* line : lines()) {
      BudgetLine of = begin(*line);
      for (std::size_t j = 0; j < line->ix.size(); ++j)
        of.length.push_back(std::hypot(step_x * (number(line->ix[j]) - number(line->ix[0])),
                                       step_y * (number(line->iy[j]) - number(line->iy[0]))));
      put(std::move(of), ++group, {line->cx, line->cy});
    }
    for (const auto& [direct, step] : {std::pair{&r_.EYX, step_x}, std::pair{&r_.EXY, step_y}})
      if (*direct) {
        put_other(along(**direct, step), BudgetLine::Kind::lateral, ++group);
        if (const auto& turned = (*direct)->reversed)
          put_other(along(*turned, step), BudgetLine::Kind::lateral, ++group);
      }
    // If one curve has no repetition, the noise is estimated from the residuals of all curves.
    if (std::any_of(out_.begin(), out_.end(), [](const BudgetLine& l) { return l.u == 0.0; }))
      for (BudgetLine& line : out_) line.u = 0.0;
    return std::move(out_);
  }

 private:
  static double number(std::size_t i) { return static_cast<double>(i); }
  std::vector<const math::GridLine*> lines() const {
    std::vector<const math::GridLine*> all{&r_.D1, &r_.D2};
    for (const math::GridLine& line : r_.third) all.push_back(&line);
    return all;
  }
  static BudgetLine begin(const MeanCurve& curve) {
    BudgetLine line;
    line.zeroed = curve.zeroed;
    line.u = curve.u;
    line.dof = curve.dof;
    line.visits = curve.visits;
    line.walk_seen = curve.walk_seen;
    return line;
  }
  static BudgetLine along(const MeanCurve& curve, double step) {
    BudgetLine line = begin(curve);
    for (std::size_t i = 0; i < curve.mean.size(); ++i) line.length.push_back(step * number(i));
    return line;
  }
  void put(BudgetLine line, std::size_t group, const std::array<double, 2>& direction) {
    line.group = group;
    const std::array<std::string, 2> axes{c_.x_axis, c_.y_axis};
    std::vector<std::string> moved;
    std::vector<double> share;
    for (std::size_t k = 0; k < 2; ++k)
      if (direction[k] != 0.0) moved.push_back(axes[k]), share.push_back(direction[k]);
    put_expansion(line, in_, moved, share);
    out_.push_back(std::move(line));
  }
  void put_other(BudgetLine line, BudgetLine::Kind kind, std::size_t group) {
    line.kind = kind;
    line.group = group;
    out_.push_back(std::move(line));
  }

  const Collected& c_;
  const math::DiagonalReadings& r_;
  const Campaign& in_;
  std::vector<BudgetLine> out_;
};

std::vector<BudgetLine> budget_lines(const Collected& c, const Campaign& campaign) {
  return Lines(c, campaign).all();
}

std::vector<const Observations*> observations_of(const AnalysisInput& in,
                                                 const std::vector<std::string>& uses) {
  std::vector<const Observations*> out{&in.observations};
  for (std::size_t i = 0; i < in.all->size(); ++i)
    if (std::find(uses.begin(), uses.end(), in.campaign.measurements[i].id) != uses.end())
      out.push_back(&(*in.all)[i]);
  return out;
}

constexpr double um = 1e-6;
constexpr std::size_t enough_dof = 10;

bool applies(const Campaign& campaign, const Measurement& m) {
  return m.kind == "diagonal" && set_led_by(sets_of(campaign), campaign, m) != nullptr;
}

class Report {
 public:
  Report(const AnalysisInput& in, const Collected& c, const math::DiagonalResult& r,
         const math::ReadingModel& model, const Set& set, Evaluation& e)
      : in_(in),
        c_(c),
        set_(set),
        r_(r),
        e_(e),
        known_(r.noise_known || r.dof >= enough_dof),
        complete_(model.missing.empty()),
        budget_(model, noise(), r.noise_known ? c.readings.D1.dof : static_cast<double>(r.dof),
                Quantity::deviation, source(in)) {}

  void fill(bool first_set) {
    add_points();
    value("S_n", r_.closure.S_n, Quantity::deviation);
    value("S_odd", r_.closure.S_odd, Quantity::deviation);
    check_reversal();
    if (!known_)
      e_.findings.push_back({.id = "diagonals.no-uncertainty",
                             .attention = true,
                             .evidence = {{"dof", static_cast<double>(r_.dof), Quantity::count}}});
    if (!r_.closure.passed()) return refuse_closure();
    const double gain = math::diagonal_gain(c_.readings.Lx, c_.readings.Ly),
                 most = in_.options.number("largest_gain");
    if (!(gain <= most)) {
      e_.findings.push_back(
          {.id = "diagonals.flat",
           .attention = true,
           .evidence = {{"gain", gain, Quantity::ratio}, {"limit", most, Quantity::ratio}}});
      add_squareness();
      return compare_squares();
    }
    add_squareness();
    compare_squares();
    add_yaw();
    if (r_.separable())
      add_both();
    else
      add_parts();
    if (complete_)
      compare(r_.EYX_agrees, c_.x_axis, "EYX"), compare(r_.EXY_agrees, c_.y_axis, "EXY");
    if (!first_set) e_.findings.push_back({.id = "diagonals.remeasured"});
    if (known_ && budget_.budget().missing.empty()) e_.budget = budget_.budget();
  }

 private:
  static std::string source(const AnalysisInput& in) {
    return in.options.number("reading_u_um") > 0.0 ? "options.diagonal-straightness.reading_u_um"
                                                   : "readings";
  }
  double noise() const {
    if (!r_.noise_known) return r_.residual_u;
    double most = std::max(c_.readings.D1.u, c_.readings.D2.u);
    for (const auto* curves : {&c_.readings.X, &c_.readings.Y})
      for (const math::PitchLine& line : *curves) most = std::max(most, line.u);
    return most;
  }

  void value(const char* name, double v, Quantity q) { e_.values.push_back({name, v, q}); }
  void value(const char* name, double v, Quantity q, double u, const math::Shares& shares) {
    if (!known_) return value(name, v, q);
    e_.values.push_back(budget_.value(name, v, q, u, shares));
  }

  std::vector<double> positions(const std::string& axis) const {
    const bool x = axis == c_.x_axis;
    const double from = x ? c_.x0 : c_.y0, length = x ? c_.readings.Lx : c_.readings.Ly;
    const std::size_t n = c_.readings.n;
    std::vector<double> out;
    for (std::size_t i = 0; i <= n; ++i)
      out.push_back(from + length * static_cast<double>(i) / static_cast<double>(n));
    return out;
  }

  void series(const char* name, const std::string& axis, const math::KnownCurve& c,
              Quantity q = Quantity::deviation) {
    series(name, axis, c.value, c, q);
  }
  void series(const char* name, const std::string& axis, const std::vector<double>& v,
              const math::KnownCurve& c, Quantity q = Quantity::deviation) {
    if (v.empty()) return;
    Series s{name, axis, Quantity::length, q, positions(axis), v, {}};
    if (known_ && !c.u.empty()) budget_.put(s, c.u, c.shares);
    e_.series.push_back(std::move(s));
  }

  void add_points() {
    const auto& r = c_.readings;
    const double L = std::hypot(r.Lx, r.Ly);
    PointTable::Column target{"target", Quantity::length, {}};
    PointTable::Column D1{"D1", Quantity::deviation, {}}, D2{"D2", Quantity::deviation, {}};
    for (std::size_t i = 0; i <= r.n; ++i) {
      target.values.push_back(L * static_cast<double>(i) / static_cast<double>(r.n));
      D1.values.push_back(r.D1.mean[i] - r.D1.mean[0]);
      D2.values.push_back(r.D2.mean[i] - r.D2.mean[0]);
    }
    e_.points.columns = {std::move(target),
                         std::move(D1),
                         std::move(D2),
                         {"D1_less_pitch", Quantity::deviation, r_.d1},
                         {"D2_less_pitch", Quantity::deviation, r_.d2}};
  }

  void add_squareness() {
    value("C0Y", r_.C0Y, Quantity::small_angle, r_.u_C0Y, r_.shares_C0Y);
    e_.values.back().followed = {"squareness:XY", "XY"};
    value("C0Y_LSQ", r_.lsq.C0Y, Quantity::small_angle, r_.lsq.u_C0Y, r_.lsq.shares_C0Y);
    if (r_.slave_shift) {
      math::Shares shares = r_.shares_C0Y;
      for (auto* parts : {&shares.u, &shares.in_residuals, &shares.rectangular})
        for (double& u : *parts) u *= c_.sides_apart;
      value("slave_shift", *r_.slave_shift, Quantity::deviation, c_.sides_apart * r_.u_C0Y, shares);
    }
    if (r_.racking) add_racking(*r_.racking);
  }

  /// The expected range of many noise values is 4 standard deviations; u is that of a difference of
  /// two.
  void add_racking(const math::DiagonalResult::Racking& racking) {
    value("racking", racking.value, Quantity::deviation, racking.u, racking.shares);
    const double noise = 4.0 / std::numbers::sqrt2 * racking.u;
    if (known_ && racking.value <= noise)
      e_.findings.push_back({.id = "diagonals.racking-noise",
                             .evidence = {{"racking", racking.value, Quantity::deviation},
                                          {"noise", noise, Quantity::deviation}}});
  }

  void add_yaw() {
    const std::string &axis = c_.mirrored ? c_.y_axis : c_.x_axis,
                      name = c_.mirrored ? "ECY" : "ECX";
    series(name.c_str(), axis, r_.ECX, Quantity::small_angle);
    const auto& yaw = r_.ECX.value;
    if (yaw.empty()) return;
    const double sum = std::accumulate(yaw.begin(), yaw.end(), 0.0);
    e_.notes.push_back({"method.squareness-place",
                        {{"mean", sum / static_cast<double>(yaw.size()), Quantity::small_angle}},
                        {{"axis", axis}, {"yaw", name}}});
  }

  void add_both() {
    series("EYX", c_.x_axis, r_.EYX);
    series("EXY", c_.y_axis, r_.EXY);
    series("EYX_LSQ", c_.x_axis, r_.lsq.EYX);
    series("EXY_LSQ", c_.y_axis, r_.lsq.EXY);
    value("gain_EYX", r_.EYX.gain, Quantity::ratio);
    value("gain_EXY", r_.EXY.gain, Quantity::ratio);
  }

  void add_parts() {
    series("EYX_even", c_.x_axis, r_.EYX_even);
    series("EXY_even", c_.y_axis, r_.EXY_even);
    series("q_odd", c_.x_axis, r_.q_odd);
    value("gain_EYX_even", r_.EYX_even.gain, Quantity::ratio);
    value("gain_EXY_even", r_.EXY_even.gain, Quantity::ratio);
    value("gain_q_odd", r_.q_odd.gain, Quantity::ratio);
    const auto& r = c_.readings;
    const double bound = in_.options.number("EXY_odd_bound_um") * um;
    Finding f{.id = bound > 0.0 ? "diagonals.not-separable-band" : "diagonals.not-separable",
              .attention = true,
              .evidence = {{"numbers", static_cast<double>(r_.nullity()), Quantity::count},
                           {"q_max", largest(r_.q_odd.value), Quantity::deviation}},
              .texts = {{"x", c_.x_axis}, {"y", c_.y_axis}}};
    if (bound > 0.0) {
      const math::Band band = math::straightness_band(r_, r.Lx, r.Ly, bound);
      series("EYX_low", c_.x_axis, band.low, r_.EYX_even);
      series("EYX_high", c_.x_axis, band.high, r_.EYX_even);
      f.evidence.push_back({"bound", bound, Quantity::deviation});
      f.evidence.push_back({"half_width", bound * r.Lx / r.Ly, Quantity::deviation});
    }
    e_.findings.push_back(std::move(f));
  }

  void compare_squares() {
    constexpr double level = 0.01;
    if (!known_ || !complete_) return;
    for (const math::SquareLines& lines : math::squares_of(in_.campaign)) {
      if (lines.first != c_.x_axis || lines.second != c_.y_axis) continue;
      if (lines.state != set_.name && !lines.state.empty()) continue;
      const auto s = math::squareness_of(in_.campaign, *in_.all, lines);
      if (!s || s->dof == 0.0 || !s->model.missing.empty()) continue;
      const math::BudgetOf of_square(s->model, s->largest_u, s->dof, Quantity::deviation);
      const math::Expanded a = budget_.expand(r_.lsq.u_C0Y, r_.lsq.shares_C0Y),
                           b = of_square.expand(s->u, s->shares);
      const math::OneQuantity one = math::one_quantity(r_.lsq.C0Y, a, s->value, b);
      const bool differs = math::significant(one.p, level);
      for (const std::size_t i : lines.all()) use(in_.campaign.measurements[i].id);
      if (!differs) {
        const double k = math::coverage_factor(one.dof);
        e_.values.push_back({"C0Y_both", one.value, Quantity::small_angle, k * one.u, k, {}});
      }
      e_.findings.push_back(
          {.id = differs ? "diagonals.squareness-disagrees" : "diagonals.squareness-agrees",
           .attention = differs,
           .evidence = {{"diagonals", r_.lsq.C0Y, Quantity::small_angle},
                        {"U_diagonals", *a.U, Quantity::small_angle},
                        {"square", s->value, Quantity::small_angle},
                        {"U_square", *b.U, Quantity::small_angle},
                        {"p", one.p, Quantity::probability}},
           .texts = {{"name", lines.square}}});
      return;
    }
  }
  void use(const std::string& id) {
    if (std::find(e_.uses.begin(), e_.uses.end(), id) == e_.uses.end()) e_.uses.push_back(id);
  }

  void compare(const std::optional<math::Agreement>& a, const std::string& axis,
               const char* curve) {
    constexpr double level = 0.01;
    if (!a || !known_) return;
    const bool differs = math::significant(a->p, level);
    e_.findings.push_back(
        {.id = differs ? "diagonals.straightness-disagrees" : "diagonals.straightness-agrees",
         .attention = differs,
         .evidence = {{"difference", a->difference[a->worst - 1], Quantity::deviation},
                      {"u", a->u[a->worst - 1], Quantity::deviation},
                      {"at", positions(axis)[a->worst], Quantity::length},
                      {"mirrored", positions(axis)[c_.readings.n - a->worst], Quantity::length},
                      {"p", a->p, Quantity::probability}},
         .texts = {{"curve", curve}, {"axis", axis}}});
  }

  static double largest(const std::vector<double>& v) {
    double most = 0.0;
    for (const double x : v) most = std::max(most, std::fabs(x));
    return most;
  }

  void refuse_closure() {
    e_.findings.push_back(
        {.id = "diagonals.closure",
         .attention = true,
         .evidence = {{"S_n", r_.closure.S_n, Quantity::deviation},
                      {"S_n_limit", r_.closure.S_n_limit, Quantity::deviation},
                      {"S_odd", r_.closure.S_odd, Quantity::deviation},
                      {"S_odd_limit", r_.closure.S_odd_limit, Quantity::deviation}}});
  }

  void check_reversal() {
    const double differ = c_.reversal_of_diagonals - c_.reversal_of_axes;
    if (!(c_.u_reversal > 0.0) || std::fabs(differ) <= 4.0 * c_.u_reversal) return;
    e_.findings.push_back(
        {.id = "diagonals.reversal",
         .attention = true,
         .evidence = {{"diagonals", c_.reversal_of_diagonals, Quantity::deviation},
                      {"axes", c_.reversal_of_axes, Quantity::deviation}}});
  }

  const AnalysisInput& in_;
  const Collected& c_;
  const Set& set_;
  const math::DiagonalResult& r_;
  Evaluation& e_;
  bool known_;
  bool complete_;
  math::BudgetOf budget_;
};

Expected<Evaluation> analyse(const AnalysisInput& in) {
  if (in.all == nullptr) return fail("expected the other measurements of the campaign, found none");
  const auto sets = sets_of(in.campaign);
  const Set* set = set_led_by(sets, in.campaign, in.measurement);
  if (set == nullptr) return fail("this diagonal belongs to another one's set");
  Evaluation e;
  for (const std::size_t i : set->lines)
    if (in.campaign.measurements[i].id != in.measurement.id)
      e.uses.push_back(in.campaign.measurements[i].id);
  auto collected = collect(in, sets, *set);
  if (!collected) {
    e.findings.push_back(collected.error());
    return e;
  }
  for (const std::string& id : collected->uses)
    if (std::find(e.uses.begin(), e.uses.end(), id) == e.uses.end()) e.uses.push_back(id);
  e.findings = collected->findings;
  const math::HeldLimits limits = math::limits_held(in.campaign, observations_of(in, e.uses));
  const math::ReadingModel model =
      math::reading_model(in.campaign, limits.environment, budget_lines(*collected, in.campaign));
  e.findings.insert(e.findings.end(), limits.findings.begin(), limits.findings.end());
  if (!model.missing.empty()) e.findings.push_back(math::missing_finding(model.missing));
  NONIO_TRY(auto solved, math::solve_diagonals(collected->readings, &model));
  if (collected->mirrored) turn_back(*collected, solved);
  Report(in, *collected, solved, model, *set, e).fill(set == &sets.front());
  return e;
}

std::vector<Option> options() {
  return {
      {"EXY_odd_bound_um",
       0.0,
       "um",
       "Largest size of the odd part of EXY that is known from elsewhere; 0: not known.",
       {},
       0.0,
       {}},
      one_of({"odd", "whole"}, {"direct_straightness", std::string("odd"), "",
                                "Which part of a directly measured straightness is used: the 'odd' "
                                "part or the 'whole'."}),
      at_least(0.7, {"largest_gain", 3.0, "",
                     "Largest noise gain 1/(2 min(c, s)); above it no straightness."}),
      at_least(0.0, {"reading_u_um", 0.0, "um",
                     "Standard uncertainty of every mean; 0: from the scatter of the readings."}),
      at_least(
          0.0,
          {"yaw_u_urad", 0.0, "urad",
           "Standard uncertainty of every mean of a yaw read for itself; 0: from the scatter."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"diagonal-straightness", "1.0.0",
            "Squareness and straightness of two axes from the diagonals of their rectangle.",
            options()};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::diagonal_straightness
