// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/reports/document.h"
#include "nonio/sdk/templates.h"

namespace nonio::pages {

/// A checked layout template, templates/<name>.toml.
struct Look {
  std::vector<std::string> blocks, measurement, plots;
  std::vector<std::string> summary;  ///< results on the first page in addition to those with limits
  int plots_per_row = 2;
  std::string regular, bold, wide;  ///< names of the font files; `wide` may be empty
  /// File names of pictures: of the laboratory, of its accreditation; may be empty.
  std::string logo, mark;
  std::string verification;  ///< URL of the page that verifies a certificate; may be empty
  std::string profile;       ///< file name of an ICC profile of sRGB; may be empty
  double logo_height = 0.0;  ///< pt
  reports::Style style;
};

/// `blocks` and `measurement` are the names of the available parts. Error, with file and key: an
/// unknown key or block, a missing key, a wrong type.
Expected<Look> read_look(const Templates&, const std::string& name,
                         const std::vector<std::string>& blocks,
                         const std::vector<std::string>& measurement);

/// Fonts are parsed and compressed once per process.
Expected<std::shared_ptr<const reports::Fonts>> fonts_of(const Templates&, const Look&);

}  // namespace nonio::pages
