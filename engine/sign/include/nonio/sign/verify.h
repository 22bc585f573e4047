// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/sign.h"

/// Verifies signed files, without network, clock or a system-wide list of trusted roots: trust is
/// given as an argument.
namespace nonio::sign {

/// Largest size of a signed file in bytes; larger files are rejected unread, and are not signed.
inline constexpr std::size_t max_bytes = pdf::max_file;

struct Check {
  enum class State { holds, fails, not_checked };
  std::string id;  ///< id of the check, for example "signature.digest"
  State state = State::not_checked;
  std::string says;
  /// Whether the file proves nothing without this check, so that "not checked" is as bad as
  /// "fails".
  bool essential = true;
};

/// A signer, and the period in which it is accepted.
struct ExpectedSigner {
  std::string who;               ///< subject of the certificate, or its SHA-256
  Time from = 0;                 ///< beginning of the period; 0: that of the certificate's validity
  std::optional<Time> before{};  ///< end of the period; none: that of the certificate's validity
};

struct Verifier {
  /// PEM: trusted roots of signers, and trusted roots of time servers. They are separate, because a
  /// time server must not be able to certify signers.
  std::string signer_roots{}, time_stamp_roots{};
  std::optional<std::string> revocation{};  ///< revocation lists in PEM
  std::vector<ExpectedSigner> signers{};
  /// Text that states that a register contains this very file as issued. If it is not empty, the
  /// signer need not be among `signers`.
  std::string issued_by{};
  Time now = 0;
  /// For a file inside another one with time stamps: `Verified::existed` of the outer file;
  /// otherwise 0.
  Time existed = 0;
};

struct Verified {
  std::vector<Check> checks;
  std::string certificate;  ///< signer's certificate, DER; empty if there is none
  std::string subject;
  /// Time of the signature as proved by a time stamp; without one, `Verifier::now`.
  Time at = 0;
  /// Time of the oldest time stamp over the complete file, when the signed part existed; 0 without
  /// such a time stamp.
  Time existed = 0;
  /// Size of the signed part of a PDF in bytes; updates for long-term validation follow.
  std::size_t issued = 0;
  std::vector<pdf::Attachment> attachments;  ///< attachments of a PDF, if it could be read

  bool holds() const;  ///< returns whether no check failed and every essential one was made
};

/// Returns an error if roots that are given contain no certificate, or if a given revocation file
/// contains no list. A revocation file of 0 bytes, such as a failed download, is an error too.
Expected<void> check_verifier(const Verifier& verifier);

/// Returns the number of certificates in a PEM file of roots.
Expected<std::size_t> number_of_roots(const std::string& pem);

/// Verifies a PDF. The signature is checked first, found by its position at the end of the file.
/// The rest is read only if the signature is valid and from an expected signer, so that a foreign
/// file costs no more than its digest.
Verified verify_pdf(std::string_view bytes, const Verifier& verifier);
/// Returns the attachments of a PDF that is known to be authentic, such as one from the register;
/// nothing is checked.
Expected<std::vector<pdf::Attachment>> unverified_attachments(std::string_view pdf);
/// Returns a PDF without the updates after its signed part; other files are returned unchanged.
std::string_view issued_part(std::string_view file);
Expected<Identity> unverified_signer(std::string_view signed_pdf);
/// Verifies an XML document as written by `Key::sign`: in its canonical form, with one enveloped
/// signature over all of it. `certificate`: DER of the only accepted signer, whose chain is not
/// checked again; empty: the signer is checked as for a PDF.
Verified verify_xml(std::string_view bytes, const Verifier& verifier,
                    std::string_view certificate = {});
/// Checks that a signed document without its signature has the canonical form of `written`.
Expected<void> same_document(std::string_view signed_document, std::string_view written);

}  // namespace nonio::sign
