// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Evaluates new and changed campaigns of a site and updates history, worklist and summary. Returns
/// when the run is complete or was stopped by `request_stop`; the end is `refused` if the site or
/// the output folder cannot be used. The steps `plan` and `merge` are the first and the last part
/// of a run in shards; `dry_run` only surveys the site.
RunResult run_site(const RunOptions& options, const RunEvents& events);

}  // namespace nonio::batch
