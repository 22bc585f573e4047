// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/observations.h"

#include <limits>
#include <type_traits>

namespace nonio {

void keep_rows(Observations& o, const std::vector<char>& kept) {
  for_each_column(o, [&](auto& column) {
    if (column.empty()) return;
    std::size_t to = 0;
    for (std::size_t i = 0; i < kept.size(); ++i)
      if (kept[i] != 0) column[to++] = column[i];
    column.resize(to);
  });
}

void append_measured(Observations& to, const Observations& more) {
  const std::size_t before = to.size(), after = before + more.size();
  for_each_measured_column(
      [&](auto& column, const auto& added) {
        using T = typename std::remove_reference_t<decltype(column)>::value_type;
        if (column.empty() && added.empty()) return;
        T absent{};
        if constexpr (std::is_floating_point_v<T>)
          absent = std::numeric_limits<T>::quiet_NaN();
        else if (&column == &to.run)
          absent = 1;
        column.resize(before, absent);
        column.insert(column.end(), added.begin(), added.end());
        column.resize(after, absent);
      },
      to, more);
  to.deviation.insert(to.deviation.end(), more.deviation.begin(), more.deviation.end());
}

Observations rearranged(const Observations& o, const std::vector<std::uint32_t>& order) {
  Observations out = o;
  for_each_column(out, [&](auto& column) {
    if (column.empty()) return;
    std::remove_reference_t<decltype(column)> arranged;
    arranged.reserve(order.size());
    for (const std::uint32_t i : order) arranged.push_back(column[i]);
    column = std::move(arranged);
  });
  return out;
}

}  // namespace nonio
