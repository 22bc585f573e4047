// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "batch/state/run_result.h"
#include "campaign/reading/context.h"
#include "certificates/register.h"

namespace nonio::batch {

/// The entries of the register before the run; nothing if another process keeps it locked.
struct Known {
  std::vector<certificates::RegisterEntry> numbers;
  std::vector<certificates::WaitingDraft> drafts;
};

/// An error if the register cannot be read, or is where it would be lost.
/// `first`: before anything is issued; then a journal that is no chain is an error too.
enum class Look { first, again };
Expected<std::optional<Known>> known_of(const RunOptions& options, const reading::Context& context,
                                        Look look = Look::first);

/// Order of the last number.
std::uint64_t issued_so_far(const std::vector<certificates::RegisterEntry>& numbers);

}  // namespace nonio::batch
