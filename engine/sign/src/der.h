// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/evp.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace nonio::sign {

/// One element of DER. The tag has one byte; the length is definite and in the fewest bytes.
struct Der {
  std::uint8_t tag = 0;
  std::string_view whole, content;

  static constexpr std::uint8_t integer = 0x02, octets = 0x04, object = 0x06, sequence = 0x30,
                                set = 0x31;
  static constexpr std::uint8_t context(unsigned n) { return static_cast<std::uint8_t>(0xA0 + n); }

  /// Removes the first element from `rest`. Returns nullopt for a malformed element, and then
  /// leaves `rest` unchanged.
  static std::optional<Der> take(std::string_view& rest);
  static std::optional<Der> take(std::string_view& rest, std::uint8_t tag);
  /// Whether the whole text consists of DER elements, at all levels (at most 41). The check is
  /// stricter than OpenSSL, which normalizes other encodings before it checks a signature.
  static bool sound(std::string_view text, int depth = 0);
  /// Returns nullopt unless the whole text is one element of this tag.
  static std::optional<Der> only(std::string_view text, std::uint8_t tag);
};

/// Returns null unless the content of the AlgorithmIdentifier denotes SHA-256, SHA-384 or SHA-512.
const EVP_MD* digest_of_algorithm(std::string_view content);
/// Whether the content of an AlgorithmIdentifier denotes ECDSA with this digest, or RSA (PKCS #1
/// v1.5) with this digest or without a stated digest.
bool is_signature_algorithm(std::string_view content, const EVP_MD* digest);

}  // namespace nonio::sign
