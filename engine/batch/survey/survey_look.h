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

/// Decides what is to be done with a campaign, and why, by comparing its files with those of its
/// last result. Runs in a child process of the survey, since it reads the site.
class ChangeDetector {
 public:
  ChangeDetector(const SurveyInput& input, process::SignsOfLife& signs);

  /// Returns the state of a campaign. `known` contains its folder, and also its id if the manifest
  /// states none. `rough`: do not parse the manifest, because that crashed the process before.
  CampaignState at(const CampaignState& known, bool rough);
  /// Returns an issued number that the register does not contain; empty if there is none.
  const std::string& unknown_number() const { return unknown_; }

 private:
  using Last = Expected<std::optional<evaluation::LastRecord>>;

  /// Parses the manifest and returns its id; stores the digests of the campaign's files of readings
  /// in the state. Returns an empty text, without parsing, if `rough`, and also if the manifest is
  /// invalid.
  std::string read_whole(CampaignState& state, const std::string& manifest, bool rough);
  Last last_of(const std::string& id);
  std::string staged_reason(const CampaignState& state) const;
  void judge(CampaignState& state, const Last& last, const std::string& manifest_digest);
  std::string changes(CampaignState& state, const evaluation::Record& record,
                      const std::string& manifest_digest);
  /// Adds a reason to `why` if the content of the file differs from `digest`. Returns the first 64
  /// bits of the file's present digest; none if the file cannot be read.
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
