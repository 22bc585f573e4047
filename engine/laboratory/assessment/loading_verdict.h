// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluation.h"
#include "laboratory/statistics/table_change.h"

/// Verdict on a loaded table, from measurements of an axis before and after loading.
namespace nonio::assessment {

struct LoadingVerdict {
  enum class Answer { worked, failed, not_decided };
  Answer answer = Answer::not_decided;  ///< not_decided: the measurements allow no decision
  std::vector<Finding> findings{};      ///< findings of the analysis before-after: pitch and
                                        ///< reversal
  /// Change between both campaigns, recognized as a loaded table; none if the tables worked, if the
  /// table that was active before is not known, or if the change is not one that the tables in
  /// `next` would cause.
  std::optional<statistics::TableChange> change{};
  double E = 0.0;  ///< E of the axis after loading (ISO 230-2), m or rad
};

/// Judges whether the tables that were loaded between both campaigns work. `next`: these tables, of
/// the axis. An error if a campaign has not exactly one measurement of the axis with readings, if
/// the measurements are not of the same line, or if the analysis before-after is not loaded.
Expected<LoadingVerdict> judge_loading(const reading::ReadCampaign& before,
                                       const reading::ReadCampaign& after, const std::string& axis,
                                       const std::vector<LoadedTable>& next,
                                       const evaluation::WantedController& control,
                                       const loader::Plugins& plugins);

}  // namespace nonio::assessment
