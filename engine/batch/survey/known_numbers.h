// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "batch/state/run_result.h"
#include "campaign/reading/context.h"
#include "certificates/register.h"

namespace nonio::batch {

/// Content of the register before the run.
struct Known {
  std::vector<certificates::RegisterEntry> numbers;
  std::vector<certificates::WaitingDraft> drafts;
};

/// `first`: before numbers are issued, the hash chain of the journal is checked, and a broken chain
/// is an error.
enum class Look { first, again };
/// Returns std::nullopt if another process has locked the register. An error if it cannot be read,
/// or if it is stored in the output folder, where it could be lost.
Expected<std::optional<Known>> known_of(const RunOptions& options, const reading::Context& context,
                                        Look look = Look::first);

/// Returns the last position in the order of issue, counted from 1; 0 without certificates.
std::uint64_t issued_so_far(const std::vector<certificates::RegisterEntry>& numbers);

}  // namespace nonio::batch
