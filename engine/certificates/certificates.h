// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "campaign/evaluation/evaluate.h"
#include "certificates/campaign_files.h"
#include "certificates/signer.h"
#include "nonio/sign/sign.h"

namespace nonio::certificates {

/// How the attachments of a certificate are called.
inline constexpr const char* settings_name = "site-settings.toml";
/// Of those from which a certificate was made.
inline constexpr const char* source_relation = "Source";
inline constexpr const char* templates_name = "templates.json";

/// Why nothing can be signed where `signer` is null.
inline constexpr const char* no_key =
    "an output is to be signed, and site.toml does not contain a key; expected [signing]";

/// Signs the artifacts that outputs want signed: XML documents first, then PDFs, into which go the
/// manifest, the readings, the parts of site.toml that affect them, results.json and the signed XML
/// documents. What is to be issued under a number is then in `Evaluated::certificate`, and is taken
/// from the register in the end; what is issued already is not signed again. Of a draft only its
/// pages are kept, unsigned; what else would be signed waits with it. Of a failed campaign nothing
/// is signed: these artifacts are taken away. `signer` is null where site.toml has no
/// [signing].
Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, const Signer* signer,
                              sign::Time now);

/// "certificate.pdf" -> "certificate-draft.pdf".
std::string draft_name(const std::string& pdf);

/// Who signs what `sign_artifacts` has put together: the process with the key; or, when a
/// certificate is verified, a caller that compares it with the present file.
struct SignWith {
  std::function<Expected<sign::Signed>(const Artifact&)> sign;
  /// What is attached as results.json, from what was made of it now; none: that.
  std::function<Expected<std::string>(std::string made)> results{};
};
Expected<void> sign_artifacts(evaluation::Evaluated& evaluated, CampaignFiles& files,
                              const reading::Context& context, const SignWith& how, sign::Time now);

/// Removes files that should be signed and are not, and all files of a certificate that is not issued.
void remove_unsigned(evaluation::Evaluated& evaluated);

/// Adds a finding to what one of its outputs found.
void note_finding(evaluation::Evaluated& evaluated, const std::string& output, Finding finding);
/// That a file was signed without time stamp, if it was.
void note_time_stamp(evaluation::Evaluated& evaluated, const evaluation::IssuedFile& file);

}  // namespace nonio::certificates
