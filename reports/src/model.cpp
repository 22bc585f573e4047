// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/model.h"

#include <algorithm>
#include <cmath>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"

namespace nonio::reports {
namespace {

constexpr double notable_correlation = 0.9;

/// The parts of a curve, s1, s2, ..., have one text.
std::string meaning_of(const ModelFit::Parameter& p, const Templates& templates,
                       const std::string& language) {
  const std::string card = "effect." + p.effect.substr(0, p.effect.find(':')) + ".parameter.";
  const std::string text = words(templates, language, card + p.name);
  if (!text.empty()) return text;
  return words(templates, language,
               card + p.name.substr(0, p.name.find_last_not_of("0123456789") + 1));
}

}  // namespace

std::vector<ParameterRow> parameter_rows(const ModelFit& fit, const Templates& templates,
                                         const std::string& language) {
  std::vector<ParameterRow> rows;
  const std::string* above = nullptr;
  for (const ModelFit::Parameter& p : fit.parameters) {
    std::optional<double> U;
    if (p.u && std::isfinite(*p.u)) U = 2 * *p.u;
    const Printed shown = printed_result(p.value, U, p.quantity, language);
    const bool same = above != nullptr && *above == p.effect;
    rows.push_back({same ? "" : p.effect, p.name, meaning_of(p, templates, language), shown.value,
                    shown.U.empty() ? "–" : shown.U, unit_text(p.quantity)});
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
  const Value *F = value("lack_of_fit_F"), *p = value("lack_of_fit_p");
  if (F != nullptr && p != nullptr)
    text +=
        " " + words.get("model.lack_of_fit",
                        {{"F", localised(short_text(F->value), language)},
                         {"p", localised(evidence_text({"", p->value, p->quantity}), language)}});
  return text;
}

}  // namespace nonio::reports
