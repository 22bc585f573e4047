// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "nonio/reports/model.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "pages.h"
#include "rules.h"

namespace nonio::pages {
using namespace reports;

std::string meaning_of(const Source& source, const std::string& name) {
  const std::string known = source.words.get_or("value." + name, "");
  if (!known.empty()) return known;
  for (std::size_t end = name.rfind('_'); end != std::string::npos && end > 0;
       end = name.rfind('_', end - 1)) {
    const std::string key = "value_of." + name.substr(0, end);
    if (!source.words.get_or(key, "").empty())
      return source.words.get(key, {{"id", name.substr(end + 1)}});
  }
  return "";
}

namespace {

const Value* value_of(const Measured& m, std::string_view name) {
  for (const auto* a : m.analyses)
    for (const Value& v : a->evaluation.values)
      if (v.name == name) return &v;
  return nullptr;
}

Table::Cell decision_cell(const Source& source, const Conformity* c) {
  if (c == nullptr) return {""};
  const bool good = c->decision == Decision::conforms;
  return {decision_text(source, c->decision), !good,
          good                                        ? Level::good
          : c->decision == Decision::does_not_conform ? Level::failed
                                                      : Level::attention};
}

std::string tolerance_text(const Source& source, const Conformity* c) {
  return c == nullptr ? "" : plain_number(source, c->tolerance, c->quantity);
}

struct Shape {
  bool meaning = false, U = false, k = false, repeatability = false;
  bool decision = false, own_units = false;
  std::string unit;
};

bool left_out(const Source& source, const Value& v) { return source.certificate && !v.U; }

Shape shape_of(const Source& source, const Results::Analysed& a) {
  Shape s;
  const auto& values = a.evaluation.values;
  s.unit = values.empty() ? "" : unit_text(values.front().quantity);
  for (const Value& v : values) {
    if (left_out(source, v)) continue;
    s.meaning |= !meaning_of(source, v.name).empty();
    s.U |= v.U.has_value();
    s.k |= (v.U || v.repeatability) && std::fabs(v.k - 2.0) >= 0.005;
    s.repeatability |= v.repeatability.has_value();
    s.decision |= !source.certificate && conformity_of(source.in, a, v.name) != nullptr;
    s.own_units |= unit_text(v.quantity) != s.unit;
  }
  return s;
}

Block value_table(const Source& source, const Results::Analysed& a) {
  const Wording& w = source.words;
  const Shape shape = shape_of(source, a);
  Table table;
  table.title = analysis_title(source, a);
  const auto column = [&](const char* key, bool number, bool with_unit) {
    table.columns.push_back({w.get(key), with_unit && !shape.own_units ? shape.unit : "", number});
  };
  column("results.symbol", false, false);
  if (shape.meaning) column("results.meaning", false, false);
  column("results.value", true, true);
  if (shape.U) column("results.uncertainty", true, true);
  if (shape.repeatability) column("results.repeatability", true, true);
  if (shape.k) column("results.k", true, false);
  if (shape.decision) column("results.tolerance", true, true);
  if (shape.own_units) table.columns.push_back({"", "", false});
  if (shape.decision) column("results.decision", false, false);
  for (const Value& v : a.evaluation.values) {
    if (left_out(source, v)) continue;
    const Conformity* c = conformity_of(source.in, a, v.name);
    const Printed shown =
        printed_result(v.value, v.U ? v.U : v.repeatability, v.quantity, source.language(),
                       c == nullptr ? std::nullopt : std::optional(c->tolerance));
    std::vector<Table::Cell> row = {{symbol(v.name), true}};
    if (shape.meaning) row.push_back({meaning_of(source, v.name)});
    row.push_back({shown.value});
    if (shape.U) row.push_back({v.U ? shown.U : "–"});
    if (shape.repeatability)
      row.push_back({v.repeatability
                         ? printed_result(v.value, v.repeatability, v.quantity, source.language()).U
                         : "–"});
    if (shape.k)
      row.push_back({v.U || v.repeatability
                         ? printed_number(v.k, Quantity::number, 2, source.language())
                         : ""});
    if (shape.decision) row.push_back({tolerance_text(source, c)});
    if (shape.own_units) row.push_back({unit_text(v.quantity)});
    if (shape.decision) row.push_back(decision_cell(source, c));
    table.rows.push_back(std::move(row));
  }
  return {std::move(table), "results of " + a.plugin + ", measurement " + a.measurement};
}

bool found(const Measured& m, std::string_view kind) {
  return std::any_of(m.findings.begin(), m.findings.end(),
                     [&](const Finding* f) { return f->id.starts_with(kind); });
}

/// Compares ISO 230-2 with VDI/DGQ 3441 for the same readings if the directions differ
/// significantly.
void add_what_is_hidden(const Source& source, const Measured& m, Blocks& blocks) {
  const Wording& w = source.words;
  std::vector<std::string> lines;
  const auto text = [&](const Value* v) {
    return printed_result(v->value, v->U, v->quantity, source.language()).value;
  };
  const Value *plus = value_of(m, "R+"), *minus = value_of(m, "R-"), *ps = value_of(m, "Ps_max");
  if (plus != nullptr && minus != nullptr && ps != nullptr) {
    const double small = std::min(plus->value, minus->value);
    const double ratio = std::max(plus->value, minus->value) / small;
    if (small > 0 && found(m, "repeatability."))
      lines.push_back(w.get("hidden.repeatability",
                            {{"plus", text(plus)},
                             {"minus", text(minus)},
                             {"ps", text(ps)},
                             {"unit", unit_text(plus->quantity)},
                             {"ratio", localised(short_text(ratio, 2), source.language())}}));
  }
  const Value *B = value_of(m, "B"), *mean = value_of(m, "B_mean");
  const Value *U_mean = value_of(m, "U_mean"), *U_max = value_of(m, "U_max");
  if (B != nullptr && mean != nullptr && U_mean != nullptr && U_max != nullptr &&
      found(m, "reversal."))
    lines.push_back(w.get("hidden.reversal", {{"mean", text(mean)},
                                              {"largest", text(B)},
                                              {"u_mean", text(U_mean)},
                                              {"u_max", text(U_max)},
                                              {"unit", unit_text(B->quantity)}}));
  if (lines.empty()) return;
  blocks.push_back({Heading{w.get("hidden.title"), 2}, "hidden.title"});
  for (const std::string& line : lines)
    blocks.push_back({Paragraph{line, Paragraph::Look::small}, "hidden"});
}

}  // namespace

std::string analysis_title(const Source& source, const Results::Analysed& a) {
  const std::string known = source.words.get_or("analysis." + a.plugin, a.plugin);
  return follows_plan(source.in, a) ? known
                                    : source.words.get_or("analysis_own_plan." + a.plugin, known);
}

std::string rule_text(const Source& source) {
  const std::string& rule = source.in.campaign.certificate.decision_rule;
  return source.words.get("rule." + (rule.empty() ? "iso14253-1" : rule));
}

std::string decision_text(const Source& source, Decision decision) {
  if (source.in.campaign.certificate.decision_rule.starts_with("ilac"))
    return source.words.get(decision == Decision::conforms ? "results.pass" : "results.fail");
  return source.words.get(decision == Decision::conforms           ? "results.conforms"
                          : decision == Decision::does_not_conform ? "results.does_not_conform"
                                                                   : "results.cannot_be_decided");
}

const Conformity* conformity_of(const OutputInput& in, const Results::Analysed& a,
                                const std::string& name) {
  for (const Conformity& c : in.results.conformity)
    if (c.measurement == a.measurement && c.plugin == a.plugin && c.name == name) return &c;
  return nullptr;
}

std::vector<std::string> undecided(const Source& source) {
  const Wording& w = source.words;
  const Campaign& c = source.in.campaign;
  const auto is_held = [&](const std::string& measurement, const std::string& name) {
    const auto& all = source.in.results.conformity;
    return std::any_of(all.begin(), all.end(), [&](const Conformity& k) {
      return k.measurement == measurement && k.name == name && k.reason != "no-value" &&
             !(source.certificate && k.reason == "no-uncertainty");
    });
  };
  const auto is_held_with = [&](const std::string& measurement, const std::string& name) {
    const auto& all = source.in.results.analyses;
    return std::any_of(all.begin(), all.end(), [&](const Results::Analysed& a) {
      const auto& uses = a.evaluation.uses;
      return std::find(uses.begin(), uses.end(), measurement) != uses.end() &&
             is_held(a.measurement, name);
    });
  };
  std::string not_measured;
  std::vector<std::string> sentences;
  const auto add_missing = [&](const Measurement& m, const std::vector<std::string>& limited) {
    std::string names;
    for (const std::string& name : limited)
      if (!is_held(m.id, name) && !is_held_with(m.id, name))
        names += (names.empty() ? "" : ", ") + symbol(name);
    if (!names.empty())
      sentences.push_back(w.get("undecided.no_result", {{"measurement", m.id}, {"names", names}}));
  };
  for (const Axis& axis : c.machine.axes) {
    if (axis.tolerance.empty()) continue;
    bool measured = false;
    for (const Measurement& m : c.measurements) {
      if (m.axis != axis.name || m.kind != "axis") continue;
      measured = true;
      std::vector<std::string> names;
      for (const auto& [name, limit] : axis.tolerance) names.push_back(name);
      add_missing(m, names);
    }
    if (!measured) not_measured += (not_measured.empty() ? "" : ", ") + axis.name;
  }
  for (const Measurement& m : c.measurements) {
    std::vector<std::string> names;
    for (const Tolerance& t : m.tolerances)
      if (m.kind != "axis" || !c.machine.axis(m.axis) ||
          !c.machine.axis(m.axis)->tolerance.contains(t.result))
        names.push_back(t.result);
    add_missing(m, names);
  }
  if (!not_measured.empty())
    sentences.push_back(w.get("undecided.not_measured", {{"axes", not_measured}}));
  return sentences;
}

namespace {

void add_by_rules(const Source& source, const Results::Analysed& a, Blocks& blocks) {
  add_rule_tables(source, a, blocks);
  Results::Analysed rest = a;
  std::erase_if(rest.evaluation.values,
                [](const Value& v) { return v.name.find(':') != std::string::npos; });
  if (!rest.evaluation.values.empty()) {
    Block block = value_table(source, rest);
    std::get<Table>(block.what).title.clear();
    blocks.push_back(std::move(block));
  }
  add_rule_notes(source, a, blocks);
}

}  // namespace

void add_results(const Source& source, const Measured& m, Blocks& blocks) {
  std::vector<Blocks> parts;
  Blocks rules;
  const bool wide = source.certificate && source.in.campaign.certificate.languages.size() > 1;
  bool decisions = wide, second_decides = false;
  for (const auto* a : m.analyses) {
    const auto& values = a->evaluation.values;
    if (a->plugin == model_analysis ||
        std::all_of(values.begin(), values.end(),
                    [&](const Value& v) { return left_out(source, v); }))
      continue;
    if (rules_of(*a) != nullptr) {
      add_by_rules(source, *a, rules);
      continue;
    }
    parts.push_back({value_table(source, *a)});
    if (parts.size() == 2) second_decides = shape_of(source, *a).decision;
    if (parts.size() <= 2) decisions |= shape_of(source, *a).decision;
  }
  Blocks hidden;
  if (parts.size() > 1 && !source.certificate) add_what_is_hidden(source, m, hidden);
  if (decisions && !second_decides && !hidden.empty())
    parts[1] = {{Columns{{std::move(parts[1]), std::move(hidden)}, {0.55, 0.45}}, "results"}};
  else if (parts.size() > 1)
    std::move(hidden.begin(), hidden.end(), std::back_inserter(parts[1]));
  std::size_t next = 0;
  if (parts.size() > 1 && !decisions) {
    blocks.push_back(
        {Columns{{std::move(parts[0]), std::move(parts[1])}, {0.55, 0.45}}, "results"});
    next = 2;
  }
  for (; next < parts.size(); ++next)
    std::move(parts[next].begin(), parts[next].end(), std::back_inserter(blocks));
  std::move(rules.begin(), rules.end(), std::back_inserter(blocks));
}

namespace {

struct Joined {
  const PointTable* base;
  std::vector<const PointTable::Column*> columns;
};

bool without_values(const Source& source, const Results::Analysed& a) {
  const auto& values = a.evaluation.values;
  return source.certificate && std::all_of(values.begin(), values.end(),
                                           [&](const Value& v) { return left_out(source, v); });
}

std::vector<Joined> joined_points(const Source& source, const Measured& m) {
  std::vector<Joined> out;
  for (const auto* a : m.analyses) {
    if (without_values(source, *a)) continue;
    const PointTable& points = a->evaluation.points;
    if (points.columns.empty() || points.columns.front().values.empty()) continue;
    Joined* into = nullptr;
    for (Joined& j : out)
      if (j.base->columns.front().values == points.columns.front().values) into = &j;
    if (into == nullptr) into = &out.emplace_back(Joined{&points, {}});
    for (const PointTable::Column& c : points.columns) {
      const bool known =
          std::any_of(into->columns.begin(), into->columns.end(),
                      [&](const PointTable::Column* k) { return k->name == c.name; });
      if (!known) into->columns.push_back(&c);
    }
  }
  return out;
}

bool all_missing(const PointTable::Column& c) {
  const bool count = c.quantity == Quantity::count;
  return std::none_of(c.values.begin(), c.values.end(),
                      [&](double v) { return std::isfinite(v) && !(count && v == 0); });
}

std::optional<double> common_count(const Joined& joined) {
  std::optional<double> n;
  for (const auto* c : joined.columns) {
    if (c->quantity != Quantity::count || all_missing(*c)) continue;
    for (const double v : c->values) {
      if (n && *n != v) return {};
      n = v;
    }
  }
  return n;
}

}  // namespace

namespace {

std::vector<std::string> cells_of(const Source& source, const PointTable::Column& c, bool target,
                                  std::size_t rows) {
  const int decimals = target                          ? decimals_for(c.values, c.quantity, 4)
                       : c.quantity == Quantity::count ? 0
                                                       : 3;
  const bool by_U = source.certificate && c.U;
  std::vector<std::string> out;
  for (std::size_t i = 0; i < rows; ++i)
    out.push_back(i >= c.values.size() ? "–"
                  : by_U ? printed_result(c.values[i], c.U, c.quantity, source.language()).value
                         : printed_number(c.values[i], c.quantity, decimals, source.language()));
  if (source.certificate)
    out.push_back(target ? U_heading(source, 2.0)
                  : by_U ? printed_result(0.0, c.U, c.quantity, source.language()).U
                         : "");
  return out;
}

}  // namespace

std::string U_heading(const Source& source, double k) {
  return source.words.get(
      "targets.uncertainty",
      {{"k", k == 2.0 ? "2" : printed_number(k, Quantity::number, 2, source.language())}});
}

namespace {

using SideBySide = std::vector<const Series*>;

std::vector<SideBySide> curves_of(const Source& source, const Measured& m) {
  constexpr std::size_t per_table = 3;
  std::vector<SideBySide> all;
  for (const Results::Analysed* a : m.analyses) {
    if (a->plugin == model_analysis || without_values(source, *a)) continue;
    for (const Series& s : a->evaluation.series) {
      if (s.position.empty() || (source.certificate && s.U.size() != s.value.size())) continue;
      const bool fits = !all.empty() && all.back().size() < per_table &&
                        all.back().front()->over == s.over &&
                        all.back().front()->position_quantity == s.position_quantity &&
                        all.back().front()->position == s.position;
      if (!fits) all.emplace_back();
      all.back().push_back(&s);
    }
  }
  return all;
}

/// Value and U ("–" without U), and whether U is missing. Both texts are empty if the value is not
/// finite, or if a certificate requires U for a nonzero value.
std::pair<Printed, bool> at_place(const Source& source, const Series& s, std::size_t i) {
  constexpr double nothing = 1e-12;
  if (!std::isfinite(s.value[i])) return {{"", ""}, false};
  const std::optional<double> U =
      i < s.U.size() && std::isfinite(s.U[i]) ? std::optional(s.U[i]) : std::nullopt;
  const bool none = !U || !(*U > 0.0);
  if (none && source.certificate && std::fabs(s.value[i]) > nothing) return {{"", ""}, false};
  Printed shown = printed_result(s.value[i], U, s.quantity, source.language());
  if (shown.U.empty()) shown.U = "–";
  return {std::move(shown), none};
}

void add_curve_table(Table table, const std::string& field, Blocks& blocks) {
  constexpr std::size_t narrow = 3, few = 12, most = 80;
  const std::size_t n = table.rows.size();
  if (table.columns.size() > narrow || n <= few || n > most) {
    blocks.push_back({std::move(table), field});
    return;
  }
  blocks.push_back({Heading{std::exchange(table.title, {}), 2}, field});
  Table second = table;
  const auto half = static_cast<std::ptrdiff_t>((n + 1) / 2);
  table.rows.erase(table.rows.begin() + half, table.rows.end());
  second.rows.erase(second.rows.begin(), second.rows.begin() + half);
  blocks.push_back({Columns{{{{std::move(table), field}}, {{std::move(second), field}}}}, field});
}

void add_curves(const Source& source, const Measured& m, Blocks& blocks) {
  const Wording& w = source.words;
  bool by_definition = false;
  for (const SideBySide& curves : curves_of(source, m)) {
    const Series& first = *curves.front();
    Table table;
    table.columns = {
        {w.get("plot.place", {{"axis", first.over}}), unit_text(first.position_quantity), true}};
    std::string names;
    for (const Series* s : curves) {
      names += (names.empty() ? "" : ", ") + symbol(s->name);
      table.columns.push_back({symbol(s->name), unit_text(s->quantity), true});
      table.columns.push_back({U_heading(source, s->k), unit_text(s->quantity), true});
    }
    table.title = w.get(curves.size() == 1 ? "targets.curve" : "targets.curves", {{"name", names}});
    const int decimals = decimals_for(first.position, first.position_quantity, 4);
    for (std::size_t i = 0; i < first.position.size(); ++i) {
      std::vector<Table::Cell> row = {{printed_number(first.position[i], first.position_quantity,
                                                      decimals, source.language())}};
      bool any = false;
      for (const Series* s : curves) {
        auto [shown, none] = at_place(source, *s, i);
        any |= !shown.value.empty();
        by_definition |= none;
        row.push_back({std::move(shown.value)});
        row.push_back({std::move(shown.U)});
      }
      if (any) table.rows.push_back(std::move(row));
    }
    if (!table.rows.empty())
      add_curve_table(std::move(table), "curves " + names + " of " + m.measurement.id, blocks);
  }
  if (by_definition)
    blocks.push_back({Paragraph{w.get("targets.by_definition"), Paragraph::Look::small},
                      "curves of " + m.measurement.id});
}

}  // namespace

void add_targets(const Source& source, const Measured& m, Blocks& blocks) {
  const Wording& w = source.words;
  if (source.certificate) add_curves(source, m, blocks);
  for (const Joined& joined : joined_points(source, m)) {
    const auto n = common_count(joined);
    Table table;
    table.title = w.get("targets.title");
    if (n)
      table.title += " (" + w.get("targets.number") + " = " +
                     printed_number(*n, Quantity::count, 0, source.language()) + ")";
    std::vector<std::vector<std::string>> columns;
    for (const auto* c : joined.columns) {
      const bool target = c == joined.columns.front(), count = c->quantity == Quantity::count;
      if ((n && count) || all_missing(*c)) continue;
      if (source.certificate && !target && !count && !c->U) continue;
      const std::string title = target && c->name == "target"
                                    ? w.get("targets.target")
                                    : w.get_or("column." + c->name, symbol(c->name));
      table.columns.push_back({title, unit_text(c->quantity), true});
      columns.push_back(cells_of(source, *c, target, joined.base->columns.front().values.size()));
    }
    if (source.certificate && columns.size() < 2) continue;
    for (std::size_t i = 0; i < columns.front().size(); ++i) {
      std::vector<Table::Cell> row;
      const bool last = source.certificate && i + 1 == columns.front().size();
      for (const auto& column : columns) row.push_back({column[i], last});
      table.rows.push_back(std::move(row));
    }
    blocks.push_back({std::move(table), "targets of measurement " + m.measurement.id});
  }
}

namespace {

bool has(const Results::Analysed& a, std::string_view id) {
  const auto& findings = a.evaluation.findings;
  return std::any_of(findings.begin(), findings.end(),
                     [&](const Finding& f) { return f.id == id; });
}

bool departs(const Results::Analysed& a) {
  const auto& findings = a.evaluation.findings;
  return std::any_of(findings.begin(), findings.end(), [](const Finding& f) {
    return (f.id.starts_with("plan.") && f.id != "plan.long-axis") || f.id == "direction.missing" ||
           f.id == "targets.unpaired";
  });
}

const Measurement* measurement_of(const OutputInput& in, const Results::Analysed& a) {
  for (const Measurement& m : in.campaign.measurements)
    if (m.id == a.measurement) return &m;
  return nullptr;
}

bool has_short_test(const OutputInput& in, const Results::Analysed& whole) {
  const Measurement* m = measurement_of(in, whole);
  if (m == nullptr) return false;
  return std::any_of(
      in.results.analyses.begin(), in.results.analyses.end(), [&](const Results::Analysed& other) {
        const Measurement* o = measurement_of(in, other);
        return &other != &whole && other.plugin == whole.plugin && o != nullptr &&
               o->axis == m->axis && o->kind == m->kind && o->adjustment == m->adjustment &&
               !departs(other) && !has(other, "plan.long-axis");
      });
}

}  // namespace

bool follows_plan(const OutputInput& in, const Results::Analysed& a) {
  return !departs(a) && (!has(a, "plan.long-axis") || has_short_test(in, a));
}

}  // namespace nonio::pages
