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

/// Decides whether a campaign is evaluated by comparing its files with its last record. Runs in a
/// child process of the survey.
class ChangeDetector {
 public:
  ChangeDetector(const SurveyInput& input, process::SignsOfLife& signs);

  /// `known` contains the folder, and the id if the manifest states none. `rough` omits the parsing
  /// of the manifest, which has crashed the process before.
  CampaignState at(const CampaignState& known, bool rough);
  /// Returns an issued number that the register lacks; empty if there is none.
  const std::string& unknown_number() const { return unknown_; }

 private:
  using Last = Expected<std::optional<evaluation::LastRecord>>;

  /// Returns the id in the manifest and stores the digests of the files of readings in `state`.
  /// Empty if the manifest is invalid, or without parsing if `rough`.
  std::string read_whole(CampaignState& state, const std::string& manifest, bool rough);
  Last last_of(const std::string& id);
  std::string staged_reason(const CampaignState& state) const;
  void judge(CampaignState& state, const Last& last, const std::string& manifest_digest);
  std::string changes(CampaignState& state, const evaluation::Record& record,
                      const std::string& manifest_digest);
  /// Adds a reason to `why` if the digest of the file is not `digest`. Returns the first 64 bits of
  /// the present digest, or std::nullopt if the file cannot be read.
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
