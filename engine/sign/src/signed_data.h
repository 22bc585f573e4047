// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sign/verify.h"
#include "openssl.h"
#include "revocation.h"

namespace nonio::sign {

struct Trusted {
  std::vector<CertificatePtr> signer_roots, time_roots;
  std::vector<RevocationPtr> lists;
  std::vector<Statement> kept{};  ///< revocation data contained in the file
};
Expected<Trusted> trusted(const Verifier& verifier);

/// A CMS SignedData of one signer (RFC 5652): the signature of a PDF, or a time-stamp token.
class SignedData {
 public:
  enum class Content { detached, time_stamp };

  /// Parses strictly: one signer, DER, known algorithms, nothing beyond the required parts. For
  /// every byte that is not signed, only one value is accepted.
  static Expected<SignedData> parse(std::string_view der, Content content);

  /// Returns an error unless the signed attributes are exactly those that Nonio writes, once each.
  Expected<void> check_attributes() const;
  /// Checks the signed digest of `before` followed by `after`, and the signature over it.
  Expected<void> check_signature(std::string_view before, std::string_view after) const;
  /// Checks the signed reference to the signer's certificate (ESS, RFC 5035).
  Expected<void> check_certificate_named() const;

  /// Returns all certificates of the structure without any check.
  const std::vector<CertificatePtr>& certificates() const { return certificates_; }
  X509* certificate() const { return signer_certificate_; }
  std::string_view certificate_der() const { return signer_der_; }
  std::string_view signature() const { return signature_; }
  /// Returns the content of a time stamp (TSTInfo, RFC 3161); empty for a detached signature.
  std::string_view content() const { return content_; }
  /// Returns the time-stamp token of a signature; empty without a token.
  std::string_view time_stamp() const { return token_; }

 private:
  Expected<void> read_outside(Content content);
  Expected<void> read_content(std::string_view text, Content content);
  Expected<void> read_certificates(std::string_view text);
  Expected<void> read_signer(std::string_view text, Content content);
  Expected<void> read_unsigned(std::string_view text, Content content);
  Expected<void> find_certificate(std::string_view identifier);

  std::string der_;
  CmsPtr cms_;
  CMS_SignerInfo* signer_ = nullptr;
  const EVP_MD* digest_ = nullptr;
  std::vector<CertificatePtr> certificates_;
  std::vector<std::string_view> certificate_ders_;
  X509* signer_certificate_ = nullptr;
  std::string_view signer_der_, signature_, content_, token_;
};

/// Returns the chain from this certificate to a root. All certificates must be valid at `at`.
Expected<std::vector<CertificatePtr>> chain_of(X509* certificate,
                                               const std::vector<CertificatePtr>& others,
                                               const std::vector<CertificatePtr>& roots, Time at);
/// Each certificate must be issued and validly signed by one of `certificates` or `roots`.
Expected<void> check_issued(const std::vector<CertificatePtr>& certificates,
                            const std::vector<CertificatePtr>& roots);

/// Each certificate must be in the chain exactly once, because no signature covers the list.
Expected<void> check_only(const std::vector<CertificatePtr>& certificates,
                          const std::vector<CertificatePtr>& chain);
/// Returns those of `others` that lead from the certificate towards the root, in this order.
std::vector<CertificatePtr> way_up(X509* certificate, std::vector<CertificatePtr> others);

}  // namespace nonio::sign
