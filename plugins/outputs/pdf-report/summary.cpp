// SPDX-License-Identifier: Apache-2.0
// Table of all measurements on the first page.
#include <algorithm>
#include <cstddef>

#include "nonio/reports/number.h"
#include "report.h"

namespace nonio::pdf_report {

using namespace reports;

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
