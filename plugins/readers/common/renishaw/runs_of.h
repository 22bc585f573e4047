// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run_file.h"
#include "runs.h"

namespace nonio::renishaw {

/// SI value of one unit of the file.
struct Units {
  double target = 1e-3, value = 1e-6;
};

/// Adds readings of one axis, and remarks. The direction of a run is that in which its rows pass
/// the targets.
Expected<void> add_runs(const RunFile& file, const Units& units, readers::Runs& runs);

/// Adds the operator's free text as a note. Error: it names another axis than the manifest.
Expected<void> add_user_text(const RunFile& file, const ReadInput& input, Observations& obs);

Option code_page_option();

}  // namespace nonio::renishaw
