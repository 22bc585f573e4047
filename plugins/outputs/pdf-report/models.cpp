// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "report.h"

namespace nonio::pdf_report {

using namespace reports;

namespace {

constexpr double notable_correlation = 0.9;

std::string unit_or_dash(Quantity q) {
  const std::string unit = unit_text(q);
  return unit.empty() ? "–" : unit;
}

void add_parameters(const Source& source, const ModelFit& fit, Blocks& blocks) {
  const Wording& words = source.pictures;
  const std::string field = "parameters of the model of " + fit.part;
  if (fit.parameters.empty()) {
    blocks.push_back({Paragraph{words.get("model.empty"), Paragraph::Look::body}, field});
    return;
  }
  Table table;
  table.title = words.get("model.parameters");
  table.columns = {{words.get("model.effect"), ""},
                   {words.get("model.parameter"), ""},
                   {words.get("model.value"), "", true},
                   {"U", "", true},
                   {words.get("model.unit"), ""}};
  for (const ModelFit::Parameter& p : fit.parameters) {
    std::optional<double> U;
    if (p.u && std::isfinite(*p.u)) U = 2 * *p.u;
    const Printed shown = printed_result(p.value, U, p.quantity, source.language());
    table.rows.push_back({{p.effect},
                          {p.name},
                          {shown.value},
                          {shown.U.empty() ? "–" : shown.U},
                          {unit_or_dash(p.quantity)}});
  }
  blocks.push_back({std::move(table), field});
  std::string correlated;
  for (std::size_t i = 0; i < fit.correlation.size() && i < fit.parameters.size(); ++i)
    for (std::size_t k = 0; k < i && k < fit.correlation[i].size(); ++k) {
      const double r = fit.correlation[i][k];
      if (!(std::fabs(r) > notable_correlation)) continue;
      const auto name = [&](std::size_t n) {
        return fit.parameters[n].effect + " " + fit.parameters[n].name;
      };
      correlated += (correlated.empty() ? "" : "; ") +
                    words.get("model.pair",
                              {{"one", name(k)},
                               {"other", name(i)},
                               {"r", printed_number(r, Quantity::ratio, 2, source.language())}});
    }
  if (!correlated.empty())
    blocks.push_back(
        {Paragraph{words.get("model.correlated", {{"pairs", correlated}}), Paragraph::Look::small},
         field});
}

void add_falling_error(const Source& source, const ModelFit& fit, Blocks& blocks) {
  if (fit.steps.empty()) return;
  const Wording& words = source.pictures;
  const Quantity q = deviation_of(fit.angular);
  const auto bar = [&](std::optional<double> si) {
    if (!si || !std::isfinite(*si)) return BarChart::Bar{std::nan(""), "–"};
    const double value = *si * unit_of(q).per_si;
    return BarChart::Bar{value, localised(short_text(value, 3), source.language())};
  };
  const bool left_out = std::any_of(fit.steps.begin(), fit.steps.end(),
                                    [](const auto& step) { return step.cv_rms.has_value(); });
  BarChart chart;
  chart.title = words.get("model.falls");
  chart.x_title = words.get("model.rms_axis", {{"unit", unit_text(q)}});
  chart.language = source.language();
  chart.series = {{words.get("model.rms"), source.look.style.plus}};
  if (left_out) chart.series.push_back({words.get("model.cv_rms"), source.look.style.minus});
  for (const ModelFit::Step& step : fit.steps) {
    BarChart::Row row{step.effect.empty() ? words.get("model.start") : "+ " + step.effect,
                      {bar(step.rms)}};
    if (left_out) row.bars.push_back(bar(step.cv_rms));
    chart.rows.push_back(std::move(row));
  }
  if (fit.floor && std::isfinite(*fit.floor)) {
    const double U = 2 * fit.floor_u.value_or(0.0);
    const Printed shown = printed_result(*fit.floor, U, q, source.language());
    chart.line = {*fit.floor * unit_of(q).per_si, U * unit_of(q).per_si,
                  words.get("model.floor", {{"s", shown.value},
                                            {"U", shown.U.empty() ? "–" : shown.U},
                                            {"unit", unit_text(q)}})};
  }
  blocks.push_back({Spacer{4}});
  blocks.push_back({std::move(chart), "falling error of " + fit.part});
}

}  // namespace

void add_models(const Source& source, Blocks& blocks) {
  for (const ModelFit& fit : source.in.results.models) {
    const std::string field = "model of " + fit.part;
    blocks.push_back(
        {Heading{source.pictures.get("model.heading", {{"part", fit.part}}), 1}, field});
    for (const Finding& f : fit.says) blocks.push_back(note_of(source, f));
    add_parameters(source, fit, blocks);
    add_falling_error(source, fit, blocks);
    add_pictures(source, fit, blocks);
  }
  if (!source.in.results.models.empty()) blocks.push_back({PageBreak{}});
}

}  // namespace nonio::pdf_report
