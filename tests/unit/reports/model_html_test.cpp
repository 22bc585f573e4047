// SPDX-License-Identifier: Apache-2.0
#include <regex>

#include "content_policy.h"
#include "fixtures.h"
#include "model_fixture.h"

namespace nonio::fixtures::model_html_test {
namespace {

struct ModelHtml : testing::Test {
  Plugins plugins;
  Templates templates = read_templates(NONIO_TEMPLATES);
  Case made = simple_case();

  void SetUp() override { ASSERT_TRUE(plugins.load(NONIO_PLUGINS, "model-html")); }
  std::vector<Artifact> write(const std::string& language = "en") {
    Settings options = defaults(plugins.outputs.front().info);
    options.values["language"] = language;
    const auto result = plugins.outputs.front().write(
        {made.campaign, made.observations, made.results, options, templates});
    EXPECT_TRUE(result) << result.error().message;
    return result ? result->artifacts : std::vector<Artifact>{};
  }
  std::string page(const ModelFit& fit, const std::string& language = "en") {
    made.results.models = {fit};
    const auto artifacts = write(language);
    return artifacts.size() == 1 ? artifacts.front().bytes : "";
  }
};

std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++n;
  return n;
}
bool has(const std::string& text, const std::string& what) { return occurrences(text, what) > 0; }

MadeModel bare() { return {false, false, false, false, false, 11, 1, false}; }

TEST_F(ModelHtml, OneFileForEachPart) {
  made.results.models = {made_model(), made_model({.rotary = true})};
  const auto artifacts = write();
  ASSERT_EQ(artifacts.size(), 2U);
  EXPECT_EQ(artifacts[0].name, "model-X.html");
  EXPECT_EQ(artifacts[1].name, "model-C.html");
  made.results.models.clear();
  EXPECT_TRUE(write().empty());
}

TEST_F(ModelHtml, AlwaysTenFramesAndThoseWithoutDataSayWhy) {
  for (const char* language : {"de", "en", "it"})
    for (const MadeModel& data : {MadeModel{}, bare(), MadeModel{.rotary = true}})
      EXPECT_EQ(occurrences(page(made_model(data), language), "<figure "), 10U) << language;
  const std::string text = page(made_model(bare()));
  for (const char* why : {"Measured from one direction only.", "No times.", "No temperature.",
                          "Screw pitch not stated.", "A single run: none can be left out."})
    EXPECT_TRUE(has(text, std::string("<p class=\"none\">") + why)) << why;
}

TEST_F(ModelHtml, HostileTextStaysText) {
  const std::string hostile = "</script><script>alert(1)</script><img src=x onerror='a\"&";
  made.campaign.id = made.campaign.customer = made.campaign.machine.model = hostile;
  ModelFit fit = made_model();
  fit.part = "../" + hostile;
  fit.axis = fit.measurements[0] = hostile;
  fit.effects[0].name = fit.parameters[0].effect = fit.parameters[1].name = hostile;
  fit.steps[1].effect = hostile;
  fit.diagnosis[0].id = fit.diagnosis[0].advice = hostile;
  Measurement m;
  m.id = m.file = hostile;
  made.campaign.measurements = {m};
  const std::string text = page(fit);
  ASSERT_FALSE(text.empty());
  EXPECT_EQ(occurrences(text, "<script"), 2U) << "the data and the page's own";
  EXPECT_EQ(occurrences(text, "</script"), 2U);
  EXPECT_FALSE(has(text, "<img"));
  const std::string name = write().front().name;
  EXPECT_EQ(name.find_first_of("/<>'\"& "), std::string::npos) << name;
}

TEST_F(ModelHtml, NeedsNothingFromOutside) {
  const std::string text = page(made_model());
  EXPECT_TRUE(has(text, "default-src 'none'; script-src 'sha256-"));
  EXPECT_EQ(refused_by_policy(text), std::vector<std::string>{});
  EXPECT_FALSE(has(text, "unsafe-inline"));
  EXPECT_FALSE(has(text, "https:"));
  EXPECT_EQ(occurrences(text, "url("), occurrences(text, "url(#")) << "only parts of the page";
  EXPECT_FALSE(has(text, "@import"));
  EXPECT_FALSE(std::regex_search(text, std::regex("<(link|iframe|img|object|embed)")));
  EXPECT_FALSE(std::regex_search(text, std::regex("[ \n](src|href|style|on[a-z]+)=\"")))
      << "nothing is fetched, and no handler or style stands in an attribute";
  EXPECT_EQ(occurrences(text, "http:"), 1U) << "the name of SVG";
}

TEST_F(ModelHtml, NamesNoCommand) {
  for (const char* language : {"en", "de", "it"})
    EXPECT_FALSE(has(page(made_model(), language), "nonio model")) << language;
}

TEST_F(ModelHtml, CandidatesCardsSizesAndWhatToMeasureAreOnIt) {
  const std::string text = page(with_candidates(made_model()));
  for (const char* what :
       {"scale:X <b>significant</b>", "0.150 \u00b5m", "<summary>scale:X</summary>",
        ("No sign of: warm-up:X (would be detected from 1.10 \u00b5m); "
         "temperature:X (0.250 \u00b5m)."),
        "<li>Record the material temperature"})
    EXPECT_TRUE(has(text, what)) << what;
  EXPECT_TRUE(has(page(made_model()), "There is no evidence for any further effect."));
  EXPECT_TRUE(has(page(with_candidates(made_model()), "it"), "Nessun indizio di: warm-up:X"));
}

TEST_F(ModelHtml, HoldsTheFitWithoutAnEffectAndNoneWhereThereIsNone) {
  const std::string text = page(made_model());
  EXPECT_EQ(occurrences(text, "\"without\":{"), 1U);
  EXPECT_EQ(occurrences(text, "\"without\":null"), 2U);
  for (const char* member : {"rms", "cv_rms", "floor", "left_out", "weight", "suspects"})
    EXPECT_EQ(occurrences(text, std::string("\"") + member + "\":"), 2U) << member;
}

TEST_F(ModelHtml, TheSameBytesTwice) {
  EXPECT_EQ(page(made_model()), page(made_model()));
  EXPECT_NE(page(made_model()), page(made_model(), "it"));
  EXPECT_TRUE(has(page(made_model(), "it"), "<html lang=\"it\">"));
  for (const char* language : {"de", "it"})
    EXPECT_TRUE(has(page(made_model(), language), "\"comma\":true")) << language;
  EXPECT_TRUE(has(page(made_model()), "\"comma\":false"));
}

TEST_F(ModelHtml, ManyReadingsAreThinnedWithAWordAndTheLargestStays) {
  MadeModel many;
  many.targets = 2001;
  many.runs = 10;
  many.suspects = false;
  ModelFit fit = made_model(many);
  fit.residual[4321] = 40.125e-6;
  const std::string text = page(fit);
  EXPECT_TRUE(has(text, "of 40020 readings: a sample"));
  EXPECT_TRUE(has(text, "40.125"));
  EXPECT_LT(text.size(), 3000000U);
  EXPECT_FALSE(has(page(made_model()), "The page contains"));
}

TEST_F(ModelHtml, NumbersThatAreNoneAreNoneOnThePage) {
  ModelFit fit = made_model();
  fit.temperature[3] = fit.time[5] = fit.cv_residual[7] = std::nan("");
  const std::string text = page(fit);
  const std::string data = text.substr(text.find("id=\"data\""));
  EXPECT_EQ(occurrences(data, ",null"), 3U);
  EXPECT_FALSE(has(data, ",nan"));
}

}  // namespace
}  // namespace nonio::fixtures::model_html_test
