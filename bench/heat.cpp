// SPDX-License-Identifier: Apache-2.0
// How often U holds the truth of simulated thermal tests, spindles and lengths: nonio_heat [COUNT] [SEED]
#include <cstdio>
#include <cstdlib>

#include "made_heat.h"

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 2000;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  std::printf("%d of each, seed %lld\n", count, static_cast<long long>(seed));
  for (const auto& [what, found] : {std::pair{"thermal", heat::thermal_coverage(count, seed)},
                                    {"spindle", heat::spindle_coverage(count, seed)},
                                    {"lengths", heat::lengths_coverage(count, seed)}})
    for (const auto& [name, c] : found)
      std::printf("%-8s %-18s %5.1f %% of %d\n", what, name.c_str(), c.share(), c.all);
  return 0;
}
