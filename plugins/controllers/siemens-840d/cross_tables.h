// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/controllers/kit.h"

namespace nonio::siemens_840d {

/// An error if one of these CEC tables is in use (option `taken`).
Expected<void> free_tables(std::int64_t first, std::size_t count, const Settings& options);
/// Text that these table numbers were not read from the control.
std::string chosen_words(std::int64_t first, std::size_t count);

/// Adds the text of `chosen_words` as a note.
void note_chosen(const std::string& axis, std::int64_t first, std::size_t count,
                 OutputResult& result);

/// Writes one CEC table per cross curve from diagonals or step diagonals (six for a volume); the
/// squareness is in one curve of each plane. `pitch`: pitch tables already written.
Expected<void> write_cross_tables(const ControllerInput&,
                                  const std::vector<controllers::AxisJob>& pitch, OutputResult&);

}  // namespace nonio::siemens_840d
