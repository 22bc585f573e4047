// SPDX-License-Identifier: Apache-2.0
// How often the causes of simulated circles are within 2 u of the truth: nonio_circles [CIRCLES] [SEED].
// So many circles in each scenario; rms: of (found - true)/u, 1 where u is right.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "exact_path.h"

int main(int argc, char** argv) {
  const int circles = argc > 1 ? std::atoi(argv[1]) : 2000;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  const char* const names[] = {
      "scale_mismatch", "squareness", "servo_mismatch", "B_X",   "B_Y",
      "lateral_X",      "lateral_Y",  "bow_X",          "bow_Y", "cyclic_X"};
  std::printf("%d circles in each scenario, seed %lld; %% within 2 u, rms\n", circles,
              static_cast<long long>(seed));
  const auto row = [&](const char* scenario, const std::vector<exact::Coverage>& found) {
    std::printf("%-22s", scenario);
    for (std::size_t k = 0; k < found.size(); ++k)
      std::printf("  %s %.1f %.2f", names[k], found[k].share(), found[k].rms());
    std::printf("\n");
  };
  std::vector<exact::Coverage> together(std::size(names));
  exact::Coverage all;
  for (const auto& scenario : exact::scenarios) {
    const auto found = exact::coverage(circles, scenario.noise, seed);
    row(scenario.name, found);
    for (std::size_t k = 0; k < found.size(); ++k) together[k] += found[k], all += found[k];
  }
  row("together", together);
  row(exact::wide_spikes.name,
      exact::coverage(circles, exact::wide_spikes.noise, seed, exact::wide_spikes.stick_deg));
  std::printf("largest values, %d circles\n", circles);
  for (const auto& scenario : exact::scenarios) {
    std::printf("%-22s", scenario.name);
    const auto found = exact::largest_coverage(circles, scenario.noise, seed);
    for (std::size_t k = 0; k < found.size(); ++k)
      std::printf("  %s %.1f %.2f", exact::largest_names[k], found[k].share(), found[k].rms());
    std::printf("\n");
  }
  std::printf("all %.2f %%\n", all.share());
  return all.all > 0 ? 0 : 1;
}
