// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Does the nightly run over a site: evaluates the campaigns that need it, and updates the history,
/// the worklist and the summary. Returns when this is done, after a call of `request_stop`, or with
/// `refused` if the site or the output folder cannot be used. With the step plan or merge, only
/// that part is done. After a plan the run remains in progress. With `dry_run`, the site is only
/// surveyed.
RunResult run_site(const RunOptions& options, const RunEvents& events);

}  // namespace nonio::batch
