// SPDX-License-Identifier: Apache-2.0
#include "doubt.h"

#include <cmath>
#include <numbers>

namespace nonio::rotary {

namespace {

constexpr std::size_t most_residuals = 500;  // a table of this many times three times as many

/// The name of the machine's axis along a coordinate: "X", or "X1" where there is no X.
std::string axis_along(const Campaign& c, std::size_t coordinate) {
  const std::string letter(1, "XYZ"[coordinate]);
  if (c.machine.axis(letter) != nullptr) return letter;
  for (const Axis& axis : c.machine.axes)
    if (!axis.rotary && coordinate_of(axis.name) == coordinate) return axis.name;
  return letter;
}

std::size_t count(const std::vector<const Judged*>& circles) {
  std::size_t n = 0;
  for (const Judged* j : circles) n += j->centres.size();
  return n;
}

/// Coordinate `by`, less that of the middle of the circles, as the error of coordinate `of`.
std::vector<double> pattern(const std::vector<const Judged*>& circles, std::size_t of,
                            std::size_t by, double u) {
  const std::size_t n = count(circles);
  std::vector<double> out(3 * n, 0.0), at;
  double middle = 0.0;
  for (const Judged* j : circles) {
    for (const math::BallCentre& c : j->centres) at.push_back(c.at[by]);
    middle += j->fit.centre[by] / static_cast<double>(circles.size());
  }
  for (std::size_t i = 0; i < n; ++i) out[of * n + i] = u * (at[i] - middle);
  return out;
}

/// Squareness and scale differences of the axes that read the coordinates: within +-bound each.
math::ReadingModel::Input linear_axes_input(const std::vector<const Judged*>& circles,
                                            double bound) {
  const double u = bound / std::numbers::sqrt3;
  math::ReadingModel::Input input;
  double radius = 0.0;
  for (const Judged* j : circles) radius = std::max(radius, j->fit.radius);
  input.is = {.id = "linear-axes",
              .u = u * radius,
              .with_length = true,
              .distribution = Distribution::rectangular,
              .correlation = Correlation::device,
              .source = "options.rotary-kinematics.linear_axes_urad"};
  input.of_line.assign(3, u);
  for (const auto& [of, by] : {std::pair{0U, 1U}, {0U, 2U}, {1U, 2U}, {0U, 0U}, {1U, 1U}, {2U, 2U}})
    input.patterns.push_back(pattern(circles, of, by, u));
  return input;
}

}  // namespace

Derivatives derivatives_of(const Judged& judged, bool use_angles) {
  constexpr double step = 1e-5;  // m: far above rounding, far below the radius
  const std::size_t n = judged.centres.size();
  Derivatives d;
  for (auto* rows : {&d.centre, &d.direction})
    for (auto& row : *rows) row.assign(3 * n, 0.0);
  d.radius.assign(3 * n, 0.0);
  if (n <= most_residuals) d.radial.assign(n, Derivatives::Row(3 * n, 0.0));
  d.axial = d.radial;
  auto centres = judged.centres;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = k * n + i;
      for (const double sign : {1.0, -1.0}) {
        centres[i].at[k] = judged.centres[i].at[k] + sign * step;
        const auto fit = math::fit_rotary(centres, use_angles);
        if (!fit) continue;  // a fit that ended ends beside it too
        const double by = sign / (2.0 * step);
        for (std::size_t c = 0; c < 3; ++c) {
          d.centre[c][at] += by * fit->centre[c];
          d.direction[c][at] += by * fit->direction[c];
        }
        d.radius[at] += by * fit->radius;
        for (std::size_t p = 0; p < d.radial.size(); ++p) {
          d.radial[p][at] += by * fit->radial[p];
          d.axial[p][at] += by * fit->axial[p];
        }
      }
      centres[i].at[k] = judged.centres[i].at[k];
    }
  return d;
}

math::ReadingModel coordinate_model(const Campaign& c, const Environment& e,
                                    const std::vector<const Judged*>& circles,
                                    std::optional<double> linear_axes) {
  std::vector<math::BudgetLine> lines;
  for (std::size_t k = 0; k < 3; ++k) {
    math::BudgetLine line;
    line.kind = math::BudgetLine::Kind::coordinate;
    line.group = k;
    for (const Judged* j : circles)
      for (const math::BallCentre& centre : j->centres) line.length.push_back(centre.at[k]);
    const std::string axis = axis_along(c, k);
    const double whole = 1.0;
    put_expansion(line, c, {&axis, 1}, {&whole, 1});
    lines.push_back(std::move(line));
  }
  math::ReadingModel model = math::reading_model(c, e, std::move(lines));
  if (linear_axes)
    model.inputs.push_back(linear_axes_input(circles, *linear_axes));
  else
    model.missing.emplace_back("options.rotary-kinematics.linear_axes_urad");
  return model;
}

Derivatives::Row chain(const Derivatives& d, const std::array<double, 6>& by_line) {
  Derivatives::Row out(d.radius.size(), 0.0);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      out[i] += by_line[k] * d.centre[k][i] + by_line[3 + k] * d.direction[k][i];
  return out;
}

}  // namespace nonio::rotary
