// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/evaluation/evaluate.h"
#include "certificates/campaign_files.h"
#include "certificates/register.h"

namespace nonio::certificates {

/// Whether a rule of the site accepts this finding.
const config::AcceptedRule* rule_for(const config::Numbering& numbering,
                                     const evaluation::KnownFinding& finding);

/// A draft, and the one who releases it.
struct Releasing {
  WaitingDraft draft;
  Approval by;
  reading::Twins twins{};  ///< what the run knew of other campaigns
};

/// What a run, or the release of one campaign, does with the site's register. Every call opens it
/// by itself: no process inherits it from another.
class Numbers {
 public:
  struct Where {
    std::filesystem::path site, out;
    std::string today;  ///< YYYY-MM-DD
    bool can_sign;      ///< there is a key, or there are neither drafts nor numbers
  };
  /// `releasing` is null in a run.
  Numbers(Where where, const reading::Context& context, const Releasing* releasing)
      : where_(std::move(where)), context_(context), releasing_(releasing) {}

  /// What was issued for these data, whatever is `missing` for it today; else, if nothing is, a
  /// draft or a number; else neither. `as_draft`: never a number.
  evaluation::AssignedNumber assign(const evaluation::Evaluated& evaluated, CampaignFiles& files,
                                    std::vector<std::string> missing, bool as_draft) const;
  /// Whether a finding that no rule accepts came after a number was drawn by the rules.
  bool held_up(const evaluation::Evaluated& evaluated) const;
  /// After signing: enters what is issued into the register, and gives the campaign what the
  /// register holds. Of what was issued before it is stated if its numbers are others now. A draft
  /// is entered as one that waits for `folder`'s release (relative to the site).
  Expected<void> issue(evaluation::Evaluated& evaluated, const std::string& folder) const;
  /// Nothing is signed that neither a person nor the site's rules have released. Documents that are
  /// not part of a certificate need no release: they are signed if the rules allow it, else omitted
  /// with a finding.
  void hold_unreleased(evaluation::Evaluated& evaluated) const;
  /// Records why a number that was drawn for a campaign is not issued. Errors are ignored, because
  /// no caller could handle them.
  void note_failure(const std::string& campaign, const std::string& why) const;

 private:
  Expected<Register> open() const;
  Expected<bool> has_register() const;
  bool may_issue(const evaluation::Evaluated& evaluated) const;
  /// No number: `missing` states what for.
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
