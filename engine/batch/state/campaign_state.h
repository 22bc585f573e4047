// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "campaign/evaluation/status.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// A campaign and its state in the run. The summary reads the findings from the record, so that the
/// memory does not grow with them.
struct CampaignState {
  std::string id{};
  std::string folder{};  ///< relative to the site, in the encoding of the file system
  std::string reason{};  ///< why the campaign is evaluated or not
  /// Digest of the machine history in the document; empty if no history was available.
  std::string history{};
  enum class Action : char { todo, done, unchanged } action = Action::todo;
  evaluation::Status status = evaluation::Status::none;  ///< `none` before the evaluation
  /// Whether the id is the name of the folder, because the manifest states no id.
  bool named_by_folder = false;
  /// False for a folder that cannot be listed and for a campaign of another shard with the same
  /// files of readings.
  bool is_campaign = true;
  bool shows_history = false;

  using Twin = std::pair<std::uint64_t, std::uint32_t>;
  using TwinBefore = std::pair<std::uint64_t, std::string>;
  std::vector<Error> errors{};
  std::vector<Error> warnings{};  ///< former keys in the manifest; not stored for the next run
  /// Files of readings that another campaign contains too: first 64 bits of the SHA-256, and index
  /// of the other campaign.
  std::vector<Twin> twins{};
  /// Shared files of readings in the last record: first 64 bits of the SHA-256, and id of the other
  /// campaign.
  std::vector<TwinBefore> twins_before{};
  /// First 64 bits of the SHA-256 of each file of readings; empty after the comparison with other
  /// campaigns.
  std::vector<std::uint64_t> readings{};
};

}  // namespace nonio::batch
