// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "batch/state/run_result.h"
#include "batch/state/run_status.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// Folder for the run's own files in the output folder; no campaign can have this name.
inline constexpr const char* state_folder = ".nonio";
/// Folder inside `state_folder` for the plan of a run in shards; it exists from the plan to the end
/// of the merge, or until the plan is cancelled.
inline constexpr const char* plan_folder = "plan";
inline constexpr const char* plan_name = "plan.json";

/// Number and date of the run, stored in OUT/.nonio. A run that was killed or interrupted keeps its
/// number when it is resumed, so that its summary equals that of an undisturbed run.
struct RunState {
  std::uint64_t number = 1;
  std::string date{};            ///< date of the run, YYYY-MM-DD; the local date if none was given
  std::optional<RunEnd> last{};  ///< the previous complete run; none before the first
  bool force = false;
  bool resumed = false;
  /// Position, in the order of issue, of the last certificate number in the register when the
  /// previous run ended, or when the first run began; none if the register could not be read.
  std::optional<std::uint64_t> issued_before{};
  /// Position, in the order of issue, of the last certificate number in the register when this run
  /// began. It is needed if the run is reopened later.
  std::optional<std::uint64_t> issued_at_begin{};
  bool reopened = false;  ///< whether this is a complete run of which one campaign is evaluated
                          ///< again
  std::string site{};     ///< folder of the site that the results belong to
  /// When this process began the run; none if the run was done in shards, or reopened.
  std::optional<std::chrono::steady_clock::time_point> began{};
  evaluation::RunLabel of() const { return {number, date}; }
};

/// Begins or resumes a run; with `dry_run`, nothing is written. An error if the state file is
/// damaged, or if the output folder contains results of another site that still exists, because the
/// campaigns of both would be mixed.
Expected<RunState> begin_run(const RunOptions& options, const std::string& site,
                             std::optional<std::uint64_t> issued_so_far);
/// Returns the state that the last run had when it began, so that one campaign can be evaluated
/// again. An error if the run is not complete. Nothing is written, so an interruption leaves the
/// run complete.
Expected<RunState> reopen_run(const RunOptions& options, const std::string& site);
/// Returns the state that the planned run had when it began. An error if it is not the run in
/// progress in the output folder. Nothing is written.
Expected<RunState> planned_run(const RunOptions& options, const std::string& site,
                               std::uint64_t number);
/// Marks the run as complete. The next run takes over `run.issued_before`.
Expected<void> end_run(const std::filesystem::path& out, const RunState& run, const RunEnd& end);

/// Compares the layout of site.toml (`hashed`: OUT/ab/<id>) with that of existing results, and
/// marks a new output folder with hashed folders, unless `dry_run`. Results are never moved: a
/// different layout is an error.
Expected<void> settle_folders(const std::filesystem::path& out, bool hashed, bool dry_run);

/// Returns an error if a planned run has been neither merged nor cancelled, because no other run
/// may begin before.
Expected<void> check_not_planned(const std::filesystem::path& out);

}  // namespace nonio::batch
