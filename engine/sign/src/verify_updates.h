// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/pdf/update.h"
#include "time_stamp.h"

namespace nonio::sign {

/// What a file got after it was signed, in its order.
struct Added {
  struct DocumentStamp {
    std::string token, imprint;
  };
  std::vector<DocumentStamp> stamps;
  std::vector<Statement> statements;
  /// Of each statement the stamp that covers it first; `stamps.size()`: none does.
  std::vector<std::size_t> covered;
  std::vector<std::string> certificates;  ///< DER
};

/// An error if there is anything else. `ends` of `pdf::ends_of_parts`; `updater` of the signed
/// file, ready to write one more afterwards.
Expected<Added> read_updates(std::string_view bytes, const std::vector<std::size_t>& ends,
                             pdf::Updater& updater);

/// The newest stamp as it is now, each older one as the next one saw it. `known` gets the
/// statements, each with the time at which it is proved to have existed.
Expected<std::vector<Stamp>> check_document_stamps(Added& added, Trusted& known, Time now);

/// Every statement and every certificate is needed for one of the chains, and none occurs twice.
Expected<void> check_needed(const Added& added, const Trusted& known,
                            const std::vector<std::vector<CertificatePtr>>& chains);

/// The DER at the beginning of a signature's hexadecimal digits; an error if anything but zeros
/// follows.
Expected<std::string> der_in(std::string_view digits);

}  // namespace nonio::sign
