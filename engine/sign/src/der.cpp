// SPDX-License-Identifier: Apache-2.0
#include "der.h"

namespace nonio::sign {

using namespace std::string_view_literals;

std::optional<Der> Der::take(std::string_view& rest) {
  if (rest.size() < 2) return std::nullopt;
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(rest[i]); };
  if ((byte(0) & 0x1F) == 0x1F) return std::nullopt;
  std::size_t head = 2, length = byte(1);
  if (length >= 0x80) {
    const std::size_t bytes = length & 0x7F;
    if (bytes == 0 || bytes > 4 || rest.size() < 2 + bytes || byte(2) == 0) return std::nullopt;
    length = 0;
    for (std::size_t i = 0; i < bytes; ++i) length = length << 8 | byte(2 + i);
    if (length < 0x80) return std::nullopt;
    head += bytes;
  }
  if (length > rest.size() - head) return std::nullopt;
  const Der out{byte(0), rest.substr(0, head + length), rest.substr(head, length)};
  rest.remove_prefix(head + length);
  return out;
}

std::optional<Der> Der::take(std::string_view& rest, std::uint8_t tag) {
  if (rest.empty() || static_cast<std::uint8_t>(rest.front()) != tag) return std::nullopt;
  return take(rest);
}

std::optional<Der> Der::only(std::string_view text, std::uint8_t tag) {
  const auto out = take(text, tag);
  return text.empty() ? out : std::nullopt;
}

bool Der::sound(std::string_view text, int depth) {
  if (depth > 40) return false;
  while (!text.empty()) {
    const auto one = take(text);
    if (!one) return false;
    const bool constructed = (one->tag & 0x20) != 0, universal = (one->tag & 0xC0) == 0;
    const int number = one->tag & 0x1F;
    if (universal && constructed != (number == 16 || number == 17)) return false;
    if (constructed && !sound(one->content, depth + 1)) return false;
  }
  return true;
}

namespace {

constexpr std::string_view null_parameters = "\x05\x00"sv;
/// DER without the last byte of the OIDs 2.16.840.1.101.3.4.2.1 to .3: SHA-256, SHA-384, SHA-512.
constexpr std::string_view sha2 = "\x06\x09\x60\x86\x48\x01\x65\x03\x04\x02"sv;
/// DER without the last byte of OIDs below 1.2.840.113549.1.1 (PKCS #1): .1 is rsaEncryption; .11
/// to .13 are RSA with SHA-256 to SHA-512.
constexpr std::string_view pkcs1 = "\x06\x09\x2a\x86\x48\x86\xf7\x0d\x01\x01"sv;
/// DER without the last byte of the OIDs 1.2.840.10045.4.3.2 to .4: ECDSA with SHA-256 to SHA-512.
constexpr std::string_view ecdsa = "\x06\x08\x2a\x86\x48\xce\x3d\x04\x03"sv;

char rank(const EVP_MD* digest) {
  const int size = EVP_MD_get_size(digest);
  return static_cast<char>(size == 32 ? 0 : size == 48 ? 1 : 2);
}

}  // namespace

const EVP_MD* digest_of_algorithm(std::string_view content) {
  if (content.ends_with(null_parameters)) content.remove_suffix(null_parameters.size());
  if (content.size() != sha2.size() + 1 || !content.starts_with(sha2)) return nullptr;
  switch (content.back()) {
    case 1:
      return EVP_sha256();
    case 2:
      return EVP_sha384();
    case 3:
      return EVP_sha512();
    default:
      return nullptr;
  }
}

bool is_signature_algorithm(std::string_view content, const EVP_MD* digest) {
  if (content.size() == ecdsa.size() + 1 && content.starts_with(ecdsa))
    return content.back() == 2 + rank(digest);
  if (!content.ends_with(null_parameters)) return false;
  content.remove_suffix(null_parameters.size());
  if (content.size() != pkcs1.size() + 1 || !content.starts_with(pkcs1)) return false;
  return content.back() == 1 || content.back() == 11 + rank(digest);
}

}  // namespace nonio::sign
