// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "platform/storage/workbook.h"
#include "shown_results.h"

namespace nonio::app {

/// Returns the results of one campaign as a spreadsheet: decisions with their uncertainty, points,
/// curves with charts, budgets, and the readings if `shown` contains them. Numbers are those of
/// results.json. An error if `shown` does not contain a results.json.
Expected<storage::Workbook> workbook_of(const Shown& shown);

}  // namespace nonio::app
