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

/// What one machine has to do with the others: all that lists over the machines of a site need.
struct Standing {
  std::string name;               ///< of the machine; of a campaign that belongs to none, its id
  bool alone = false;             ///< a campaign that belongs to no machine
  reports::MachineHistory shown;  ///< without series
  std::vector<ComparedValue> compared{};
  std::vector<reports::WorkItem> lines{};
  std::vector<reports::MonthOfMachine> months{};
  std::vector<reports::InstrumentUse> instruments{};
  bool has_results = false;
  bool judged = false;     ///< some result has a limit
  bool conforms = false;   ///< nothing that was judged last does not
  bool attention = false;  ///< the last campaign has a finding that requires action
  bool reversal = false;   ///< and it is one of the reversal
  IntervalFacts interval{};
  std::string until{};  ///< date of the last run with the same lines
};

/// `described`: of the same machine, see `describe`.
Standing standing_of(const AssessedMachine& machine, const reports::MachineHistory& described,
                     const store::StoredLogs& logs, const LastRun& last_run,
                     const std::filesystem::path& out);

/// Acknowledgements that may concern a machine.
std::vector<const config::Acknowledgement*> acknowledgements_of(const std::string& machine,
                                                                const store::StoredLogs& logs);

}  // namespace nonio::assessment
