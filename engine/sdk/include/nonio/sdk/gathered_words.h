// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/settings.h"

namespace nonio {

/// Moves the texts that `words` (format.h) looks up most often (findings, notes, terms) from all
/// files of a language into one table, so that `words` searches one table instead of twenty. If
/// files have the same key, the first file has priority. To be called once all templates are read.
void gather_words(Templates& templates);

}  // namespace nonio
