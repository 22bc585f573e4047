// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "laboratory/assessment/last_run.h"
#include "laboratory/assessment/proposals.h"
#include "laboratory/assessment/series.h"
#include "laboratory/assessment/site_tables.h"
#include "laboratory/store/reader.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// Result of the assessment of one machine: everything that the lists over all machines need.
struct Standing {
  std::string name;               ///< name of the machine, or id of a campaign without a machine
  bool alone = false;             ///< whether this is a campaign without a machine
  reports::MachineHistory shown;  ///< description of the machine without its series
  std::vector<ComparedValue> compared{};
  std::vector<reports::WorkItem> lines{};
  std::vector<reports::MonthOfMachine> months{};
  std::vector<reports::InstrumentUse> instruments{};
  bool has_results = false;
  bool judged = false;  ///< whether a result was compared with a limit, or a limit has no value
  /// whether all values that were judged last conform, and no limit lacks a value
  bool conforms = false;
  bool attention = false;  ///< whether the last campaign has a finding with severity warning
  bool reversal = false;   ///< whether such a finding of the last campaign is about reversal
  IntervalFacts interval{};
  std::string until{};  ///< last date of a run for which the lines are the same
};

/// Assesses one machine: makes its lines, applies the acknowledgements to them, and collects its
/// entries in the lists over all machines. `described`: result of `describe` for the same machine.
Standing standing_of(const AssessedMachine& machine, const reports::MachineHistory& described,
                     const store::StoredLogs& logs, const LastRun& last_run,
                     const std::filesystem::path& out);

/// Returns acknowledgements that name this machine or no machine.
std::vector<const config::Acknowledgement*> acknowledgements_of(const std::string& machine,
                                                                const store::StoredLogs& logs);

}  // namespace nonio::assessment
