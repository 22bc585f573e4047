// SPDX-License-Identifier: Apache-2.0
// How often the causes of simulated circles are within 2 u of the truth: nonio_circles [CIRCLES] [SEED]
#include <cstdio>
#include <cstdlib>

#include "exact_path.h"

int main(int argc, char** argv) {
  const int circles = argc > 1 ? std::atoi(argv[1]) : 2000;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  const char* const names[] = {
      "scale_mismatch", "squareness", "servo_mismatch", "B_X",   "B_Y",
      "lateral_X",      "lateral_Y",  "bow_X",          "bow_Y", "cyclic_X"};
  std::printf("%d circles in %d scenarios, seed %lld\n", circles,
              static_cast<int>(std::size(exact::scenarios)), static_cast<long long>(seed));
  exact::Coverage all;
  for (const auto& scenario : exact::scenarios) {
    const int share = circles / static_cast<int>(std::size(exact::scenarios));
    const auto found = exact::coverage(share, scenario.noise, seed);
    std::printf("%-22s", scenario.name);
    for (std::size_t k = 0; k < found.size(); ++k) {
      std::printf("  %s %.1f", names[k], found[k].share());
      all.within += found[k].within, all.all += found[k].all;
    }
    std::printf("\n");
  }
  std::printf("all %.2f %%\n", all.share());
  return all.all > 0 ? 0 : 1;
}
