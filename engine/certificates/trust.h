// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "nonio/sign/verify.h"

namespace nonio::certificates {

/// Arguments of `nonio certificate verify`; paths may be empty.
struct VerifyOptions {
  std::filesystem::path site;  ///< whose [signing] states whom to trust and expect
  std::filesystem::path signer_roots, time_stamp_roots;
  std::filesystem::path trust;  ///< one root for both
  std::filesystem::path revocation;
  std::vector<std::string> signers;
};

/// Trust, revocation lists and expected signers; what is given by itself goes before the site's. An
/// error where a file that is named holds nothing of its kind, and where one file of several roots
/// would serve for signers and for time servers.
config::Checked<sign::Verifier> verifier_of(const VerifyOptions& options);

}  // namespace nonio::certificates
