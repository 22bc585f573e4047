// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "nonio/reports/model.h"
#include "nonio/reports/number.h"
#include "nonio/reports/text.h"
#include "nonio/sdk/format.h"
#include "report.h"
#include "rules.h"

namespace nonio::pdf_report {
using namespace reports;

Block note_of(const Source& source, const Finding& f) {
  const auto part = [&](const char* name) {
    return typeset(finding_text(source.in.templates, source.language(), f, name));
  };
  return {Note{f.attention ? Level::attention : Level::info, part("title"), part("says"),
               part("advice")},
          "finding " + f.id};
}

namespace {

bool speaks(const OutputResult& r) {
  return !r.predictions.empty() || !r.findings.empty() || !r.notes.empty();
}

/// The advice is omitted if a laboratory part contains it.
Block without_advice(const Source& source, const Finding& f) {
  Block block = note_of(source, f);
  if (has_laboratory_part(source)) std::get<Note>(block.what).advice.clear();
  return block;
}

}  // namespace

void add_findings(const Source& source, const Measured& m, Blocks& blocks) {
  bool any = false;
  for (const Finding* f : m.findings) {
    if (is_for_laboratory(source, *f)) continue;
    if (!std::exchange(any, true))
      blocks.push_back({Heading{source.words.get("findings.title"), 2}, "findings.title"});
    blocks.push_back(without_advice(source, *f));
  }
}

bool is_for_laboratory(const Source& source, const Finding& f) {
  return has_laboratory_part(source) && f.id.starts_with("model.");
}

bool has_laboratory_part(const Source& source) {
  const auto& blocks = source.look.blocks;
  return std::find(blocks.begin(), blocks.end(), "laboratory") != blocks.end();
}

/// Recommended actions for operators and maintenance. All results for a customer are on the
/// preceding pages.
void add_laboratory(const Source& source, Blocks& blocks) {
  Blocks advice;
  std::set<std::string> printed_already;
  for (const Measured& m : measured(source.in))
    for (const Finding* f : m.findings) {
      Block block = note_of(source, *f);
      Note& note = std::get<Note>(block.what);
      const bool whole = is_for_laboratory(source, *f);
      if ((note.advice.empty() && !whole) ||
          !printed_already.insert(m.measurement.id + note.title).second)
        continue;
      note.title = m.measurement.id + ": " + note.title;
      if (!whole) note.says.clear();
      advice.push_back(std::move(block));
    }
  for (const Results::Analysed& a : source.in.results.analyses)
    for (const Finding& f : a.evaluation.findings) {
      Block block = note_of(source, f);
      Note& note = std::get<Note>(block.what);
      if (!a.measurement.empty() || note.advice.empty()) continue;
      note.title = analysis_title(source, a) + ": " + note.title;
      note.says.clear();
      advice.push_back(std::move(block));
    }
  const auto& outputs = source.in.results.outputs;
  const bool tables = std::any_of(outputs.begin(), outputs.end(),
                                  [](const auto& output) { return speaks(output.result); });
  if (advice.empty() && source.in.results.models.empty() && !tables) return;
  blocks.push_back({PageBreak{}});
  blocks.push_back({Heading{source.words.get("laboratory.title"), 1}, "laboratory"});
  blocks.push_back(
      {Paragraph{source.words.get("laboratory.says"), Paragraph::Look::small}, "laboratory"});
  std::move(advice.begin(), advice.end(), std::back_inserter(blocks));
}

namespace {

std::string file_names(const OutputResult& result) {
  std::string out;
  for (const Artifact& a : result.artifacts) out += (out.empty() ? "" : ", ") + a.name;
  return out;
}

struct Row {
  const Results::Written* output;
  std::string measurement;
  std::map<std::string, const Prediction*> by_name;
};

std::vector<Row> prediction_rows(const Source& source, std::vector<std::string>& names) {
  std::vector<Row> rows;
  for (const Results::Written& output : source.in.results.outputs)
    for (const Prediction& p : output.result.predictions) {
      if (rows.empty() || rows.back().output != &output || rows.back().measurement != p.measurement)
        rows.push_back({&output, p.measurement, {}});
      rows.back().by_name[p.name] = &p;
      if (std::find(names.begin(), names.end(), p.name) == names.end()) names.push_back(p.name);
    }
  return rows;
}

Table predictions(const Source& source, bool& with_files) {
  const Wording& w = source.words;
  std::vector<std::string> names;
  const std::vector<Row> rows = prediction_rows(source, names);
  std::set<std::string> units;
  for (const Row& row : rows)
    for (const auto& [name, p] : row.by_name) units.insert(unit_text(p->quantity));
  const bool own_units = units.size() > 1;
  Table table;
  table.title = w.get("tables.change");
  with_files = names.size() <= 4;
  table.columns = {{w.get("tables.output"), "", false}};
  if (with_files) table.columns.push_back({w.get("tables.file"), "", false});
  table.columns.push_back({w.get("tables.measurement"), "", false});
  for (const std::string& name : names)
    table.columns.push_back({symbol(name), own_units ? "" : *units.begin(), true});
  for (const Row& row : rows) {
    const bool first = &row == &rows.front() || (&row)[-1].output != row.output;
    std::vector<Table::Cell> cells = {{first ? row.output->plugin : "", true}};
    if (with_files) cells.push_back({first ? file_names(row.output->result) : ""});
    cells.push_back({row.measurement});
    for (const std::string& name : names) {
      const auto p = row.by_name.find(name);
      const auto number = [&](double v) {
        return printed_number(v, p->second->quantity, 2, source.language());
      };
      cells.push_back(p == row.by_name.end()
                          ? Table::Cell{"–"}
                          : Table::Cell{number(p->second->before) + " → " +
                                        number(p->second->after) +
                                        (own_units ? " " + unit_text(p->second->quantity) : "")});
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

namespace {

std::string remark(const Source& source, const Remark& note) {
  return remark_text(source.in.templates, source.language(), note);
}

bool already_said(const Source& source, const Finding& f) {
  for (const Results::Analysed& a : source.in.results.analyses)
    for (const Finding& known : a.evaluation.findings)
      if (known.id == f.id && a.measurement == f.measurement) return true;
  return false;
}

}  // namespace

std::vector<TableFinding> table_findings(const Source& source) {
  std::vector<TableFinding> out;
  for (const Results::Written& output : source.in.results.outputs)
    for (const Finding& f : output.result.findings) {
      const bool refused = output.result.artifacts.empty();
      const auto says = [&](const Finding& one) {
        return finding_text(source.in.templates, source.language(), one, "says");
      };
      const auto same = std::find_if(out.begin(), out.end(), [&](const TableFinding& known) {
        return known.refused == refused && known.finding->id == f.id &&
               known.finding->measurement == f.measurement && says(*known.finding) == says(f);
      });
      if (same == out.end())
        out.push_back({&f, output.plugin, refused});
      else
        same->outputs += ", " + output.plugin;
    }
  return out;
}

std::string title_of(const Source& source, const TableFinding& f) {
  const Wording& w = source.words;
  std::string title =
      typeset(finding_text(source.in.templates, source.language(), *f.finding, "title"));
  if (!f.finding->measurement.empty())
    title =
        w.get("status.of_measurement", {{"measurement", f.finding->measurement}, {"what", title}});
  return w.get(f.refused ? "status.refused" : "status.of_output",
               {{"output", f.outputs}, {"what", title}});
}

void add_tables(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  const auto& outputs = source.in.results.outputs;
  if (std::none_of(outputs.begin(), outputs.end(),
                   [](const auto& output) { return speaks(output.result); }))
    return;
  blocks.push_back({Heading{w.get("tables.title"), 1}, "tables.title"});
  bool with_files = true;
  if (Table table = predictions(source, with_files); !table.rows.empty()) {
    blocks.push_back({std::move(table), "tables"});
    for (const Results::Written& output : outputs)
      if (!with_files && !output.result.predictions.empty())
        blocks.push_back({Paragraph{w.get("tables.note", {{"output", output.plugin},
                                                          {"note", file_names(output.result)}}),
                                    Paragraph::Look::small},
                          "tables"});
    blocks.push_back({Paragraph{w.get("tables.predicted"), Paragraph::Look::muted}, "tables"});
  }
  for (const TableFinding& f : table_findings(source)) {
    Block block = note_of(source, *f.finding);
    auto& note = std::get<Note>(block.what);
    if (already_said(source, *f.finding)) note.says = note.advice = "";
    note.title = title_of(source, f);
    blocks.push_back(std::move(block));
  }
  for (const Results::Written& output : outputs) {
    std::string notes;
    std::set<std::string> said;
    for (const Remark& note : output.result.notes)
      if (const std::string text = remark(source, note); said.insert(text).second)
        notes += (notes.empty() ? "" : " ") + text;
    if (!notes.empty())
      blocks.push_back(
          {Paragraph{typeset(visible_text(
                         w.get("tables.note", {{"output", output.plugin}, {"note", notes}}),
                         source.fonts)),
                     Paragraph::Look::small},
           "notes of " + output.plugin});
  }
}

void add_plans(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  for (const Results::Analysed& a : source.in.results.analyses) {
    const PointTable& rows = a.evaluation.rows;
    if (!a.measurement.empty() || (rows.columns.empty() && a.evaluation.findings.empty())) continue;
    blocks.push_back({Heading{analysis_title(source, a), 1}, "analysis " + a.plugin});
    Table table;
    std::vector<int> decimals;
    for (const PointTable::Column& c : rows.columns) {
      table.columns.push_back(
          {w.get_or("column." + c.name, symbol(c.name)), unit_text(c.quantity), true});
      decimals.push_back(c.quantity == Quantity::ratio ? 4 : decimals_for(c.values, c.quantity, 4));
    }
    for (std::size_t i = 0; !rows.columns.empty() && i < rows.columns.front().values.size(); ++i) {
      std::vector<Table::Cell> row;
      for (std::size_t k = 0; k < rows.columns.size(); ++k)
        row.push_back({printed_number(rows.columns[k].values[i], rows.columns[k].quantity,
                                      decimals[k], source.language())});
      table.rows.push_back(std::move(row));
    }
    if (!table.rows.empty()) blocks.push_back({std::move(table), "rows of " + a.plugin});
    for (const Finding& f : a.evaluation.findings) blocks.push_back(without_advice(source, f));
  }
}

namespace {

bool lacks_statements(const Results::Analysed& a) {
  const auto& findings = a.evaluation.findings;
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.id == "uncertainty.no-data"; });
}

std::string meaning_of_numbers(const Source& source) {
  const Results& results = source.in.results;
  std::string all;
  const auto say = [&](bool wanted, const std::string& text) {
    if (wanted) all += (all.empty() ? "" : " ") + text;
  };
  bool with_U = false, without_U = false;
  for (const Results::Analysed& a : results.analyses)
    for (const Value& v : a.evaluation.values)
      v.U ? with_U = true : without_U |= lacks_statements(a);
  const auto& measurements = source.in.campaign.measurements;
  say(with_U, source.words.get("notes.uncertainty"));
  say(without_U, source.words.get("notes.no_uncertainty"));
  say(std::any_of(results.conformity.begin(), results.conformity.end(),
                  [](const Conformity& c) { return !c.measurement.empty(); }),
      pages::rule_text(source));
  say(std::any_of(measurements.begin(), measurements.end(), pages::over_one_position),
      source.words.get("notes.sign"));
  say(true, source.words.get("notes.items"));
  return all;
}

}  // namespace

void add_notes(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  const Results& results = source.in.results;
  blocks.push_back({Heading{w.get("notes.title"), 2}, "notes.title"});
  const auto add = [&](const std::string& text) {
    if (!text.empty())
      blocks.push_back(
          {Paragraph{typeset(visible_text(text, source.fonts)), Paragraph::Look::small}, "notes"});
  };
  for (const Remark& note : results.notes)
    add(w.get("status.of_measurement",
              {{"measurement", note.measurement}, {"what", remark(source, note)}}));
  std::set<std::string> said;
  std::string methods;
  for (const Results::Analysed& a : results.analyses)
    for (const Remark& note : a.evaluation.notes)
      if (pages::rules_of(a) == nullptr && said.insert(remark(source, note)).second)
        methods += (methods.empty() ? "" : " ") + remark(source, note);
  add(methods);
  add(meaning_of_numbers(source));
}

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
    if (!add_part_maps(source, fit, blocks)) add_fit(source, fit, blocks);
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
