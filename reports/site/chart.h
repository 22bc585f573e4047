// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "html.h"

namespace nonio::reports::site {

/// SVG of one quantity over the years: points with U, limit and guard band, events, model
/// prediction, forecast.
Html history_chart(const Page&, const MachineHistory&, const HistorySeries&);

/// A line without axes, for a table.
Html spark_line(const Page&, const HistorySeries&);

/// Error curves of one axis from all campaigns, older ones in gray.
Html curves_chart(const Page&, const MachineHistory&, const std::string& axis);
/// Last minus previous error curve of an axis, with U.
Html difference_chart(const Page&, const MachineHistory&, const std::string& axis);

/// Values of machines of the same model, side by side.
Html comparison_chart(const Page&, const ModelComparison&);

/// Residuals of several campaigns, the last one colored, with their means and twice the noise;
/// `rows` of the values are drawn.
Html residuals_chart(const Page&, const JointResiduals&, const std::vector<std::size_t>& rows,
                     const std::vector<double>& across, const std::string& heading,
                     const std::string& title);

}  // namespace nonio::reports::site
