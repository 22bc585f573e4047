// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/settings.h"

namespace nonio {

/// Collects the texts that `words` (format.h) looks up most often (findings, notes, terms) from all
/// files of a language into one table, so that it searches one table instead of twenty. Earlier
/// files have priority. Call it after templates are read; it changes no text.
void gather_words(Templates& templates);

}  // namespace nonio
