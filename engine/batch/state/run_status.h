// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "campaign/evaluation/record.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

struct RunEnd {
  evaluation::RunLabel run{};
  std::uint64_t seen = 0;
  std::uint64_t failed = 0;
};

struct RunStatus {
  enum class State { complete, running, cut_short, planned } state = State::complete;
  evaluation::RunLabel run{};  ///< last run that began
  std::optional<RunEnd> last{};
  /// Time since the last summary, s; only valid with `last`.
  double age = 0.0;
  /// Duration of the last complete run, s; unknown for a run in shards.
  std::optional<double> seconds{};
  /// Shards of a planned run, and number of those with a record.
  std::uint64_t shards = 0, reported = 0;
  std::string used_by{};
};

/// Returns "complete", "running", "planned" or "cut-short".
const char* to_text(RunStatus::State state);

/// An error if no run began in `out` or if its files cannot be read.
Expected<RunStatus> run_status(const std::filesystem::path& out);

}  // namespace nonio::batch
