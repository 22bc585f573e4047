// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/digest.h"

#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <new>

#include "platform/storage/files.h"

namespace nonio::storage {

/// Uses OpenSSL directly, because Poco's engine ignores a failed allocation and then reads invalid
/// memory.
struct RunningDigest::State {
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context{::EVP_MD_CTX_new(),
                                                             &::EVP_MD_CTX_free};
};

namespace {

/// Fetched once, because EVP_sha256() of OpenSSL 3 fetches the algorithm for every digest, which
/// takes as long as hashing a kilobyte.
const EVP_MD* method() {
  static const EVP_MD* const found = ::EVP_MD_fetch(nullptr, "SHA256", nullptr);
  return found != nullptr ? found : ::EVP_sha256();
}

}  // namespace

RunningDigest::RunningDigest() : state_(std::make_unique<State>()) {
  if (!state_->context || ::EVP_DigestInit_ex(state_->context.get(), method(), nullptr) != 1)
    throw std::bad_alloc();
}

RunningDigest::~RunningDigest() = default;

void RunningDigest::add(std::string_view bytes) {
  if (::EVP_DigestUpdate(state_->context.get(), bytes.data(), bytes.size()) != 1)
    throw std::bad_alloc();
}

namespace {
using Digest = std::array<unsigned char, 32>;

std::string hex_of(const Digest& digest) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : digest) text += {digits[byte >> 4U], digits[byte & 15U]};
  return text;
}
}  // namespace

std::string RunningDigest::hex() {
  Digest digest{};
  if (::EVP_DigestFinal_ex(state_->context.get(), digest.data(), nullptr) != 1)
    throw std::bad_alloc();
  return hex_of(digest);
}

std::string hmac_sha256(std::string_view key, std::string_view bytes) {
  Digest digest{};
  const auto* const text = reinterpret_cast<const unsigned char*>(bytes.data());
  if (::HMAC(method(), key.data(), static_cast<int>(key.size()), text, bytes.size(), digest.data(),
             nullptr) == nullptr)
    throw std::bad_alloc();
  return hex_of(digest);
}

std::string sha256(std::string_view bytes) {
  RunningDigest digest;
  digest.add(bytes);
  return digest.hex();
}

Expected<std::string> sha256_of_file(const std::filesystem::path& path,
                                     const std::function<void()>& after_each_part) {
  RunningDigest digest;
  const auto read = read_parts(path, [&](std::string_view part) {
    digest.add(part);
    if (after_each_part) after_each_part();
  });
  if (!read) return fail(read.error());
  return digest.hex();
}

std::uint64_t short_digest(std::string_view sha256) {
  constexpr std::size_t digits = 16;
  std::uint64_t value = 0;
  std::from_chars(sha256.data(), sha256.data() + std::min(sha256.size(), digits), value, 16);
  return value;
}

}  // namespace nonio::storage
