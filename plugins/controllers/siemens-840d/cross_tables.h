// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/controllers/kit.h"

namespace nonio::siemens_840d {

/// A CEC table for each curve of one axis over another that diagonals or step diagonals gave: Y by
/// the position of X, and X by that of Y with the squareness in it; of a volume six. `pitch`: what
/// was written of the axes themselves.
/// An error where one of these CEC tables is in use: option `taken`.
Expected<void> free_tables(std::int64_t first, std::size_t count, const Settings& options);
/// States that these numbers were not read from the control.
std::string chosen_words(std::int64_t first, std::size_t count);

/// A note that states that.
void note_chosen(const std::string& axis, std::int64_t first, std::size_t count,
                 OutputResult& result);

Expected<void> write_cross_tables(const ControllerInput&,
                                  const std::vector<controllers::AxisJob>& pitch, OutputResult&);

}  // namespace nonio::siemens_840d
