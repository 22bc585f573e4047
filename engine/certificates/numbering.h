// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/evaluation/evaluate.h"
#include "certificates/campaign_files.h"
#include "certificates/register.h"

namespace nonio::certificates {

/// Returns the rule of the site that accepts this finding; null if there is none. Findings about
/// plausibility are accepted by no rule, because they require a person's reason each time.
const config::AcceptedRule* rule_for(const config::Numbering& numbering,
                                     const evaluation::KnownFinding& finding);

/// A draft, and the approval of the person who issues it.
struct Releasing {
  WaitingDraft draft;
  Approval by;
  reading::Twins twins{};  ///< files of readings that the campaign shares with other campaigns, as
                           ///< the run found them
};

/// Accesses the site's register for a run, or for the approval of one campaign. Every call opens
/// the register itself, because no process may inherit it from another.
class Numbers {
 public:
  struct Where {
    std::filesystem::path site, out;
    std::string today;  ///< present date, YYYY-MM-DD
    bool can_sign;      ///< whether a key exists, or no key is needed
  };
  /// `releasing` is null in a run.
  Numbers(Where where, const reading::Context& context, const Releasing* releasing)
      : where_(std::move(where)), context_(context), releasing_(releasing) {}

  /// Assigns a certificate to the data: the one that was issued for them, even if something is
  /// `missing` today; otherwise, if nothing is missing, a draft or a number; otherwise neither.
  /// `as_draft`: never assign a number.
  evaluation::AssignedNumber assign(const evaluation::Evaluated& evaluated, CampaignFiles& files,
                                    std::vector<std::string> missing, bool as_draft) const;
  /// Returns whether a finding that no rule accepts appeared after the rules had allowed a number
  /// to be assigned.
  bool held_up(const evaluation::Evaluated& evaluated) const;
  /// Has to be called after signing. Enters the certificate into the register and replaces the
  /// campaign's files by those of the register; does nothing without a certificate or if the
  /// evaluation failed. Adds a finding if an earlier certificate's values would be different now,
  /// or if a file has no time stamp. A draft is entered as waiting for approval. `folder`: folder
  /// of the campaign, relative to the site.
  Expected<void> issue(evaluation::Evaluated& evaluated, const std::string& folder) const;
  /// Removes files that were to be signed if there is no certificate and the rules of the site do
  /// not allow to issue, and adds a finding for each output that has lost files. Nothing is removed
  /// for a certificate, or if a person approves.
  void hold_unreleased(evaluation::Evaluated& evaluated) const;
  /// Records why a number that was drawn for a campaign is not issued. Errors are ignored, because
  /// no caller could handle them.
  void note_failure(const std::string& campaign, const std::string& why) const;

 private:
  Expected<Register> open() const;
  Expected<bool> has_register() const;
  bool may_issue(const evaluation::Evaluated& evaluated) const;
  /// Returns the certificate for the data. Without a number, `missing` lists what is missing for
  /// one.
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
