// SPDX-License-Identifier: Apache-2.0
#include "describe.h"

#include <cmath>

namespace nonio::model {

std::vector<Description> described(const Finding& finding) {
  std::vector<Term> terms = finding.of_best.fit.terms;
  const std::size_t explained = terms.size();
  terms.insert(terms.end(), finding.descriptions.begin(), finding.descriptions.end());
  const Workbench bench(finding.part.table, terms, finding.weight, {}, 0, nullptr, finding.noise);
  Workbench::State state = bench.state({});
  for (std::size_t e = 0; e < explained; ++e) state = bench.with(state, bench.gains(state, e), e);
  std::vector<Description> out;
  while (true) {
    const VectorXd gains = bench.gains(state);
    Workbench::State best = state;
    for (std::size_t e = explained; e < terms.size(); ++e) {
      if (bench.holds(state, e)) continue;
      Workbench::State more = bench.with(state, gains, e);
      if (more.criterion < best.criterion) best = std::move(more);
    }
    if (best.blocks.size() == state.blocks.size()) return out;
    state = std::move(best);
    const Workbench::Block& block = bench.blocks()[state.blocks.back()];
    out.push_back({terms[block.effect], std::sqrt(state.squares / bench.readings())});
    out.back().term.shape = block.shape;
  }
}

}  // namespace nonio::model
