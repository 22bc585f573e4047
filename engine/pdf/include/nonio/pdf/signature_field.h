// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/attachments.h"
#include "nonio/pdf/reader.h"
#include "nonio/pdf/text.h"

/// The place of a signature in a PDF: made by `reserve`, found again by its form near the end.
namespace nonio::pdf {

inline constexpr std::string_view sub_filter = "ETSI.CAdES.detached";
inline constexpr std::size_t max_room = 32000;  ///< a PDF string may have 65535 bytes
/// A file, and the same with its attachments uncompressed: what is larger is neither signed nor
/// looked at.
inline constexpr std::size_t max_file = 100'000'000;

/// Bytes for the CMS object if nothing else is stated: enough for a time stamp with a long chain.
inline constexpr std::size_t usual_room = 16384;

/// `pdf` with attachments, a signature field in the frame that a page has for it (`signature_key`),
/// else without appearance on its first page, and `room` bytes of zeros for the signature. Same
/// input, same bytes. `pdf` is read strictly (reader.h): it comes from plugins.
Expected<std::string> reserve(std::string_view pdf, const std::vector<Attachment>& attachments,
                              Time time, std::size_t room = usual_room);

/// The one signature of a file.
struct PdfSignature {
  const Value* dictionary = nullptr;
  std::string_view before, after;  ///< what is signed
  std::size_t gap = 0;             ///< position of the signature's "<"
  std::string_view contents;       ///< its hexadecimal digits
  Time time = 0;                   ///< as the signer states; not confirmed by others

  std::size_t room() const { return contents.size() / 2; }
};

/// Finds the signature near the end of a file by the form that `reserve` gives it. The rest of the
/// file is parsed only after the signature was verified.
Expected<PdfSignature> signature_at_end(std::string_view bytes);
/// When a signed PDF states that it was signed (/M); an error if it states it in another way than
/// `reserve` does.
Expected<Time> stated_time(std::string_view pdf);

/// Exactly one signature field, reachable from the form, on the first page.
Expected<const Value*> find_signature(const File& file);
/// Its dictionary's /ByteRange covers the whole file but for /Contents.
Expected<PdfSignature> signature_of(const File& file, const Value& dictionary);

}  // namespace nonio::pdf
