// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/reports/document.h"
#include "nonio/sdk/settings.h"

namespace nonio::pages {

/// A template: templates/<name>.toml, checked.
struct Look {
  std::vector<std::string> blocks, measurement, plots;
  std::vector<std::string>
      summary;  ///< results that the first page shows besides those with limits
  int plots_per_row = 2;
  std::string regular, bold, wide;  ///< names of the font files; `wide` may be empty
  std::string logo, mark;    ///< pictures: of the laboratory, of its accreditation; may be empty
  std::string verification;  ///< address of the page that verifies a certificate; may be empty
  std::string profile;       ///< ICC profile of sRGB; may be empty
  double logo_height = 0.0;  ///< pt
  reports::Style style;
};

/// An unknown key or block, a missing key or one of the wrong kind is an error that names file and
/// key. `blocks` and `measurement`: the parts that there are to choose from.
Expected<Look> read_look(const Templates&, const std::string& name,
                         const std::vector<std::string>& blocks,
                         const std::vector<std::string>& measurement);

/// The template's fonts, parsed and compressed once in a process.
Expected<std::shared_ptr<const reports::Fonts>> fonts_of(const Templates&, const Look&);

}  // namespace nonio::pages
