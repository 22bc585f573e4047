// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

struct libdeflate_compressor;

namespace nonio::pdf {

/// Compresses bytes to the zlib format, at a level from 1 (fastest) to 12 (smallest result). The
/// result is empty if there is not enough memory.
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

/// Returns the SHA-256 digest of the bytes, 32 bytes.
std::string sha256(std::string_view bytes);

void append_int(std::string& out, long long value);

/// Appends a number to `out` as an operand of a PDF, with at most two decimals, and then the
/// character `after`. Values beyond +-30000 are replaced by this limit, because PDF readers limit
/// them too; NaN is replaced by 30000.
void append_real(std::string& out, double value, char after);

}  // namespace nonio::pdf
