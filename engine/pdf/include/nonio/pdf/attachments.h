// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/pdf/reader.h"

namespace nonio::pdf {

/// A file inside the PDF.
struct Attachment {
  std::string name;  ///< with folders, "data/x.csv"
  std::string bytes;
  std::string type;      ///< "text/csv"
  std::string relation;  ///< PDF 2.0 /AFRelationship: Source, Data, Supplement, Alternative
  std::string says;      ///< one line for people
};

/// The embedded files of a PDF in the order of their names.
Expected<std::vector<Attachment>> attachments_of(const File& file);

/// What is drawn on each page, uncompressed, as the writer of the PDF put it down.
Expected<std::vector<std::string>> page_contents(std::string_view pdf);

/// Whether two PDFs of `reserve`, one of them signed, have the same objects, streams uncompressed;
/// only the signature itself and the identifier that is made from the whole file may differ.
Expected<void> same_pdf(std::string_view signed_pdf, std::string_view reserved);

}  // namespace nonio::pdf
