// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/explain.h"

#include <algorithm>
#include <optional>

#include "beside.h"
#include "course/course.h"
#include "data/thin.h"
#include "fit/compare.h"
#include "search/candidates.h"
#include "search/finding.h"
#include "statements.h"
#include "verdict.h"

namespace nonio::model {

namespace {

Expected<Explanation> explain_all(const Part& part, const std::vector<Term>& model,
                                  const std::vector<Term>& catalogue, std::uint64_t seed,
                                  const Ground& ground) {
  auto finding = find_best(part, model, catalogue, seed);
  if (!finding) return fail(finding.error());
  Explanation out;
  out.candidates = candidates_of(*finding, ground);
  for (const Candidate& c : out.candidates)
    if (c.visible && finding->bench->holds(finding->best, finding->index_of(c.term.name())))
      out.together.push_back(c.term.name());
  out.best_rms = finding->of_best.fit.rms;
  out.criterion = finding->best.criterion;
  out.readings = finding->bench->readings();
  judge(*finding, out);
  if (out.verdict.kind == Verdict::Kind::unknown) {
    describe(*finding, catalogue, out);
    out.statements = statements_of(*finding);
  }
  out.comparison.suspects = std::move(finding->suspects);
  return out;
}

/// Searched on means of neighbours; how well each candidate does, on all readings.
void judge_on_all(const Part& part, const std::vector<Term>& model,
                  const std::vector<Term>& catalogue, const Groundwork::Found& ground,
                  Explanation& out) {
  const std::vector<double>& weight = ground.whole.weight;
  out.verdict.suspects_share =
      static_cast<double>(ground.whole.suspects.size()) / static_cast<double>(part.table.size());
  if (too_many(ground.whole.suspects.size(), part.table.size()))
    out.verdict.kind = Verdict::Kind::unrepeatable;
  for (Candidate& c : out.candidates) {
    const auto term = std::find_if(catalogue.begin(), catalogue.end(),
                                   [&](const Term& t) { return t.name() == c.term.name(); });
    if (!c.visible || term == catalogue.end()) continue;
    const auto fitted =
        fit(part.table, with_term(model, *term), weight, ground.whole.noise, &ground.thin->table);
    if (!fitted) continue;
    c.rms = fitted->rms;
    c.cv_rms = rms_of(cross_validated(part.table, fitted->terms, weight), weight);
  }
}

/// What the search suspects besides, because the best explanation contradicts it.
void add_suspects(const std::vector<Suspect>& found, Comparison& comparison) {
  for (const Suspect& s : found)
    if (std::none_of(comparison.suspects.begin(), comparison.suspects.end(),
                     [&](const Suspect& known) { return known.row == s.row; }))
      comparison.suspects.push_back(s);
}

}  // namespace

Expected<Explanation> explain(const Part& part, const std::vector<Term>& model,
                              const std::vector<Term>& catalogue, std::uint64_t seed,
                              const Groundwork* known) {
  if (part.table.size() == 0) return fail("there are no readings of an axis to explain");
  if (part.kind == Part::Kind::course) return explain_course(part, model, catalogue, seed);
  std::optional<Groundwork> made;
  if (known == nullptr) known = &made.emplace(part, model);
  const Groundwork::Found& ground = known->found();
  auto out = explain_all(ground.thin ? *ground.thin : part, model, catalogue, seed,
                         ground.thin ? *ground.of_thin : ground.whole);
  if (!out) return out;
  // The model is compared as `compare` does it: one model has one RMS.
  auto comparison = compare(part, model, known);
  if (!comparison) return fail(comparison.error());
  if (ground.thin)
    judge_on_all(part, model, catalogue, ground, *out);
  else
    add_suspects(out->comparison.suspects, *comparison);
  out->comparison = std::move(*comparison);
  return out;
}

}  // namespace nonio::model
