// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/followed.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/followed.h"
#include "nonio/sdk/format.h"

namespace nonio::evaluation {

namespace {

/// Identifies instrument and calibration; empty without a serial number.
std::string instrument_source(const Instrument& i) {
  if (i.serial.empty()) return {};
  std::string out = "instrument";
  for (const std::string& part : {i.maker, i.model, i.serial, i.certificate, i.calibrated})
    if (!part.empty()) out += ' ' + part;
  return out;
}

std::string found_or_left(const Measurement& m) {
  return m.adjustment == "after" ? "as-left" : "as-found";
}

std::string compensation_of(const Machine& machine, const Measurement& m) {
  if (!m.compensation.empty()) return m.compensation;
  const Axis* axis = machine.axis(m.axis);
  if (axis == nullptr || !axis->active_table) return {};
  return axis->active_table->empty() ? "off" : "on";
}

std::optional<double> mean_temperature(const Observations& o) {
  double sum = 0.0, n = 0.0;
  for (const double t : o.material)
    if (std::isfinite(t)) sum += t, n += 1.0;
  return n > 0.0 ? std::optional(sum / n) : std::nullopt;
}

/// Without a source, the square of `u` is added to `variance`, the part that is new in each
/// campaign.
void put_common(FollowedQuantity& to, double& variance, const std::string& source, double u) {
  if (u == 0.0) return;
  if (source.empty())
    variance += u * u;
  else
    to.common.push_back({source, u});
}

void put_conditions(FollowedQuantity& to, const math::AxisTest& test, const Campaign& campaign,
                    const Measurement& m) {
  const Quantity position = test.rotary ? Quantity::angle : Quantity::length;
  to.numbers = {{"from", printed(test.targets.front(), position)},
                {"to", printed(test.targets.back(), position)}};
  if (const std::string on = compensation_of(campaign.machine, m); !on.empty())
    to.texts.emplace_back("compensation", on);
  if (!m.at.empty()) to.texts.emplace_back("at", positions_text(m.at));
  if (!m.lateral.empty()) to.texts.emplace_back("across", m.lateral);
}

std::optional<FollowedGroup> of_axis(const reading::ReadCampaign& read, std::size_t index) {
  const Campaign& campaign = read.manifest->campaign;
  const Measurement& m = campaign.measurements[index];
  const Observations& o = read.observations[index];
  const bool across = m.kind == "straightness";
  if ((m.kind != "axis" && !across) || o.size() == 0 || o.axes.empty()) return std::nullopt;
  const math::AxisTest test = math::AxisTest::arrange(o);
  const math::FollowedAxis found = math::followed_quantities(
      test, campaign, m.axis, mean_temperature(o), across ? math::Across::yes : math::Across::no);
  if (found.quantities.empty()) return std::nullopt;
  FollowedGroup out{{}, found.covariance, compared_targets(test, found.other_targets)};
  const std::size_t n = found.quantities.size();
  for (std::size_t i = 0; i < n; ++i) {
    const math::Followed& f = found.quantities[i];
    FollowedQuantity q{.measurement = m.id,
                       .axis = control_axis(campaign.machine, m),
                       .name = across ? "straightness:" + m.lateral + '.' + f.name : f.name,
                       .value = f.value,
                       .quantity = f.quantity};
    double& variance = out.covariance[i * n + i];
    put_common(q, variance, instrument_source(campaign.instrument), f.of_instrument);
    put_common(q, variance, "expansion of axis " + m.axis, f.of_expansion);
    q.u = std::sqrt(variance);
    q.state = found_or_left(m);
    put_conditions(q, test, campaign, m);
    const Axis* axis = campaign.machine.axis(m.axis);
    if (f.name.starts_with("cyclic") && axis != nullptr && axis->screw_pitch)
      q.numbers.emplace_back("period", printed(*axis->screw_pitch, Quantity::length));
    if (f.name == "scale") q.not_stated = found.not_stated;
    out.quantities.push_back(std::move(q));
  }
  return out;
}

/// Returns nullopt without an uncertainty budget. Values without other uncertainties are left out.
std::optional<FollowedGroup> of_budget(const Results::Analysed& a, const Campaign& campaign) {
  if (!a.evaluation.budget) return std::nullopt;
  const UncertaintyBudget& budget = *a.evaluation.budget;
  FollowedGroup out;
  std::vector<double> variances;
  for (const Value& v : a.evaluation.values) {
    const auto result = std::find_if(budget.results.begin(), budget.results.end(),
                                     [&](const auto& r) { return r.name == v.name; });
    if (!v.followed || result == budget.results.end()) continue;
    FollowedQuantity q{.measurement = a.measurement,
                       .axis = v.followed->axis,
                       .name = v.followed->quantity,
                       .value = v.value,
                       .quantity = v.quantity,
                       .numbers = v.followed->numbers,
                       .texts = v.followed->texts};
    double variance = 0.0, shared = 0.0;
    for (std::size_t i = 0; i < result->u.size(); ++i)
      (budget.contributions[i].correlation == Correlation::device ? shared : variance) +=
          result->u[i] * result->u[i];
    put_common(q, variance, instrument_source(campaign.instrument), std::sqrt(shared));
    q.u = std::sqrt(variance);
    for (const Measurement& m : campaign.measurements)
      if (m.id == a.measurement) q.state = found_or_left(m);
    if (q.state.empty()) q.state = "as-found";
    variances.push_back(variance);
    if (q.u > 0.0)
      out.quantities.push_back(std::move(q));
    else
      variances.pop_back();
  }
  if (out.quantities.empty()) return std::nullopt;
  const std::size_t n = variances.size();
  out.covariance.assign(n * n, 0.0);  // the correlation between these values is not known
  for (std::size_t i = 0; i < n; ++i) out.covariance[i * n + i] = variances[i];
  return out;
}

std::string effects_of(const ModelFit& fit) {
  std::string out;
  for (const auto& e : fit.effects) out += (out.empty() ? "" : ", ") + e.name;
  return out;
}

/// Excludes searched parameters, parameters of curves, because their knots differ between
/// campaigns, parameters in m/m, which the quantity `scale` includes, and how a part or an
/// instrument was set up.
bool is_followed(const ModelFit& fit, const ModelFit::Parameter& p) {
  const auto effect = std::find_if(fit.effects.begin(), fit.effects.end(),
                                   [&](const ModelFit::Effect& e) { return e.name == p.effect; });
  return !p.searched && p.quantity != Quantity::deviation_per_length &&
         (effect == fit.effects.end() || (!effect->curve && !effect->is_set_up));
}

/// Model of a parameter. That of a source is the effect of its largest value, which must be equal.
std::string model_of(const ModelFit& fit, Quantity of) {
  constexpr int digits = 3;  // measured speeds are never equal
  std::string out = effects_of(fit);
  if (of != Quantity::deviation && of != Quantity::angular_deviation) return out;
  for (const ModelFit::Channel& c : fit.channels) {
    if (!c.used || c.unit == "degC") continue;
    double largest = 0.0;
    for (const double v : c.values) largest = std::max(largest, std::fabs(v));
    out += "; " + c.name + " up to " + short_text(largest, digits) + " " + c.unit;
  }
  return out;
}

/// A shift by a temperature is that in the middle of the targets.
std::vector<std::pair<std::string, double>> range_of(const ModelFit& fit, Quantity of) {
  if (!fit.channels.empty() || fit.target.empty() || of != Quantity::deviation_per_kelvin)
    return {};
  const auto [from, to] = std::minmax_element(fit.target.begin(), fit.target.end());
  return {{"from", printed(*from, Quantity::length)}, {"to", printed(*to, Quantity::length)}};
}

std::optional<FollowedGroup> of_model(const ModelFit& fit, const Campaign& campaign) {
  FollowedGroup out;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const ModelFit::Parameter& p = fit.parameters[i];
    if (!is_followed(fit, p) || !p.u || !(*p.u > 0.0) || !std::isfinite(p.value) ||
        fit.correlation.size() <= i)
      continue;
    kept.push_back(i);
    out.quantities.push_back(
        {.measurement = fit.measurement.empty() ? "" : fit.measurements.front(),
         .axis = fit.axis,
         .name = p.effect + '.' + p.name,
         .value = p.value,
         .quantity = p.quantity,
         .u = *p.u,
         .numbers = range_of(fit, p.quantity),
         .texts = {{"model", model_of(fit, p.quantity)}}});
    FollowedQuantity& q = out.quantities.back();
    for (const Measurement& m : campaign.measurements)
      if (m.id == q.measurement) q.state = found_or_left(m);
  }
  if (kept.empty()) return std::nullopt;
  for (const std::size_t i : kept)
    for (const std::size_t j : kept)
      out.covariance.push_back(fit.correlation[i][j] * *fit.parameters[i].u * *fit.parameters[j].u);
  return out;
}

void put_quantity(JsonWriter& json, const FollowedQuantity& q) {
  json.begin_object();
  if (!q.measurement.empty()) json.member("measurement", q.measurement);
  json.member("axis", q.axis);
  json.member("quantity", q.name);
  json.member("unit", unit_of(q.quantity).symbol);
  json.member("value", printed(q.value, q.quantity));
  json.member("u", printed(q.u, q.quantity));
  json.member("state", q.state);
  if (!q.common.empty()) {
    json.objects("common", q.common, [&](const auto& c) {
      json.member("source", c.source);
      json.member("u", printed(c.u, q.quantity));
    });
  }
  json.key("conditions");
  json.begin_object();
  for (const auto& [name, value] : q.numbers) json.member(name, value);
  for (const auto& [name, text] : q.texts) json.member(name, text);
  json.end_object();
  if (!q.not_stated.empty()) json.member("not_stated", q.not_stated);
  json.end_object();
}

void put_covariance(JsonWriter& json, const FollowedGroup& group, std::size_t first) {
  const std::size_t n = group.quantities.size();
  json.begin_object();
  json.member("first", static_cast<std::uint64_t>(first));
  json.member("count", static_cast<std::uint64_t>(n));
  json.key("upper");
  json.begin_array();
  constexpr double rounding = 1e-12;
  const auto& v = group.covariance;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) {
      const double least = rounding * std::sqrt(v[i * n + i] * v[j * n + j]);
      const double one = std::fabs(v[i * n + j]) > least ? v[i * n + j] : 0.0;
      json.value(printed(printed(one, group.quantities[i].quantity), group.quantities[j].quantity));
    }
  json.end_array();
  if (group.targets) {
    std::vector<Quantity> quantities;
    std::vector<double> variances;
    for (std::size_t i = 0; i < n; ++i)
      quantities.push_back(group.quantities[i].quantity), variances.push_back(v[i * n + i]);
    put_other_targets(json, *group.targets, quantities, variances);
  }
  json.end_object();
}

}  // namespace

std::vector<FollowedGroup> followed_of(const reading::ReadCampaign& read, const Results& results) {
  std::vector<FollowedGroup> out;
  const auto add = [&](std::optional<FollowedGroup> group) {
    if (group) out.push_back(std::move(*group));
  };
  const Campaign& campaign = read.manifest->campaign;
  for (std::size_t i = 0; i < read.observations.size(); ++i) add(of_axis(read, i));
  for (const Results::Analysed& a : results.analyses) add(of_budget(a, campaign));
  for (const ModelFit& fit : results.models) add(of_model(fit, campaign));
  return out;
}

void put_followed(JsonWriter& json, const std::vector<FollowedGroup>& groups) {
  if (groups.empty()) return;
  json.list("followed", groups, [&](const FollowedGroup& group) {
    for (const FollowedQuantity& q : group.quantities) put_quantity(json, q);
  });
  std::size_t first = 0;
  json.list("followed_covariance", groups, [&](const FollowedGroup& group) {
    put_covariance(json, group, first);
    first += group.quantities.size();
  });
}

namespace {

double printed_square(double si, Quantity q) { return printed(printed(si, q), q); }

std::string hexadecimal(std::uint64_t bits) {
  std::string out;
  for (int shift = 60; shift >= 0; shift -= 4) out += "0123456789abcdef"[bits >> shift & 0xF];
  return out;
}

template <class Value>
void put_list(JsonWriter& json, const char* name, std::size_t n, Value value) {
  json.key(name);
  json.begin_array();
  for (std::size_t i = 0; i < n; ++i) json.value(value(i));
  json.end_array();
}

template <class Value>
void put_triangle(JsonWriter& json, const char* name, std::size_t n, Value value) {
  json.key(name);
  json.begin_array();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) json.value(value(i * n + j));
  json.end_array();
}

void put_fit(JsonWriter& json, const char* name, const ComparedTargets::Fit& fit, Quantity q) {
  json.key(name);
  json.begin_object();
  json.member("beyond", printed_square(fit.beyond, q));
  json.member("dof", fit.dof);
  if (const std::size_t n = fit.residuals.size(); n > 0)
    put_list(json, "residuals", n, [&](std::size_t i) {
      constexpr double digits = 1e4;  // residuals are rounded to 1e-4 um or arcsec
      return std::round(printed(fit.residuals[i], q) * digits) / digits + 0.0;
    });
  if (const std::size_t n = fit.coefficients.size(); n > 0) {
    put_list(json, "coefficients", n,
             [&](std::size_t i) { return printed(fit.coefficients[i], q); });
    put_triangle(json, "upper", n,
                 [&](std::size_t i) { return printed_square(fit.covariance[i], q); });
    put_triangle(json, "share", n,
                 [&](std::size_t i) { return printed(fit.share[i], Quantity::number); });
  }
  if (const std::size_t n = fit.sinusoids.size() / 3; n > 0) {
    const auto& s = fit.sinusoids;
    put_list(json, "sinusoids", n, [&](std::size_t i) { return printed(s[3 * i], q); });
    put_list(json, "variances", n, [&](std::size_t i) { return printed_square(s[3 * i + 1], q); });
    put_list(json, "shares", n,
             [&](std::size_t i) { return printed(s[3 * i + 2], Quantity::number); });
  }
  json.end_object();
}

}  // namespace

ComparedTargets compared_targets(const nonio::math::AxisTest& test,
                                 const nonio::math::OtherTargets& fits) {
  const auto fit = [](const nonio::math::TargetFit& f) {
    ComparedTargets::Fit out{f.beyond, f.dof, f.coefficients, f.covariance,
                             f.share,  {},    f.residuals};
    for (const auto& s : f.sinusoids)
      out.sinusoids.insert(out.sinusoids.end(), {s.value, s.variance, s.share});
    return out;
  };
  ComparedTargets out{.from = test.targets.front(),
                      .to = test.targets.back(),
                      .rotary = test.rotary,
                      .of_readings = fits.of_readings,
                      .share = fits.share,
                      .mean = fit(fits.mean),
                      .reversal = fit(fits.reversal)};
  const double step = test.rotary ? 0.001 / unit_of(Quantity::angle).per_si : 1e-6;
  out.digest = 0xcbf29ce484222325U;  // initial value of FNV-1a
  for (const double target : test.targets) {
    auto bits = static_cast<std::uint64_t>(std::llround(target / step));
    for (int byte = 0; byte < 8; ++byte, bits >>= 8)
      out.digest = (out.digest ^ (bits & 0xFF)) * 0x100000001b3U;
  }
  return out;
}

void put_other_targets(JsonWriter& json, const ComparedTargets& t,
                       const std::vector<Quantity>& quantities,
                       const std::vector<double>& variances) {
  const Quantity position = t.rotary ? Quantity::angle : Quantity::length,
                 deviation = t.rotary ? Quantity::angular_deviation : Quantity::deviation;
  json.key("other_targets");
  json.begin_object();
  json.member("targets", hexadecimal(t.digest));
  json.member("from", printed(t.from, position));
  json.member("to", printed(t.to, position));
  put_list(json, "other_variance", quantities.size(), [&](std::size_t i) {
    const double readings = i < t.of_readings.size() ? t.of_readings[i] : variances[i];
    return printed_square(std::max(0.0, variances[i] - readings), quantities[i]);
  });
  put_list(json, "share", quantities.size(), [&](std::size_t i) {
    return printed(i < t.share.size() ? t.share[i] : 0.0, Quantity::number);
  });
  put_fit(json, "mean", t.mean, deviation);
  put_fit(json, "reversal", t.reversal, deviation);
  json.end_object();
}

}  // namespace nonio::evaluation
