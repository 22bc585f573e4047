// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "batch/state/run_result.h"
#include "batch/state/run_status.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// What a run keeps for itself in the output folder; no campaign can have its name.
inline constexpr const char* state_folder = ".nonio";
/// In it: the plan of a run that is done in parts, from the plan to the end of the merge.
inline constexpr const char* plan_folder = "plan";
inline constexpr const char* plan_name = "plan.json";

/// The number and date of the run. A run that was killed or interrupted keeps its number when it is
/// resumed, so that its summary is that of an undisturbed one. Kept in OUT/.nonio.
struct RunState {
  std::uint64_t number = 1;
  std::string date{};            ///< YYYY-MM-DD, as it was given
  std::optional<RunEnd> last{};  ///< the previous run; none before the first
  bool force = false;
  bool resumed = false;
  /// Certificates in the register when the previous run ended, or when the first one began; none
  /// if the register could not be read.
  std::optional<std::uint64_t> issued_before{};
  /// The same when this run began, for one that is reopened.
  std::optional<std::uint64_t> issued_at_begin{};
  bool reopened = false;  ///< a complete run, of which one campaign is done again
  std::string site{};     ///< whose results they are, its folder
  evaluation::RunLabel of() const { return {number, date}; }
};

/// An error if the folder holds the results of another site that is still there: campaigns of both
/// would be taken for one another's, and the summary would report one of them only.
Expected<RunState> begin_run(const RunOptions& options, const std::string& site,
                             std::optional<std::uint64_t> issued_so_far);
/// The last run, which has to be complete, as it was when it began: one campaign of it is done
/// again. Nothing is written; what is cut short leaves the run complete.
Expected<RunState> reopen_run(const RunOptions& options, const std::string& site);
/// The run that was planned, as it was when it began: it is in progress. Nothing is written.
Expected<RunState> planned_run(const RunOptions& options, const std::string& site,
                               std::uint64_t number);
/// `run.issued_before` is then what the next one begins with.
Expected<void> end_run(const std::filesystem::path& out, const RunState& run, const RunEnd& end);

/// Compares the layout of site.toml (`hashed`: OUT/ab/<id>) with that of existing results, and
/// marks a new output folder. Results are never moved: another layout is an error.
Expected<void> settle_folders(const std::filesystem::path& out, bool hashed, bool dry_run);

/// An error while a run is planned and not merged yet: the next run would be refused.
Expected<void> check_not_planned(const std::filesystem::path& out);

}  // namespace nonio::batch
