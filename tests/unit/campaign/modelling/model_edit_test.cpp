// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_edit.h"

#include <gtest/gtest.h>

#include "campaign/modelling/model_history.h"

namespace nonio::model_edit_test {
namespace {

std::string added(const std::string& text, const std::string& effect = "backlash:X") {
  const auto out = modelling::with_effect(text, effect);
  return out ? *out : "refused: " + out.error().message;
}
std::string dropped(const std::string& text, const std::string& effect) {
  const auto out = modelling::without_effect(text, effect);
  return out ? *out : "refused: " + out.error().message;
}

TEST(ModelEdit, AnEffectIsAddedToAListOnOneLine) {
  EXPECT_EQ(added("[model]\neffects = [\"a:X\"]\n"),
            "[model]\neffects = [\"a:X\", \"backlash:X\"]\n");
  EXPECT_EQ(added("[model]\neffects = [ 'a:X' , ] # why\n"),
            "[model]\neffects = [ 'a:X' , \"backlash:X\", ] # why\n");
  EXPECT_EQ(added("[model]\neffects = []"), "[model]\neffects = [\"backlash:X\"]");
}

TEST(ModelEdit, ManyLinesKeepTheirStyle) {
  EXPECT_EQ(added("[model]\neffects = [\n  \"a:X\", # first\n  \"b:X\" # second, not [last]\n]\n"),
            "[model]\neffects = [\n  \"a:X\", # first\n  \"b:X\", # second, not [last]\n"
            "  \"backlash:X\"\n]\n");
  EXPECT_EQ(added("[model]\neffects = [\n\t\"a:X\",\n]\n"),
            "[model]\neffects = [\n\t\"a:X\",\n\t\"backlash:X\",\n]\n");
  EXPECT_EQ(added("[model]\neffects = [\"a:X\",\n           \"b:X\"]\n"),
            "[model]\neffects = [\"a:X\",\n           \"b:X\",\n           \"backlash:X\"]\n");
  EXPECT_EQ(added("[model]\neffects = [\n  # none yet\n]\n"),
            "[model]\neffects = [\"backlash:X\"\n  # none yet\n]\n");
}

TEST(ModelEdit, CommentsAndTextsThatLookLikeLists) {
  const std::string before =
      "# effects = [\"no:X\"]\ntitle = \"[model] effects = ['no']\"\n[model] # the model\n"
      "effects = [\"a:X\"] # ], \"c:X\"\n[other]\neffects = [\"d:X\"]\n";
  EXPECT_EQ(added(before),
            "# effects = [\"no:X\"]\ntitle = \"[model] effects = ['no']\"\n[model] # the model\n"
            "effects = [\"a:X\", \"backlash:X\"] # ], \"c:X\"\n[other]\neffects = [\"d:X\"]\n");
}

TEST(ModelEdit, LineEndsAndByteOrderMarkStay) {
  EXPECT_EQ(added("\xEF\xBB\xBF[model]\r\neffects = [\r\n  \"a:X\"\r\n]\r\n"),
            "\xEF\xBB\xBF[model]\r\neffects = [\r\n  \"a:X\",\r\n  \"backlash:X\"\r\n]\r\n");
  EXPECT_EQ(added("\xEF\xBB\xBFmodel.effects = [\"a:X\"]"),
            "\xEF\xBB\xBFmodel.effects = [\"a:X\", \"backlash:X\"]");
  EXPECT_EQ(added("format = 1\r\n"), "format = 1\r\n\r\n[model]\r\neffects = [\"backlash:X\"]\r\n");
}

TEST(ModelEdit, LettersOutsideAsciiBeforeTheList) {
  EXPECT_EQ(added("model = { note = \"più µm\", effects = [\"a:X\"] } # è\n"),
            "model = { note = \"più µm\", effects = [\"a:X\", \"backlash:X\"] } # è\n");
}

TEST(ModelEdit, AModelTableIsAddedWhereThereIsNone) {
  EXPECT_EQ(added("format = 1"), "format = 1\n\n[model]\neffects = [\"backlash:X\"]\n");
  EXPECT_EQ(added(""), "\n[model]\neffects = [\"backlash:X\"]\n");
  EXPECT_EQ(added("[model]\ncompensate = \"model\"\n[run]\n"),
            "[model]\neffects = [\"backlash:X\"]\ncompensate = \"model\"\n[run]\n");
  EXPECT_EQ(added("t = '''\n[model]\n'''\n[ model ] # here\n"),
            "t = '''\n[model]\n'''\n[ model ] # here\neffects = [\"backlash:X\"]\n");
  EXPECT_EQ(added("[[model.formula]]\nname = \"f\"\n[run]\n"),
            "[[model.formula]]\nname = \"f\"\n[run]\n\n[model]\neffects = [\"backlash:X\"]\n");
}

TEST(ModelEdit, RefusesWhatItCannotDoExactly) {
  const auto inline_table = modelling::with_effect("model = { compensate = \"model\" }\n", "a:X");
  ASSERT_FALSE(inline_table);
  EXPECT_NE(inline_table.error().message.find("nothing was changed"), std::string::npos);
  EXPECT_EQ(inline_table.error().file, "campaign.toml");
  const auto number = modelling::with_effect("\n[model]\neffects = 3\n", "a:X");
  ASSERT_FALSE(number);
  EXPECT_EQ(number.error().line, 3U);
  EXPECT_FALSE(modelling::with_effect("[model]\neffects = [1]\n[[\n", "a:X"));
  EXPECT_FALSE(modelling::without_effect("[model]\neffects = [\"b:X\"]\n", "a:X"));
  EXPECT_FALSE(modelling::without_effect("format = 1\n", "a:X"));
}

TEST(ModelEdit, AnEffectIsTakenOutOfTheList) {
  const std::string three = "effects = [\"a:X\", \"b:X\",  'c:X']\n";
  EXPECT_EQ(dropped("[model]\n" + three, "a:X"), "[model]\neffects = [\"b:X\",  'c:X']\n");
  EXPECT_EQ(dropped("[model]\n" + three, "b:X"), "[model]\neffects = [\"a:X\", 'c:X']\n");
  EXPECT_EQ(dropped("[model]\n" + three, "c:X"), "[model]\neffects = [\"a:X\", \"b:X\"]\n");
  EXPECT_EQ(dropped("[model]\neffects = [\"a:X\"]", "a:X"), "[model]\neffects = []");
}

TEST(ModelEdit, DropsALineAndKeepsComments) {
  const std::string text =
      "[model]\neffects = [\n  # pitch\n  \"a:X\",\n  \"b:X\", # seen on Monday\n  \"c:X\"\n]\n";
  EXPECT_EQ(dropped(text, "a:X"),
            "[model]\neffects = [\n  # pitch\n  \"b:X\", # seen on Monday\n  \"c:X\"\n]\n");
  EXPECT_EQ(dropped(text, "b:X"),
            "[model]\neffects = [\n  # pitch\n  \"a:X\",\n  # seen on Monday\n  \"c:X\"\n]\n");
  EXPECT_EQ(dropped(text, "c:X"),
            "[model]\neffects = [\n  # pitch\n  \"a:X\",\n  \"b:X\" # seen on Monday\n]\n");
}

TEST(ModelEdit, DropIsTheReverseOfAdd) {
  for (const std::string text :
       {"[model]\neffects = [\"a:X\"]\n", "[model]\neffects = []\n",
        "[model]\neffects = [\n  \"a:X\", # one\n  \"b:X\"\n]\n",
        "[model]\neffects = [\n  \"a:X\",\n]\n", "[model]\r\neffects = [\r\n\"a:X\"\r\n]\r\n",
        "[model]\neffects = [\"a:X\",\n \"b:X\"]\n"})
    EXPECT_EQ(dropped(added(text), "backlash:X"), text);
}

std::string excluded(const std::string& text, std::vector<std::uint32_t> lines,
                     const std::string& why = "chip") {
  const auto out = modelling::with_excluded(text, "m", lines, why);
  return out ? *out : "refused: " + out.error().message;
}

TEST(ModelEdit, ExcludedLinesComeIntoTheirMeasurement) {
  const std::string two =
      "[[measurement]]\nid = \"other\"\nfile = \"o.csv\"\n\n[[measurement]] # mine\n  id = "
      "'m'\n  file = \"m.csv\" # seen\n  axis = \"X\"\n";
  EXPECT_EQ(excluded(two, {57, 103}),
            "[[measurement]]\nid = \"other\"\nfile = \"o.csv\"\n\n[[measurement]] # mine\n  id = "
            "'m'\n  file = \"m.csv\" # seen\n  exclude = [57, 103]\n  exclude_reason = \"chip\"\n  "
            "axis = \"X\"\n");
  const std::string there =
      "[[measurement]]\nid = \"m\"\nfile = \"m.csv\"\nexclude = [\n  57, # hit\n]\nexclude_reason "
      "= 'hit' # by whom?\n";
  EXPECT_EQ(excluded(there, {57, 9}),
            "[[measurement]]\nid = \"m\"\nfile = \"m.csv\"\nexclude = [\n  57, # hit\n  9,\n]\n"
            "exclude_reason = \"hit; chip\" # by whom?\n");
  EXPECT_EQ(excluded("[[measurement]]\r\nid = \"m\"\r\nexclude = [1]\r\n", {2}, "\"a\" # b\\"),
            "[[measurement]]\r\nid = \"m\"\r\nexclude = [1, 2]\r\nexclude_reason = \"\\\"a\\\" # "
            "b\\\\\"\r\n");
  EXPECT_TRUE(
      excluded("measurement = [{ id = \"m\", file = \"a\" }]\n", {2}).starts_with("refused"));
  EXPECT_TRUE(excluded("[[measurement]]\nid = \"n\"\n", {2}).starts_with("refused"));
}

TEST(ModelEdit, ThePeriodOfAnAxis) {
  const auto period = [](const std::string& text, double mm) {
    const auto out = modelling::with_period(text, "X", mm);
    return out ? *out : "refused: " + out.error().message;
  };
  EXPECT_EQ(period("[machine.axes.X]\nkind = \"linear\" # ball\ntravel = [0, 9]\n", 10.0),
            "[machine.axes.X]\nkind = \"linear\" # ball\nscrew_pitch_mm = 10.0\ntravel = [0, 9]\n");
  EXPECT_EQ(period("[machine.axes.X]\nscrew_pitch_mm = 5# mm\n", 12.5),
            "[machine.axes.X]\nscrew_pitch_mm = 12.5# mm\n");
  EXPECT_EQ(period("[machine.axes.X]\ntravel = [0, 9]\n", 4.0),
            "[machine.axes.X]\nscrew_pitch_mm = 4.0\ntravel = [0, 9]\n");
  EXPECT_TRUE(period("[machine.axes]\nX = { kind = \"linear\" }\n", 4.0).starts_with("refused"));
  EXPECT_TRUE(period("[machine.axes.Y]\nkind = \"linear\"\n", 4.0).starts_with("refused"));
}

TEST(ModelHistory, ReadsWhatItWrites) {
  modelling::ModelStep step{.effect = "backlash:X", .rms_before = 4.1e-6, .rms_after = 0.7e-6};
  step.floor = 0.6e-6;
  const std::string line = modelling::history_line(step);
  EXPECT_EQ(line,
            "{\"action\":\"add\",\"effect\":\"backlash:X\",\"rms_before_um\":4.1,"
            "\"rms_after_um\":0.7,\"noise_floor_um\":0.6}\n");
  const auto read = modelling::parse_history(line + "\n" + line);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ(modelling::history_line(read->back()), line);
  EXPECT_FALSE(read->front().cv_before);
  const auto broken = modelling::parse_history(line + "scale:X\n");
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().line, 2U);
}

}  // namespace
}  // namespace nonio::model_edit_test
