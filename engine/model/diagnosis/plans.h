// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "data/design.h"
#include "nonio/model/explain.h"

namespace nonio::model {

/// A table with one additional planned measurement, whose deviations are 0.
struct Further {
  std::string id, of;  ///< kind and object of the measurement, as `Plan::id` and `Plan::of`
  Observations table;
  std::optional<double> duration{};  ///< as `Plan::duration`
  std::vector<Term> set_up{};        ///< unknowns that only the planned measurement has
  /// Rows of the part that is made once more, in the order of the added rows, and its name.
  std::vector<std::size_t> again{};
  std::string body{};
  std::vector<std::string> settled{};  ///< terms of the model that are known afterwards
};

/// Repeats the last known values, because weights and columns need an entry for each reading.
void fill_measured(Observations& o);

/// The readings of an axis and one planned measurement with one run or three.
std::vector<Further> further_runs(const Part& part, const Axis& axis);

/// Returns tables with one additional measurement on a machine with several axes, or of a ball.
std::vector<Further> further_in_space(const Part& part);

/// Added to the names of the part that is made once more, and of its lines.
inline constexpr const char* further_body = " (again)";
/// Returns tables with one of the parts made once more: turned by 90 deg, or in another place; and
/// one without further readings in which the sizes of all parts are known.
std::vector<Further> further_parts(const Part& part);
/// Adds the unknowns of the set-up of the part that is made once more, like those in the model, and
/// names those of the model that are known afterwards.
void add_set_up_of_part(Further& further, const std::vector<Term>& model);
/// Converts columns of an effect of the machine to those of the same error in the part, its fixture
/// or the measuring machine: it moves with the part.
MatrixXd as_error_of_part(const Part& part, const Further& further, MatrixXd columns);
/// Whether parts were made without being turned against each other, so that their own errors are
/// not separable from those of the machine.
bool is_of_parts_alike(const Part& part);

/// Measurements that would separate a candidate from its aliases. `model`: the other effects of the
/// explanation, which are fitted too. Power: the part of the candidate in the planned readings that
/// no alias explains, in standard deviations `s` of a reading (m or rad). At most three: those
/// with a power of four by increasing number of readings, then the others by decreasing power.
std::vector<Plan> plans_for(const Part& part, const std::vector<Term>& model,
                            const Candidate& candidate, const std::vector<Term>& catalogue,
                            double s);

/// Measurements of an axis that would separate two effects that cancel each other: their joint
/// effect is compared with that of each alone. Empty for other parts. `value`: their linear
/// parameters, SI; `s`: standard deviation of a reading, m or rad.
std::vector<Plan> plans_for_pair(const Part& part, const std::vector<Term>& model,
                                 const std::vector<Term>& pair, const std::vector<double>& value,
                                 double s);

}  // namespace nonio::model
