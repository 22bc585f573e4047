// SPDX-License-Identifier: Apache-2.0
#include "log.h"

#include <algorithm>
#include <chrono>

#include "lines.h"
#include "runs.h"

namespace nonio::camonitor {
using namespace readers;

namespace {

/// `count` digits at `at`; -1 if there is something else.
int digits(std::string_view text, std::size_t at, std::size_t count) {
  int value = 0;
  if (at + count > text.size()) return -1;
  for (const char c : text.substr(at, count)) {
    if (c < '0' || c > '9') return -1;
    value = 10 * value + (c - '0');
  }
  return value;
}

/// 2022-04-07 and 08:23:29.748369
std::optional<std::int64_t> time_of(std::string_view date, std::string_view time) {
  const int year = digits(date, 0, 4), month = digits(date, 5, 2), day = digits(date, 8, 2);
  const int h = digits(time, 0, 2), m = digits(time, 3, 2), s = digits(time, 6, 2);
  if (date.size() != 10 || date[4] != '-' || date[7] != '-' || time.size() < 8 || time[2] != ':' ||
      time[5] != ':' || h < 0 || h > 23 || m < 0 || m > 59 || s < 0 || s > 60)
    return std::nullopt;
  using namespace std::chrono;
  if (year < 1970 || month < 1 || day < 1) return std::nullopt;
  const year_month_day on{std::chrono::year{year}, std::chrono::month{static_cast<unsigned>(month)},
                          std::chrono::day{static_cast<unsigned>(day)}};
  if (!on.ok()) return std::nullopt;
  std::int64_t us = 0;
  if (time.size() > 8) {
    const std::size_t places = time.size() - 9;
    const int part = digits(time, 9, std::min<std::size_t>(places, 6));
    if (time[8] != '.' || places == 0 || places > 9 || part < 0) return std::nullopt;
    us = part;
    for (std::size_t i = places; i < 6; ++i) us *= 10;
  }
  const auto days = sys_days{on}.time_since_epoch().count();
  return ((days * 24LL + h) * 60 + m) * 60'000'000LL + s * 1'000'000LL + us;
}

}  // namespace

std::optional<Entry> entry_of(std::string_view line) {
  const auto fields = by_blanks(line);
  if (fields.size() < 4) return std::nullopt;
  const auto time = time_of(fields[1], fields[2]);
  if (!time) return std::nullopt;
  return Entry{fields[0], fields[3], *time, 0};
}

Expected<std::vector<Entry>> entries_of(std::string_view bytes,
                                        const std::vector<std::string_view>& pvs) {
  std::vector<Entry> entries;
  Lines lines(bytes);
  std::string_view line;
  while (lines.next(line)) {
    const auto fields = by_blanks(line);
    if (fields.empty() || std::find(pvs.begin(), pvs.end(), fields[0]) == pvs.end()) {
      if (auto error = not_text(line)) return fail(at_line(lines.number(), error->message));
      continue;
    }
    auto entry = entry_of(line);
    if (!entry)
      return fail(at_line(lines.number(),
                          "expected PV, date, time and value, such as \"AXIS:Pos 2022-04-07 "
                          "08:23:29.748369 33.46\"; found " +
                              shown(line)));
    entry->line = lines.number();
    entries.push_back(*entry);
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.time < b.time; });
  return entries;
}

}  // namespace nonio::camonitor
