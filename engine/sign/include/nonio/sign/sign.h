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

/// Signs calibration certificates. `pdf::reserve` adds the attachments and an empty signature to a
/// PDF, for which no key is needed; `Key::sign` fills in the signature in the process that has
/// opened the key. The PDF must have one revision with a plain cross-reference table, no form and
/// no attachments of its own. In an XML document, the signature becomes the last child of the root
/// element.
namespace nonio::sign {

/// Seconds since 1970-01-01 UTC. The functions get the time as an argument and read no clock.
using pdf::Time;
std::string text_of(Time time);  ///< returns, for example, "2026-11-21 15:00:07 UTC"

/// Location of a key: a PKCS#12 file, or a PKCS#11 token.
struct KeyPlace {
  std::string pkcs12{};        ///< path of the PKCS#12 file; empty if the key is in a token
  std::string pkcs11{};        ///< URI of key and certificate: pkcs11:token=...;object=...
  std::string module{};        ///< path of the token's PKCS#11 library
  std::string certificates{};  ///< PEM file with the intermediate certificates; may be empty
};

struct Identity {
  std::string subject;    ///< subject of the certificate (RFC 2253), for example "CN=Ada,O=Lab"
  std::string sha256;     ///< SHA-256 of the certificate in lower-case hexadecimal digits
  std::string algorithm;  ///< algorithm of the key, for example "RSA-3072", "P-256"
  Time not_before = 0, not_after = 0;
};

/// An RFC 3161 time-stamp server. Without an address, no time stamp is requested.
struct TimeStamping {
  std::string url{};     ///< address of the form http://host[:port]/path
  bool required = true;  ///< whether signing fails without a valid time stamp
  int seconds = 10;      ///< time limit for an answer, s
  std::string trust{};   ///< PEM of the trusted roots of the server's certificate
  /// Reason why the server did not answer; while it is not empty, the server is not contacted
  /// again. Failures are not stored if the pointer is null.
  std::shared_ptr<std::string> away{};
};

struct Signed {
  std::string bytes;
  /// Reason why a configured server gave no time stamp; otherwise empty.
  std::string no_time_stamp{};
};

/// A private key and its certificate. The key never leaves the process that opened it.
class Key {
 public:
  /// Opens the key. The certificate must be valid at `now`. Errors never contain the password.
  static Expected<Key> open(const KeyPlace& place, const std::string& password, Time now);
  Key(Key&&) noexcept;
  ~Key();

  const Identity& identity() const;
  /// Signs a PDF from `pdf::reserve` (PAdES B-B, or B-T with a time stamp) or an XML document
  /// (enveloped XAdES B-B or B-T, in canonical form). `now` is the signing time that an XML
  /// signature states. Other bytes are an error.
  Expected<Signed> sign(std::string bytes, Time now, const TimeStamping& stamping = {}) const;

  struct Impl;

 private:
  explicit Key(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace nonio::sign
