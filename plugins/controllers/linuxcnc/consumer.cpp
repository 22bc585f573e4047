// SPDX-License-Identifier: Apache-2.0
#include "consumer.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <vector>

namespace nonio::linuxcnc {
namespace {

struct Line {
  double nominal;
  float forward, reverse;  // trims: added to the motor's position; the controller keeps floats
};

std::optional<double> next_number(std::string_view& rest) {
  const std::size_t start = rest.find_first_not_of(" \t\r");
  if (start == std::string_view::npos) return {};
  rest.remove_prefix(start);
  double value = 0.0;
  const char* begin = rest.data() + (rest.front() == '+' ? 1 : 0);
  const auto r = std::from_chars(begin, rest.data() + rest.size(), value);
  if (r.ec != std::errc()) return {};
  rest.remove_prefix(static_cast<std::size_t>(r.ptr - rest.data()));
  return value;
}

std::vector<Line> taken(std::string_view bytes, const Machine& machine) {
  std::vector<Line> lines;
  while (!bytes.empty() && lines.size() < machine.most) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string_view line = bytes.substr(0, end);
    if (line.size() > 254) break;
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    const auto nominal = next_number(line), plus = next_number(line), minus = next_number(line);
    if (!nominal || !plus || !minus) break;  // here the reader stops for good
    if (!lines.empty() && !(*nominal > lines.back().nominal)) continue;
    const bool actual = machine.type == 0;  // else the trims themselves
    lines.push_back({*nominal, static_cast<float>(actual ? *nominal - *plus : *plus),
                     static_cast<float>(actual ? *nominal - *minus : *minus)});
  }
  return lines;
}

}  // namespace

std::size_t lines_taken(std::string_view bytes, const Machine& machine) {
  return taken(bytes, machine).size();
}

Expected<math::Correction> load(std::string_view bytes, const Machine& machine) {
  auto lines = taken(bytes, machine);
  if (lines.empty()) return fail("no line is taken: there is no compensation");
  return math::Correction(
      [lines = std::move(lines), per_si = machine.per_si](double x, int direction) {
        const auto trim = [&](const Line& l) {
          return static_cast<double>(direction > 0 ? l.forward : l.reverse);
        };
        const double at = x * per_si;
        if (at <= lines.front().nominal) return trim(lines.front()) / per_si;
        if (at >= lines.back().nominal) return trim(lines.back()) / per_si;
        std::size_t i = 1;
        while (lines[i].nominal < at) ++i;
        const Line &a = lines[i - 1], &b = lines[i];
        const double t = (at - a.nominal) / (b.nominal - a.nominal);
        return (trim(a) + t * (trim(b) - trim(a))) / per_si;
      });
}

}  // namespace nonio::linuxcnc
