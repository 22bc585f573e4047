// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run_file.h"
#include "runs.h"

namespace nonio::renishaw {

/// SI value of one unit of the file.
struct Units {
  double target = 1e-3, value = 1e-6;
};

/// The runs as readings of one axis, and what a user would want to know of them. Directions are
/// those in which the rows of each run go through the targets.
Expected<void> add_runs(const RunFile& file, const Units& units, readers::Runs& runs);

/// Free text that an operator typed; the axis there must not contradict the manifest's.
Expected<void> add_user_text(const RunFile& file, const ReadInput& input, Observations& obs);

/// Option of both readers.
Option code_page_option();

}  // namespace nonio::renishaw
