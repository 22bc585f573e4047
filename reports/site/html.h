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

struct Page {
  const SiteHistory& site;
  const Templates& templates;
  const Wording& words;
  std::string to_root;                   ///< relative path to index.html: "" or "../"
  std::shared_ptr<const Fonts> fonts{};  ///< for text widths in charts
};

/// Escaped text whose dates do not wrap.
Html with_whole_days(std::string_view text);
/// Like with_whole_days, for HTML.
std::string whole_days(const std::string& html);

View page_view(const Page&, const std::string& title, std::string next_to_navigation = {});
/// The template is templates/pages/site/`name`.html.
Expected<std::string> written(const Page&, const std::string& name, const View&);

/// Link relative to the current page; empty if there is no link.
inline std::string from_root(const Page& page, const std::string& link) {
  return link.empty() ? link : page.to_root + link;
}

/// "−4.2 ± 0.4 µm", U = 2 u; without u the number and its unit.
std::string value_text(const Page&, double value, std::optional<double> u, Quantity,
                       std::optional<double> limit = {});
/// "6 months. Why.", or the reason for no proposal; empty if not required.
std::string proposal_text(const Page&, const IntervalProposal&);
/// "every 6 months"; empty without months.
std::string interval_text(const Page&, const std::string& months);
FollowedNumbers numbers_of(const Page&, const ModelComparison&);
/// A scatter is a logarithm, so its value is not printed; its sentence states the factor.
bool shows_value(const WorkItem&);
/// A text of a line ("says", "advice") with kinds of events in words; not yet typeset.
std::string line_text(const Page&, const WorkItem&, const char* part);
/// "Also out: A 15.5 ± 1.9 µm (limit 5)."; empty for one value only.
std::string also_text(const Page&, const WorkItem&);
/// ", limit 12.0"; empty without a limit or if the line's sentence states it.
std::string limit_text(const Page&, const WorkItem&);
/// "Since 2026-01-24."; empty if the line's sentence has the date.
std::string since_text(const Page&, const WorkItem&);
/// Symbol of a quantity if it has no text.
std::string quantity_text(const Page&, const std::string& quantity);
/// Name of the quantity of a line, with its state if the line has values of several states.
std::string quantity_text(const Page&, const WorkItem&);
/// Three significant digits in the printed unit, without the unit.
std::string short_number(const Page&, double value, Quantity);

using Day = std::chrono::sys_days;
/// nullopt unless the text is "YYYY-MM-DD".
std::optional<Day> day_of(std::string_view date);
/// "Mar 2026"
std::string month_text(const Page&, std::string_view month);

const char* name_of(WorkItem::Kind);

}  // namespace nonio::reports::site
