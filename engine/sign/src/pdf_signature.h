// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "pdf_reader.h"

namespace nonio::sign {

inline constexpr std::string_view sub_filter = "ETSI.CAdES.detached";
inline constexpr std::size_t max_room = 32000;        ///< a PDF string may have 65535 bytes
inline constexpr std::size_t max_file = 500'000'000;  ///< with attachments, uncompressed

/// The one signature of a file.
struct PdfSignature {
  const pdf::Value* dictionary = nullptr;
  std::string_view before, behind;  ///< what is signed
  std::size_t gap = 0;              ///< where the signature's "<" stands
  std::string_view contents;        ///< its hexadecimal digits
  std::string time;                 ///< /M as written; nobody vouches for it

  std::size_t room() const { return contents.size() / 2; }
};

/// Exactly one signature field, reachable from the form, that stands on the first page.
Expected<const pdf::Value*> find_signature(const pdf::File& file);
/// Its dictionary's /ByteRange covers the whole file but for /Contents.
Expected<PdfSignature> signature_of(const pdf::File& file, const pdf::Value& dictionary);

}  // namespace nonio::sign
