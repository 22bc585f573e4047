// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluation.h"
#include "laboratory/statistics/table_change.h"

/// Whether a table did what it should: an axis before and after it was loaded.
namespace nonio::assessment {

struct LoadingVerdict {
  enum class Answer { worked, failed, not_decided };
  Answer answer = Answer::not_decided;  ///< not_decided: the readings do not decide it
  std::vector<Finding> findings{};      ///< of analysis before-after: pitch and reversal
  /// What the change between both campaigns is, as a table; none: not that of this table.
  std::optional<statistics::TableChange> change{};
  double E = 0.0;  ///< of the axis after loading, m or rad
};

/// `next`: the tables of the axis that were loaded between both campaigns. An error if one of the
/// campaigns has not exactly one measurement of the axis, if they are not of the same line, or if the
/// analysis before-after is not loaded.
Expected<LoadingVerdict> judge_loading(const reading::ReadCampaign& before,
                                       const reading::ReadCampaign& after, const std::string& axis,
                                       const std::vector<LoadedTable>& next,
                                       const evaluation::WantedController& control,
                                       const loader::Plugins& plugins);

}  // namespace nonio::assessment
