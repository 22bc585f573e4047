// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluation.h"
#include "laboratory/statistics/table_change.h"

/// Verdict on a loaded table from measurements of an axis before and after loading.
namespace nonio::assessment {

struct LoadingVerdict {
  enum class Answer { worked, failed, not_decided };
  Answer answer = Answer::not_decided;
  std::vector<Finding> findings{};  ///< pitch and reversal, from the analysis before-after
  /// Change between both campaigns that a table would cause; std::nullopt if the tables worked, if
  /// the former table is unknown or if the change has another form.
  std::optional<statistics::TableChange> change{};
  double E = 0.0;  ///< E of the axis after loading (ISO 230-2), m or rad
};

/// Assesses the tables `next` of an axis, which were loaded between both campaigns. An error unless
/// each campaign contains one measurement of the axis, both along the same line, and the analysis
/// before-after is loaded.
Expected<LoadingVerdict> judge_loading(const reading::ReadCampaign& before,
                                       const reading::ReadCampaign& after, const std::string& axis,
                                       const std::vector<LoadedTable>& next,
                                       const evaluation::WantedController& control,
                                       const loader::Plugins& plugins);

}  // namespace nonio::assessment
