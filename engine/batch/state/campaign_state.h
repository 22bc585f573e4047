// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "campaign/evaluation/status.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// One campaign of the run and its state so far. It contains no findings; the summary reads them
/// from the record of the campaign.
struct CampaignState {
  std::string id{};
  std::string folder{};   ///< folder of the campaign relative to the site, as stored in the file
                          ///< system
  std::string reason{};   ///< reason why the campaign is evaluated, or why not
  std::string history{};  ///< digest of the machine's history that the document shows (only if
      ///< `shows_history`); empty: the history was not known when the document was
      ///< written
  enum class Action : char { todo, done, unchanged } action = Action::todo;
  evaluation::Status status = evaluation::Status::none;  ///< status of the results; none: the
                                                         ///< campaign is still to be evaluated
  bool named_by_folder = false;                          ///< whether the id was made from the
                                                         ///< folder's name, because the manifest
                                                         ///< states none
  bool is_campaign = true;     ///< false: the entry is a folder that could not be listed, or
                               ///< a campaign of another shard, listed because it shares
                               ///< files of readings
  bool shows_history = false;  ///< whether a document shows the machine's history

  using Twin = std::pair<std::uint64_t, std::uint32_t>;
  using TwinBefore = std::pair<std::uint64_t, std::string>;
  std::vector<Error> errors{};
  std::vector<Error>
      warnings{};  ///< warnings about keys with former names in the manifest; not stored for the
                   ///< next run
  /// Files of readings that another campaign has too: the first 64 bits of the file's SHA-256, and
  /// the position of the other campaign in the list of all campaigns.
  std::vector<Twin> twins{};
  /// Shared files of readings that the campaign's last record states: the first 64 bits of the
  /// file's SHA-256, and the id of the other campaign.
  std::vector<TwinBefore> twins_before{};
  /// First 64 bits of the SHA-256 of each of the campaign's files of readings. The list is empty
  /// after the comparison with other campaigns, because the digests are moved out.
  std::vector<std::uint64_t> readings{};
};

}  // namespace nonio::batch
