// SPDX-License-Identifier: Apache-2.0
#include "rules.h"

#include <algorithm>
#include <utility>

#include "nonio/reports/number.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/format.h"

namespace nonio::pages {

using namespace reports;

namespace {

constexpr std::string_view half_of_a_range = "+-";

struct Named {
  std::string symbol;
  const Value* value;
};

struct RuleColumn {
  std::vector<std::string> titles;
  std::vector<Named> values;

  const Value* find(std::string_view symbol) const {
    for (const Named& n : values)
      if (n.symbol == symbol) return n.value;
    return nullptr;
  }
  bool same_as(const RuleColumn& o) const {
    return std::equal(values.begin(), values.end(), o.values.begin(), o.values.end(),
                      [](const Named& a, const Named& b) {
                        return a.symbol == b.symbol && a.value->value == b.value->value &&
                               a.value->U == b.value->U;
                      });
  }
};

struct RuleTable {
  std::vector<std::string> symbols;
  std::vector<RuleColumn> columns;
};

bool within(const std::vector<std::string>& some, const std::vector<std::string>& all) {
  return std::all_of(some.begin(), some.end(), [&](const std::string& s) {
    return std::find(all.begin(), all.end(), s) != all.end();
  });
}

std::vector<std::string> symbols_of(const RuleColumn& c) {
  std::vector<std::string> out;
  for (const Named& n : c.values) out.push_back(n.symbol);
  return out;
}

std::vector<RuleColumn> columns_of(const Source& source, const Results::Analysed& a) {
  std::vector<RuleColumn> out;
  for (const auto& [name, title] : rules_of(a)->texts) {
    RuleColumn column{{title}, {}};
    for (const Value& v : a.evaluation.values)
      if (v.name.starts_with(name + ":") && (v.U || !source.certificate))
        column.values.push_back({v.name.substr(name.size() + 1), &v});
    if (column.values.empty()) continue;
    const auto same = std::find_if(out.begin(), out.end(),
                                   [&](const RuleColumn& c) { return c.same_as(column); });
    if (same == out.end())
      out.push_back(std::move(column));
    else
      same->titles.push_back(title);
  }
  return out;
}

std::vector<RuleTable> tables_of(std::vector<RuleColumn> columns) {
  std::vector<RuleTable> out;
  for (RuleColumn& c : columns) {
    std::vector<std::string> symbols = symbols_of(c);
    const auto fits = std::find_if(out.begin(), out.end(), [&](const RuleTable& t) {
      return within(symbols, t.symbols) || within(t.symbols, symbols);
    });
    if (fits == out.end()) {
      out.push_back({std::move(symbols), {}});
      out.back().columns.push_back(std::move(c));
      continue;
    }
    if (symbols.size() > fits->symbols.size()) fits->symbols = std::move(symbols);
    fits->columns.push_back(std::move(c));
  }
  return out;
}

/// No-break spaces keep each title on one line.
std::string titles_in_line(const std::vector<std::string>& titles) {
  std::string out;
  for (const std::string& title : titles) {
    out += out.empty() ? "" : ", ";
    for (const char c : title)
      if (c == ' ')
        out += "\u00a0";
      else
        out += c;
  }
  return out;
}

Table table_of(const Source& source, const RuleTable& t, std::size_t first, std::size_t last) {
  const Wording& w = source.words;
  Table table;
  const Value& any = *t.columns[first].values.front().value;
  const std::string unit = unit_text(any.quantity);
  bool U = false;
  for (std::size_t c = first; c < last; ++c)
    for (const Named& n : t.columns[c].values) U |= n.value->U.has_value();
  table.columns = {{w.get("results.symbol"), "", false}, {w.get("results.meaning"), "", false}};
  for (std::size_t c = first; c < last; ++c) {
    table.columns.push_back({titles_in_line(t.columns[c].titles), unit, true});
    if (U) table.columns.push_back({w.get("results.uncertainty"), unit, true});
  }
  for (const std::string& name : t.symbols) {
    std::vector<Table::Cell> row = {{symbol(name), true}, {w.get_or("value." + name, "")}};
    const bool half = name.starts_with(half_of_a_range);
    for (std::size_t c = first; c < last; ++c) {
      const Value* v = t.columns[c].find(name);
      const Printed shown = v == nullptr
                                ? Printed{"–", "–"}
                                : printed_result(v->value, v->U, v->quantity, source.language());
      row.push_back({(half && v != nullptr ? "±" : "") + shown.value});
      if (U) row.push_back({v != nullptr && !v->U ? "–" : shown.U});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

void add_decisions(const Source& source, const Results::Analysed& a, Blocks& blocks) {
  const Wording& w = source.words;
  Table table;
  for (const char* key : {"results.symbol", "results.value", "results.tolerance"})
    table.columns.push_back({w.get(key), "", table.columns.size() > 0});
  table.columns.push_back({"", "", false});
  table.columns.push_back({w.get("results.decision"), "", false});
  for (const Value& v : a.evaluation.values) {
    const Conformity* c = conformity_of(source.in, a, v.name);
    if (c == nullptr) continue;
    table.rows.push_back(
        {{symbol(v.name), true},
         {printed_result(v.value, v.U, v.quantity, source.language(), c->tolerance).value},
         {plain_number(source, c->tolerance, c->quantity)},
         {unit_text(c->quantity)},
         {decision_text(source, c->decision), true,
          c->decision == Decision::conforms           ? Level::good
          : c->decision == Decision::does_not_conform ? Level::failed
                                                      : Level::attention}});
  }
  if (!table.rows.empty()) blocks.push_back({std::move(table), "decisions on rules"});
}

bool is_sureness(const Remark& note) {
  return note.id == "rules.known" || note.id.ends_with("inferred");
}

std::string rule_note(const Source& source, const Remark& note) {
  return typeset(remark_text(source.in.templates, source.language(), note));
}

}  // namespace

std::string without_rule(const std::string& name) { return name.substr(name.find(':') + 1); }

const Remark* rules_of(const Results::Analysed& a) {
  for (const Remark& note : a.evaluation.notes)
    if (note.id == "rules.evaluated") return &note;
  return nullptr;
}

void add_rule_tables(const Source& source, const Results::Analysed& a, Blocks& blocks) {
  const std::string field = "results of " + a.plugin + ", measurement " + a.measurement;
  const bool two_languages =
      source.certificate && source.in.campaign.certificate.languages.size() > 1;
  const std::size_t most = two_languages ? 2 : 3;
  std::string title = analysis_title(source, a);
  for (const RuleTable& t : tables_of(columns_of(source, a)))
    for (std::size_t first = 0; first < t.columns.size(); first += most) {
      Table table = table_of(source, t, first, std::min(first + most, t.columns.size()));
      table.title = std::exchange(title, {});
      blocks.push_back({std::move(table), field});
    }
}

void add_rule_notes(const Source& source, const Results::Analysed& a, Blocks& blocks) {
  const std::string field = "results of " + a.plugin + ", measurement " + a.measurement;
  if (!source.certificate) add_decisions(source, a, blocks);
  std::vector<std::string> paragraphs;
  bool differ = false;
  for (const Remark& note : a.evaluation.notes) {
    if (note.id == "rules.evaluated" || (source.certificate && is_sureness(note))) continue;
    const std::string text = rule_note(source, note);
    const bool reason = note.id.starts_with("rules.differ");
    if (reason && std::exchange(differ, true))
      paragraphs.back() += " " + text;
    else
      paragraphs.push_back(text);
  }
  for (std::string& text : paragraphs)
    blocks.push_back({Paragraph{std::move(text), Paragraph::Look::small}, field});
}

}  // namespace nonio::pages
