// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/verify.h"

/// A signed PDF stays provable when keys and time servers have run out: what was revoked is put
/// into it while authorities still confirm it (PAdES B-LT), and a time stamp over all of it
/// (B-LTA). Needs no key.
namespace nonio::sign {

struct Prolonging {
  Verifier verifier{};  ///< whom to trust and expect; revocation lists that are at hand
  std::vector<std::string> answers{};  ///< by OCSP, DER, that are at hand
  TimeStamping stamping{};             ///< no time stamp if the address is empty
  bool fetch = true;  ///< request missing data from the addresses in the certificates
  int seconds = 10;   ///< to wait for an answer
};

struct Prolonged {
  std::string bytes;
  std::vector<std::string> added;  ///< in words, a line each
};

/// The file with one update more. Only of a file that `verify_pdf` accepts, and only what it
/// accepts again: an error names the certificate whose revocation status is unknown.
Expected<Prolonged> prolong(std::string_view signed_pdf, const Prolonging& how);

}  // namespace nonio::sign
