// SPDX-License-Identifier: Apache-2.0
// Linear displacement on several lines in the volume; the worst line gives each value.
#include "nonio/sdk/plugin.h"

#include <cmath>

#include "nonio/math/axis_analysis.h"
#include "nonio/math/iso230_2.h"

namespace nonio::worst_line {
namespace {

using math::AxisAnalysis;
using math::Made;

constexpr double k_of_2005 = 2.0;

bool applies(const Campaign&, const Measurement& m) { return m.kind == "axis"; }

struct Line {
  std::string id;
  AxisAnalysis analysis;
  math::Iso230Result result{};
  math::Iso230Uncertainty U{};
};

std::vector<std::size_t> lines_of(const Campaign& c, const Measurement& of) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < c.measurements.size(); ++i) {
    const Measurement& m = c.measurements[i];
    if (m.kind == of.kind && m.axis == of.axis && m.adjustment == of.adjustment &&
        state_of(m) == state_of(of))
      out.push_back(i);
  }
  return out;
}

Expected<Line> line(const AnalysisInput& in, std::size_t i) {
  const Measurement& m = in.campaign.measurements[i];
  NONIO_TRY(auto begun,
            math::begin_axis_analysis({in.campaign, m, (*in.all)[i], in.options, in.all}));
  Line out{m.id, std::move(begun)};
  out.result = math::evaluate_iso230_2(out.analysis.test, k_of_2005);
  out.U = math::iso230_2_uncertainty(out.analysis.budget.value_or(math::Budget{}),
                                     out.analysis.approaches, k_of_2005);
  return out;
}

struct Of {
  const char* name;
  double math::Iso230Result::*value;
  math::ResultUncertainty math::Iso230Uncertainty::*U;
  Made made;
};
constexpr Of values[] = {
    {"A", &math::Iso230Result::A, &math::Iso230Uncertainty::A, Made::of_all},
    {"E", &math::Iso230Result::E, &math::Iso230Uncertainty::E, Made::of_all},
    {"M", &math::Iso230Result::M, &math::Iso230Uncertainty::M, Made::of_all},
    {"R", &math::Iso230Result::R, &math::Iso230Uncertainty::R, Made::of_environment},
    {"B", &math::Iso230Result::B, &math::Iso230Uncertainty::B, Made::of_environment},
};

/// If a value is missing on one line, no worst value is reported, because this line could be the
/// worst.
void put_worst(const std::vector<Line>& lines, Evaluation& e) {
  for (const Of& of : values) {
    const Line* worst = nullptr;
    std::string absent;
    for (const Line& l : lines) {
      const double v = l.result.*of.value;
      if (!std::isfinite(v)) absent += (absent.empty() ? "" : ", ") + l.id;
      if (worst == nullptr || !(v <= worst->result.*of.value)) worst = &l;
    }
    if (!absent.empty()) {
      e.findings.push_back({.id = "worst-line.absent",
                            .attention = false,
                            .texts = {{"name", of.name}, {"lines", absent}}});
      continue;
    }
    add_value(e, worst->analysis, std::string(of.name) + "_worst", worst->result.*of.value,
              worst->U.*of.U, of.made);
    e.findings.push_back(
        {.id = "worst-line.which",
         .attention = false,
         .evidence = {{"value", worst->result.*of.value, worst->analysis.deviation}},
         .texts = {{"name", of.name}, {"line", worst->id}}});
  }
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  if (in.all == nullptr) return fail("expected the other measurements of the campaign, found none");
  const std::vector<std::size_t> all = lines_of(in.campaign, in.measurement);
  Evaluation e;
  const Measurement& first = in.campaign.measurements[all.front()];
  if (first.id != in.measurement.id) return e;
  std::vector<Line> lines;
  for (const std::size_t i : all) {
    NONIO_TRY(auto l, line(in, i));
    if (i != all.front()) e.uses.push_back(l.id);
    lines.push_back(std::move(l));
  }
  const auto count = static_cast<double>(lines.size());
  if (lines.size() < 2)
    e.findings.push_back(
        {.id = "worst-line.one-line", .attention = true, .texts = {{"axis", in.measurement.axis}}});
  put_worst(lines, e);
  e.notes.push_back({"method.worst-line",
                     {{"lines", count, Quantity::count}, {"k", k_of_2005, Quantity::count}}});
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"worst-line",
            "1.0.0",
            "One axis on several lines in the volume: of each value the worst line (ASME B5.54).",
            {math::incomplete_targets_option()},
            true};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::worst_line
