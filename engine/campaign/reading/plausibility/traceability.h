// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

/// Checks dates: calibrations must be valid, and items received, on the day of the measurement.
/// Source: ISO/IEC 17025:2017, 6.4.4 to 6.4.8 (equipment), 7.4 (items), 7.8.2.1 (dates).
namespace nonio::reading {

/// Validity of a calibration in years, if its last day is not stated.
inline constexpr int unstated_validity = 2;

/// Returns the last day on which a calibration is valid: `valid_until`, otherwise the day
/// `unstated_validity` years after `calibrated`; empty if neither is stated.
std::string last_valid_day(const std::string& calibrated, const std::string& valid_until);

/// Returns findings about instruments that were calibrated after the measurement or whose
/// calibration had expired, and about items received after their measurement. Each prevents a
/// certificate; an expired calibration does not if the person who approves the certificate states a
/// reason.
std::vector<Finding> traceability_findings(const Campaign& campaign);
/// Whether a finding reports a calibration that had expired, or was too old, on the day of
/// measurement.
bool is_expired_calibration(std::string_view id);

/// Returns the keys whose day is after `today`, and why they prevent a certificate. Days are
/// YYYY-MM-DD.
std::vector<std::string> days_to_come(const Campaign& campaign, const std::string& today);

}  // namespace nonio::reading
