// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live/calculation.h"

namespace nonio::live {

/// Writes the model to campaign.toml as `nonio model add` and `drop` do: {"model": [...]}. The
/// answer has the new digest of the file and the lines of its history.
Expected<std::string> save(Bench& bench, const storage::Json& request);

/// What that would change: {"diff": "--- campaign.toml\n+++ ..."}, and the file as it is now
/// on the disk.
Expected<std::string> difference(Bench& bench, const storage::Json& request);

/// The file that a run would write, of the model that is tried: "page" for one part by
/// model-html, "report" by pdf-report. The bytes themselves.
Expected<std::string> document(Bench& bench, const storage::Json& request);

}  // namespace nonio::live
