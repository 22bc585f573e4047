// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/pdf/update.h"
#include "time_stamp.h"

namespace nonio::sign {

/// Data appended to a file after it was signed, in the order of the file.
struct Added {
  struct DocumentStamp {
    std::string token, imprint;
  };
  std::vector<DocumentStamp> stamps;
  std::vector<Statement> statements;
  /// Index of the first stamp that covers each statement, or `stamps.size()`.
  std::vector<std::size_t> covered;
  std::vector<std::string> certificates;  ///< in DER
};

/// Reads the time stamps, certificates and revocation data that updates add; any other addition is
/// an error. `ends`: result of `pdf::ends_of_parts`. `updater`: updater of the signed file, which
/// can then write another update.
Expected<Added> read_updates(std::string_view bytes, const std::vector<std::size_t>& ends,
                             pdf::Updater& updater);

/// Checks the stamps, the newest first, because each proves that the older ones existed at its
/// time. Returns them with the oldest first. Adds the statements to `known`, each with the time at
/// which it is proved to have existed.
Expected<std::vector<Stamp>> check_document_stamps(Added& added, Trusted& known, Time now);

/// Returns an error if a statement or certificate occurs twice or is needed for none of the chains.
Expected<void> check_needed(const Added& added, const Trusted& known,
                            const std::vector<std::vector<CertificatePtr>>& chains);

/// Returns the DER at the beginning of hexadecimal digits; an error unless only zeros follow.
Expected<std::string> der_in(std::string_view digits);

}  // namespace nonio::sign
