// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "platform/storage/workbook.h"
#include "shown_results.h"

namespace nonio::app {

/// Returns the results of one campaign as a spreadsheet with the numbers of results.json. An error
/// if `shown` does not contain results of schema nonio-results/1.
Expected<storage::Workbook> workbook_of(const Shown& shown);

}  // namespace nonio::app
