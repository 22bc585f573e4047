// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/pdf/update.h"
#include "time_stamp.h"

namespace nonio::sign {

/// Data appended to a file after it was signed, in their order.
struct Added {
  struct DocumentStamp {
    std::string token, imprint;
  };
  std::vector<DocumentStamp> stamps;
  std::vector<Statement> statements;
  /// For each statement, the index of the first stamp that covers it; `stamps.size()` if no stamp
  /// does.
  std::vector<std::size_t> covered;
  std::vector<std::string> certificates;  ///< in DER
};

/// Reads the updates of a file. Returns an error if data of any other kind were appended. `ends` is
/// the result of `pdf::ends_of_parts`. `updater` must be that of the signed file; afterwards it can
/// write another update.
Expected<Added> read_updates(std::string_view bytes, const std::vector<std::size_t>& ends,
                             pdf::Updater& updater);

/// Checks the stamps, the newest first, and returns them with the oldest first. The time of each
/// stamp proves that the older ones existed then. Adds the statements to `known`, each with the
/// time at which it is proved to have existed.
Expected<std::vector<Stamp>> check_document_stamps(Added& added, Trusted& known, Time now);

/// Checks that every statement and every certificate is needed for one of the chains, and that none
/// occurs twice.
Expected<void> check_needed(const Added& added, const Trusted& known,
                            const std::vector<std::vector<CertificatePtr>>& chains);

/// Returns the DER at the beginning of a signature's hexadecimal digits; an error if anything but
/// zeros follows.
Expected<std::string> der_in(std::string_view digits);

}  // namespace nonio::sign
