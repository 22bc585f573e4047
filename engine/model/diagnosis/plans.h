// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"

namespace nonio::model {

/// A table with one measurement more, whose deviations are 0.
struct Further {
  std::string id, of;  ///< as in Plan
  Observations table;
};

/// Further measured quantities of planned readings at the end of the table: as they were last
/// known. Weights and columns need an entry for each reading.
void fill_measured(Observations& o);

/// Further runs of an axis, laid behind its readings.
std::vector<Further> further_runs(const Part& part, const Axis& axis);

/// What could be measured besides on a machine with several axes, or on a ball.
std::vector<Further> further_in_space(const Part& part);

/// Further measurements that would separate a candidate from its aliases: each plan's readings are
/// added to the existing ones, and the distance that the alias cannot explain is computed. Plans
/// that reach four standard deviations, cheapest first; the best one if none does.
std::vector<Plan> plans_for(const Part& part, const std::vector<Term>& model,
                            const Candidate& candidate, const std::vector<Term>& catalogue,
                            double s);

/// The same for two effects that cancel each other, with the values of their linear parameters:
/// their joint effect compared with that of each alone.
std::vector<Plan> plans_for_pair(const Part& part, const std::vector<Term>& model,
                                 const std::vector<Term>& pair, const std::vector<double>& value,
                                 double s);

}  // namespace nonio::model
