// SPDX-License-Identifier: Apache-2.0
// Results with their limits and decisions, on the first page (ISO/IEC 17025:2017, 7.8.6).
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "certificate.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"

namespace nonio::certificate {

using namespace reports;

namespace {

struct Shown {
  const pages::Measured* measured;
  const Value* value;
  const Conformity* limit;
};

/// "A+" (printed "A↑") also matches "A" if the test has no "A".
bool is_named(const Source& source, const Evaluation& e, const std::string& name) {
  const std::vector<std::string>& summary = source.look.summary;
  const auto in_summary = [&](const std::string& n) {
    return std::find(summary.begin(), summary.end(), n) != summary.end();
  };
  if (in_summary(name)) return true;
  if (name.size() < 2 || (name.back() != '+' && name.back() != '-')) return false;
  const std::string both = name.substr(0, name.size() - 1);
  return in_summary(both) && std::none_of(e.values.begin(), e.values.end(),
                                          [&](const Value& v) { return v.name == both && v.U; });
}

/// All results with a limit, because no other part contains their decisions, and those that the
/// template names. If there are more than 18, fewer of the latter are shown.
std::vector<Shown> shown_results(const Source& source,
                                 const std::vector<pages::Measured>& measured) {
  constexpr std::size_t most = 18;
  std::vector<Shown> all;
  for (const pages::Measured& m : measured)
    for (const Results::Analysed* a : m.analyses) {
      if (!is_printed(*a)) continue;
      for (const Value& v : a->evaluation.values) {
        const Conformity* limit = pages::conformity_of(source.in, *a, v.name);
        if (v.U && (limit != nullptr || is_named(source, a->evaluation, v.name)))
          all.push_back({&m, &v, limit});
      }
    }
  const auto limited = [](const Shown& s) { return s.limit != nullptr; };
  if (all.size() <= most) return all;
  if (std::any_of(all.begin(), all.end(), limited)) {
    std::set<const pages::Measured*> with_limit;
    for (const Shown& s : all)
      if (limited(s)) with_limit.insert(s.measured);
    std::erase_if(all,
                  [&](const Shown& s) { return !limited(s) && with_limit.contains(s.measured); });
  } else {
    const pages::Measured* last = nullptr;
    std::erase_if(all,
                  [&](const Shown& s) { return std::exchange(last, s.measured) == s.measured; });
  }
  return all;
}

/// With two languages, meanings are printed below the table, because a column would double the row
/// height.
bool is_brief(const Source& source) { return source.in.campaign.certificate.languages.size() > 1; }

std::string meanings(const Source& source, const std::vector<Shown>& all) {
  std::string text;
  std::set<std::string> said;
  for (const Shown& s : all) {
    const std::string meaning =
        source.words.get_or("value." + pages::without_rule(s.value->name), "");
    if (meaning.empty() || !said.insert(s.value->name).second) continue;
    text += (text.empty() ? "" : "; ") + pages::symbol(s.value->name) + ": " + meaning;
  }
  return text.empty() ? text : ended(source, text);
}

Level level_of(Decision decision) {
  return decision == Decision::conforms           ? Level::good
         : decision == Decision::does_not_conform ? Level::failed
                                                  : Level::attention;
}

}  // namespace

std::string undecided_text(const Source& source) {
  std::string all;
  for (const std::string& sentence : pages::undecided(source))
    all += (all.empty() ? "" : " ") + sentence;
  return all;
}

void add_conformity(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  const std::vector<pages::Measured> measured = pages::measured(source.in);
  const std::vector<Shown> all = shown_results(source, measured);
  const std::string undecided = undecided_text(source);
  if (all.empty() && undecided.empty()) return;
  const bool limits =
      std::any_of(all.begin(), all.end(), [](const Shown& s) { return s.limit != nullptr; });
  const bool factors = std::any_of(all.begin(), all.end(), [](const Shown& s) {
    return s.value->U && std::fabs(s.value->k - 2.0) >= 0.005;
  });
  const bool brief = is_brief(source);
  Table table;
  table.columns = {{w.get("conformity.measurement"), "", false},
                   {w.get("results.symbol"), "", false}};
  if (!brief) table.columns.push_back({w.get("results.meaning"), "", false});
  table.columns.push_back({w.get("results.value"), "", true});
  table.columns.push_back(
      {factors ? w.get("results.uncertainty") : pages::U_heading(source, 2.0), "", true});
  if (factors) table.columns.push_back({w.get("results.k"), "", true});
  if (limits) table.columns.push_back({w.get("conformity.limit"), "", true});
  table.columns.push_back({"", "", false});
  if (limits) table.columns.push_back({w.get("results.decision"), "", false});
  for (const Shown& s : all) {
    const Value& v = *s.value;
    const Printed shown =
        printed_result(v.value, v.U, v.quantity, source.language(),
                       s.limit == nullptr ? std::nullopt : std::optional(s.limit->tolerance));
    std::vector<Table::Cell> row = {{s.measured->measurement.id}, {pages::symbol(v.name), true}};
    if (!brief) row.push_back({w.get_or("value." + pages::without_rule(v.name), "")});
    row.push_back({shown.value});
    row.push_back({shown.U});
    if (factors)
      row.push_back({v.U ? printed_number(v.k, Quantity::number, 2, source.language()) : ""});
    if (limits)
      row.push_back(
          {s.limit == nullptr ? "–" : pages::plain_number(source, s.limit->tolerance, v.quantity)});
    row.push_back({unit_text(v.quantity)});
    if (limits && s.limit == nullptr) row.push_back({"–"});
    if (limits && s.limit != nullptr)
      row.push_back({pages::decision_text(source, s.limit->decision),
                     s.limit->decision != Decision::conforms, level_of(s.limit->decision)});
    table.rows.push_back(std::move(row));
  }
  blocks.push_back(
      {Heading{w.get(limits ? "conformity.title" : "conformity.results"), 1}, "conformity.title"});
  blocks.push_back({std::move(table), "conformity"});
  if (const std::string text = brief ? meanings(source, all) : ""; !text.empty())
    blocks.push_back({Paragraph{text, Paragraph::Look::small}, "conformity"});
  if (limits)
    blocks.push_back({Paragraph{pages::rule_text(source) + " " + w.get("conformity.specification"),
                                Paragraph::Look::small},
                      "rule"});
  if (!undecided.empty())
    blocks.push_back({Paragraph{undecided, Paragraph::Look::bold}, "undecided"});
}

}  // namespace nonio::certificate
