// SPDX-License-Identifier: Apache-2.0
#include "cross_job.h"

#include <algorithm>
#include <cmath>

namespace nonio::controllers {

namespace {

const Series* series_of(const Evaluation& e, std::string_view name) {
  for (const Series& s : e.series)
    if (s.name == name) return &s;
  return nullptr;
}

double range(const std::vector<double>& v) {
  const auto [low, high] = std::minmax_element(v.begin(), v.end());
  return *high - *low;
}

}  // namespace

std::vector<CrossJob> cross_jobs(const Results& results) {
  std::vector<CrossJob> jobs;
  for (const Results::Analysed& a : results.analyses) {
    const Evaluation& e = a.evaluation;
    const Series *f = series_of(e, "EYX"), *g = series_of(e, "EXY");
    const auto *D1 = e.points.column("D1"), *D2 = e.points.column("D2");
    const auto k = std::find_if(e.values.begin(), e.values.end(),
                                [](const Value& v) { return v.name == "C0Y"; });
    if (f == nullptr || g == nullptr || D1 == nullptr || D2 == nullptr || k == e.values.end())
      continue;
    CrossJob job{a.measurement,
                 {f->over, g->over, f->position, f->value},
                 {g->over, f->over, g->position, g->value},
                 D1->values,
                 D2->values};
    for (std::size_t i = 0; i < job.along_y.value.size(); ++i)
      job.along_y.value[i] -= k->value * (g->position[i] - g->position.front());
    jobs.push_back(std::move(job));
  }
  return jobs;
}

void predict_diagonals(const CrossJob& job, const math::Correction& of_y,
                       const math::Correction& of_x, OutputResult& result) {
  const auto &x = job.along_x.position, &y = job.along_y.position;
  const double Lx = x.back() - x.front(), Ly = y.back() - y.front(), L = std::hypot(Lx, Ly);
  const std::size_t n = x.size() - 1;
  for (const bool rising : {true, false}) {
    const auto& before = rising ? job.D1 : job.D2;
    std::vector<double> after;
    for (std::size_t i = 0; i <= n; ++i) {
      const double at_y = y[rising ? i : n - i];
      after.push_back(before[i] + Lx / L * of_x(at_y, rising ? 1 : -1) +
                      (rising ? 1.0 : -1.0) * Ly / L * of_y(x[i], 1));
    }
    const char* name = rising ? "D1" : "D2";
    result.predictions.push_back(
        {job.measurement, name, range(before), range(after), Quantity::deviation});
    if (!(range(after) < range(before)))
      result.findings.push_back({.id = "table.no-gain",
                                 .attention = true,
                                 .evidence = {{"before", range(before), Quantity::deviation},
                                              {"after", range(after), Quantity::deviation}},
                                 .texts = {{"axis", name}},
                                 .measurement = job.measurement,
                                 .advice = "These tables would not make the diagonal better."});
  }
}

}  // namespace nonio::controllers
