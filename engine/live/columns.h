// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "campaign/modelling/campaign_model.h"
#include "platform/storage/json_values.h"

/// Returns the readings of a part as the page requests them: reduced to pixels, or single ones.
namespace nonio::live {

/// Returns the least and the largest y in each of `px` columns of the range x0..x1, and the rows
/// that have them, so that no extreme is lost. If there are at most twice as many readings as
/// pixels, all are returned.
Expected<std::string> series(const modelling::PartModel& part, const storage::Json& request,
                             std::span<const double> residual);

/// Whether a series needs the residuals of a fit.
bool is_of_fit(const storage::Json& series);

/// Returns readings by their rows, or `count` of them from `from` on: file, line, run, direction,
/// values. Residuals are left out if `residual` is empty.
Expected<std::string> readings(const modelling::PartModel& part, const Campaign& campaign,
                               const storage::Json& request, std::span<const double> residual);

}  // namespace nonio::live
