// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "nonio/sdk/format.h"
#include "rtl.h"
#include "runs.h"

namespace reader_cases {

/// All readers of instrument files.
inline const std::vector<nonio::Reader>& readers() {
  static const std::vector<nonio::Reader> all{nonio::renishaw::rtl_reader()};
  return all;
}

}  // namespace reader_cases
