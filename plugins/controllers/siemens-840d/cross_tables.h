// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/controllers/kit.h"

namespace nonio::siemens {

/// A CEC table for each curve of one axis over another that diagonals or step diagonals gave: Y by
/// the position of X, and X by that of Y with the squareness in it; of a volume six. `pitch`: what
/// was written of the axes themselves.
Expected<void> write_cross_tables(const OutputInput&,
                                  const std::vector<controllers::AxisJob>& pitch, OutputResult&);

}  // namespace nonio::siemens
