// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/reports/document.h"
#include "nonio/sdk/settings.h"

namespace nonio::pages {

/// A layout template: templates/<name>.toml, checked.
struct Look {
  std::vector<std::string> blocks, measurement, plots;
  std::vector<std::string> summary;  ///< results on the first page in addition to those with limits
  int plots_per_row = 2;
  std::string regular, bold, wide;  ///< names of the font files; `wide` may be empty
  /// file names of pictures: of the laboratory, of its accreditation; may be empty
  std::string logo, mark;
  std::string verification;  ///< URL of the page that verifies a certificate; may be empty
  std::string profile;       ///< file name of an ICC profile of sRGB; may be empty
  double logo_height = 0.0;  ///< height of the logo, pt
  reports::Style style;
};

/// Reads a layout template. Error, with file and key: an unknown key or block, a missing key, a
/// wrong type. `blocks` and `measurement`: names of the available parts.
Expected<Look> read_look(const Templates&, const std::string& name,
                         const std::vector<std::string>& blocks,
                         const std::vector<std::string>& measurement);

/// Returns the template's fonts, parsed and compressed once per process.
Expected<std::shared_ptr<const reports::Fonts>> fonts_of(const Templates&, const Look&);

}  // namespace nonio::pages
