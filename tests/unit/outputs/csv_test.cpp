// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "one_output.h"

namespace nonio {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Results results_of(const std::string& measurement) {
  Results r;
  Results::Analysed a;
  a.plugin = "iso230-2";
  a.measurement = measurement;
  a.evaluation.values = {{"A", 11.96e-6, Quantity::deviation, 1.9e-6},
                         {"R+", 4.516e-6, Quantity::deviation, {}}};
  a.evaluation.points.columns = {{"target", Quantity::length, {0.0252, 0.1}},
                                 {"mean+", Quantity::deviation, {1.5e-6, nan}}};
  r.analyses = {a};
  return r;
}

std::string file(const Expected<OutputResult>& result, const std::string& name) {
  EXPECT_TRUE(result);
  for (const Artifact& a : result->artifacts)
    if (a.name == name) return a.bytes;
  ADD_FAILURE() << "no " << name;
  return {};
}

const std::string head = "measurement,plugin,name,value,unit,U,tolerance,decision\n";

TEST(Csv, ValuesHaveUncertaintyToleranceAndDecision) {
  Results r = results_of("X");
  r.conformity = {{"X", "X", "iso230-2", "A", 15e-6, Quantity::deviation, Decision::conforms, ""}};
  EXPECT_EQ(file(written({}, {}, r), "values.csv"),
            head + "X,iso230-2,A,11.96,um,1.9,15,conforms\nX,iso230-2,R+,4.516,um,,,\n");
}

TEST(Csv, DecisionsInWords) {
  Results r = results_of("X");
  for (const auto& [decision, words] :
       {std::pair{Decision::does_not_conform, "does not conform"},
        std::pair{Decision::cannot_be_decided, "cannot be decided"}}) {
    r.conformity = {{"X", "X", "iso230-2", "R+", 4e-6, Quantity::deviation, decision, ""}};
    EXPECT_NE(file(written({}, {}, r), "values.csv").find(",4," + std::string(words) + "\n"),
              std::string::npos);
  }
}

TEST(Csv, ToleranceWithoutAValueIsSeen) {
  Results r = results_of("X");
  r.conformity = {{"X", "X", "iso230-2", "B", 3e-6, Quantity::deviation,
                   Decision::cannot_be_decided, "no-value"}};
  EXPECT_NE(file(written({}, {}, r), "values.csv").find("X,iso230-2,B,,um,,3,cannot be decided\n"),
            std::string::npos);
}

TEST(Csv, PointsHaveUnitsInTheirNamesAndEmptyFieldsForTheUnknown) {
  EXPECT_EQ(file(written({}, {}, results_of("X")), "points-X-iso230-2.csv"),
            "target_mm,mean+_um\n25.2,1.5\n100,\n");
}

TEST(Csv, QuotesAndFormulas) {
  for (const auto& [name, field] :
       {std::pair{"a,b", "\"a,b\""}, std::pair{"a\"b", "\"a\"\"b\""}, std::pair{"=1+1", "'=1+1"},
        std::pair{"+X", "'+X"}, std::pair{"-X", "'-X"}, std::pair{"@X", "'@X"},
        std::pair{"=a,b", "\"'=a,b\""}, std::pair{"X=1", "X=1"}})
    EXPECT_NE(file(written({}, {}, results_of(name)), "values.csv")
                  .find("\n" + std::string(field) + ",iso230-2,A,"),
              std::string::npos)
        << name;
}

TEST(Csv, NumbersAreNotTakenForFormulas) {
  Results r = results_of("X");
  r.analyses[0].evaluation.values = {{"B_mean", -8.143e-6, Quantity::deviation, {}}};
  EXPECT_NE(file(written({}, {}, r), "values.csv").find(",-8.143,um"), std::string::npos);
}

TEST(Csv, FileNamesArePlainAndDifferent) {
  Results r = results_of("a/b");
  r.analyses.push_back(r.analyses[0]);
  r.analyses[1].measurement = "a b";
  const auto result = written({}, {}, r);
  EXPECT_FALSE(file(result, "points-a_b-iso230-2.csv").empty());
  EXPECT_FALSE(file(result, "points-a_b-iso230-2-2.csv").empty());
}

}  // namespace
}  // namespace nonio
