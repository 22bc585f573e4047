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

/// Reads events.toml, acknowledged.toml and forgotten.toml, and adds aliases and calibration
/// intervals of site.toml and events of the machine records. The error contains all mistakes of the
/// three files.
Expected<store::SiteRecords> read_records(const RunOptions& options,
                                          const reading::Context& context);

class HistoryUpdate {
 public:
  HistoryUpdate(const RunOptions& options, const reading::Context& context)
      : options_(options), context_(context) {}

  /// Must be called before the first result is stored: marks the store as possibly outdated.
  /// `known` is the run up to which the store is complete according to the plan; it applies only if
  /// OUT/.nonio contains no such note of the store.
  Expected<void> begin(std::optional<std::uint64_t> known = {});
  std::optional<std::uint64_t> known() const { return known_; }
  /// Must be called after all results are stored. Adds these campaigns, or rebuilds the store if it
  /// is not complete up to the run `last`; afterwards it is complete up to `run`. Returns notes
  /// about results that the history lacks. After an error or a note, the next run rebuilds the
  /// store.
  Expected<std::vector<std::string>> end(std::uint64_t last, std::uint64_t run,
                                         const std::vector<std::string>& campaigns,
                                         const Expected<store::SiteRecords>& records);
  /// Must be called instead of `end` if no result was stored after `begin`.
  void nothing_done() const;
  /// Adds campaigns that were evaluated again between runs. An outdated store is not changed,
  /// because the next run rebuilds it.
  Expected<std::vector<std::string>> end(const std::vector<std::string>& campaigns,
                                         const Expected<store::SiteRecords>& records);
  bool rebuilt() const { return rebuilt_; }

 private:
  const RunOptions& options_;
  const reading::Context& context_;
  std::optional<std::uint64_t> known_{};
  bool rebuilt_ = false;
};

}  // namespace nonio::batch
