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

/// Assessment of one machine, as far as the lists of all machines need it.
struct Standing {
  std::string name;
  bool alone = false;             ///< whether this is a campaign without a machine
  reports::MachineHistory shown;  ///< without series
  std::vector<ComparedValue> compared{};
  std::vector<reports::WorkItem> lines{};
  std::vector<reports::MonthOfMachine> months{};
  std::vector<reports::InstrumentUse> instruments{};
  bool has_campaigns = false;
  bool judged = false;  ///< whether any result has a tolerance limit
  /// Whether all last decisions are "conforms" and no limit lacks a value.
  bool conforms = false;
  bool attention = false;  ///< whether the last campaign has a finding of severity warning
  bool reversal = false;   ///< whether such a finding is about reversal
  std::string misread{};   ///< the newest campaign if it includes a suspected misreading
  IntervalFacts interval{};
  std::string until{};  ///< last date of a run with the same worklist
};

/// Makes the worklist of one machine with acknowledgements and its entries in the lists of all
/// machines. `described` is the result of `describe`.
Standing standing_of(const AssessedMachine& machine, const reports::MachineHistory& described,
                     const store::StoredLogs& logs, const LastRun& last_run,
                     const std::filesystem::path& out);

/// Returns acknowledgements of this machine and those that name no machine.
std::vector<const config::Acknowledgement*> acknowledgements_of(const std::string& machine,
                                                                const store::StoredLogs& logs);

}  // namespace nonio::assessment
