// SPDX-License-Identifier: Apache-2.0
// The language of templates/pages: text is escaped, and a mistake names its file and line.
#include "nonio/reports/page.h"

#include <gtest/gtest.h>

namespace nonio::fixtures::page_test {
namespace {

using namespace reports;

Expected<std::string> written(const std::string& page, const View& view) {
  Templates templates;
  templates.tables["words/en/site"].values["site.due"] = std::string("Due & paid");
  return page_text("page", view, Wording(templates, "en", {"site"}),
                   {{"page", page}, {"part", "[{{name}}]"}});
}

TEST(Page, TextIsEscapedAndMarkupIsNot) {
  View view;
  view.set("name", "\"><script>&'").set("drawn", Html{"<b>x</b>"});
  EXPECT_EQ(written("<a title=\"{{name}}\">{{drawn}}</a>", view).value(),
            "<a title=\"&quot;&gt;&lt;script&gt;&amp;&#39;\"><b>x</b></a>");
}

TEST(Page, AValueIsNoTemplate) {
  View view;
  view.set("name", "{{other}}").set("other", "secret");
  EXPECT_EQ(written("{{name}}", view).value(), "{{other}}");
}

TEST(Page, ListsRepeatAndSeeWhatIsAroundThem) {
  View view;
  view.set("name", "outside");
  for (const char* machine : {"a", "b"}) {
    View& row = view.add("row");
    row.set("machine", machine);
    for (const char* axis : {"X", "Y"}) row.add("axis").set("axis", axis);
  }
  EXPECT_EQ(
      written("{{#row}}{{machine}}:{{#axis}}{{axis}}{{/axis}} {{name}};{{/row}}", view).value(),
      "a:XY outside;b:XY outside;");
}

TEST(Page, PartsAreForValuesThatAreNotEmpty) {
  View view;
  view.set("name", "n").set("empty", "").flag("off", false);
  EXPECT_EQ(written("{{#name}}1{{/name}}{{#empty}}2{{/empty}}{{^empty}}3{{/empty}}{{^off}}4{{/off}}"
                    "{{#list}}{{unknown}}{{/list}}{{^list}}5{{/list}}",
                    view)
                .value(),
            "1345");
}

TEST(Page, OtherFilesAndWordsArePutIn) {
  View view;
  view.set("name", "<");
  EXPECT_EQ(written("{{>part}} {{words.site.due}}", view).value(), "[&lt;] Due &amp; paid");
}

TEST(Page, AMistakeNamesItsFileAndLine) {
  View view;
  view.set("name", "n");
  for (const char* page : {"\n{{nmae}}", "\n{{#name}}", "\n{{/name}}", "\n{{name", "\n{{>none}}",
                           "\n{{#name}}{{/nmae}}"}) {
    const auto text = written(page, view);
    ASSERT_FALSE(text) << page;
    EXPECT_TRUE(text.error().file == "templates/pages/page.html" ||
                text.error().file == "templates/pages/none.html")
        << page;
    EXPECT_TRUE(text.error().line == 2 || text.error().file == "templates/pages/none.html") << page;
  }
  const auto endless = written("{{>page}}", view);
  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error().message, "the page contains itself");
}

}  // namespace
}  // namespace nonio::fixtures::page_test
