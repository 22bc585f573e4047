// SPDX-License-Identifier: Apache-2.0
#include "duplicates.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "nonio/sdk/format.h"

namespace nonio::csv {
namespace {

/// With more passes, this check needs more memory than sorting.
constexpr std::size_t most_passes = 100000;

Key key_of(const Observations& obs, std::size_t row) {
  return {obs.run[row], obs.axes[0].approach[row], obs.axes[0].position[row]};
}

std::array<std::vector<double>*, 6> value_columns(Observations& obs) {
  return {&obs.deviation, &obs.time, &obs.material, &obs.air, &obs.pressure, &obs.humidity};
}

bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool same_values(Observations& obs, std::size_t a, std::size_t b) {
  for (const std::vector<double>* column : value_columns(obs))
    if (!column->empty() && !same_number((*column)[a], (*column)[b])) return false;
  return true;
}

std::string target_text(const Observations::AxisColumn& axis, std::size_t row) {
  const Quantity quantity = position_of(axis.rotary);
  std::array<char, 40> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                                 printed(axis.position[row], quantity))
                       .ptr;
  return std::string(buffer.data(), end) + " " + std::string(unit_of(quantity).symbol);
}

Error contradiction(const Observations& obs, std::size_t first, std::size_t later) {
  Error error{"a second reading of run " + std::to_string(obs.run[first]) + ", direction " +
              (obs.axes[0].approach[first] > 0 ? "+" : "-") + " and target " +
              target_text(obs.axes[0], first) + ", different from the one in line " +
              std::to_string(obs.source_line[first]) +
              "; expected one, or an identical repetition"};
  error.line = obs.source_line[later];
  return error;
}

std::vector<std::uint32_t> sorted_rows(const Observations& obs) {
  std::vector<std::uint32_t> rows(obs.size());
  std::iota(rows.begin(), rows.end(), 0U);
  std::sort(rows.begin(), rows.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Key x = key_of(obs, a), y = key_of(obs, b);
    return x < y || (x == y && a < b);
  });
  return rows;
}

std::uint64_t count_missing(const Observations& obs, const std::vector<std::uint32_t>& rows,
                            std::vector<Key>& not_taken) {
  std::sort(not_taken.begin(), not_taken.end());
  not_taken.erase(std::unique(not_taken.begin(), not_taken.end()), not_taken.end());
  std::uint64_t missing = 0;
  auto row = rows.begin();
  for (const Key& key : not_taken) {
    row = std::lower_bound(row, rows.end(), key,
                           [&](std::uint32_t r, const Key& k) { return key_of(obs, r) < k; });
    if (row == rows.end() || !(key_of(obs, *row) == key)) ++missing;
  }
  return missing;
}

}  // namespace

void PassOrder::see(const Key& key) {
  if (!unique_) return;
  const std::uint64_t number = std::uint64_t{key.run} * 2 + (key.approach > 0 ? 1 : 0);
  if (number != current_) {
    const auto [it, inserted] = passes_.try_emplace(number);
    current_ = number;
    pass_ = &it->second;
    if (inserted) {
      pass_->last = key.target;
      unique_ = passes_.size() <= most_passes;
      return;
    }
  }
  const int sense = key.target > pass_->last ? 1 : key.target < pass_->last ? -1 : 0;
  unique_ = sense != 0 && (pass_->sense == 0 || sense == pass_->sense);
  *pass_ = {key.target, sense};
}

Expected<void> settle_duplicates(Observations& obs, std::vector<Key>& not_taken) {
  const std::vector<std::uint32_t> rows = sorted_rows(obs);
  std::vector<char> kept(obs.size(), 1);
  std::uint64_t dropped = 0;
  std::uint32_t first_dropped = 0;
  std::optional<std::pair<std::size_t, std::size_t>> worst;
  for (std::size_t i = 1, first = 0; i < rows.size(); ++i) {
    if (!(key_of(obs, rows[i]) == key_of(obs, rows[first]))) {
      first = i;
    } else if (same_values(obs, rows[first], rows[i])) {
      kept[rows[i]] = 0;
      first_dropped = dropped++ == 0 ? rows[i] : std::min(first_dropped, rows[i]);
    } else if (!worst || rows[i] < worst->second) {
      worst = {rows[first], rows[i]};
    }
  }
  if (worst) return fail(contradiction(obs, worst->first, worst->second));
  obs.missing = count_missing(obs, rows, not_taken);
  if (dropped == 0) return {};
  const auto count = [](const char* name, double n) {
    return nonio::Number{name, n, Quantity::count};
  };
  obs.notes.push_back({"csv.repeated-rows",
                       {count("rows", static_cast<double>(dropped)),
                        count("line", obs.source_line[first_dropped])}});
  keep_rows(obs, kept);
  return {};
}

}  // namespace nonio::csv
