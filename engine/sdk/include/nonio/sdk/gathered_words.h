// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/settings.h"

namespace nonio {

/// Collects the texts that `words` (format.h) looks up most - findings, notes, terms - from all
/// files of a language into one table, the first file first, so that it searches one table instead
/// of twenty. To be called after templates are read; the texts stay the same.
void gather_words(Templates& templates);

}  // namespace nonio
