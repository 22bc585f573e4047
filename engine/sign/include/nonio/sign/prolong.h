// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/verify.h"

/// Extends the validity of a signed PDF beyond the expiry of keys and time servers: adds revocation
/// data (PAdES B-LT) and a time stamp over the complete file (B-LTA). No key is needed.
namespace nonio::sign {

struct Prolonging {
  Verifier verifier{};  ///< trusted roots, expected signers, available revocation lists
  std::vector<std::string> answers{};  ///< available OCSP answers, DER
  TimeStamping stamping{};             ///< time-stamp server; no stamp if its address is empty
  bool fetch = true;  ///< whether to request missing data from the addresses in the certificates
  int seconds = 10;   ///< time limit for an answer, s
};

struct Prolonged {
  std::string bytes;
  std::vector<std::string> added;  ///< one text per added certificate, list, answer or stamp
};

/// Returns the file with one more update. `verify_pdf` must accept the file before and after the
/// update. Other errors: the revocation status of a certificate is unknown, nothing can be added,
/// the time stamp is missing, or the file would become too large.
Expected<Prolonged> prolong(std::string_view signed_pdf, const Prolonging& how);

}  // namespace nonio::sign
