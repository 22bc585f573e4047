// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/conditions.h"

#include <cmath>
#include <utility>

namespace nonio::assessment {
using storage::Json;

namespace {

constexpr double same_place = 0.01;  // of the span
bool near(double a, double b, double span) { return std::fabs(a - b) <= same_place * span; }

double number_at(const Json& o, const char* key) {
  const auto it = o.find(key);
  return it != o.end() && it->is_number() ? it->get<double>() : 0.0;
}

}  // namespace

std::string difference(const Json& a, const Json& b, bool common_stretch) {
  const double span = number_at(a, "to") - number_at(a, "from");
  if (!common_stretch && (a.contains("from") != b.contains("from") ||
                          !near(number_at(a, "from"), number_at(b, "from"), span) ||
                          !near(number_at(a, "to"), number_at(b, "to"), span)))
    return "span";
  for (const auto& [key, why] :
       {std::pair("at", "place"), std::pair("across", "across"), std::pair("model", "model"),
        std::pair("period", "period"), std::pair("radius", "radius"), std::pair("feed", "feed")}) {
    const Json one = a.value(key, Json()), other = b.value(key, Json());
    const bool same = one.is_number() && other.is_number()
                          ? near(one.get<double>(), other.get<double>(), one.get<double>())
                          : one == other;
    if (!same) return why;
  }
  return {};
}

Json parsed(const std::string& conditions) {
  Json json = Json::parse(conditions, nullptr, false);
  return json.is_object() ? json : Json::object();
}

std::string compensation(const Json& conditions) {
  const auto it = conditions.find("compensation");
  return it != conditions.end() && it->is_string() ? it->get<std::string>() : "";
}

bool stepped_by_table(const std::string& before, const std::string& after) {
  return !before.empty() && !after.empty() && before != after;
}

}  // namespace nonio::assessment
