// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/reader.h"

namespace nonio::pdf {

/// A file that is embedded in a PDF.
struct Attachment {
  std::string name;  ///< file name with its folders: "data/x.csv"
  std::string bytes;
  std::string type;  ///< MIME type: "text/csv"
  /// Relation to the document, /AFRelationship of PDF 2.0: Source, Data, Supplement or Alternative.
  std::string relation;
  std::string says;  ///< description for readers, one line
};

/// Returns the embedded files of a PDF, sorted by name. Error: the PDF embeds other files than it
/// lists, or a file in another form than `reserve` writes.
Expected<std::vector<Attachment>> attachments_of(const File& file);

/// Returns the uncompressed content of each page, in the order of the pages. If the content of a
/// page consists of several streams, they are joined.
Expected<std::vector<std::string>> page_contents(std::string_view pdf);

/// Checks that two PDFs made by `reserve`, of which the first is signed, contain the same objects;
/// streams are compared uncompressed. Only the signature (/ByteRange and /Contents), the compressed
/// lengths and the identifier of the file (/ID) may differ. The error states what differs.
Expected<void> same_pdf(std::string_view signed_pdf, std::string_view reserved);

}  // namespace nonio::pdf
