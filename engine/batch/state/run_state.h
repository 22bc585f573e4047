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

/// Folder of internal files in the output folder. It is not a valid campaign id.
inline constexpr const char* state_folder = ".nonio";
/// Folder in `state_folder` that exists until the planned run is merged or canceled.
inline constexpr const char* plan_folder = "plan";
inline constexpr const char* plan_name = "plan.json";

/// State of a run in OUT/.nonio. A resumed run keeps its number, so that its summary equals that of
/// a run without interruption.
struct RunState {
  std::uint64_t number = 1;
  std::string date{};  ///< YYYY-MM-DD
  std::optional<RunEnd> last{};
  bool force = false;
  bool resumed = false;
  /// Last position in the order of issue that the previous run recorded; before the first run, the
  /// last position in the register. Unknown if the register could not be read.
  std::optional<std::uint64_t> issued_before{};
  /// Value of `issued_before` at the beginning of the run, for reopening it.
  std::optional<std::uint64_t> issued_at_begin{};
  bool reopened = false;  ///< whether one campaign of a complete run is evaluated again
  std::string site{};
  /// Set only in a process that does a whole run.
  std::optional<std::chrono::steady_clock::time_point> began{};
  evaluation::RunLabel of() const { return {number, date}; }
};

/// Begins or resumes a run; `dry_run` writes nothing. An error if the state file is damaged or if
/// the output folder belongs to another existing site, because the campaigns of both would be
/// mixed.
Expected<RunState> begin_run(const RunOptions& options, const std::string& site,
                             std::optional<std::uint64_t> issued_so_far);
/// Returns the state at the beginning of the last run, so that one of its campaigns can be
/// evaluated again. An error if the run is not complete. Nothing is written, so that the run
/// remains complete after an interruption.
Expected<RunState> reopen_run(const RunOptions& options, const std::string& site);
/// Returns the state at the beginning of the planned run without writing. An error if this run is
/// not in progress, or if it is of another site.
Expected<RunState> planned_run(const RunOptions& options, const std::string& site,
                               std::uint64_t number);
/// Returns the site of the runs into this folder; empty if it is not known.
std::string site_of(const std::filesystem::path& out);
/// Marks the run as complete. The next run continues from `run.issued_before`.
Expected<void> end_run(const std::filesystem::path& out, const RunState& run, const RunEnd& end);

/// Compares the layout in site.toml (`hashed` for OUT/ab/<id>) with that of existing results. A
/// difference is an error, because results are never moved. Marks a new folder with the hashed
/// layout, unless `dry_run`.
Expected<void> settle_folders(const std::filesystem::path& out, bool hashed, bool dry_run);

/// Returns an error while a planned run is neither merged nor canceled, because no other run may
/// begin.
Expected<void> check_not_planned(const std::filesystem::path& out);

}  // namespace nonio::batch
