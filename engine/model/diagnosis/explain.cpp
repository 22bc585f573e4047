// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/explain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "course/course.h"
#include "data/thin.h"
#include "diagnosis/plans.h"
#include "fit/compare.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/axis_readings.h"
#include "plans.h"
#include "search/candidates.h"
#include "search/finding.h"
#include "verdict.h"

namespace nonio::model {

namespace {

// p below which a drift or a reversal is reported; docs/dev/constants.md, M36.
constexpr double stated_below = 0.001;

struct Sums {
  std::vector<double> sum, n;
  Sums(const std::vector<std::uint32_t>& of, std::size_t count, const std::vector<double>& weight,
       const std::vector<double>& x)
      : sum(count, 0.0), n(count, 0.0) {
    for (std::size_t i = 0; i < x.size(); ++i)
      sum[of[i]] += weight[i] * x[i], n[of[i]] += weight[i];
  }
  double mean(std::size_t k) const { return n[k] > 0.0 ? sum[k] / n[k] : 0.0; }
};

std::vector<double> within_cells(const Finding& f, std::vector<double> x) {
  const Sums cells(f.repeats.cell, f.repeats.cells, f.weight, x);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= cells.mean(f.repeats.cell[i]);
  return x;
}

/// Line through the zeros of passes over their times, if its slope is significant.
std::optional<Statement> drift(const Finding& f, double dof) {
  const auto read = readings_of(f.part.table, f.part.axes.front());
  if (!read || !(read->duration > 0.0) || !(dof > 2.0)) return std::nullopt;
  const Repeats& r = f.repeats;
  const Sums zero(r.pass, r.passes, f.weight, within_cells(f, f.part.table.deviation));
  const Sums time(r.pass, r.passes, f.weight, within_cells(f, read->t));
  double tt = 0.0, ty = 0.0, yy = 0.0;
  for (std::size_t p = 0; p < r.passes; ++p) {
    const double t = time.mean(p), y = zero.mean(p);
    tt += t * t, ty += t * y, yy += y * y;
  }
  if (!(tt > 0.0)) return std::nullopt;
  const double slope = ty / tt, s2 = std::max(yy - slope * ty, 0.0) / (dof - 1.0);
  Statement out{.what = Statement::What::drift};
  out.value = slope * read->duration;
  out.u = std::sqrt(s2 / tt) * read->duration;
  out.p = math::t_two_sided(math::test_ratio(out.value, out.u), dof - 1.0);
  return out.p < stated_below ? std::optional(out) : std::nullopt;
}

/// Needs three targets or more, read from both sides, with significant reversals of one sign.
std::optional<Statement> reversal(const Finding& f, double dof) {
  const Repeats& r = f.repeats;
  const std::vector<double>& y = f.part.table.deviation;
  const std::vector<double> e = within_cells(f, y);
  const Sums cells(r.cell, r.cells, f.weight, y);
  double squares = 0.0, used = 0.0, full = 0.0;
  for (std::size_t i = 0; i < e.size(); ++i) squares += f.weight[i] * e[i] * e[i];
  for (const double n : cells.n) used += n, full += n > 0.0 ? 1.0 : 0.0;
  if (!(used - full >= 1.0) || f.part.way.size() != y.size()) return std::nullopt;
  const double s2 = squares / (used - full);
  std::vector<std::array<std::optional<std::uint32_t>, 2>> of(r.targets);
  for (std::size_t i = 0; i < y.size(); ++i)
    if (f.weight[i] > 0.0 && f.part.way[i] != 0)
      of[r.target[i]][f.part.way[i] > 0 ? 0 : 1] = r.cell[i];
  Statement out{.what = Statement::What::reversal};
  out.low = std::numeric_limits<double>::infinity(), out.high = -out.low;
  double n = 0.0, sum = 0.0, variance = 0.0;
  for (const auto& [plus, minus] : of) {
    if (!plus || !minus) return std::nullopt;
    const double b = cells.mean(*plus) - cells.mean(*minus);
    const double v = s2 * (1.0 / cells.n[*plus] + 1.0 / cells.n[*minus]);
    out.p =
        std::max(n == 0.0 ? 0.0 : out.p, math::t_two_sided(math::test_ratio(b, std::sqrt(v)), dof));
    out.low = std::min(out.low, b), out.high = std::max(out.high, b);
    sum += b, variance += v, ++n;
  }
  if (n < 3.0 || !(out.low * out.high > 0.0)) return std::nullopt;
  out.value = sum / n;
  out.u = std::sqrt(variance / n);  // the zero of a pass affects all targets
  out.p = std::min(1.0, out.p * n);
  return out.p < stated_below ? std::optional(out) : std::nullopt;
}

/// Statements are tested against the scatter of passes, because each pass may have a zero of its
/// own. Empty if fewer than 3 passes repeat others.
std::vector<Statement> statements_of(const Finding& f) {
  std::vector<Statement> out;
  const double dof = static_cast<double>(f.repeats.passes) - static_cast<double>(f.repeats.sides);
  if (f.part.kind != Part::Kind::axis || !(dof >= 3.0)) return out;
  for (const auto& one : {drift(f, dof), reversal(f, dof)})
    if (one) out.push_back(*one);
  return out;
}

struct Means {
  double plus = 0.0, minus = 0.0, n_plus = 0.0, n_minus = 0.0;
};

/// Whether the term predicts the same value for all readings of a target from one side.
bool of_place(const Observations& o, const Repeats& repeats, const Term& term) {
  const auto columns = columns_of(o, term, term.shape);
  if (!columns) return false;
  std::vector<Index> first(repeats.cells, -1);
  for (std::size_t i = 0; i < repeats.cell.size(); ++i) {
    Index& seen = first[repeats.cell[i]];
    const auto row = static_cast<Index>(i);
    if (seen < 0)
      seen = row;
    else if (!(columns->row(row) - columns->row(seen)).isZero())
      return false;
  }
  return true;
}

bool of_place(const Finding& f, const Term& term) {
  return of_place(f.part.table, f.repeats, term);
}

/// Range over targets if the description depends only on place, otherwise over readings.
void measure(const Finding& f, const std::vector<double>& says, Description& d) {
  std::vector<double> values = says;
  if (of_place(f, d.term)) {
    std::vector<Means> target(f.repeats.targets);
    for (std::size_t i = 0; i < says.size(); ++i) {
      Means& m = target[f.repeats.target[i]];
      (f.part.way[i] < 0 ? m.minus : m.plus) += says[i];
      (f.part.way[i] < 0 ? m.n_minus : m.n_plus) += 1.0;
    }
    values.clear();
    d.what = Description::What::value_at_targets;
    for (const Means& m : target)
      if (m.n_plus > 0.0 && m.n_minus > 0.0 &&
          std::fabs(m.plus / m.n_plus - m.minus / m.n_minus) > 1e-6 * d.rms)
        d.what = Description::What::reversal_at_targets;
    for (const Means& m : target) {
      const bool both = m.n_plus > 0.0 && m.n_minus > 0.0;
      if (d.what == Description::What::value_at_targets)
        values.push_back((m.plus + m.minus) / (m.n_plus + m.n_minus));
      else if (both)
        values.push_back(m.plus / m.n_plus - m.minus / m.n_minus);
    }
  }
  double sum = 0.0;
  for (const double v : values) sum += v;
  d.mean = values.empty() ? 0.0 : sum / static_cast<double>(values.size());
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double zero = d.what == Description::What::reversal_at_targets ? 0.0 : d.mean;
  if (!values.empty()) d.low = *low - zero, d.high = *high - zero;
}

/// The best description is added while its gain of evidence exceeds the cost of its columns.
std::vector<Description> described(const Finding& finding, const std::vector<Term>& certain) {
  std::vector<Term> terms = finding.of_model.fit.terms;
  terms.insert(terms.end(), certain.begin(), certain.end());
  const std::size_t explained = terms.size();
  terms.insert(terms.end(), finding.descriptions.begin(), finding.descriptions.end());
  const Workbench bench(finding.part.table, terms, finding.weight, {}, 0, nullptr, finding.noise);
  Workbench::State state = bench.state({});
  for (std::size_t e = 0; e < explained; ++e) state = bench.with(state, bench.gains(state, e), e);
  std::vector<Description> out;
  terms.resize(explained);
  while (true) {
    const Workbench::Gains gains = bench.gains(state);
    Workbench::State best = state;
    for (std::size_t e = explained; e < bench.instances().size(); ++e) {
      if (bench.holds(state, e)) continue;
      Workbench::State more = bench.with(state, gains, e);
      if (more.criterion < best.criterion) best = std::move(more);
    }
    if (best.blocks.size() == state.blocks.size()) break;
    state = std::move(best);
    const Workbench::Block& block = bench.blocks()[state.blocks.back()];
    out.push_back({finding.descriptions[block.effect - explained],
                   std::sqrt(state.squares / bench.readings())});
    out.back().term.shape = block.shape;
    terms.push_back(out.back().term);
  }
  const auto fitted =
      fit_near(finding.part.table, terms, std::vector<char>(terms.size(), 0), finding.weight);
  for (std::size_t k = 0; fitted && k < out.size(); ++k)
    measure(finding, fitted->part[explained + k], out[k]);
  return out;
}

std::vector<Term> certain_terms(const Explanation& out) {
  std::vector<Term> terms;
  for (const std::string& name : out.certain)
    for (const Candidate& c : out.candidates)
      if (c.term.name() == name) terms.push_back(c.term);
  return terms;
}

/// Significant effects whose predictions differ between repeated readings of a target and side.
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
  judge(*finding, finding->of_model.fit.rms, e);
  for (const Candidate& c : e.candidates)
    if (std::find(e.certain.begin(), e.certain.end(), c.term.name()) != e.certain.end() &&
        !of_place(*finding, c.term))
      out.push_back(c);
  return out;
}

/// Adds an effect that is significant only together with descriptions.
void take_over(Candidate found, const std::vector<std::string>& descriptions, Explanation& out) {
  const std::string name = found.term.name();
  if (std::find(out.certain.begin(), out.certain.end(), name) != out.certain.end()) return;
  const auto known = std::find_if(out.candidates.begin(), out.candidates.end(),
                                  [&](const Candidate& c) { return c.term.name() == name; });
  if (known == out.candidates.end()) return;
  found.rms = known->rms;
  found.cv_rms = known->cv_rms;
  found.with_descriptions = descriptions;
  *known = std::move(found);
  out.certain.push_back(name);
}

/// RMS of the model if the fit with the significant effects fails.
double rms_with_certain(const Finding& finding, const Explanation& out) {
  std::vector<Term> terms = finding.of_model.fit.terms;
  for (Term& term : certain_terms(out)) terms.push_back(std::move(term));
  const double rms = rms_with(finding.part.table, terms, finding.weight);
  return std::isfinite(rms) ? rms : finding.of_model.fit.rms;
}

/// More free values would cost more evidence than they provide.
bool few_places(const Finding& finding) {
  constexpr std::uint32_t most_targets = 60;
  return finding.part.kind == Part::Kind::axis && finding.repeats.targets <= most_targets;
}

/// For `unknown`: searches again with descriptions of place in the model. These describe all
/// residuals that repeat at a place, but not what changes in time. Effects that are then
/// significant are added to `out.certain`, and the remaining residuals are described.
void describe(const Finding& finding, const std::vector<Term>& catalogue, Explanation& out) {
  out.descriptions = described(finding, certain_terms(out));
  std::vector<Term> model = finding.of_model.fit.terms;
  std::vector<std::string> descriptions;
  const std::size_t before = out.certain.size();
  for (const Description& description : out.descriptions) {
    if (!few_places(finding) || !of_place(finding, description.term)) continue;
    model.push_back(description.term);
    descriptions.push_back(description.term.name());
    for (Candidate& found : certain_in(finding.part, model, catalogue, finding.seed))
      take_over(std::move(found), descriptions, out);
  }
  out.significant_rms = rms_with_certain(finding, out);
  if (out.certain.size() == before) return;
  rank(out.candidates);
  out.descriptions = described(finding, certain_terms(out));
}

/// Plans a measurement that separates the missing effect, the first of the candidates.
void plan_for_missing(const Finding& f, Explanation& out) {
  std::vector<Term> others = f.of_best.fit.terms;
  std::erase_if(others, [&](const Term& t) { return t.name() == out.verdict.effect; });
  out.plans = plans_for(f.part, others, out.candidates.front(), f.terms, f.of_best.fit.s);
}

/// Plans a measurement that separates the first replaceable effect of the model.
void plan_for_replaceable(const Finding& f, Explanation& out) {
  if (out.replaceable.empty()) return;
  const Replaceable& first = out.replaceable.front();
  Candidate member;
  std::vector<Term> others;
  for (const Term& term : f.of_best.fit.terms)
    if (term.name() == first.effect)
      member.term = term;
    else
      others.push_back(term);
  member.aliases = first.by;
  for (const Parameter& p : f.of_best.fit.parameters)
    if (p.effect == first.effect) member.parameters.push_back(p);
  out.plans = plans_for(f.part, others, member, f.terms, f.of_best.fit.s);
}

Expected<Explanation> explain_all(const Part& part, const std::vector<Term>& model,
                                  const std::vector<Term>& catalogue, std::uint64_t seed,
                                  const Ground& ground) {
  NONIO_TRY(auto finding, find_best(part, model, catalogue, seed));
  Explanation out;
  out.candidates = candidates_of(finding, ground);
  for (const Candidate& c : out.candidates)
    if (c.visible && finding.bench->holds(finding.best, finding.index_of(c.term.name())))
      out.together.push_back(c.term.name());
  out.best_rms = finding.of_best.fit.rms;
  const double rms = rms_with(finding.part.table, finding.of_model.fit.terms, ground.weight);
  judge(finding, std::isfinite(rms) ? rms : finding.of_model.fit.rms, out);
  if (out.verdict.kind == Verdict::Kind::missing) plan_for_missing(finding, out);
  if (out.verdict.kind == Verdict::Kind::nothing) {
    out.replaceable = replaceable_in(finding, ground);
    plan_for_replaceable(finding, out);
  }
  if (out.verdict.kind == Verdict::Kind::unknown) {
    describe(finding, catalogue, out);
    out.statements = statements_of(finding);
  }
  out.comparison.suspects = std::move(finding.suspects);
  return out;
}

/// After a search on means of adjacent readings: fits each candidate to all readings.
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

/// Adds suspect readings that the search found because they contradict the best explanation.
void add_suspects(const std::vector<Suspect>& found, Comparison& comparison) {
  for (const Suspect& s : found)
    if (std::none_of(comparison.suspects.begin(), comparison.suspects.end(),
                     [&](const Suspect& known) { return known.row == s.row; }))
      comparison.suspects.push_back(s);
}

}  // namespace

std::vector<Term> replacing(const Part& part, const Explanation& e, std::vector<Term> terms) {
  const Repeats repeats(part.table);
  bool place = false, time = false;
  for (const Candidate& c : e.candidates)
    if (std::find(e.together.begin(), e.together.end(), c.term.name()) != e.together.end())
      (of_place(part.table, repeats, c.term) ? place : time) = true;
  std::erase_if(terms, [&](Term term) {
    for (const Effect::Shape& shape : term.effect->shapes) {
      const auto grid = shape.grid(part.table, term.axis);
      if (grid.empty()) return false;
      term.shape.push_back(grid[grid.size() / 2]);
    }
    return !(of_place(part.table, repeats, term) ? place : time);
  });
  return terms;
}

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
  // Compare the model as `compare` does, so that one model has one RMS.
  NONIO_TRY(auto comparison, compare(part, model, known));
  if (ground.thin)
    judge_on_all(part, model, catalogue, ground, *out);
  else
    add_suspects(out->comparison.suspects, comparison);
  out->comparison = std::move(comparison);
  return out;
}

}  // namespace nonio::model
