// SPDX-License-Identifier: Apache-2.0
#include "campaign/schema/schema.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "campaign/config/keys.h"
#include "campaign/loader/plugins.h"

namespace nonio::schema_test {
namespace {

using Json = nlohmann::json;

/// Two kinds of plugins with one name, one option of each kind, an effect of an axis, one in space
/// and one of the set-up.
loader::Plugins plugins() {
  loader::Plugins all;
  Analysis analysis;
  analysis.info = {"both",
                   "1",
                   "An analysis.",
                   {{"flag", true, "", "A flag."},
                    {"whole", std::int64_t{2}, "", "A whole number.", {"1", "2"}},
                    {"number", 0.5, "mm", "A number.", {}, 0.0, 10.0},
                    {"text", std::string("a"), "", "A text.", {"a", "b"}},
                    {"numbers", std::vector<double>{}, "", "Numbers."},
                    {"texts", std::vector<std::string>{"x"}, "", "Texts."}}};
  all.add(analysis);
  Reader reader;
  reader.info = {"both", "1", "A reader.", {{"only-here", false, "", "A flag."}}};
  all.add(reader);
  Controller controller;
  controller.info = {"table", "1", "A table."};
  all.add(controller);
  Effect effect;
  effect.info = {"lost.motion", "1", "Of an axis"};
  all.add(effect);
  effect.info.name = "set-up";
  effect.is_nuisance = true;
  all.add(effect);
  effect.info.name = "yaw";
  effect.is_nuisance = false;
  effect.instances = [](const Observations&) { return std::vector<std::string>{}; };
  all.add(effect);
  return all;
}

}  // namespace

TEST(Schema, HoldsTheNamesOfWhatIsLoaded) {
  const Json s = Json::parse(schema::campaign_schema(plugins()));
  const Json& p = s["properties"];
  EXPECT_EQ(p["run"]["properties"]["analyses"]["items"]["enum"], Json({"both", "model-fit"}));
  EXPECT_EQ(p["run"]["properties"]["outputs"]["items"]["enum"], Json({"table"}));
  EXPECT_EQ(p["machine"]["properties"]["control"]["enum"], Json({"table", ""}));
  EXPECT_EQ(p["measurement"]["items"]["properties"]["reader"]["enum"], Json({"both", ""}));
  const Json& rule = p["model"]["then"]["allOf"][0];
  EXPECT_EQ(rule["else"]["properties"]["effects"]["items"]["pattern"],
            "^((lost\\.motion):.+|(yaw):[EXYZABC0-9]+)$");
}

TEST(Schema, HoldsTheOptionsOfPlugins) {
  const Json s = Json::parse(schema::file_schema(config::site_file(), plugins()));
  const Json& options = s["properties"]["options"];
  EXPECT_EQ(options["additionalProperties"], false);
  const Json& both = options["properties"]["both"];
  EXPECT_EQ(both["description"], "A reader. An analysis.");
  EXPECT_EQ(both["additionalProperties"], false);
  const Json& o = both["properties"];
  EXPECT_EQ(o.size(), 7U);
  EXPECT_EQ(o["flag"], Json({{"description", "A flag."}, {"type", "boolean"}, {"default", true}}));
  EXPECT_EQ(o["whole"]["enum"], Json({1, 2}));
  EXPECT_EQ(o["number"], Json({{"description", "A number. In mm."},
                               {"type", "number"},
                               {"minimum", 0.0},
                               {"maximum", 10.0},
                               {"default", 0.5}}));
  EXPECT_EQ(o["text"]["enum"], Json({"a", "b"}));
  EXPECT_EQ(o["numbers"]["items"]["type"], "number");
  EXPECT_EQ(o["texts"]["default"], Json({"x"}));
  EXPECT_TRUE(o.contains("only-here"));
}

TEST(Schema, HoldsTheKeysOfMethodsOnlyForTheirKinds) {
  loader::Plugins all;
  Method one{.info = {"one", "1", "A method."}};
  one.info.options = {
      {.name = "load", .default_value = 0.5, .unit = "", .help = "A load.", .min = 0.0},
      {.name = "axis",
       .default_value = std::string(),
       .unit = "",
       .help = "An axis.",
       .required = true,
       .missing = "the axis"}};
  Method two = one;
  two.info.name = "two";
  two.info.options[0].default_value = std::string();
  two.info.options[0].min.reset();
  all.add(one);
  all.add(two);
  const Json s = Json::parse(schema::campaign_schema(all));
  const Json& items = s["properties"]["measurement"]["items"];
  EXPECT_EQ(items["properties"]["kind"]["enum"], Json({"one", "two"}));
  EXPECT_EQ(items["properties"]["axis"]["type"], "string");
  EXPECT_FALSE(items["properties"]["load"].contains("type"));  // a number of one, a text of two
  const std::string rules = items["then"]["allOf"].dump();
  EXPECT_NE(rules.find("only where kind is one"), std::string::npos);
  EXPECT_NE(rules.find("\"required\":[\"axis\"]"), std::string::npos);
}

TEST(Schema, IsGoodWithoutPlugins) {
  for (const std::string& text : {schema::campaign_schema(loader::Plugins()),
                                  schema::file_schema(config::site_file(), loader::Plugins())}) {
    const Json s = Json::parse(text);
    EXPECT_EQ(s["$schema"], "http://json-schema.org/draft-07/schema#");
    EXPECT_EQ(text.find("\"enum\": []"), std::string::npos);
  }
}

}  // namespace nonio::schema_test
