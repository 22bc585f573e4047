// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "campaign/evaluation/record.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// Number, date and counts of a complete run.
struct RunEnd {
  evaluation::RunLabel run{};
  std::uint64_t seen = 0;  ///< number of campaigns in the site
  std::uint64_t failed = 0;
};

/// The state of the last run in an output folder.
struct RunStatus {
  enum class State { complete, running, cut_short, planned } state = State::complete;
  evaluation::RunLabel run{};              ///< the last run that began
  std::optional<RunEnd> last{};            ///< the last complete run; none: no run was completed
  double age = 0.0;                        ///< time since the last summary was written, s; valid
                                           ///< only if `last` is set
  std::optional<double> seconds{};         ///< duration of the last complete run, s; none if it was
                                           ///< done in shards
  std::uint64_t shards = 0, reported = 0;  ///< number of shards of a planned run, and number of
                                           ///< those that have reported
  std::string used_by{};  ///< description of the process that uses the folder; empty if none
};

/// Returns complete, running, planned or cut-short.
const char* to_text(RunStatus::State state);

/// Reads the state of the last run. An error if no run began in `out`, or if its files cannot be
/// read.
Expected<RunStatus> run_status(const std::filesystem::path& out);

}  // namespace nonio::batch
