// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sign/sign.h"
#include "signed_data.h"

namespace nonio::sign {

/// Requests a time-stamp token (RFC 3161) for the SHA-256 `imprint`, and checks it. The server is
/// not contacted if `stamping.away` contains a reason.
Expected<std::string> ask_for_time_stamp(const TimeStamping& stamping, std::string_view imprint,
                                         Time now);

struct Stamp {
  Time time = 0;
  std::string by;
  std::string nonce;  ///< empty if the token has no nonce
  std::vector<CertificatePtr> chain{};
};
/// Checks that a time stamp covers the SHA-256 `imprint`, comes from a trusted authority whose
/// certificate was not revoked, and is not later than `now` plus 60 s. `until`: time at which the
/// stamp is proved to have existed; a later revocation has no effect.
Expected<Stamp> check_time_stamp(std::string_view token, std::string_view imprint,
                                 const Trusted& trusted, Time now,
                                 Time until = std::numeric_limits<Time>::max());

}  // namespace nonio::sign
