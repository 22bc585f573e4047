// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openssl.h"

namespace nonio::sign {

/// Returns an error unless the key usage, if present, contains digitalSignature or nonRepudiation,
/// and the extended key usage, if present, contains documentSigning, emailProtection or
/// anyExtendedKeyUsage.
Expected<void> check_signer_use(X509* certificate);

}  // namespace nonio::sign
