// SPDX-License-Identifier: Apache-2.0
#include "state_record.h"

#include <algorithm>
#include <filesystem>

#include "campaign/config/machines.h"
#include "campaign/config/site_files.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t largest_file = 1'000'000;  // limit per file, bytes

std::string safe(const std::string& name) {
  std::string out = name;
  for (char& c : out)
    if (c == ',' || c == '"' || c == '\\' || c == '/' || static_cast<unsigned char>(c) < 0x21)
      c = '_';
  return out;
}

std::string number(double value) {
  std::string text;
  append_shortest(text, rounded_to_places(value, 9));
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string state_text(const NewState& state, const std::string& axis, bool rotary,
                       const std::string& list) {
  std::string out = "\n[[axes." + axis + ".state]]\nsince = " + state.since + "\n";
  out += "table = \"" + (list.empty() ? "none" : list) + "\"\n";
  if (state.backlash)
    out += std::string(rotary ? "backlash_deg = " : "backlash_mm = ") +
           number(*state.backlash * (rotary ? deg_per_rad : 1e3)) + "\n";
  out += "source = \"" + state.source + "\"\n";
  if (!list.empty()) out += "sha256 = \"" + config::table_sha256(state.files) + "\"\n";
  for (const LoadedTable& t : state.tables) {
    if (t.position.size() != 1 || t.position.front().size() < 2) continue;
    const auto& at = t.position.front();
    const double per = rotary ? deg_per_rad : 1e3;
    out += "grid = [" + number(at.front() * per) + ", " + number(at.back() * per) + "]\n";
    out += "points = " + std::to_string(at.size()) + "\n";
    break;
  }
  if (state.reference && !list.empty()) out += "reference = " + number(*state.reference) + "\n";
  return out;
}

bool is_known(const config::RecordFile* record, const std::string& axis, const NewState& state) {
  if (record == nullptr || !record->record) return false;
  const auto found = record->record->axes.find(axis);
  if (found == record->record->axes.end()) return false;
  return std::any_of(
      found->second.states.begin(), found->second.states.end(), [&](const config::ControlState& s) {
        return s.since == state.since && s.source == state.source &&
               s.sha256 == (state.files.empty() ? "" : config::table_sha256(state.files));
      });
}

}  // namespace

Expected<std::string> add_states(const OpenCampaign& open, const std::string& axis,
                                 const std::vector<NewState>& states) {
  const Machine& machine = open.campaign().machine;
  NONIO_TRY(const auto* const record, config::record_of(open.place->context.machines, machine));
  const std::string asset = record != nullptr ? record->asset : machine.asset;
  if (asset.empty())
    return fail(
        "the state of the control cannot be recorded, because the campaign does not name its "
        "machine: state asset in [machine] of campaign.toml");
  const fs::path site = config::site_of(open.folder);
  const std::string name = std::string(config::machines_folder) + "/" + asset + ".toml";
  // The record may have states of other axes that were added since the campaign was opened.
  const auto present = storage::read_small_file(site / name);
  std::string text = present             ? *present
                     : record != nullptr ? record->bytes
                                         : "format = 1\nasset = \"" + asset + "\"\n";
  if (!text.empty() && text.back() != '\n') text += '\n';
  const Axis* const of = machine.axis(axis);
  const bool rotary = of != nullptr && of->rotary;
  bool is_new = false;
  std::vector<std::pair<fs::path, std::vector<Artifact>>> copies;
  for (const NewState& state : states) {
    if (is_known(record, axis, state)) continue;
    is_new = true;
    std::string list;
    std::vector<Artifact> files = state.files;
    const std::string folder = std::string(config::machines_folder) + "/" + asset + "/" +
                               state.since + "-" + safe(axis) + "-" +
                               config::table_sha256(files).substr(0, 8);
    for (Artifact& f : files) {
      if (f.bytes.size() > largest_file)
        return fail(f.name + " is larger than 1 MB: the record of a machine cannot name it");
      f.name = safe(f.name);
      list += (list.empty() ? "" : ",") + folder + "/" + f.name;
    }
    if (!files.empty()) copies.emplace_back(site / folder, std::move(files));
    text += state_text(state, axis, rotary, list);
  }
  if (!is_new) return name;
  if (const auto read = config::parse_machine(text, name, asset); !read)
    return fail("the state of the control cannot be added to " + name + ": " +
                read.error().front().message);
  for (const auto& [folder, files] : copies)
    if (auto done = storage::publish(folder, files); !done) return fail(done.error());
  if (auto done = storage::publish(site / config::machines_folder, {{asset + ".toml", text}});
      !done)
    return fail(done.error());
  return name;
}

}  // namespace nonio::app
