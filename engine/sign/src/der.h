// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/evp.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace nonio::sign {

/// One element of DER: tag, length, content. The tag has one byte, and the length is definite and
/// in the fewest bytes; all other elements are malformed.
struct Der {
  std::uint8_t tag = 0;
  std::string_view whole, content;

  static constexpr std::uint8_t integer = 0x02, octets = 0x04, object = 0x06, sequence = 0x30,
                                set = 0x31;
  static constexpr std::uint8_t context(unsigned n) { return static_cast<std::uint8_t>(0xA0 + n); }

  /// Removes the first element from `rest` and returns it. For a malformed element, returns none
  /// and leaves `rest` unchanged.
  static std::optional<Der> take(std::string_view& rest);
  /// Does the same as `take(rest)` if the element has this tag; otherwise returns none.
  static std::optional<Der> take(std::string_view& rest, std::uint8_t tag);
  /// Whether the whole text consists of DER elements, down to the innermost ones, with at most 41
  /// levels. Sequences, sets and constructed elements of other classes must consist of elements,
  /// and every other universal type must be primitive. This is stricter than OpenSSL, which accepts
  /// other encodings and normalizes them before it checks a signature.
  static bool sound(std::string_view text, int depth = 0);
  /// Returns the whole text as one element of this tag; none if it is anything else.
  static std::optional<Der> only(std::string_view text, std::uint8_t tag);
};

/// Returns SHA-256, SHA-384 or SHA-512 for the content of an AlgorithmIdentifier; null for other
/// algorithms.
const EVP_MD* digest_of_algorithm(std::string_view content);
/// Whether the content of an AlgorithmIdentifier denotes ECDSA with this digest, or RSA (PKCS #1
/// v1.5) with this digest or without a stated digest.
bool is_signature_algorithm(std::string_view content, const EVP_MD* digest);

}  // namespace nonio::sign
