// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/axes.h"

#include <set>

#include "nonio/controllers/text.h"

namespace nonio::controllers {
namespace {

// Adds the keys that all controls accept because they describe the machine. Empty if any key is
// allowed.
std::set<std::string> full_keys(const std::vector<std::string_view>& keys) {
  std::set<std::string> out;
  if (!keys.empty())
    out = {"drifted",     "number",         "reference_mm",   "reference_deg",
           "backlash_mm", "backlash_deg",   "from_mm",        "from_deg",
           "to_mm",       "to_deg",         "resolution_um",  "resolution_arcsec",
           "largest_um",  "largest_arcsec", "slope_um_per_m", "slope_arcsec_per_deg"};
  for (const std::string_view k : keys) {
    if (k.back() == ':') {
      out.emplace(k.substr(0, k.size() - 1));
    } else {
      out.insert(std::string(k) + "_mm");
      out.insert(std::string(k) + "_deg");
    }
  }
  return out;
}

}  // namespace

std::optional<double> KnownAxis::setting(std::string_view key) const {
  const auto it = settings.find(key);
  return it == settings.end() ? std::nullopt : std::optional(it->second);
}

std::optional<double> KnownAxis::position_setting(std::string_view key) const {
  const auto value = setting(std::string(key) + (rotary ? "_deg" : "_mm"));
  return value ? std::optional(*value / per_si()) : std::nullopt;
}

tl::unexpected<Error> wrong_axes(std::string message, const std::string& key) {
  Error error{std::move(message)};
  error.key = key.empty() ? "axes" : "axes." + key;
  return fail(std::move(error));
}

Expected<NumberTables> settings_of_axes(const Settings& options,
                                        const std::vector<std::string_view>& keys) {
  NumberTables tables = options.tables("axes");
  const std::set<std::string> known = full_keys(keys);
  for (const auto& [axis, settings] : tables)
    for (const auto& [key, value] : settings)
      if (!known.empty() && !known.contains(key))
        return wrong_axes("option axes, axis " + axis + ": no setting " + key + "; there are " +
                              joined({known.begin(), known.end()}, ", "),
                          axis + "." + key);
  return tables;
}

Expected<std::vector<KnownAxis>> known_axes(const TableInput& in) {
  NONIO_TRY(auto settings, settings_of_axes(in.options));
  std::vector<KnownAxis> axes;
  for (const Axis& a : in.campaign.machine.axes) {
    KnownAxis axis{a.name, 0, a.rotary, settings[a.name]};
    if (const auto n = axis.setting("number"); n && *n >= 1.0 && *n < 1e6)
      axis.number = static_cast<std::size_t>(*n);
    axes.push_back(std::move(axis));
  }
  return axes;
}

KnownAxis axis_numbered(const std::vector<KnownAxis>& axes, std::size_t number) {
  for (const KnownAxis& a : axes)
    if (number != 0 && a.number == number) return a;
  return {std::to_string(number), number, false, {}};
}

KnownAxis axis_of_file(const std::vector<KnownAxis>& axes, std::string_view file,
                       std::string_view prefix) {
  const bool ours = file.rfind(prefix, 0) == 0;
  if (!ours) return axes.size() == 1 ? axes.front() : KnownAxis{std::string(file), 0, false, {}};
  std::string_view stem = file.substr(prefix.size());
  stem = stem.substr(0, stem.rfind('.'));
  const KnownAxis* found = nullptr;
  for (const KnownAxis& a : axes) {
    const std::string part = file_part(a.name);
    const bool fits = stem == part || stem.rfind(part + "-", 0) == 0;
    if (fits && (found == nullptr || part.size() > file_part(found->name).size())) found = &a;
  }
  return found != nullptr ? *found : KnownAxis{std::string(stem), 0, false, {}};
}

KnownAxis axis_named(const std::vector<KnownAxis>& axes, std::string_view name) {
  for (const KnownAxis& a : axes)
    if (plain(a.name) == name) return a;
  return {std::string(name), 0, false, {}};
}

}  // namespace nonio::controllers
