// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "campaign/tables/control_state.h"
#include "campaign/tables/table_check.h"
#include "nonio/sdk/format.h"
#include "platform/process/guarded.h"

namespace nonio::tables {
namespace {

using ReadTables = std::vector<LoadedTable>;

bool is_own(const TableDifference& d, const std::string& axis) {
  return d.output == axis && d.input == std::vector{axis};
}

struct OneAxis {
  Campaign campaign;
  std::vector<Observations> readings;  ///< without the active compensation
  std::vector<Observations> measured;
};

Expected<OneAxis> one_axis(const reading::ReadCampaign& read, const std::string& axis) {
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
    one.readings.push_back(read.observations[i]);
    one.measured.push_back(read.observations[i]);
  }
  if (one.readings.size() == 1) return one;
  if (!one.readings.empty())
    return fail("axis " + axis + " has " + std::to_string(one.readings.size()) +
                " measurements; expected one");
  std::string list;
  for (const std::string& o : others) list += (list.empty() ? "" : ", ") + o;
  return fail("no measurement of axis " + axis + "; there are " + (list.empty() ? "none" : list));
}

void take_active(OneAxis& one, const MeasuredWith& with, const std::string& axis,
                 Settings& options) {
  for (Axis& a : one.campaign.machine.axes) {
    if (a.name != axis) continue;
    a.active_table = with.files;
    a.active_backlash = with.backlash;
    if (with.backlash) state_backlash(options, axis, a.rotary, *with.backlash);
  }
  one.readings = without_tables(one.campaign, one.measured, with.tables);
}

/// Returns an error unless the merge changes only the table of this axis and no backlash value, and
/// the control reads the new table back unchanged.
Expected<void> only_this_axis(const ReadTables& present, const ReadTables& fresh,
                              const ReadTables& next, const std::string& axis) {
  constexpr double nothing = 1e-12;  // largest difference regarded as rounding, m or rad
  for (const TableDifference& d : differences(present, next)) {
    if (is_own(d, axis)) continue;
    if (!d.present || !d.next || d.largest > nothing || d.present->backlash != d.next->backlash)
      return fail("the table of " + d.output + " by " + d.input.front() +
                  " would change too; nothing was written: give only files that contain the table "
                  "of " +
                  axis);
  }
  bool there = false;
  for (const TableDifference& d : differences(fresh, next)) {
    if (!is_own(d, axis)) continue;
    there = d.present && d.next;
    if (!there || d.largest > nothing)
      return fail("the control would not read the new table of " + axis +
                  " back from the merged file, because another table of " + axis +
                  " remains in the backup; nothing was written: delete that table in the control "
                  "and save the backup again");
    if (d.present->backlash && d.next->backlash != d.present->backlash)
      return fail("the files of the backup hold another backlash value of " + axis +
                  " than the new table needs; nothing was written");
  }
  return there ? Expected<void>{} : fail("the merged file holds no table of " + axis);
}

/// Because the whole file is loaded, the backup must contain the last recorded tables of other
/// axes.
Expected<void> not_outdated(const reading::ReadCampaign& read, const Controller& controller,
                            const ReadTables& present, const std::string& axis,
                            const Settings& options) {
  if (!read.machine) return {};
  for (const auto& [name, recorded] : read.machine->axes) {
    const auto own = own_tables(present, name);
    if (name == axis || own.empty() || recorded.states.empty()) continue;
    const config::ControlState& last = recorded.states.back();
    const auto files = read.state_files.find(last.files);
    if (!last.table || (!last.table->empty() && files == read.state_files.end())) continue;
    ReadTables stated;
    if (!last.table->empty()) {
      const auto in = tables_in(controller, files->second, read.manifest->campaign, options);
      if (!in) continue;
      stated = own_tables(*in, name);
    }
    if (same_correction(own, stated, name)) continue;
    return fail("the backup contains another table of " + name + " than " + read.machine->file +
                " states since " + last.since +
                ", and loading the whole file would replace that one: save the backup again, or "
                "correct [[axes." +
                name + ".state]]");
  }
  return {};
}

}  // namespace

Expected<CampaignTables> tables_of_campaign(const reading::ReadCampaign& read,
                                            const Controller& controller, const Settings& given) {
  NONIO_TRY(const auto on, active_compensation(read, controller, given));
  const Settings& options = on ? on->options : given;
  const Campaign& campaign = read.manifest->campaign;
  const Results none;
  auto written = process::guarded("controller " + controller.info.name, [&] {
    return controller.write({campaign, on ? on->readings : read.observations, none, options});
  });
  if (!written) return fail(written.error());
  CampaignTables out{std::move(written->artifacts), {}, std::move(written->findings)};
  if (out.files.empty()) return out;
  NONIO_TRY(auto tables, tables_in(controller, out.files, campaign, options));
  out.tables = std::move(tables);
  return out;
}

Expected<MergedTables> merge_tables(const reading::ReadCampaign& read, const Controller& controller,
                                    const Settings& given, const std::vector<Artifact>& backup,
                                    const std::string& axis) {
  const std::string who = "controller " + controller.info.name;
  NONIO_TRY(auto one, one_axis(read, axis));
  Settings options = given;
  std::vector<Finding> findings;
  NONIO_TRY(const auto with, measured_with(read, controller, backup, axis, options, findings));
  take_active(one, with, axis, options);
  const Results none;
  auto written = process::guarded(who, [&] {
    return controller.write({one.campaign, one.readings, none, options});
  });
  if (!written) return fail(written.error());
  MergedTables out{.files = {},
                   .whole = {},
                   .differences = {},
                   .forecast = {},
                   .with = with,
                   .next = {},
                   .findings = written->findings,
                   .notes = written->notes};
  out.findings.insert(out.findings.begin(), findings.begin(), findings.end());
  if (written->artifacts.empty()) return out;
  const Campaign& campaign = read.manifest->campaign;
  const bool merges = controller.merge != nullptr;
  auto changed =
      merges ? process::guarded(
                   who,
                   [&] {
                     return controller.merge({backup, written->artifacts, axis, campaign, options});
                   })
             : written->artifacts;
  if (!changed) return fail(changed.error());
  std::vector<Artifact> whole = merges ? backup : std::vector<Artifact>{};
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
  if (merges)
    if (auto ok = not_outdated(read, controller, *present, axis, options); !ok)
      return fail(ok.error());
  if (auto only = only_this_axis(*present, *fresh, *next, axis); !only) return fail(only.error());
  out.files = std::move(*changed);
  out.whole = std::move(whole);
  out.differences = differences(*present, *next);
  out.next = own_tables(*next, axis);
  out.forecast.push_back(forecast_of_axis(one.campaign, one.campaign.measurements.front(), axis,
                                          one.measured.front(), one.readings.front(), *next,
                                          options));
  return out;
}

}  // namespace nonio::tables
