// SPDX-License-Identifier: Apache-2.0
#include "campaign/loader/plugins.h"

#include <gtest/gtest.h>

#include "campaign/loader/offered.h"

namespace nonio::plugins_test {
namespace {

Output output_named(const char* name) {
  Output o;
  o.info = {name, "1", "An output"};
  return o;
}

Controller controller_named(const char* name) {
  Controller c;
  c.info = {name, "1", "A controller"};
  return c;
}

// [run] outputs names both kinds in one list.
TEST(Plugins, AnOutputAndAControllerOfOneNameAreAConflict) {
  loader::Plugins all;
  all.add(controller_named("fanuc"));
  all.add(output_named("fanuc"));
  ASSERT_EQ(all.conflicts().size(), 1U);
  EXPECT_EQ(all.controllers().size(), 1U);
  EXPECT_TRUE(all.outputs().empty());
  Analysis analysis;
  analysis.info = {"fanuc", "1", "An analysis"};
  all.add(analysis);
  EXPECT_EQ(all.conflicts().size(), 1U) << "another kind, another list";
}

TEST(Plugins, AnAbsentOutputIsLookedForAmongControllersToo) {
  loader::Plugins all;
  all.add(output_named("json"));
  all.add(controller_named("fanuc"));
  EXPECT_NE(all.absence("output", "fanuk").find("nearest: \"fanuc\""), std::string::npos);
  EXPECT_NE(all.absence("output", "jsn").find("nearest: \"json\""), std::string::npos);
}

TEST(Plugins, AMethodCannotDeclareAKeyOfEveryMethod) {
  const auto refusal = [](Option key) {
    Method method{.info = {"m", "1", "A method."}};
    method.info.options = {std::move(key)};
    loader::Offered offered;
    offered.add(std::move(method));
    return offered.incomplete();
  };
  EXPECT_EQ(refusal({"gauge", 1.0, "", "A gauge."}), "");
  EXPECT_EQ(refusal({"file", std::string(), "", "A file."}),
            "registers the method m: the key `file` is one that every method has");
  EXPECT_EQ(refusal({"gauge", NumberTables{}, "", "Gauges."}),
            "registers the method m: the key `gauge` has tables; expected one table of numbers");
  Method half{.info = {"m", "1", "A method."}};
  half.observe = [](const MethodInput&) { return Expected<Observations>(Observations{}); };
  loader::Offered offered;
  offered.add(std::move(half));
  EXPECT_EQ(offered.incomplete(),
            "registers the method m without `simulate`, a function that every "
            "method has");
}

TEST(Plugins, TheCatalogueHasEveryKind) {
  loader::Plugins all;
  all.add(output_named("json"));
  all.add(controller_named("fanuc"));
  all.add(Method{.info = {"axis", "1", "A method"}});
  const loader::Plugins described(all.catalogue());
  ASSERT_EQ(described.outputs().size(), 1U);
  ASSERT_EQ(described.controllers().size(), 1U);
  EXPECT_EQ(described.controllers().front().info.name, "fanuc");
  ASSERT_NE(described.method("axis"), nullptr);
  EXPECT_EQ(described.method("axes"), nullptr);
}

}  // namespace
}  // namespace nonio::plugins_test
