// SPDX-License-Identifier: Apache-2.0
#include "check_campaign.h"

#include <algorithm>

#include "nonio/sdk/format.h"
#include "platform/storage/files.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

constexpr const char* loaded_folder = "loaded";

std::string_view trimmed(std::string_view s) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!s.empty() && is_blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && is_blank(s.back())) s.remove_suffix(1);
  return s;
}

struct Section {
  std::string head;
  std::vector<std::string> lines{};

  bool is_part_of(std::string_view name) const {
    return head.starts_with("[" + std::string(name) + "]") ||
           head.starts_with("[" + std::string(name) + ".") ||
           head.starts_with("[[" + std::string(name) + "]]") ||
           head.starts_with("[[" + std::string(name) + ".");
  }
  static bool has_key(const std::string& line, std::string_view key) {
    const std::string_view s = trimmed(line);
    return s.starts_with(key) && trimmed(s.substr(key.size())).starts_with("=");
  }
  void remove(std::string_view key) {
    std::erase_if(lines, [&](const std::string& line) { return has_key(line, key); });
  }
  void set(std::string_view key, const std::string& value) {
    remove(key);
    lines.insert(lines.begin() + (head.empty() ? 0 : 1), std::string(key) + " = " + value + "\n");
  }
};

std::vector<Section> sections_of(std::string_view text) {
  std::vector<Section> out(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    const std::string line(text.substr(at, end + 1 - at));
    at = end + 1;
    if (trimmed(line).starts_with("[")) out.push_back({std::string(trimmed(line))});
    out.back().lines.push_back(line.back() == '\n' ? line : line + "\n");
  }
  return out;
}

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

std::string list_of(const std::vector<Artifact>& files) {
  std::string list;
  for (const Artifact& f : files)
    list += (list.empty() ? "" : ",") + std::string(loaded_folder) + "/" + f.name;
  return list.empty() ? "none" : list;
}

std::string backlash_text(double value, bool rotary) {
  std::string text;
  append_shortest(text, rounded_to_places(value * (rotary ? deg_per_rad : 1e3), 9));
  return text;
}

bool is_rotary(const Machine& machine, const std::string& name) {
  const Axis* const axis = machine.axis(name);
  return axis != nullptr && axis->rotary;
}

/// The measurement of a section [[measurement]], or null.
const std::pair<const std::string, Artifact>* measured_in(const Section& s,
                                                          const CheckCampaign& check) {
  for (const auto& one : check.readings)
    if (std::any_of(s.lines.begin(), s.lines.end(), [&](const std::string& line) {
          return Section::has_key(line, "id") && line.find(quoted(one.first)) != std::string::npos;
        }))
      return &one;
  return nullptr;
}

/// Changes single lines, so that the rest of the text is kept.
std::string check_text(std::string_view text, const std::string& id, const CheckCampaign& check,
                       const Machine& machine) {
  auto sections = sections_of(text);
  auto missing = check.axes;
  const std::pair<const std::string, Artifact>* of = nullptr;
  std::string out;
  for (Section& s : sections) {
    if (s.head.starts_with("[[measurement]]")) of = measured_in(s, check);
    if (s.is_part_of("measurement") ? of == nullptr
                                    : s.is_part_of("model") || s.is_part_of("accept"))
      continue;
    if (s.head.starts_with("[campaign]")) {
      s.set("purpose", quoted("check"));
      s.set("date", check.date);
      s.set("id", quoted(id));
    }
    if (s.head.starts_with("[[measurement]]")) {
      for (const char* key : {"adjustment", "compensation", "exclude", "why"}) s.remove(key);
      s.set("file", quoted(of->second.name));
    }
    for (const auto& [axis, backlash] : check.axes) {
      if (!s.head.starts_with("[machine.axes." + axis + "]")) continue;
      missing.erase(axis);
      for (const char* key : {"active_backlash_mm", "active_backlash_deg"}) s.remove(key);
      const bool rotary = is_rotary(machine, axis);
      if (backlash)
        s.set(rotary ? "active_backlash_deg" : "active_backlash_mm",
              backlash_text(*backlash, rotary));
      s.set("active_table", quoted(list_of(check.loaded)));
    }
    for (const std::string& line : s.lines) out += line;
  }
  for (const auto& [axis, backlash] : missing) {
    const bool rotary = is_rotary(machine, axis);
    out += "\n[machine.axes." + axis + "]\nactive_table = " + quoted(list_of(check.loaded)) + "\n";
    if (backlash)
      out += std::string(rotary ? "active_backlash_deg = " : "active_backlash_mm = ") +
             backlash_text(*backlash, rotary) + "\n";
  }
  return out;
}

/// Whether the manifest, parsed again, contains the intended values and is otherwise unchanged.
bool is_meant(const config::Manifest& read, const config::Manifest& before, const std::string& id,
              const CheckCampaign& check) {
  const Campaign& c = read.campaign;
  if (c.id != id || c.date != check.date || read.purpose != "check" ||
      c.measurements.size() != check.readings.size())
    return false;
  const auto same_line = [&](const Measurement& m) {
    const auto readings = check.readings.find(m.id);
    return readings != check.readings.end() && m.file == readings->second.name &&
           m.adjustment.empty() && m.compensation.empty() &&
           std::any_of(before.campaign.measurements.begin(), before.campaign.measurements.end(),
                       [&](const Measurement& o) {
                         return o.id == m.id && m.kind == o.kind && m.axis == o.axis &&
                                m.side == o.side && m.at == o.at && m.from == o.from &&
                                m.to == o.to;
                       });
  };
  const auto has_state = [&](const auto& loaded) {
    const Axis* const axis = c.machine.axis(loaded.first);
    return axis != nullptr && axis->active_table &&
           *axis->active_table == (check.loaded.empty() ? "" : list_of(check.loaded)) &&
           axis->active_backlash.has_value() == loaded.second.has_value();
  };
  return std::all_of(c.measurements.begin(), c.measurements.end(), same_line) &&
         std::all_of(check.axes.begin(), check.axes.end(), has_state) &&
         c.machine.asset == before.campaign.machine.asset &&
         c.machine.serial == before.campaign.machine.serial &&
         c.machine.control == before.campaign.machine.control;
}

}  // namespace

Expected<fs::path> write_check_campaign(const OpenCampaign& open, const CheckCampaign& check) {
  NONIO_TRY(const auto text, storage::read_small_file(open.folder / config::manifest_name));
  const auto before =
      config::parse_manifest(text, config::manifest_name, open.place->plugins.methods());
  if (!before) return fail(before.error().front());
  const std::string id = open.campaign().id + "-check";
  std::error_code error;
  fs::path folder = fs::canonical(open.folder, error);
  folder += "-check";
  if (error || fs::exists(folder, error))
    return fail(folder.string() +
                " exists: put the readings of the check there, or make the campaign by hand, with "
                "purpose = \"check\" in [campaign]");
  std::vector<Artifact> files;
  for (const auto& [measurement, file] : check.readings) {
    if (!storage::is_artifact_name(file.name) || file.name == config::manifest_name)
      return fail("--check: expected a plain file name, found \"" + file.name + "\"");
    for (const Artifact& other : files)
      if (other.name == file.name)
        return fail("--check: expected files of different names, found \"" + file.name +
                    "\" twice");
    files.push_back(file);
  }
  const std::string changed = check_text(text, id, check, open.campaign().machine);
  const auto read =
      config::parse_manifest(changed, config::manifest_name, open.place->plugins.methods());
  if (!read || !is_meant(*read, *before, id, check))
    return fail(
        "campaign.toml has a form of which no check campaign can be made: make it by hand, with "
        "the same axis, targets and machine, purpose = \"check\" in [campaign] and the day of the "
        "check" +
        (read ? "" : " (" + read.error().front().message + ")"));
  if (auto done = storage::publish(folder / loaded_folder, check.loaded); !done)
    return fail(done.error());
  files.push_back({config::manifest_name, changed});
  if (auto done = storage::publish(folder, files); !done) return fail(done.error());
  return folder;
}

}  // namespace nonio::app
