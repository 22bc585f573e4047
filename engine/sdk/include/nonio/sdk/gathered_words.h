// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/settings.h"

namespace nonio {

/// Collects the texts that `words` (format.h) looks up most often (findings, notes, terms) from all
/// files of a language into one table, so that `words` searches one table instead of twenty. Texts
/// of earlier files have priority. It is called after the templates are read, and changes no text.
void gather_words(Templates& templates);

}  // namespace nonio
