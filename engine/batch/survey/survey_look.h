// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/survey/survey.h"
#include "campaign/evaluation/record.h"
#include "platform/process/watched.h"
#include "platform/storage/digest.h"

namespace nonio::batch {

/// What is to be done with a campaign, and why: its contents against those of its last result. Runs
/// in a child process of the survey, since it reads the site.
class ChangeDetector {
 public:
  ChangeDetector(const SurveyInput& input, process::SignsOfLife& signs);

  /// Of a campaign of which the folder is known, and the id where its manifest gives none. `rough`:
  /// without parsing the manifest, which brought down the process before.
  CampaignState at(const CampaignState& known, bool rough);
  /// A number that was issued and that the register does not know; empty if all is well.
  const std::string& unknown_number() const { return unknown_; }

 private:
  using Last = Expected<std::optional<evaluation::LastRecord>>;

  /// The id that the manifest gives; notes the digests of its files in the state.
  std::string read_whole(CampaignState& state, const std::string& manifest, bool rough);
  Last last_of(const std::string& id);
  std::string staged_reason(const CampaignState& state) const;
  void judge(CampaignState& state, const Last& last, const std::string& manifest_digest);
  std::string changes(CampaignState& state, const evaluation::Record& record,
                      const std::string& manifest_digest);
  /// Adds what is not as it was; the begin of the file's digest.
  std::optional<std::uint64_t> look_at_file(const CampaignState& state, const std::string& name,
                                            const std::string& digest,
                                            std::vector<std::string>& why);
  void look_at_outputs(const CampaignState& state, const evaluation::Record& record,
                       std::vector<std::string>& why);
  void look_at_number(const CampaignState& state, const evaluation::Record& record,
                      std::vector<std::string>& why) const;
  Expected<std::string> digest_with_signs(const std::filesystem::path& path);

  const SurveyInput& in_;
  process::SignsOfLife& signs_;
  reading::Inputs shared_;
  std::map<std::string, const certificates::RegisterEntry*> numbers_;
  std::string unknown_;
};

}  // namespace nonio::batch
