// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "campaign/modelling/campaign_model.h"
#include "platform/storage/json_values.h"

namespace nonio::live {

/// Returns the least and the largest y with their rows for each of `px` columns of the range
/// x0..x1, so that no extreme is lost; single readings if there are at most 2 px.
Expected<std::string> series(const modelling::PartModel& part, const storage::Json& request,
                             std::span<const double> residual);

/// Whether the series needs the residuals of a fit.
bool is_of_fit(const storage::Json& series);

/// Returns the requested rows, or `count` readings from row `from` on: file, line, run, direction,
/// values. `residual` may be empty.
Expected<std::string> readings(const modelling::PartModel& part, const Campaign& campaign,
                               const storage::Json& request, std::span<const double> residual);

}  // namespace nonio::live
