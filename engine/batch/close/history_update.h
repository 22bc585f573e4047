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

/// Reads events.toml, acknowledged.toml and forgotten.toml, and adds the aliases and calibration
/// intervals of site.toml and the events in the records of the machines. All mistakes in the three
/// files are reported in one error.
Expected<store::SiteRecords> read_records(const RunOptions& options,
                                          const reading::Context& context);

/// Keeps the history of the laboratory (OUT/history.sqlite) consistent with the results while a run
/// replaces them.
class HistoryUpdate {
 public:
  HistoryUpdate(const RunOptions& options, const reading::Context& context)
      : options_(options), context_(context) {}

  /// Has to be called before the first result is stored. Marks the store as possibly outdated.
  /// `known`: the run up to which the store is complete according to the plan of this run; it is
  /// used if the store itself does not state one.
  Expected<void> begin(std::optional<std::uint64_t> known = {});
  std::optional<std::uint64_t> known() const { return known_; }
  /// Has to be called when all results are stored: adds these campaigns to the store, and rebuilds
  /// the store if it is not complete up to the run `last`. `run` is the run up to which it is
  /// complete afterwards. Returns notes for the summary about results that are not in the history.
  /// After an error or a note, the next run rebuilds the store.
  Expected<std::vector<std::string>> end(std::uint64_t last, std::uint64_t run,
                                         const std::vector<std::string>& campaigns,
                                         const Expected<store::SiteRecords>& records);
  /// Has to be called instead of `end` if no result was stored after `begin`: the store remains
  /// complete up to the same run.
  void nothing_done() const;
  /// Adds campaigns that were evaluated again between runs. An outdated store is not changed,
  /// because the next run rebuilds it.
  Expected<std::vector<std::string>> end(const std::vector<std::string>& campaigns,
                                         const Expected<store::SiteRecords>& records);
  /// Returns whether `end` rebuilt the store from all results.
  bool rebuilt() const { return rebuilt_; }

 private:
  const RunOptions& options_;
  const reading::Context& context_;
  std::optional<std::uint64_t> known_{};  ///< number of the run up to which the store is complete;
                                          ///< empty: not known
  bool rebuilt_ = false;
};

}  // namespace nonio::batch
