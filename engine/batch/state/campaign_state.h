// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "campaign/evaluation/status.h"
#include "nonio/sdk/error.h"

namespace nonio::batch {

/// One campaign of the run, as it is known so far. What its record holds (findings) is read again
/// for the summary.
struct CampaignState {
  std::string id{};
  std::string folder{};  ///< relative to the site, in the bytes of the file system
  std::string reason{};  ///< why it is to do, or why not
  std::string
      history{};  ///< where `shows_history`: digest of it; empty: not known when it was written
  enum class Action : char { todo, done, unchanged } action = Action::todo;
  evaluation::Status status = evaluation::Status::none;  ///< none while it is to do
  bool named_by_folder = false;                          ///< its manifest gives no id
  bool is_campaign = true;     ///< false: a folder whose content is unknown
  bool shows_history = false;  ///< a document shows the machine's history

  using Twin = std::pair<std::uint64_t, std::uint32_t>;
  using TwinBefore = std::pair<std::uint64_t, std::string>;
  std::vector<Error> errors{};
  std::vector<Error>
      warnings{};  ///< of the manifest: keys with former names, not kept for the next run
  /// Begin of the SHA-256 of files that another campaign has too, and its position in the list of campaigns.
  std::vector<Twin> twins{};
  /// The same as its record knew it, with the other one's id.
  std::vector<TwinBefore> twins_before{};
  /// Begin of the SHA-256 of each of its files, until they are compared with those of the others.
  std::vector<std::uint64_t> readings{};
};

}  // namespace nonio::batch
