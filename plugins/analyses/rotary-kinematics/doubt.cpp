// SPDX-License-Identifier: Apache-2.0
#include "doubt.h"

#include <algorithm>

#include "nonio/math/probed.h"

namespace nonio::rotary_kinematics {

namespace {

constexpr std::size_t most_residuals = 500;  // a table of this many times three times as many

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
  math::ProbedPlaces places;
  places.linear_axes = linear_axes;
  places.linear_axes_key = "options.rotary-kinematics.linear_axes_urad";
  for (const Judged* j : circles) {
    for (const math::BallCentre& centre : j->centres) places.at.push_back(centre.at);
    for (std::size_t k = 0; k < 3; ++k)
      places.middle[k] += j->fit.centre[k] / static_cast<double>(circles.size());
    places.radius = std::max(places.radius, j->fit.radius);
  }
  return math::probed_model(c, e, places);
}

Derivatives::Row chain(const Derivatives& d, const std::array<double, 6>& by_line) {
  Derivatives::Row out(d.radius.size(), 0.0);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      out[i] += by_line[k] * d.centre[k][i] + by_line[3 + k] * d.direction[k][i];
  return out;
}

}  // namespace nonio::rotary_kinematics
