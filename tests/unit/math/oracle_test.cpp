// SPDX-License-Identifier: Apache-2.0
//
// Readings, and what independent programs make of them. The made ones are in tests/golden/oracle.
// Real ones are not part of the project; where they are absent the test says so and is skipped.
#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "axis_builder.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/vdi3441.h"

namespace nonio::oracle_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path data() {
  const char* named = std::getenv("NONIO_SHARED_DATA");
  return named != nullptr ? fs::path(named) : fs::path(NONIO_SHARED_DATA);
}

// run,direction,target,deviation; the numbers are not converted, so that the results are in the
// unit of the file.
Observations read(const fs::path& file) {
  std::ifstream in(file);
  Observations o;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> field(1);
    for (const char c : line)
      if (c == ',')
        field.emplace_back();
      else if (c != '\r')
        field.back() += c;
    if (field.size() < 4) continue;
    const auto number = [](const std::string& text) {
      double v = std::nan("");
      std::from_chars(text.data(), text.data() + text.size(), v);
      return v;
    };
    made::add(o, number(field[2]), field[1] == "+" ? 1 : -1, number(field[3]),
              static_cast<std::uint32_t>(number(field[0])));
  }
  return o;
}

std::map<std::string, double> iso(const math::AxisTest& test, double k) {
  const auto r = math::evaluate_iso230_2(test, k);
  return {{"A", r.A},
          {"A_up", r.A_plus},
          {"A_down", r.A_minus},
          {"E", r.E},
          {"E_up", r.E_plus},
          {"E_down", r.E_minus},
          {"M", r.M},
          {"R", r.R},
          {"R_up", r.R_plus},
          {"R_down", r.R_minus},
          {"B", r.B},
          {"B_mean", r.B_mean}};
}

std::map<std::string, double> vdi(const math::AxisTest& test, math::StandardDeviation how) {
  const auto r = math::evaluate_vdi3441(test, how);
  return {{"P", r.P},
          {"Pa", r.Pa},
          {"Ps_max", r.Ps_max},
          {"Ps_mean", r.Ps_mean},
          {"U_max", r.U_max},
          {"U_mean", r.U_mean},
          {"PsU_max", r.PsU_max},
          {"P_up", r.P_plus},
          {"P_down", r.P_minus},
          {"Pa_up", r.Pa_plus},
          {"Pa_down", r.Pa_minus},
          {"Ps_max_up", r.Ps_max_plus},
          {"Ps_max_down", r.Ps_max_minus}};
}

/// How many values; `relative` is what may differ.
int compare(const json& wanted, const std::map<std::string, double>& found, double relative) {
  int compared = 0;
  for (const auto& [name, value] : wanted.items()) {
    const auto it = found.find(name);
    if (it == found.end()) {
      ADD_FAILURE() << "no value " << name;
      continue;
    }
    ++compared;
    if (value.is_null()) {
      EXPECT_TRUE(std::isnan(it->second)) << name << " expected absent, found " << it->second;
      continue;
    }
    const double w = value.get<double>();
    EXPECT_TRUE(std::fabs(it->second - w) <= relative * std::fabs(w) + 1e-12)
        << name << " expected " << w << ", found " << it->second;
  }
  return compared;
}

/// Compares every CSV of a folder with its expected results; returns how many there are.
int compare_folder(const fs::path& folder, double relative) {
  int files = 0, compared = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const std::string ending = ".expected.json";
    if (!name.ends_with(ending)) continue;
    SCOPED_TRACE(name);
    const json oracle = json::parse(std::ifstream(entry.path()))["oracle"];
    const auto test = math::AxisTest::arrange(
        read(folder / (name.substr(0, name.size() - ending.size()) + ".csv")));
    EXPECT_FALSE(test.targets.empty());
    compared += compare(oracle["iso230_2_2014"], iso(test, 2.0), relative);
    compared += compare(oracle["iso230_2_1988"], iso(test, 3.0), relative);
    compared +=
        compare(oracle["vdi3441_direct"], vdi(test, math::StandardDeviation::direct), relative);
    compared +=
        compare(oracle["vdi3441_range"], vdi(test, math::StandardDeviation::from_range), relative);
    ++files;
  }
  std::cout << compared << " values of " << files << " files\n";
  return files;
}

/// tests/golden/make_oracle.py made both.
TEST(Oracle, MadeReadingsHaveTheResultsOfExactArithmetic) {
  EXPECT_EQ(compare_folder(NONIO_ORACLE, 1e-10), 10);
}

TEST(Oracle, RealReadingsHaveTheResultsOfTwoOtherPrograms) {
  const fs::path folder = data() / "iso230";
  if (!fs::exists(folder))
    GTEST_SKIP() << "no real readings at " << folder << ", NONIO_SHARED_DATA";
  EXPECT_GE(compare_folder(folder, 1e-6), 12);
}

TEST(Oracle, ARealRotaryAxisHasTheResultsOfAnotherProgram) {
  const fs::path file = data() / "real" / "rotary_collimator_6x6x2.csv";
  if (!fs::exists(file)) GTEST_SKIP() << "no real readings at " << file << ", NONIO_SHARED_DATA";
  const auto test = math::AxisTest::arrange(read(file));
  const json oracle =
      json::parse(std::ifstream(fs::path(file).replace_extension(".json")))["oracle"];
  EXPECT_EQ(compare(oracle["iso230_2"]["results"], iso(test, 2.0), 1e-6), 12);
  EXPECT_EQ(compare(oracle["vdi3441"]["results"], vdi(test, math::StandardDeviation::direct), 1e-6),
            13);
}

}  // namespace
}  // namespace nonio::oracle_test
