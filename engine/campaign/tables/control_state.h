// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"

/// Determines which table was in the control while a campaign was measured, from the backup, the
/// record of the machine and the manifest.
namespace nonio::tables {

/// Returns the tables that correct this axis by its own position.
std::vector<LoadedTable> own_tables(const std::vector<LoadedTable>&, const std::string& axis);

/// Returns whether both sets of tables correct an axis equally, except for a constant: within 0.11
/// um or 0.11 arcsec, so that one of them may be rounded to a tenth of them.
bool same_correction(const std::vector<LoadedTable>& a, const std::vector<LoadedTable>& b,
                     const std::string& axis);

/// The measurement from which a table was made, as Nonio wrote it into the comments of the table.
struct Origin {
  std::string file;
  std::uint64_t line = 0;
  std::string date, campaign;
  std::string serial;  ///< serial number of the machine; empty: not stated
  std::string place() const { return file + ":" + std::to_string(line); }
};
std::optional<Origin> origin_of(const std::vector<Artifact>& files, const std::string& axis);

/// The answer of a person about the state during the measurement, used in place of the manifest.
struct StateAnswer {
  std::string table;  ///< names of the table's files, separated by commas; empty: no table
  std::vector<Artifact> files{};
  std::optional<double> backlash{};  ///< backlash value, m or rad; 0: no value was active
};
void state_by_answer(reading::ReadCampaign&, const std::string& axis, const StateAnswer&);

/// Returns the compensation that was active while `axis` was measured. The manifest has precedence,
/// then the record of the machine, then the backup. A manifest that differs from the backup is a
/// finding. An error, which names the key or file to correct, if the record contradicts the backup.
/// The same applies if nothing is stated and the backup has no table of the axis, or one that was
/// made from this or a later campaign and was therefore loaded after the measurement.
Expected<MeasuredWith> measured_with(const reading::ReadCampaign&, const Controller&,
                                     const std::vector<Artifact>& backup, const std::string& axis,
                                     const Settings& options, std::vector<Finding>& findings);

/// Sets the active compensation of axes that were measured with a table of the backup, if nothing
/// else states it. Axes without a table in the backup stay unchanged. Returns errors like
/// `measured_with`.
Expected<void> state_by_backup(reading::ReadCampaign&, const Controller&,
                               const std::vector<Artifact>& backup, Settings& options,
                               std::vector<Finding>& findings);

}  // namespace nonio::tables
