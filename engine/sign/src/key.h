// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sign/sign.h"
#include "openssl.h"

namespace nonio::sign {

/// A key with its certificate and the chain towards the root, without the root itself.
struct Key::Impl {
  PrivateKeyPtr key;
  CertificatePtr certificate;
  std::vector<CertificatePtr> chain;
  Identity identity{};

  Expected<std::string> sign_bytes(std::string_view bytes) const;  ///< signs with SHA-256
};

Expected<Key::Impl> open_token(const KeyPlace& place, const std::string& password);

/// Returns the CMS signature over `before` followed by `after`, in DER. Sets `no_time_stamp` to the
/// reason why an optional time stamp is missing.
Expected<std::string> make_cms(const Key::Impl& key, std::string_view before,
                               std::string_view after, Time now, const TimeStamping& stamping,
                               std::string& no_time_stamp);

Expected<Signed> sign_xml(const Key::Impl& key, std::string_view document, Time now,
                          const TimeStamping& stamping);

/// Returns an error unless the key usage, if present, contains digitalSignature or nonRepudiation,
/// and the extended key usage, if present, contains documentSigning, emailProtection or
/// anyExtendedKeyUsage.
Expected<void> check_signer_use(X509* certificate);

}  // namespace nonio::sign
