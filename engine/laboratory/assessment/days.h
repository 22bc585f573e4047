// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace nonio::assessment {

/// Returns the number of days since 1970-01-01; std::nullopt if `day` is not a date YYYY-MM-DD.
std::optional<std::int64_t> day_number(const std::string& day);
std::string day_text(std::int64_t number);
/// Returns the same day of a later month, or the last day if the month is shorter; empty if `day`
/// is not a date YYYY-MM-DD.
std::string months_later(const std::string& day, int months);

inline constexpr double days_a_year = 365.25;

}  // namespace nonio::assessment
