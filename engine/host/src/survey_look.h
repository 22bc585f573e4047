// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "nonio/host/digest.h"
#include "nonio/host/record.h"
#include "survey.h"
#include "watched.h"

namespace nonio::host {

/// What is to be done with a campaign, and why: its contents against those of its last result. Runs
/// in a child process of the survey, since it reads the site.
class Look {
 public:
  Look(const SurveyInput& input, SignsOfLife& signs);

  /// Of a campaign of which the folder is known, and the id where its manifest gives none. `rough`:
  /// without parsing the manifest, which brought down the process before.
  CampaignState at(const CampaignState& known, bool rough);
  /// A number that was issued and that the register does not know; empty if all is well.
  const std::string& unknown_number() const { return unknown_; }

 private:
  using Last = Expected<std::optional<LastRecord>>;

  /// The id that the manifest gives; notes the digests of its files in the state.
  std::string read_whole(CampaignState& state, const std::string& manifest, bool rough);
  Last last_of(const std::string& id);
  std::string staged_reason(const CampaignState& state) const;
  void judge(CampaignState& state, const Last& last, const std::string& manifest_digest);
  std::string changes(CampaignState& state, const Record& record,
                      const std::string& manifest_digest);
  void look_at_file(CampaignState& state, const std::string& name, const std::string& digest,
                    std::vector<std::string>& why);
  void look_at_outputs(const CampaignState& state, const Record& record,
                       std::vector<std::string>& why);
  void look_at_number(const CampaignState& state, const Record& record,
                      std::vector<std::string>& why) const;
  Expected<std::string> digest_with_signs(const std::filesystem::path& path);

  const SurveyInput& in_;
  SignsOfLife& signs_;
  Inputs shared_;
  std::map<std::string, const RegisterEntry*> numbers_;
  std::string unknown_;
};

}  // namespace nonio::host
