// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Does the nightly run over a site. Returns when every campaign is evaluated, after a call of
/// `request_stop`, or at once with `refused` if the site or the output folder cannot be used. With
/// the step plan or merge, only that part is done. After a plan the run remains in progress.
RunResult run_site(const RunOptions& options, const RunEvents& events);

}  // namespace nonio::batch
