// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openssl.h"

namespace nonio::sign {

/// Returns an error unless the certificate allows its key to sign documents: key usage
/// digitalSignature or nonRepudiation, and if there is an extended key usage, one for documents,
/// for mail or for any use.
Expected<void> check_signer_use(X509* certificate);

}  // namespace nonio::sign
