// SPDX-License-Identifier: Apache-2.0
#include "law.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "nonio/sdk/channels.h"

namespace nonio::heat_compensation {

namespace {

std::string trimmed(const std::string& s) {
  const std::size_t from = s.find_first_not_of(" \t");
  return from == std::string::npos ? "" : s.substr(from, s.find_last_not_of(" \t") - from + 1);
}

Expected<std::map<std::string, std::string>> stated_axes(const OutputInput& in) {
  std::map<std::string, std::string> out;
  for (const std::string& entry : in.options.texts("axes")) {
    const std::size_t equal = entry.find('=');
    const std::string displacement = trimmed(entry.substr(0, equal));
    const std::string axis = equal == std::string::npos ? "" : trimmed(entry.substr(equal + 1));
    const std::string name = axis.substr(axis.empty() || axis[0] != '-' ? 0 : 1);
    const Axis* known = in.campaign.machine.axis(name);
    if (displacement.empty() || known == nullptr || known->rotary)
      return fail("option axes, \"" + entry +
                  "\": expected \"displacement = axis\" with a linear axis of this machine, as in "
                  "\"z = Z\" or \"ch3 = -Z\"");
    out[displacement] = axis;
  }
  return out;
}

std::string axis_by_name(const Campaign& campaign, const std::string& displacement) {
  for (const Axis& axis : campaign.machine.axes)
    if (!axis.rotary && axis.name.size() == 1 &&
        std::tolower(static_cast<unsigned char>(axis.name[0])) == displacement[0] &&
        displacement.find_first_not_of("0123456789", 1) == std::string::npos)
      return axis.name;
  return "";
}

const Observations* readings_of(const OutputInput& in, const std::string& measurement) {
  for (std::size_t i = 0; i < in.campaign.measurements.size() && i < in.observations.size(); ++i)
    if (in.campaign.measurements[i].id == measurement) return &in.observations[i];
  return nullptr;
}

using Channel = Observations::Channel;

/// Name of the column material_c as a channel, which effects `temperature` follow.
constexpr const char* material = "material";

std::optional<Channel> channel_of(const Observations& o, const std::string& name) {
  if (const Channel* known = o.channel(name)) return *known;
  if (name != material || o.material.size() != o.size()) return std::nullopt;
  Channel out{material, "degC", {}, {}};
  std::map<double, double> samples;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (std::isfinite(o.material[i]))
      samples[o.time.size() == o.size() ? o.time[i] : static_cast<double>(i)] = o.material[i];
  for (const auto& [time, value] : samples) out.time.push_back(time), out.value.push_back(value);
  return out;
}

struct Values {
  double gain = 0.0, tau = 0.0, power = 1.0, growth = 0.0, fixed = 0.0;
  bool has_gain = false;
};

Values values_of(const ModelFit& fit, const std::string& effect) {
  Values v;
  for (const ModelFit::Parameter& p : fit.parameters) {
    if (p.effect != effect) continue;
    if (p.name == "tau")
      v.tau = p.value;
    else if (p.name == "m")
      v.power = p.value;
    else if (p.name == "fixed")
      v.fixed = p.value;
    else if (p.quantity == Quantity::expansion)
      v.growth = p.value, v.has_gain = true;
    else
      v.gain = p.value, v.has_gain = true;
  }
  return v;
}

std::optional<Term> term_of(const ModelFit& fit, const std::string& effect,
                            const Observations& readings) {
  const std::size_t colon = effect.find(':');
  const std::string kind = effect.substr(0, colon);
  const std::string of = colon == std::string::npos ? "" : effect.substr(colon + 1);
  Term term;
  if (kind == "heat" || kind == "heat-slow" || kind == "heat-growth") {
    term.channels = {of};
  } else if (kind == "temperature") {
    term.channels = {material};
    double sum = 0.0, n = 0.0;
    for (const double t : fit.temperature)
      if (std::isfinite(t)) sum += t, ++n;
    if (n > 0.0) term.zero = sum / n;
  } else if (kind == "heat-difference") {
    term.kind = Term::Kind::difference;
    term.channels = {of.substr(0, of.find('-')), of.substr(std::min(of.size(), of.find('-') + 1))};
  } else if (kind == "heat-source" || kind == "heat-source-slow") {
    term.kind = Term::Kind::source;
    term.channels = {of};
  } else {
    return std::nullopt;
  }
  for (const std::string& name : term.channels)
    if (!channel_of(readings, name)) return std::nullopt;
  const Values v = values_of(fit, effect);
  if (!v.has_gain) return std::nullopt;
  term.gain = v.gain - v.growth * v.fixed, term.growth = v.growth;
  term.tau = v.tau, term.power = static_cast<int>(std::lround(v.power));
  if (term.kind == Term::Kind::source)
    for (const double n : readings.channel(of)->value)
      term.largest = std::max(term.largest, std::fabs(n));
  return term;
}

bool is_thermal(const std::string& effect) {
  return effect.starts_with("heat") || effect.starts_with("temperature");
}

double rms_about_mean(const std::vector<double>& x) {
  double mean = 0.0, squares = 0.0;
  for (const double v : x) mean += v / static_cast<double>(x.size());
  for (const double v : x) squares += (v - mean) * (v - mean);
  return x.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(x.size()));
}

/// What a term of runs follows at each reading: change of its channel since the first sample, or
/// from `zero`, with its lag.
std::vector<double> followed(const OutputInput& in, const ModelFit& fit, const Term& term) {
  std::vector<double> out(fit.size(), 0.0);
  std::optional<double> first;
  for (std::size_t m = 0; m < fit.measurements.size(); ++m) {
    const auto channel = channel_of(*readings_of(in, fit.measurements[m]), term.channels.front());
    if (!channel || channel->value.empty()) continue;
    if (!first) first = term.zero.value_or(channel->value.front());
    std::vector<double> time;
    for (std::size_t i = 0; i < fit.size(); ++i)
      if (fit.measurement[i] == m)
        time.push_back(fit.time.empty() ? static_cast<double>(time.size()) : fit.time[i]);
    const std::vector<double> own = lagged(*channel, term.tau, time);
    for (std::size_t i = 0, k = 0; i < fit.size(); ++i)
      if (fit.measurement[i] == m) out[i] = own[k++] + channel->value.front() - *first;
  }
  return out;
}

/// Adds what only runs of the axis show.
void put_runs(Law& law, const OutputInput& in, const ModelFit& fit) {
  const auto [low, high] = std::minmax_element(fit.target.begin(), fit.target.end());
  law.reference = 0.5 * (*low + *high);
  std::vector<double> rest = fit.deviation, slope(fit.size(), 0.0);
  for (const Term& term : law.terms) {
    const std::vector<double> follows = followed(in, fit, term);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      slope[i] += term.growth * follows[i];
      rest[i] -= (term.gain + term.growth * (fit.target[i] - law.reference)) * follows[i];
    }
  }
  for (const double s : slope) law.largest_slope = std::max(law.largest_slope, std::fabs(s));
  law.after = rms_about_mean(rest);
}

Law law_of(const ModelFit& fit, const Observations& readings, const std::string& axis,
           const OutputInput& in) {
  Law law;
  law.of_runs = fit.part == axis;
  law.measurement = fit.measurements.front();
  law.axis = axis[0] == '-' ? axis.substr(1) : axis;
  const double sense = axis[0] == '-' ? -1.0 : 1.0;
  std::vector<double> rest = fit.deviation;
  std::set<std::string> used;
  for (const ModelFit::Effect& effect : fit.effects) {
    auto term = term_of(fit, effect.name, readings);
    if (!term) {
      // Other effects on runs belong to tables.
      if (!law.of_runs || is_thermal(effect.name)) law.left_out.push_back(effect.name);
      continue;
    }
    term->gain *= sense;
    for (std::size_t i = 0; i < rest.size() && i < effect.contribution.size(); ++i)
      rest[i] -= effect.contribution[i];
    used.insert(term->channels.begin(), term->channels.end());
    law.effects.push_back(effect.name);
    law.terms.push_back(std::move(*term));
  }
  for (const std::string& name : used) law.channels.push_back(*channel_of(readings, name));
  law.before = rms_about_mean(fit.deviation);
  law.after = rms_about_mean(rest);
  if (law.of_runs && fit.size() > 0) put_runs(law, in, fit);
  return law;
}

/// "x1" of the part "warm/x1"; for runs the name of the axis.
std::string displacement_of(const ModelFit& fit) {
  return fit.part.substr(fit.part.rfind('/') + 1);
}

Finding about(const char* id, const std::string& displacement) {
  return {.id = id, .attention = true, .texts = {{"displacement", displacement}}};
}

}  // namespace

std::string plain(const std::string& name) {
  std::string out;
  for (const char c : name)
    out += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
  return out;
}

Expected<std::vector<Law>> laws(const OutputInput& in, std::vector<Finding>& findings) {
  NONIO_TRY(const auto stated, stated_axes(in));
  // Stated displacements come first, because they take precedence over names.
  std::vector<const ModelFit*> fits;
  for (const ModelFit& fit : in.results.models) fits.push_back(&fit);
  std::stable_partition(fits.begin(), fits.end(), [&](const ModelFit* fit) {
    return stated.contains(displacement_of(*fit));
  });
  std::vector<Law> out;
  for (const ModelFit* const of : fits) {
    const ModelFit& fit = *of;
    const std::size_t slash = fit.part.rfind('/');
    const Axis* runs = in.campaign.machine.axis(fit.part);
    if (slash == std::string::npos && (runs == nullptr || runs->rotary)) continue;
    const Observations* readings = readings_of(in, fit.measurements.front());
    if (readings == nullptr || fit.effects.empty()) continue;
    if (runs == nullptr && readings->channels.empty()) continue;
    const std::string displacement = displacement_of(fit);
    if (fit.angular) {
      findings.push_back(about("heat-compensation.tilt", displacement));
      continue;
    }
    const auto entry = stated.find(displacement);
    const std::string axis = runs != nullptr         ? fit.part
                             : entry != stated.end() ? entry->second
                                                     : axis_by_name(in.campaign, displacement);
    if (axis.empty()) {
      findings.push_back(about("heat-compensation.no-axis", displacement));
      continue;
    }
    Law law = law_of(fit, *readings, axis, in);
    law.displacement = displacement;
    if (law.terms.empty()) {
      if (law.of_runs && law.left_out.empty()) continue;
      findings.push_back(about("heat-compensation.no-effect", displacement));
      continue;
    }
    const auto other =
        std::find_if(out.begin(), out.end(), [&](const Law& one) { return one.axis == law.axis; });
    if (other != out.end()) {
      if (stated.contains(other->displacement) && entry == stated.end()) continue;
      Finding f = about("heat-compensation.two-displacements", displacement);
      f.texts.emplace_back("other", other->displacement);
      f.texts.emplace_back("axis", law.axis);
      findings.push_back(std::move(f));
      continue;
    }
    out.push_back(std::move(law));
  }
  return out;
}

}  // namespace nonio::heat_compensation
