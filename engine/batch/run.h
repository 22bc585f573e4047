// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "batch/state/run_result.h"

namespace nonio::batch {

/// The nightly run over a site. Returns when every campaign is done, or after a call of
/// `request_stop`, or at once with `refused` if the site or the output folder cannot be used.
/// With the step plan or merge: that part of a run. A plan leaves it open.
RunResult run_site(const RunOptions& options, const RunEvents& events);

}  // namespace nonio::batch
