// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/error_text.h"

namespace nonio::reading {

std::string text_of(const Error& e) {
  return e.file + (e.line != 0 ? ":" + std::to_string(e.line) : "") +
         (e.column.empty() ? "" : " (" + e.column + ")") + (e.file.empty() ? "" : ": ") + e.message;
}

}  // namespace nonio::reading
