// SPDX-License-Identifier: Apache-2.0
#include "campaign/tables/control_state.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/loaded_table.h"
#include "nonio/sdk/format.h"

namespace nonio::tables {
namespace {

bool is_own(const LoadedTable& t, const std::string& axis) {
  return t.output == axis && t.input == std::vector{axis};
}

std::string names_of(const std::vector<Artifact>& files) {
  std::string out;
  for (const Artifact& f : files) out += (out.empty() ? "" : ", ") + f.name;
  return out;
}

std::string_view between(std::string_view line, std::string_view from, std::string_view to) {
  const std::size_t at = line.find(from);
  if (at == std::string_view::npos) return {};
  line.remove_prefix(at + from.size());
  return line.substr(0, line.find(to));
}

std::string_view without_end(std::string_view text) {
  while (!text.empty() && (text.back() == ')' || text.back() == '\r' || text.back() == ' '))
    text.remove_suffix(1);
  return text;
}

class Stated {
 public:
  Stated(const reading::ReadCampaign& read, const Axis& axis) : read_(read), axis_(axis) {}

  bool in_manifest(const char* key) const {
    return read_.manifest->lines.contains("machine.axes." + axis_.name + "." + key);
  }
  std::string key() const { return "active_table in [machine.axes." + axis_.name + "]"; }
  std::string backlash_key() const {
    return std::string(axis_.rotary ? "active_backlash_deg" : "active_backlash_mm") +
           " in [machine.axes." + axis_.name + "] of campaign.toml";
  }
  std::string place() const {
    if (!in_manifest("active_table")) return read_.machine ? read_.machine->file : "campaign.toml";
    const auto line = read_.manifest->lines.at("machine.axes." + axis_.name + ".active_table");
    return line == 0 ? "the answer on the terminal" : "campaign.toml:" + std::to_string(line);
  }
  std::string text() const {
    return axis_.active_table->empty() ? "\"none\"" : "\"" + *axis_.active_table + "\"";
  }

 private:
  const reading::ReadCampaign& read_;
  const Axis& axis_;
};

/// Most formats have no unit. Returns an error if the grid fits the measurement only in inches.
Expected<void> check_unit(const std::vector<LoadedTable>& own, const Campaign& campaign,
                          const std::vector<Observations>& readings, const std::string& axis,
                          const std::string& files, const std::string& by_hand) {
  constexpr double inch = 25.4;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t i = 0; i < readings.size(); ++i)
    if (campaign.measurements[i].kind == "axis" &&
        control_axis(campaign.machine, campaign.measurements[i]) == axis && readings[i].size() > 0)
      for (const double x : readings[i].axes.front().position)
        low = std::min(low, x), high = std::max(high, x);
  for (const LoadedTable& t : own) {
    if (t.rotary || !(high > low)) continue;
    const double span = t.position.front().back() - t.position.front().front();
    const auto equal = [&](double one, double other) { return std::fabs(one / other - 1.0) < 0.1; };
    const bool smaller = equal(inch * span, high - low), larger = equal(span, inch * (high - low));
    if (!smaller && !larger) continue;
    return fail(
        files + ": the table of " + axis + " covers " + fixed_text(1e3 * span, 1) +
        " mm, the measurement " + fixed_text(1e3 * (high - low), 1) + " mm, which is " +
        (smaller ? "25.4 times as much" : "the 25.4th part") +
        ": one of them seems to be in inch. Save the backup in mm; or state the unit of the "
        "control, if it has an option for that (`nonio table controls NAME`); or, if both "
        "are in mm, " +
        by_hand);
  }
  return {};
}

std::vector<LoadedTable> opposite(std::vector<LoadedTable> tables) {
  for (LoadedTable& t : tables)
    for (auto* values : {&t.plus, &t.minus})
      for (double& v : *values) v = -v;
  return tables;
}

bool is_loaded_later(const reading::ReadCampaign& read, const Controller& controller,
                     const std::vector<LoadedTable>& backup, const std::string& axis,
                     const Settings& options) {
  if (!read.machine) return false;
  const auto recorded = read.machine->axes.find(axis);
  if (recorded == read.machine->axes.end()) return false;
  const Campaign& campaign = read.manifest->campaign;
  return std::any_of(recorded->second.states.begin(), recorded->second.states.end(),
                     [&](const config::ControlState& s) {
                       if (s.since < campaign.date || s.counts_on(campaign.date) || !s.table)
                         return false;
                       if (s.table->empty()) return backup.empty();
                       const auto files = read.state_files.find(s.files);
                       if (files == read.state_files.end()) return false;
                       const auto tables = tables_in(controller, files->second, campaign, options);
                       return tables && same_correction(own_tables(*tables, axis), backup, axis);
                     });
}

}  // namespace

std::vector<LoadedTable> own_tables(const std::vector<LoadedTable>& tables,
                                    const std::string& axis) {
  std::vector<LoadedTable> own;
  for (const LoadedTable& t : tables)
    if (is_own(t, axis)) own.push_back(t);
  return own;
}

bool same_correction(const std::vector<LoadedTable>& a, const std::vector<LoadedTable>& b,
                     const std::string& axis) {
  for (const TableDifference& d : differences(own_tables(a, axis), own_tables(b, axis)))
    if (d.range > same_within_um * (d.rotary ? 1.0 / arcsec_per_rad : 1e-6)) return false;
  return true;
}

std::optional<Origin> origin_of(const std::vector<Artifact>& files, const std::string& axis) {
  for (const Artifact& f : files) {
    std::string serial;
    std::uint64_t number = 0;
    for (std::size_t at = 0; at < f.bytes.size();) {
      const std::size_t end = std::min(f.bytes.find('\n', at), f.bytes.size());
      const std::string_view line = std::string_view(f.bytes).substr(at, end - at);
      at = end + 1;
      ++number;
      if (const auto of = between(line, ", serial ", "\n");
          !of.empty() && line.find("machine: ") != std::string_view::npos)
        serial = without_end(of);
      if (line.find("axis " + axis + ", measurement ") == std::string_view::npos) continue;
      const auto campaign = without_end(between(line, ", campaign ", "\n"));
      if (campaign.empty()) continue;
      const std::string_view before = line.substr(0, line.find(", campaign "));
      const std::string_view day = before.substr(before.rfind(' ') + 1);
      return Origin{f.name, number, std::string(day), std::string(campaign), serial};
    }
  }
  return std::nullopt;
}

Expected<MeasuredWith> measured_with(const reading::ReadCampaign& read,
                                     const Controller& controller,
                                     const std::vector<Artifact>& backup, const std::string& name,
                                     const Settings& options, std::vector<Finding>& findings) {
  const Campaign& campaign = read.manifest->campaign;
  const Axis* const axis = campaign.machine.axis(name);
  if (axis == nullptr) return fail("the campaign has no axis " + name);
  const Stated stated(read, *axis);
  auto all = tables_in(controller, backup, campaign, options);
  if (!all) return fail(names_of(backup) + ": " + all.error().message);
  const auto in_backup = own_tables(*all, name);
  std::optional<double> backlash_in_backup;
  for (const LoadedTable& t : in_backup)
    if (t.backlash) backlash_in_backup = t.backlash;
  const auto origin = origin_of(backup, name);
  const std::string& serial = campaign.machine.serial;
  if (origin && !serial.empty() && !origin->serial.empty() && origin->serial != serial)
    return fail(origin->place() + ": the table of " + name + " is of the machine with serial " +
                origin->serial + ", the campaign is of " + serial +
                ": give the backup of this machine, or correct serial in [machine]");
  const bool off = std::any_of(
      campaign.measurements.begin(), campaign.measurements.end(), [&](const Measurement& m) {
        return m.kind == "axis" && control_axis(campaign.machine, m) == name &&
               m.compensation == "off";
      });
  const std::string by_hand = "state " + stated.key() +
                              " of campaign.toml: the file of the table that was active while it "
                              "was measured, or \"none\"";
  const bool is_later =
      origin &&
      (origin->campaign == campaign.id ||
       (!campaign.date.empty() && origin->date >= campaign.date && origin->date != "date"));
  MeasuredWith out{{}, {}, axis->active_backlash, false};
  if (!out.backlash) out.backlash = stated_backlash(options, name, axis->rotary);
  if (off) out.backlash = 0.0;
  if (axis->active_table || off) {
    if (const auto files = read.active_tables.find(name);
        !off && files != read.active_tables.end()) {
      auto tables = tables_in(controller, files->second, campaign, options);
      if (!tables) return fail(*axis->active_table + ": " + tables.error().message);
      out.tables = own_tables(*tables, name), out.files = names_of(files->second);
    }
    if (same_correction(out.tables, in_backup, name)) {
      if (!out.backlash) out.backlash = backlash_in_backup;
      return out;
    }
    if (off || is_later || is_loaded_later(read, controller, in_backup, name, options)) return out;
    if (!stated.in_manifest("active_table"))
      return fail(stated.place() + " states that the table of " + name + " was " + stated.text() +
                  " on " + campaign.date + ", but " + names_of(backup) +
                  (in_backup.empty() ? " contains none"
                   : same_correction(out.tables, opposite(in_backup), name)
                       ? " contains it with the opposite sign"
                       : " contains another one") +
                  ": add the state of the backup to [[axes." + name + ".state]] there, or " +
                  by_hand);
    findings.push_back({"table.backup-differs",
                        true,
                        {},
                        {{"axis", name},
                         {"files", names_of(backup)},
                         {"place", stated.place()},
                         {"stated", axis->active_table->empty() ? "none" : *axis->active_table}},
                        {},
                        {}});
    return out;
  }
  if (is_later)
    return fail(origin->place() + ": the table of " + name + " was made from campaign " +
                origin->campaign + " of " + origin->date +
                ", so it was loaded after this campaign was measured: " + by_hand);
  if (in_backup.empty())
    return fail(names_of(backup) + " contains no table of axis " + name +
                ": give the file that contains it, or " + by_hand);
  if (!backlash_in_backup && !out.backlash && !controller.table.backlash.empty())
    return fail(names_of(backup) + " does not contain the value of " + controller.table.backlash +
                " of axis " + name +
                ", which was active during the measurement: give its file too, or state " +
                stated.backlash_key());
  if (auto fits =
          check_unit(in_backup, campaign, read.observations, name, names_of(backup), by_hand);
      !fits)
    return fail(fits.error());
  out.tables = in_backup;
  out.from_backup = true;
  out.files = names_of(backup);
  if (backlash_in_backup) out.backlash = backlash_in_backup;
  findings.push_back({"table.active-from-backup",
                      true,
                      {},
                      {{"axis", name}, {"files", names_of(backup)}},
                      {},
                      {}});
  return out;
}

void state_by_answer(reading::ReadCampaign& read, const std::string& name,
                     const StateAnswer& answer) {
  for (Axis& axis : read.manifest->campaign.machine.axes) {
    if (axis.name != name) continue;
    axis.active_table = answer.table;
    if (answer.backlash) axis.active_backlash = answer.backlash;
    if (!answer.files.empty()) read.active_tables[name] = answer.files;
    read.manifest->lines["machine.axes." + name + ".active_table"] = 0;
  }
}

Expected<void> state_by_backup(reading::ReadCampaign& read, const Controller& controller,
                               const std::vector<Artifact>& backup, Settings& options,
                               std::vector<Finding>& findings) {
  NONIO_TRY(const auto in_backup, tables_in(controller, backup, read.manifest->campaign, options));
  for (Axis& axis : read.manifest->campaign.machine.axes) {
    const auto& measurements = read.manifest->campaign.measurements;
    const bool is_open =
        std::any_of(measurements.begin(), measurements.end(), [&](const Measurement& m) {
          return m.kind == "axis" && m.compensation != "off" &&
                 control_axis(read.manifest->campaign.machine, m) == axis.name;
        });
    if (axis.active_table || !is_open || own_tables(in_backup, axis.name).empty()) continue;
    const auto with = measured_with(read, controller, backup, axis.name, options, findings);
    if (!with) return fail(with.error());
    axis.active_table = with->files;
    axis.active_backlash = with->backlash;
    if (with->backlash) state_backlash(options, axis.name, axis.rotary, *with->backlash);
    read.active_tables[axis.name] = backup;
  }
  return {};
}

}  // namespace nonio::tables
