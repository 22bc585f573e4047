// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/loader/plugins.h"
#include "campaign/reading/campaign_reader.h"

/// Checks and compares tables that are in a control, or are to be loaded into it.
namespace nonio::tables {

/// Returns the controller of this name; without a name, the one after which the files are named,
/// otherwise the only one that can read them, or that could read them if one line were correct.
Expected<const Controller*> control_of(const loader::Plugins&, const std::string& name,
                                       const std::vector<Artifact>& files, const Campaign&,
                                       const std::map<std::string, std::string>& options);

/// Returns the tables that the control would read from these files.
Expected<std::vector<LoadedTable>> tables_in(const Controller&, const std::vector<Artifact>&,
                                             const Campaign&, const Settings& options);

/// Size, step and slope of the correction of a table, in m or rad.
struct TableShape {
  double largest = 0.0;  ///< largest absolute correction, m or rad
  double step = 0.0;     ///< largest step from one point to the next, m or rad
  double slope = 0.0;    ///< largest absolute slope, m/m or rad/rad
  double step_at = 0.0;  ///< position of the largest step on the first input axis, m or rad
  std::optional<double> backlash{};
};

/// Difference between the tables of one output axis with the same inputs.
struct TableDifference {
  std::string output;
  std::vector<std::string> input;
  bool rotary = false;  ///< the output axis is rotary
  std::optional<TableShape> present{},
      next{};  ///< none if only the other set of tables has such a table
  /// Largest absolute value of next - present, and its position on the first input axis, m or rad.
  double largest = 0.0, at = 0.0;
  double range = 0.0;  ///< range of next - present, m or rad
};
std::vector<TableDifference> differences(const std::vector<LoadedTable>& present,
                                         const std::vector<LoadedTable>& next);

/// Predicted E, B and M of one measurement of an axis; NaN if one cannot be computed.
struct TableForecast {
  std::string measurement, axis;
  bool rotary = false;
  double E[2]{}, B[2]{}, M[2]{};  ///< values before and after loading the tables, m or rad
  /// Amount by which E after loading may be larger because the readings scatter (95 %); 0 with one
  /// run.
  double scatter = 0.0;
  bool worse() const { return !(E[1] <= E[0]); }
};

/// The compensation that was active while a campaign was measured, and its readings without it.
struct Underlay {
  std::vector<LoadedTable> tables;
  Settings options;  ///< options of the controller with the backlash values of these tables
  std::vector<Observations> readings;  ///< readings as they would be without these tables
};
/// Returns the campaign with only this measurement. For a side of a gantry, the measurement gets
/// the axis of the control that belongs to this side, and no side. Slave axes are removed from the
/// machine, because a caller that processes one axis after another processes both sides.
Campaign with_one(Campaign campaign, Measurement m);

/// Returns the tables that were active according to manifest and record; none if there was no
/// table. An error if the control does not read the files as tables of these axes, or if they
/// contain another backlash than is stated.
Expected<std::optional<Underlay>> active_compensation(const reading::ReadCampaign&,
                                                      const Controller&, const Settings& options);
/// Returns readings, or a model's predictions of them, without the correction of these tables; the
/// effect of backlash stays.
std::vector<Observations> without_tables(const Campaign&, const std::vector<Observations>&,
                                         const std::vector<LoadedTable>&);
/// Removes the correction of these cross tables from the curves of one axis over another (EYX,
/// EXY_even, ...) in `Results`, which were computed from readings with the tables active. The mean
/// of both directions is removed.
Results without_tables(const Results&, const std::vector<LoadedTable>&);
/// Replaces the values before loading in the predictions of a result by the measured ones, because
/// the table was made from readings without the active compensation. Adds a finding if a table does
/// not reduce E.
void compare_with_measured(const reading::ReadCampaign&, OutputResult&);

/// Returns the backlash parameter (m or rad) that option `axes` states for an axis during the
/// measurement; none if it is not stated.
std::optional<double> stated_backlash(const Settings& options, const std::string& axis,
                                      bool rotary);
/// Adds a backlash parameter (m or rad) to option `axes`.
void state_backlash(Settings& options, const std::string& axis, bool rotary, double value);

/// Predicts E, B and M of the measurements with these tables in the control. They replace the
/// active compensation `on`; without it the readings were measured without tables.
std::vector<TableForecast> forecast(const reading::ReadCampaign&, const std::vector<LoadedTable>&,
                                    const Settings& options,
                                    const std::optional<Underlay>& on = std::nullopt);

/// Predicts E, B and M of one measurement. `measured` contains the readings as they were measured,
/// `raw` those without the active compensation.
TableForecast forecast_of_axis(const Campaign&, const Measurement&, const std::string& axis,
                               const Observations& measured, const Observations& raw,
                               const std::vector<LoadedTable>& loaded, const Settings& options);

/// The tables that the plugin writes for a campaign measured with `present` tables. These are first
/// removed from the readings, so that the new tables contain the whole correction.
struct RenewedTables {
  std::vector<Artifact> files;
  std::vector<LoadedTable> tables;
  std::vector<TableForecast> forecast;
  std::vector<Finding> findings;
};
Expected<RenewedTables> renew(const reading::ReadCampaign&, const Controller&, Settings options,
                              const std::vector<LoadedTable>& present);

/// The tables that a controller writes for a campaign; empty if all were refused.
struct CampaignTables {
  std::vector<Artifact> files;
  std::vector<LoadedTable> tables;
  std::vector<Finding> findings;
};
Expected<CampaignTables> tables_of_campaign(const reading::ReadCampaign&, const Controller&,
                                            const Settings& options);

/// The compensation with which an axis was measured.
struct MeasuredWith {
  std::vector<LoadedTable> tables;   ///< tables of the axis; empty: no table was active
  std::string files;                 ///< names of the files of these tables; empty: no table active
  std::optional<double> backlash{};  ///< backlash value, m or rad; none: not stated
  bool from_backup = false;          ///< whether only the backup states this compensation
};

/// A control's backup in which the table of one axis is replaced.
struct MergedTables {
  std::vector<Artifact> files;  ///< complete text of the changed files; none: the table was refused
  std::vector<Artifact> whole;  ///< all files that contain the table afterwards
  std::vector<TableDifference> differences;
  std::vector<TableForecast> forecast;  ///< predictions with all tables of the files loaded
  MeasuredWith with;
  std::vector<LoadedTable> next;  ///< tables of the axis after the merge
  std::vector<Finding> findings;
  std::vector<Remark> notes;
};
/// Replaces the table of one axis in a backup; for a control with one file per axis, the files are
/// new. An error if it is not known what was active (`measured_with`), or if a table of another
/// axis would change.
Expected<MergedTables> merge_tables(const reading::ReadCampaign&, const Controller&,
                                    const Settings& options, const std::vector<Artifact>& backup,
                                    const std::string& axis);

/// Two positions of an axis, approached from below, between which its error without a table differs
/// most. With the table an instrument shows no difference, or twice the difference if the sign is
/// wrong.
struct SignProbe {
  std::string measurement, axis;
  bool rotary = false;
  /// Positions of the first target and of the two stops, m or rad.
  double start = 0.0, from = 0.0, to = 0.0;
  double difference = 0.0;  ///< difference of the error between the stops without a table, m or rad
  double as_measured = 0.0;  ///< `difference` with the compensation that was active, m or rad
  double scatter = 0.0;      ///< standard deviation of a reading, m or rad; 0 with one run
  bool shows() const { return difference * difference > 36.0 * scatter * scatter; }
};
/// Returns the two positions. `raw` contains the readings without the active compensation,
/// `measured` those with it.
Expected<SignProbe> sign_probe(const Measurement&, const Observations& raw,
                               const Observations& measured);

}  // namespace nonio::tables
