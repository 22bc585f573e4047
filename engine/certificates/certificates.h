// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "campaign/evaluation/evaluate.h"
#include "certificates/campaign_files.h"
#include "certificates/signer.h"
#include "nonio/sign/sign.h"

namespace nonio::certificates {

inline constexpr const char* settings_name = "site-settings.toml";
/// /AFRelationship of the attachments from which a certificate was made.
inline constexpr const char* source_relation = "Source";
inline constexpr const char* templates_name = "templates.json";

/// Error if something is to be signed and `signer` is null.
inline constexpr const char* no_key =
    "an output is to be signed, and site.toml does not contain a key; expected [signing]";

/// Signs XML documents first, then PDFs, which get as attachments the manifest, the readings, the
/// machine record, the parts of site.toml that affect the results, the templates, results.json and
/// the signed XML documents. Files to be issued under a number are then in
/// `Evaluated::certificate`; issued files are not signed again. Of a draft, only the pages are
/// kept, unsigned. If the campaign failed, files that should be signed are removed. `signer` is
/// null if site.toml has no [signing].
Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, const Signer* signer,
                              sign::Time now);

/// Returns "certificate-draft.pdf" for "certificate.pdf".
std::string draft_name(const std::string& pdf);

/// Functions of the process with the key; for verification, functions that compare with a file.
struct SignWith {
  std::function<Expected<sign::Signed>(const Artifact&)> sign;
  /// Returns the results.json to attach instead of `made`; `made` is attached without this
  /// function.
  std::function<Expected<std::string>(std::string made)> results{};
};
Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, const SignWith& how, sign::Time now);

/// Removes files that should be signed and are not, and all files of a certificate that is not
/// issued.
void remove_unsigned(evaluation::Evaluated& evaluated);

/// A finding with severity warning sets the status of the campaign to attention.
void note_finding(evaluation::Evaluated& evaluated, const std::string& output, Finding finding);
/// Adds a finding if the file was signed without a time stamp.
void note_time_stamp(evaluation::Evaluated& evaluated, const evaluation::IssuedFile& file);

}  // namespace nonio::certificates
