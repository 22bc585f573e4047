// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/model.h"

#include <algorithm>
#include <cmath>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"

namespace nonio::reports {
namespace {

constexpr double notable_correlation = 0.9;

std::string meaning_of(const ModelFit::Parameter& p, const Templates& templates,
                       const std::string& language) {
  const std::string card = "effect." + p.effect.substr(0, p.effect.find(':')) + ".parameter.";
  const std::string text = words(templates, language, card + p.name);
  if (!text.empty()) return text;
  return words(templates, language,
               card + p.name.substr(0, p.name.find_last_not_of("0123456789") + 1));
}

const ModelFit::Curve* curve_named(const ModelFit& fit, const std::string& effect) {
  for (const ModelFit::Effect& e : fit.effects)
    if (e.name == effect && e.curve) return &*e.curve;
  return nullptr;
}

/// Properties of a curve, because spline coefficients are not readable.
void add_curve(std::vector<ParameterRow>& rows, const std::string& effect,
               const ModelFit::Curve& curve, const ModelFit& fit, const Templates& templates,
               const std::string& language) {
  const Quantity q = deviation_of(fit.angular), along = position_of(fit.rotary);
  const auto row = [&](const char* name, double value, std::optional<double> at) {
    const std::string key = std::string("model.curve.") + name;
    std::string meaning = words(templates, language, at ? key + "_at" : key);
    if (const std::size_t place = meaning.find("{at}"); at && place != std::string::npos)
      meaning.replace(
          place, 4, localised(evidence_text({"", *at, along}), language) + " " + unit_text(along));
    std::string text = localised(short_text(printed(value, q)), language);
    if (text.starts_with('-')) text.replace(0, 1, "\u2212");
    rows.push_back({name == std::string_view("rms") ? effect : "", "", meaning, std::move(text),
                    "–", unit_text(q)});
  };
  row("rms", curve.rms, {});
  row("low", curve.low, curve.low_at);
  row("high", curve.high, curve.high_at);
}

}  // namespace

std::vector<CandidateRow> candidate_rows(const ModelFit& fit, const std::string& language) {
  const Quantity q = deviation_of(fit.angular);
  const auto with_unit = [&](double value) {
    if (!std::isfinite(value)) return std::string("–");
    return localised(short_text(printed(value, q)), language) + " " + unit_text(q);
  };
  std::vector<CandidateRow> rows;
  for (const ModelFit::Candidate& c : fit.candidates)
    rows.push_back({c.effect, localised(fixed_text(c.score, 1), language), with_unit(c.rms),
                    c.cv_rms ? with_unit(*c.cv_rms) : "–", with_unit(c.smallest), c.certain});
  return rows;
}

std::string no_sign(const ModelFit& fit, const Templates& templates, const std::string& language) {
  std::string text;
  for (const Finding& f : fit.no_sign)
    text += (text.empty() ? "" : "; ") + finding_text(templates, language, f, "says");
  return text.empty() ? text : typeset(text + ".");
}

std::vector<ParameterRow> parameter_rows(const ModelFit& fit, const Templates& templates,
                                         const std::string& language) {
  std::vector<ParameterRow> rows;
  const std::string* above = nullptr;
  for (const ModelFit::Parameter& p : fit.parameters) {
    const ModelFit::Curve* const curve = p.searched ? nullptr : curve_named(fit, p.effect);
    if (curve != nullptr) {
      if (above == nullptr || *above != p.effect)
        add_curve(rows, p.effect, *curve, fit, templates, language);
      above = &p.effect;
      continue;
    }
    std::optional<double> U;
    if (p.u && std::isfinite(*p.u)) U = 2 * *p.u;
    const Printed shown = printed_result(p.value, U, p.quantity, language);
    const bool same = above != nullptr && *above == p.effect;
    const bool is_held = p.u && *p.u == 0.0 && !p.searched;
    const std::string says_U = is_held           ? words(templates, language, "model.held")
                               : shown.U.empty() ? "–"
                                                 : shown.U;
    rows.push_back({same ? "" : p.effect, p.name, meaning_of(p, templates, language), shown.value,
                    says_U, unit_text(p.quantity)});
    above = &p.effect;
  }
  return rows;
}

std::string correlated_parameters(const ModelFit& fit, const Wording& words) {
  std::string out;
  const auto name = [&](std::size_t n) {
    return fit.parameters[n].effect + " " + fit.parameters[n].name;
  };
  for (std::size_t i = 0; i < std::min(fit.correlation.size(), fit.parameters.size()); ++i)
    for (std::size_t k = 0; k < std::min(i, fit.correlation[i].size()); ++k)
      if (const double r = fit.correlation[i][k]; std::fabs(r) > notable_correlation)
        out += (out.empty() ? "" : "; ") +
               words.get("model.pair",
                         {{"one", name(k)},
                          {"other", name(i)},
                          {"r", printed_number(r, Quantity::ratio, 2, words.language())}});
  return out.empty() ? out : words.get("model.correlated", {{"pairs", out}});
}

std::string fit_in_words(const ModelFit& fit, const Results& results, const Wording& words) {
  const auto analysed = std::find_if(
      results.analyses.begin(), results.analyses.end(), [&](const Results::Analysed& a) {
        return a.plugin == model_analysis &&
               std::find(fit.measurements.begin(), fit.measurements.end(), a.measurement) !=
                   fit.measurements.end();
      });
  if (analysed == results.analyses.end()) return {};
  const auto value = [&](std::string_view name) -> const Value* {
    for (const Value& v : analysed->evaluation.values)
      if (v.name == name) return &v;
    return nullptr;
  };
  const std::string& language = words.language();
  std::string text;
  if (const Value* redundancy = value("redundancy"))
    text += words.get(
        "model.redundancy",
        {{"readings", std::to_string(fit.size())},
         {"redundancy", printed_number(redundancy->value, Quantity::count, 0, language)}});
  if (const Value* largest = value("largest_residual"))
    text +=
        " " + words.get("model.largest",
                        {{"value", printed_number(largest->value, largest->quantity, 2, language)},
                         {"unit", unit_text(largest->quantity)}});
  return text;
}

}  // namespace nonio::reports
