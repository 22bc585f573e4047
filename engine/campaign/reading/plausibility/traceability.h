// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

/// Days that cannot be: what makes a measurement traceable holds on the day on which it was made.
/// Source: ISO/IEC 17025:2017, 6.4.4 to 6.4.8 (equipment), 7.4 (items), 7.8.2.1 (dates).
namespace nonio::reading {

/// Validity in years of a calibration whose last day is not stated.
inline constexpr int unstated_validity = 2;

/// The last day on which a calibration holds; empty if its day is not stated.
std::string last_valid_day(const std::string& calibrated, const std::string& valid_until);

/// Instruments that were calibrated after the measurement, or whose calibration held no longer; an
/// item that came after it was measured. Any of them stops a certificate; an expired calibration
/// unless the person who releases it states a reason.
std::vector<Finding> traceability_findings(const Campaign& campaign);
/// A calibration that held no longer on the day of the measurement, or was too long ago to hold.
bool is_expired_calibration(std::string_view id);

/// Keys with a day that has not come yet on `today`, and why they stop a certificate. Days are
/// YYYY-MM-DD.
std::vector<std::string> days_to_come(const Campaign& campaign, const std::string& today);

}  // namespace nonio::reading
