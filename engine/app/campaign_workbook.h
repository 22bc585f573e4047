// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "platform/storage/workbook.h"
#include "shown_results.h"

namespace nonio::app {

/// The results of one campaign as a spreadsheet: what was decided with its uncertainty, points,
/// curves and their charts, budgets, and the readings where `shown` has them. Numbers are those of
/// results.json. An error if it is none of results.
Expected<storage::Workbook> workbook_of(const Shown& shown);

}  // namespace nonio::app
