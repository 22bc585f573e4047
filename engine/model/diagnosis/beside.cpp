// SPDX-License-Identifier: Apache-2.0
#include "beside.h"

#include <algorithm>
#include <cmath>

#include "describe.h"
#include "search/candidates.h"
#include "verdict.h"

namespace nonio::model {

namespace {

/// Terms of the candidates that are certain, with their shapes.
std::vector<Term> certain_terms(const Explanation& out) {
  std::vector<Term> terms;
  for (const std::string& name : out.certain)
    for (const Candidate& c : out.candidates)
      if (c.term.name() == name) terms.push_back(c.term);
  return terms;
}

/// Effects that are certain beside the model and do not repeat at a place; their candidates.
std::vector<Candidate> certain_in(const Part& part, const std::vector<Term>& model,
                                  const std::vector<Term>& catalogue, std::uint64_t seed) {
  std::vector<Candidate> out;
  const auto finding = find_best(part, model, catalogue, seed);
  if (!finding) return out;
  Explanation e;
  e.candidates = candidates_of(
      *finding, {finding->repeats, finding->suspects, finding->weight, finding->noise});
  for (const Candidate& c : e.candidates)
    if (c.visible && finding->bench->holds(finding->best, finding->index_of(c.term.name())))
      e.together.push_back(c.term.name());
  judge(*finding, e);
  for (const Candidate& c : e.candidates)
    if (std::find(e.certain.begin(), e.certain.end(), c.term.name()) != e.certain.end() &&
        !of_place(*finding, c.term))
      out.push_back(c);
  return out;
}

/// An effect that is certain beside descriptions only.
void take_over(Candidate found, const std::vector<std::string>& beside, Explanation& out) {
  const std::string name = found.term.name();
  if (std::find(out.certain.begin(), out.certain.end(), name) != out.certain.end()) return;
  const auto known = std::find_if(out.candidates.begin(), out.candidates.end(),
                                  [&](const Candidate& c) { return c.term.name() == name; });
  if (known == out.candidates.end()) return;
  found.rms = known->rms;
  found.cv_rms = known->cv_rms;
  found.beside = beside;
  *known = std::move(found);
  out.certain.push_back(name);
}

/// What is left with all that is certain in the model.
double rms_beside(const Finding& finding, const Explanation& out) {
  std::vector<Term> terms = finding.of_model.fit.terms;
  for (Term& term : certain_terms(out)) terms.push_back(std::move(term));
  const double rms = rms_with(finding.part.table, terms, finding.weight);
  return std::isfinite(rms) ? rms : finding.of_model.fit.rms;
}

/// Where the search is worth doing again beside free values of place: with few targets, in which
/// the catalogue cannot say what repeats there. More would cost more than they tell.
bool few_places(const Finding& finding) {
  constexpr std::uint32_t most_targets = 60;
  return finding.part.kind == Part::Kind::axis && finding.repeats.targets <= most_targets;
}

}  // namespace

void describe(const Finding& finding, const std::vector<Term>& catalogue, Explanation& out) {
  out.descriptions = described(finding, certain_terms(out));
  std::vector<Term> model = finding.of_model.fit.terms;
  std::vector<std::string> beside;
  const std::size_t before = out.certain.size();
  for (const Description& description : out.descriptions) {
    if (!few_places(finding) || !of_place(finding, description.term)) continue;
    model.push_back(description.term);
    beside.push_back(description.term.name());
    for (Candidate& found : certain_in(finding.part, model, catalogue, finding.seed))
      take_over(std::move(found), beside, out);
  }
  out.significant_rms = rms_beside(finding, out);
  if (out.certain.size() == before) return;
  std::stable_sort(out.candidates.begin(), out.candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  out.descriptions = described(finding, certain_terms(out));
}

}  // namespace nonio::model
