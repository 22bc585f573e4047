// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/differences.h"

#include <algorithm>

#include "nonio/math/budget.h"

namespace nonio::math {

namespace {

/// The model has two consecutive readings for each value.
ReadingModel model_of(const Campaign& campaign, const std::vector<Difference>& all, bool is_tilt) {
  std::vector<BudgetLine> lines;
  double largest = 0.0;
  for (const Difference& d : all) {
    BudgetLine line;
    line.kind = is_tilt ? BudgetLine::Kind::angle : BudgetLine::Kind::lateral;
    line.length = {d.length, d.length};
    lines.push_back(std::move(line));
    if (d.scale != 0.0) largest = std::max({largest, std::fabs(d.from), std::fabs(d.to)});
  }
  Environment environment = campaign.environment;
  environment.drift = environment.drift_angle = 0.0;
  ReadingModel model = reading_model(campaign, environment, std::move(lines));
  for (auto& input : model.inputs) {
    const bool gain = input.is.id == "device-fixed" || input.is.id == "device-angle";
    if (!gain && input.is.id != "device-length") continue;
    std::vector<double> pattern;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Difference& d = all[i];
      const double u = gain ? input.is.u : input.of_line[i];
      pattern.push_back(gain && largest > 0.0 ? u * d.from / largest : 0.0);
      pattern.push_back(!gain ? u * d.length : largest > 0.0 ? u * d.to / largest : 0.0);
    }
    input.is.correlation = Correlation::device;
    input.patterns = {std::move(pattern)};
  }
  return model;
}

void put_ball(const Campaign& campaign, const std::vector<Difference>& all, ReadingModel& model) {
  const bool any =
      std::any_of(all.begin(), all.end(), [](const Difference& d) { return d.with_ball; });
  if (!any || !campaign.instrument.sphere) return;
  const double u = *campaign.instrument.sphere / std::sqrt(3.0);
  ReadingModel::Input input;
  input.is = {.id = "sphere",
              .u = u,
              .distribution = Distribution::rectangular,
              .correlation = Correlation::device,
              .source = "instrument.sphere_um"};
  std::vector<double> pattern;
  for (const Difference& d : all) {
    input.of_line.push_back(d.with_ball ? u : 0.0);
    pattern.push_back(0.0), pattern.push_back(d.with_ball ? u : 0.0);
  }
  input.patterns = {std::move(pattern)};
  model.inputs.push_back(std::move(input));
}

}  // namespace

void put_differences(const Campaign& campaign, const std::vector<Difference>& all,
                     Evaluation& out) {
  if (all.empty()) return;
  const bool is_tilt = std::any_of(all.begin(), all.end(), [](const Difference& d) {
    return d.quantity == Quantity::angular_deviation;
  });
  const Quantity q = deviation_of(is_tilt);
  ReadingModel model = model_of(campaign, all, is_tilt);
  put_ball(campaign, all, model);
  ReadingModel without = model;  // for values that contain a ball with unknown form error
  bool ball_missing = false;
  double most = 0.0;
  for (const Difference& d : all) {
    if (d.quantity == q) most = std::max(most, d.u);
    ball_missing = ball_missing || (d.with_ball && !campaign.instrument.sphere);
  }
  if (ball_missing) without.missing.emplace_back("instrument.sphere_um");
  BudgetOf budget(model, most, INFINITY, q), unknown(without, most, INFINITY, q);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Difference& d = all[i];
    if (!(d.dof > 0.0)) {
      out.values.push_back({d.name, d.value, d.quantity});
      continue;
    }
    std::vector<double> row(2 * all.size(), 0.0);
    row[2 * i] = -d.scale, row[2 * i + 1] = d.scale;
    Shares shares = model.shares(row);
    shares.dof = d.dof;
    const bool no_ball = d.with_ball && !campaign.instrument.sphere;
    out.values.push_back(
        (no_ball ? unknown : budget).value(d.name, d.value, d.quantity, d.u, shares));
  }
  if (!without.missing.empty()) out.findings.push_back(missing_finding(without.missing));
  if (model.missing.empty() && !budget.budget().results.empty()) out.budget = budget.budget();
}

std::optional<Finding> dead_sensor(const std::string& name, std::span<const double> readings,
                                   Quantity of) {
  const auto differs = [&](double d) { return d != readings.front(); };
  if (readings.size() < 4 || std::any_of(readings.begin(), readings.end(), differs)) return {};
  return Finding{.id = "sensor.refused-equal",
                 .attention = true,
                 .evidence = {{"readings", static_cast<double>(readings.size()), Quantity::count},
                              {"value", readings.front(), of}},
                 .texts = {{"sensor", name}}};
}

}  // namespace nonio::math
