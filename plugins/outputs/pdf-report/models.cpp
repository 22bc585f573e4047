// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "nonio/reports/model.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "report.h"

namespace nonio::pdf_report {

using namespace reports;

namespace {

void add_what_it_says(const Source& source, const ModelFit& fit, Blocks& blocks) {
  const std::string field = "model of " + fit.part;
  for (const Finding& f : fit.diagnosis) {
    Block block = note_of(source, f);
    auto& note = std::get<Note>(block.what);
    if (note.title == f.id && !note.says.empty()) note.title = std::exchange(note.says, "");
    if (&f == &fit.diagnosis.front())
      blocks.push_back(std::move(block));
    else
      blocks.push_back({Paragraph{"• " + note.title, Paragraph::Look::small}, field});
  }
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
                   {"", ""},
                   {words.get("model.value"), "", true},
                   {"U", "", true},
                   {words.get("model.unit"), ""}};
  for (const ParameterRow& row : parameter_rows(fit, source.in.templates, source.language()))
    table.rows.push_back({{row.effect, true},
                          {row.name},
                          {row.meaning},
                          {row.value},
                          {row.U},
                          {row.unit.empty() ? "–" : row.unit}});
  blocks.push_back({std::move(table), field});
  if (const std::string text = correlated_parameters(fit, words); !text.empty())
    blocks.push_back({Paragraph{text, Paragraph::Look::small}, field});
}

void add_candidates(const Source& source, const ModelFit& fit, Blocks& blocks) {
  const Wording& words = source.pictures;
  const std::string field = "candidates for the model of " + fit.part;
  Table table;
  table.title = words.get("model.candidates");
  table.columns = {{words.get("model.effect"), ""},
                   {words.get("model.evidence"), "", true},
                   {words.get("model.rms_after"), "", true},
                   {words.get("model.left_out_after"), "", true},
                   {words.get("model.smallest"), "", true}};
  for (const CandidateRow& row : candidate_rows(fit, source.language()))
    table.rows.push_back(
        {{row.effect + (row.certain ? " – " + words.get("model.certain") : ""), row.certain},
         {row.evidence},
         {row.rms},
         {row.cv_rms},
         {row.smallest}});
  if (!table.rows.empty()) blocks.push_back({std::move(table), field});
  if (const std::string text = no_sign(fit, source.in.templates, source.language()); !text.empty())
    blocks.push_back({Paragraph{text, Paragraph::Look::small}, field});
  for (const Finding& f : fit.next) {
    const std::string text = finding_text(source.in.templates, source.language(), f, "says");
    blocks.push_back(
        {Paragraph{words.get("model.next") + ": " + typeset(text), Paragraph::Look::small}, field});
  }
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
    add_what_it_says(source, fit, blocks);
    add_fit(source, fit, blocks);
    add_candidates(source, fit, blocks);
    add_parameters(source, fit, blocks);
    add_falling_error(source, fit, blocks);
    if (const std::string text = fit_in_words(fit, source.in.results, source.pictures);
        !text.empty())
      blocks.push_back({Paragraph{text, Paragraph::Look::small}, field});
  }
}

void add_residuals(const Source& source, Blocks& blocks) {
  for (const ModelFit& fit : source.in.results.models) add_pictures(source, fit, blocks);
}

}  // namespace nonio::pdf_report
