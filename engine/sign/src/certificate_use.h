// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openssl.h"

namespace nonio::sign {

/// Returns an error unless the certificate allows its key to sign documents. A key usage, if
/// present, must contain digitalSignature or nonRepudiation, and an extended key usage
/// documentSigning, emailProtection or anyExtendedKeyUsage.
Expected<void> check_signer_use(X509* certificate);

}  // namespace nonio::sign
