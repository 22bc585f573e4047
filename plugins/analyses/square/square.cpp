// SPDX-License-Identifier: Apache-2.0
// Squareness of two axes measured against the two faces of one square.
#include "nonio/math/square.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "nonio/math/distributions.h"
#include "nonio/sdk/plugin.h"

namespace nonio::square {

namespace {

constexpr double level = 0.01;

std::optional<math::SquareLines> led_by(const Campaign& campaign, const Measurement& m) {
  for (math::SquareLines& s : math::squares_of(campaign))
    if (campaign.measurements[s.all().front()].id == m.id) return std::move(s);
  return std::nullopt;
}

bool applies(const Campaign& campaign, const Measurement& m) {
  return !m.square.empty() && led_by(campaign, m).has_value();
}

void judge_certificate(const AnalysisInput& in, const math::SquareLines& lines, double found,
                       const math::Expanded& e, Evaluation& out) {
  for (const Square& square : in.campaign.squares) {
    if (square.name != lines.square || !square.error || !square.U || !e.U) continue;
    const math::OneQuantity one =
        math::one_quantity(found, e, *square.error, {.u = *square.U / 2.0, .U = {}});
    if (!math::significant(one.p, level)) continue;
    out.findings.push_back({.id = "square.certificate",
                            .attention = true,
                            .evidence = {{"found", found, Quantity::small_angle},
                                         {"U", *e.U, Quantity::small_angle},
                                         {"stated", *square.error, Quantity::small_angle},
                                         {"U_stated", *square.U, Quantity::small_angle}},
                            .texts = {{"square", lines.square}}});
  }
}

/// Compares the results of all placements and states for the same plane and square. The first
/// placement with a result reports the comparison.
void compare_placements(const AnalysisInput& in, const math::SquareLines& own, double U_square,
                        Evaluation& out) {
  std::vector<double> values;
  double u = 0.0;
  for (const math::SquareLines& s : math::squares_of(in.campaign)) {
    if (s.square != own.square || s.first != own.first || s.second != own.second) continue;
    const auto one = math::squareness_of(in.campaign, *in.all, s);
    if (!one) continue;
    if (values.empty() && s.all() != own.all()) return;
    values.push_back(one->value);
    u = std::max(u, one->u);
  }
  if (values.size() < 2) return;
  const auto n = static_cast<double>(values.size());
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  out.findings.push_back(
      {.id = "square.placements",
       .attention = *high - *low > std::max(4.0 * u, U_square),
       .evidence = {{"count", n, Quantity::count},
                    {"low", *low, Quantity::small_angle},
                    {"high", *high, Quantity::small_angle},
                    {"range", *high - *low, Quantity::small_angle},
                    {"mean", mean, Quantity::small_angle},
                    {"s", std::sqrt(squares / (n - 1.0)), Quantity::small_angle}},
       .texts = {{"name", own.name}, {"square", own.square}}});
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  if (in.all == nullptr) return fail("expected the other measurements of the campaign, found none");
  const auto lines = led_by(in.campaign, in.measurement);
  if (!lines) return fail("this line belongs to the square of another one");
  Evaluation e;
  for (const std::size_t i : lines->all())
    if (in.campaign.measurements[i].id != in.measurement.id)
      e.uses.push_back(in.campaign.measurements[i].id);
  auto s = math::squareness_of(in.campaign, *in.all, *lines);
  if (!s) {
    e.findings.push_back(
        {.id = "square." + s.error().why,
         .attention = true,
         .texts = {
             {"which", s.error().which}, {"first", lines->first}, {"second", lines->second}}});
    return e;
  }
  e.findings = std::move(s->findings);
  if (!s->model.missing.empty()) e.findings.push_back(math::missing_finding(s->model.missing));
  double U_square = 0.0;
  for (const Square& square : in.campaign.squares)
    if (square.name == lines->square) U_square = square.U.value_or(0.0);
  compare_placements(in, *lines, U_square, e);
  const std::string name = lines->name + "_LSQ";
  e.notes.push_back({s->of_square ? "method.square-turned" : "method.square",
                     {},
                     {{"name", lines->name}, {"square", lines->square}}});
  if (s->dof == 0.0) {
    e.findings.push_back({.id = "square.no-uncertainty", .attention = true});
    e.values.push_back({name, s->value, Quantity::small_angle});
    if (s->of_square) e.values.push_back({"square_error", *s->of_square, Quantity::small_angle});
    return e;
  }
  math::BudgetOf budget(s->model, s->largest_u, s->dof, Quantity::deviation);
  e.values.push_back(budget.value(name, s->value, Quantity::small_angle, s->u, s->shares));
  if (s->of_square) {
    e.values.push_back(
        budget.value("square_error", *s->of_square, Quantity::small_angle, s->u, s->shares));
    judge_certificate(in, *lines, *s->of_square, budget.expand(s->u, s->shares), e);
  }
  if (s->model.missing.empty()) e.budget = budget.budget();
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"square", "1.0.0", "Squareness of two axes read against the two faces of one square."};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::square
