// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"

/// A diagonal as one line: where its stops lie between its corners `from` and `to`.
namespace nonio::math {

/// Axes whose ends differ, in the order of their names; of a face in a volume the third one does
/// not move.
std::vector<std::string> moving_axes(const Measurement&);
/// From corner to corner: share of each moving axis; the sum of their squares is 1.
std::vector<double> direction_along(const Measurement&);
/// The readings as those of one axis along the diagonal, + from its first corner to its second.
Observations along_diagonal(const Observations&, const Measurement&);

}  // namespace nonio::math
