// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "nonio/reports/font.h"
#include "nonio/reports/page.h"
#include "nonio/reports/site.h"
#include "nonio/reports/wording.h"

namespace nonio::reports::site {

/// What every page needs.
struct Page {
  const SiteHistory& site;
  const Templates& templates;
  const Wording& words;
  std::string to_root;                   ///< "" or "../"
  std::shared_ptr<const Fonts> fonts{};  ///< that charts are measured with
};

/// Text in which no day breaks at its dashes.
Html with_whole_days(std::string_view text);
/// The same of text that is HTML already.
std::string whole_days(const std::string& html);

/// What the head of every page shows.
View page_view(const Page&, const std::string& title, std::string next_to_navigation = {});
/// The page templates/pages/site/`name`.html.
Expected<std::string> written(const Page&, const std::string& name, const View&);

/// Relative to the page that is written; empty if there is none.
inline std::string from_root(const Page& page, const std::string& link) {
  return link.empty() ? link : page.to_root + link;
}

/// "−4.2 ± 0.4 µm", U = 2 u; without u the number and its unit.
std::string value_text(const Page&, double value, std::optional<double> u, Quantity);
/// "6 months. Why.", or why there is none; empty where none is required.
std::string proposal_text(const Page&, const IntervalProposal&);
/// "every 6 months"; empty without months.
std::string interval_text(const Page&, const std::string& months);
/// How the values of a comparison of machines are printed.
FollowedNumbers numbers_of(const Page&, const ModelComparison&);
/// Whether the value of a line is printed: that of a scatter is a logarithm, and its sentence states
/// the factor.
bool shows_value(const WorkItem&);
/// What a line states or advises ("says", "advice"), with kinds of events in words; not yet typeset.
std::string line_text(const Page&, const WorkItem&, const char* part);
/// "Also out: A 15.5 ± 1.9 µm (limit 5)."; empty where the line has one value.
std::string also_text(const Page&, const WorkItem&);
/// ", limit 12.0"; empty without a limit, or if the line's sentence states it.
std::string limit_text(const Page&, const WorkItem&);
/// "Since 2026-01-24."; nothing where what it states has the day already.
std::string since_text(const Page&, const WorkItem&);
/// Name of a quantity in words, with its symbol where it has none.
std::string quantity_text(const Page&, const std::string& quantity);
/// A number with three significant digits, in its printed unit, without the unit.
std::string short_number(const Page&, double value, Quantity);

using Day = std::chrono::sys_days;
/// None if it is not "YYYY-MM-DD".
std::optional<Day> day_of(std::string_view date);
/// A month as its name and year: "Mar 2026".
std::string month_text(const Page&, std::string_view month);

const char* name_of(WorkItem::Kind);

}  // namespace nonio::reports::site
