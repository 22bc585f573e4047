// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/residuals.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nonio/reports/site.h"

namespace nonio::assessment {

namespace {

reports::JointResiduals residuals_of(const modelling::Together& t) {
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  reports::JointResiduals out;
  out.name = t.part, out.axis = t.axis;
  out.rotary = t.parts.front().part.axes.front().rotary;
  out.angular = t.parts.front().part.table.angular;
  out.noise = t.explanation.noise;
  for (std::size_t m = 0; m < t.parts.size(); ++m) {
    out.campaigns.push_back(t.campaigns[m] + (t.dates[m].empty() ? "" : " (" + t.dates[m] + ")"));
    const model::Part& part = t.parts[m].part;
    const auto value = [&](const std::vector<double>& column, std::size_t i) {
      return column.empty() ? nowhere : column[i];
    };
    double first = std::numeric_limits<double>::infinity();
    for (const double s : part.table.time)
      if (std::isfinite(s)) first = std::min(first, s);
    for (std::size_t i = 0; i < part.table.size(); ++i) {
      out.campaign.push_back(static_cast<std::uint32_t>(m));
      out.position.push_back(part.along[i]);
      out.time.push_back(value(part.table.time, i) - first);
      out.temperature.push_back(value(part.table.material, i));
      out.residual.push_back(t.explanation.campaigns[m].residual[i]);
    }
  }
  return out;
}

}  // namespace

Expected<std::string> residuals_page(const std::vector<modelling::Together>& all,
                                     const Templates& templates, const std::string& language) {
  std::vector<reports::JointResiduals> parts;
  for (const modelling::Together& t : all) parts.push_back(residuals_of(t));
  return reports::residuals_page(parts, templates, language);
}

}  // namespace nonio::assessment
