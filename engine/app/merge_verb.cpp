// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "axis_argument.h"
#include "campaign/config/site_files.h"
#include "campaign/planning/plan.h"
#include "campaign/tables/control_state.h"
#include "insert_set.h"
#include "platform/storage/files.h"
#include "questions.h"
#include "table_common.h"
#include "verbs.h"

namespace nonio::app {

Expected<std::string> merged_axis(const std::string& axis, const Campaign& campaign) {
  if (!axis.empty()) return axis;
  std::vector<std::string> measured;
  for (const Measurement& m : campaign.measurements) {
    const std::string of = control_axis(campaign.machine, m);
    if (m.kind == "axis" && std::find(measured.begin(), measured.end(), of) == measured.end())
      measured.push_back(of);
  }
  if (measured.size() == 1) return measured.front();
  std::string list;
  for (const std::string& a : measured) list += (list.empty() ? "" : ", ") + a;
  return fail(measured.empty() ? "the campaign has no measurement of an axis"
                               : "expected --axis, one of " + list);
}

Expected<void> check_day(const std::string& loaded, const std::string& day) {
  if (loaded.empty()) return {};
  if (day.empty())
    return fail(
        "--loaded: campaign.toml does not state date in [campaign], so the order of "
        "measurement and loading is not known");
  if (loaded < day)
    return fail("--loaded " + loaded + " is before the measurement of " + day +
                ": expected the day on which the new table was loaded");
  return {};
}

Expected<std::string> record_loading(const tables::MergedTables& merged, const Loaded& present,
                                     const Settings& options, const std::string& axis,
                                     const std::string& loaded, const OpenCampaign& open) {
  if (loaded.empty()) return std::string();
  const std::string& day = open.campaign().date;
  std::vector<NewState> states;
  if (merged.with.from_backup)
    states.push_back({day, "backup",
                      merged.with.files.empty() ? std::vector<Artifact>{} : present.files,
                      merged.with.backlash, merged.with.tables});
  NewState next{loaded, "nonio", merged.whole, merged.with.backlash, merged.next};
  const NumberTables axes = options.tables("axes");
  if (const auto of = axes.find(axis); of != axes.end())
    for (const char* key : {"reference_mm", "reference_deg"})
      if (const auto at = of->second.find(key); at != of->second.end()) next.reference = at->second;
  for (const LoadedTable& t : merged.next)
    if (t.backlash) next.backlash = t.backlash;
  states.push_back(std::move(next));
  return add_states(open, axis, states);
}

std::vector<Finding> older_measurement(const OpenCampaign& open, const std::string& axis) {
  const auto later = later_campaigns(open, axis);
  if (later.empty() || later.back().date == open.campaign().date) return {};
  return {{"table.older-measurement",
           true,
           {},
           {{"axis", axis},
            {"date", open.campaign().date},
            {"newest", later.back().date},
            {"campaign", later.back().id},
            {"folder", later.back().folder.string()}},
           {},
           {}}};
}

namespace {

struct MergeWish {
  std::string backup, folder, control, axis, out, loaded;
  std::vector<std::string> settings;
};

int tell_merged(const tables::MergedTables& merged, const Loaded& present, const std::string& axis,
                const MergeWish& w, const std::string& recorded, const OpenCampaign& open,
                const Common& common) {
  std::vector<std::string> written;
  if (!w.out.empty())
    for (const Artifact& f : merged.files)
      written.push_back((std::filesystem::path(w.out) / f.name).string());
  if (common.json) {
    TableJson json = {{"schema", "nonio-merge/1"},
                      {"campaign", open.campaign().id},
                      {"control", present.control->info.name},
                      {"axis", axis},
                      {"tables", TableJson::array()}};
    for (const auto& d : merged.differences) json["tables"].push_back(difference_json(d));
    json["predictions"] = TableJson::array();
    for (const auto& f : merged.forecast) json["predictions"].push_back(forecast_json(f));
    json["measured_with"] = merged.with.files.empty() ? "none" : merged.with.files;
    json["files"] = written;
    if (!recorded.empty()) json["recorded"] = recorded;
    print_json(json);
    return exit_done;
  }
  const config::TerminalWords say = open.words();
  for (const auto& d : merged.differences) print_difference(d, say);
  for (const auto& f : merged.forecast) print_forecast(f, say);
  for (const std::string& file : written) std::cout << file << "\n";
  if (!recorded.empty()) std::cout << recorded << "\n";
  return exit_done;
}

/// Parses a value from -10 to 10, in mm or deg, with a decimal point or comma; "none" is 0.
Expected<double> backlash_of(std::string text) {
  if (text == "none") return 0.0;
  std::replace(text.begin(), text.end(), ',', '.');
  double value = 0.0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec == std::errc() && end.ptr == text.data() + text.size() && std::fabs(value) <= 10.0)
    return value;
  return fail("expected the backlash value in mm or deg, or none, found \"" + text + "\"");
}

/// Asks the user for the state of the control that no file states, and returns the answer. An error
/// if there is none.
Expected<tables::StateAnswer> ask_for_state(OpenCampaign& open, const Controller& control,
                                            const std::string& name) {
  const config::TerminalWords say = open.words();
  const Axis* const axis = open.campaign().machine.axis(name);
  const bool rotary = axis != nullptr && axis->rotary;
  Questions ask(true, say);
  std::string table, backlash;
  const auto question = [&](const char* key) {
    return say(key, {{"axis", name},
                     {"date", open.campaign().date},
                     {"unit", rotary ? "deg" : "mm"},
                     {"parameter", control.table.backlash}});
  };
  if (auto done = ask.text(question("insert.ask.table"), table, ""); !done)
    return fail(done.error());
  if (table.empty()) return fail(say("insert.ask.unanswered"));
  tables::StateAnswer answer;
  if (table != "none") {
    NONIO_TRY(answer.files, config::read_table_files(table));
    answer.table = table;
  }
  if (!control.table.backlash.empty() && axis != nullptr && !axis->active_backlash) {
    if (auto done = ask.text(question("insert.ask.backlash"), backlash, ""); !done)
      return fail(done.error());
    if (backlash.empty()) return fail(say("insert.ask.unanswered"));
    NONIO_TRY(const auto value, backlash_of(backlash));
    answer.backlash = value / (rotary ? deg_per_rad : 1e3);
  }
  tables::state_by_answer(open.read, name, answer);
  return answer;
}

int merge(const MergeWish& w, const Common& common) {
  const auto settings = settings_of(w.settings);
  if (!settings) return complain(settings.error().message);
  auto opened = open_campaign(w.folder, common);
  if (!opened) return opened.error();
  OpenCampaign& open = *opened;
  if (const auto day = check_day(w.loaded, open.campaign().date); !day)
    return complain(text_of(day.error()));
  const auto set = tables::set_of_axes(w.axis, open.campaign().machine);
  const auto axis = merged_axis(w.axis, open.campaign());
  if (!axis) return complain(axis.error().message);
  const auto options = [&](const Info& info) { return campaign_options(open, info, *settings); };
  const std::string control = w.control.empty() ? open.campaign().machine.control : w.control;
  const auto present =
      load(open.place->plugins, w.backup, control, open.campaign(), *settings, options);
  if (!present) return complain(text_of(present.error()));
  if (!set.empty())
    return insert_set({w.axis, w.out, w.loaded}, *present, *options(present->control->info), set,
                      open, common);
  const auto merge_now = [&] {
    return merge_axis_now(open, *present, *options(present->control->info), *axis);
  };
  auto merged = merge_now();
  StateAnswers answers;
  if (!merged) {
    auto asked = ask_for_states(open, *present->control, {*axis}, merged.error(), common);
    if (!asked) return complain(text_of(asked.error()), exit_failed);
    answers = std::move(*asked);
    if (!answers.empty()) merged = merge_now();
  }
  if (!merged) return complain(text_of(merged.error()), exit_failed);
  tell_findings(open, older_measurement(open, *axis));
  tell_findings(open, merged->findings);
  if (merged->files.empty()) return complain("nothing was written", exit_failed);
  if (!w.out.empty())
    if (auto done = storage::publish(std::filesystem::absolute(w.out), merged->files); !done)
      return complain(text_of(done.error()), exit_failed);
  auto answered = record_answers(open, answers);
  if (!answered) return complain(text_of(answered.error()), exit_failed);
  auto recorded =
      record_loading(*merged, *present, *options(present->control->info), *axis, w.loaded, open);
  if (!recorded) return complain(text_of(recorded.error()), exit_failed);
  if (recorded->empty()) *recorded = std::move(*answered);
  return tell_merged(*merged, *present, *axis, w, *recorded, open, common);
}

}  // namespace

Expected<StateAnswers> ask_for_states(OpenCampaign& open, const Controller& control,
                                      const std::vector<std::string>& axes, const Error& why,
                                      const Common& common) {
  StateAnswers answers;
  if (common.json || !Questions::on_terminal()) return answers;
  for (const std::string& axis : axes) {
    const Axis* const of = open.campaign().machine.axis(axis);
    if (of == nullptr || of->active_table) continue;
    if (answers.empty()) complain(text_of(why));
    NONIO_TRY(answers[axis], ask_for_state(open, control, axis));
  }
  return answers;
}

Expected<std::string> record_answers(const OpenCampaign& open, const StateAnswers& answers) {
  std::string record;
  if (open.campaign().date.empty()) return record;
  if (open.campaign().machine.asset.empty() && !open.read.machine) return record;
  for (const auto& [axis, answer] : answers) {
    NONIO_TRY(
        record,
        add_states(open, axis, {{open.campaign().date, "answer", answer.files, answer.backlash}}));
  }
  return record;
}

Verb insert_verb(Common& common) {
  auto w = std::make_shared<MergeWish>();
  using Takes = Argument::Takes;
  return {
      .name = "insert",
      .summary =
          "Inserts a new table into a backup of a control and leaves everything else unchanged",
      .arguments = joined(
          {required(takes(Takes::file, {"BACKUP", &w->backup,
                                        "Files saved from the control: FILE, or FILE,FILE,..."})),
           required(takes(Takes::folder, {"--with", &w->folder, "Folder of the campaign"})),
           {"--axis", &w->axis,
            "The axis (default: the measured axis, if there is only one); XY: the tables of both, "
            "and of one by the other"},
           takes(Takes::folder, {"--out", &w->out,
                                 "Folder for the changed files (default: only print the changes)"}),
           day({"--loaded", &w->loaded,
                "YYYY-MM-DD: the new table was loaded on this day. Records it in "
                "machines/<asset>.toml, "
                "and what was active during the measurement"}),
           takes(Argument::Takes::control,
                 {"--control", &w->control, "The control of the files (`nonio table controls`)"}),
           settings_argument(w->settings,
                             "NAME=VALUE: an option of that control; may be given several times")},
          common_arguments(common)),
      .footer =
          "BACKUP is the state of the control during the measurement, unless the campaign "
          "(active_table) or the record of the machine states another one. Its table is removed "
          "from the readings, so that the new table is complete. If the table of the backup was "
          "made "
          "from this campaign or from a later one, or contradicts the record, the command ends "
          "with "
          "an error; on a terminal it prompts for a state that is stated nowhere. It prints the "
          "differences, and E, B and M as measured and with all files "
          "loaded, and warns if a later campaign of the site measured this axis of the "
          "machine.\n\nFiles with several axes (FANUC's parameters and pitch data, SINUMERIK's "
          "archives, HEIDENHAIN's CONFIG.CMA, lists of TwinCAT, Aerotech) keep every other byte; "
          "the new table gets the numbers that the axis has in the backup, or free ones. If the "
          "control would read a different table for another axis, nothing is written. For other "
          "controls the files of the axis are written again.\n\n--axis XY inserts what the "
          "diagonals of "
          "the campaign determine: the tables of X and Y, of both sides of a gantry, and those of "
          "one axis by the position of the other (straightness and squareness). Each axis has its "
          "state, as above. It prints the range of each diagonal as measured and with all files "
          "loaded.\n\nExit status: 0 inserted; 1 "
          "refused; 2 usage or configuration.",
      .examples =
          {"nonio table insert backup/CNCPARAM.TXT --with site/2026-11-rossi --axis Z --out load"},
      .run = [w, &common] { return merge(*w, common); }};
}

}  // namespace nonio::app
