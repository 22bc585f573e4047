// SPDX-License-Identifier: Apache-2.0
#include "insert_set.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <tuple>

#include "campaign/config/machines.h"
#include "campaign/config/site_files.h"
#include "campaign/evaluation/evaluation.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"
#include "tables.h"

namespace nonio::app {

namespace {

/// Analyses for which nothing is printed.
struct Analysed {
  explicit Analysed(const OpenCampaign& open)
      : work{open.place->context, quiet, open.read, errors} {
    results.analyses = evaluation::run_analyses(work);
  }
  const reading::Stage quiet = [](const std::string&) {};
  std::vector<Error> errors{};
  const evaluation::Work work;
  Results results{};
};

bool moves_any(const Machine& machine, const Measurement& m, const std::vector<std::string>& axes) {
  return std::any_of(axes.begin(), axes.end(), [&](const std::string& axis) {
    return m.axis == axis || control_axis(machine, m) == axis || m.from.contains(axis);
  });
}

/// What prevents tables in `nonio run` prevents them here.
Expected<void> refuse_doubts(const OpenCampaign& open, Analysed& now,
                             const std::vector<std::string>& axes) {
  for (Results::Analysed& a :
       reading::implausible(open.read, open.place->context, open.read.inputs, now.results.analyses))
    now.results.analyses.push_back(std::move(a));
  const auto doubts = evaluation::open_doubts(now.work, now.results.analyses);
  if (!now.errors.empty()) return fail(now.errors.front());
  for (const Measurement& m : open.campaign().measurements)
    if (const auto of = doubts.find(m.id);
        of != doubts.end() && moves_any(open.campaign().machine, m, axes))
      return fail("measurement " + m.id + ": finding " + *of->second.begin() +
                  " prevents tables: correct the cause, or accept it with a reason "
                  "([[tables.accept]] in campaign.toml)");
  return {};
}

}  // namespace

Expected<tables::MergedTables> merge_axis_now(const OpenCampaign& open, const Loaded& present,
                                              const Settings& options, const std::string& axis) {
  Analysed now(open);
  now.errors.clear();  // the table needs no analysis
  if (auto sound = refuse_doubts(open, now, {axis}); !sound) return fail(sound.error());
  return tables::merge_tables(open.read, *present.control, options, present.files, axis);
}

Expected<tables::MergedSet> merge_set_now(const OpenCampaign& open, const Loaded& present,
                                          const Settings& options,
                                          const std::vector<std::string>& set) {
  Analysed now(open);
  if (!now.errors.empty()) return fail(now.errors.front());
  if (auto sound = refuse_doubts(open, now, set); !sound) return fail(sound.error());
  return tables::merge_set(open.read, now.results, *present.control, options, present.files, set);
}

Expected<std::string> record_set(const tables::MergedSet& merged, const Loaded& present,
                                 const Settings& options, const std::vector<std::string>& set,
                                 const std::string& loaded, const OpenCampaign& open) {
  std::string record;
  for (const std::string& axis : set) {
    tables::MergedTables one;
    one.whole = merged.whole;
    one.with = merged.with.at(axis);
    one.next = tables::own_tables(merged.next, axis);
    NONIO_TRY(record, record_loading(one, present, options, axis, loaded, open));
  }
  return record;
}

namespace {

TableJson json_of(const tables::MergedSet& merged) {
  TableJson json = {{"tables", TableJson::array()},
                    {"predictions", TableJson::array()},
                    {"lines", TableJson::array()},
                    {"measured_with", TableJson::object()}};
  for (const auto& d : merged.differences) json["tables"].push_back(difference_json(d));
  for (const auto& f : merged.forecast) json["predictions"].push_back(forecast_json(f));
  for (const auto& line : merged.lines) {
    TableJson one = {{"measurement", line.measurement}};
    put(one, "before", line.before, Quantity::deviation);
    put(one, "after", line.after, Quantity::deviation);
    json["lines"].push_back(std::move(one));
  }
  for (const auto& [axis, with] : merged.with)
    json["measured_with"][axis] = with.files.empty() ? "none" : with.files;
  return json;
}

}  // namespace

int insert_set(const SetWish& w, const Loaded& present, const Settings& options,
               const std::vector<std::string>& set, OpenCampaign& open, const Common& common) {
  auto merged = merge_set_now(open, present, options, set);
  StateAnswers answers;
  if (!merged) {
    auto asked = ask_for_states(open, *present.control, set, merged.error(), common);
    if (!asked) return complain(text_of(asked.error()), exit_failed);
    answers = std::move(*asked);
    if (!answers.empty()) merged = merge_set_now(open, present, options, set);
  }
  if (!merged) return complain(text_of(merged.error()), exit_failed);
  for (const std::string& axis : set) tell_findings(open, older_measurement(open, axis));
  tell_findings(open, merged->findings);
  if (merged->files.empty())
    return complain(
        "no table of one axis by the position of another was made of this campaign, so "
        "nothing was written: the findings state the reason, or the diagonals over " +
            w.axis + " are missing",
        exit_failed);
  std::vector<std::string> written;
  if (!w.out.empty()) {
    if (auto done = storage::publish(std::filesystem::absolute(w.out), merged->files); !done)
      return complain(text_of(done.error()), exit_failed);
    for (const Artifact& f : merged->files)
      written.push_back((std::filesystem::path(w.out) / f.name).string());
  }
  auto recorded = record_answers(open, answers);
  if (recorded && !w.loaded.empty())
    recorded = record_set(*merged, present, options, set, w.loaded, open);
  if (!recorded) return complain(text_of(recorded.error()), exit_failed);
  if (common.json) {
    TableJson json = {{"schema", "nonio-merge/1"},
                      {"campaign", open.campaign().id},
                      {"control", present.control->info.name},
                      {"axis", w.axis}};
    json.update(json_of(*merged));
    json["files"] = written;
    if (!recorded->empty()) json["recorded"] = *recorded;
    print_json(json);
    return exit_done;
  }
  const config::TerminalWords say = open.words();
  for (const auto& d : merged->differences) print_difference(d, say);
  for (const auto& f : merged->forecast) print_forecast(f, say);
  for (const auto& line : merged->lines)
    sentence(std::cout, 0,
             say("session.set.line", {{"line", line.measurement},
                                      {"before", with_unit(line.before, Quantity::deviation, say)},
                                      {"after", with_unit(line.after, Quantity::deviation, say)}}));
  for (const std::string& file : written) std::cout << file << "\n";
  if (!recorded->empty()) std::cout << *recorded << "\n";
  return exit_done;
}

namespace fs = std::filesystem;

namespace {

/// Compares the records of the machines, otherwise the asset, or maker and serial number.
bool is_same_machine(const config::MachineRecords& records, const Machine& a, const Machine& b) {
  const auto of_a = config::record_of(records, a), of_b = config::record_of(records, b);
  if (of_a && of_b && *of_a != nullptr && *of_a == *of_b) return true;
  const std::string name = config::machine_input(a);
  return !name.empty() && name == config::machine_input(b);
}

bool has_readings(const Campaign& campaign, const std::string& axis, const fs::path& folder) {
  std::error_code error;
  return std::any_of(
      campaign.measurements.begin(), campaign.measurements.end(), [&](const Measurement& m) {
        const bool of_axis = m.kind == "axis" ? control_axis(campaign.machine, m) == axis
                                              : m.kind == "diagonal" && m.from.contains(axis);
        return of_axis && fs::is_regular_file(folder / m.file, error);
      });
}

}  // namespace

std::vector<LaterCampaign> later_campaigns(const OpenCampaign& open, const std::string& axis) {
  const Campaign& mine = open.campaign();
  std::vector<LaterCampaign> found;
  std::error_code error;
  const fs::path own = fs::canonical(open.folder, error);
  if (error || mine.date.empty()) return found;
  const auto look = [&](const fs::path& folder) {
    if (folder == own) return;
    const auto text = storage::read_small_file(folder / config::manifest_name);
    if (!text) return;
    const auto read =
        config::parse_manifest(*text, config::manifest_name, open.place->plugins.methods());
    if (!read) return;
    const std::string& date = read->campaign.date;
    if (!(date > mine.date || (date == mine.date && read->purpose == "check")) ||
        !is_same_machine(open.place->context.machines, mine.machine, read->campaign.machine) ||
        !has_readings(read->campaign, axis, folder))
      return;
    found.push_back({folder, read->campaign.id, date, read->purpose});
  };
  const fs::path site = fs::canonical(config::site_of(own), error);
  if (error || site == own) {
    for (const auto& entry : fs::directory_iterator(own.parent_path(), error)) look(entry.path());
  } else {
    fs::recursive_directory_iterator it(site, fs::directory_options::skip_permission_denied, error);
    for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
      if (it->path().filename().string().starts_with('.')) it.disable_recursion_pending();
      if (it->path().filename() == config::manifest_name) look(it->path().parent_path());
    }
  }
  std::sort(found.begin(), found.end(), [](const LaterCampaign& a, const LaterCampaign& b) {
    return std::tie(a.date, a.id) < std::tie(b.date, b.id);
  });
  return found;
}

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

std::string toml_real(double value) {
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
           toml_real(*state.backlash * (rotary ? deg_per_rad : 1e3)) + "\n";
  out += "source = \"" + state.source + "\"\n";
  if (!list.empty()) out += "sha256 = \"" + config::table_sha256(state.files) + "\"\n";
  for (const LoadedTable& t : state.tables) {
    if (t.position.size() != 1 || t.position.front().size() < 2) continue;
    const auto& at = t.position.front();
    const double per = rotary ? deg_per_rad : 1e3;
    out += "grid = [" + toml_real(at.front() * per) + ", " + toml_real(at.back() * per) + "]\n";
    out += "points = " + std::to_string(at.size()) + "\n";
    break;
  }
  if (state.reference && !list.empty()) out += "reference = " + toml_real(*state.reference) + "\n";
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
