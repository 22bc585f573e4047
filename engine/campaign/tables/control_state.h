// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"

/// Which table was in the control while a campaign was measured, from the backup, the record of the
/// machine and the manifest.
namespace nonio::tables {

/// The tables of these that correct this axis by its own position.
std::vector<LoadedTable> own_tables(const std::vector<LoadedTable>&, const std::string& axis);

/// Whether the control adds the same, but for a constant, to half of the last digit that a control
/// prints: 0.06 um or 0.06 arcsec.
bool same_correction(const std::vector<LoadedTable>& a, const std::vector<LoadedTable>& b,
                     const std::string& axis);

/// What Nonio wrote into the comments of a table: the measurement that it was made from.
struct Origin {
  std::string file;
  std::uint64_t line = 0;
  std::string date, campaign;
  std::string serial;  ///< of the machine; empty: not stated
  std::string place() const { return file + ":" + std::to_string(line); }
};
std::optional<Origin> origin_of(const std::vector<Artifact>& files, const std::string& axis);

/// What a person answers of the state during the measurement, in place of the manifest.
struct StateAnswer {
  std::string table;  ///< list of files; empty: none
  std::vector<Artifact> files{};
  std::optional<double> backlash{};  ///< m or rad; 0: none
};
void state_by_answer(reading::ReadCampaign&, const std::string& axis, const StateAnswer&);

/// Settles what was active while `axis` was measured. The manifest applies first, then the record of
/// the machine, then the backup. An error, which names the key or the file that ends it, where they
/// contradict each other, or where the table of the backup was made from this campaign or from a
/// later one, so that it was loaded after the measurement.
Expected<MeasuredWith> measured_with(const reading::ReadCampaign&, const Controller&,
                                     const std::vector<Artifact>& backup, const std::string& axis,
                                     const Settings& options, std::vector<Finding>& findings);

/// Fills in the state of the axes that were measured with a table of the backup and of which nothing
/// else states what was active; axes of which the backup contains no table stay as they are. An error
/// as of `measured_with`.
Expected<void> state_by_backup(reading::ReadCampaign&, const Controller&,
                               const std::vector<Artifact>& backup, Settings& options,
                               std::vector<Finding>& findings);

}  // namespace nonio::tables
