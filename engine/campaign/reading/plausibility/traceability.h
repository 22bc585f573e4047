// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

/// Checks dates of calibrations and received items. Source: ISO/IEC 17025:2017, 6.4.4 to 6.4.8
/// (equipment), 7.4 (items), 7.8.2.1 (dates).
namespace nonio::reading {

/// Years of validity of a calibration without a stated last day.
inline constexpr int unstated_validity = 2;

/// Returns `valid_until`, otherwise `calibrated` plus `unstated_validity`; empty without either.
std::string last_valid_day(const std::string& calibrated, const std::string& valid_until);

/// Reports calibrations that were made after the measurement or had expired, and items that were
/// received after the measurement. Each finding prevents a certificate; for an expired calibration,
/// a person may state a reason.
std::vector<Finding> traceability_findings(const Campaign& campaign);
bool is_expired_calibration(std::string_view id);

/// Returns the keys with a day after `today` (YYYY-MM-DD), and the reason.
std::vector<std::string> days_to_come(const Campaign& campaign, const std::string& today);

}  // namespace nonio::reading
