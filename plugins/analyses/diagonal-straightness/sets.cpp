// SPDX-License-Identifier: Apache-2.0
#include "sets.h"

#include <algorithm>

namespace nonio::diagonal_straightness {

std::vector<Set> sets_of(const Campaign& campaign) {
  std::vector<Set> sets;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.kind != "diagonal") continue;
    const std::string name = state_of(m);
    auto at = std::find_if(sets.begin(), sets.end(), [&](const Set& s) { return s.name == name; });
    if (at == sets.end()) at = sets.insert(sets.end(), Set{name, {}});
    at->lines.push_back(i);
  }
  // The first set is the one before the adjustment; unless stated, the first of the manifest.
  const auto rank = [&](const Set& set) {
    for (const std::size_t i : set.lines)
      if (const std::string& stated = campaign.measurements[i].adjustment; !stated.empty())
        return stated == "before" ? 0 : 2;
    return 1;
  };
  std::stable_sort(sets.begin(), sets.end(),
                   [&](const Set& a, const Set& b) { return rank(a) < rank(b); });
  return sets;
}

const Set* set_led_by(const std::vector<Set>& sets, const Campaign& campaign,
                      const Measurement& m) {
  for (const Set& set : sets)
    if (campaign.measurements[set.lines.front()].id == m.id) return &set;
  return nullptr;
}

}  // namespace nonio::diagonal_straightness
