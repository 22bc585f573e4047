// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/settings.h"

namespace nonio {

/// Puts what `words` (format.h) is asked for thousands of times a night - findings, notes, terms - of all files of a
/// language into one table, the first file first: `words` then looks into one table instead of twenty. For who has read
/// templates; they say the same with and without it.
void gather_words(Templates& templates);

}  // namespace nonio
