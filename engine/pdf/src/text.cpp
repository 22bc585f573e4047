// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/text.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>

namespace nonio::pdf {

Calendar calendar(Time time) {
  namespace chrono = std::chrono;
  const chrono::sys_seconds at{chrono::seconds(time)};
  const auto day = chrono::floor<chrono::days>(at);
  const chrono::year_month_day date(day);
  const chrono::hh_mm_ss clock(at - day);
  return {static_cast<int>(date.year()),
          static_cast<unsigned>(date.month()),
          static_cast<unsigned>(date.day()),
          static_cast<int>(clock.hours().count()),
          static_cast<int>(clock.minutes().count()),
          static_cast<int>(clock.seconds().count())};
}

std::string date_text(Time time) {
  const Calendar c = calendar(time);
  std::array<char, 64> text{};
  const int n = std::snprintf(text.data(), text.size(), "(D:%04d%02u%02u%02d%02d%02dZ)", c.year,
                              c.month, c.day, c.hours, c.minutes, c.seconds);
  return {text.data(), static_cast<std::size_t>(n)};
}

Expected<Time> time_in(std::string_view text) {
  constexpr std::string_view form = "(D:00000000000000Z)";
  const bool fits = text.size() == form.size() &&
                    std::equal(text.begin(), text.end(), form.begin(), [](char c, char f) {
                      return f == '0' ? c >= '0' && c <= '9' : c == f;
                    });
  if (!fits) return fail("does not state when it was signed as Nonio states it");
  const auto number = [&](std::size_t at, std::size_t count) {
    int value = 0;
    for (const char c : text.substr(at, count)) value = value * 10 + (c - '0');
    return value;
  };
  namespace chrono = std::chrono;
  const chrono::year_month_day date{chrono::year(number(3, 4)),
                                    chrono::month(static_cast<unsigned>(number(7, 2))),
                                    chrono::day(static_cast<unsigned>(number(9, 2)))};
  const int hours = number(11, 2), minutes = number(13, 2), seconds = number(15, 2);
  if (!date.ok() || hours > 23 || minutes > 59 || seconds > 60)
    return fail("states that it was signed at a time that does not exist");
  return chrono::sys_seconds(chrono::sys_days(date)).time_since_epoch().count() +
         hours * Time{3600} + minutes * Time{60} + seconds;
}

Expected<std::string> utf16(std::string_view text) {
  std::string out = "\xFE\xFF";
  const auto put = [&](std::uint32_t unit) {
    out += static_cast<char>(unit >> 8);
    out += static_cast<char>(unit & 0xFF);
  };
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t more = lead < 0x80 ? 0 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
    if ((lead >= 0x80 && lead < 0xC2) || lead > 0xF4 || i + more >= text.size())
      return fail("expected text in UTF-8");
    std::uint32_t c = more == 0 ? lead : lead & (0x3FU >> more);
    for (std::size_t k = 1; k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xC0) != 0x80) return fail("expected text in UTF-8");
      c = c << 6 | (next & 0x3FU);
    }
    i += more + 1;
    if (c < 0x10000) {
      put(c);
    } else {
      put(0xD800 + ((c - 0x10000) >> 10));
      put(0xDC00 + ((c - 0x10000) & 0x3FF));
    }
  }
  return out;
}

Expected<std::string> utf8(std::string_view text) {
  if (!text.starts_with("\xFE\xFF") || text.size() % 2 != 0) return fail("expected text in UTF-16");
  const auto unit = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]) << 8 |
                                      static_cast<unsigned char>(text[i + 1]));
  };
  std::string out;
  for (std::size_t i = 2; i < text.size(); i += 2) {
    std::uint32_t c = unit(i);
    if (c >= 0xD800 && c < 0xDC00 && i + 3 < text.size() && (unit(i + 2) & 0xFC00U) == 0xDC00) {
      i += 2;
      c = 0x10000 + ((c - 0xD800) << 10) + (unit(i) - 0xDC00);
    }
    if (c < 0x20 || (c >= 0xD800 && c < 0xE000)) return fail("expected text in UTF-16");
    const int more = c < 0x80 ? 0 : c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
    constexpr unsigned char lead[] = {0, 0xC0, 0xE0, 0xF0};
    out += static_cast<char>(lead[more] | c >> (6 * more));
    for (int k = more - 1; k >= 0; --k) out += static_cast<char>(0x80 | ((c >> (6 * k)) & 0x3F));
  }
  return out;
}

std::string hexadecimal(std::string_view bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out = "<";
  for (const char c : bytes) {
    out += digits[static_cast<unsigned char>(c) >> 4];
    out += digits[static_cast<unsigned char>(c) & 15];
  }
  return out + ">";
}

std::string reference(std::size_t number) { return std::to_string(number) + " 0 R"; }

std::string plain_name(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const bool kept = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                      std::string_view("-_./ ").find(c) != std::string_view::npos;
    out += kept ? c : '_';
  }
  return out;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t most = 200;
  return "\"" + std::string(text.substr(0, most)) + (text.size() > most ? "..." : "") + "\"";
}

}  // namespace nonio::pdf
