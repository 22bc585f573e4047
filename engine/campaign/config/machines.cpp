// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/machines.h"

#include <algorithm>

#include "campaign/config/site_files.h"
#include "campaign/config/table_files.h"
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

/// Numbers that a control uses unchanged, by the key of option `axes`.
void read_settings(TableReader& reader, RecordedAxis& axis) {
  const auto keep = [&](const char* key, std::optional<double> value) {
    if (value) axis.settings[key] = *value;
  };
  if (const auto number = reader.integer("number")) axis.settings["number"] = *number;
  const auto travel = reader.span("travel");
  if (axis.rotary) {
    keep("reference_deg", reader.number("reference_deg"));
    keep("resolution_arcsec", reader.number("resolution_arcsec"));
    keep("largest_arcsec", reader.number("largest_arcsec"));
    keep("slope_arcsec_per_deg", reader.number("slope_arcsec_per_deg"));
  } else {
    keep("reference_mm", reader.number("reference_mm"));
    keep("resolution_um", reader.number("resolution_um"));
    keep("largest_um", reader.number("largest_um"));
    keep("slope_um_per_m", reader.number("slope_um_per_m"));
  }
  if (!travel) return;
  axis.settings[axis.rotary ? "from_deg" : "from_mm"] = travel->first;
  axis.settings[axis.rotary ? "to_deg" : "to_mm"] = travel->second;
}

ControlState read_state(TableReader& reader, bool rotary, const std::string& key) {
  ControlState state;
  state.key = key;
  state.line_of_table = reader.line_of("table"), state.line_of_since = reader.line_of("since");
  if (const std::string table = reader.text("table"); !table.empty())
    state.table = table == "none" ? std::string() : table;
  state.backlash = rotary ? reader.number_or_none("backlash_deg", 1.0 / deg_per_rad)
                          : reader.number_or_none("backlash_mm", 1e-3);
  state.since = reader.date("since");
  if ((state.table || state.backlash) && state.since.empty())
    reader.error("since",
                 "is missing: the day on which table and backlash came into the control; they "
                 "count for measurements of later days only");
  return state;
}

RecordedAxis read_recorded_axis(const std::string& name, TableReader& reader) {
  RecordedAxis axis{.rotary = rotary_by_name(name)};
  if (const std::string kind = reader.text("kind"); !kind.empty()) axis.rotary = kind == "rotary";
  reader.settle("kind", axis.rotary ? "rotary" : "linear");
  axis.name = reader.text("name");
  reader.text("gear");  // for people
  read_settings(reader, axis);
  const std::string place = "axes." + name;
  if (ControlState present = read_state(reader, axis.rotary, place); !present.since.empty()) {
    if (present.table) present.files = name;
    axis.states.push_back(std::move(present));
  }
  for (TableReader& one : reader.tables("state")) {
    const char* const other = axis.rotary ? "backlash_mm" : "backlash_deg";
    if (one.number_or_none(other))
      one.error(other, std::string("axis ") + name + " is " + (axis.rotary ? "rotary" : "linear") +
                           ": expected " + (axis.rotary ? "backlash_deg" : "backlash_mm"));
    ControlState state = read_state(one, axis.rotary, place + ".state");
    if (const std::string source = one.text("source"); !source.empty()) state.source = source;
    state.sha256 = one.text("sha256");
    one.span("grid");  // for people, as the two that follow
    one.integer("points");
    one.number("reference");
    one.finish();
    if (state.table) state.files = name + " " + *state.table;
    axis.states.push_back(std::move(state));
  }
  std::stable_sort(axis.states.begin(), axis.states.end(),
                   [](const ControlState& a, const ControlState& b) { return a.since < b.since; });
  reader.finish();
  return axis;
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

/// The files that the record names, from inside of the site.
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

}  // namespace

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
  top.integer("format");
  record.asset = top.text("asset");
  if (!record.asset.empty() && record.asset != asset)
    top.error("asset",
              "expected \"" + asset + "\", as the file is called; found \"" + record.asset + "\"");
  record.maker = top.text("maker");
  record.model = top.text("model");
  record.serial = top.text("serial");
  record.control = top.text("control");
  record.control_version = top.text("control_version");
  record.taken = top.texts("taken").value_or(std::vector<std::string>{});
  if (!std::all_of(record.taken.begin(), record.taken.end(), is_range))
    top.error("taken", "expected numbers or ranges of them, [\"0\", \"100-227\"]");
  for (auto& [name, axis] : top.named_tables("axes"))
    record.axes[name] = read_recorded_axis(name, axis);
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

/// Whose record it is.
Machine machine_of(const RecordFile& r) {
  Machine out;
  out.maker = r.record ? r.record->maker : r.maker;
  out.serial = r.record ? r.record->serial : r.serial;
  return out;
}

/// Not readable, and the machine is not known.
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
