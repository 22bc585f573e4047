// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "campaign/reading/plausibility/plausibility.h"

namespace nonio::reading {

/// Compares the decimals of the last number with those above. A complete last line is not examined.
std::vector<Finding> implausible_end(std::string_view bytes, const std::string& file) {
  if (bytes.empty() || bytes.back() == '\n' || bytes.back() == '\r') return {};
  constexpr std::size_t window = 65536;
  if (bytes.size() > window) bytes = bytes.substr(bytes.size() - window);
  const auto last_field = [](std::string_view line, std::size_t& fields) {
    fields = 1 + static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) {
               return c == ',' || c == ';' || c == '\t';
             }));
    const bool comma = line.find_first_of(";\t") == line.npos;
    const std::size_t at = line.find_last_of(comma ? "," : ";\t");
    return at == line.npos ? line : line.substr(at + 1);
  };
  const auto decimals = [](std::string_view number) -> std::ptrdiff_t {
    if (number.find_first_not_of("+-0123456789.,") != number.npos || number.empty()) return -1;
    const std::size_t point = number.find_first_of(".,");
    return point == number.npos ? 0 : static_cast<std::ptrdiff_t>(number.size() - point - 1);
  };
  std::vector<std::string_view> lines;
  while (!bytes.empty()) {
    const std::size_t at = bytes.rfind('\n');
    std::string_view line = at == bytes.npos ? bytes : bytes.substr(at + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    bytes = at == bytes.npos ? std::string_view() : bytes.substr(0, at);
  }
  std::size_t own_fields = 0, fields = 0;
  const std::string_view own = last_field(lines.front(), own_fields);
  const std::ptrdiff_t digits = decimals(own);
  std::ptrdiff_t fewest = -1;
  std::size_t seen = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::ptrdiff_t d = decimals(last_field(lines[i], fields));
    if (fields != own_fields || d < 0) continue;
    fewest = seen++ == 0 ? d : std::min(fewest, d);
  }
  const bool cut = own_fields > 1 && seen >= 3 && (digits < fewest || own == "-" || own == "+");
  if (!cut) return {};
  return {{.id = "plausibility.file-cut-short",
           .attention = true,
           .evidence = {{"digits", static_cast<double>(std::max<std::ptrdiff_t>(digits, 0)),
                         Quantity::count},
                        {"others", static_cast<double>(fewest), Quantity::count}},
           .texts = {{"file", file}, {"found", std::string(own)}}}};
}

}  // namespace nonio::reading
