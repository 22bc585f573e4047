// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <vector>

#include "batch/state/run_result.h"
#include "campaign/evaluation/evaluate.h"
#include "certificates/register.h"

namespace nonio::batch {

struct SurveyInput {
  std::filesystem::path site, out;
  const reading::Context& context;
  std::uint64_t run;  ///< the one that is being done
  bool force;
  /// All of the site's register, and the campaigns whose drafts wait there; none while another
  /// process keeps it locked: then it is not consulted.
  std::optional<std::vector<certificates::RegisterEntry>> numbers;
  std::set<std::string> drafts;
  std::vector<std::string>& notes;  ///< what was passed over, for the summary
  bool (*stopped)();            ///< called repeatedly; if it becomes true, the result is incomplete
  bool verify_results = false;  ///< digests decide of all files given out
};

struct Surveyed {
  std::vector<CampaignState> campaigns;  ///< by id
  std::vector<Vanished> vanished;        ///< by id
};

/// All campaigns of a site, each with what is to be done with it and why. Failed, and not to be
/// evaluated, are: campaigns whose ids collide, campaigns whose files give no answer, and, as
/// entries of their own, folders that cannot be listed. The site is read in child processes.
Expected<Surveyed> survey(const SurveyInput& input);

/// The last step of a survey: in the order of ids and folders, with collisions and shared readings.
void set_in_order(std::vector<CampaignState>& campaigns);

/// An error if the output folder has a number that the register does not know: numbers would be
/// used twice. For a run whose survey could not consult it.
Expected<void> check_numbers(const std::filesystem::path& out,
                             const std::vector<CampaignState>& campaigns,
                             const std::vector<certificates::RegisterEntry>& numbers);

}  // namespace nonio::batch
