// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "campaign/modelling/campaign_model.h"
#include "platform/storage/json_values.h"

/// Readings of a part as the page requests them: reduced to pixels, or single ones.
namespace nonio::live {

/// Least and largest y in each of `px` columns of the range x0..x1, and the rows that have them; so
/// that an extreme never vanishes. Of no more readings than twice the pixels all of them.
Expected<std::string> series(const modelling::PartModel& part, const storage::Json& request,
                             std::span<const double> residual);

/// Whether a series has to do with what a fit leaves.
bool is_of_fit(const storage::Json& series);

/// Readings by their rows, or `count` of them from `from` on: file, line, run, direction, values.
/// Without residuals where `residual` is empty.
Expected<std::string> readings(const modelling::PartModel& part, const Campaign& campaign,
                               const storage::Json& request, std::span<const double> residual);

}  // namespace nonio::live
