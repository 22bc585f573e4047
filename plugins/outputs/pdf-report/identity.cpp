// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>

#include "nonio/reports/number.h"
#include "nonio/reports/text.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/withheld.h"
#include "report.h"

namespace nonio::pdf_report {
using namespace reports;

namespace {

const std::vector<double> identity_shares = {0.36, 0.29, 0.35};
const std::vector<double> title_shares = {0.66, 0.34};

const char* subtitle_of(const Source& source) {
  bool positioning = false, other = false;
  for (const Measurement& m : source.in.campaign.measurements)
    (m.kind == "axis" ? positioning : other) = true;
  if (positioning && other) return "subtitle_both";
  return positioning ? "subtitle" : other ? "subtitle_geometry" : "subtitle_plan";
}

}  // namespace

void add_title(const Source& source, Blocks& blocks) {
  const Laboratory& laboratory = source.in.campaign.laboratory;
  Blocks title = {
      {Heading{source.words.get("title"), 0}, "title"},
      {Paragraph{source.words.get(subtitle_of(source)), Paragraph::Look::muted}, "subtitle"},
      {Paragraph{source.words.get("not_a_certificate"), Paragraph::Look::bold}, "status"}};
  Blocks by;
  if (!laboratory.name.empty())
    by.push_back({Paragraph{laboratory.name, Paragraph::Look::bold}, "laboratory.name"});
  std::string below = laboratory.address;
  if (!laboratory.country.empty()) below += (below.empty() ? "" : " · ") + laboratory.country;
  if (!below.empty())
    by.push_back({Paragraph{below, Paragraph::Look::muted}, "laboratory.address"});
  if (by.empty())
    std::move(title.begin(), title.end(), std::back_inserter(blocks));
  else
    blocks.push_back({Columns{{std::move(title), std::move(by)}, title_shares}, "title"});
  blocks.push_back({Spacer{6}});
}

void add_identity(const Source& source, Blocks& blocks) {
  const Campaign& c = source.in.campaign;
  const Wording& w = source.words;
  const auto label = [&](const char* key) { return w.get(std::string("identity.") + key); };
  const std::string structure =
      c.machine.structure.empty()
          ? ""
          : w.get_or("structure." + c.machine.structure, c.machine.structure);
  Grid campaign{label("campaign"),
                {{label("id"), c.id, "campaign.id"},
                 {label("date"), c.date, "campaign.date"},
                 {label("customer"), c.customer, "campaign.customer"},
                 {label("site"), c.site, "campaign.site"},
                 {label("operator"), c.operator_name, "campaign.operator"}}};
  Grid machine{label("machine"),
               {{label("maker"), c.machine.maker, "machine.maker"},
                {label("model"), c.machine.model, "machine.model"},
                {label("serial"), c.machine.serial, "machine.serial"},
                {label("structure"), structure, "machine.structure"},
                {label("control"), c.machine.control, "machine.control"}}};
  const Instrument& i = c.instrument;
  Grid instrument{label("instrument"),
                  {{label("maker"), i.maker, "instrument.maker"},
                   {label("model"), i.model, "instrument.model"},
                   {label("serial"), i.serial, "instrument.serial"},
                   {label("calibrated"), i.calibrated, "instrument.calibrated"},
                   {label("certificate"), i.certificate, "instrument.certificate"},
                   {label("uncertainty"), instrument_U(source), "instrument.U"}}};
  const auto empty = [](const Grid::Row& row) { return row.value.empty(); };
  if (std::all_of(instrument.rows.begin(), instrument.rows.end(), empty))
    instrument.rows = {{label("model"), label("not_given"), "instrument"}};
  if (std::all_of(machine.rows.begin(), machine.rows.end(), empty))
    machine.rows = {{label("model"), label("not_given"), "machine"}};
  blocks.push_back({Columns{{{{std::move(campaign), "campaign"}},
                             {{std::move(machine), "machine"}},
                             {{std::move(instrument), "instrument"}}},
                            identity_shares},
                    "identity"});
}

namespace {

void add_conformity(const Source& source, std::vector<std::string>& lines) {
  const Wording& w = source.words;
  for (const Conformity& c : source.in.results.conformity) {
    if (c.decision == Decision::conforms || c.reason == "no-value") continue;
    const Value* value = nullptr;
    for (const Results::Analysed& a : source.in.results.analyses)
      if (a.plugin == c.plugin && a.measurement == c.measurement)
        for (const Value& v : a.evaluation.values)
          if (v.name == c.name) value = &v;
    const Printed shown = value != nullptr ? printed_result(value->value, value->U, c.quantity,
                                                            source.language(), c.tolerance)
                                           : Printed{"–", ""};
    const std::string what =
        w.get(c.decision == Decision::does_not_conform ? "status.does_not_conform"
                                                       : "status.cannot_be_decided",
              {{"name", symbol(c.name)},
               {"value", shown.U.empty() ? shown.value : shown.value + " ± " + shown.U},
               {"unit", unit_text(c.quantity)},
               {"tolerance", plain_number(source, c.tolerance, c.quantity)},
               {"reason", w.get_or("results." + c.reason, c.reason)}});
    lines.push_back(
        w.get("status.of_measurement", {{"measurement", c.measurement}, {"what", what}}));
  }
  for (std::string& sentence : undecided(source)) lines.push_back(std::move(sentence));
}

bool has_results(const Evaluation& e) {
  return !e.values.empty() || !e.series.empty() || !e.points.columns.empty() ||
         !e.rows.columns.empty();
}

/// Status if no action is required; green only if something was evaluated and compared with a
/// tolerance.
void say_what_was_looked_at(const Source& source, Status& status, bool of_laboratory) {
  const Results& results = source.in.results;
  const Wording& w = source.words;
  std::string not_evaluated;
  for (const Remark& note : results.notes)
    if (note.id == "measurement.not-evaluated")
      not_evaluated += (not_evaluated.empty() ? "" : ", ") + note.measurement;
  const bool any = !results.models.empty() ||
                   std::any_of(results.analyses.begin(), results.analyses.end(),
                               [](const auto& a) { return has_results(a.evaluation); });
  status.level = Level::info;
  if (!any)
    status.level = Level::attention, status.text = w.get("status.nothing_evaluated");
  else if (!not_evaluated.empty())
    status.text = w.get("status.part_evaluated", {{"measurements", not_evaluated}});
  else if (results.conformity.empty())
    status.text = w.get("status.not_judged");
  else
    status.level = Level::good,
    status.text = w.get(of_laboratory ? "status.ok_results" : "status.ok");
}

}  // namespace

void add_status(const Source& source, Blocks& blocks) {
  const Results& results = source.in.results;
  const Wording& w = source.words;
  Status status;
  for (const Error& e : results.errors)
    status.lines.push_back(visible_text(
        (e.file.empty() ? "" : e.file + (e.line > 0 ? ":" + std::to_string(e.line) : "") + ": ") +
            e.message,
        source.fonts));
  if (!status.lines.empty()) {
    status.level = Level::failed;
    status.text = w.get("status.failed");
    blocks.push_back({std::move(status), "errors"});
    status = {};
  }
  add_conformity(source, status.lines);
  bool requires_action = !status.lines.empty();
  bool of_laboratory = false;
  for (const Measured& m : measured(source.in)) {
    for (const Finding* f : m.findings)
      if (f->attention && is_for_laboratory(source, *f))
        of_laboratory = true;
      else if (f->attention) {
        requires_action = requires_action || is_withholding(f->id);
        status.lines.push_back(
            w.get("status.of_measurement",
                  {{"measurement", m.measurement.id},
                   {"what",
                    typeset(finding_text(source.in.templates, source.language(), *f, "title"))}}));
      }
    if (m.observations.size() == 0 && results.errors.empty())
      status.lines.push_back(
          w.get("status.of_measurement",
                {{"measurement", m.measurement.id}, {"what", w.get("measurement.unread")}}));
  }
  for (const Results::Analysed& a : results.analyses)
    for (const Finding& f : a.evaluation.findings)
      if (a.measurement.empty() && f.attention) {
        requires_action = requires_action || is_withholding(f.id);
        status.lines.push_back(w.get(
            "status.of_measurement",
            {{"measurement", w.get_or("analysis." + a.plugin, a.plugin)},
             {"what", typeset(finding_text(source.in.templates, source.language(), f, "title"))}}));
      }
  for (const TableFinding& f : table_findings(source))
    if (f.finding->attention && has_laboratory_part(source))
      of_laboratory = true;
    else if (f.finding->attention)
      requires_action = true, status.lines.push_back(title_of(source, f));
  if (status.lines.empty() && !results.errors.empty()) return;
  if (status.lines.empty())
    say_what_was_looked_at(source, status, of_laboratory);
  else
    status.level = Level::attention,
    status.text = w.get(requires_action ? "status.attention" : "status.warnings");
  blocks.push_back({std::move(status), "status"});
}

// Table of all measurements on the first page.
namespace {

constexpr std::size_t fewest_measurements = 3, most_values = 4;

struct Line {
  const Value* value;
  const Conformity* limit;
};

/// Values with a limit first, then A, E, R, B and others in the order of the analysis.
std::vector<Line> main_values(const Source& source, const Measured& m) {
  std::vector<Line> all;
  for (const Results::Analysed* a : m.analyses)
    for (const Value& v : a->evaluation.values)
      if (v.U && std::none_of(all.begin(), all.end(),
                              [&](const Line& l) { return l.value->name == v.name; }))
        all.push_back({&v, pages::conformity_of(source.in, *a, v.name)});
  const auto rank = [](const Line& l) {
    constexpr std::string_view names[] = {"A", "E", "R", "B"};
    const auto at = std::find(std::begin(names), std::end(names), l.value->name);
    return std::pair(l.limit == nullptr, at - std::begin(names));
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Line& a, const Line& b) { return rank(a) < rank(b); });
  if (all.size() > most_values) all.resize(most_values);
  return all;
}

std::string text_of(const Source& source, const std::vector<Line>& lines) {
  std::string out;
  for (const Line& l : lines) {
    const Printed p =
        printed_result(l.value->value, l.value->U, l.value->quantity, source.language(),
                       l.limit == nullptr ? std::nullopt : std::optional(l.limit->tolerance));
    const std::string unit = unit_text(l.value->quantity);
    out += (out.empty() ? "" : "; ") + symbol(l.value->name) + " " + p.value + " ± " + p.U +
           (unit.empty() ? "" : " " + unit);
  }
  return out;
}

/// Decision on the whole measurement: the least favourable one.
Table::Cell decision_of(const Source& source, const Measured& m) {
  const Conformity* worst = nullptr;
  const auto rank = [](Decision d) {
    return d == Decision::does_not_conform ? 2 : d == Decision::cannot_be_decided ? 1 : 0;
  };
  for (const Conformity& c : source.in.results.conformity)
    if (c.measurement == m.measurement.id &&
        (worst == nullptr || rank(c.decision) > rank(worst->decision)))
      worst = &c;
  if (worst == nullptr) return {"–"};
  constexpr Level levels[] = {Level::good, Level::attention, Level::failed};
  return {pages::decision_text(source, worst->decision), rank(worst->decision) > 0,
          levels[rank(worst->decision)]};
}

}  // namespace

void add_summary(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  Table table;
  for (const char* name : {"measurement", "state", "results", "decision", "warnings"})
    table.columns.push_back(
        {w.get("summary." + std::string(name)), "", std::string_view(name) == "warnings"});
  for (const Measured& m : measured(source.in)) {
    const std::vector<Line> lines = main_values(source, m);
    const auto warnings = std::count_if(m.findings.begin(), m.findings.end(),
                                        [](const Finding* f) { return f->attention; });
    if (lines.empty() && warnings == 0) continue;
    const std::string& state = m.measurement.adjustment;
    table.rows.push_back({{m.measurement.id, true},
                          {state.empty() ? "–" : w.get("summary." + state)},
                          {lines.empty() ? "–" : text_of(source, lines)},
                          decision_of(source, m),
                          {std::to_string(warnings)}});
  }
  if (table.rows.size() < fewest_measurements) return;
  blocks.push_back({Heading{w.get("summary.title"), 1}, "summary"});
  blocks.push_back({std::move(table), "summary"});
  blocks.push_back({PageBreak{}});
}

}  // namespace nonio::pdf_report
