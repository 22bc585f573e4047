// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/method.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nonio::method_test {
namespace {

using Role = Method::Column::Role;

/// Positions in mm, deviations in um, and all else that a column can be.
Method by_roles() {
  Method m;
  m.info = {"m", "1", "A method."};
  m.info.options = {{.name = "axis",
                     .default_value = std::string(),
                     .unit = "",
                     .help = "The axis that moves.",
                     .required = true}};
  m.columns = {{"target", Quantity::length, Role::position, "Position."},
               {"gauge", Quantity::deviation, Role::deviation, "Deviation."},
               {"run", Quantity::count, Role::run, "Run.", false},
               {"direction", Quantity::number, Role::direction, "Direction.", false},
               {"time", Quantity::time, Role::time, "Time.", false},
               {"material", Quantity::temperature, Role::material, "Temperature.", false}};
  return m;
}

const Campaign campaign{};

Measurement of_x() {
  Measurement m;
  m.id = "X 1", m.kind = "m", m.axis = "X";
  return m;
}

Readings three() {
  Readings r;
  r.columns = {{"target", {0.0, 0.1, 0.2}},
               {"gauge", {1e-6, NAN, 3e-6}},
               {"run", {1.0, 1.0, 2.0}},
               {"direction", {1.0, 1.0, -1.0}},
               {"time", {0.0, 5.0, NAN}}};
  r.source_line = {2, 3, 4};
  return r;
}

std::string error_of(const Expected<Observations>& o) {
  return o ? ""
           : o.error().message + (o.error().column.empty() ? "" : ", " + o.error().column) +
                 (o.error().line == 0 ? "" : ", " + std::to_string(o.error().line));
}

}  // namespace

TEST(Method, NamesOfColumnsHaveTheirUnits) {
  const Method m = by_roles();
  EXPECT_EQ(name_in_file(m.columns[0]), "target_mm");
  EXPECT_EQ(name_in_file(m.columns[1]), "gauge_um");
  EXPECT_EQ(name_in_file(m.columns[2]), "run");
  EXPECT_EQ(name_in_file(m.columns[5]), "material_c");
}

TEST(Method, RolesMakeObservations) {
  const auto o = observe(by_roles(), {campaign, of_x(), three()});
  ASSERT_TRUE(o) << o.error().message;
  EXPECT_EQ(o->measurement, "X 1");
  EXPECT_EQ(o->missing, 1U);
  EXPECT_EQ(o->deviation, (std::vector<double>{1e-6, 3e-6}));
  ASSERT_EQ(o->axes.size(), 1U);
  EXPECT_EQ(o->axes[0].axis, "X");
  EXPECT_EQ(o->axes[0].position, (std::vector<double>{0.0, 0.2}));
  EXPECT_EQ(o->axes[0].approach, (std::vector<std::int8_t>{1, -1}));
  EXPECT_EQ(o->run, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(o->source_line, (std::vector<std::uint32_t>{2, 4}));
  EXPECT_EQ(o->time[0], 0.0);
  EXPECT_TRUE(std::isnan(o->time[1]));
  EXPECT_TRUE(o->material.empty());
  EXPECT_EQ(o->lines[0].sense, (std::array<double, 3>{1.0, 0.0, 0.0}));
}

TEST(Method, ADeviationAcrossIsSensedAcross) {
  Measurement across = of_x();
  across.lateral = "Z";
  EXPECT_EQ(observe(by_roles(), {campaign, across, three()})->lines[0].sense,
            (std::array<double, 3>{0.0, 0.0, 1.0}));
  Method turning = by_roles();
  turning.columns[0].quantity = Quantity::angle;
  turning.columns[1].quantity = Quantity::angular_deviation;
  const auto o = observe(turning, {campaign, of_x(), three()});
  EXPECT_TRUE(o->angular && o->axes[0].rotary);
  EXPECT_EQ(o->lines[0].sense, (std::array<double, 3>{}));
}

TEST(Method, ReadingsThatDoNotMatchAreRefused) {
  const auto refusal = [](const char* name, std::vector<double> values) {
    Readings r = three();
    if (values.empty())
      r.columns.erase(name);
    else
      r.columns[name] = std::move(values);
    return error_of(observe(by_roles(), {campaign, of_x(), r}));
  };
  EXPECT_EQ(refusal("target", {}), "missing column: expected \"target_mm\"");
  EXPECT_EQ(refusal("target", {0.0, NAN, 0.2}), "expected a number, target_mm, 3");
  EXPECT_EQ(refusal("target", {0.0}), "column target has 1 values; expected 3");
  EXPECT_EQ(refusal("run", {1.0, 1.0, 1.5}), "expected a whole number from 1, run, 4");
  EXPECT_EQ(refusal("run", {1.0, 1.0, NAN}), "expected a whole number from 1, run, 4");
}

TEST(Method, SimulatedReadingsAreObservedAgain) {
  const auto o = observe(by_roles(), {campaign, of_x(), three()});
  const auto readings = simulate(by_roles(), {campaign, of_x(), *o});
  ASSERT_TRUE(readings) << readings.error().message;
  const auto again = observe(by_roles(), {campaign, of_x(), *readings});
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->deviation, o->deviation);
  EXPECT_EQ(again->axes[0].position, o->axes[0].position);
  EXPECT_EQ(again->axes[0].approach, o->axes[0].approach);
  EXPECT_EQ(again->run, o->run);
  EXPECT_EQ(again->source_line, o->source_line);
  Method wanted = by_roles();
  wanted.columns[5].required = true;
  EXPECT_EQ(simulate(wanted, {campaign, of_x(), *o}).error().message,
            "the observations do not determine the required column material_c");
}

TEST(Method, DeclarationsAreChecked) {
  const auto complaint = [](auto change) {
    Method m = by_roles();
    change(m);
    const auto sound = check(m);
    return sound ? std::string() : sound.error().message;
  };
  EXPECT_EQ(complaint([](Method&) {}), "");
  EXPECT_EQ(complaint([](Method& m) { m.columns.clear(); }), "");
  EXPECT_EQ(complaint([](Method& m) { m.columns.push_back(m.columns[0]); }),
            "two columns with the name target_mm");
  EXPECT_EQ(complaint([](Method& m) { m.columns[0].name = "Target"; }),
            "a column with the name \"Target\"; expected a-z 0-9 _");
  EXPECT_EQ(complaint([](Method& m) { m.columns[0].help.clear(); }), "column target without help");
  EXPECT_EQ(complaint([](Method& m) { m.columns[4].role = Role::air; }),
            "column time has a quantity that does not match its role");
  EXPECT_EQ(complaint([](Method& m) { m.columns[2].role = Role::direction; }),
            "column direction has the role of another column");
  EXPECT_EQ(complaint([](Method& m) { m.columns.erase(m.columns.begin() + 1); }),
            "no column has the role deviation; expected one, or a function `observe`");
  EXPECT_EQ(complaint([](Method& m) { m.info.options.clear(); }),
            "a column has the role position; expected a required key `axis`");
  EXPECT_EQ(complaint([](Method& m) {
              m.columns.push_back({"force", Quantity::number, Role::none, "Force."});
            }),
            "the required column force has no role; expected a function `observe`");
}

}  // namespace nonio::method_test
