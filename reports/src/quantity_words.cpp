// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/quantity_words.h"

#include <algorithm>
#include <cmath>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"

namespace nonio::reports {

std::string followed_quantity(const Wording& site, const std::string& quantity) {
  const auto colon = quantity.find(':');
  const std::string kind = quantity.substr(0, colon);
  // A value of a rule, such as "iso-1988:A", is printed with the name of the standard.
  if (const std::string rule = site.get_or("site.rule." + kind, "");
      !rule.empty() && colon != std::string::npos) {
    const std::string symbol = quantity.substr(colon + 1);
    return (symbol.starts_with("+-") ? "± " + symbol.substr(2) : symbol) + ", " + rule;
  }
  const std::string name = site.get_or("site.quantity." + kind, quantity);
  if (name == quantity || colon == std::string::npos) return name;
  // In "straightness:Z.curve_2", Z is the axis and curve_2 the part of the curve.
  const auto dot = quantity.find('.', colon);
  const std::string of = name + " " + quantity.substr(colon + 1, dot - colon - 1);
  if (dot == std::string::npos || quantity.substr(dot + 1) == "c") return of;
  const std::string part = quantity.substr(dot + 1);
  return of + ", " + site.get_or("site.part." + part, part);
}

bool is_log_of_scatter(const std::string& quantity) {
  return quantity == "ln_s" || quantity.ends_with(".ln_s");
}

namespace {

constexpr double twice = 2.0;

std::string with_unit(const std::string& number, Quantity q) {
  const std::string unit = unit_text(q);
  return unit.empty() ? number : number + " " + unit;
}

/// Straightness and squareness never have angular deviations.
bool has_angles(const HistorySeries& s, const std::vector<HistorySeries>& of_machine) {
  return s.quantity.find(':') == std::string::npos &&
         std::any_of(of_machine.begin(), of_machine.end(), [&](const HistorySeries& other) {
           return other.axis == s.axis && (other.unit == Quantity::angular_deviation ||
                                           other.unit == Quantity::deviation_per_angle);
         });
}

}  // namespace

std::string scatter_text(const Wording& site, double log_of_scatter, double u) {
  return site.get("site.interval", {{"value", factor_text(site, log_of_scatter)},
                                    {"low", factor_text(site, log_of_scatter - twice * u)},
                                    {"high", factor_text(site, log_of_scatter + twice * u)}});
}

std::string factor_text(const Wording& site, double difference) {
  return localised(short_text(std::exp(difference), 3), site.language());
}

std::string factor_text(const Wording& site, double difference, double u) {
  return site.get("site.factor", {{"factor", factor_text(site, difference)},
                                  {"low", factor_text(site, difference - twice * u)},
                                  {"high", factor_text(site, difference + twice * u)}});
}

FollowedNumbers::FollowedNumbers(const std::string& quantity, Quantity unit, bool of_angles,
                                 const Wording& site)
    : quantity_(unit), is_scatter_(is_log_of_scatter(quantity)), site_(site) {
  if (is_scatter_) quantity_ = of_angles ? Quantity::angular_deviation : Quantity::deviation;
}

FollowedNumbers::FollowedNumbers(const HistorySeries& series,
                                 const std::vector<HistorySeries>& of_machine, const Wording& site)
    : FollowedNumbers(series.quantity, series.unit, has_angles(series, of_machine), site) {}

double FollowedNumbers::in_unit(double value) const {
  return is_scatter_ ? std::exp(value) : value * unit_of(quantity_).per_si;
}

std::string FollowedNumbers::number(double value, double u) const {
  if (is_scatter_) return u > 0.0 ? scatter_text(site_, value, u) : factor_text(site_, value);
  const Printed shown = printed_result(value, u > 0.0 ? std::optional(twice * u) : std::nullopt,
                                       quantity_, site_.language());
  return shown.U.empty() ? shown.value : shown.value + " ± " + shown.U;
}

std::string FollowedNumbers::value(double value, double u) const {
  return with_unit(number(value, u), quantity_);
}

std::string FollowedNumbers::difference(double size, double u) const {
  return is_scatter_ ? factor_text(site_, size, u) : value(size, u);
}

std::string FollowedNumbers::size(double size) const {
  if (is_scatter_) return "× " + factor_text(site_, std::fabs(size));
  const double shown = size * unit_of(quantity_).per_si, magnitude = std::fabs(shown);
  constexpr double least = 1e-8, exponent_below = 1e-4;  // two digits instead of an exponent
  const bool is_tiny = magnitude >= least && magnitude < exponent_below;
  std::string out =
      localised(is_tiny ? fixed_text(shown, 1 - static_cast<int>(std::floor(std::log10(magnitude))))
                        : short_text(shown),
                site_.language());
  if (out.starts_with('-')) out.replace(0, 1, "\u2212");
  return with_unit(out, quantity_);
}

std::string event_text(const Wording& site, const std::string& event) {
  const std::string kind = event.substr(0, event.find(": "));
  return site.get_or("site.event." + kind, kind) + event.substr(kind.size());
}

}  // namespace nonio::reports
