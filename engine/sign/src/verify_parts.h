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

/// The lines of a verification as they are found.
class Report {
 public:
  explicit Report(Verified& out) : out_(out) {}
  void add(const char* id, const Expected<void>& result, const std::string& well);
  void skip(const char* id, const std::string& why, bool essential = true);
  void check_signer(X509* certificate, const Verifier& verifier);
  /// Sets `Verified::at` to what a time stamp over `stamped` proves; `said` is the signer's time.
  /// `existed`: when all of it is proved to have existed; 0 if nothing proves it. The chain of the
  /// stamp.
  std::vector<CertificatePtr> check_stamp(const char* id, std::string_view token,
                                          std::string_view stamped, const std::string& said,
                                          const Trusted& known, const Verifier& verifier,
                                          Time existed);
  /// At `Verified::at`.
  std::vector<CertificatePtr> check_chain(X509* certificate,
                                          const std::vector<CertificatePtr>& others,
                                          const Trusted& known, const Verifier& verifier);

 private:
  Verified& out_;
};

}  // namespace nonio::sign
