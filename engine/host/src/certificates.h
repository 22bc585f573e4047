// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "nonio/host/evaluate.h"
#include "nonio/sign/sign.h"
#include "signer.h"

namespace nonio::host {

/// How the attachments of a certificate are called.
inline constexpr const char* settings_name = "site-settings.toml";

/// Signs the artifacts that outputs want signed: XML documents first, then PDFs, into which go the
/// manifest, the readings, what of site.toml has a say in the results, results.json and the signed
/// XML documents. Of a failed campaign nothing is signed: these artifacts are taken away.
/// `signer` is null where site.toml has no [signing].
Expected<void> sign_artifacts(Evaluated& evaluated, const std::filesystem::path& folder,
                              const Context& context, const Signer* signer, sign::Time now);

/// Takes away what is to be signed and is not.
void remove_unsigned(Results& results);

}  // namespace nonio::host
