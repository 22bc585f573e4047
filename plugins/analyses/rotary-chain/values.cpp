// SPDX-License-Identifier: Apache-2.0
// Values of a chain: point and direction of each axis, relation of the two axes, and for a head the
// distance from the axis to the tool.
#include <algorithm>

#include "chain.h"

namespace nonio::rotary_chain {
namespace {

using math::ChainLine;
using math::ChainState;
using math::Vector3;

double length(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }
Vector3 minus(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector3 times(double f, const Vector3& v) { return {f * v[0], f * v[1], f * v[2]}; }

Vector3 anchor(const Chain& chain, const ChainState& s, std::size_t axis) {
  return chain.is_head(axis) ? Vector3{} : s.ball.front();
}

/// Vector from the spindle nose to the tip of the first tool with the heads at 0. Its length is
/// `length_of`; its direction is the line through both tips, or the stated offset.
Vector3 tool_vector(const Places& places, const Tools& tools, const ChainState& s,
                    double length_of) {
  Vector3 along{};
  if (tools.two) {
    along = minus(s.tool[tools.to], s.tool[tools.from]);
  } else {
    for (const auto& [axis, offset] : places.tools.front()->tool_offset)
      if (const std::size_t k = coordinate_of(axis); k < 3) along[k] = offset;
  }
  return times(length_of / length(along), along);
}

/// Uses the components perpendicular to the axis, because the component along it varies little.
bool identifies_direction(const math::ChainFit& fit, std::size_t axis) {
  return std::all_of(fit.across[axis].begin(), fit.across[axis].end(), [&](std::size_t k) {
    return math::chain_value(fit, [&](const ChainState& s) { return s.lines[axis].direction[k]; })
        .identifiable;
  });
}

void put_line(const Chain& chain, const math::ChainFit& fit, std::size_t axis,
              std::vector<Candidate>& out) {
  const std::string& name = chain.axes[axis];
  const auto centre = [&chain, axis](const ChainState& s) {
    return math::nearest_on(s.lines[axis], anchor(chain, s, axis));
  };
  for (std::size_t k = 0; k < 3; ++k)
    out.push_back({std::string("centre_") + "xyz"[k] + "_" + name, Quantity::length,
                   math::chain_value(fit, [&](const ChainState& s) { return centre(s)[k]; })});
  const bool identifiable = identifies_direction(fit, axis);
  for (std::size_t k = 0; k < 3; ++k) {
    auto value =
        math::chain_value(fit, [&](const ChainState& s) { return s.lines[axis].direction[k]; });
    value.identifiable = identifiable;
    out.push_back(
        {std::string("direction_") + "ijk"[k] + "_" + name, Quantity::number, std::move(value)});
  }
  out.push_back(
      {"radius_" + name, Quantity::length, math::chain_value(fit, [&](const ChainState& s) {
         return length(minus(anchor(chain, s, axis), centre(s)));
       })});
}

/// Pivot lengths from the spindle nose, to which a tool length refers.
void put_pivots(const Chain& chain, const Places& places, const math::ChainFit& fit,
                std::vector<Candidate>& out) {
  if (places.tools.empty() || !(tool_length(*places.tools.front()) > 0.0)) return;
  const Tools tools = tools_of(places);
  const double stated = tool_length(*places.tools.front());
  const auto pivot = [&](std::size_t axis, double length_of) {
    return [&, axis, length_of](const ChainState& s) {
      const Vector3 nose = times(-1.0, tool_vector(places, tools, s, length_of));
      return length(minus(nose, math::nearest_on(s.lines[axis], nose)));
    };
  };
  for (std::size_t axis = chain.tables; axis < chain.axes.size(); ++axis) {
    Candidate c{"pivot_" + chain.axes[axis], Quantity::length,
                math::chain_value(fit, pivot(axis, stated))};
    constexpr double step = 1e-6;
    c.by_tool = (pivot(axis, stated + step)(fit.state) - pivot(axis, stated - step)(fit.state)) /
                (2.0 * step);
    out.push_back(std::move(c));
  }
  for (std::size_t k = 0; tools.two && k < 3; ++k)
    out.push_back({std::string("tool_") + "ijk"[k], Quantity::number,
                   math::chain_value(fit, [&](const ChainState& s) {
                     return tool_vector(places, tools, s, 1.0)[k];
                   })});
}

}  // namespace

double tool_length(const Measurement& m) {
  double square = 0.0;
  for (const auto& [axis, offset] : m.tool_offset) square += offset * offset;
  return std::sqrt(square);
}

Tools tools_of(const Places& places) {
  Tools out;
  constexpr double least = 1e-3;  // m, smallest length difference that determines a direction
  for (std::size_t a = 0; a < places.tools.size(); ++a)
    for (std::size_t b = 0; b < places.tools.size(); ++b) {
      const double from = tool_length(*places.tools[a]), to = tool_length(*places.tools[b]);
      if (!(from > 0.0) || !(to - from > std::max(least, out.stated))) continue;
      out = {true, a, b, to - from};
    }
  return out;
}

std::vector<Candidate> candidates(const Chain& chain, const Places& places,
                                  const math::ChainFit& fit) {
  std::vector<Candidate> out;
  bool identifiable = true;
  for (std::size_t axis = 0; axis < chain.axes.size(); ++axis) {
    put_line(chain, fit, axis, out);
    identifiable = identifiable && identifies_direction(fit, axis);
  }
  // The linear axes move a head relative to a table, so their axes have an angle but no distance.
  if (chain.is_head(0) == chain.is_head(1)) {
    auto distance = math::chain_value(
        fit, [](const ChainState& s) { return math::signed_distance(s.lines[0], s.lines[1]); });
    distance.identifiable = distance.identifiable && identifiable;
    if (distance.value < 0.0) {
      distance.value = -distance.value;
      for (double& by : distance.by) by = -by;
    }
    out.push_back({"distance", Quantity::length, std::move(distance)});
  }
  auto angle = math::chain_value(
      fit, [](const ChainState& s) { return math::angle_between(s.lines[0], s.lines[1]); });
  angle.identifiable = angle.identifiable && identifiable;
  out.push_back({"angle", Quantity::angle, std::move(angle)});
  put_pivots(chain, places, fit, out);
  return out;
}

}  // namespace nonio::rotary_chain
