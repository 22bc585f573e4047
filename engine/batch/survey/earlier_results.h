// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "batch/state/run_result.h"
#include "batch/survey/site_walk.h"
#include "campaign/reading/context.h"
#include "certificates/register.h"

namespace nonio::batch {

/// Results whose id no manifest states.
struct EarlierResult {
  std::string id, folder;
  std::uint64_t run = 0;
  bool failed = false;
};

/// Index of the ids that manifests state. It contains positions of four bytes to save memory.
class ClaimedIds {
 public:
  explicit ClaimedIds(const std::vector<CampaignState>& campaigns);
  bool contains(std::string_view id) const;

 private:
  const std::vector<CampaignState>& campaigns_;
  std::vector<std::uint32_t> by_id_;
};

/// Returns the results in `out` whose id is not in `claimed`, sorted by id. An error if the folder
/// cannot be listed.
Expected<std::vector<EarlierResult>> unclaimed_results(const std::filesystem::path& out,
                                                       const ClaimedIds& claimed);

/// Returns the campaigns that no longer exist. Failed results of a folder whose campaign has
/// another id are only noted. The first `ordered` campaigns must be sorted by folder.
std::vector<Vanished> vanished_of(const std::vector<EarlierResult>& earlier,
                                  const std::vector<CampaignState>& campaigns, std::size_t ordered,
                                  const std::vector<SiteWalk::Unlisted>& unlisted,
                                  const std::filesystem::path& out,
                                  std::vector<std::string>& notes);

/// Content of the register before the run.
struct Known {
  std::vector<certificates::RegisterEntry> numbers;
  std::vector<certificates::WaitingDraft> drafts;
};

/// `first`: before numbers are issued, the hash chain of the journal is checked, and a broken chain
/// is an error.
enum class Look { first, again };
/// Returns std::nullopt if another process has locked the register. An error if it cannot be read,
/// or if it is stored in the output folder, where it could be lost.
Expected<std::optional<Known>> known_of(const RunOptions& options, const reading::Context& context,
                                        Look look = Look::first);

/// Returns the last position in the order of issue, counted from 1; 0 without certificates.
std::uint64_t issued_so_far(const std::vector<certificates::RegisterEntry>& numbers);

}  // namespace nonio::batch
