// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live/calculation.h"

namespace nonio::live {

/// Writes the model to campaign.toml, as `nonio model add` and `drop` do: {"model": [...]}. The
/// answer contains the new digest of the file and the lines added to its history.
Expected<std::string> save(Bench& bench, const storage::Json& request);

/// Returns what `save` would change as {"diff": "--- campaign.toml\\n+++ ..."}, and the model that
/// campaign.toml on the disk states now. The difference is empty if the file has changed since it
/// was read.
Expected<std::string> difference(Bench& bench, const storage::Json& request);

/// Returns the bytes of the file that a run would write with the tried model: "page" of model-html
/// for one part, or "report" of pdf-report.
Expected<std::string> document(Bench& bench, const storage::Json& request);

}  // namespace nonio::live
