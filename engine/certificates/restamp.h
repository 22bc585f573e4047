// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "certificates/trust.h"
#include "certificates/verify.h"
#include "nonio/sign/prolong.h"

namespace nonio::certificates {

/// Arguments of `nonio certificate extend`; empty arguments are taken from the site.
struct RestampOptions {
  VerifyOptions whom;
  std::string time_stamp;  ///< address of the time-stamp server; if empty, the address of the site
  bool with_time_stamp = true;
  std::vector<std::filesystem::path> answers;  ///< files with OCSP answers, DER
  bool fetch = true;
};

/// Returns an error if a time stamp is required and no server is named.
config::Checked<sign::Prolonging> prolonging_of(const RestampOptions& options);

struct Restamped {
  std::filesystem::path written;
  std::vector<std::string> added;
};

/// Writes the file with revocation data and, if `how` contains a server, a time stamp into the
/// folder `out`, or over itself if `out` is empty; completely or not at all. Refuses a separate
/// DCC, and the output folder of a run, because the next run would restore the issued file. A file
/// that the register has issued is accepted even if its signer is no longer expected.
Expected<Restamped> restamp(const std::filesystem::path& file, const sign::Prolonging& how,
                            const RegisterRows& rows, const std::filesystem::path& out);

}  // namespace nonio::certificates
