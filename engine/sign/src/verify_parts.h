// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "der.h"
#include "nonio/pdf/text.h"
#include "nonio/sign/verify.h"
#include "openssl.h"
#include "signed_data.h"

namespace nonio::sign {

using pdf::quoted;

template <class T>
Expected<void> to_void(const Expected<T>& result) {
  if (result) return {};
  return fail(result.error());
}

class Report {
 public:
  explicit Report(Verified& out) : out_(out) {}
  void add(const char* id, const Expected<void>& result, const std::string& well);
  void skip(const char* id, const std::string& why, bool essential = true);
  void check_signer(X509* certificate, const Verifier& verifier);
  /// Checks a time stamp over `stamped` and sets `Verified::at` to its time; without a time stamp,
  /// to `existed` if that is not 0. `said`: the signer's own time; `existed`: time at which the
  /// whole file is proved to have existed, or 0. Returns the chain of the stamp; empty without a
  /// valid stamp.
  std::vector<CertificatePtr> check_stamp(const char* id, std::string_view token,
                                          std::string_view stamped, const std::string& said,
                                          const Trusted& known, const Verifier& verifier,
                                          Time existed);
  /// Checks use, chain and revocation at `Verified::at`. Returns the chain; empty if it does not
  /// lead to a trusted root.
  std::vector<CertificatePtr> check_chain(X509* certificate,
                                          const std::vector<CertificatePtr>& others,
                                          const Trusted& known, const Verifier& verifier);

 private:
  Verified& out_;
};

}  // namespace nonio::sign
