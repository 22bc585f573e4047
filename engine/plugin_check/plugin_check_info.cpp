// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "campaign/config/manifest.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

bool is_plain(std::string_view name, bool capitals, std::string_view also) {
  const auto letter = [&](char c) {
    return (c >= 'a' && c <= 'z') || (capitals && c >= 'A' && c <= 'Z');
  };
  return !name.empty() && name.size() <= 60 && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) {
           return letter(c) || (c >= '0' && c <= '9') || also.find(c) != also.npos;
         });
}

bool is_version(std::string_view version) {
  return !version.empty() && version.front() != '.' && version.back() != '.' &&
         version.find_first_not_of("0123456789.") == version.npos;
}

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

Verdict check_names(const Info& info, const Bench&) {
  if (!is_plain(info.name, false, "-"))
    return failed("the name " + quoted(info.name) +
                  ": expected small letters, digits and '-', a letter first");
  if (!is_version(info.version))
    return failed("the version " + quoted(info.version) + ": expected numbers and dots");
  if (info.summary.empty() || info.summary.find('\n') != info.summary.npos)
    return failed("no summary: expected one sentence");
  std::set<std::string> seen;
  for (const Option& o : info.options) {
    if (!is_plain(o.name, true, "_"))
      return failed("the option " + quoted(o.name) + ": expected letters, digits and '_'");
    if (!seen.insert(o.name).second) return failed("two options are called " + quoted(o.name));
  }
  return passed();
}

/// "mm" for "depth_mm"; empty if the name ends with no unit.
std::string unit_in_name(std::string_view name) {
  static constexpr std::string_view units[] = {"mm",   "um",     "deg", "arcsec", "urad", "s",
                                               "degC", "kelvin", "K",   "rad",    "m",    "h"};
  if (name.ends_with("_um_per_m_K")) return "um/(m K)";
  for (const std::string_view unit : units)
    if (name.size() > unit.size() + 1 && name.ends_with(unit) &&
        name[name.size() - unit.size() - 1] == '_')
      return std::string(unit);
  return {};
}

bool is_empty(const Setting& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return text->empty();
  const auto* number = std::get_if<double>(&value);
  const auto* whole = std::get_if<std::int64_t>(&value);
  return (number != nullptr && *number == 0.0) || (whole != nullptr && *whole == 0);
}

}  // namespace

std::string wrong_option(const Option& o, bool may_be_absent) {
  if (o.help.empty()) return "has no help: expected one sentence";
  const bool number = std::holds_alternative<double>(o.default_value) ||
                      std::holds_alternative<std::vector<double>>(o.default_value);
  if (const std::string unit = unit_in_name(o.name); number && !unit.empty() && o.unit != unit)
    return "ends in _" + unit + ", its unit is " + quoted(o.unit) + ": expected " + quoted(unit);
  const Settings own{{{o.name, o.default_value}}};
  const double value = own.number(o.name, 0.0);
  if (!std::isfinite(value)) return "has a default that is not a number";
  if (o.min && o.max && !(*o.min <= *o.max)) return "has its least value above its most";
  std::set<std::string> choices(o.choices.begin(), o.choices.end());
  if (choices.size() != o.choices.size()) return "has the same choice twice";
  if (may_be_absent && is_empty(o.default_value)) return {};
  const Info one{"x", "1", "x", {o}};
  const config::RawOptions raw{{"x", {{o.name, {o.default_value, "", 0}}}}};
  if (const auto settled = config::settle_options(one, raw, {}); !settled)
    return "has a default that it does not allow: " + settled.error().front().message;
  return {};
}

namespace {

Verdict check_options(const Info& info, const Bench&) {
  if (info.options.empty()) return skipped("it has no options");
  for (const Option& o : info.options)
    if (const std::string why = wrong_option(o, false); !why.empty())
      return failed("option " + quoted(o.name) + " " + why);
  return passed();
}

}  // namespace

const std::vector<Check<Info>>& info_checks() {
  static const std::vector<Check<Info>> checks = {
      {"names", "Names are plain and unique; version and summary are present.", check_names},
      {"options", "Options have help and units; defaults are within ranges and choices.",
       check_options}};
  return checks;
}

}  // namespace nonio::plugin_check::kit
