// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "campaign/config/machines.h"
#include "nonio/sdk/format.h"

namespace nonio::config {
namespace {

std::string in_digits(double value) {
  std::string text;
  append_shortest(text, value);
  return text;
}

std::uint64_t line_in(const KeyLines& lines, const std::string& key) {
  const auto found = lines.find(key);
  return found == lines.end() ? 0 : found->second;
}

std::string place_in(const MachineRecord& record, const std::string& key) {
  const std::uint64_t line = line_in(record.lines, key);
  return record.file + (line == 0 ? "" : ":" + std::to_string(line));
}

std::string key_of(const std::string& axis, const std::string& setting) {
  const bool travel = setting.starts_with("from_") || setting.starts_with("to_");
  return "axes." + axis + "." + (travel ? "travel" : setting);
}

/// Axes that the settings of the output may name, including slaves and the axes of measured lines.
std::set<std::string> axes_of(const Campaign& campaign) {
  std::set<std::string> names;
  for (const Axis& a : campaign.machine.axes) {
    names.insert(a.name);
    if (!a.slave.empty()) names.insert(a.slave);
  }
  for (const Measurement& m : campaign.measurements)
    for (const auto* ends : {&m.from, &m.to})
      for (const auto& [axis, position] : *ends) names.insert(axis);
  return names;
}

class Layers {
 public:
  Layers(const Info& output, const Manifest& manifest, const MachineRecord* record)
      : output_(output), manifest_(manifest), known_(axes_of(manifest.campaign)) {
    const bool own =
        record != nullptr && (record->control.empty() || record->control == output.name);
    record_ = own ? record : nullptr;
  }

  void add_site(const RawOptions& site) {
    for (const auto& [axis, settings] : tables_in(site))
      if (known_.contains(axis)) add(axis, settings);
  }

  void add_record() {
    if (record_ == nullptr) return;
    for (const auto& [name, axis] : record_->axes)
      if (known_.contains(name)) add(name, {axis.settings.begin(), axis.settings.end()});
  }

  void add_campaign(std::vector<Error>& errors) {
    for (const auto& [axis, settings] : tables_in(manifest_.options)) {
      for (const auto& [key, value] : settings) look_at(axis, key, value, errors);
      add(axis, settings);
    }
    for (const Axis& a : manifest_.campaign.machine.axes) add_backlash(a, errors);
  }

  NumberTables tables() const { return tables_; }

 private:
  NumberTables tables_in(const RawOptions& options) const {
    const auto plugin = options.find(output_.name);
    if (plugin == options.end()) return {};
    const auto raw = plugin->second.find("axes");
    if (raw == plugin->second.end()) return {};
    if (const auto* tables = std::get_if<NumberTables>(&raw->second.value)) return *tables;
    const auto* list = std::get_if<std::vector<std::string>>(&raw->second.value);
    return list == nullptr ? NumberTables{} : number_tables_of(*list).value_or(NumberTables{});
  }

  void add(const std::string& axis, const NumberTable& settings) {
    NumberTable& all = tables_[axis];
    for (const auto& [key, value] : settings) all[key] = value;
  }

  Error at_axes(const std::string& message, const std::string& axis, const std::string& key) const {
    const auto plugin = manifest_.options.find(output_.name);
    std::uint64_t line =
        line_in(manifest_.lines, "options." + output_.name + ".axes." + axis + "." + key);
    if (line != 0)
      return Error{"options." + output_.name + ".axes: " + message, manifest_name, line};
    if (plugin != manifest_.options.end())
      if (const auto raw = plugin->second.find("axes"); raw != plugin->second.end())
        line = raw->second.line;
    return Error{"options." + output_.name + ".axes: " + message, manifest_name, line};
  }

  void look_at(const std::string& axis, const std::string& key, double value,
               std::vector<Error>& errors) const {
    if (record_ == nullptr) return;
    const std::string other = key == "joint" ? "number" : key;
    const auto recorded = record_->axes.find(axis);
    const bool known = recorded != record_->axes.end() && recorded->second.settings.contains(other);
    if (!known && other == "number") look_for_owner(axis, key, value, errors);
    if (!known) return;
    const auto says = recorded->second.settings.find(other);
    if (std::fabs(value - says->second) <= 1e-9 * std::max(1.0, std::fabs(says->second))) return;
    errors.push_back(at_axes("axis " + axis + ", " + said(key, value) + " contradicts " +
                                 place_in(*record_, key_of(axis, other)) + ", where it is " +
                                 in_digits(says->second),
                             axis, key));
  }

  static std::string said(const std::string& key, double value) {
    return key + "=" + in_digits(value);
  }

  /// A number that belongs to another axis is an error, because the control would load the table
  /// for that axis.
  void look_for_owner(const std::string& axis, const std::string& key, double number,
                      std::vector<Error>& errors) const {
    for (const auto& [name, recorded] : record_->axes)
      if (const auto has = recorded.settings.find("number");
          name != axis && has != recorded.settings.end() && has->second == number)
        errors.push_back(at_axes("axis " + axis + ", " + said(key, number) +
                                     " is the number of axis " + name + ", " +
                                     place_in(*record_, key_of(name, "number")),
                                 axis, key));
  }

  /// Adds the backlash value that was active during the measurement; a different value in the
  /// settings is an error.
  void add_backlash(const Axis& a, std::vector<Error>& errors) {
    if (!a.active_backlash) return;
    const std::string key = a.rotary ? "backlash_deg" : "backlash_mm";
    const double on = *a.active_backlash * (a.rotary ? deg_per_rad : 1e3);
    NumberTable& table = tables_[a.name];
    const auto known = table.find(key);
    if (known == table.end())
      table[key] = rounded_to_places(on, 9);
    else if (std::fabs(known->second - on) > 1e-9)
      errors.push_back(
          at_axes("axis " + a.name + ", " + said(key, known->second) +
                      " contradicts the compensation that was active during the measurement, " +
                      in_digits(on),
                  a.name, key));
  }

  const Info& output_;
  const Manifest& manifest_;
  const MachineRecord* record_ = nullptr;
  std::set<std::string> known_;
  NumberTables tables_;
};

}  // namespace

std::vector<Error> contradictions(const Manifest& manifest, const MachineRecord& record) {
  std::vector<Error> errors;
  const Machine& m = manifest.campaign.machine;
  const auto differ = [&](const std::string& key, const std::string& here,
                          const std::string& record_key, const std::string& there) {
    errors.push_back(Error{key + ": \"" + here + "\" contradicts " + place_in(record, record_key) +
                               ", where it is \"" + there + "\"",
                           manifest_name, line_in(manifest.lines, key)});
  };
  for (const auto& [key, here, there] : {std::tuple{"maker", &m.maker, &record.maker},
                                         {"model", &m.model, &record.model},
                                         {"serial", &m.serial, &record.serial},
                                         {"control", &m.control, &record.control}})
    if (!here->empty() && !there->empty() && *here != *there)
      differ(std::string("machine.") + key, *here, key, *there);
  for (const Axis& a : m.axes) {
    const auto recorded = record.axes.find(a.name);
    if (recorded == record.axes.end()) continue;
    const RecordedAxis& r = recorded->second;
    const std::string key = "machine.axes." + a.name;
    const auto word = [](bool rotary) { return rotary ? "rotary" : "linear"; };
    if (a.rotary != r.rotary)
      differ(key + ".kind", word(a.rotary), "axes." + a.name + ".kind", word(r.rotary));
    const auto from = r.settings.find(r.rotary ? "from_deg" : "from_mm"),
               to = r.settings.find(r.rotary ? "to_deg" : "to_mm");
    if (!a.travel || from == r.settings.end() || a.rotary != r.rotary) continue;
    const double per = a.rotary ? deg_per_rad : 1e3;
    const auto span = [](double low, double high) {
      return in_digits(low) + " to " + in_digits(high);
    };
    const double low = std::round(a.travel->first * per * 1e6) / 1e6,
                 high = std::round(a.travel->second * per * 1e6) / 1e6;
    if (std::fabs(low - from->second) > 1e-6 || std::fabs(high - to->second) > 1e-6)
      differ(key + ".travel", span(low, high), "axes." + a.name + ".travel",
             span(from->second, to->second));
  }
  return errors;
}

Checked<Settings> settle_table_options(const Info& output, const RawOptions& site,
                                       const Manifest& manifest, const MachineRecord* record) {
  auto settled = settle_options(output, site, manifest.options);
  const auto has = [&]<class T>(const char* name, const T&) {
    return std::any_of(output.options.begin(), output.options.end(), [&](const Option& o) {
      return o.name == name && std::holds_alternative<T>(o.default_value);
    });
  };
  if (!settled || !has("axes", NumberTables{})) return settled;
  std::vector<Error> errors;
  Layers layers(output, manifest, record);
  layers.add_site(site);
  layers.add_record();
  layers.add_campaign(errors);
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  settled->values["axes"] = layers.tables();
  const bool own = record != nullptr && (record->control.empty() || record->control == output.name);
  if (own && has("taken", std::vector<std::string>{})) {
    auto taken = settled->texts("taken");
    taken.insert(taken.end(), record->taken.begin(), record->taken.end());
    settled->values["taken"] = std::move(taken);
  }
  return settled;
}

}  // namespace nonio::config
