// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "campaign/evaluation/status.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// One campaign of the run and its state so far. The findings in its record are read again for the
/// summary.
struct CampaignState {
  std::string id{};
  std::string folder{};  ///< relative to the site, as stored in the file system
  std::string reason{};  ///< why it is to be evaluated, or why not
  std::string
      history{};  ///< if `shows_history`: its digest; empty: the history was not known when the
                  ///< document was written
  enum class Action : char { todo, done, unchanged } action = Action::todo;
  evaluation::Status status = evaluation::Status::none;  ///< none until it is evaluated
  bool named_by_folder = false;                          ///< the manifest states no id
  bool is_campaign = true;     ///< false: a folder that could not be listed
  bool shows_history = false;  ///< a document shows the machine's history

  using Twin = std::pair<std::uint64_t, std::uint32_t>;
  using TwinBefore = std::pair<std::uint64_t, std::string>;
  std::vector<Error> errors{};
  std::vector<Error>
      warnings{};  ///< keys with former names in the manifest; not stored for the next run
  /// Files that another campaign has too: the first 64 bits of the file's SHA-256, and the position
  /// of the other campaign in the list.
  std::vector<Twin> twins{};
  /// The shared files that its record states: the same digests, each with the id of the other
  /// campaign.
  std::vector<TwinBefore> twins_before{};
  /// First 64 bits of the SHA-256 of each of its files, until they are compared with those of other
  /// campaigns.
  std::vector<std::uint64_t> readings{};
};

}  // namespace nonio::batch
