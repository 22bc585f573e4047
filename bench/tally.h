// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>

/// What the benches of hidden effects count, and the numbers they are given.
namespace nonio::bench {

/// Share with its 95 % interval by Wilson's score.
struct Tally {
  std::uint64_t yes = 0, of = 0;
  void add(bool value) { yes += value ? 1 : 0, ++of; }
};

inline void print(const std::string& what, const Tally& t) {
  if (t.of == 0) return;
  const double n = static_cast<double>(t.of), p = static_cast<double>(t.yes) / n, z = 1.959964;
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  std::printf("  %-52s %5llu of %5llu  %6.2f %%  (%5.1f .. %5.1f)\n", what.c_str(),
              static_cast<unsigned long long>(t.yes), static_cast<unsigned long long>(t.of),
              100.0 * p, 100.0 * std::max(0.0, middle - half),
              100.0 * std::min(1.0, middle + half));
}

inline std::optional<std::uint64_t> whole(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace nonio::bench
