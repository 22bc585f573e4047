// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/explain.h"

#include "beside.h"
#include "data/thin.h"
#include "fit/compare.h"
#include "search/candidates.h"
#include "search/finding.h"
#include "verdict.h"

namespace nonio::model {

namespace {

Expected<Explanation> explain_all(const Part& part, const std::vector<Term>& model,
                                  const std::vector<Term>& catalogue, std::uint64_t seed) {
  auto finding = find_best(part, model, catalogue, seed);
  if (!finding) return fail(finding.error());
  Explanation out;
  out.candidates = candidates_of(*finding);
  for (const Candidate& c : out.candidates)
    if (c.visible && finding->bench->holds(finding->best, finding->index_of(c.term.name())))
      out.together.push_back(c.term.name());
  out.best_rms = finding->of_best.fit.rms;
  judge(*finding, out);
  if (out.verdict.kind == Verdict::Kind::unknown) describe(*finding, catalogue, out);
  if (finding->of_model.fails())
    finding->of_model.seats = seats_in(part, finding->repeats, finding->of_model);
  out.comparison = std::move(finding->of_model);
  return out;
}

/// The search on means of neighbours; how well the model and each candidate do, on all readings.
Expected<Explanation> explain_on_means(const Part& part, const std::vector<Term>& model,
                                       const std::vector<Term>& catalogue, std::uint64_t seed,
                                       const Groundwork::Found& ground) {
  const std::vector<double>& weight = ground.whole.weight;
  const Part& thin = *ground.thin;
  auto out = explain_all(thin, model, catalogue, seed);
  if (!out) return out;
  auto whole = compare_on(part, out->comparison.fit.terms, ground.whole);
  if (!whole) return fail(whole.error());
  whole->places = std::move(out->comparison.places);
  whole->seats = std::move(out->comparison.seats);
  whole->means = thin.table.size();
  out->comparison = std::move(*whole);
  out->verdict.suspects_share =
      static_cast<double>(out->comparison.suspects.size()) / static_cast<double>(part.table.size());
  if (too_many(out->comparison.suspects.size(), part.table.size()))
    out->verdict.kind = Verdict::Kind::unrepeatable;
  for (Candidate& c : out->candidates) {
    if (!c.visible) continue;
    std::vector<Term> terms = out->comparison.fit.terms;
    terms.push_back(c.term);
    c.rms = rms_with(part.table, terms, weight);
    c.cv_rms = rms_of(cross_validated(part.table, terms, weight), weight);
  }
  return out;
}

}  // namespace

Expected<Explanation> explain(const Part& part, const std::vector<Term>& model,
                              const std::vector<Term>& catalogue, std::uint64_t seed,
                              const Groundwork* known) {
  if (part.table.size() == 0) return fail("there are no readings of an axis to explain");
  if (part.table.size() <= thin_beyond || !can_be_thinned(part.table))
    return explain_all(part, model, catalogue, seed);
  return explain_on_means(part, model, catalogue, seed, *GroundworkOf(part, model, known));
}

}  // namespace nonio::model
