// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/sign.h"

/// Whether a signed file is what its signer signed. No network, no clock, no system-wide list of
/// trusted roots: whom to trust is given.
namespace nonio::sign {

/// What is larger is refused unread; it is not signed either.
inline constexpr std::size_t max_bytes = pdf::max_file;

struct Check {
  enum class State { holds, fails, not_checked };
  std::string id;  ///< "signature.digest"
  State state = State::not_checked;
  std::string says;
  /// Without it the file proves nothing, so that "not checked" is as bad as "fails".
  bool essential = true;
};

/// Who may have signed, and when.
struct ExpectedSigner {
  std::string who;               ///< the subject of the certificate, or its SHA-256
  Time from = 0;                 ///< 0: from the beginning of the certificate's validity
  std::optional<Time> before{};  ///< none: to its end
};

struct Verifier {
  /// PEM: the roots that the certificates of signers must lead to, and those of time servers. They
  /// are apart: who may state a time may not sign certificates.
  std::string signer_roots{}, time_stamp_roots{};
  std::optional<std::string> revocation{};  ///< PEM: revocation lists
  std::vector<ExpectedSigner> signers{};
  /// The register that contains this very file as issued; empty: none. Then its signer need
  /// not be among `signers`.
  std::string issued_by{};
  Time now = 0;
  /// Of what is inside a file with time stamps of its own: `Verified::existed` of that file.
  Time existed = 0;
};

struct Verified {
  std::vector<Check> checks;
  std::string certificate;  ///< of the signer, DER; empty if there is none
  std::string subject;
  /// When it was signed, as a time stamp proves; else `Verifier::now`.
  Time at = 0;
  /// When a time stamp over the whole file proves it to have existed; 0 without one.
  Time existed = 0;
  /// Bytes of a PDF as it was signed; they are followed by what was added for long-term validation.
  std::size_t issued = 0;
  std::vector<pdf::Attachment> attachments;  ///< of a PDF, if it could be read

  bool holds() const;  ///< every check, and no essential one was left out
};

/// An error if the roots or the revocation lists are none: a file of 0 bytes, such as a download
/// that failed, is not an empty list.
Expected<void> check_verifier(const Verifier& verifier);

/// The certificates in a PEM file of roots.
Expected<std::size_t> number_of_roots(const std::string& pem);

/// The signature comes first, found by its place at the end of the file. Only where it holds and is
/// of the expected signer is the rest read: what a stranger sends costs no more than its digest.
Verified verify_pdf(std::string_view bytes, const Verifier& verifier);
/// Of a PDF that is known to be our own, such as one from the register; nothing is checked.
Expected<std::vector<pdf::Attachment>> unverified_attachments(std::string_view pdf);
/// Of a PDF without the updates behind it; other files as they are.
std::string_view issued_part(std::string_view file);
Expected<Identity> unverified_signer(std::string_view signed_pdf);
/// An XML document as `Key::sign` writes one: in its canonical form, with one enveloped signature
/// over all of it. `certificate` (DER): only that signer will do, and its chain is not looked at
/// again.
Verified verify_xml(std::string_view bytes, const Verifier& verifier,
                    std::string_view certificate = {});
/// Whether a signed document, its signature taken out, has the canonical form of `written`.
Expected<void> same_document(std::string_view signed_document, std::string_view written);

}  // namespace nonio::sign
