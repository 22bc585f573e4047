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

Expected<std::string> page_of(const Source&);

}  // namespace nonio::model_html
