// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/reports/document.h"

namespace nonio::pages {

/// A document in two languages out of the same document in each of them: labels joined, sentences
/// side by side, numbers once, with the first one's decimal sign.
reports::Document side_by_side(reports::Document first, const reports::Document& second);

}  // namespace nonio::pages
