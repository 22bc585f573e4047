// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/number.h"

#include <algorithm>
#include <cmath>

#include "nonio/sdk/format.h"

namespace nonio::reports {
namespace {

constexpr double largest_plain = 1e9;
constexpr const char* dash = "–";

/// The minus sign is U+2212, which a PDF maps back to "-" when copied.
std::string typeset(std::string number, std::string_view language) {
  number = localised(std::move(number), language);
  std::string out;
  for (const char c : number)
    if (c == '-')
      out += "\u2212";
    else
      out += c;
  return out;
}

std::string rounded_text(double printed_value, int place, std::string_view language) {
  if (!std::isfinite(printed_value)) return dash;
  if (std::fabs(printed_value) >= largest_plain)
    return typeset(short_text(printed_value, 4), language);
  return typeset(nonio::rounded_text(printed_value, place), language);
}

double rounded_at(double value, int place) {
  if (place <= 0) return rounded_to_places(value, -place);
  const double unit = std::pow(10.0, place);
  return std::round(value / unit) * unit;
}

/// Place of the last digit, at most `place`, at which the rounded magnitude is on the same side of
/// the limit as the magnitude.
int place_that_shows(double value, double limit, int place) {
  constexpr int least = -9;
  const auto side = [&](double x) { return (std::fabs(x) > limit) - (std::fabs(x) < limit); };
  while (place > least && side(rounded_at(value, place)) != side(value)) --place;
  return place;
}

}  // namespace

Printed printed_result(double value, std::optional<double> U, Quantity quantity,
                       std::string_view language, std::optional<double> limit) {
  if (quantity == Quantity::count) return {printed_number(value, quantity, 0, language), ""};
  const double shown = printed(value, quantity);
  const double shown_U = U ? printed(*U, quantity) : 0.0;
  if (!(shown_U > 0.0) || !std::isfinite(shown_U))
    return {rounded_text(shown, quantity == Quantity::time ? -1 : -3, language), ""};
  const int place = std::max(place_of_second_digit(shown_U), -9);
  const int place_of_value = limit && std::isfinite(shown)
                                 ? place_that_shows(shown, printed(*limit, quantity), place)
                                 : place;
  return {rounded_text(shown, place_of_value, language), rounded_text(shown_U, place, language)};
}

std::string printed_number(double si, Quantity quantity, int decimals, std::string_view language) {
  return rounded_text(printed(si, quantity), -decimals, language);
}

int decimals_for(const std::vector<double>& si, Quantity quantity, int most) {
  int decimals = 0;
  for (const double v : si) {
    const double value = printed(v, quantity);
    if (!(std::fabs(value) < largest_plain)) continue;
    for (double scale = std::pow(10.0, decimals); decimals < most; ++decimals, scale *= 10.0)
      if (std::fabs(value * scale - std::nearbyint(value * scale)) < 1e-6) break;
  }
  return decimals;
}

std::string unit_text(Quantity quantity) {
  switch (quantity) {
    case Quantity::deviation:
      return "µm";
    case Quantity::angle:
      return "°";
    case Quantity::small_angle:
      return "µrad";
    case Quantity::deviation_per_length:
      return "µm/m";
    case Quantity::deviation_per_angle:
      return "arcsec/°";
    case Quantity::expansion:
      return "µm/(m·K)";
    case Quantity::deviation_per_time:
      return "µm/h";
    case Quantity::deviation_per_kelvin:
      return "µm/K";
    case Quantity::growth:
      return "µm/(m·h)";
    case Quantity::angular_growth:
      return "arcsec/(°·h)";
    case Quantity::angular_expansion:
      return "arcsec/(°·K)";
    case Quantity::deviation_per_reading:
      return "µm/reading";
    case Quantity::angle_per_reading:
      return "arcsec/reading";
    case Quantity::growth_per_reading:
      return "µm/(m·reading)";
    case Quantity::angular_growth_per_reading:
      return "arcsec/(°·reading)";
    case Quantity::temperature:
      return "°C";
    default:
      return std::string(unit_of(quantity).symbol);
  }
}

}  // namespace nonio::reports
