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

/// What the pictures of a browser's page are drawn from (page/draw.js), as JSON.
namespace nonio::workbench {

/// A part's model, and what is stated about it. The words are those of
/// templates/words/<language>/pictures.toml.
struct Drawn {
  const Campaign& campaign;
  const ModelFit& fit;
  const reports::Wording& words;
  std::array<reports::PictureWords, 9> pictures;
};

/// Whether the part has circles, which have pictures of their own (page/polar.js).
bool has_circles(const Campaign&, const ModelFit&);

/// Names of the words that page/chart.js uses.
inline constexpr std::array<const char*, 6> chart_words = {
    "chart.in", "chart.out", "chart.left", "chart.right", "chart.all", "chart.tools"};

inline constexpr std::size_t most_readings = 20000;

/// The readings that a page holds: all, or of many a sample, and with it those with the largest
/// values, which are drawn but do not count in RMS and means.
struct Kept {
  std::vector<std::size_t> rows;
  std::vector<char> counted;
  /// Of each reading of the fit its row in the files, where that is another one; else empty.
  std::vector<std::size_t> row_in_files{};
};
Kept kept_readings(const std::vector<double>& values, std::size_t most = most_readings);

/// The data as JSON, in the units that are printed (um, mm; arcsec, deg). `titles`: with title and
/// sentence of each picture, which a page from disk has in its text.
std::string data_of(const Drawn& drawn, const Kept& kept, bool titles = true);

}  // namespace nonio::workbench
