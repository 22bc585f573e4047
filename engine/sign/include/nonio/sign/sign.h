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

/// The steps between the content of a certificate and its signature: a finished PDF and its
/// attachments go in, a signed PDF comes out.
///
///   pdf::reserve(pdf, attachments, time)  puts the attachments and an empty signature into the
///   PDF,
///                                         in its one revision. Needs no key: any process may.
///   Key::sign(bytes, stamp)               fills the signature. Only the process that holds the
///   key.
///
/// Whoever writes the content need not know of the signature: a PDF of one revision with a plain
/// cross-reference table (as reports::pdf makes it), without a form and attachments of its own. An
/// XML document is signed as it is; its signature becomes the last child of the root.
namespace nonio::sign {

/// Seconds since 1970-01-01 UTC. Signatures and their checks take it as a value; nothing here but a
/// time-stamp server looks at a clock.
using pdf::Time;
std::string text_of(Time time);  ///< "2026-11-21 15:00:07 UTC"

/// Where a key is. Either a PKCS#12 file, or a token.
struct KeyPlace {
  std::string pkcs12{};  ///< path of the file
  std::string pkcs11{};  ///< pkcs11:token=...;object=... of key and certificate
  std::string module{};  ///< path of the token's PKCS#11 library
  std::string
      certificates{};  ///< PEM file with what leads from the certificate to the root; or empty
};

struct Identity {
  std::string subject;    ///< RFC 2253, "CN=Ada,O=Lab"
  std::string sha256;     ///< of the certificate, lower-case hexadecimal
  std::string algorithm;  ///< "RSA-3072", "P-256"
  Time not_before = 0, not_after = 0;
};

/// An RFC 3161 time-stamp server; none if the address is empty.
struct TimeStamping {
  std::string url{};     ///< http://host[:port]/path
  bool required = true;  ///< no answer: no signature; else one without time stamp
  int seconds = 10;      ///< to wait for an answer
  std::string trust{};   ///< PEM of the roots that its certificate must lead to
  /// Records that the server did not answer, so that it is not contacted again. May be null.
  std::shared_ptr<std::string> away{};
};

struct Signed {
  std::string bytes;
  /// Why there is no time stamp although one was wanted; empty if all is as configured.
  std::string no_time_stamp{};
};

/// A private key and its certificate, opened once. It never leaves the process that opened it.
class Key {
 public:
  /// An error states what is wrong with key, certificate or password, never the password. `now`:
  /// the certificate must be valid.
  static Expected<Key> open(const KeyPlace& place, const std::string& password, Time now);
  Key(Key&&) noexcept;
  Key& operator=(Key&&) noexcept;
  ~Key();

  const Identity& identity() const;
  /// A PDF from `pdf::reserve`: PAdES B-B, or B-T with a time stamp. An XML document: put into its
  /// canonical form, with an enveloped signature, XAdES B-B or B-T; `now` is what that signature
  /// states about its time. Anything else is an error.
  Expected<Signed> sign(std::string bytes, Time now, const TimeStamping& stamping = {}) const;

  struct Impl;

 private:
  explicit Key(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace nonio::sign
