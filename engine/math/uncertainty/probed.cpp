// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/probed.h"

#include <numbers>

namespace nonio::math {
namespace {

/// Returns "X" for coordinate 0 or, if the machine has no such axis, another linear axis along X
/// such as "X1"; "X" if there is none either.
std::string axis_along(const Campaign& c, std::size_t coordinate) {
  const std::string letter(1, "XYZ"[coordinate]);
  if (c.machine.axis(letter) != nullptr) return letter;
  for (const Axis& axis : c.machine.axes)
    if (!axis.rotary && coordinate_of(axis.name) == coordinate) return axis.name;
  return letter;
}

/// An error of coordinate `of` in proportion to coordinate `by`, relative to the middle.
std::vector<double> pattern(const ProbedPlaces& places, std::size_t of, std::size_t by, double u) {
  const std::size_t n = places.at.size();
  std::vector<double> out(3 * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) out[of * n + i] = u * (places.at[i][by] - places.middle[by]);
  return out;
}

/// Squareness and scale differences of the axes that measure the coordinates, within +-bound.
ReadingModel::Input linear_axes_input(const ProbedPlaces& places, double bound) {
  const double u = bound / std::numbers::sqrt3;
  ReadingModel::Input input;
  input.is = {.id = "linear-axes",
              .u = u * places.radius,
              .with_length = true,
              .distribution = Distribution::rectangular,
              .correlation = Correlation::device,
              .source = places.linear_axes_key};
  input.of_line.assign(3, u);
  for (const auto& [of, by] : {std::pair{0U, 1U}, {0U, 2U}, {1U, 2U}, {0U, 0U}, {1U, 1U}, {2U, 2U}})
    input.patterns.push_back(pattern(places, of, by, u));
  return input;
}

}  // namespace

ReadingModel probed_model(const Campaign& c, const Environment& e, const ProbedPlaces& places) {
  std::vector<BudgetLine> lines;
  for (std::size_t k = 0; k < 3; ++k) {
    BudgetLine line;
    line.kind = BudgetLine::Kind::coordinate;
    line.group = k;
    for (const auto& at : places.at) line.length.push_back(at[k]);
    const std::string axis = axis_along(c, k);
    const double whole = 1.0;
    put_expansion(line, c, {&axis, 1}, {&whole, 1});
    lines.push_back(std::move(line));
  }
  ReadingModel model = reading_model(c, e, std::move(lines));
  if (places.linear_axes)
    model.inputs.push_back(linear_axes_input(places, *places.linear_axes));
  else
    model.missing.push_back(places.linear_axes_key);
  return model;
}

}  // namespace nonio::math
