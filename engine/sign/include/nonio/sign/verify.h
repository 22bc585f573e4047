// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/sign.h"

/// Whether a signed file is what its signer signed. No network, no clock, no system-wide list of
/// trusted roots: whom to trust is given.
namespace nonio::sign {

struct Check {
  enum class State { holds, fails, not_checked };
  std::string id;  ///< "signature.digest"
  State state = State::not_checked;
  std::string says;
  /// Without it the file proves nothing, so that "not checked" is as bad as "fails".
  bool essential = true;
};

struct Verifier {
  std::string trust{};       ///< PEM: the roots that certificates must lead to
  std::string revocation{};  ///< PEM: revocation lists; may be empty
  /// Who should have signed: the subject of the certificate, or its SHA-256.
  std::string signer{};
  Time now = 0;
};

struct Verified {
  std::vector<Check> checks;
  std::string certificate;  ///< of the signer, DER; empty if there is none
  std::string subject;
  /// When it was signed, as a time stamp proves; else `Verifier::now`.
  Time at = 0;
  std::vector<Attachment> attachments;  ///< of a PDF, if it could be read

  bool holds() const;  ///< every check, and no essential one was left out
};

/// `max_bytes` of attachments are unpacked at the most.
Verified verify_pdf(std::string_view bytes, const Verifier& verifier);
/// What is drawn on each page, uncompressed, as the writer of the PDF put it down.
Expected<std::vector<std::string>> page_contents(std::string_view pdf);
/// An XML document with one enveloped signature over all of it. `certificate` (DER): only that
/// signer will do, and its chain is not looked at again.
Verified verify_xml(std::string_view bytes, const Verifier& verifier,
                    std::string_view certificate = {});

}  // namespace nonio::sign
