// SPDX-License-Identifier: Apache-2.0
// Errors of the linear axes that measure ball centers distort the circle into an ellipse. A machine
// with axis errors e measures P - e at P. n: direction of sensing; x, y, z: position, m:
//     linear-squareness  XY: +c y n_x   XZ: -c z n_x   YZ: +c z n_y   (signs as squareness, rad)
//     linear-scale       X: -k x n_x, and so on   (k: m/m, as scale)
#include "nonio/sdk/space_readings.h"

namespace nonio::linear_errors {

namespace {

struct Pair {
  const char* name;
  std::size_t error, lever;
  double sign;
};
constexpr Pair squares[] = {{"XY", 0, 1, +1.0}, {"XZ", 0, 2, -1.0}, {"YZ", 1, 2, +1.0}};
constexpr Pair scales[] = {{"X", 0, 0, -1.0}, {"Y", 1, 1, -1.0}, {"Z", 2, 2, -1.0}};

/// Whether the ball moves far enough along both coordinates to determine the effect.
bool seen(const SpaceReadings& s, const Pair& pair) {
  const double widest = *std::max_element(s.length.begin(), s.length.end());
  return s.length[pair.lever] > 0.05 * widest && s.length[pair.error] > 0.05 * widest;
}

template <std::size_t n>
Effect effect_of(const char* kind, const char* summary, Effect::Parameter parameter,
                 const Pair (&pairs)[n]) {
  Effect e;
  e.info = {kind, "1.0.0", summary};
  e.linear = {std::move(parameter)};
  e.applies = [](const Observations&, const Axis&) { return true; };
  e.columns = [kind, &pairs](const Observations& o, const Axis& place,
                             const std::vector<double>&) -> Expected<Effect::Columns> {
    const SpaceReadings s = space_of(o);
    for (const Pair& pair : pairs) {
      if (place.name != pair.name) continue;
      Effect::Columns out(1, std::vector<double>(o.size()));
      for (std::size_t i = 0; i < o.size(); ++i)
        out[0][i] = pair.sign * s.lever(pair.lever, i) * o.sense_of(i)[pair.error];
      return out;
    }
    return fail(std::string(kind) + ": cannot be of " + place.name);
  };
  e.instances = [&pairs](const Observations& o) {
    std::vector<std::string> names;
    if (!of_ball_centres(o)) return names;
    const SpaceReadings s = space_of(o);
    for (const Pair& pair : pairs)
      if (seen(s, pair)) names.emplace_back(pair.name);
    return names;
  };
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(effect_of("linear-squareness", "The axes that read the ball are not square",
                         {"c", "squareness (ISO 230-1: C0Y, B0Z, A0Z)", Quantity::small_angle},
                         squares));
  registry.add(effect_of("linear-scale", "An axis that reads the ball has a wrong scale",
                         {"k", "slope over the travel", Quantity::deviation_per_length}, scales));
}

}  // namespace nonio::linear_errors
