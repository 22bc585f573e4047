// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/loader/plugins.h"
#include "campaign/reading/campaign_reader.h"

namespace nonio::tables {

// docs/dev/constants.md, A29.
inline constexpr double same_within_um = 0.11;

/// Without a name, returns the controller of the files' names, otherwise the only one that can read
/// the files, or could if one line were correct.
Expected<const Controller*> control_of(const loader::Plugins&, const std::string& name,
                                       const std::vector<Artifact>& files, const Campaign&,
                                       const std::map<std::string, std::string>& options);

Expected<std::vector<LoadedTable>> tables_in(const Controller&, const std::vector<Artifact>&,
                                             const Campaign&, const Settings& options);

struct TableShape {
  double largest = 0.0;  ///< largest magnitude, m or rad
  double step = 0.0;     ///< largest step from one point to the next, m or rad
  double slope = 0.0;    ///< magnitude, m/m or rad/rad
  double step_at = 0.0;  ///< position on the first input axis, m or rad
  std::optional<double> backlash{};
};

struct TableDifference {
  std::string output;
  std::vector<std::string> input;
  bool rotary = false;                          ///< kind of the output axis
  std::optional<TableShape> present{}, next{};  ///< nullopt without such a table
  /// Largest magnitude of next - present, and its position on the first input axis, m or rad.
  double largest = 0.0, at = 0.0;
  double range = 0.0;  ///< range of next - present, m or rad
};
std::vector<TableDifference> differences(const std::vector<LoadedTable>& present,
                                         const std::vector<LoadedTable>& next);

/// E, B and M of one measurement; NaN if not computable.
struct TableForecast {
  std::string measurement, axis;
  bool rotary = false;
  double E[2]{}, B[2]{}, M[2]{};  ///< before and after loading, m or rad
  /// Possible increase of E by scatter of the readings (95 %), m or rad; 0 with one run.
  double scatter = 0.0;
  bool U_known = true;  ///< false: the table may leave more than the values after loading
  bool grows = false;   ///< E of the means would grow; E[1] also contains what U permits
  /// Whether E may fall, but not by as much as the readings can show.
  bool unproven() const { return !grows && E[1] >= E[0]; }
};

struct Underlay {
  std::vector<LoadedTable> tables;
  Settings options;                    ///< settings, including the active backlash values
  std::vector<Observations> readings;  ///< without the active compensation
};
/// Keeps one measurement, without slave axes. A side of a gantry becomes the axis of the control.
Campaign with_one(Campaign campaign, Measurement m);

/// Returns nullopt without an active table. An error if the files have no tables of these axes or
/// another backlash than is stated.
Expected<std::optional<Underlay>> active_compensation(const reading::ReadCampaign&,
                                                      const Controller&, const Settings& options);
/// Keeps the effect of backlash. Readings may be predictions of a model.
std::vector<Observations> without_tables(const Campaign&, const std::vector<Observations>&,
                                         const std::vector<LoadedTable>&);
/// Removes cross tables, as means of both directions, from curves of one axis over another (EYX,
/// EXY_even, ...).
Results without_tables(const Campaign&, const Results&, const std::vector<LoadedTable>&);
/// Replaces the values before loading by those measured. Adds a finding if no smaller E can
/// be promised.
void compare_with_measured(const reading::ReadCampaign&, OutputResult&);

/// Returns the active backlash parameter of option `axes`, m or rad; nullopt if not stated.
std::optional<double> stated_backlash(const Settings& options, const std::string& axis,
                                      bool rotary);
/// `value`: m or rad.
void state_backlash(Settings& options, const std::string& axis, bool rotary, double value);

/// The tables replace `on`; without it, no compensation was active.
std::vector<TableForecast> forecast(const reading::ReadCampaign&, const std::vector<LoadedTable>&,
                                    const Settings& options,
                                    const std::optional<Underlay>& on = std::nullopt);

/// `measured`: as measured; `raw`: without the active compensation.
TableForecast forecast_of_axis(const Campaign&, const Measurement&, const std::string& axis,
                               const Observations& measured, const Observations& raw,
                               const std::vector<LoadedTable>& loaded, const Settings& options);

/// Tables that contain the whole correction: `present` tables are first removed from the readings.
struct RenewedTables {
  std::vector<Artifact> files;
  std::vector<LoadedTable> tables;
  std::vector<TableForecast> forecast;
  std::vector<Finding> findings;
};
Expected<RenewedTables> renew(const reading::ReadCampaign&, const Controller&, Settings options,
                              const std::vector<LoadedTable>& present);

/// Empty if all tables were refused.
struct CampaignTables {
  std::vector<Artifact> files;
  std::vector<LoadedTable> tables;
  std::vector<Finding> findings;
};
Expected<CampaignTables> tables_of_campaign(const reading::ReadCampaign&, const Controller&,
                                            const Settings& options);

struct MeasuredWith {
  std::vector<LoadedTable> tables;  ///< empty if no table was active
  std::string files;  ///< files of `tables`, separated by commas; empty without a table
  std::optional<double> backlash{};  ///< m or rad; nullopt if not stated
  bool from_backup = false;
};

struct MergedTables {
  std::vector<Artifact> files;  ///< complete text of changed files; empty if the table was refused
  std::vector<Artifact> whole;  ///< all files with the table, changed or not
  std::vector<TableDifference> differences;
  std::vector<TableForecast> forecast;  ///< with all tables of the files loaded
  MeasuredWith with;
  std::vector<LoadedTable> next;  ///< tables of the axis after the merge
  std::vector<Finding> findings;
  std::vector<Remark> notes;
};
/// A control with one file per axis gets new files. An error if the active compensation is not
/// known (`measured_with`), or a table of another axis would change.
Expected<MergedTables> merge_tables(const reading::ReadCampaign&, const Controller&,
                                    const Settings& options, const std::vector<Artifact>& backup,
                                    const std::string& axis);

/// Two positions, approached from below, with the largest difference of the error without a table.
/// With the table, no difference is measured, or twice the difference if the sign is wrong.
struct SignProbe {
  std::string measurement, axis;
  bool rotary = false;
  /// First target and both stops, m or rad.
  double start = 0.0, from = 0.0, to = 0.0;
  double difference = 0.0;   ///< difference of the error without a table, m or rad
  double as_measured = 0.0;  ///< difference with the active compensation, m or rad
  double scatter = 0.0;      ///< standard deviation of a reading, m or rad; 0 with one run
  bool shows() const { return difference * difference > 36.0 * scatter * scatter; }
};
/// `raw`: without the active compensation; `measured`: with it.
Expected<SignProbe> sign_probe(const Measurement&, const Observations& raw,
                               const Observations& measured);

}  // namespace nonio::tables
