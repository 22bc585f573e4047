// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "laboratory/assessment/assess.h"

namespace nonio::app {

/// What the history is printed with: words of site.toml and terminal.toml, and columns.
struct HistoryWords {
  const reports::Wording& words;
  std::size_t width;
};

/// One line per machine: how many quantities are followed, what changed, when it is due.
std::string machines_table(const reports::SiteHistory& site, const HistoryWords& with);

/// All series of a machine, one line per campaign with a bar of value ± U; between them changes and
/// events, below them slope, detection limit and forecast. The scatter of the readings is followed
/// as its logarithm and printed as a scatter, its changes as factors.
std::string machine_chart(const reports::MachineHistory& machine, const HistoryWords& with);

}  // namespace nonio::app
