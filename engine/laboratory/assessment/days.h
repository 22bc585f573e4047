// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace nonio::assessment {

/// Days since 1970-01-01 of YYYY-MM-DD; nothing of what is no day.
std::optional<std::int64_t> day_number(const std::string& day);
std::string day_text(std::int64_t number);
/// The same day of a later month, the last one where that has none.
std::string months_later(const std::string& day, int months);

inline constexpr double days_a_year = 365.25;

}  // namespace nonio::assessment
