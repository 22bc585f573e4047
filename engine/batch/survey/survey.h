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
  std::uint64_t run;
  bool force;
  /// Register entries and campaigns with drafts. Without entries, because another process has
  /// locked the register, numbers are not checked.
  std::optional<std::vector<certificates::RegisterEntry>> numbers;
  std::set<std::string> drafts;
  std::vector<std::string>& notes;  ///< on skipped names
  bool (*stopped)();                ///< called repeatedly; after true the result is incomplete
  bool verify_results = false;      ///< whether to compare digests in addition to times
};

struct Surveyed {
  std::vector<CampaignState> campaigns;
  std::vector<Vanished> vanished;
};

/// Decides for each campaign of a site whether it is evaluated and why. Campaigns with equal ids or
/// with files that do not respond fail; so do folders that cannot be listed, which are separate
/// entries. The site is read in child processes.
Expected<Surveyed> survey(const SurveyInput& input);

/// Last step of a survey: sorts by id and folder, marks campaigns with equal ids as failed, and
/// compares files of readings.
void set_in_order(std::vector<CampaignState>& campaigns);

/// Returns an error if the output folder contains a number that the register lacks, because numbers
/// would be used twice. For runs whose survey could not read the register.
Expected<void> check_numbers(const std::filesystem::path& out,
                             const std::vector<CampaignState>& campaigns,
                             const std::vector<certificates::RegisterEntry>& numbers);

}  // namespace nonio::batch
