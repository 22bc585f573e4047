// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/evp.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace nonio::sign {

/// One element of DER: tag, length, content. Only what DER allows: one-byte tags, definite lengths
/// in the fewest bytes.
struct Der {
  std::uint8_t tag = 0;
  std::string_view whole, content;

  static constexpr std::uint8_t integer = 0x02, octets = 0x04, object = 0x06, sequence = 0x30,
                                set = 0x31;
  static constexpr std::uint8_t context(unsigned n) { return static_cast<std::uint8_t>(0xA0 + n); }

  /// Takes the first element off `rest`.
  static std::optional<Der> take(std::string_view& rest);
  /// The same, of this tag.
  static std::optional<Der> take(std::string_view& rest, std::uint8_t tag);
  /// Whether the whole text is elements of DER, down to the innermost: sequences and sets, and
  /// nothing else that has a tag of its own, are made of others. OpenSSL reads more than that, and
  /// puts it right before it looks at the signature.
  static bool sound(std::string_view text, int depth = 0);
  /// The whole text as one element of this tag.
  static std::optional<Der> only(std::string_view text, std::uint8_t tag);
};

/// SHA-256, SHA-384 or SHA-512 of an AlgorithmIdentifier's content; null if it is another one.
const EVP_MD* digest_of_algorithm(std::string_view content);
/// Whether an AlgorithmIdentifier's content names a signature that is accepted with that digest.
bool is_signature_algorithm(std::string_view content, const EVP_MD* digest);

}  // namespace nonio::sign
