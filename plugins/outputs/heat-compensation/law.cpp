// SPDX-License-Identifier: Apache-2.0
#include "law.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

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

struct Values {
  double gain = 0.0, tau = 0.0, power = 1.0;
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
  if (kind == "heat" || kind == "heat-slow") {
    term.channels = {of};
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
    if (readings.channel(name) == nullptr) return std::nullopt;
  const Values v = values_of(fit, effect);
  if (!v.has_gain) return std::nullopt;
  term.gain = v.gain, term.tau = v.tau, term.power = static_cast<int>(std::lround(v.power));
  if (term.kind == Term::Kind::source)
    for (const double n : readings.channel(of)->value)
      term.largest = std::max(term.largest, std::fabs(n));
  return term;
}

double rms_about_mean(const std::vector<double>& x) {
  double mean = 0.0, squares = 0.0;
  for (const double v : x) mean += v / static_cast<double>(x.size());
  for (const double v : x) squares += (v - mean) * (v - mean);
  return x.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(x.size()));
}

Law law_of(const ModelFit& fit, const Observations& readings, const std::string& axis) {
  Law law;
  law.measurement = fit.measurements.front();
  law.axis = axis[0] == '-' ? axis.substr(1) : axis;
  const double sense = axis[0] == '-' ? -1.0 : 1.0;
  std::vector<double> rest = fit.deviation;
  std::set<std::string> used;
  for (const ModelFit::Effect& effect : fit.effects) {
    auto term = term_of(fit, effect.name, readings);
    if (!term) {
      law.left_out.push_back(effect.name);
      continue;
    }
    term->gain *= sense;
    for (std::size_t i = 0; i < rest.size() && i < effect.contribution.size(); ++i)
      rest[i] -= effect.contribution[i];
    used.insert(term->channels.begin(), term->channels.end());
    law.effects.push_back(effect.name);
    law.terms.push_back(std::move(*term));
  }
  for (const std::string& name : used) law.channels.push_back(*readings.channel(name));
  law.before = rms_about_mean(fit.deviation);
  law.after = rms_about_mean(rest);
  return law;
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
  const auto stated = stated_axes(in);
  if (!stated) return fail(stated.error());
  std::vector<Law> out;
  for (const ModelFit& fit : in.results.models) {
    const std::size_t slash = fit.part.rfind('/');
    const Observations* readings =
        slash == std::string::npos ? nullptr : readings_of(in, fit.measurements.front());
    if (readings == nullptr || readings->channels.empty() || fit.effects.empty()) continue;
    const std::string displacement = fit.part.substr(slash + 1);
    const auto entry = stated->find(displacement);
    const std::string axis =
        entry != stated->end() ? entry->second : axis_by_name(in.campaign, displacement);
    if (axis.empty()) {
      findings.push_back(about("heat-compensation.no-axis", displacement));
      continue;
    }
    Law law = law_of(fit, *readings, axis);
    law.displacement = displacement;
    if (law.terms.empty()) {
      findings.push_back(about("heat-compensation.no-effect", displacement));
      continue;
    }
    const auto other =
        std::find_if(out.begin(), out.end(), [&](const Law& one) { return one.axis == law.axis; });
    if (other != out.end()) {
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
