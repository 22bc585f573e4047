// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/loader/plugins.h"
#include "campaign/reading/campaign_reader.h"

/// Tables that are in a control, or are to come into it.
namespace nonio::tables {

/// The controller plugin of this name; without one that after which the files are called, or the
/// only one that can read them.
Expected<const Controller*> control_of(const loader::Plugins&, const std::string& name,
                                       const std::vector<Artifact>& files, const Campaign&,
                                       const std::map<std::string, std::string>& options);

/// What the control makes of these files.
Expected<std::vector<LoadedTable>> tables_in(const Controller&, const std::vector<Artifact>&,
                                             const Campaign&, const Settings& options);

/// Steps and slopes of what one table adds. m or rad.
struct TableShape {
  double largest = 0.0;  ///< size of what is added
  double step = 0.0;     ///< from one point to the next
  double slope = 0.0;    ///< m/m or rad/rad
  double step_at = 0.0;  ///< position of the step, of the first input
  std::optional<double> backlash{};
};

/// What changes for one output axis by the same inputs.
struct TableDifference {
  std::string output;
  std::vector<std::string> input;
  bool rotary = false;  ///< of the output
  std::optional<TableShape> present{},
      next{};                      ///< nothing where only the other one has such a table
  double largest = 0.0, at = 0.0;  ///< size of next - present, and where
  double range = 0.0;              ///< of next - present
};
std::vector<TableDifference> differences(const std::vector<LoadedTable>& present,
                                         const std::vector<LoadedTable>& next);

/// E, B and M of one measurement of an axis; NaN where one cannot be given.
struct TableForecast {
  std::string measurement, axis;
  bool rotary = false;
  double E[2]{}, B[2]{}, M[2]{};  ///< before, after
  /// By how much E after loading may be larger because the readings scatter (95 %); 0 with one run.
  double scatter = 0.0;
  bool worse() const { return !(E[1] <= E[0]); }
};

/// What was in force while a campaign was measured, and its readings without it.
struct Underlay {
  std::vector<LoadedTable> tables;
  Settings options;                    ///< with the backlash values that these tables' files hold
  std::vector<Observations> readings;  ///< as they would be without these tables
};
/// The campaign with this one measurement. Its axis is that of the control, no side of a gantry: who takes the axes
/// one after the other takes both sides.
Campaign with_one(Campaign campaign, Measurement m);

/// The tables that were on, as manifest and record state; none: there was no table. An error where
/// the control does not read them as tables of these axes.
Expected<std::optional<Underlay>> active_compensation(const reading::ReadCampaign&,
                                                      const Controller&, const Settings& options);
/// The same readings, or what a model predicts of them, without these tables; the backlash stays.
std::vector<Observations> without_tables(const Campaign&, const std::vector<Observations>&,
                                         const std::vector<LoadedTable>&);
/// The same of the curves of one axis over another (EYX, EXY_even ...): without what these tables
/// add, the mean of both directions. Results were computed from readings with them.
Results without_tables(const Results&, const std::vector<LoadedTable>&);
/// A table was made of readings without what was on: before it, the axis is as it was measured.
void compare_with_measured(const reading::ReadCampaign&, OutputResult&);

/// The backlash parameter while axis was measured, m or rad, of option `axes`; nothing: not stated.
std::optional<double> stated_backlash(const Settings& options, const std::string& axis,
                                      bool rotary);
/// Adds it.
void state_backlash(Settings& options, const std::string& axis, bool rotary, double value);

/// With these tables in the control in place of what was on, or of none.
std::vector<TableForecast> forecast(const reading::ReadCampaign&, const std::vector<LoadedTable>&,
                                    const Settings& options,
                                    const std::optional<Underlay>& on = std::nullopt);

/// Of one measurement, as measured and without what was active.
TableForecast forecast_of_axis(const Campaign&, const Measurement&, const std::string& axis,
                               const Observations& measured, const Observations& raw,
                               const std::vector<LoadedTable>& loaded, const Settings& options);

/// What the plugin would write for the campaign if these tables were in force while it was
/// measured: they are taken off the readings first, so that the new table is the whole of what is
/// needed.
struct RenewedTables {
  std::vector<Artifact> files;
  std::vector<LoadedTable> tables;
  std::vector<TableForecast> forecast;
  std::vector<Finding> findings;
};
Expected<RenewedTables> renew(const reading::ReadCampaign&, const Controller&, Settings options,
                              const std::vector<LoadedTable>& present);

/// The tables that a control gets of the campaign; none where all were refused.
struct CampaignTables {
  std::vector<Artifact> files;
  std::vector<LoadedTable> tables;
  std::vector<Finding> findings;
};
Expected<CampaignTables> tables_of_campaign(const reading::ReadCampaign&, const Controller&,
                                            const Settings& options);

/// What an axis was measured with.
struct MeasuredWith {
  std::vector<LoadedTable> tables;   ///< empty: none
  std::string files;                 ///< names; empty: none
  std::optional<double> backlash{};  ///< m or rad
  bool from_backup = false;          ///< nothing else states it
};

/// A control's backup with the table of one axis renewed.
struct MergedTables {
  std::vector<Artifact> files;  ///< that changed, whole; none: the table was refused
  std::vector<Artifact> whole;  ///< all files that then state the table
  std::vector<TableDifference> differences;
  std::vector<TableForecast> forecast;  ///< with everything loaded
  MeasuredWith with;
  std::vector<LoadedTable> next;  ///< of the axis
  std::vector<Finding> findings;
  std::vector<Remark> notes;
};
/// A control with one axis per file gets new files. An error where it is not known what was active
/// (`measured_with`), or where what the control reads of another axis would change.
Expected<MergedTables> merge_tables(const reading::ReadCampaign&, const Controller&,
                                    const Settings& options, const std::vector<Artifact>& backup,
                                    const std::string& axis);

/// Two positions of an axis, reached from below, between which its error without any table differs
/// most. With the table the instrument shows nothing of that, or twice the difference if the sign is
/// wrong.
struct SignProbe {
  std::string measurement, axis;
  bool rotary = false;
  double start = 0.0, from = 0.0, to = 0.0;  ///< the first target; the two stops; m or rad
  double difference = 0.0;                   ///< of the error, without a table
  double as_measured = 0.0;  ///< the same difference with what was active during the measurement
  double scatter = 0.0;      ///< standard deviation of a reading about its mean; 0 with one run
  bool shows() const { return difference * difference > 36.0 * scatter * scatter; }
};
/// `raw`: without what was active; `measured`: with it.
Expected<SignProbe> sign_probe(const Measurement&, const Observations& raw,
                               const Observations& measured);

}  // namespace nonio::tables
