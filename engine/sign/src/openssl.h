// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/asn1.h>
#include <openssl/bio.h>
#include <openssl/cms.h>
#include <openssl/evp.h>
#include <openssl/x509.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/sign.h"

namespace nonio::sign {

template <auto Free>
struct Freed {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
inline void free_stack(STACK_OF(X509) * stack) { sk_X509_free(stack); }
inline void free_owned_stack(STACK_OF(X509) * stack) { sk_X509_pop_free(stack, X509_free); }

using BioPtr = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using CertificatePtr = std::unique_ptr<X509, Freed<X509_free>>;
using PrivateKeyPtr = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using CmsPtr = std::unique_ptr<CMS_ContentInfo, Freed<CMS_ContentInfo_free>>;
using RevocationPtr = std::unique_ptr<X509_CRL, Freed<X509_CRL_free>>;
using Borrowed = std::unique_ptr<STACK_OF(X509), Freed<free_stack>>;
using Owned = std::unique_ptr<STACK_OF(X509), Freed<free_owned_stack>>;

/// Returns OpenSSL's message about the last error, and clears the error queue.
std::string reason();

inline const unsigned char* data_of(std::string_view bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}
/// Returns the DER of an object, empty on failure. `encode` is the i2d function of its type.
template <class T, class Encode>
std::string der_of(T* object, Encode encode) {
  unsigned char* data = nullptr;
  const int size = encode(object, &data);
  if (size <= 0) return {};
  std::string bytes(reinterpret_cast<const char*>(data), static_cast<std::size_t>(size));
  OPENSSL_free(data);
  return bytes;
}
inline std::string der_of(const X509* certificate) { return der_of(certificate, &i2d_X509); }
std::string_view bytes_of(const ASN1_STRING* text);

/// Error for data with more bytes than `pdf::max_file`.
inline constexpr const char* too_large = "is larger than 100 MB";

std::string sha256(std::string_view one, std::string_view other = {});
std::string hex(std::string_view bytes);
std::string subject_of(const X509* certificate);
/// Returns seconds since 1970-01-01 UTC; 0 if `time` is invalid.
Time time_of(const ASN1_TIME* time);
/// Returns, for example, "RSA-3072" or "P-256"; an error for keys that are too weak or cannot be
/// used in a CMS. `old`: whether RSA keys of 2048 bits are accepted, as for existing signatures,
/// instead of 3072.
Expected<std::string> algorithm_of(EVP_PKEY* key, bool old);

/// Returns an error if the PEM text contains no certificate, or a certificate that cannot be read.
Expected<std::vector<CertificatePtr>> certificates_of(const std::string& pem);

}  // namespace nonio::sign
