// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sign/verify.h"

namespace nonio::certificates {

/// Checks that two results.json contain the same values, points, rows, series and decisions;
/// findings and versions may differ. Returns how much was compared; an error states the first
/// difference.
Expected<std::string> same_values(std::string_view attached, std::string_view recomputed);

/// Checks that two results.json of one version of Nonio are equal, except for the last digits of
/// numbers and for digests of files that are not among `attached`.
Expected<void> same_results(std::string_view results, std::string_view recomputed,
                            const std::vector<std::string>& attached);

/// Checks a DCC's units and list lengths, and compares its numbers with results.json if that is
/// attached.
sign::Check check_dcc(const pdf::Attachment& dcc, const pdf::Attachment* results);

}  // namespace nonio::certificates
