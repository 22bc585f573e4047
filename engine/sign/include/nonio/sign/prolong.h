// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/verify.h"

/// Extends the validity of a signed PDF, so that it can be verified after keys and time servers
/// have expired: adds revocation data while authorities still confirm them (PAdES B-LT), and a time
/// stamp over the complete file (B-LTA). No key is needed.
namespace nonio::sign {

struct Prolonging {
  Verifier verifier{};  ///< trusted roots and expected signers; available revocation lists
  std::vector<std::string> answers{};  ///< available OCSP answers, DER
  TimeStamping stamping{};             ///< server for the time stamp; none is requested if the
                                       ///< address is empty
  bool fetch = true;  ///< whether to request missing data from the addresses in the certificates
  int seconds = 10;   ///< time limit for an answer, s
};

struct Prolonged {
  std::string bytes;
  std::vector<std::string> added;  ///< one text for each addition
};

/// Returns the file with one more update. The file must be accepted by `verify_pdf` before and
/// after the update. Other errors: the revocation status of a certificate, which the error names,
/// is unknown; there is nothing to add; the time stamp is missing; or the file would become too
/// large.
Expected<Prolonged> prolong(std::string_view signed_pdf, const Prolonging& how);

}  // namespace nonio::sign
