// SPDX-License-Identifier: Apache-2.0
#include "describe.h"

#include <algorithm>
#include <cmath>

namespace nonio::model {

namespace {

struct Means {
  double plus = 0.0, minus = 0.0, n_plus = 0.0, n_minus = 0.0;
};

/// What a description says: of each target a value or a reversal, else of each reading.
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

}  // namespace

bool of_place(const Finding& f, const Term& term) {
  const auto columns = columns_of(f.part.table, term, term.shape);
  if (!columns) return false;
  std::vector<Index> first(f.repeats.cells, -1);
  for (std::size_t i = 0; i < f.repeats.cell.size(); ++i) {
    Index& seen = first[f.repeats.cell[i]];
    const auto row = static_cast<Index>(i);
    if (seen < 0)
      seen = row;
    else if (!(columns->row(row) - columns->row(seen)).isZero())
      return false;
  }
  return true;
}

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

}  // namespace nonio::model
