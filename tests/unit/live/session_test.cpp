// SPDX-License-Identifier: Apache-2.0
#include "live/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace session_test {

using namespace nonio::live;
using Names = std::vector<std::string>;

namespace {

Excluded reading(const std::string& part, std::size_t row, const std::string& why = "chip") {
  return {part, row, "m", "m.csv", static_cast<std::uint32_t>(row), row + 2, why};
}

}  // namespace

TEST(LiveSession, BeginsWithTheSavedModel) {
  const Session s({"a:X", "b:X"});
  EXPECT_EQ(s.trial().model, (Names{"a:X", "b:X"}));
  EXPECT_FALSE(s.can_undo());
  EXPECT_FALSE(s.can_redo());
}

TEST(LiveSession, StepsGoBackAndForth) {
  Session s{Names{}};
  ASSERT_TRUE(s.add("a:X"));
  ASSERT_TRUE(s.add("b:X"));
  EXPECT_FALSE(s.add("b:X"));
  ASSERT_TRUE(s.undo());
  EXPECT_EQ(s.trial().model, Names{"a:X"});
  ASSERT_TRUE(s.redo());
  EXPECT_FALSE(s.redo());
  EXPECT_EQ(s.trial().model, (Names{"a:X", "b:X"}));
  ASSERT_TRUE(s.go_to(0));
  EXPECT_FALSE(s.undo());
  ASSERT_TRUE(s.drop("a:X").has_value() == false);
  ASSERT_TRUE(s.add("c:X"));
  EXPECT_EQ(s.steps().size(), 2U);  // an undone step is discarded
  EXPECT_FALSE(s.go_to(2));
}

TEST(LiveSession, OrderIsThatOfTheFileAfterSaving) {
  Session s({"a:X", "b:X", "c:X"});
  ASSERT_TRUE(s.drop("a:X"));
  ASSERT_TRUE(s.add("d:X"));
  ASSERT_TRUE(s.add("a:X"));
  EXPECT_EQ(s.trial().model, (Names{"a:X", "b:X", "c:X", "d:X"}));
}

TEST(LiveSession, AChangeThatChangesNothingIsNoStep) {
  Session s(Names{"a:X"});
  const auto version = s.version();
  ASSERT_TRUE(s.set({"a:X"}));
  EXPECT_EQ(s.version(), version);
  EXPECT_EQ(s.steps().size(), 1U);
}

TEST(LiveSession, ExclusionsHaveReasonsAndCanBeUndone) {
  Session s{Names{}};
  EXPECT_FALSE(s.exclude({reading("X", 3, "")}));
  EXPECT_TRUE(s.trial().excluded.empty());
  ASSERT_TRUE(s.exclude({reading("X", 7), reading("X", 3)}));
  EXPECT_EQ(s.trial().excluded.front().row, 3U);
  ASSERT_TRUE(s.exclude({reading("X", 3, "other")}));
  EXPECT_EQ(s.trial().excluded.size(), 2U);
  EXPECT_EQ(s.trial().excluded.front().why, "other");
  ASSERT_TRUE(s.include("X", {3}));
  EXPECT_FALSE(s.include("X", {3}));
  EXPECT_FALSE(s.include("Y", {7}));
  ASSERT_TRUE(s.undo());
  EXPECT_EQ(s.trial().excluded.size(), 2U);
}

TEST(LiveSession, Periods) {
  Session s{Names{}};
  for (const double wrong : {-1.0, std::nan(""), 1e300, HUGE_VAL})
    EXPECT_FALSE(s.period("X", wrong));
  ASSERT_TRUE(s.period("X", 10.0));
  EXPECT_EQ(s.trial().period_mm.at("X"), 10.0);
  ASSERT_TRUE(s.period("X", 0.0));
  EXPECT_TRUE(s.trial().period_mm.empty());
}

TEST(LiveSession, SavingKeepsTheSteps) {
  Session s{Names{}};
  ASSERT_TRUE(s.add("a:X"));
  s.was_saved({"a:X"});
  EXPECT_EQ(s.saved(), Names{"a:X"});
  EXPECT_EQ(command_of("c", s.saved(), s.trial()), "");
  ASSERT_TRUE(s.undo());
  EXPECT_EQ(command_of("c", s.saved(), s.trial()), "nonio model drop c a:X");
}

TEST(LiveSession, ReadAgainNoReadingIsExcluded) {
  Session s{Names{}};
  ASSERT_TRUE(s.exclude({reading("X", 3)}));
  s.was_read_again({"b:X"});
  EXPECT_EQ(s.trial().model, Names{"b:X"});
  EXPECT_TRUE(s.trial().excluded.empty());
  ASSERT_TRUE(s.undo());
  EXPECT_TRUE(s.trial().excluded.empty());
}

TEST(LiveSession, CommandsAreForAShell) {
  Trial trial{{"b:X"}, {reading("X", 3), reading("X", 4)}, {{"X", 12.5}}};
  trial.excluded[0].line = 57, trial.excluded[1].line = 58;
  for (Excluded& e : trial.excluded) e.measurement = "X", e.why = "beam interrupted";
  EXPECT_EQ(command_of("my c", {"a:X"}, trial),
            "nonio model exclude 'my c' X 57,58 --why 'beam interrupted' && nonio model period 'my "
            "c' X 12.5 && nonio model drop 'my c' a:X && nonio model add 'my c' b:X");
  Trial before = trial;
  before.excluded.pop_back(), before.model = {"a:X"};
  EXPECT_EQ(command_between("c", before, trial),
            "nonio model exclude c X 58 --why 'beam interrupted' && nonio model drop c a:X && "
            "nonio model add c b:X");
  EXPECT_EQ(quoted_for_shell("it's; rm -rf $HOME"), "'it'\\''s; rm -rf $HOME'");
  EXPECT_EQ(quoted_for_shell(""), "''");
}

TEST(LiveSession, VersionsOnlyGrowAndUndoIsExact) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  Session s({"e0:X", "e1:X"});
  std::vector<Trial> trials{s.trial()};
  auto version = s.version();
  for (int i = 0; i < 3000; ++i) {
    const std::string effect = "e" + std::to_string(random() % 6) + ":X";
    const std::size_t at = s.at();
    const auto kind = random() % 5;
    const auto done = kind == 0   ? s.add(effect)
                      : kind == 1 ? s.drop(effect)
                      : kind == 2 ? s.undo()
                      : kind == 3 ? s.redo()
                                  : s.exclude({reading("X", random() % 9)});
    EXPECT_GE(s.version(), version);
    version = s.version();
    if (!done || s.at() == at) continue;
    if (kind == 2 || kind == 3) {
      EXPECT_EQ(s.trial(), trials[s.at()]);
    } else if (s.steps().size() < 900) {
      trials.resize(s.at());
      trials.push_back(s.trial());
    } else {
      break;
    }
  }
}

}  // namespace session_test
