// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "campaign/tables/table_check.h"
#include "nonio/sdk/format.h"
#include "platform/process/guarded.h"

namespace nonio::tables {
namespace {

using ReadTables = std::vector<LoadedTable>;

bool is_own(const TableDifference& d, const std::string& axis) {
  return d.output == axis && d.input == std::vector{axis};
}

/// The readings of this axis by themselves, as `on` leaves them.
struct OneAxis {
  Campaign campaign;
  std::vector<Observations> readings, measured;
};

Expected<OneAxis> one_axis(const reading::ReadCampaign& read, const std::string& axis,
                           const std::optional<Underlay>& on) {
  const Campaign& campaign = read.manifest->campaign;
  OneAxis one{campaign, {}, {}};
  one.campaign.measurements.clear();
  std::vector<std::string> others;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.kind != "axis" || read.observations[i].size() == 0) continue;
    if (const std::string of = control_axis(campaign.machine, m); of != axis) {
      others.push_back(of);
      continue;
    }
    one.campaign = with_one(campaign, m);
    one.readings.push_back(on ? on->readings[i] : read.observations[i]);
    one.measured.push_back(read.observations[i]);
  }
  if (one.readings.size() == 1) return one;  // the campaign has this one measurement
  if (!one.readings.empty())
    return fail("axis " + axis + " has " + std::to_string(one.readings.size()) +
                " measurements; expected one");
  std::string list;
  for (const std::string& o : others) list += (list.empty() ? "" : ", ") + o;
  return fail("no measurement of axis " + axis + "; there are " + (list.empty() ? "none" : list));
}

/// The backup contains the table that was active while the axis was measured, unless the campaign
/// states another one: it is removed from the readings, so that the new table is complete.
Expected<void> take_active_of_backup(OneAxis& one, const Controller& controller,
                                     const std::vector<Artifact>& backup, const std::string& axis,
                                     Settings& options, std::vector<Finding>& findings) {
  auto& axes = one.campaign.machine.axes;
  const auto of_campaign =
      std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == axis; });
  if (of_campaign == axes.end() || of_campaign->active_table ||
      one.campaign.measurements.front().compensation == "off")
    return {};
  const auto present = tables_in(controller, backup, one.campaign, options);
  if (!present) return fail(present.error());
  std::string files;
  for (const Artifact& f : backup) files += (files.empty() ? "" : ", ") + f.name;
  std::optional<double> backlash = of_campaign->active_backlash;
  bool corrected = false;
  for (const LoadedTable& t : *present) {
    if (t.output != axis || t.input != std::vector{axis}) continue;
    corrected = true;
    if (t.backlash) backlash = t.backlash;
  }
  if (!backlash) backlash = stated_backlash(options, axis, of_campaign->rotary);
  if (!backlash && !controller.table.backlash.empty())
    return fail(files + " does not contain the value of " + controller.table.backlash +
                " of axis " + axis +
                ", which was active during the measurement: give its file too, or state " +
                (of_campaign->rotary ? "active_backlash_deg" : "active_backlash_mm") +
                " in [machine.axes." + axis + "]");
  one.readings = without_tables(one.campaign, one.readings, *present);
  of_campaign->active_table = corrected ? files : std::string();
  of_campaign->active_backlash = backlash.value_or(0.0);
  state_backlash(options, axis, of_campaign->rotary, *of_campaign->active_backlash);
  findings.push_back({"table.active-from-backup",
                      true,
                      {},
                      {{"axis", axis}, {"files", files}},
                      one.campaign.measurements.front().id,
                      {}});
  return {};
}

/// What the control would have after the merge, held against what it has and what is new.
Expected<void> only_this_axis(const ReadTables& present, const ReadTables& fresh,
                              const ReadTables& next, const std::string& axis) {
  constexpr double nothing = 1e-12;  // m, rad
  for (const TableDifference& d : differences(present, next)) {
    if (is_own(d, axis)) continue;
    if (!d.present || !d.next || d.largest > nothing || d.present->backlash != d.next->backlash)
      return fail("the table of " + d.output + " by " + d.input.front() +
                  " would change too; nothing was written");
  }
  bool there = false;
  for (const TableDifference& d : differences(fresh, next)) {
    if (!is_own(d, axis)) continue;
    there = d.present && d.next;
    if (!there || d.largest > nothing)
      return fail("the control would not read the new table of " + axis +
                  " back from the merged file; nothing was written");
    if (d.present->backlash && d.next->backlash != d.present->backlash)
      return fail("the files of the backup hold another backlash value of " + axis +
                  " than the new table needs; nothing was written");
  }
  return there ? Expected<void>{} : fail("the merged file holds no table of " + axis);
}

}  // namespace

Expected<CampaignTables> tables_of_campaign(const reading::ReadCampaign& read,
                                            const Controller& controller, const Settings& given) {
  const auto on = active_compensation(read, controller, given);
  if (!on) return fail(on.error());
  const Settings& options = *on ? (*on)->options : given;
  const Campaign& campaign = read.manifest->campaign;
  const Results none;
  auto written = process::guarded("controller " + controller.info.name, [&] {
    return controller.write({campaign, *on ? (*on)->readings : read.observations, none, options});
  });
  if (!written) return fail(written.error());
  CampaignTables out{std::move(written->artifacts), {}, std::move(written->findings)};
  if (out.files.empty()) return out;
  auto tables = tables_in(controller, out.files, campaign, options);
  if (!tables) return fail(tables.error());
  out.tables = std::move(*tables);
  return out;
}

Expected<MergedTables> merge_tables(const reading::ReadCampaign& read, const Controller& controller,
                                    const Settings& given, const std::vector<Artifact>& backup,
                                    const std::string& axis) {
  const std::string who = "controller " + controller.info.name;
  if (controller.merge == nullptr)
    return fail(controller.info.name +
                " does not merge: load the new file of the axis as it is, in place of the old one");
  const auto on = active_compensation(read, controller, given);
  if (!on) return fail(on.error());
  Settings options = *on ? (*on)->options : given;
  auto one = one_axis(read, axis, *on);
  if (!one) return fail(one.error());
  std::vector<Finding> findings;
  if (auto taken = take_active_of_backup(*one, controller, backup, axis, options, findings); !taken)
    return fail(taken.error());
  const Results none;
  auto written = process::guarded(who, [&] {
    return controller.write({one->campaign, one->readings, none, options});
  });
  if (!written) return fail(written.error());
  MergedTables out{
      .files = {}, .differences = {}, .findings = written->findings, .notes = written->notes};
  out.findings.insert(out.findings.begin(), findings.begin(), findings.end());
  if (written->artifacts.empty()) return out;  // refused; the findings say why
  const Campaign& campaign = read.manifest->campaign;
  auto changed = process::guarded(who, [&] {
    return controller.merge({backup, written->artifacts, axis, campaign, options});
  });
  if (!changed) return fail(changed.error());
  std::vector<Artifact> whole = backup;
  for (const Artifact& f : *changed) {
    const auto same = std::find_if(whole.begin(), whole.end(),
                                   [&](const Artifact& a) { return a.name == f.name; });
    if (same != whole.end())
      *same = f;
    else
      whole.push_back(f);
  }
  const auto present = tables_in(controller, backup, campaign, options),
             next = tables_in(controller, whole, campaign, options),
             fresh = tables_in(controller, written->artifacts, campaign, options);
  for (const auto* tables : {&present, &next, &fresh})
    if (!*tables) return fail(tables->error());
  if (auto only = only_this_axis(*present, *fresh, *next, axis); !only) return fail(only.error());
  out.files = std::move(*changed);
  out.differences = differences(*present, *next);
  return out;
}

}  // namespace nonio::tables
