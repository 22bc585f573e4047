// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "nonio/reports/residuals.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/plugin.h"

namespace nonio::model_html {

/// What a page is made from.
struct Source {
  const OutputInput& in;
  const ModelFit& fit;
  const reports::Wording& words;
  std::array<reports::PictureWords, 9> pictures;
};

inline constexpr std::size_t most_readings = 20000;

/// The readings that the page holds: all, or of many a sample, and with it those with the largest
/// residuals, which are drawn but do not count in RMS and means.
struct Kept {
  std::vector<std::size_t> rows;
  std::vector<char> counted;
};
Kept kept_readings(const ModelFit&);

/// The page's data as JSON, in the units that are printed.
std::string data_of(const Source&, const Kept&);

std::string page_of(const Source&);

}  // namespace nonio::model_html
