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
  std::filesystem::path site;  ///< site whose [signing] states trusted roots and expected signers
  std::filesystem::path signer_roots, time_stamp_roots;
  std::filesystem::path trust;  ///< file with one root for signers and time servers
  std::filesystem::path revocation;
  std::vector<std::string> signers;
};

/// Reads trusted roots, revocation lists and expected signers; arguments take precedence over the
/// site. An error if a file contains none of these, or if several roots would serve for both
/// signers and time servers.
config::Checked<sign::Verifier> verifier_of(const VerifyOptions& options);

}  // namespace nonio::certificates
