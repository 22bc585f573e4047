// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/triples.h"

namespace nonio::math {

PointTable triple_table(const std::vector<TriplePlan>& plans) {
  PointTable rows;
  const auto column = [&](const char* name, Quantity quantity, auto value_of) {
    PointTable::Column c{name, quantity, {}};
    for (const TriplePlan& p : plans) c.values.push_back(static_cast<double>(value_of(p)));
    rows.columns.push_back(std::move(c));
  };
  using P = TriplePlan;
  column("a", Quantity::count, [](const P& p) { return p.a; });
  column("b", Quantity::count, [](const P& p) { return p.b; });
  column("c", Quantity::count, [](const P& p) { return p.c; });
  column("q", Quantity::count, [](const P& p) { return p.q; });
  column("n", Quantity::count, [](const P& p) { return p.n; });
  column("step_x", Quantity::length, [](const P& p) { return p.step_x; });
  column("step_y", Quantity::length, [](const P& p) { return p.step_y; });
  column("step_d", Quantity::length, [](const P& p) { return p.step_d; });
  column("length_x", Quantity::length, [](const P& p) { return p.length_x; });
  column("length_y", Quantity::length, [](const P& p) { return p.length_y; });
  column("length_d", Quantity::length, [](const P& p) { return p.length_d; });
  column("cover_x", Quantity::ratio, [](const P& p) { return p.cover_x; });
  column("cover_y", Quantity::ratio, [](const P& p) { return p.cover_y; });
  column("gain_EYX", Quantity::ratio, [](const P& p) { return p.gain_EYX(); });
  column("gain_EXY", Quantity::ratio, [](const P& p) { return p.gain_EXY(); });
  column("gain_EYX_even", Quantity::ratio, [](const P& p) { return p.gain_EYX_even(); });
  column("gain_EXY_even", Quantity::ratio, [](const P& p) { return p.gain_EXY_even(); });
  return rows;
}

}  // namespace nonio::math
