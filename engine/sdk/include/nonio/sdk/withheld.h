// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace nonio {

/// Whether a finding states that an analysis gives no result, such as "diagonals.refused-place" or
/// an id that ends with "-needed".
inline bool is_refusal(std::string_view finding) {
  return finding.find(".refused") != std::string_view::npos || finding.ends_with("-needed");
}

/// Whether a finding states that a compensation did not have its effect.
inline bool is_failed_compensation(std::string_view finding) {
  return finding.starts_with("before-after.") &&
         (finding.ends_with("not-active") || finding.ends_with("wrong-sign") ||
          finding.ends_with("something-else"));
}

/// Whether a finding of severity `attention` requires action: a table or certificate was not made
/// or must not be used, a compensation failed, the instrument had no valid calibration, there is no
/// result, or results include a suspected misreading. Other findings are warnings.
inline bool is_withholding(std::string_view finding) {
  return finding.starts_with("table.") || finding.starts_with("certificate.") ||
         finding.starts_with("traceability.") || finding == "signature.not-released" ||
         finding == "reading.suspect" || is_failed_compensation(finding) || is_refusal(finding);
}

}  // namespace nonio
