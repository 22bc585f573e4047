// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/ocsp.h>

#include <limits>

#include "openssl.h"

namespace nonio::sign {

struct Trusted;

using OcspPtr = std::unique_ptr<OCSP_BASICRESP, Freed<OCSP_BASICRESP_free>>;

/// Revocation data of an authority: a revocation list, or an answer by OCSP (RFC 6960).
struct Statement {
  std::string der;
  RevocationPtr list;  ///< or else
  OcspPtr answer;
  Time seen = 0;  ///< when it is proved to have existed
  mutable bool used = false;

  static Expected<Statement> of_list(std::string_view der);
  static Expected<Statement> of_answer(std::string_view der);
};

/// What a revocation is compared with.
struct Revocation {
  enum class Of { signer, time_server };
  Time at;   ///< when the certificates were used
  Time now;  ///< when they are checked: lists that are given must be of use now
  Of of;
  /// When what was made with them is proved to have existed: what was revoked later is of no
  /// account.
  Time until = std::numeric_limits<Time>::max();
};
/// How far two clocks may differ.
inline constexpr Time clock_tolerance = 60;

/// An error if a certificate of the chain was revoked before `at`, or if the newest list of an
/// issuer is of no use: past its nextUpdate, from the future, or a part of a list only. Of a time
/// server (RFC 3161, 4): revoked later counts too, unless the reason leaves its key unharmed. Of a
/// certificate that has run out only what was stated before it did is heard. Else what was and was
/// not looked at.
Expected<std::string> check_revocation(const std::vector<CertificatePtr>& chain,
                                       const Trusted& trusted, const Revocation& revocation,
                                       bool& looked);
/// Whether the statement is of `issuer`, about that certificate, and proves that it was good at
/// `at`: it was of use when it was seen, or made after the certificate was used, and in any case
/// before the certificate ran out, and seen before that of the issuer did. An error if it states
/// that the certificate was revoked.
Expected<bool> vouches(const Statement& statement, X509* certificate, X509* issuer,
                       const Revocation& revocation);

}  // namespace nonio::sign
