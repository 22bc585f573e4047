// SPDX-License-Identifier: Apache-2.0
// Pages of a laboratory: complete in each language, the numbers that they were given, nothing that
// runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "content_policy.h"
#include "fixtures.h"
#include "nonio/sdk/text.h"
#include "site_fixture.h"

namespace nonio::fixtures::site_pages_test {
namespace {

const Templates& templates() {
  static const Templates all = read_templates(NONIO_TEMPLATES);
  return all;
}

std::map<std::string, std::string> pages_of(const SiteHistory& site,
                                            const std::string& language = "en") {
  std::map<std::string, std::string> out;
  const auto pages = site_pages(site, templates(), language);
  if (!pages) ADD_FAILURE() << pages.error().message;
  if (pages)
    for (const Artifact& a : *pages) out[a.name] = a.bytes;
  return out;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(SitePages, AreCompleteInEachLanguage) {
  for (const char* language : {"en", "it", "de"}) {
    const auto pages = pages_of(made_site(), language);
    EXPECT_EQ(pages.size(), 9U) << language;
    for (const auto& [name, bytes] : pages) {
      EXPECT_FALSE(has(bytes, "finding.")) << name;
      EXPECT_TRUE(is_utf8(bytes)) << name;
    }
  }
}

TEST(SitePages, TheSameValuesAreTheSameBytes) {
  EXPECT_EQ(pages_of(made_site()), pages_of(made_site()));
}

TEST(SitePages, NumbersAreThoseOfTheValues) {
  const auto pages = pages_of(made_site());
  const std::string& index = pages.at("index.html");
  EXPECT_TRUE(has(index, "11.20 ± 0.40 µm"));
  EXPECT_TRUE(has(index, "tolerance limit of 8.00 µm"));
  EXPECT_TRUE(has(index, "Known to B. Sample until 2026-06-01: repair ordered"));
  const std::string& machine = pages.at("machines/S-0042.html");
  EXPECT_TRUE(has(machine,
                  "Changed by −4.20 ± 0.40 µm between <span class=\"day\">2024-07-14</span> and "
                  "<span class=\"day\">2025-01-14</span>"));
  EXPECT_TRUE(has(machine, "−9.60 ± 0.80 µm expected, 98.0 % beyond the limit"));
  EXPECT_TRUE(has(machine, "Detection limit: 1.30 µm"));
}

TEST(SitePages, AScatterIsPrintedAsAScatterAndItsChangeAsAFactor) {
  // 0.48 um and its double, each times or divided by e^0.3 (k = 2): 1.35.
  SiteHistory site = made_site();
  HistorySeries s{
      .axis = "X", .quantity = "ln_s", .unit = Quantity::number, .points = {}, .model = "step"};
  for (int i = 0; i < 4; ++i)
    s.points.push_back({"2023-" + std::to_string(i), day(2023 + i, 1, 14), "",
                        HistoryPoint::State::as_found, std::log(i < 2 ? 0.48 : 0.96), 0.15});
  s.changes = {{"2024-01-14", "2025-01-14", std::log(2.0), 0.15, 1e-6, "undeclared"}};
  site.machines.front().series.push_back(s);
  const std::string page = pages_of(site).at("machines/" + site.machines.front().file);
  EXPECT_TRUE(has(page, "X · Scatter of the readings"));
  EXPECT_TRUE(has(page, "0.480 (0.356 to 0.648) µm"));
  EXPECT_TRUE(has(page, "a factor of 2.00 (1.48 to 2.70)")) << page;
  EXPECT_FALSE(has(page, "ln(s)"));
}

TEST(SitePages, ADecimalCommaWhereTheLanguageHasOne) {
  EXPECT_TRUE(has(pages_of(made_site(), "de").at("index.html"), "11,20 ± 0,40 µm"));
}

TEST(SitePages, NamesRunNoScriptAndLeaveNoFolder) {
  SiteHistory site = made_site();
  const std::string evil = "\"><script>alert(1)</script>";
  site.machines.back().customer = evil;
  site.lines.back().why = evil;
  site.lines.back().customer = evil;
  site.instruments.front().name = evil;
  site.machines.back().events.front().text = evil;
  site.comparisons.front().machines.front().machine = evil;
  for (const auto& [name, bytes] : pages_of(site))
    EXPECT_TRUE(name == "due.ics" || !has(bytes, "<script>alert")) << name;
}

TEST(SitePages, AChartShowsCharactersThatTheFontsLack) {
  SiteHistory site = made_site();
  site.comparisons.front().machines.front().machine = "\u05D0-7 <b>\x01";
  const auto pages = pages_of(site);
  EXPECT_TRUE(has(pages.at("compare.html"), ">\u05D0-7 &lt;b&gt;\uFFFD</text>"));
}

TEST(SitePages, ChartsNeedNoFonts) {
  Templates words_only = templates();
  words_only.files.clear();
  const auto pages = site_pages(made_site(), words_only, "en");
  ASSERT_TRUE(pages) << pages.error().message;
  for (const Artifact& page : *pages)
    if (page.name == "compare.html") EXPECT_TRUE(has(page.bytes, ">S-0042</text>"));
}

TEST(SitePages, PointsOfAChartLeadToTheirReports) {
  const auto pages = pages_of(made_site());
  const std::string& page = pages.at("machines/S-0042.html");
  EXPECT_TRUE(has(page, "<a href=\"../c5/report.pdf\"><title>2025-07-14 2023-5: −9.30 ± 0.40 µm"));
  EXPECT_TRUE(has(page, "<title>2024-10-02 Collision with the vice</title>"));
  EXPECT_TRUE(has(page, "<title>2024-01-14 2023-2: −5.30 ± 0.40 µm ("));
}

TEST(SitePages, NothingIsFetchedFromAnywhere) {
  for (const auto& [name, bytes] : pages_of(made_site())) {
    // The name of the elements of SVG, which nothing fetches.
    std::string own = bytes;
    if (const auto at = own.find("http://www.w3.org/2000/svg"); at != std::string::npos)
      own.erase(at, std::string_view("http:").size());
    EXPECT_FALSE(has(own, "http://") || has(own, "https://") || has(own, " src=")) << name;
    EXPECT_EQ(has(bytes, "default-src 'none'"), name.ends_with(".html")) << name;
  }
}

TEST(SitePages, ABrowserUsesTheirStyleAndScript) {
  for (const auto& [name, bytes] : pages_of(made_site())) {
    if (!name.ends_with(".html")) continue;
    EXPECT_TRUE(has(bytes, "<style>")) << name;
    EXPECT_EQ(refused_by_policy(bytes), std::vector<std::string>{}) << name;
  }
}

TEST(SitePages, AQuietRunIsOneSentence) {
  SiteHistory site = made_site();
  site.lines.clear();
  EXPECT_TRUE(has(pages_of(site).at("index.html"), "No action required."));
  site.judged = false;
  EXPECT_TRUE(
      has(pages_of(site).at("index.html"), "Nothing was assessed: no campaign states a limit."));
}

TEST(SitePages, ALargeSiteIsOnePageThatSaysWhatItLeavesOut) {
  SiteHistory site = made_site();
  const WorkItem one = site.lines[2];
  site.lines.clear();
  site.months.clear();
  for (int i = 0; i < 5000; ++i) {
    const std::string id = "S-" + std::to_string(10000 + i);
    site.lines.push_back(one);
    site.lines.back().machine = id;
    site.lines.back().customer = "Customer " + std::to_string(i);
    for (int k = 0; k < 60; ++k)
      site.months.push_back(
          {id,
           std::to_string(2022 + k / 12) + (k % 12 < 9 ? "-0" : "-") + std::to_string(1 + k % 12),
           k % 2 == 0 ? std::optional(WorkItem::Kind::out) : std::nullopt, k % 2 == 0, false});
  }
  const std::string page = pages_of(site).at("index.html");
  EXPECT_LT(page.size(), 300000U);
  EXPECT_TRUE(has(page, "And 4800 lines more"));
  EXPECT_TRUE(has(page, "And 4940 machines more"));
}

TEST(SitePages, AQuantityWithinAnotherIsSaidInWords) {
  SiteHistory site = made_site();
  site.lines[2].quantity = "straightness:Z.curve_2";
  site.lines[3].quantity = "squareness:XY.c";
  const std::string page = pages_of(site).at("index.html");
  EXPECT_TRUE(has(page, "Straightness Z, bow"));
  EXPECT_TRUE(has(page, "Squareness XY "));
  EXPECT_FALSE(has(page, "curve_2") || has(page, "XY.c"));
}

TEST(SitePages, NoDayBreaksAtItsDashes) {
  EXPECT_TRUE(has(pages_of(made_site()).at("index.html"),
                  "between <span class=\"day\">2024-07-14</span> and"));
}

TEST(SitePages, AnEmptySiteHasItsPages) {
  const SiteHistory none{};
  EXPECT_EQ(pages_of(none).size(), 6U);
}

TEST(SitePages, TheCalendarHasADayForEachMachine) {
  const std::string calendar = pages_of(made_site()).at("due.ics");
  EXPECT_TRUE(calendar.starts_with("BEGIN:VCALENDAR\r\n"));
  EXPECT_TRUE(has(calendar, "DTSTART;VALUE=DATE:20260114\r\n"));
  EXPECT_TRUE(has(calendar, "LOCATION:Rossi & Figli <S.p.A.>\\, Padova\r\n"));
  for (std::size_t at = 0; at < calendar.size();) {
    const std::size_t end = calendar.find("\r\n", at);
    ASSERT_NE(end, std::string::npos);
    EXPECT_LE(end - at, 75U);
    at = end + 2;
  }
}

TEST(SitePages, AValueThatIsNoNumberDrawsNothingWrong) {
  SiteHistory site = made_site();
  site.machines.back().series.front().points.front().value = NAN;
  site.machines.back().series.front().points.front().date = "soon";
  for (const auto& [name, bytes] : pages_of(site)) {
    EXPECT_FALSE(has(bytes, "\"nan")) << name;
    EXPECT_FALSE(has(bytes, "\"inf")) << name;
  }
}

}  // namespace
}  // namespace nonio::fixtures::site_pages_test
