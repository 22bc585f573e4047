// SPDX-License-Identifier: Apache-2.0
#include "followed.h"

#include "nonio/sdk/format.h"

namespace nonio::circle {

namespace {

std::optional<Followed> named(const std::string& value, const std::string& plane) {
  if (value == "scale_mismatch" || value == "servo_mismatch")
    return Followed{value + ':' + plane, plane};
  if (value == "D") return Followed{"radius:" + plane, plane};
  if (value.size() == 3 && value[1] == '0')
    return Followed{"squareness:" + plane + ".circle", plane};
  if (value.starts_with("bow_")) return Followed{"bow:" + value.substr(4), value.substr(6)};
  for (const auto& [begin, name] :
       {std::pair("B_", "B_circle"), std::pair("lateral_", "lateral"),
        std::pair("cyclicCos_", "cyclic_circle_cos"), std::pair("cyclicSin_", "cyclic_circle_sin")})
    if (value.starts_with(begin)) return Followed{name, value.substr(std::string(begin).size())};
  return std::nullopt;
}

std::string plane_of(const Measurement& m) {
  std::string plane;
  for (const char letter : {'X', 'Y', 'Z'})
    for (const auto& [axis, at] : m.from)
      if (axis.front() == letter) plane += letter;
  return plane;
}

Followed conditions_of(const Measurement& m) {
  Followed out;
  std::map<std::string, double> at = m.at;
  for (const auto& [axis, centre] : m.from) {
    at[axis] = centre;
    if (const auto end = m.to.find(axis); end != m.to.end() && end->second != centre)
      out.numbers.emplace_back("radius", printed(end->second - centre, Quantity::length));
  }
  if (m.feed) out.numbers.emplace_back("feed", *m.feed * 60e3);  // mm/min, as the manifest has it
  if (!m.compensation.empty()) out.texts.emplace_back("compensation", m.compensation);
  out.texts.emplace_back("at", positions_text(at));
  return out;
}

}  // namespace

void follow(const Campaign& campaign, const Measurement& m, Evaluation& e) {
  const std::string plane = plane_of(m);
  const Followed conditions = conditions_of(m);
  for (Value& v : e.values) {
    v.followed = named(v.name, plane);
    if (!v.followed) continue;
    v.followed->numbers = conditions.numbers, v.followed->texts = conditions.texts;
    if (const Axis* axis = campaign.machine.axis(v.followed->axis);
        v.followed->quantity.starts_with("cyclic") && axis != nullptr && axis->screw_pitch)
      v.followed->numbers.emplace_back("period", printed(*axis->screw_pitch, Quantity::length));
  }
}

}  // namespace nonio::circle
