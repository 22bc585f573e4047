// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/reader.h"

namespace nonio::pdf {

struct Attachment {
  std::string name;  ///< file name with its folders: "data/x.csv"
  std::string bytes;
  std::string type;  ///< MIME type: "text/csv"
  /// /AFRelationship of PDF 2.0: Source, Data, Supplement or Alternative.
  std::string relation;
  std::string says;  ///< description for readers, one line
};

/// Returns the embedded files, sorted by name. Error: the PDF embeds other files than it lists, or
/// a file in another form than `reserve` writes.
Expected<std::vector<Attachment>> attachments_of(const File& file);

/// Returns the uncompressed content of each page; several streams of a page are joined.
Expected<std::vector<std::string>> page_contents(std::string_view pdf);

/// Checks that two PDFs made by `reserve`, of which the first is signed, contain the same objects;
/// streams are compared uncompressed. Only the signature (/ByteRange and /Contents), the compressed
/// lengths and the identifier of the file (/ID) may differ. An error describes the difference.
Expected<void> same_pdf(std::string_view signed_pdf, std::string_view reserved);

}  // namespace nonio::pdf
