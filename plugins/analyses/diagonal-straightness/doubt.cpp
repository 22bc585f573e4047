// SPDX-License-Identifier: Apache-2.0
#include "doubt.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nonio::diagonal_straightness {

namespace {

using math::BudgetLine;
using math::MeanCurve;

class Lines {
 public:
  Lines(const Collected& c, const Campaign& campaign) : c_(c), r_(c.readings), in_(campaign) {}

  std::vector<BudgetLine> all() {
    const double step_x = r_.Lx / static_cast<double>(r_.n),
                 step_y = r_.Ly / static_cast<double>(r_.n);
    for (const math::PitchLine& y : r_.Y) put(along(y, step_y), 0, {0.0, 1.0});
    std::size_t group = 1;
    for (std::size_t k = 0; k < r_.X.size(); ++k) {
      if (k > 0 && r_.X[k].across != r_.X[k - 1].across) ++group;
      put(along(r_.X[k], step_x), group, {1.0, 0.0});
    }
    ++group;
    for (const MeanCurve& yaw : r_.ECX)
      put_other(along(yaw, step_x), BudgetLine::Kind::angle, group);
    for (const math::GridLine* line : lines()) {
      BudgetLine of = begin(*line);
      for (std::size_t j = 0; j < line->ix.size(); ++j)
        of.length.push_back(std::hypot(step_x * (number(line->ix[j]) - number(line->ix[0])),
                                       step_y * (number(line->iy[j]) - number(line->iy[0]))));
      put(std::move(of), ++group, {line->cx, line->cy});
    }
    for (const auto& [direct, step] : {std::pair{&r_.EYX, step_x}, std::pair{&r_.EXY, step_y}})
      if (*direct) {
        put_other(along(**direct, step), BudgetLine::Kind::lateral, ++group);
        if (const auto& turned = (*direct)->reversed)
          put_other(along(*turned, step), BudgetLine::Kind::lateral, ++group);
      }
    // One curve without repetition: then the residuals of all give the noise.
    if (std::any_of(out_.begin(), out_.end(), [](const BudgetLine& l) { return l.u == 0.0; }))
      for (BudgetLine& line : out_) line.u = 0.0;
    return std::move(out_);
  }

 private:
  static double number(std::size_t i) { return static_cast<double>(i); }
  std::vector<const math::GridLine*> lines() const {
    std::vector<const math::GridLine*> all{&r_.D1, &r_.D2};
    for (const math::GridLine& line : r_.third) all.push_back(&line);
    return all;
  }
  static BudgetLine begin(const MeanCurve& curve) {
    BudgetLine line;
    line.zeroed = curve.zeroed;
    line.u = curve.u;
    line.dof = curve.dof;
    line.visits = curve.visits;
    line.walk_seen = curve.walk_seen;
    return line;
  }
  static BudgetLine along(const MeanCurve& curve, double step) {
    BudgetLine line = begin(curve);
    for (std::size_t i = 0; i < curve.mean.size(); ++i) line.length.push_back(step * number(i));
    return line;
  }
  void put(BudgetLine line, std::size_t group, const std::array<double, 2>& direction) {
    line.group = group;
    const std::array<std::string, 2> axes{c_.x_axis, c_.y_axis};
    std::vector<std::string> moved;
    std::vector<double> share;
    for (std::size_t k = 0; k < 2; ++k)
      if (direction[k] != 0.0) moved.push_back(axes[k]), share.push_back(direction[k]);
    put_expansion(line, in_, moved, share);
    out_.push_back(std::move(line));
  }
  void put_other(BudgetLine line, BudgetLine::Kind kind, std::size_t group) {
    line.kind = kind;
    line.group = group;
    out_.push_back(std::move(line));
  }

  const Collected& c_;
  const math::DiagonalReadings& r_;
  const Campaign& in_;
  std::vector<BudgetLine> out_;
};

}  // namespace

std::vector<BudgetLine> budget_lines(const Collected& c, const Campaign& campaign) {
  return Lines(c, campaign).all();
}

std::vector<const Observations*> observations_of(const AnalysisInput& in,
                                                 const std::vector<std::string>& uses) {
  std::vector<const Observations*> out{&in.observations};
  for (std::size_t i = 0; i < in.all->size(); ++i)
    if (std::find(uses.begin(), uses.end(), in.campaign.measurements[i].id) != uses.end())
      out.push_back(&(*in.all)[i]);
  return out;
}

}  // namespace nonio::diagonal_straightness
