// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "font_reader.h"

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

/// Locates glyph outlines. Formats: ISO/IEC 14496-22 (OpenType), 5.2 and 5.3.
class Outlines {
 public:
  Outlines(const FontReader& r, std::size_t head, std::size_t loca, std::size_t glyf)
      : r_(r), loca_(loca), glyf_(glyf), long_(r.u16(head + 50) != 0) {}

  std::size_t begin(std::size_t glyph) const {
    return glyf_ + (long_ ? r_.u32(loca_ + 4 * glyph) : 2 * r_.u16(loca_ + 2 * glyph));
  }
  std::size_t size(std::size_t glyph) const {
    const std::size_t from = begin(glyph), to = begin(glyph + 1);
    return to > from ? to - from : 0;
  }
  /// File offsets of the numbers of component glyphs.
  std::vector<std::size_t> components(std::size_t glyph) const {
    std::vector<std::size_t> out;
    if (size(glyph) < 10 || r_.s16(begin(glyph)) >= 0) return out;
    for (std::size_t at = begin(glyph) + 10; at + 4 <= begin(glyph + 1) && r_.ok();) {
      const std::uint32_t flags = r_.u16(at);
      out.push_back(at + 2);
      at += 4 + (flags & 0x01 ? 4 : 2);
      at += flags & 0x80 ? 8 : flags & 0x40 ? 4 : flags & 0x08 ? 2 : 0;
      if ((flags & 0x20) == 0) break;
    }
    return out;
  }

 private:
  const FontReader& r_;
  std::size_t loca_, glyf_;
  bool long_;
};

}  // namespace nonio::reports
