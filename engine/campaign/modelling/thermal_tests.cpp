// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/thermal_tests.h"

#include <cmath>

#include "nonio/sdk/axis_readings.h"
#include "platform/storage/nearest.h"

namespace nonio::modelling {

namespace {

Number minutes(const char* name, double s) { return {name, s / 60.0, Quantity::number}; }

const model::Term* asks(const PartModel& part, const std::string& axis) {
  for (const auto* list : {&part.terms, &part.catalogue})
    for (const model::Term& term : *list)
      if (term.axis.name == axis && model::time_constant_shape(*term.effect)) return &term;
  return nullptr;
}

const model::Parameter* fitted_tau(const model::Fit& fit, const model::Term& asked,
                                   const model::Term*& term) {
  for (const model::Term& t : fit.terms)
    if (t.name() == asked.name()) term = &t;
  for (const model::Parameter& p : fit.parameters)
    if (p.effect == asked.name() && p.shape && p.name == "tau") return &p;
  return nullptr;
}

Finding own_value(const model::TimeConstant& stated, const model::Parameter& tau, Finding f) {
  const double apart = std::fabs(std::log(tau.value / stated.tau));
  const double u = std::hypot(tau.u / tau.value, stated.u / stated.tau);
  const bool differs = !std::isfinite(u) || apart > model::time_constants_apart * u;
  f.id = differs ? "model.time-constant-differs" : "model.time-constant-own";
  f.attention = differs;
  f.evidence.push_back(minutes("own_min", tau.value));
  if (std::isfinite(tau.u)) f.evidence.push_back(minutes("u_own_min", tau.u));
  return f;
}

Finding not_usable(const PartModel& part, const model::Term& asked, Finding f) {
  const auto readings = readings_of(part.part.table, asked.axis);
  if (!readings || !readings->timed) {
    f.id = "model.time-constant-untimed";
    return f;
  }
  f.id = "model.time-constant-outside";
  f.evidence.push_back(minutes("duration_min", readings->duration));
  return f;
}

const char* why_left(const model::ChannelLeft& left) {
  using Why = model::ChannelLeft::Why;
  switch (left.why) {
    case Why::partly:
      return "channel-left.partly";
    case Why::untimed:
      return "channel-left.untimed";
    case Why::speed:
      return "channel-left.speed";
    case Why::frozen:
      return "channel-left.frozen";
    case Why::start_value:
      return "channel-left.start-value";
    case Why::start_values_dropped:
      return "channel-left.start-values-dropped";
    case Why::spikes_dropped:
      break;
  }
  return "channel-left.spikes-dropped";
}

}  // namespace

std::vector<Finding> channel_findings(const PartModel& part) {
  std::vector<Finding> out;
  for (const model::ChannelLeft& left : part.part.channels_left)
    out.push_back(
        {.id = why_left(left),
         .evidence = {{"value", left.value, Quantity::temperature},
                      {"from", left.from, Quantity::time},
                      {"to", left.to, Quantity::time},
                      {"count", static_cast<double>(left.readings), Quantity::count}},
         .texts = {{"channel", left.name}, {"measurements", storage::listed(left.measurements)}}});
  return out;
}

std::vector<Finding> restart_findings(const PartModel& part, const model::Fit& fit) {
  std::vector<Finding> out;
  for (const model::Restart& one : part.part.restarts) {
    const double gap = one.to - one.from;
    Finding f{.id = one.is_gap() ? "restart.gap" : "restart.jump",
              .evidence = {{"from", one.from, Quantity::time},
                           {"to", one.to, Quantity::time},
                           {"jump", one.jump, part.deviation()},
                           minutes("gap_min", gap)},
              .texts = {{"displacement", one.displacement}}};
    const model::Parameter* longest = nullptr;
    for (const model::Parameter& p : fit.parameters)
      if (p.shape && p.quantity == Quantity::time && p.value < gap &&
          (longest == nullptr || p.value > longest->value))
        longest = &p;
    if (one.is_gap() && longest != nullptr && longest->value > 0.0) {
      f.id = "restart.long-gap";
      f.evidence.push_back(minutes("tau_min", longest->value));
      f.texts.emplace_back("effect", longest->effect);
    }
    out.push_back(std::move(f));
  }
  return out;
}

std::vector<Finding> time_constant_findings(const PartModel& part, const model::Fit& fit) {
  using State = model::TimeConstant::State;
  std::vector<Finding> out;
  for (const model::TimeConstant& one : part.part.time_constants) {
    const model::Term* const asked = asks(part, one.axis);
    if (asked == nullptr) continue;
    Finding f{.id = "model.time-constant-used",
              .attention = false,
              .texts = {{"effect", asked->name()},
                        {"axis", one.axis},
                        {"measurements", storage::listed(one.measurements)}}};
    if (one.state != State::known) {
      f.id = one.state == State::none ? "model.time-constant-none"
                                      : "model.time-constant-contradictory";
      f.attention = one.state == State::contradictory;
      out.push_back(std::move(f));
      continue;
    }
    f.evidence = {minutes("tau_min", one.tau), minutes("u_min", one.u)};
    const model::Term* term = asked;
    const model::Parameter* const tau = fitted_tau(fit, *asked, term);
    if (!asked->stated)
      f = not_usable(part, *asked, std::move(f));
    else if (tau != nullptr && !model::has_stated(*term))
      f = own_value(one, *tau, std::move(f));
    out.push_back(std::move(f));
  }
  return out;
}

}  // namespace nonio::modelling
