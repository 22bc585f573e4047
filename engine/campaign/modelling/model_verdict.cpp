// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace nonio::modelling {

const char* to_text(model::Verdict::Kind kind) {
  switch (kind) {
    case model::Verdict::Kind::missing:
      return "missing";
    case model::Verdict::Kind::nothing:
      return "nothing";
    case model::Verdict::Kind::unknown:
      return "unknown";
    case model::Verdict::Kind::unrepeatable:
      break;
  }
  return "unrepeatable";
}

bool is_ranked(const model::Candidate& c) {
  return c.visible && std::isfinite(c.score) && (c.rms > 0.0 || !c.parameters.empty());
}

std::vector<Correlated> correlated(const model::Fit& fit) {
  constexpr double high = 0.9;
  std::vector<Correlated> out;
  for (std::size_t i = 0; i < fit.correlation.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const double r = fit.correlation[i][j]; std::fabs(r) > high)
        out.push_back({&fit.parameters[j], &fit.parameters[i], r});
  return out;
}

namespace {

std::size_t most_severe_of(const std::vector<PartVerdict>& parts) {
  using Verdict = model::Verdict::Kind;
  for (const Verdict kind : {Verdict::missing, Verdict::unrepeatable, Verdict::unknown})
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].kind == to_text(kind)) return i;
  return 0;
}

}  // namespace

std::vector<PartVerdict> verdicts_of(const std::vector<Explained>& all) {
  std::vector<PartVerdict> verdicts;
  for (const Explained& e : all) {
    const auto& part = e.part.part;
    std::vector<std::string> certain;
    for (const std::string& effect : e.explanation.certain)
      certain.push_back(model::written_for(part, effect));
    const std::string& effect = e.explanation.verdict.effect;
    verdicts.push_back({to_text(e.explanation.verdict.kind),
                        effect.empty() ? effect : model::written_for(part, effect), certain});
  }
  return verdicts;
}

std::size_t most_severe(const std::vector<Explained>& all) {
  return most_severe_of(verdicts_of(all));
}

std::string next_effect(const std::vector<PartVerdict>& parts) {
  using Verdict = model::Verdict::Kind;
  if (parts.empty()) return {};
  const PartVerdict& worst = parts[most_severe_of(parts)];
  if (worst.kind == to_text(Verdict::missing)) return worst.effect;
  if (worst.kind == to_text(Verdict::unknown) && !worst.certain.empty())
    return worst.certain.front();
  return {};
}

NextEffects next_effects(const std::vector<Explained>& all, const std::set<std::string>& settled) {
  std::vector<PartVerdict> verdicts = verdicts_of(all);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (settled.contains(all[i].part.part.name))
      verdicts[i] = {to_text(model::Verdict::Kind::nothing), {}, {}};
  const std::string next = next_effect(verdicts);
  if (next.empty()) return {};
  const Explained& worst = all[most_severe_of(verdicts)];
  const model::Explanation& e = worst.explanation;
  const model::Part::Kind kind = worst.part.part.kind;
  NextEffects out{&worst, {next}};
  // Sensors replace each other in a displacement over time, so their set is added as a whole. The
  // set of a volume is added if it leaves nothing unexplained, otherwise its significant effects.
  std::vector<std::string> more;
  if (kind == model::Part::Kind::course || (kind == model::Part::Kind::space && e.explains_all))
    more = e.together;
  else if (kind == model::Part::Kind::space)
    more = e.certain;
  for (const std::string& effect : more) {
    std::string written = model::written_for(worst.part.part, effect);
    if (written != next) out.effects.push_back(std::move(written));
  }
  return out;
}

std::vector<std::string> unproven_effects(const std::vector<Explained>& all) {
  std::map<std::string, double> strength;  // |value| / u, infinite where a part proves the effect
  for (const Explained& e : all) {
    const model::Fit& fit = e.explanation.comparison.fit;
    const std::vector<std::string> weak = model::below_uncertainty(fit);
    for (const model::Term& term : fit.terms) {
      if (term.effect->is_nuisance || term.held) continue;
      double own = std::numeric_limits<double>::infinity();
      if (std::find(weak.begin(), weak.end(), term.name()) != weak.end()) {
        own = 0.0;
        for (const model::Parameter& p : fit.parameters)
          if (p.effect == term.name() && !p.shape) own = std::max(own, std::fabs(p.value) / p.u);
      }
      double& most = strength[model::written_for(e.part.part, term.name())];
      most = std::max(most, own);
    }
  }
  std::vector<std::pair<double, std::string>> weakest;
  for (const auto& [effect, of] : strength)
    if (std::isfinite(of)) weakest.emplace_back(of, effect);
  std::sort(weakest.begin(), weakest.end());
  std::vector<std::string> out;
  for (auto& [of, effect] : weakest) out.push_back(std::move(effect));
  return out;
}

}  // namespace nonio::modelling
