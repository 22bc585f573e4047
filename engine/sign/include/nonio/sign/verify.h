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

/// Largest size of a signed file in bytes; larger files are neither verified nor signed.
inline constexpr std::size_t max_bytes = pdf::max_file;

struct Check {
  enum class State { holds, fails, not_checked };
  std::string id;  ///< id of the check, for example "signature.digest"
  State state = State::not_checked;
  std::string says;
  /// Whether the file is rejected if this check was not made.
  bool essential = true;
};

/// A signer, and the period in which it is accepted.
struct ExpectedSigner {
  std::string who;               ///< subject of the certificate, or its SHA-256 (hexadecimal)
  Time from = 0;                 ///< first accepted time; 0 if not limited
  std::optional<Time> before{};  ///< end of the period, excluded; nullopt if not limited
};

struct Verifier {
  /// PEM of the trusted roots. Those of time servers are separate, because a time server must not
  /// be able to certify signers.
  std::string signer_roots{}, time_stamp_roots{};
  std::optional<std::string> revocation{};  ///< revocation lists in PEM
  std::vector<ExpectedSigner> signers{};
  /// Text for the report if a register contains this very file as issued. If it is not empty, the
  /// signer is not compared with `signers`.
  std::string issued_by{};
  Time now = 0;
  /// For an attachment of a signed PDF, `Verified::existed` of the PDF; otherwise 0.
  Time existed = 0;
};

struct Verified {
  std::vector<Check> checks;
  std::string certificate;  ///< signer's certificate, DER; empty if there is none
  std::string subject;
  /// Time of the signature as proved by a time stamp; without a time stamp, `Verifier::now`.
  Time at = 0;
  /// Time of the oldest time stamp over the complete file; 0 without such a time stamp.
  Time existed = 0;
  /// Size of the signed part of a PDF in bytes; updates for long-term validation follow.
  std::size_t issued = 0;
  std::vector<pdf::Attachment> attachments;

  bool holds() const;  ///< true if no check failed and every essential check was made
};

/// Returns an error if nonempty roots contain no certificate, or if `revocation` is given but
/// contains no list (for example, 0 bytes after a failed download).
Expected<void> check_verifier(const Verifier& verifier);

/// Returns an error if the PEM text contains no certificate, or a certificate that cannot be read.
Expected<std::size_t> number_of_roots(const std::string& pem);

/// Verifies a PDF. The content is parsed only if the signature is valid and from an expected
/// signer, so that a foreign file costs no more than its digest.
Verified verify_pdf(std::string_view bytes, const Verifier& verifier);
/// For a PDF that is known to be authentic, such as one from the register; nothing is checked.
Expected<std::vector<pdf::Attachment>> unverified_attachments(std::string_view pdf);
/// Returns a PDF without the updates after its signed part; other files are returned unchanged.
std::string_view issued_part(std::string_view file);
Expected<Identity> unverified_signer(std::string_view signed_pdf);
/// Verifies an XML document as written by `Key::sign`. `certificate`: DER of the only accepted
/// signer, whose chain is not checked again. If it is empty, the signer is checked as for a PDF.
Verified verify_xml(std::string_view bytes, const Verifier& verifier,
                    std::string_view certificate = {});
/// Checks that a signed document without its signature has the canonical form of `written`.
Expected<void> same_document(std::string_view signed_document, std::string_view written);

}  // namespace nonio::sign
