// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::pages {

using namespace reports;

namespace {

std::string small(const Source& source, double u, Quantity q) {
  if (!(u > 0.0)) return "0";
  return printed_result(u, u, q, source.language()).U;
}

/// The unit of deviations; for a pure number, 10^-6.
struct ShortUnit {
  Quantity quantity;
  double factor = 1.0;
  std::string text;
};
ShortUnit short_unit(Quantity q) {
  if (q == Quantity::length) return {Quantity::deviation, 1.0, unit_text(Quantity::deviation)};
  if (q == Quantity::angle)
    return {Quantity::angular_deviation, 1.0, unit_text(Quantity::angular_deviation)};
  if (q == Quantity::number) return {q, 1e6, "10^\u22126"};
  return {q, 1.0, unit_text(q)};
}

/// A contribution below 1e-6 of the variance is printed as "0".
std::string part(const Source& source, double u, double whole, const ShortUnit& unit) {
  constexpr double nothing = 1e-3;
  if (!(u > nothing * whole)) return "0";
  return small(source, unit.factor * u, unit.quantity);
}

/// In words for customers, without repetition: "data of the machine", not
/// "machine.axes.X.expansion_um_per_m_K".
std::string source_text(const Source& source, const Contribution& c) {
  const Wording& w = source.words;
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < c.source.size();) {
    const std::size_t end = std::min(c.source.find(", ", at), c.source.size());
    std::string part = c.source.substr(at, end - at);
    at = end + 2;
    const std::size_t dot = part.find('.');
    const bool is_key = part.find(' ') == part.npos && part.find_first_of("._") != part.npos;
    if (part == "readings")
      part = w.get("budget.from_readings");
    else if (is_key && dot != part.npos)
      part = w.get_or("budget.source_of." + part.substr(0, dot), w.get("budget.source_of.options"));
    else if (is_key)
      continue;
    if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
  }
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return all;
}

std::string distribution_text(const Source& source, const Contribution& c) {
  const std::string key = "budget.distribution_of." + std::string(to_text(c.distribution));
  if (!c.dof) return source.words.get(key);
  return source.words.get(
      key, {{"dof", printed_number(*c.dof, Quantity::number, 0, source.language())}});
}

Table inputs(const Source& source, const Results::Analysed& a, const UncertaintyBudget& budget) {
  const Wording& w = source.words;
  Table table;
  table.title =
      w.get("budget.title", {{"analysis", analysis_title(source, a)}}) + " – " + w.get("budget.u");
  if (budget.length > 0.0)
    table.title +=
        ", " +
        w.get("budget.length",
              {{"length",
                printed_number(budget.length, Quantity::length, 0, source.language()) + " mm"}});
  table.columns = {{w.get("budget.no"), "", true},
                   {w.get("budget.contribution"), "", false},
                   {"u", "", true},
                   {"", "", false},
                   {w.get("budget.distribution"), "", false},
                   {w.get("budget.correlation"), "", false},
                   {w.get("budget.source"), "", false}};
  for (std::size_t i = 0; i < budget.contributions.size(); ++i) {
    const Contribution& c = budget.contributions[i];
    table.rows.push_back({{std::to_string(i + 1)},
                          {w.get_or("budget.item." + c.id, c.id)},
                          {small(source, c.u, c.quantity)},
                          {unit_text(c.quantity)},
                          {distribution_text(source, c)},
                          {w.get("budget.correlation_of." + std::string(to_text(c.correlation)))},
                          {source_text(source, c)}});
  }
  return table;
}

struct Row {
  std::string names;
  const UncertaintyBudget::Result* result;
};

std::vector<Row> rows_of(const UncertaintyBudget& budget) {
  std::vector<Row> rows;
  for (const auto& r : budget.results) {
    const auto same = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
      return row.result->u == r.u && row.result->k == r.k && row.result->quantity == r.quantity;
    });
    if (same == rows.end())
      rows.push_back({symbol(r.name), &r});
    else
      same->names += ", " + symbol(r.name);
  }
  return rows;
}

Table results(const Source& source, const Results::Analysed& a, const UncertaintyBudget& budget) {
  const Wording& w = source.words;
  Table table;
  table.title = w.get("budget.results");
  table.columns = {{w.get("budget.result"), "", false}, {"", "", false}};
  for (std::size_t i = 0; i < budget.contributions.size(); ++i)
    table.columns.push_back({std::to_string(i + 1), "", true});
  table.columns.push_back({w.get("results.k"), "", true});
  table.columns.push_back({w.get("results.uncertainty"), "", true});
  for (const Row& row : rows_of(budget)) {
    const UncertaintyBudget::Result& r = *row.result;
    const ShortUnit unit = short_unit(r.quantity);
    double variance = 0.0;
    for (const double u : r.u) variance += u * u;
    std::vector<Table::Cell> cells = {{row.names, true}, {unit.text}};
    for (const double u : r.u) cells.push_back({part(source, u, std::sqrt(variance), unit)});
    std::string U;
    double k = r.k;
    for (const Value& v : a.evaluation.values)
      if (v.name == r.name && v.U) {
        U = small(source, unit.factor * *v.U, unit.quantity);
        k = v.k;
      }
    cells.push_back({printed_number(k, Quantity::number, 2, source.language())});
    cells.push_back({U, true});
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

std::string cmc_text(const Source& source, const Results::Analysed& a) {
  for (const Finding& f : a.evaluation.findings) {
    if (f.id != "uncertainty.cmc") continue;
    std::string names;
    for (const auto& [name, text] : f.texts)
      for (std::size_t at = 0; name == "results" && at < text.size();) {
        const std::size_t end = std::min(text.find(", ", at), text.size());
        names += (names.empty() ? "" : ", ") + symbol(text.substr(at, end - at));
        at = end + 2;
      }
    return source.words.get("budget.cmc", {{"results", names}});
  }
  return {};
}

void add_budget(const Source& source, const Measured& m, Blocks& blocks) {
  for (const auto* a : m.analyses) {
    const auto& budget = a->evaluation.budget;
    if (!budget || budget->results.empty()) continue;
    const std::string field = "budget of " + a->plugin + ", measurement " + a->measurement;
    blocks.push_back({inputs(source, *a, *budget), field});
    blocks.push_back({results(source, *a, *budget), field});
    if (std::string text = cmc_text(source, *a); !text.empty())
      blocks.push_back({Paragraph{std::move(text), Paragraph::Look::small}, field});
  }
}

}  // namespace nonio::pages
