// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

struct libdeflate_compressor;

namespace nonio::pdf {

/// Into zlib's format; level 1 (fast) to 12 (small).
class Deflater {
 public:
  explicit Deflater(int level);
  ~Deflater();
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  std::string operator()(std::string_view bytes) const;

 private:
  libdeflate_compressor* compressor_;
};
inline std::string deflated(std::string_view bytes, int level) { return Deflater(level)(bytes); }

/// 32 bytes.
std::string sha256(std::string_view bytes);

/// Decimal digits of an integer.
void append_int(std::string& out, long long value);

/// With at most two decimals, as PDF operands; the size is limited to 30000, as PDF readers do.
void append_real(std::string& out, double value, char after);

}  // namespace nonio::pdf
