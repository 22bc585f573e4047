// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "campaign/evaluation/record.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// The counts of a complete run.
struct RunEnd {
  evaluation::RunLabel run{};
  std::uint64_t seen = 0;  ///< campaigns
  std::uint64_t failed = 0;
};

/// The state of an output folder's runs.
struct RunStatus {
  enum class State { complete, running, cut_short, planned } state = State::complete;
  evaluation::RunLabel run{};              ///< the last that began
  std::optional<RunEnd> last{};            ///< the last that is complete
  double age = 0.0;                        ///< s since the last summary was written
  std::uint64_t shards = 0, reported = 0;  ///< of a run that is planned
  std::string used_by{};  ///< who uses the folder now, for people; "" if no process
};

/// complete, running, planned, cut-short
const char* to_text(RunStatus::State state);

/// An error if no run was begun there, or if its files cannot be read.
Expected<RunStatus> run_status(const std::filesystem::path& out);

}  // namespace nonio::batch
