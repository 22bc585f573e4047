// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "campaign/evaluation/evaluate.h"
#include "certificates/campaign_files.h"
#include "certificates/signer.h"
#include "nonio/sign/sign.h"

namespace nonio::certificates {

/// Name of the attachment with the settings of the site.
inline constexpr const char* settings_name = "site-settings.toml";
/// Relation of attachments that a certificate was made from.
inline constexpr const char* source_relation = "Source";
inline constexpr const char* templates_name = "templates.json";

/// Error if something is to be signed and `signer` is null.
inline constexpr const char* no_key =
    "an output is to be signed, and site.toml does not contain a key; expected [signing]";

/// Signs the artifacts that are to be signed: XML documents first, then PDFs, which get as
/// attachments the manifest, the readings, the machine record, the parts of site.toml that affect
/// the results, the templates, results.json and the signed XML documents. Files to be issued under
/// a number are then in `Evaluated::certificate`; they are finally taken from the register, so
/// files that are issued already are not signed again. Of a draft, only the pages are kept,
/// unsigned; other files that would be signed are left out until the draft is approved. If the
/// campaign failed, nothing is signed and these artifacts are removed. `signer` is null if
/// site.toml has no [signing].
Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, const Signer* signer,
                              sign::Time now);

/// Returns "certificate-draft.pdf" for "certificate.pdf".
std::string draft_name(const std::string& pdf);

/// Functions with which `sign_artifacts` signs: those of the process with the key, or during
/// verification, functions that compare with the present file.
struct SignWith {
  std::function<Expected<sign::Signed>(const Artifact&)> sign;
  /// Returns the attached results.json, given the one that was made now; empty: attach the latter.
  std::function<Expected<std::string>(std::string made)> results{};
};
Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, const SignWith& how, sign::Time now);

/// Removes files that should be signed and are not, and all files of a certificate that is not
/// issued.
void remove_unsigned(evaluation::Evaluated& evaluated);

/// Adds a finding to the findings of an output. A finding with severity warning sets the status of
/// the campaign to attention.
void note_finding(evaluation::Evaluated& evaluated, const std::string& output, Finding finding);
/// Adds a finding if the file was signed without a time stamp.
void note_time_stamp(evaluation::Evaluated& evaluated, const evaluation::IssuedFile& file);

}  // namespace nonio::certificates
