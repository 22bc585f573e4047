// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/signature_field.h"
#include "nonio/sdk/error.h"

/// Signs calibration certificates: makes a signed PDF from a finished PDF and its attachments.
///
///   pdf::reserve(pdf, attachments, time)  adds the attachments and an empty signature to the PDF,
///                                         in its single revision; needs no key
///   Key::sign(bytes, now, stamping)       fills in the signature; is called in the process that
///                                         has opened the key
///
/// The PDF must have one revision with a plain cross-reference table (as made by reports::pdf), no
/// form and no attachments of its own. An XML document is signed in its canonical form; its
/// signature becomes the last child of the root element.
namespace nonio::sign {

/// Seconds since 1970-01-01 UTC. Signatures and their checks get the time as an argument; only a
/// time-stamp server reads a clock.
using pdf::Time;
std::string text_of(Time time);  ///< returns, for example, "2026-11-21 15:00:07 UTC"

/// Location of a key: either a PKCS#12 file or a token.
struct KeyPlace {
  std::string pkcs12{};  ///< path of the PKCS#12 file
  std::string pkcs11{};  ///< URI of the key and its certificate in the token:
                         ///< pkcs11:token=...;object=...
  std::string module{};  ///< path of the token's PKCS#11 library
  std::string
      certificates{};  ///< PEM file with the certificates from the signer's up to the root; or
                       ///< empty
};

struct Identity {
  std::string subject;    ///< subject of the certificate (RFC 2253), for example "CN=Ada,O=Lab"
  std::string sha256;     ///< SHA-256 of the certificate in lower-case hexadecimal digits
  std::string algorithm;  ///< algorithm of the key, for example "RSA-3072", "P-256"
  Time not_before = 0, not_after = 0;
};

/// An RFC 3161 time-stamp server; none if the address is empty.
struct TimeStamping {
  std::string url{};     ///< address of the server: http://host[:port]/path
  bool required = true;  ///< whether signing fails if the server gives no valid time stamp; if
                         ///< false, the document is then signed without one
  int seconds = 10;      ///< time limit for an answer, s
  std::string trust{};   ///< PEM of the trusted roots of the server's certificate
  /// Why the server did not answer, after which it is not contacted again; empty if it answered.
  /// Null: failures are not remembered.
  std::shared_ptr<std::string> away{};
};

struct Signed {
  std::string bytes;
  /// Why there is no time stamp although a server is configured; empty if there is one, or none is
  /// configured.
  std::string no_time_stamp{};
};

/// A private key and its certificate. The key never leaves the process that opened it.
class Key {
 public:
  /// Opens the key. An error states what is wrong with key, certificate or password, never the
  /// password itself. The certificate must be valid at `now`.
  static Expected<Key> open(const KeyPlace& place, const std::string& password, Time now);
  Key(Key&&) noexcept;
  Key& operator=(Key&&) noexcept;
  ~Key();

  const Identity& identity() const;
  /// Signs a PDF from `pdf::reserve` (PAdES B-B, or B-T with a time stamp) or an XML document. The
  /// XML document is converted to its canonical form and gets an enveloped signature (XAdES B-B or
  /// B-T); `now` is the time that this signature states. Other bytes are an error.
  Expected<Signed> sign(std::string bytes, Time now, const TimeStamping& stamping = {}) const;

  struct Impl;

 private:
  explicit Key(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace nonio::sign
