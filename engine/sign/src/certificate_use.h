// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openssl.h"

namespace nonio::sign {

/// Whether a certificate states that its key may sign documents: key usage digitalSignature or
/// nonRepudiation, and where there is an extended key usage, one for documents or mail.
Expected<void> check_signer_use(X509* certificate);

}  // namespace nonio::sign
