// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/machines.h"

#include <algorithm>

#include "campaign/config/checks.h"
#include "campaign/config/site_files.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/format.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::config {
namespace fs = std::filesystem;

namespace {

bool is_range(std::string_view text) {
  const auto digits = [](std::string_view part) {
    return !part.empty() && part.size() <= 6 &&
           part.find_first_not_of("0123456789") == std::string_view::npos;
  };
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return digits(text);
  const std::string_view from = text.substr(0, dash), to = text.substr(dash + 1);
  return digits(from) && digits(to) && std::stol(std::string(from)) <= std::stol(std::string(to));
}

void same_number_twice(const MachineRecord& record, TableReader& top) {
  std::map<double, std::string> owner;
  for (const auto& [name, axis] : record.axes)
    if (const auto number = axis.settings.find("number"); number != axis.settings.end()) {
      const auto [known, is_new] = owner.emplace(number->second, name);
      if (!is_new)
        top.error("axes", known->second + " and " + name + " both have number " +
                              fixed_text(number->second, 0));
    }
}

/// Returns an error if a path is outside of the site, or if the files no longer have the SHA-256
/// that the record states.
Expected<std::map<std::string, std::vector<Artifact>>> tables_of(const MachineRecord& record,
                                                                 const fs::path& site) {
  std::map<std::string, std::vector<Artifact>> tables;
  for (const auto& [name, axis] : record.axes)
    for (const ControlState& state : axis.states) {
      if (!state.table || state.table->empty()) continue;
      const auto wrong = [&](const std::string& key, const std::string& message) {
        return fail(
            Error{state.key + "." + key + ": " + message, record.file, state.line_of_table});
      };
      auto files = read_table_files(*state.table, site);
      if (!files) return wrong("table", files.error().message);
      if (!state.sha256.empty() && table_sha256(*files) != state.sha256)
        return wrong("sha256", *state.table +
                                   " has changed since it was recorded: restore these files, or "
                                   "record what is in the control as another state");
      tables[state.files] = std::move(*files);
    }
  return tables;
}

void settle_digest(RecordFile& file) {
  std::string all = storage::sha256(file.bytes);
  for (const auto& [axis, files] : file.tables)
    for (const Artifact& f : files)
      all += "\n" + axis + " " + f.name + " " + storage::sha256(f.bytes);
  file.sha256 = file.tables.empty() ? all : storage::sha256(all);
}

RecordFile read_record(const fs::path& site, const std::string& asset) {
  const std::string name = std::string(machines_folder) + "/" + asset + ".toml";
  RecordFile file{.asset = asset, .bytes = {}, .sha256 = {}, .record = MachineRecord{}};
  const auto wrong = [&](Error error) {
    if (error.file.empty()) error.file = name;
    file.record = tl::unexpected(std::vector<Error>{std::move(error)});
  };
  const auto path = storage::path_inside(site, name);
  auto bytes = path ? storage::read_small_file(*path) : fail(path.error());
  if (bytes) {
    file.bytes = std::move(*bytes);
    file.record = parse_machine(file.bytes, name, asset);
  } else {
    wrong(bytes.error());
  }
  if (file.record) {
    auto tables = tables_of(*file.record, site);
    if (tables)
      file.tables = std::move(*tables);
    else
      wrong(tables.error());
  }
  settle_digest(file);
  return file;
}

void check_since(TableReader& reader, ControlState& state) {
  state.key = reader.place();
  state.line_of_table = reader.line_of("table"), state.line_of_since = reader.line_of("since");
  if (state.table == "none") state.table.emplace();
  if ((state.table || state.backlash) && state.since.empty())
    reader.error("since",
                 "is missing: the day on which table and backlash came into the control; they "
                 "count for measurements of later days only");
}

}  // namespace

void read_as_written(TableReader& reader, const Key& key, std::map<std::string, double>& settings) {
  const bool rotary = reader.settled() == "rotary";
  if (key.holds == Key::Holds::span) {
    const auto travel = value_of<Span>(reader, key);
    if (!travel) return;
    settings[rotary ? "from_deg" : "from_mm"] = travel->first;
    settings[rotary ? "to_deg" : "to_mm"] = travel->second;
  } else if (key.holds == Key::Holds::whole) {
    if (const auto value = value_of<int>(reader, key)) settings[std::string(key.name)] = *value;
  } else if (const auto value = value_of<double>(reader, key)) {
    settings[std::string(key.name)] = *value;
  }
}

void check_state(TableReader& reader, ControlState& state) {
  const bool rotary = reader.settled() == "rotary";
  const char* const other = rotary ? "backlash_mm" : "backlash_deg";
  if (reader.contains(other))
    reader.error(other, "axis " + reader.name() + " is " + (rotary ? "rotary" : "linear") +
                            ": expected " + (rotary ? "backlash_deg" : "backlash_mm"));
  check_since(reader, state);
  if (state.table) state.files = reader.name() + " " + *state.table;
}

void check_recorded_axis(TableReader& reader, RecordedAxis& axis) {
  axis.rotary = reader.settled() == "rotary";
  check_since(reader, axis.present);
  if (!axis.present.since.empty()) {
    if (axis.present.table) axis.present.files = reader.name();
    axis.states.insert(axis.states.begin(), axis.present);
  }
  std::stable_sort(axis.states.begin(), axis.states.end(),
                   [](const ControlState& a, const ControlState& b) { return a.since < b.since; });
}

const ControlState* RecordedAxis::state_on(const std::string& day) const {
  const ControlState* last = nullptr;
  for (const ControlState& s : states)
    if (s.counts_on(day)) last = &s;
  return last;
}

std::string table_sha256(const std::vector<Artifact>& files) {
  std::vector<std::string> digests;
  for (const Artifact& f : files) digests.push_back(storage::sha256(f.bytes));
  std::sort(digests.begin(), digests.end());
  std::string all;
  for (const std::string& one : digests) all += one + "\n";
  return storage::sha256(all);
}

Checked<MachineRecord> parse_machine(std::string_view text, const std::string& file,
                                     const std::string& asset) {
  auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  std::vector<Error> errors;
  MachineRecord record;
  record.file = file;
  TableReader top(*root, machine_file(), file, errors);
  top.fill(record);
  if (!record.asset.empty() && record.asset != asset)
    top.error("asset",
              "expected \"" + asset + "\", as the file is called; found \"" + record.asset + "\"");
  if (!std::all_of(record.taken.begin(), record.taken.end(), is_range))
    top.error("taken", "expected numbers or ranges of them, [\"0\", \"100-227\"]");
  same_number_twice(record, top);
  top.finish();
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  note_lines(*root, "", record.lines);
  return record;
}

Expected<MachineRecords> read_machines(const fs::path& site) {
  MachineRecords records;
  NONIO_TRY(const auto there, storage::is_there(site / machines_folder));
  if (!there) return records;
  NONIO_TRY(const auto folder, storage::path_inside(site, machines_folder));
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (const fs::path name = it->path().filename();
        name.extension() == ".toml" && !name.string().starts_with("."))
      names.push_back(name.stem().string());
  if (error) return fail("cannot read the machines in " + folder.string() + ": " + error.message());
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) records.push_back(read_record(site, name));
  return records;
}

std::string machine_input(const Machine& m) {
  const std::string prefix(machine_prefix);
  if (!m.asset.empty()) return prefix + "asset " + m.asset;
  if (!m.maker.empty() && !m.serial.empty()) return prefix + "of " + m.maker + ", " + m.serial;
  return {};
}

namespace {

/// Returns maker and serial number of a record, or of its last valid version after an error.
Machine machine_of(const RecordFile& r) {
  Machine out;
  out.maker = r.record ? r.record->maker : r.maker;
  out.serial = r.record ? r.record->serial : r.serial;
  return out;
}

bool may_be_of_any(const RecordFile& r) { return !r.record && r.maker.empty() && r.serial.empty(); }

}  // namespace

std::string machine_digest(const MachineRecords& records, std::string_view input) {
  std::string all, of_any;
  const auto add = [](std::string& to, const std::string& digest) {
    to += (to.empty() ? "" : " ") + digest;
  };
  const std::string asset_prefix = std::string(machine_prefix) + "asset ";
  for (const RecordFile& r : records) {
    Machine by_asset;
    by_asset.asset = r.asset;
    if (machine_input(by_asset) == input || machine_input(machine_of(r)) == input)
      add(all, r.sha256);
    else if (may_be_of_any(r) && !input.starts_with(asset_prefix))
      add(of_any, "unreadable " + r.sha256);
  }
  return !all.empty() ? all : !of_any.empty() ? of_any : absent;
}

Expected<const RecordFile*> record_of(const MachineRecords& records, const Machine& machine) {
  const RecordFile *found = nullptr, *any = nullptr;
  for (const RecordFile& r : records) {
    if (!machine.asset.empty()) {
      if (r.asset == machine.asset) return &r;
      continue;
    }
    if (machine.maker.empty() || machine.serial.empty()) continue;
    if (may_be_of_any(r)) any = &r;
    const Machine of = machine_of(r);
    if (of.maker != machine.maker || of.serial != machine.serial) continue;
    if (found != nullptr)
      return fail(std::string(machines_folder) + "/" + found->asset + ".toml and " +
                  machines_folder + "/" + r.asset + ".toml both are of " + machine.maker +
                  ", serial " + machine.serial + ": state asset in [machine]");
    found = &r;
  }
  return found != nullptr ? found : any;
}

std::string packed(const RecordFile& record) {
  storage::Json json = {
      {"schema", "nonio-machine/1"}, {"asset", record.asset}, {"record", record.bytes}};
  for (const auto& [axis, files] : record.tables)
    for (const Artifact& f : files) json["tables"][axis][f.name] = to_hex(f.bytes);
  return storage::dump(json);
}

Expected<RecordFile> unpacked_record(std::string_view text) {
  const storage::Json json = storage::parse_or_discard(text);
  const auto is_text = [](const storage::Json& of, const char* key) {
    return of.is_object() && of.contains(key) && of[key].is_string();
  };
  if (!is_text(json, "asset") || !is_text(json, "record"))
    return fail("the attached record of the machine is none");
  RecordFile file{.asset = json["asset"].get<std::string>(),
                  .bytes = json["record"].get<std::string>(),
                  .sha256 = {},
                  .record = MachineRecord{}};
  file.record = parse_machine(file.bytes, std::string(machines_folder) + "/" + file.asset + ".toml",
                              file.asset);
  if (json.contains("tables"))
    for (const auto& axis : json["tables"].items())
      for (const auto& one : axis.value().items()) {
        auto bytes = one.value().is_string() ? from_hex(one.value().get<std::string>())
                                             : fail("expected hexadecimal digits");
        if (!bytes) return fail("the attached table " + one.key() + ": " + bytes.error().message);
        file.tables[axis.key()].push_back({one.key(), std::move(*bytes)});
      }
  settle_digest(file);
  return file;
}

}  // namespace nonio::config
