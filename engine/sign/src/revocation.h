// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/ocsp.h>

#include <limits>

#include "openssl.h"

namespace nonio::sign {

struct Trusted;

using OcspPtr = std::unique_ptr<OCSP_BASICRESP, Freed<OCSP_BASICRESP_free>>;

/// Revocation data of an authority: a revocation list or an OCSP answer (RFC 6960).
struct Statement {
  std::string der;
  RevocationPtr list;  ///< exactly one of `list` and `answer` is set
  OcspPtr answer;
  Time seen = 0;  ///< time at which the statement is proved to have existed
  mutable bool used = false;

  static Expected<Statement> of_list(std::string_view der);
  static Expected<Statement> of_answer(std::string_view der);
};

struct Revocation {
  enum class Of { signer, time_server };
  Time at;   ///< time at which the certificates were used
  Time now;  ///< time of the check, at which given lists must be current
  Of of;
  /// Time at which signatures or time stamps made with the certificates are proved to have existed.
  Time until = std::numeric_limits<Time>::max();
};
/// Largest accepted difference between two clocks, s.
inline constexpr Time clock_tolerance = 60;

/// Checks the revocation of each certificate of a chain except the root. An error if one was
/// revoked at or before `at`, or if the newest list of an issuer is past its nextUpdate, from the
/// future, or partial. For a time server (RFC 3161, 4), a revocation up to `until` is an error too,
/// unless its reason leaves earlier time stamps valid. Returns a text about the checks. Sets
/// `looked` to whether the status of the first certificate is known.
Expected<std::string> check_revocation(const std::vector<CertificatePtr>& chain,
                                       const Trusted& trusted, const Revocation& revocation,
                                       bool& looked);
/// Whether the statement comes from `issuer`, is about `certificate`, and proves that the
/// certificate was good at `at`. The statement must have been current when it was seen, or made
/// after `at`; it must have been made before the expiry of the certificate, and seen before the
/// expiry of the issuer's certificate. An error if it is damaged or states a revocation that is an
/// error for `check_revocation`.
Expected<bool> vouches(const Statement& statement, X509* certificate, X509* issuer,
                       const Revocation& revocation);

}  // namespace nonio::sign
