// SPDX-License-Identifier: Apache-2.0
// Where increments begin and end: the drawing of docs/howto-plugin.md in numbers.
#include <gtest/gtest.h>

#include "nonio/controllers/kit.h"

using namespace nonio;
using controllers::RawTable;

namespace {

ControlTable table(ControlTable::Zero zero) {
  ControlTable t;
  t.sign = ControlTable::Sign::correction;
  t.entry = ControlTable::Entry::increment;
  t.zero = zero;
  t.value_unit = {1e-6, 1.0};
  return t;
}

/// Entries at -100, 0, 100, 200 mm; the change over each interval is at its end.
RawTable drawn() {
  RawTable raw;
  raw.axis.name = "X";
  raw.position = {-100.0, 0.0, 100.0, 200.0};
  raw.plus = {0.0, 4.0, -2.0, 5.0};
  raw.reference = 1;
  return raw;
}

void expect_um(const std::vector<double>& found, const std::vector<double>& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i] * 1e6, wanted[i], 1e-9) << i;
}

TEST(Increments, AreAtTheEndOfTheirIntervalAndZeroAtTheReference) {
  const auto read = controllers::loaded(table(ControlTable::Zero::reference), drawn());
  ASSERT_TRUE(read);
  expect_um(read->plus, {-4.0, 0.0, -2.0, 3.0});
  EXPECT_TRUE(read->minus.empty());
}

TEST(Increments, TheSecondColumnBeginsWhereItsOwnNumberSays) {
  RawTable raw = drawn();
  raw.minus = {0.0, 3.0, -2.0, 4.0};
  raw.minus_start = 7.0;
  const auto read = controllers::loaded(table(ControlTable::Zero::reference), raw);
  ASSERT_TRUE(read);
  expect_um(read->plus, {-4.0, 0.0, -2.0, 3.0});
  expect_um(read->minus, {4.0, 7.0, 5.0, 9.0});
  // With the error's sign the start value turns with all others.
  ControlTable error = table(ControlTable::Zero::reference);
  error.sign = ControlTable::Sign::error;
  expect_um(controllers::loaded(error, raw)->minus, {-4.0, -7.0, -5.0, -9.0});
}

TEST(Increments, ZeroAtTheFirstPoint) {
  RawTable raw = drawn();
  EXPECT_FALSE(controllers::loaded(table(ControlTable::Zero::first), raw));
  raw.reference = 0;
  const auto read = controllers::loaded(table(ControlTable::Zero::first), raw);
  ASSERT_TRUE(read);
  expect_um(read->plus, {0.0, 4.0, 2.0, 7.0});
}

}  // namespace
