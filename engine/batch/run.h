// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Evaluates the campaigns of a site that are new or changed, and updates the history, the worklist
/// and the summary. Returns when the run is complete or when it was stopped by `request_stop`; the
/// end is `refused` if the site or the output folder cannot be used. With the step `plan` or
/// `merge`, only this part of the run is done, and the run remains in progress after `plan`. With
/// `dry_run`, the site is only surveyed.
RunResult run_site(const RunOptions& options, const RunEvents& events);

}  // namespace nonio::batch
