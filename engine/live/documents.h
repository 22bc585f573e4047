// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live/calculation.h"

namespace nonio::live {

/// Writes the model, the exclusions and the periods of the request to campaign.toml, as the
/// commands of `nonio model` do. The answer contains the model, the new digest of the file and the
/// lines added to its history. An error if nothing differs.
Expected<std::string> save(Bench& bench, const storage::Json& request);

/// Returns what `save` would change, as `diff` in the unified format, and the model that
/// campaign.toml on the disk states now, or its first error. The difference is empty if the file has
/// changed since it was read.
Expected<std::string> difference(Bench& bench, const storage::Json& request);

/// Returns the bytes of the file that a run would write with the tried model: "page" of model-html
/// for one part, or "report" of pdf-report.
Expected<std::string> document(Bench& bench, const storage::Json& request);

}  // namespace nonio::live
