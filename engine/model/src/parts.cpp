// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "design.h"
#include "nonio/model/explain.h"

namespace nonio::model {

namespace {

/// Appends a column that one of the tables may not have: then it is NaN there.
void append(std::vector<double>& to, const std::vector<double>& more, std::size_t before,
            std::size_t added) {
  if (to.empty() && more.empty()) return;
  to.resize(before, std::numeric_limits<double>::quiet_NaN());
  if (more.empty())
    to.resize(before + added, std::numeric_limits<double>::quiet_NaN());
  else
    to.insert(to.end(), more.begin(), more.end());
}

void append(Observations& to, const Observations& more, const std::string& id) {
  const std::size_t before = to.size(), added = more.size();
  const auto line = static_cast<std::uint32_t>(to.lines.size());
  if (to.axes.empty()) {
    to.axes = {{more.axes.front().axis, more.axes.front().rotary, {}, {}}};
    to.angular = more.angular;
  }
  const auto& from = more.axes.front();
  auto& axis = to.axes.front();
  axis.position.insert(axis.position.end(), from.position.begin(), from.position.end());
  axis.approach.insert(axis.approach.end(), from.approach.begin(), from.approach.end());
  to.lines.push_back({id, more.lines.empty() ? std::array<double, 3>{} : more.lines.front().sense});
  to.line.insert(to.line.end(), added, line);
  to.deviation.insert(to.deviation.end(), more.deviation.begin(), more.deviation.end());
  to.run.insert(to.run.end(), more.run.begin(), more.run.end());
  to.source_line.insert(to.source_line.end(), more.source_line.begin(), more.source_line.end());
  append(to.time, more.time, before, added);
  append(to.material, more.material, before, added);
  append(to.air, more.air, before, added);
  to.missing += more.missing;
}

}  // namespace

std::vector<Part> parts_of(const Campaign& campaign, const std::vector<Observations>& read) {
  std::vector<Part> parts;
  for (std::size_t m = 0; m < campaign.measurements.size() && m < read.size(); ++m) {
    const Measurement& measurement = campaign.measurements[m];
    const Observations& o = read[m];
    if (measurement.kind != "axis" || o.size() == 0 || o.axes.empty() ||
        o.axes.front().approach.size() != o.size())
      continue;
    const Axis* axis = campaign.machine.axis(measurement.axis);
    if (axis == nullptr) continue;
    auto part = std::find_if(parts.begin(), parts.end(),
                             [&](const Part& p) { return p.axes.front().name == axis->name; });
    if (part == parts.end()) part = parts.insert(parts.end(), Part{{}, {*axis}, {}});
    part->measurements.push_back(measurement.id);
    append(part->table, o, measurement.id);
  }
  return parts;
}

std::vector<Term> catalogue(const Part& part, const std::vector<Effect>& effects) {
  std::vector<Term> terms;
  for (const Axis& axis : part.axes)
    for (const Effect& effect : effects)
      if (effect.applies(part.table, axis)) terms.push_back({&effect, axis, {}});
  return terms;
}

Expected<std::vector<Term>> terms_of(const Part& part, const Machine& machine,
                                     const std::vector<std::string>& names,
                                     const std::vector<Effect>& effects) {
  std::vector<Term> terms;
  for (const std::string& name : names) {
    const std::size_t colon = name.find(':');
    const std::string kind = name.substr(0, colon);
    const std::string of = colon == std::string::npos ? "" : name.substr(colon + 1);
    const auto effect = std::find_if(effects.begin(), effects.end(),
                                     [&](const Effect& e) { return e.info.name == kind; });
    if (effect == effects.end()) return fail("there is no effect \"" + kind + "\"");
    const auto here = std::find_if(part.axes.begin(), part.axes.end(),
                                   [&](const Axis& a) { return a.name == of; });
    if (here == part.axes.end()) {
      if (machine.axis(of) == nullptr)
        return fail("effect \"" + name + "\": the machine has no axis \"" + of +
                    "\"; wanted kind:axis, such as backlash:X");
      continue;
    }
    if (!effect->applies(part.table, *here))
      return fail("effect \"" + name +
                  "\" does not apply to these readings: " + effect->info.summary);
    terms.push_back({&*effect, *here, {}});
  }
  return terms;
}

}  // namespace nonio::model
