// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/cmc.h"

#include <algorithm>

namespace nonio::evaluation {

namespace {

/// The smallest U of this quantity; 0 if none is stated.
double floor_of(const Cmc& cmc, Quantity q, double length) {
  switch (q) {
    case Quantity::length:
    case Quantity::deviation:
      return cmc.fixed.value_or(0.0) + cmc.per_length.value_or(0.0) * length;
    case Quantity::angle:
    case Quantity::angular_deviation:
    case Quantity::small_angle:
    case Quantity::number:  // components of a direction
      return cmc.angle.value_or(0.0);
    default:
      return 0.0;
  }
}

}  // namespace

void apply_cmc(const Laboratory& laboratory, double length, Evaluation& e) {
  if (laboratory.accreditation.empty() || !laboratory.cmc.stated()) return;
  std::string raised;
  const auto raise = [&](double& U, Quantity q) {
    const double least = floor_of(laboratory.cmc, q, length);
    const bool below = U < least;
    if (below) U = least;
    return below;
  };
  const auto note = [&](const std::string& name) { raised += (raised.empty() ? "" : ", ") + name; };
  for (Value& v : e.values)
    if (v.U && raise(*v.U, v.quantity)) {
      v.k = 2.0;  // that of [laboratory.cmc]
      note(v.name);
    }
  for (PointTable::Column& c : e.points.columns)
    if (c.U) raise(*c.U, c.quantity);
  for (Series& s : e.series) {
    bool any = false;
    for (double& U : s.U) any = raise(U, s.quantity) || any;
    if (any) note(s.name);
  }
  if (!raised.empty())
    e.findings.push_back({.id = "uncertainty.cmc", .texts = {{"results", std::move(raised)}}});
}

}  // namespace nonio::evaluation
