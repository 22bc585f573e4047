// SPDX-License-Identifier: Apache-2.0
// Periodic error of an axis from a dense run over two or more periods of its screw or scale.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nonio/math/differences.h"
#include "nonio/math/fine_motion.h"
#include "nonio/math/thermal.h"

namespace nonio::periodic_error {
namespace {

using math::Difference;
using math::Pass;
using math::PeriodicError;

/// Rotary axes are excluded because their budget needs the uncertainty of another instrument.
bool applies(const Campaign& c, const Measurement& m) {
  if (m.kind != "axis") return false;
  const Axis* axis = c.machine.axis(m.axis);
  return axis == nullptr || !axis->rotary;
}

struct Sides {
  std::vector<Pass> plus, minus;
};

Sides passes_of(const Observations& o) {
  std::map<std::pair<std::uint32_t, int>, std::vector<std::pair<double, double>>> rows;
  const auto& axis = o.axes.front();
  for (std::size_t i = 0; i < o.size(); ++i)
    if (axis.approach[i] != 0 && std::isfinite(o.deviation[i]))
      rows[{o.run_of(i), axis.approach[i]}].emplace_back(axis.position[i], o.deviation[i]);
  Sides out;
  for (auto& [key, pass] : rows) {
    std::sort(pass.begin(), pass.end());
    Pass& p = (key.second > 0 ? out.plus : out.minus).emplace_back();
    for (const auto& [x, d] : pass) p.position.push_back(x), p.deviation.push_back(d);
  }
  return out;
}

double period_of(const AnalysisInput& in) {
  if (const double asked = in.options.number("period_mm", 0.0); asked > 0.0) return asked * 1e-3;
  const Axis* axis = in.campaign.machine.axis(in.measurement.axis);
  return axis != nullptr ? axis->screw_pitch.value_or(0.0) : 0.0;
}

class Worker {
 public:
  Worker(const AnalysisInput& in, double period) : in_(in), period_(period) {}

  void side(const std::vector<Pass>& passes, const char* sign) {
    if (passes.empty()) return;
    const PeriodicError e = math::periodic_error(passes, period_);
    using Answer = PeriodicError::Answer;
    if (e.answer != Answer::given) return refuse(e, sign);
    const auto [low, high] = std::minmax_element(e.folded.begin(), e.folded.end());
    const double excess = math::range_excess(e.folded, e.u_folded);
    put(std::string("periodic") + sign, e.range,
        std::sqrt(2.0 * e.u_folded * e.u_folded + excess * excess / 3.0), e.dof, *low, *high);
    for (std::size_t k = 0; k < e.harmonics.size(); ++k) {
      const auto& wave = e.harmonics[k];
      const std::string number = std::to_string(k + 1);
      put("periodic_2c" + number + sign, 2.0 * wave.amplitude, 2.0 * wave.u, e.dof, -wave.amplitude,
          wave.amplitude);
      out_.values.push_back(
          {"periodic_at" + number + sign,
           wave.phase / (2.0 * std::numbers::pi) * period_ / static_cast<double>(k + 1),
           Quantity::length});
    }
    curve(e, sign);
  }

  Evaluation done() {
    math::put_differences(in_.campaign, items_, out_);
    for (Value& v : positions_) out_.values.push_back(std::move(v));
    out_.notes.push_back({"method.periodic-error", {{"period", period_, Quantity::length}}});
    return std::move(out_);
  }

 private:
  void put(std::string name, double value, double u, double dof, double from, double to) {
    items_.push_back({.name = std::move(name),
                      .value = value,
                      .quantity = Quantity::deviation,
                      .u = u,
                      .dof = dof,
                      .from = from,
                      .to = to,
                      .scale = 1.0});
  }

  void refuse(const PeriodicError& e, const char* sign) {
    const bool is_short = e.answer != PeriodicError::Answer::too_coarse;
    out_.findings.push_back(
        {.id = is_short ? "periodic-error.too-short" : "periodic-error.too-coarse",
         .attention = true,
         .evidence = {{"periods", e.periods, Quantity::number},
                      {"step", e.step, Quantity::length},
                      {"period", period_, Quantity::length}},
         .texts = {{"direction", sign}}});
  }

  void curve(const PeriodicError& e, const char* sign) {
    Series s{std::string("folded") + sign,
             in_.measurement.axis,
             Quantity::length,
             Quantity::deviation,
             {},
             {},
             {}};
    for (std::size_t i = 0; i < e.folded.size(); ++i) {
      s.position.push_back(period_ * static_cast<double>(i) / static_cast<double>(e.folded.size()));
      s.value.push_back(e.folded[i]);
    }
    out_.series.push_back(std::move(s));
  }

  const AnalysisInput& in_;
  double period_;
  std::vector<Difference> items_;
  std::vector<Value> positions_;
  Evaluation out_;
};

Expected<Evaluation> analyse(const AnalysisInput& in) {
  const Observations& o = in.observations;
  if (o.axes.empty() || o.axes.front().approach.size() != o.size())
    return fail("measurement \"" + in.measurement.id + "\": expected directions of approach");
  const double period = period_of(in);
  if (!(period > 0.0)) {
    Evaluation e;
    e.findings.push_back({.id = "periodic-error.no-period",
                          .attention = true,
                          .texts = {{"axis", in.measurement.axis}}});
    return e;
  }
  const Sides sides = passes_of(o);
  Worker worker(in, period);
  worker.side(sides.plus, "+");
  worker.side(sides.minus, "-");
  return worker.done();
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {
      "periodic-error",
      "1.0.0",
      "Periodic error of a linear axis from a dense run over two periods or more.",
      {within(0.0, 1e5,
              {"period_mm", 0.0, "mm", "Period; 0: the axis's screw_pitch_mm of the manifest."})},
      true};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::periodic_error
