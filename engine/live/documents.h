// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live/calculation.h"

namespace nonio::live {

/// Writes model, exclusions and periods of the request to campaign.toml, like the commands of
/// `nonio model`. The answer contains the model, the new digest of the file and the lines added to
/// its history. An error if nothing differs.
Expected<std::string> save(Bench& bench, const storage::Json& request);

/// Returns the changes of `save` as `diff` in the unified format, and the model in campaign.toml or
/// its first error. `diff` is empty if the file has changed since it was read.
Expected<std::string> difference(Bench& bench, const storage::Json& request);

/// Returns the file that a run would write with the tried model: "page" of model-html for one part,
/// or "report" of pdf-report.
Expected<std::string> document(Bench& bench, const storage::Json& request);

}  // namespace nonio::live
