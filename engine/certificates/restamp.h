// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "certificates/trust.h"
#include "certificates/verify.h"
#include "nonio/sign/prolong.h"

namespace nonio::certificates {

/// Arguments of `nonio certificate extend`; an empty one is that of the site.
struct RestampOptions {
  VerifyOptions whom;
  std::string time_stamp;  ///< address of the server
  bool with_time_stamp = true;
  std::vector<std::filesystem::path> answers;  ///< by OCSP, DER
  bool fetch = true;
};

/// An error where no time-stamp server is named although a time stamp is required.
config::Checked<sign::Prolonging> prolonging_of(const RestampOptions& options);

struct Restamped {
  std::filesystem::path written;
  std::vector<std::string> added;  ///< in words
};

/// Writes the file with its revocation data and a time stamp into `out`, or over itself where that
/// is empty: whole or not at all. Not into the output of a run, which the next run would write again
/// as it was issued. What the register has issued is accepted with the signer of that time.
Expected<Restamped> restamp(const std::filesystem::path& file, const sign::Prolonging& how,
                            const RegisterRows& rows, const std::filesystem::path& out);

}  // namespace nonio::certificates
