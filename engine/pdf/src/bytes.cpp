// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/bytes.h"

#include <libdeflate.h>
#include <openssl/sha.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace nonio::pdf {

Deflater::Deflater(int level) : compressor_(libdeflate_alloc_compressor(level)) {}
Deflater::~Deflater() { libdeflate_free_compressor(compressor_); }

std::string Deflater::operator()(std::string_view bytes) const {
  if (compressor_ == nullptr) return "";
  std::string out(libdeflate_zlib_compress_bound(compressor_, bytes.size()), '\0');
  out.resize(
      libdeflate_zlib_compress(compressor_, bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  return {digest.begin(), digest.end()};
}

void append_int(std::string& out, long long value) {
  char buffer[24];
  out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

/// Does not use a library function, because a document contains tens of thousands of numbers.
void append_real(std::string& out, double value, char after) {
  if (!(std::fabs(value) < 30000.0))
    value = std::copysign(30000.0, std::isnan(value) ? 0.0 : value);
  const double exact = std::fabs(value) * 100.0;
  auto hundredths = static_cast<std::uint32_t>(exact);
  if (exact - hundredths >= 0.5) ++hundredths;
  std::array<char, 12> text;
  char* at = text.data() + text.size();
  *--at = after;
  std::uint32_t whole = hundredths / 100;
  if (const std::uint32_t rest = hundredths % 100; rest != 0) {
    if (rest % 10 != 0) *--at = static_cast<char>('0' + rest % 10);
    *--at = static_cast<char>('0' + rest / 10);
    *--at = '.';
  }
  do *--at = static_cast<char>('0' + whole % 10);
  while ((whole /= 10) != 0);
  if (value < 0.0 && hundredths != 0) *--at = '-';
  out.append(at, static_cast<std::size_t>(text.data() + text.size() - at));
}

}  // namespace nonio::pdf
