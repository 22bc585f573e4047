// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camonitor.h"
#include "ecmc_iso230.h"
#include "linuxcnc_probe.h"
#include "long_table.h"
#include "nonio/sdk/format.h"
#include "rta.h"
#include "rtl.h"
#include "runs.h"
#include "wide_table.h"

namespace reader_cases {

/// All readers of instrument files.
inline const std::vector<nonio::Reader>& readers() {
  static const std::vector<nonio::Reader> all{
      nonio::renishaw::rtl_reader(),  nonio::renishaw::rta_reader(), nonio::wide_table::reader(),
      nonio::long_table::reader(),    nonio::ecmc_iso230::reader(),  nonio::camonitor::reader(),
      nonio::linuxcnc_probe::reader()};
  return all;
}

}  // namespace reader_cases
