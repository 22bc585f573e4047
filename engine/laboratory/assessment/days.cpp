// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/days.h"

#include <array>
#include <chrono>
#include <cstdio>

namespace nonio::assessment {
namespace chrono = std::chrono;

namespace {

std::optional<chrono::year_month_day> date_of(const std::string& day) {
  int year = 0, end = 0;
  unsigned month = 0, of_month = 0;
  if (day.size() != 10 ||
      std::sscanf(day.c_str(), "%4d-%2u-%2u%n", &year, &month, &of_month, &end) != 3 || end != 10)
    return std::nullopt;
  const chrono::year_month_day date{chrono::year(year), chrono::month(month),
                                    chrono::day(of_month)};
  return date.ok() ? std::optional(date) : std::nullopt;
}

std::string text_of(const chrono::year_month_day& date) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02u", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
  return text.data();
}

}  // namespace

std::optional<std::int64_t> day_number(const std::string& day) {
  const auto date = date_of(day);
  if (!date) return std::nullopt;
  return chrono::sys_days(*date).time_since_epoch().count();
}

std::string day_text(std::int64_t number) {
  return text_of(chrono::year_month_day(
      chrono::sys_days(chrono::days(static_cast<chrono::days::rep>(number)))));
}

std::string months_later(const std::string& day, int months) {
  auto date = date_of(day);
  if (!date) return {};
  *date += chrono::months(months);
  if (!date->ok()) *date = date->year() / date->month() / chrono::last;
  return text_of(*date);
}

}  // namespace nonio::assessment
