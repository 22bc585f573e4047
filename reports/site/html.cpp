// SPDX-License-Identifier: Apache-2.0
#include "html.h"

#include <algorithm>
#include <charconv>

#include "embedded.h"
#include "nonio/reports/number.h"
#include "nonio/reports/quantity_words.h"
#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/text.h"

namespace nonio::reports::site {

namespace {

std::optional<unsigned> number_of(std::string_view digits) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

}  // namespace

Html with_whole_days(std::string_view text) { return {whole_days(html_of(text).text)}; }

std::string whole_days(const std::string& html) {
  constexpr std::size_t length = 10;
  std::string out;
  std::size_t done = 0;
  for (std::size_t at = 0; at + length <= html.size(); ++at) {
    if (html[at + 4] != '-' || !day_of(std::string_view(html).substr(at, length))) continue;
    out +=
        html.substr(done, at - done) + "<span class=\"day\">" + html.substr(at, length) + "</span>";
    done = at + length;
    at = done - 1;
  }
  return out + html.substr(done);
}

View page_view(const Page& page, const std::string& title, std::string next_to_navigation) {
  View view;
  view.set("language", page.words.language()).set("title", title).set("program", "Nonio");
  view.set("root", page.to_root).set("next_to_navigation", std::move(next_to_navigation));
  // Because of strict-dynamic this script, and no markup, may load charts.js.
  view.set("script_source", Html{std::string(script_source) + "' 'strict-dynamic"});
  view.set("style_source", std::string(style_source));
  view.set("script", Html{std::string(page_script)}).set("style", Html{std::string(page_style)});
  return view;
}

Expected<std::string> written(const Page& page, const std::string& name, const View& view) {
  return page_text("site/" + name, view, page.words);
}

std::string value_text(const Page& page, double value, std::optional<double> u, Quantity q,
                       std::optional<double> limit) {
  const Printed shown = printed_result(value, u ? std::optional(2.0 * *u) : std::nullopt, q,
                                       page.words.language(), limit);
  std::string out = shown.value;
  if (!shown.U.empty()) out += " ± " + shown.U;
  const std::string unit = unit_text(q);
  return unit.empty() ? out : out + " " + unit;
}

std::string short_number(const Page& page, double value, Quantity q) {
  std::string out = localised(short_text(value * unit_of(q).per_si), page.words.language());
  if (out.starts_with('-')) out.replace(0, 1, "\u2212");
  return out;
}

/// The limit as it was stated.
std::string limit_number(const Page& page, double limit, Quantity q) {
  constexpr int most = 6;
  return printed_number(limit, q, decimals_for({limit}, q, most), page.words.language());
}

std::string interval_text(const Page& page, const std::string& months) {
  return months.empty() ? "" : page.words.get("site.every_months", {{"count", months}});
}

std::string proposal_text(const Page& page, const IntervalProposal& proposal) {
  if (proposal.method.empty()) return {};
  const std::string why =
      typeset(finding_text(page.templates, page.words.language(), proposal.why, "says"));
  if (!proposal.months) return why;
  const std::string months =
      *proposal.months == 1
          ? page.words.get("site.one_month")
          : page.words.get("site.months_count", {{"count", std::to_string(*proposal.months)}});
  return months + ". " + why;
}

bool shows_value(const WorkItem& l) { return l.value && !is_log_of_scatter(l.quantity); }

FollowedNumbers numbers_of(const Page& page, const ModelComparison& c) {
  return {c.quantity, c.unit, c.travel && c.travel->rotary, page.words};
}

std::string line_text(const Page& page, const WorkItem& l, const char* part) {
  return reports::line_text(page.templates, page.words.language(), l, part);
}

namespace {

/// The quantity, with the state of the machine if the values of the line are of several states.
std::string quantity_of(const Page& page, const WorkItem& l, const std::string& quantity,
                        std::string state) {
  const bool mixed = std::any_of(l.also.begin(), l.also.end(), [&](const OpenValue& v) {
    return v.value && v.state != l.of_state;
  });
  std::string name = quantity_text(page, quantity);
  if (!mixed || state.empty()) return name;
  std::replace(state.begin(), state.end(), '-', '_');
  return name + " (" + page.words.get("site.state." + state) + ")";
}

}  // namespace

std::string quantity_text(const Page& page, const WorkItem& l) {
  return l.quantity.empty() ? "" : quantity_of(page, l, l.quantity, l.of_state);
}

std::string also_text(const Page& page, const WorkItem& l) {
  std::string out;
  for (const bool undecided : {false, true}) {
    std::string values;
    for (const OpenValue& v : l.also) {
      if (v.undecided != undecided) continue;
      std::string name = quantity_of(page, l, v.quantity, v.state);
      if (v.axis.empty() && !v.measurement.empty()) name = v.measurement + " " + name;
      const std::string limit =
          page.words.get("site.limit", {{"limit", limit_number(page, v.limit, v.unit)}});
      values += (values.empty() ? "" : "; ") + name + " " +
                (v.value ? value_text(page, *v.value, v.u, v.unit, v.limit)
                         : page.words.get("site.no_value")) +
                " (" + limit + ")";
    }
    if (!values.empty())
      out +=
          (out.empty() ? "" : " ") +
          page.words.get(undecided ? "site.also_undecided" : "site.also_out", {{"values", values}});
  }
  return out;
}

std::string limit_text(const Page& page, const WorkItem& l) {
  const bool in_sentence = std::any_of(l.finding.evidence.begin(), l.finding.evidence.end(),
                                       [](const Number& e) { return e.name == "limit"; });
  if (!l.limit || in_sentence) return {};
  return ", " + page.words.get("site.limit", {{"limit", limit_number(page, *l.limit, l.unit)}});
}

std::string since_text(const Page& page, const WorkItem& l) {
  if (l.since.empty() || l.kind == WorkItem::Kind::overdue) return {};
  return page.words.get("site.since", {{"date", l.since}});
}

std::string quantity_text(const Page& page, const std::string& quantity) {
  return followed_quantity(page.words, quantity);
}

std::optional<Day> day_of(std::string_view date) {
  if (date.size() != 10 || date[4] != '-' || date[7] != '-') return std::nullopt;
  const auto y = number_of(date.substr(0, 4)), m = number_of(date.substr(5, 2)),
             d = number_of(date.substr(8, 2));
  if (!y || !m || !d) return std::nullopt;
  const std::chrono::year_month_day day{std::chrono::year(static_cast<int>(*y)),
                                        std::chrono::month(*m), std::chrono::day(*d)};
  if (!day.ok()) return std::nullopt;
  return Day(day);
}

std::string month_text(const Page& page, std::string_view month) {
  if (month.size() < 7) return std::string(month);
  return page.words.get("site.month." + std::string(month.substr(5, 2))) + " " +
         std::string(month.substr(0, 4));
}

const char* name_of(WorkItem::Kind kind) {
  constexpr const char* names[] = {"lost",    "failed",   "out",       "changed",    "soon",
                                   "overdue", "withheld", "undecided", "information"};
  return names[static_cast<std::size_t>(kind)];
}

}  // namespace nonio::reports::site

namespace nonio::reports {

namespace {

constexpr std::size_t most_named = 12;  // campaigns named in a line; JSON has all

std::string titles(const Templates& templates, std::string_view language, const std::string& ids,
                   const std::string& axis) {
  std::string out;
  for (std::size_t at = 0; at < ids.size();) {
    const std::size_t end = std::min(ids.find(", ", at), ids.size());
    Finding one;
    one.id = ids.substr(at, end - at);
    one.texts = {{"axis", axis}};
    out += (out.empty() ? "" : "; ") + finding_text(templates, language, one, "title");
    at = end + 2;
  }
  return out;
}

}  // namespace

std::string line_text(const Templates& templates, std::string_view language, const WorkItem& l,
                      std::string_view part) {
  Finding finding = l.finding;
  for (auto& [name, text] : finding.texts) {
    if (name == "withheld") text = titles(templates, language, text, l.axis);
    if (name == "event")
      text = event_text(Wording(templates, std::string(language), {"site"}), text);
  }
  if (!l.campaigns.empty()) {
    std::string names;
    for (std::size_t i = 0; i < std::min(l.campaigns.size(), most_named); ++i)
      names += (i == 0 ? "" : ", ") + l.campaigns[i];
    if (l.campaigns.size() > most_named) names += ", ...";
    finding.texts.emplace_back("campaigns", names);
  }
  for (const auto& [number, key] : {std::pair{"size", "site.size"}, {"factor", "site.factor"}})
    if (std::any_of(finding.evidence.begin(), finding.evidence.end(),
                    [wanted = number](const Number& n) { return n.name == wanted; }))
      finding.texts.emplace_back("change",
                                 filled(words(templates, language, key), finding, language));
  return finding_text(templates, language, finding, part);
}

}  // namespace nonio::reports
