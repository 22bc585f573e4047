// SPDX-License-Identifier: Apache-2.0
#include "centres.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace nonio::rotary_kinematics {
namespace {

const Observations::AxisColumn* column(const Observations& o, std::string_view axis) {
  for (const auto& c : o.axes)
    if (c.axis == axis) return &c;
  return nullptr;
}

}  // namespace

tl::expected<std::vector<math::BallCentre>, Finding> centres_of(const Observations& o) {
  const auto *x = column(o, "X"), *y = column(o, "Y"), *z = column(o, "Z");
  std::vector<math::BallCentre> out;
  if (x == nullptr || y == nullptr || z == nullptr || o.axes.empty()) return out;
  const auto& rotary = o.axes.front();
  std::map<long long, math::BallCentre> places;
  std::set<std::tuple<std::uint32_t, int, double>> seen;
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (o.line_of(i) != 0) continue;  // three readings a centre, each with the whole position
    const double angle = rotary.position[i];
    const int approach = rotary.approach.empty() ? 0 : rotary.approach[i];
    if (!std::isfinite(angle) || !seen.emplace(o.run_of(i), approach, angle).second) {
      Finding repeated{.id = "rotary.repeated-angles", .attention = true};
      repeated.evidence = {{"angle", std::isfinite(angle) ? angle : 0.0, Quantity::angle},
                           {"run", static_cast<double>(o.run_of(i)), Quantity::count},
                           {"line", static_cast<double>(o.source_line_of(i)), Quantity::count}};
      return tl::unexpected(std::move(repeated));
    }
    math::BallCentre& c =
        places.try_emplace(math::place_in_turn(angle), math::BallCentre{{}, angle, 0.0})
            .first->second;
    c.weight += 1.0;
    const math::Vector3 at{x->position[i], y->position[i], z->position[i]};
    for (std::size_t k = 0; k < 3; ++k) c.at[k] += (at[k] - c.at[k]) / c.weight;
  }
  for (const auto& [place, centre] : places) out.push_back(centre);
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.angle < b.angle; });
  return out;
}

}  // namespace nonio::rotary_kinematics
