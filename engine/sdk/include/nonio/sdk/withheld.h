// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace nonio {

/// A finding with which an analysis gives no result: "diagonals.refused-place", "-yaw-needed".
inline bool is_refusal(std::string_view finding) {
  return finding.find(".refused") != std::string_view::npos || finding.ends_with("-needed");
}

/// A finding of severity `attention` that requires action; others warn. A table or a certificate was
/// not made, or is not to be used, the instrument had no valid calibration, or there is no result.
inline bool is_withholding(std::string_view finding) {
  return finding.starts_with("table.") || finding.starts_with("certificate.") ||
         finding.starts_with("traceability.") || finding == "signature.not-released" ||
         is_refusal(finding);
}

}  // namespace nonio
