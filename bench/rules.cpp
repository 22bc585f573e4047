// SPDX-License-Identifier: Apache-2.0
//
// The cost of all rules of positioning compared with ISO 230-2 and VDI/DGQ 3441 alone.
//
//     bench_rules [--rounds N] [--most RATIO]
//
// CPU time of both in turn, on the same readings (21 targets, 5 runs, both directions), and their
// ratio: the median of the rounds. --most: status 1 if it is larger.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "axis_builder.h"
#include "loaded_analysis.h"
#include "nonio/math/positioning.h"

using namespace nonio;

namespace {

Settings defaults(const Analysis& a) {
  Settings s;
  for (const Option& o : a.info.options) s.values[o.name] = o.default_value;
  return s;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// CPU seconds of one evaluation.
double cost(const Analysis& a, const AnalysisInput& in) {
  const double begun = cpu_seconds();
  if (const auto done = a.analyse(in); !done) throw std::runtime_error(done.error().message);
  return cpu_seconds() - begun;
}

Campaign campaign() {
  Campaign c;
  Axis x;
  x.name = "X";
  x.expansion = 11.5e-6;
  c.machine.axes.push_back(x);
  c.instrument.U_fixed = 1e-7, c.instrument.U_per_length = 5e-7;
  Environment& e = c.environment;
  e.misalignment = 5e-4, e.temperature_range = 0.2, e.temperature_difference = 0.5;
  e.expansion_range = 1e-6, e.drift = 5e-7;
  Measurement m;
  m.id = m.axis = "X";
  m.kind = "axis";
  c.measurements.push_back(std::move(m));
  return c;
}

Observations readings() {
  made::Random random(20261);
  made::Plan plan;
  plan.targets = made::spread_targets(random, 21, 2.0);
  plan.runs = 5;
  Observations o = made::observe(
      plan, [](double x, int d, std::uint32_t) { return 5e-6 * x + (d > 0 ? -2e-6 : 0.0); },
      {3e-7, 1e-7, 1e-7, 1.0}, random);
  o.axes[0].axis = "X";
  return o;
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 200;
  double most = 0.0;
  for (int k = 1; k + 1 < argc; k += 2) {
    if (std::strcmp(argv[k], "--rounds") == 0) rounds = std::atoi(argv[k + 1]);
    if (std::strcmp(argv[k], "--most") == 0) most = std::atof(argv[k + 1]);
  }
  const Analysis iso = loaded_analysis(NONIO_ANALYSES, "iso230-2"),
                 vdi = loaded_analysis(NONIO_ANALYSES, "vdi-dgq-3441"),
                 all = loaded_analysis(NONIO_ANALYSES, "positioning");
  const Settings of_iso = defaults(iso), of_vdi = defaults(vdi);
  Settings of_all = defaults(all);
  std::vector<std::string> rules;
  for (const auto& rule : math::positioning_rules()) rules.emplace_back(rule.name);
  of_all.values["rules"] = rules;
  const Campaign c = campaign();
  const Observations o = readings();
  const auto input = [&](const Settings& s) { return AnalysisInput{c, c.measurements[0], o, s}; };
  std::vector<double> ratios;
  double two = 0.0, every = 0.0;
  for (int round = 0; round < rounds; ++round) {
    const double a = cost(iso, input(of_iso)) + cost(vdi, input(of_vdi)),
                 b = cost(all, input(of_all));
    two += a, every += b;
    if (a > 0.0) ratios.push_back(b / a);
  }
  if (ratios.empty()) return 2;
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
                   ratios.end());
  const double ratio = ratios[ratios.size() / 2];
  std::printf(
      "ISO 230-2 and VDI/DGQ 3441 %.3f ms, all %zu rules %.3f ms; median of %zu ratios %.2f\n",
      1e3 * two / rounds, rules.size(), 1e3 * every / rounds, ratios.size(), ratio);
  return most > 0.0 && ratio > most ? 1 : 0;
}
