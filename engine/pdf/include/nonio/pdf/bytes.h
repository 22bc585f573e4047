// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

struct libdeflate_compressor;

namespace nonio::pdf {

/// Compresses to the zlib format, at a level from 1 (fastest) to 12 (smallest result). The result
/// is empty if there is not enough memory.
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

/// Returns the 32 bytes of the digest, not hexadecimal digits.
std::string sha256(std::string_view bytes);

void append_int(std::string& out, long long value);

/// Appends a PDF operand with at most two decimals, followed by the character `after`. Values are
/// limited to +-30000, as by PDF readers; NaN becomes 30000.
void append_real(std::string& out, double value, char after);

}  // namespace nonio::pdf
