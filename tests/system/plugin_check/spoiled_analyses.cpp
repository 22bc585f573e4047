// SPDX-License-Identifier: Apache-2.0
// An analysis that gives the range of the readings and their number, and its faults.
#include <algorithm>
#include <stdexcept>

#include "spoiled.h"

namespace {

using namespace nonio;
using spoiled::has;

double range_of(const std::vector<double>& d) {
  if (d.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(d.begin(), d.end());
  return *high - *low;
}

double mean_of(std::vector<double> d) {
  std::sort(d.begin(), d.end());
  double sum = 0.0;
  for (const double x : d) sum += x;
  return d.empty() ? 0.0 : sum / static_cast<double>(d.size());
}

std::vector<double> chosen(const AnalysisInput& in) {
  const Observations& o = in.observations;
  std::vector<double> d = o.deviation;
  const auto keep = [&](const auto& which) {
    d.clear();
    for (std::size_t i = 0; i < o.size(); ++i)
      if (which(i)) d.push_back(o.deviation[i]);
  };
  if (has("first-run-only")) keep([&](std::size_t i) { return o.run.empty() || o.run[i] == 1; });
  if (has("towards-plus-only"))
    keep([&](std::size_t i) {
      return o.axes.front().approach.empty() || o.axes.front().approach[i] > 0;
    });
  if (has("every-second-reading")) keep([&](std::size_t i) { return i % 2 == 1; });
  if (has("without-the-largest") && !d.empty()) d.erase(std::max_element(d.begin(), d.end()));
  return d;
}

double spoiled_range(const AnalysisInput& in) {
  const std::vector<double> d = chosen(in);
  const Observations& o = in.observations;
  double range = range_of(d);
  if (has("x1000")) range *= 1e3;
  if (has("halved")) range /= 2.0;
  if (has("turned")) range = -range;
  if (has("rounded")) range = std::round(range * 1e6) * 1e-6;
  if (has("the-first") && !d.empty()) range = d.front();
  if (has("the-last") && !d.empty()) range = d.back();
  if (has("of-neighbours"))
    for (std::size_t i = 1; i < d.size(); ++i)
      range = std::max(range, 1.5 * std::fabs(d[i] - d[i - 1]));
  if (has("rms")) {
    double sum = 0.0;
    for (const double x : d) sum += x * x;
    range = d.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(d.size()));
  }
  if (has("largest-of-all"))
    for (const double x : d) range = std::max(range, 3.0 * std::fabs(x));
  if (has("to-the-square")) range = range * range * 1e5;
  if (has("root")) range = std::sqrt(range) * 1e-3;
  if (has("a-constant-more")) range += 1e-6;
  if (has("above-the-mean") && !d.empty())
    range = *std::max_element(d.begin(), d.end()) - mean_of(d);
  if (has("positive-places-only")) {
    std::vector<double> some;
    for (std::size_t i = 0; i < o.size(); ++i)
      if (o.axes.front().position[i] > 0.1) some.push_back(o.deviation[i]);
    range = range_of(some);
  }
  if (has("likes-x") && in.measurement.axis == "X") range *= 2.0;
  if (has("a-nan")) range = spoiled::nan;
  if (has("infinite")) range = spoiled::inf;
  if (has("infinite-for-one") && o.size() == 1) range = spoiled::inf;
  if (has("nan-without-travel")) {
    const double travel = range_of(o.axes.front().position);
    range = range * travel / travel;
  }
  if (has("log-of-zero")) range = range + 0.0 * std::log(range);
  return range + 1e-9 * spoiled::impurity() + 1e-9 * spoiled::counted();
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  const std::size_t n = in.observations.size();
  if (has("refuses-all")) return fail("expected something else");
  if (has("throws")) throw std::runtime_error("wrong on purpose");
  if (has("says-nothing")) return Evaluation{};
  if (has("crashes-without-readings") && n == 0) spoiled::crash();
  if (has("crashes-with-one-reading") && n == 1) spoiled::crash();
  if (has("crashes-at-huge-ones") && n > 0 && std::fabs(in.observations.deviation[0]) > 1e3)
    spoiled::crash();
  if (has("hangs-at-zeros") && n > 1 && range_of(in.observations.deviation) == 0.0) spoiled::hang();
  if (has("hangs")) spoiled::hang();
  Evaluation e;
  const Quantity q =
      has("of-another-quantity") ? Quantity::length : deviation_of(in.observations.angular);
  if (!has("without-a-value"))
    e.values.push_back({has("of-another-name") ? "Range" : "range", spoiled_range(in), q});
  double count = static_cast<double>(n);
  if (has("one-too-many")) count += 1.0;
  e.values.push_back({"readings", count, Quantity::count});
  if (has("evidence-that-is-none")) {
    Finding f{.id = "found"};
    f.evidence.push_back({"x", spoiled::nan, Quantity::deviation});
    e.findings.push_back(f);
  }
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  spoiled::at_registration();
  if (has("registers-nothing")) return;
  Analysis a;
  a.info = spoiled::info("spoiled");
  a.applies = [](const Campaign&, const Measurement& m) { return m.kind == "axis"; };
  a.analyse = analyse;
  if (has("without-analyse")) a.analyse = nullptr;
  if (has("without-applies")) a.applies = nullptr;
  registry.add(a);
}
