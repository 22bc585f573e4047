// SPDX-License-Identifier: Apache-2.0
#include "consumer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace nonio::fanuc {
namespace {

struct Memory {
  std::map<std::int64_t, std::int64_t> parameter;  // of the axis
  std::map<std::int64_t, std::int64_t> pitch;      // by point number
};

// N<number>[A<axis>]P<value>, one block a line.
Expected<void> block(Memory& memory, std::string_view line, const Machine& machine) {
  std::int64_t number = -1, axis = 0, value = 0;
  bool has_value = false;
  const auto whole_line = std::string(line);
  while (!line.empty()) {
    const char letter = line.front();
    std::int64_t n = 0;
    const auto r = std::from_chars(line.data() + 1, line.data() + line.size(), n);
    if (r.ec != std::errc() || (letter != 'N' && letter != 'A' && letter != 'P'))
      return fail("not a block: " + whole_line);
    if (letter == 'N') number = n;
    if (letter == 'A') axis = n;
    if (letter == 'P') value = n, has_value = true;
    line.remove_prefix(static_cast<std::size_t>(r.ptr - line.data()));
  }
  if (number < 0 || !has_value) return fail("not a block: " + whole_line);
  if (number < 10000) {
    if (axis == machine.axis) memory.parameter[number] = value;
    return {};
  }
  if (axis != 0) return fail("pitch data do not belong to an axis: " + whole_line);
  if (value < machine.least || value > machine.most) return fail("out of range: " + whole_line);
  if (!memory.pitch.emplace(number - 10000, value).second)
    return fail("point given twice: " + whole_line);
  return {};
}

Expected<Memory> punched(std::string_view text, const Machine& machine) {
  Memory memory;
  int percents = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!line.empty() && (line.back() == '\r' || line.back() == ';')) line.remove_suffix(1);
    if (line.empty()) continue;
    if (line == "%") {
      ++percents;
    } else if (percents != 1) {
      return fail("a block outside of the two %");
    } else if (auto ok = block(memory, line, machine); !ok) {
      return tl::unexpected<Error>(ok.error());
    }
  }
  if (percents != 2) return fail("not enclosed by %");
  return memory;
}

// Absolute compensation at the ends of the intervals of one set, zero at the reference position.
struct Staircase {
  double first = 0.0, interval = 1.0;  // position of value[0]
  std::vector<double> value;           // in pulses

  double at(double x) const {
    const double k = (x - first) / interval;
    if (k <= 0.0) return value.front();
    if (k >= static_cast<double>(value.size() - 1)) return value.back();
    const auto i = static_cast<std::size_t>(k);
    return value[i] + (k - static_cast<double>(i)) * (value[i + 1] - value[i]);
  }
};

// Number n holds the change over the interval that ends n - reference intervals from the
// reference position. `offset`: from the numbers of the plus set to those of this one.
Expected<Staircase> staircase(const Memory& m, std::int64_t offset, double interval,
                              double reference) {
  const std::int64_t zero = m.parameter.at(3620), low = m.parameter.at(3621),
                     high = m.parameter.at(3622);
  Staircase s;
  s.interval = interval;
  s.first = reference + static_cast<double>(low - 1 - zero) * interval;
  double sum = 0.0, at_reference = 0.0;
  s.value.push_back(0.0);
  for (std::int64_t n = low; n <= high; ++n) {
    const auto it = m.pitch.find(n + offset);
    if (it == m.pitch.end()) return fail("no data for point " + std::to_string(n + offset));
    sum += static_cast<double>(it->second);
    s.value.push_back(sum);
    if (n == zero) at_reference = sum;
  }
  for (double& v : s.value) v -= at_reference;
  return s;
}

// A turn ends where it began, and the number of the reference position repeats the last one.
bool closed(const Staircase& s) {
  const std::size_t n = s.value.size();
  return n > 2 && s.value[n - 1] == s.value[1] && s.value[n - 2] == s.value[0];
}

}  // namespace

Expected<math::Correction> load(std::string_view text, const Machine& machine) {
  auto memory = punched(text, machine);
  if (!memory) return tl::unexpected<Error>(memory.error());
  for (const std::int64_t n : {3620, 3621, 3622, 3623, 3624})
    if (memory->parameter.count(n) == 0) return fail("no parameter " + std::to_string(n));
  const auto& p = memory->parameter;
  if (p.at(3621) > p.at(3620) || p.at(3620) >= p.at(3622) || p.at(3624) <= 0 || p.at(3623) < 1 ||
      p.at(3623) > 100)
    return fail("3620 to 3624 do not make a table");
  const double interval = static_cast<double>(p.at(3624)) * machine.interval_unit;
  const bool turn = machine.rotary && p.count(3625) != 0;
  if (turn && std::fabs(static_cast<double>(p.at(3625)) * machine.interval_unit -
                        2.0 * std::numbers::pi) > 1e-9)
    return fail("3625 is not a turn");

  auto plus = staircase(*memory, 0, interval, machine.reference);
  if (!plus) return tl::unexpected<Error>(plus.error());
  Staircase minus = *plus;
  double shift = 0.0;
  if (machine.bidirectional) {
    if (p.count(3626) == 0 || p.count(3627) == 0) return fail("no parameters 3626 and 3627");
    auto other = staircase(*memory, p.at(3626) - p.at(3621), interval, machine.reference);
    if (!other) return tl::unexpected<Error>(other.error());
    minus = *other;
    shift = static_cast<double>(p.at(3627));
  }
  if (turn && !(closed(*plus) && closed(minus)))
    return fail("the increments of a turn do not close it");

  const auto lost = p.find(1851);
  const double backlash =
      lost == p.end() ? machine.backlash : static_cast<double>(lost->second) * machine.detection;
  const double pulse = static_cast<double>(p.at(3623)) * machine.detection;
  return math::Correction([=, up = *plus, down = minus](double x, int direction) {
    if (turn) {
      const double full = 2.0 * std::numbers::pi;
      const double past = std::fmod(std::fmod(x - machine.reference, full) + full, full);
      x = machine.reference + past;
    }
    const bool shifted = (direction < 0) == machine.returns_towards_plus;
    const double sum = (direction > 0 ? up : down).at(x) + (shifted ? shift : 0.0);
    return pulse * sum + (direction > 0 ? backlash / 2.0 : -backlash / 2.0);
  });
}

}  // namespace nonio::fanuc
