// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/evaluation/evaluate.h"
#include "certificates/campaign_files.h"
#include "certificates/register.h"

namespace nonio::certificates {

/// Returns null if no rule of the site accepts the finding. Findings about plausibility are
/// accepted by no rule, because they require a person's reason each time.
const config::AcceptedRule* rule_for(const config::Numbering& numbering,
                                     const evaluation::KnownFinding& finding);

struct Releasing {
  WaitingDraft draft;
  Approval by;
  reading::Twins twins{};  ///< files of readings shared with other campaigns, as found by the run
};

/// Accesses the site's register for a run, or for the approval of one campaign. A call that needs
/// the register opens it, because no process may inherit an open register from another.
class Numbers {
 public:
  struct Where {
    std::filesystem::path site, out;
    std::string today;  ///< YYYY-MM-DD
    bool can_sign;      ///< whether a key exists, or no key is needed
  };
  /// `releasing` is null in a run.
  Numbers(Where where, const reading::Context& context, const Releasing* releasing)
      : where_(std::move(where)), context_(context), releasing_(releasing) {}

  /// Returns the certificate that was issued for the data, even if something is `missing` today;
  /// otherwise, if nothing is missing, a draft or a number; otherwise neither. `as_draft`: a number
  /// is never returned.
  evaluation::AssignedNumber assign(const evaluation::Evaluated& evaluated, CampaignFiles& files,
                                    std::vector<std::string> missing, bool as_draft) const;
  /// Whether a finding that no rule accepts appeared after the rules had allowed a number.
  bool held_up(const evaluation::Evaluated& evaluated) const;
  /// Enters the signed certificate, or the draft, into the register and replaces the campaign's
  /// files by those of the register; does nothing if the evaluation failed. Adds a finding if an
  /// earlier certificate's values would be different now, or if a file has no time stamp. `folder`:
  /// folder of the campaign, relative to the site.
  Expected<void> issue(evaluation::Evaluated& evaluated, const std::string& folder) const;
  /// If neither a person nor the rules of the site approve, removes files to be signed that belong
  /// to no certificate, and adds a finding for each output that has lost files.
  void hold_unreleased(evaluation::Evaluated& evaluated) const;
  /// Errors are ignored, because no caller could handle them.
  void note_failure(const std::string& campaign, const std::string& why) const;

 private:
  Expected<Register> open() const;
  Expected<bool> has_register() const;
  bool may_issue(const evaluation::Evaluated& evaluated) const;
  /// Adds to `missing` the data without which no number is drawn.
  Expected<evaluation::Certificate> find_or_draw(const evaluation::Evaluated& evaluated,
                                                 CampaignFiles& files,
                                                 std::vector<std::string>& missing,
                                                 bool as_draft) const;
  Expected<void> amend(Register& opened, const RegisterEntry& before,
                       const evaluation::Evaluated& evaluated, CampaignFiles& files, Issue& issue,
                       std::vector<std::string>& missing) const;
  Expected<void> check_release(const reading::Inputs& now) const;
  Expected<void> enter_draft(const evaluation::Evaluated& evaluated,
                             const std::string& folder) const;
  Expected<void> issue_new(evaluation::Evaluated& evaluated) const;
  std::string released_json(const std::vector<evaluation::KnownFinding>& findings) const;
  void note_differences(evaluation::Evaluated& evaluated) const;

  const Where where_;
  const reading::Context& context_;
  const Releasing* const releasing_;
};

}  // namespace nonio::certificates
