// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/number_pattern.h"

#include <algorithm>

#include "platform/storage/files.h"

namespace nonio::config {

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

struct Place {
  std::size_t begin = std::string::npos, size = 0, digits = 1;
};

Place place_of(const std::string& pattern) {
  constexpr std::string_view plain = "{number}", open = "{number:";
  Place place{pattern.find(plain), plain.size()};
  if (place.begin != std::string::npos) return place;
  const std::size_t at = pattern.find(open);
  const std::size_t digit = at + open.size();
  if (at == std::string::npos || digit + 1 >= pattern.size() || pattern[digit] < '1' ||
      pattern[digit] > '9' || pattern[digit + 1] != '}')
    return place;
  return {at, open.size() + 2, static_cast<std::size_t>(pattern[digit] - '0')};
}

}  // namespace

std::string sequence_of(const std::string& pattern, const std::string& year) {
  const Place place = place_of(pattern);
  std::string sequence = pattern;
  if (place.begin != std::string::npos) sequence.replace(place.begin, place.size, "{number}");
  return replaced(sequence, "{year}", year);
}

Expected<std::string> number_text(const std::string& pattern, const std::string& year,
                                  std::uint64_t number) {
  constexpr std::size_t longest = 60;
  const auto refuse = [&](const std::string& what) {
    return fail("the pattern \"" + pattern + "\" " + what);
  };
  const Place place = place_of(pattern);
  if (place.begin == std::string::npos)
    return refuse(
        "has no place for the number; expected {number} or {number:4} once, and {year} if the "
        "numbers are to begin anew with each year");
  std::string digits = std::to_string(number);
  digits.insert(0, place.digits > digits.size() ? place.digits - digits.size() : 0, '0');
  std::string text = pattern;
  text.replace(place.begin, place.size, digits);
  text = replaced(text, "{year}", year);
  if (text.find_first_of("{}") != std::string::npos)
    return refuse("has another place than {year} and one {number}");
  const bool plain =
      std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (!plain || !storage::is_artifact_name(text) || text.front() == ' ' || text.back() == ' ' ||
      text.size() > longest)
    return refuse("gives \"" + text +
                  "\"; expected at most 60 letters, digits and signs of ASCII without / and \\, no "
                  "dot at the beginning, no blank at the ends: files are named by it");
  return text;
}

}  // namespace nonio::config
