// SPDX-License-Identifier: Apache-2.0
// Analyses that break one law each, which their name says.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "nonio/sdk/plugin.h"

using namespace nonio;

namespace {

struct Extremes {
  double low = 0.0, high = 0.0, mean = 0.0;
  double range() const { return high - low; }
};

Extremes extremes(const std::vector<double>& d) {
  Extremes e;
  if (d.empty()) return e;
  e.low = *std::min_element(d.begin(), d.end());
  e.high = *std::max_element(d.begin(), d.end());
  auto sorted = d;  // so that the order of rows is not in the rounding
  std::sort(sorted.begin(), sorted.end());
  for (const double x : sorted) e.mean += x / static_cast<double>(d.size());
  return e;
}

Evaluation one(const AnalysisInput& in, double value) {
  Evaluation e;
  e.values.push_back({"value", value, deviation_of(in.observations.angular)});
  return e;
}

Expected<Evaluation> first(const AnalysisInput& in) {
  if (in.observations.size() == 0) return fail("expected readings");
  return one(in, in.observations.deviation.front());
}
Expected<Evaluation> rms(const AnalysisInput& in) {
  double sum = 0.0;
  for (const double d : in.observations.deviation) sum += d * d;
  return one(in,
             std::sqrt(sum / std::max<double>(1.0, static_cast<double>(in.observations.size()))));
}
Expected<Evaluation> squared(const AnalysisInput& in) {
  const double r = extremes(in.observations.deviation).range();
  return one(in, r * r * 1e5);
}
Expected<Evaluation> above(const AnalysisInput& in) {
  const Extremes e = extremes(in.observations.deviation);
  return one(in, e.high - e.mean);
}
Expected<Evaluation> of_x(const AnalysisInput& in) {
  return one(
      in, extremes(in.observations.deviation).range() * (in.measurement.axis == "X" ? 2.0 : 1.0));
}
Expected<Evaluation> divided(const AnalysisInput& in) {
  const double travel = extremes(in.observations.axes.front().position).range();
  return one(in, extremes(in.observations.deviation).range() * travel / travel);
}
Expected<Evaluation> counting(const AnalysisInput& in) {
  static int counter = 0;
  Evaluation e = one(in, extremes(in.observations.deviation).range());
  e.findings.push_back({.id = "counted", .texts = {{"n", std::to_string(++counter)}}});
  return e;
}
Expected<Evaluation> crashing(const AnalysisInput& in) {
  volatile int* nowhere = nullptr;
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): the fault is the test
  if (in.observations.size() == 0) *nowhere = 1;
  return one(in, extremes(in.observations.deviation).range());
}
Expected<Evaluation> looping(const AnalysisInput& in) {
  volatile double range = extremes(in.observations.deviation).range();
  while (in.observations.size() > 1 && range == 0.0) range = 0.0;
  return one(in, range);
}

Expected<Evaluation> silent(const AnalysisInput&) { return Evaluation{}; }
Expected<Evaluation> failing(const AnalysisInput&) { return fail("expected something else"); }
Expected<Evaluation> endless(const AnalysisInput& in) {
  volatile bool on = true;
  while (on) on = true;
  return one(in, 0.0);
}
Expected<Evaluation> at_home(const AnalysisInput& in) {
  Evaluation e = one(in, extremes(in.observations.deviation).range());
  const char* home = std::getenv("HOME");
  e.notes.push_back({.id = "home", .texts = {{"home", home == nullptr ? "" : home}}});
  return e;
}

Analysis made(const char* name, Expected<Evaluation> (*analyse)(const AnalysisInput&)) {
  Analysis a;
  a.info = {name, "1", "Wrong on purpose"};
  a.applies = [](const Campaign&, const Measurement& m) { return m.kind == "axis"; };
  a.analyse = analyse;
  return a;
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(made("order-of-rows", first));
  registry.add(made("moves-with-zero", rms));
  registry.add(made("not-to-scale", squared));
  registry.add(made("one-sided", above));
  registry.add(made("likes-x", of_x));
  registry.add(made("divides-by-travel", divided));
  registry.add(made("counts-calls", counting));
  registry.add(made("crash-on-empty", crashing));
  registry.add(made("endless-on-zero", looping));
  registry.add(made("says-nothing", silent));
  registry.add(made("always-fails", failing));
  registry.add(made("endless", endless));
  registry.add(made("of-its-home", at_home));
}
