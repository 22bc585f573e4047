// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "nonio/sign/verify.h"
#include "pdf_reader.h"

namespace nonio::sign {

inline constexpr std::string_view sub_filter = "ETSI.CAdES.detached";
inline constexpr std::size_t max_room = 32000;  ///< a PDF string may have 65535 bytes
/// A file, and the same with its attachments uncompressed: what is larger is neither signed nor
/// looked at.
inline constexpr std::size_t max_file = max_bytes;
inline constexpr const char* too_large = "is larger than 100 MB";

/// The one signature of a file.
struct PdfSignature {
  const pdf::Value* dictionary = nullptr;
  std::string_view before, behind;  ///< what is signed
  std::size_t gap = 0;              ///< where the signature's "<" stands
  std::string_view contents;        ///< its hexadecimal digits
  Time time = 0;                    ///< as the signer says; nobody else vouches for it

  std::size_t room() const { return contents.size() / 2; }
};

/// By its place near the end of a file and the form that `reserve` gives it. Nothing else of the
/// file is read: that comes when the signature holds.
Expected<PdfSignature> signature_at_end(std::string_view bytes);
/// The name of an attachment in letters that every reader shows; others become "_".
std::string plain_name(std::string_view name);

/// Exactly one signature field, reachable from the form, that stands on the first page.
Expected<const pdf::Value*> find_signature(const pdf::File& file);
/// Its dictionary's /ByteRange covers the whole file but for /Contents.
Expected<PdfSignature> signature_of(const pdf::File& file, const pdf::Value& dictionary);

}  // namespace nonio::sign
