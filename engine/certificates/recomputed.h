// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sign/verify.h"

namespace nonio::certificates {

/// Compares values, points, rows, series and decisions of two results.json. Returns how much was
/// compared; an error states the first difference.
Expected<std::string> same_values(std::string_view attached, std::string_view recomputed);

/// Compares two results.json of one version of Nonio, except for the last digits of numbers and the
/// digests of files that are not among `attached`.
Expected<void> same_results(std::string_view results, std::string_view recomputed,
                            const std::vector<std::string>& attached);

/// Checks units, list lengths and, unless `results` is null, numbers against results.json.
sign::Check check_dcc(const pdf::Attachment& dcc, const pdf::Attachment* results);

}  // namespace nonio::certificates
