// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "host/config/machines.h"
#include "nonio/sdk/format.h"

namespace nonio::host::config {
namespace {

/// "X number=1 step_mm=50" as it is written: the plugin says what is wrong with it.
struct AxisEntry {
  std::string axis;
  std::vector<std::pair<std::string, std::string>> settings;  // without '=': second is empty

  std::string* find(const std::string& key) {
    for (auto& [name, value] : settings)
      if (name == key) return &value;
    return nullptr;
  }
  void put(const std::string& key, const std::string& value) {
    if (std::string* known = find(key))
      *known = value;
    else
      settings.emplace_back(key, value);
  }
};

AxisEntry entry_of(const std::string& text) {
  AxisEntry entry;
  std::size_t at = 0;
  const auto word = [&] {
    at = std::min(text.find_first_not_of(" \t", at), text.size());
    const std::size_t end = std::min(text.find_first_of(" \t", at), text.size());
    std::string out = text.substr(at, end - at);
    at = end;
    return out;
  };
  entry.axis = word();
  for (std::string one = word(); !one.empty(); one = word()) {
    const std::size_t equals = one.find('=');
    entry.settings.emplace_back(one.substr(0, equals),
                                equals == std::string::npos ? "" : one.substr(equals));
  }
  return entry;
}

std::string text_of_entry(const AxisEntry& entry) {
  std::string text = entry.axis;
  for (const auto& [key, value] : entry.settings) text += " " + key + value;
  return text;
}

std::string in_digits(double value) {
  std::string text;
  append_shortest(text, value);
  return text;
}

std::optional<double> number_of(const std::string& text) {  // "=1.5"
  double value = 0.0;
  if (text.size() < 2) return std::nullopt;
  const char* const from = text.data() + (text[1] == '+' ? 2 : 1);
  const auto end = std::from_chars(from, text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size() ? std::optional(value)
                                                                       : std::nullopt;
}

std::uint64_t line_in(const KeyLines& lines, const std::string& key) {
  const auto found = lines.find(key);
  return found == lines.end() ? 0 : found->second;
}

/// "machines/S-0042.toml:7".
std::string place_in(const MachineRecord& record, const std::string& key) {
  const std::uint64_t line = line_in(record.lines, key);
  return record.file + (line == 0 ? "" : ":" + std::to_string(line));
}

/// The key of the record that a setting of option `axes` comes from.
std::string key_of(const std::string& axis, const std::string& setting) {
  const bool travel = setting.starts_with("from_") || setting.starts_with("to_");
  return "axes." + axis + "." + (travel ? "travel" : setting);
}

/// Every axis that tables of the campaign may be of.
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
    for (const std::string& text : entries_in(site))
      if (AxisEntry e = entry_of(text); known_.contains(e.axis)) add(e);
  }

  void add_record() {
    if (record_ == nullptr) return;
    for (const auto& [name, axis] : record_->axes) {
      if (!known_.contains(name)) continue;
      AxisEntry entry{name, {}};
      for (const auto& [key, value] : axis.settings) entry.put(key, "=" + in_digits(value));
      add(entry);
    }
  }

  void add_campaign(std::vector<Error>& errors) {
    std::map<std::string, std::string> said;  // "Z number"
    for (const std::string& text : entries_in(manifest_.options)) {
      AxisEntry e = entry_of(text);
      for (const auto& [key, value] : e.settings) {
        look_at(e.axis, key, value, errors);
        const std::string& first = said.emplace(e.axis + " " + key, value).first->second;
        if (first != value)
          errors.push_back(at_axes("axis " + e.axis + " has " + key + first + " and " + key +
                                   value + ": which of them?"));
      }
      add(e);
    }
    for (const Axis& a : manifest_.campaign.machine.axes) add_backlash(a, errors);
  }

  std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const AxisEntry& e : entries_) all.push_back(text_of_entry(e));
    return all;
  }

 private:
  std::vector<std::string> entries_in(const RawOptions& options) const {
    const auto plugin = options.find(output_.name);
    if (plugin == options.end()) return {};
    const auto raw = plugin->second.find("axes");
    if (raw == plugin->second.end()) return {};
    const auto* list = std::get_if<std::vector<std::string>>(&raw->second.value);
    return list == nullptr ? std::vector<std::string>{} : *list;
  }

  void add(const AxisEntry& entry) {
    const auto known = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const AxisEntry& e) { return e.axis == entry.axis; });
    AxisEntry& all =
        known == entries_.end() ? entries_.emplace_back(AxisEntry{entry.axis, {}}) : *known;
    for (const auto& [key, value] : entry.settings) all.put(key, value);
  }

  Error at_axes(const std::string& message) const {
    const auto plugin = manifest_.options.find(output_.name);
    std::uint64_t line = 0;
    if (plugin != manifest_.options.end())
      if (const auto raw = plugin->second.find("axes"); raw != plugin->second.end())
        line = raw->second.line;
    return Error{"options." + output_.name + ".axes: " + message, manifest_name, line};
  }

  void look_at(const std::string& axis, const std::string& key, const std::string& value,
               std::vector<Error>& errors) const {
    if (record_ == nullptr) return;
    const std::string other = key == "joint" ? "number" : key;
    const auto number = number_of(value);
    if (!number) return;
    const auto recorded = record_->axes.find(axis);
    const bool known = recorded != record_->axes.end() && recorded->second.settings.contains(other);
    if (!known && other == "number") look_for_owner(axis, key + value, *number, errors);
    if (!known) return;
    const auto says = recorded->second.settings.find(other);
    if (std::fabs(*number - says->second) <= 1e-9 * std::max(1.0, std::fabs(says->second))) return;
    errors.push_back(at_axes("axis " + axis + ", " + key + value + " contradicts " +
                             place_in(*record_, key_of(axis, other)) + ", where it is " +
                             in_digits(says->second)));
  }

  /// A number that another axis of the machine has: the table would go to that one.
  void look_for_owner(const std::string& axis, const std::string& said, double number,
                      std::vector<Error>& errors) const {
    for (const auto& [name, recorded] : record_->axes)
      if (const auto has = recorded.settings.find("number");
          name != axis && has != recorded.settings.end() && has->second == number)
        errors.push_back(at_axes("axis " + axis + ", " + said + " is the number of axis " + name +
                                 ", " + place_in(*record_, key_of(name, "number"))));
  }

  /// What was in the parameter while measured, as these plugins take it.
  void add_backlash(const Axis& a, std::vector<Error>& errors) {
    if (!a.backlash_on) return;
    const std::string key = a.rotary ? "backlash_deg" : "backlash_mm";
    const double on = *a.backlash_on * (a.rotary ? deg_per_rad : 1e3);
    for (AxisEntry& e : entries_)
      if (const std::string* said = e.axis == a.name ? e.find(key) : nullptr) {
        if (const auto number = number_of(*said); number && std::fabs(*number - on) > 1e-9)
          errors.push_back(at_axes("axis " + a.name + ", " + key + *said +
                                   " contradicts what was on while it was measured, " +
                                   in_digits(on)));
        return;
      }
    add({a.name, {{key, "=" + fixed_text(on, 9)}}});
  }

  const Info& output_;
  const Manifest& manifest_;
  const MachineRecord* record_ = nullptr;
  std::set<std::string> known_;
  std::vector<AxisEntry> entries_;
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
  const auto has_texts = [&](const char* name) {
    return std::any_of(output.options.begin(), output.options.end(), [&](const Option& o) {
      return o.name == name && std::holds_alternative<std::vector<std::string>>(o.otherwise);
    });
  };
  if (!settled || !has_texts("axes")) return settled;
  std::vector<Error> errors;
  Layers layers(output, manifest, record);
  layers.add_site(site);
  layers.add_record();
  layers.add_campaign(errors);
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  settled->values["axes"] = layers.texts();
  const bool own = record != nullptr && (record->control.empty() || record->control == output.name);
  if (own && has_texts("taken")) {
    auto taken = settled->texts("taken");
    taken.insert(taken.end(), record->taken.begin(), record->taken.end());
    settled->values["taken"] = std::move(taken);
  }
  return settled;
}

}  // namespace nonio::host::config
