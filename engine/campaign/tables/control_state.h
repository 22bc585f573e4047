// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"

namespace nonio::tables {

std::vector<LoadedTable> own_tables(const std::vector<LoadedTable>&, const std::string& axis);

/// Compares corrections, except for a constant, within 0.11 um or 0.11 arcsec, because values may
/// be rounded to a tenth.
bool same_correction(const std::vector<LoadedTable>& a, const std::vector<LoadedTable>& b,
                     const std::string& axis);

/// The measurement from which a table was made, as stated in its comments.
struct Origin {
  std::string file;
  std::uint64_t line = 0;
  std::string date, campaign;
  std::string serial;  ///< empty if not stated
  std::string place() const { return file + ":" + std::to_string(line); }
};
std::optional<Origin> origin_of(const std::vector<Artifact>& files, const std::string& axis);

/// Statement of a person that replaces the manifest.
struct StateAnswer {
  std::string table;  ///< files, separated by commas; empty without a table
  std::vector<Artifact> files{};
  std::optional<double> backlash{};  ///< m or rad; 0 if inactive
};
void state_by_answer(reading::ReadCampaign&, const std::string& axis, const StateAnswer&);

/// Returns the active compensation from the manifest, otherwise from the machine's record,
/// otherwise from the backup. Errors: the record contradicts the backup, or nothing is stated and
/// the backup has no table of the axis, or only one that was loaded after the measurement.
Expected<MeasuredWith> measured_with(const reading::ReadCampaign&, const Controller&,
                                     const std::vector<Artifact>& backup, const std::string& axis,
                                     const Settings& options, std::vector<Finding>& findings);

/// Sets the compensation of each measured axis for which only the backup states one. Errors are
/// those of `measured_with`.
Expected<void> state_by_backup(reading::ReadCampaign&, const Controller&,
                               const std::vector<Artifact>& backup, Settings& options,
                               std::vector<Finding>& findings);

}  // namespace nonio::tables
