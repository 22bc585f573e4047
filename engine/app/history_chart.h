// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "laboratory/assessment/assess.h"

namespace nonio::app {

/// One line a machine: how many quantities are followed, what changed, when it is due.
std::string machines_table(const reports::SiteHistory& site);

/// All series of a machine, a line a campaign with a bar of value ± U; between them what changed
/// and what happened, below what the model says.
std::string machine_chart(const reports::MachineHistory& machine);

}  // namespace nonio::app
