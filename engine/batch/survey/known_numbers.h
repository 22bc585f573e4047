// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "batch/state/run_result.h"
#include "campaign/reading/context.h"
#include "certificates/register.h"

namespace nonio::batch {

/// Entries and drafts in the register before the run.
struct Known {
  std::vector<certificates::RegisterEntry> numbers;
  std::vector<certificates::WaitingDraft> drafts;
};

/// Point of the run at which the register is read. `first`: before anything is issued; the hash
/// chain of the journal is checked, and a broken chain is an error.
enum class Look { first, again };
/// Reads the register; none if another process keeps it locked. An error if it cannot be read, or
/// is in a place where it could be lost.
Expected<std::optional<Known>> known_of(const RunOptions& options, const reading::Context& context,
                                        Look look = Look::first);

/// Returns the position of the last issued number in the order of issue, counted from 1; 0 if no
/// number is issued.
std::uint64_t issued_so_far(const std::vector<certificates::RegisterEntry>& numbers);

}  // namespace nonio::batch
