// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/reports/residuals.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

/// Data of the figures of a web page (page/draw.js) as JSON.
namespace nonio::workbench {

/// The model of a part with its texts from templates/words/<language>/pictures.toml.
struct Drawn {
  const Campaign& campaign;
  const ModelFit& fit;
  const reports::Wording& words;
  std::array<reports::PictureWords, 9> pictures;
};

/// Circles have separate figures (page/polar.js).
bool has_circles(const Campaign&, const ModelFit&);

inline constexpr std::size_t most_readings = 20000;

/// The readings on a page: all, or a sample of many plus those with the largest values. The latter
/// are drawn but excluded from RMS and means.
struct Kept {
  std::vector<std::size_t> rows;
  std::vector<char> counted;
  /// Row of each reading in the files, if different; otherwise empty.
  std::vector<std::size_t> row_in_files{};
};
Kept kept_readings(const std::vector<double>& values, std::size_t most = most_readings);

/// The data as JSON in printed units (um, mm; arcsec, deg). With `titles`, the data include title
/// and caption of each figure, which a stored page has in its HTML.
std::string data_of(const Drawn& drawn, const Kept& kept, bool titles = true);

}  // namespace nonio::workbench
