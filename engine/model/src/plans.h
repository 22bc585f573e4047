// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"

namespace nonio::model {

/// Further measurements that would tell a candidate from its aliases: each plan's readings are laid
/// beside those that are there, and the distance that the alias cannot bridge is computed. Plans
/// that reach four standard deviations, cheapest first; the best one if none does.
std::vector<Plan> plans_for(const Part& part, const std::vector<Term>& model,
                            const Candidate& candidate, const std::vector<Term>& catalogue,
                            double s);

}  // namespace nonio::model
