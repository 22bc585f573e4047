// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sign/verify.h"

namespace nonio::certificates {

/// Whether two results.json give the same values, points, rows, series and decisions; findings and
/// versions may differ. How much was compared, or the first difference.
Expected<std::string> same_values(std::string_view attached, std::string_view recomputed);

/// Whether two results.json of one version of Nonio are the same throughout, but for the last digit
/// of numbers and for digests of files that are not among `attached`.
Expected<void> same_results(std::string_view results, std::string_view recomputed,
                            const std::vector<std::string>& attached);

/// A DCC's units and list lengths, and its numbers against those of results.json if it is there.
sign::Check check_dcc(const pdf::Attachment& dcc, const pdf::Attachment* results);

}  // namespace nonio::certificates
