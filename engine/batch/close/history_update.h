// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "campaign/reading/context.h"
#include "laboratory/store/store.h"

namespace nonio::batch {

/// What events.toml, acknowledged.toml and forgotten.toml state, and what site.toml and the records
/// of the machines state about machines; all that is wrong in one error.
Expected<store::SiteRecords> read_records(const RunOptions& options,
                                          const reading::Context& context);

/// The laboratory's memory (OUT/history.sqlite) in step with results that are about to change.
class HistoryUpdate {
 public:
  HistoryUpdate(const RunOptions& options, const reading::Context& context)
      : options_(options), context_(context) {}

  /// Before the first result is stored. `known`: the run up to which the store is complete, where the plan of
  /// this run has noted it.
  Expected<void> begin(std::optional<std::uint64_t> known = {});
  std::optional<std::uint64_t> known() const { return known_; }
  /// When all are: adds these campaigns. `last` is the run whose end the store should contain,
  /// `run` the one that it contains from now on. Returns notes for the summary. An error leaves the
  /// store as it was, and the next run makes it again.
  Expected<std::vector<std::string>> end(std::uint64_t last, std::uint64_t run,
                                         const std::vector<std::string>& campaigns,
                                         const Expected<store::SiteRecords>& records);
  /// No result was stored after `begin`: the store is complete up to the same run as before.
  void nothing_done() const;
  /// The same between runs, where an outdated store is left to the next run.
  Expected<std::vector<std::string>> end(const std::vector<std::string>& campaigns,
                                         const Expected<store::SiteRecords>& records);
  /// Whether the store was made from nothing.
  bool rebuilt() const { return rebuilt_; }

 private:
  const RunOptions& options_;
  const reading::Context& context_;
  std::optional<std::uint64_t> known_{};  ///< the run up to which the store is complete
  bool rebuilt_ = false;
};

}  // namespace nonio::batch
