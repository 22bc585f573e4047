// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/attachments.h"
#include "nonio/pdf/reader.h"
#include "nonio/pdf/text.h"

namespace nonio::pdf {

inline constexpr std::string_view sub_filter = "ETSI.CAdES.detached";
/// Largest space for a signature, bytes. Its hexadecimal digits fit into a PDF string, which may
/// have 65535 bytes.
inline constexpr std::size_t max_room = 32000;
/// Largest size of a file, and of a file with its uncompressed attachments, bytes; larger files are
/// neither signed nor verified.
inline constexpr std::size_t max_file = 100'000'000;

/// Default space for the CMS object of a signature, bytes; sufficient for a time stamp with a long
/// certificate chain.
inline constexpr std::size_t usual_room = 16384;

/// Returns `pdf` with the attachments, a signature field, and space for a signature of `room`
/// bytes, filled with zeros. The field is in the frame that a page declares for it
/// (`signature_key`); without a frame, it is invisible on the first page. Equal input gives equal
/// bytes. `pdf` is parsed strictly (reader.h), because plugins create it. Error: `parse` rejects
/// `pdf`, it already has a form or attachments, an attachment has no valid name, `room` is not 1000
/// to `max_room`, or the sizes exceed `max_file`.
Expected<std::string> reserve(std::string_view pdf, const std::vector<Attachment>& attachments,
                              Time time, std::size_t room = usual_room);

struct PdfSignature {
  const Value* dictionary = nullptr;
  std::string_view before, after;  ///< signed bytes before and after the signature
  std::size_t gap = 0;             ///< position of the signature's "<" in the file, bytes
  std::string_view contents;       ///< hexadecimal digits of the signature
  Time time = 0;  ///< time of signing as stated by the signer, without proof by a time stamp

  std::size_t room() const { return contents.size() / 2; }
};

/// Finds the signature near the end of a file by the form that `reserve` writes; an error if there
/// is none. The rest of the file is parsed only after the signature has been verified.
Expected<PdfSignature> signature_at_end(std::string_view bytes);
/// Returns the stated time of signing (/M); an error if it does not have the form that `reserve`
/// writes.
Expected<Time> stated_time(std::string_view pdf);

/// Returns the signature dictionary. Error unless the form of the file has exactly one field, which
/// is a signature of the type `sub_filter`, and no second signature dictionary exists.
Expected<const Value*> find_signature(const File& file);
/// Error unless the /ByteRange covers the whole file except /Contents, and unless /Contents and the
/// time (/M) have the form that `reserve` writes.
Expected<PdfSignature> signature_of(const File& file, const Value& dictionary);

}  // namespace nonio::pdf
