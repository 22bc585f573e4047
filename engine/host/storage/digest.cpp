// SPDX-License-Identifier: Apache-2.0
#include "host/storage/digest.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <new>
#include <string_view>

#include "host/storage/files.h"

namespace nonio::host::storage {

namespace {

/// Poco's engine goes on where OpenSSL has no memory, and then reads what is not there.
class Sha256 {
 public:
  Sha256() {
    if (!context_ || ::EVP_DigestInit_ex(context_.get(), ::EVP_sha256(), nullptr) != 1)
      throw std::bad_alloc();
  }
  void add(std::string_view bytes) {
    if (::EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) != 1) throw std::bad_alloc();
  }
  std::string hex() {
    constexpr std::string_view digits = "0123456789abcdef";
    std::array<unsigned char, 32> digest{};
    if (::EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr) != 1) throw std::bad_alloc();
    std::string text;
    for (const unsigned char byte : digest) text += {digits[byte >> 4U], digits[byte & 15U]};
    return text;
  }

 private:
  struct Free {
    void operator()(EVP_MD_CTX* context) const { ::EVP_MD_CTX_free(context); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context_{::EVP_MD_CTX_new()};
};

}  // namespace

std::string sha256(std::string_view bytes) {
  Sha256 digest;
  digest.add(bytes);
  return digest.hex();
}

Expected<std::string> sha256_of_file(const std::filesystem::path& path,
                                     const std::function<void()>& after_each_part) {
  Sha256 digest;
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

}  // namespace nonio::host::storage
