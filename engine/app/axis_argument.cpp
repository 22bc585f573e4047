// SPDX-License-Identifier: Apache-2.0
#include "axis_argument.h"

#include <charconv>
#include <cmath>

#include "nonio/sdk/units.h"

namespace nonio::app {

Expected<double> length_of(const std::string& option, const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && stop == end) return value / 1e3;
  return fail(option + ": expected a number in mm, with a point for decimals; found \"" + text +
              "\"");
}

bool is_axis_name(const std::string& name) {
  return !name.empty() &&
         name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") == std::string::npos;
}

Axis axis_named(const std::string& name) {
  return {.name = name,
          .rotary = !name.empty() && (name[0] == 'A' || name[0] == 'B' || name[0] == 'C')};
}

Expected<Axis> axis_of(const std::string& text) {
  const std::size_t equals = text.find('='), colon = text.find(':');
  const std::string name = text.substr(0, std::min(equals, text.size()));
  const auto wrong = [&] {
    return fail(
        "--axis: expected NAME=FROM:TO in mm or deg, FROM below TO, such as X=0:12000; found \"" +
        text + "\"");
  };
  if (equals == std::string::npos || colon == std::string::npos || colon < equals ||
      !is_axis_name(name))
    return wrong();
  const auto from = length_of("--axis", text.substr(equals + 1, colon - equals - 1));
  const auto to = length_of("--axis", text.substr(colon + 1));
  // The conditions are negated so that NaN is refused.
  if (!from || !to || !(*from < *to) || !std::isfinite(*from) || !std::isfinite(*to))
    return wrong();
  Axis axis = axis_named(name);
  const double per_mm = axis.rotary ? 1e3 / deg_per_rad : 1.0;
  axis.travel = {*from * per_mm, *to * per_mm};
  return axis;
}

}  // namespace nonio::app
