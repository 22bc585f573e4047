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

reports::JointResiduals residuals_of(const modelling::Alone& one) {
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  const model::Part& part = one.part.part;
  reports::JointResiduals out;
  out.name = one.campaign + " " + part.name;
  out.noise = one.noise;
  out.campaigns = part.measurements;
  out.campaign = part.measurement;
  out.position = part.along;
  out.residual = one.residual;
  out.time = out.temperature = std::vector<double>(part.table.size(), nowhere);
  out.made_order.emplace(part.table.size(), nowhere);
  for (std::size_t i = 0; i < part.row.size(); ++i)
    if (const std::string& of = part.measurements[part.measurement[i]];
        std::find(one.ordered.begin(), one.ordered.end(), of) != one.ordered.end())
      (*out.made_order)[i] = static_cast<double>(part.row[i]) + 1.0;
  return out;
}

}  // namespace

Expected<std::string> residuals_page(const modelling::FleetExplanation& all,
                                     const Templates& templates, const std::string& language) {
  std::vector<reports::JointResiduals> parts;
  for (const modelling::Together& t : all.together) parts.push_back(residuals_of(t));
  for (const modelling::Alone& one : all.alone)
    if (!one.residual.empty()) parts.push_back(residuals_of(one));
  if (parts.empty())
    return fail(
        "--page shows axes that several campaigns measured, and parts that a machine made; there "
        "are none");
  return reports::residuals_page(parts, templates, language);
}

}  // namespace nonio::assessment
