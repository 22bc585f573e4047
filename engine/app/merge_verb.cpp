// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "axis_argument.h"
#include "campaign/planning/plan.h"
#include "platform/storage/files.h"
#include "table_common.h"
#include "verbs.h"

namespace nonio::app {

namespace {

struct MergeWish {
  std::string backup, folder, control, axis, out;
  std::vector<std::string> settings;
};

/// The axis that is said, or the only one that was measured.
Expected<std::string> merged_axis(const MergeWish& w, const Campaign& campaign) {
  if (!w.axis.empty()) return w.axis;
  std::vector<std::string> measured;
  for (const Measurement& m : campaign.measurements) {
    const std::string axis = control_axis(campaign.machine, m);
    if (m.kind == "axis" && std::find(measured.begin(), measured.end(), axis) == measured.end())
      measured.push_back(axis);
  }
  if (measured.size() == 1) return measured.front();
  std::string list;
  for (const std::string& a : measured) list += (list.empty() ? "" : ", ") + a;
  return fail(measured.empty() ? "the campaign has no measurement of an axis"
                               : "expected --axis, one of " + list);
}

int tell_merged(const tables::MergedTables& merged, const Loaded& present, const std::string& axis,
                const MergeWish& w, const OpenCampaign& open, const Common& common) {
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
    json["files"] = written;
    print_json(json);
    return exit_done;
  }
  for (const auto& d : merged.differences) print_difference(d);
  for (const std::string& file : written) std::cout << file << "\n";
  return exit_done;
}

int merge(const MergeWish& w, const Common& common) {
  const auto settings = settings_of(w.settings);
  if (!settings) return complain(settings.error().message);
  const auto opened = open_campaign(w.folder, common);
  if (!opened) return opened.error();
  const OpenCampaign& open = *opened;
  const auto axis = merged_axis(w, open.campaign());
  if (!axis) return complain(axis.error().message);
  const auto options = [&](const Info& info) { return campaign_options(open, info, *settings); };
  const std::string control = w.control.empty() ? open.campaign().machine.control : w.control;
  const auto present =
      load(open.place->plugins, w.backup, control, open.campaign(), *settings, options);
  if (!present) return complain(text_of(present.error()));
  const auto merged = tables::merge_tables(open.read, *present->control,
                                           *options(present->control->info), present->files, *axis);
  if (!merged) return complain(text_of(merged.error()), exit_failed);
  tell_findings(open, merged->findings);
  if (merged->files.empty()) return complain("nothing was written", exit_failed);
  if (!w.out.empty())
    if (auto done = storage::publish(std::filesystem::absolute(w.out), merged->files); !done)
      return complain(text_of(done.error()), exit_failed);
  return tell_merged(*merged, *present, *axis, w, open, common);
}

}  // namespace

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
           {"--axis", &w->axis, "The axis (default: the measured axis, if there is only one)"},
           takes(Takes::folder, {"--out", &w->out,
                                 "Folder for the changed files (default: only print the changes)"}),
           {"--control", &w->control, "The control of the files (`nonio table controls`)"},
           settings_argument(w->settings,
                             "NAME=VALUE: an option of that control; may be given several times")},
          common_arguments(common)),
      .footer =
          "For files with several axes: FANUC's parameters and pitch data, SINUMERIK's archives, "
          "HEIDENHAIN's CONFIG.CMA. The new table gets the numbers that the axis has in the "
          "backup, or free ones. Every other byte stays unchanged. If the control would read a "
          "different table for another axis, nothing is written.\n\nExit status: 0 merged; 1 "
          "refused; 2 usage or configuration.",
      .examples =
          {"nonio table insert backup/CNCPARAM.TXT --with site/2026-11-rossi --axis Z --out load"},
      .run = [w, &common] { return merge(*w, common); }};
}

}  // namespace nonio::app
