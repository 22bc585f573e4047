// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace nonio::reports {

/// Big-endian numbers of a font file. Beyond the end of the file, 0 is returned and `ok` becomes
/// false.
class FontReader {
 public:
  explicit FontReader(std::string_view bytes) : bytes_(bytes) {}
  std::uint32_t u16(std::size_t at) const { return byte(at) << 8 | byte(at + 1); }
  std::uint32_t u32(std::size_t at) const { return u16(at) << 16 | u16(at + 2); }
  int s16(std::size_t at) const { return static_cast<std::int16_t>(u16(at)); }
  bool ok() const { return ok_; }

  std::optional<std::size_t> table(std::string_view tag) const { return entry(tag, 8); }
  std::optional<std::size_t> table_size(std::string_view tag) const { return entry(tag, 12); }

 private:
  std::optional<std::size_t> entry(std::string_view tag, std::size_t field) const {
    const std::size_t count = u16(4);
    for (std::size_t i = 0; i < count; ++i)
      if (12 + 16 * i + 16 <= bytes_.size() && bytes_.substr(12 + 16 * i, 4) == tag)
        return u32(12 + 16 * i + field);
    return {};
  }
  std::uint32_t byte(std::size_t at) const {
    if (at < bytes_.size()) return static_cast<unsigned char>(bytes_[at]);
    ok_ = false;
    return 0;
  }
  std::string_view bytes_;
  mutable bool ok_ = true;
};

}  // namespace nonio::reports
