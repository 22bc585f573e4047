// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "batch/survey/survey.h"

namespace nonio::batch {

/// Looks at the campaigns `which` of `states` and completes them, on all cores, in child processes
/// that may hang or crash without harm to the run. An error only if no process can be had, or if
/// the register does not know a number.
Expected<void> look_at_all(const SurveyInput& input, std::span<const std::uint32_t> which,
                           std::vector<CampaignState>& states);

/// For a number that was issued before.
Error unknown_number(const std::string& number, const std::filesystem::path& out);

}  // namespace nonio::batch
