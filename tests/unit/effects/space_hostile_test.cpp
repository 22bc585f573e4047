// SPDX-License-Identifier: Apache-2.0
// Readings that no effect in space can make sense of.
#include <gtest/gtest.h>

#include "space_table.h"

namespace nonio::space_hostile_test {

using namespace space;

namespace {

std::vector<Observations> hostile_tables() {
  Observations one = table({sensed(straight("L", {0, 0, 0}, {1, 0, 0}, 1), {0, 1, 0})});
  for (auto& axis : one.axes) axis.position.resize(1), axis.approach.resize(1);
  one.line.resize(1);
  one.deviation.resize(1);
  one.run.resize(1);
  std::vector<Observations> all(1);
  all.push_back(one);
  all.push_back(one);  // one ball coordinate
  all.back().axes.insert(all.back().axes.begin(), {"C", true, {0.5}, {1}});
  all.push_back(all.back());
  all.back().line.clear();
  all.push_back(one);
  all.back().axes.clear();
  all.push_back(table(step_diagonals(1)));
  all.push_back(table(two_diagonals()));
  for (auto& axis : all.back().axes) axis.position.assign(all.back().size(), 0.5);
  all.push_back(all.back());
  for (auto& axis : all.back().axes) axis.position.assign(all.back().size(), nan);
  all.push_back(table(two_diagonals()));
  all.back().lines[0].sense = {};
  return all;
}

}  // namespace

TEST(SpaceEffects, HostileReadingsAreRefusedOrGiveFiniteColumns) {
  int refused = 0, given = 0;
  for (const Observations& o : hostile_tables())
    for (const auto* kinds : {&space_kinds, &set_up_kinds, &ball_kinds})
      for (const std::string& kind : *kinds) {
        const Effect& e = effect(kind);
        Names names = e.instances(o);
        const std::size_t shown = names.size();
        for (const char* other : {"", "X", "XY", "EYX", "E", "EXX", "EQX", "C", "L", "PPP"})
          names.push_back(other);
        for (std::size_t n = 0; n < names.size(); ++n) {
          e.applies(o, named(names[n]));
          std::vector<std::vector<double>> shapes = {{}, {nan}, {-1.0}, {1e300}, {1.0}, {3.0}};
          for (const auto& shape : e.shapes)
            for (const double value : shape.grid(o, named(names[n]))) shapes.push_back({value});
          for (const auto& shape : shapes) {
            const auto columns = e.columns(o, named(names[n]), shape);
            ++(columns ? given : refused);
            if (!columns || n >= shown) continue;
            for (const auto& column : *columns) {
              EXPECT_EQ(column.size(), o.size()) << kind;
              for (const double v : column) EXPECT_TRUE(std::isfinite(v)) << kind;
            }
          }
        }
      }
  EXPECT_GT(refused, 100);
  EXPECT_GT(given, 100);
}

}  // namespace nonio::space_hostile_test
