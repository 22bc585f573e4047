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

/// Owners for what OpenSSL gives, and its bytes and times as ours.
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
using Borrowed = std::unique_ptr<STACK_OF(X509), Freed<free_stack>>;  ///< of certificates not owned
using Owned = std::unique_ptr<STACK_OF(X509), Freed<free_owned_stack>>;

/// OpenSSL's message about the last error; forgets it.
std::string reason();

inline const unsigned char* data_of(std::string_view bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}
/// With an i2d function of OpenSSL.
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

/// Of what has more bytes than `pdf::max_file`.
inline constexpr const char* too_large = "is larger than 100 MB";

std::string sha256(std::string_view one, std::string_view other = {});
std::string hex(std::string_view bytes);
std::string subject_of(const X509* certificate);
/// 0 if it is no time.
Time time_of(const ASN1_TIME* time);
/// "RSA-3072", "P-256"; an error for what is too weak or cannot be used in a CMS. `old`: what was
/// signed before is accepted down to RSA-2048.
Expected<std::string> algorithm_of(EVP_PKEY* key, bool old);

/// All certificates of a PEM text. An error if there is none, or something else among them.
Expected<std::vector<CertificatePtr>> certificates_of(const std::string& pem);

}  // namespace nonio::sign
