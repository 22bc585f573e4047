// SPDX-License-Identifier: Apache-2.0
#include "insert_set.h"

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "campaign/evaluation/evaluation.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "platform/storage/files.h"
#include "state_record.h"
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

}  // namespace nonio::app
