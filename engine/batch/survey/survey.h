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
  std::uint64_t run;  ///< number of the present run
  bool force;
  /// Entries of the site's register, and the campaigns with drafts in the register. The entries are
  /// none if another process keeps the register locked; numbers are then not checked.
  std::optional<std::vector<certificates::RegisterEntry>> numbers;
  std::set<std::string> drafts;
  std::vector<std::string>& notes;  ///< notes on skipped names, for the summary
  bool (*stopped)();            ///< whether to stop, called repeatedly; after true the result is
                                ///< incomplete
  bool verify_results = false;  ///< whether to compare the digests of all output files, not only
                                ///< their times
};

struct Surveyed {
  std::vector<CampaignState> campaigns;  ///< all campaigns of the site, sorted by id
  std::vector<Vanished> vanished;        ///< campaigns that no longer exist, sorted by id
};

/// Finds all campaigns of a site and decides what is to be done with each, and why. Campaigns with
/// the same id and campaigns whose files do not answer are failed and not evaluated; folders that
/// cannot be listed are failed entries of their own. The site is read in child processes.
Expected<Surveyed> survey(const SurveyInput& input);

/// Last step of a survey: sorts the campaigns by id and folder, marks campaigns with equal ids as
/// failed, and compares shared readings.
void set_in_order(std::vector<CampaignState>& campaigns);

/// Returns an error if the output folder contains a number that the register does not contain,
/// because numbers would be used twice. Called by a run whose survey could not read the register.
Expected<void> check_numbers(const std::filesystem::path& out,
                             const std::vector<CampaignState>& campaigns,
                             const std::vector<certificates::RegisterEntry>& numbers);

}  // namespace nonio::batch
