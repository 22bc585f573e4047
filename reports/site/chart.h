// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "html.h"

namespace nonio::reports::site {

/// One quantity over the years: points with U, limit and guard band, events, what the model
/// predicts, forecast. An SVG.
Html history_chart(const Page&, const MachineHistory&, const HistorySeries&);

/// The same as a line without axes, for a table.
Html spark_line(const Page&, const HistorySeries&);

/// Error curves of one axis: all campaigns, grey to today.
Html curves_chart(const Page&, const MachineHistory&, const std::string& axis);
/// The last curve less the one before it, with U.
Html difference_chart(const Page&, const MachineHistory&, const std::string& axis);

/// Values of machines of one model next to each other.
Html comparison_chart(const Page&, const ModelComparison&);

}  // namespace nonio::reports::site
