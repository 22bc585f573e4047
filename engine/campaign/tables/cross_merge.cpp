// SPDX-License-Identifier: Apache-2.0
#include "campaign/tables/cross_merge.h"

#include <algorithm>
#include <cmath>

#include "campaign/tables/control_state.h"
#include "nonio/math/beam.h"
#include "nonio/math/compensated.h"
#include "nonio/math/loaded_table.h"
#include "platform/process/guarded.h"

namespace nonio::tables {
namespace {

using ReadTables = std::vector<LoadedTable>;
using Names = std::vector<std::string>;

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_cross(const LoadedTable& t) { return t.input != Names{t.output}; }

/// Whether a table moves an axis of the set by axes of the set.
bool is_within(const std::string& output, const Names& input, const Names& set) {
  return contains(set, output) && std::all_of(input.begin(), input.end(), [&](const auto& axis) {
           return contains(set, axis);
         });
}

/// Files of one table or of several that were written together. `axis`: the axis whose position
/// selects the values of all of them, or the whole set.
struct Group {
  std::string axis;
  std::vector<Artifact> files;
};

/// Groups the files of the set. A file without a table belongs to the one before it.
Expected<std::vector<Group>> groups_of(const Controller& controller, const Campaign& campaign,
                                       const Settings& options, const std::vector<Artifact>& files,
                                       const Names& set) {
  std::vector<Group> out;
  bool belongs = false;
  for (const Artifact& file : files) {
    const auto tables = tables_in(controller, {file}, campaign, options);
    if (!tables || tables->empty()) {
      if (belongs) out.back().files.push_back(file);
      continue;
    }
    belongs = std::all_of(tables->begin(), tables->end(),
                          [&](const LoadedTable& t) { return is_within(t.output, t.input, set); });
    if (!belongs) continue;
    const Names& input = tables->front().input;
    const bool one =
        input.size() == 1 && std::all_of(tables->begin(), tables->end(),
                                         [&](const LoadedTable& t) { return t.input == input; });
    std::string axis = one ? input.front() : "";
    for (std::size_t i = 0; !one && i < set.size(); ++i) axis += set[i];
    out.push_back({std::move(axis), {file}});
  }
  return out;
}

/// Error if a comment of the backup states that its tables of several axes are of this campaign.
Expected<void> not_of_this_campaign(const std::vector<Artifact>& backup, const std::string& id) {
  for (const Artifact& f : backup) {
    std::uint64_t number = 0;
    for (std::size_t at = 0; at < f.bytes.size();) {
      const std::size_t next = std::min(f.bytes.find('\n', at), f.bytes.size());
      std::string line = f.bytes.substr(at, next - at);
      at = next + 1, ++number;
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == ')'))
        line.pop_back();
      if (line.find("diagonals of ") != std::string::npos && line.ends_with(", campaign " + id))
        return fail(f.name + ":" + std::to_string(number) +
                    ": the tables of several axes were made from campaign " + id +
                    ", so they were loaded after it was measured: give the backup from before, or "
                    "state active_table of each axis in campaign.toml");
    }
  }
  return {};
}

/// The campaign with the compensation that was active stated for each axis of the set.
Expected<reading::ReadCampaign> with_state(const reading::ReadCampaign& read,
                                           const Controller& controller,
                                           const std::vector<Artifact>& backup, const Names& set,
                                           Settings& options, MergedSet& out) {
  reading::ReadCampaign stated = read;
  for (Axis& axis : stated.manifest->campaign.machine.axes) {
    if (!contains(set, axis.name)) continue;
    const auto with = measured_with(read, controller, backup, axis.name, options, out.findings);
    if (!with) return fail(with.error());
    out.with[axis.name] = *with;
    if (with->from_backup) {
      if (auto ok = not_of_this_campaign(backup, read.manifest->campaign.id); !ok)
        return fail(ok.error());
      axis.active_table = with->files;
      stated.active_tables[axis.name] = backup;
    }
    axis.active_backlash = with->backlash;
    if (with->backlash) state_backlash(options, axis.name, axis.rotary, *with->backlash);
  }
  return stated;
}

/// Checks that only tables of the set change, and that the control reads the new ones back.
Expected<void> only_this_set(const ReadTables& present, const ReadTables& fresh,
                             const ReadTables& next, const Names& set) {
  constexpr double nothing = 1e-12;  // largest difference that is regarded as rounding, m or rad
  for (const TableDifference& d : differences(present, next)) {
    if (is_within(d.output, d.input, set)) continue;
    if (!d.present || !d.next || d.largest > nothing || d.present->backlash != d.next->backlash)
      return fail("the table of " + d.output + " by " + d.input.front() +
                  " would change too; nothing was written: name its axis in --axis too");
  }
  for (const TableDifference& d : differences(fresh, next)) {
    if (!d.present) continue;
    if (!d.next || d.largest > nothing)
      return fail("the control would not read the new table of " + d.output + " by " +
                  d.input.front() +
                  " back from the merged file, because another one remains in the backup; nothing "
                  "was written: delete that table in the control and save the backup again");
  }
  return {};
}

/// Mean deviation at each stop of a diagonal: over the directions of their means.
std::vector<double> means_along(const Observations& o) {
  std::map<std::vector<std::int64_t>, std::array<double, 4>> stops;
  for (std::size_t i = 0; i < o.size(); ++i) {
    std::vector<std::int64_t> at;
    for (const auto& axis : o.axes) at.push_back(std::llround(axis.position[i] / 1e-6));
    const bool minus = !o.axes.front().approach.empty() && o.axes.front().approach[i] < 0;
    auto& stop = stops[at];
    stop[minus ? 2 : 0] += o.deviation[i], stop[minus ? 3 : 1] += 1.0;
  }
  std::vector<double> out;
  for (const auto& [at, s] : stops) {
    double mean = 0.0, ways = 0.0;
    for (const std::size_t k : {0U, 2U})
      if (s[k + 1] > 0.0) mean += s[k] / s[k + 1], ways += 1.0;
    out.push_back(mean / ways);
  }
  return out;
}

double range_of(const std::vector<double>& v) {
  const auto [low, high] = std::minmax_element(v.begin(), v.end());
  return v.empty() ? 0.0 : *high - *low;
}

bool is_line_over(const Measurement& m, const Observations& o, const Names& set) {
  return m.kind == "diagonal" && o.size() > 0 &&
         std::all_of(o.axes.begin(), o.axes.end(),
                     [&](const auto& axis) { return contains(set, axis.axis); });
}

/// Adds what tables and backlash values move along a diagonal to its readings. False: positions of
/// a gantry's sides are not stated.
bool load_into(Observations& o, const std::vector<math::Beam>& beams, const ReadTables& tables,
               const Settings& options) {
  for (std::size_t i = 0; i < o.size(); ++i) {
    math::Places at;
    math::MotionSigns ways;
    for (const auto& axis : o.axes) {
      at[axis.axis] = axis.position[i];
      ways[axis.axis] = axis.approach.empty() ? 1 : axis.approach[i];
    }
    for (const auto& axis : o.axes) {
      const auto moved = math::added_on_beam(
          beams, axis.axis, at, ways,
          [&](const std::string& one, const math::Places& places, const math::MotionSigns& of) {
            double sum = math::added(tables, one, places, of);
            for (const LoadedTable& t : tables)
              if (t.output == one && t.backlash && of.contains(one))
                sum += (*t.backlash - stated_backlash(options, one, false).value_or(0.0)) / 2.0 *
                       of.at(one);
            return sum;
          });
      if (!moved) return false;
      o.deviation[i] += o.sense_of(i)[coordinate_of(axis.axis)] * *moved;
    }
  }
  return true;
}

void predict(MergedSet& out, const reading::ReadCampaign& stated, const std::optional<Underlay>& on,
             const Settings& options, const Names& set) {
  const Campaign& campaign = stated.manifest->campaign;
  out.forecast = forecast(stated, out.next, options, on);
  std::erase_if(out.forecast, [&](const TableForecast& f) { return !contains(set, f.axis); });
  const auto beams = math::beams_of(campaign);
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    const Observations& measured = stated.observations[i];
    if (!is_line_over(m, measured, set)) continue;
    Observations loaded = on ? on->readings[i] : measured;
    if (loaded.size() == 0 || !load_into(loaded, beams, out.next, options)) {
      out.findings.push_back({.id = "table.sides-not-placed", .measurement = m.id});
      continue;
    }
    const double before = range_of(means_along(measured));
    out.lines.push_back(
        {m.id, before,
         math::predicted_after(before, range_of(means_along(loaded)),
                               math::compensated_uncertainty_along(campaign, m, measured))});
  }
}

/// Merges the files of all groups into the backup, one group after another.
Expected<std::vector<Artifact>> merged(const Controller& controller, const Campaign& campaign,
                                       const Settings& options, std::vector<Artifact> whole,
                                       const std::vector<Group>& groups,
                                       std::vector<Artifact>& changed) {
  const auto put = [](std::vector<Artifact>& files, const Artifact& f) {
    const auto same = std::find_if(files.begin(), files.end(),
                                   [&](const Artifact& a) { return a.name == f.name; });
    if (same != files.end())
      *same = f;
    else
      files.push_back(f);
  };
  for (const Group& group : groups) {
    auto files = process::guarded("controller " + controller.info.name, [&] {
      return controller.merge({whole, group.files, group.axis, campaign, options});
    });
    if (!files) return fail(files.error());
    for (const Artifact& f : *files) put(whole, f), put(changed, f);
  }
  return whole;
}

}  // namespace

std::vector<std::string> set_of_axes(const std::string& text, const Machine& machine) {
  Names out;
  if (text.size() < 2 || machine.axis(text) != nullptr) return out;
  for (const char c : text) {
    const Axis* const axis = machine.axis(std::string(1, c));
    if (axis == nullptr || axis->rotary || contains(out, axis->name)) return {};
    out.push_back(axis->name);
  }
  for (const char c : text)
    if (const Axis* axis = machine.axis(std::string(1, c)); !axis->slave.empty())
      out.push_back(axis->slave);
  return out;
}

std::vector<LineVerdict> judge_lines(const MergedSet& merged, const reading::ReadCampaign& before,
                                     const reading::ReadCampaign& after, const Names& set) {
  std::vector<LineVerdict> out;
  const Campaign& checked = after.manifest->campaign;
  for (const LineForecast& line : merged.lines)
    for (const Measurement& was : before.manifest->campaign.measurements)
      for (std::size_t i = 0; was.id == line.measurement && i < checked.measurements.size(); ++i) {
        const Measurement& is = checked.measurements[i];
        if (!is_line_over(is, after.observations[i], set) || is.from != was.from || is.to != was.to)
          continue;
        out.push_back({line.measurement, line.before, line.after,
                       range_of(means_along(after.observations[i])),
                       math::compensated_uncertainty_along(checked, is, after.observations[i])});
        break;
      }
  return out;
}

bool are_loaded(const std::vector<LoadedTable>& in_control, const MergedSet& merged,
                const Names& set) {
  constexpr double nothing = 1e-12;  // largest difference that is regarded as rounding, m or rad
  const auto all = differences(in_control, merged.next);
  return std::all_of(all.begin(), all.end(), [&](const TableDifference& d) {
    return !contains(set, d.output) || (d.present && d.next && d.largest <= nothing);
  });
}

Expected<MergedSet> merge_set(const reading::ReadCampaign& read, const Results& results,
                              const Controller& controller, const Settings& given,
                              const std::vector<Artifact>& backup,
                              const std::vector<std::string>& set) {
  const std::string& name = controller.info.name;
  if (!controller.table.straightness)
    return fail(name +
                " has no tables of one axis by the position of another: correct each axis "
                "alone with --axis, or choose a control that has them");
  if (controller.merge == nullptr)
    return fail(name +
                ": its file of several axes cannot be merged into a backup, because it "
                "contains all tables: state active_table of each axis in campaign.toml and "
                "write the complete file with `nonio run`");
  if (given.has("squareness") && given.text("squareness") == "slave-zero")
    return fail(
        "squareness = \"slave-zero\": the shift of a zero is in no table: write the files "
        "with `nonio run`, or use squareness = \"table\"");
  MergedSet out;
  Settings options = given;
  NONIO_TRY(const auto stated, with_state(read, controller, backup, set, options, out));
  NONIO_TRY(const auto on, active_compensation(stated, controller, options));
  if (on) options = on->options;
  const Campaign& campaign = stated.manifest->campaign;
  const Results curves = on ? without_tables(campaign, results, on->tables) : results;
  auto written = process::guarded("controller " + name, [&] {
    return controller.write({campaign, on ? on->readings : read.observations, curves, options});
  });
  if (!written) return fail(written.error());
  out.findings.insert(out.findings.end(), written->findings.begin(), written->findings.end());
  NONIO_TRY(const auto groups, groups_of(controller, campaign, options, written->artifacts, set));
  std::vector<Artifact> files;
  for (const Group& g : groups) files.insert(files.end(), g.files.begin(), g.files.end());
  const auto fresh = tables_in(controller, files, campaign, options);
  if (!files.empty() && !fresh) return fail(fresh.error());
  if (files.empty() || std::none_of(fresh->begin(), fresh->end(), is_cross)) return out;
  NONIO_TRY(auto whole, merged(controller, campaign, options, backup, groups, out.files));
  const auto present = tables_in(controller, backup, campaign, options),
             next = tables_in(controller, whole, campaign, options);
  for (const auto* tables : {&present, &next})
    if (!*tables) return fail((*tables).error());
  if (auto ok = only_this_set(*present, *fresh, *next, set); !ok) return fail(ok.error());
  out.whole = std::move(whole);
  out.next = *next;
  out.differences = differences(*present, *next);
  predict(out, stated, on, options, set);
  return out;
}

}  // namespace nonio::tables
