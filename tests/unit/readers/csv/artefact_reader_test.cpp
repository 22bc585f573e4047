// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "csv.h"

namespace nonio::csv::artefact_test {
namespace {

Expected<Observations> read_as(const char* kind, const std::string& text) {
  Campaign campaign;
  Measurement m;
  m.id = "P1", m.kind = kind, m.file = "p1.csv", m.lateral = "plate";
  const Settings options;
  return read({text, campaign, m, options, {}});
}

TEST(Artefact, EachBallIsThreeLines) {
  const auto obs =
      read_as("artefact", "run;ball;x_mm;y_mm;z_mm\n1;b1;10,5;1;2\n1;b2;;1;2\n2;b1;10,7;1;2\n");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->size(), 6U);
  EXPECT_EQ(obs->missing, 1U);
  ASSERT_EQ(obs->lines.size(), 3U);  // of b2 nothing was read
  EXPECT_EQ(obs->lines[1].name, "b1 y");
  EXPECT_EQ(obs->lines[1].sense[1], 1.0);
  EXPECT_EQ(obs->line[4], 1U);
  EXPECT_DOUBLE_EQ(obs->deviation[3], 0.0107);
  EXPECT_DOUBLE_EQ(obs->axes[0].position[4], 0.0107);
  EXPECT_EQ(obs->run[3], 2U);
}

TEST(Artefact, ACoordinateThatWasNotMeasuredHasNoLine) {
  const auto obs = read_as("artefact", "ball,x_mm,y_mm\nh1,10,1\nh2,20,2\n");
  ASSERT_TRUE(obs) << obs.error().message;
  ASSERT_EQ(obs->size(), 4U);
  ASSERT_EQ(obs->axes.size(), 2U);
  ASSERT_EQ(obs->lines.size(), 4U);
  for (const auto& line : obs->lines) EXPECT_EQ(line.sense[2], 0.0);
  EXPECT_EQ(obs->lines[3].name, "h2 y");
  EXPECT_EQ(obs->missing, 0U);
  const auto across = read_as("artefact", "ball,x_mm,z_mm\nh1,10,1\n");
  ASSERT_TRUE(across) << across.error().message;
  EXPECT_EQ(across->axes[1].axis, "Z");
  EXPECT_EQ(across->lines[1].sense[2], 1.0);
  EXPECT_FALSE(read_as("artefact", "ball,x_mm\nh1,10\n"));
}

TEST(Artefact, ACertificateStatesPlacesOrLengthsWithTheirU) {
  const auto places = read_as("artefact-certificate", "ball,x_mm,y_mm,z_mm,U_um\nb1,1,2,3,0.4\n");
  ASSERT_TRUE(places) << places.error().message;
  EXPECT_DOUBLE_EQ(places->deviation[2], 0.003);
  EXPECT_DOUBLE_EQ(places->u[2], 0.2e-6);
  const auto lengths =
      read_as("artefact-certificate", "ball,other,length_mm,U_um\nb1,b2,400.012,0.6\n");
  ASSERT_TRUE(lengths) << lengths.error().message;
  EXPECT_EQ(lengths->lines.front().name, "b1 b2");
  EXPECT_EQ(lengths->lines.front().sense, (std::array<double, 3>{}));
  EXPECT_DOUBLE_EQ(lengths->deviation.front(), 0.400012);
}

TEST(Artefact, RefusesWithLineAndColumn) {
  const auto refused = [](const char* kind, const std::string& text, std::uint64_t line,
                          const std::string& column, const std::string& says) {
    const auto obs = read_as(kind, text);
    ASSERT_FALSE(obs) << text;
    EXPECT_EQ(obs.error().line, line) << obs.error().message;
    EXPECT_EQ(obs.error().column, column) << obs.error().message;
    EXPECT_NE(obs.error().message.find(says), std::string::npos) << obs.error().message;
  };
  refused("artefact", "ball,x_mm,y_mm,z_mm\nb1,1,2,3\nb1,1,2,3\n", 3, "ball", "line 2");
  refused("artefact", "ball,x_mm,y_mm,z_mm\nb 1,1,2,3\n", 2, "ball", "without a blank");
  refused("artefact", "ball,x_mm,y_mm,z_mm\n,1,2,3\n", 2, "ball", "name of a ball");
  refused("artefact-certificate", "ball,x_mm,y_mm,z_mm,U_um\nb1,1,2,3,0\n", 2, "U_um", "above 0");
  refused("artefact-certificate", "ball,other,length_mm,U_um\nb1,b1,1,1\n", 2, "length_mm",
          "two balls");
  refused("artefact-certificate", "ball,other,length_mm,U_um\nb1,b2,1,1\nb2,b1,1,1\n", 3, "ball",
          "line 2");
  EXPECT_FALSE(read_as("artefact", "ball,x_mm,y_mm,z_mm\nb1,nan,2,3\n"));  // nothing was taken
}

}  // namespace
}  // namespace nonio::csv::artefact_test
