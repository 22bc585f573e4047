// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/curves.h"

#include <simdjson.h>

#include <map>
#include <set>
#include <string>

#include "campaign/evaluation/record.h"
#include "laboratory/assessment/describe.h"
#include "platform/storage/files.h"

namespace nonio::assessment {
namespace dom = simdjson::dom;

namespace {

std::string member_text(const dom::object& o, const char* name) {
  std::string_view text;
  return o[name].get(text) == simdjson::SUCCESS ? std::string(text) : std::string();
}

std::map<std::string, std::string> axes_in(const dom::element& results) {
  std::map<std::string, std::string> out;
  dom::array followed;
  if (results["followed"].get(followed) != simdjson::SUCCESS) return out;
  for (const dom::object f : followed)
    if (const std::string measurement = member_text(f, "measurement"); !measurement.empty())
      out[measurement] = member_text(f, "axis");
  return out;
}

reports::ErrorCurve curve_of(const dom::object& analysis) {
  reports::ErrorCurve curve;
  dom::array points;
  dom::object units, U;
  if (analysis["points"].get(points) != simdjson::SUCCESS ||
      analysis["point_units"].get(units) != simdjson::SUCCESS)
    return curve;
  const std::string position = member_text(units, "target");
  const Quantity along = quantity_of_unit(position),
                 across = quantity_of_unit(member_text(units, "mean"));
  curve.rotary = position == "deg";
  for (const dom::object p : points) {
    double target = 0.0, mean = 0.0;
    if (p["target"].get(target) != simdjson::SUCCESS || p["mean"].get(mean) != simdjson::SUCCESS)
      continue;
    curve.position.push_back(si(target, along));
    curve.mean.push_back(si(mean, across));
  }
  double expanded = 0.0;
  if (analysis["point_U"].get(U) == simdjson::SUCCESS &&
      U["mean"].get(expanded) == simdjson::SUCCESS)
    curve.u = si(expanded / 2.0, across);
  return curve;
}

void read_curves(const std::filesystem::path& file, const std::string& campaign,
                 const std::string& date, dom::parser& parser,
                 std::vector<reports::ErrorCurve>& out) {
  const auto text = storage::read_file(file);
  if (!text) return;
  try {
    const dom::element results = parser.parse(*text);
    const auto axes = axes_in(results);
    std::set<std::string> seen;  // two analyses of one measurement have the same means
    for (const dom::object analysis : results["analyses"].get_array()) {
      const std::string measurement = member_text(analysis, "measurement");
      const auto axis = axes.find(measurement);
      if (axis == axes.end() || seen.contains(measurement)) continue;
      reports::ErrorCurve curve = curve_of(analysis);
      if (curve.position.empty()) continue;
      curve.campaign = campaign, curve.date = date, curve.axis = axis->second;
      seen.insert(measurement);
      out.push_back(std::move(curve));
    }
  } catch (const simdjson::simdjson_error& e) {
    if (e.error() == simdjson::MEMALLOC) throw std::bad_alloc();
  }
}

}  // namespace

std::vector<reports::ErrorCurve> curves_of(const std::filesystem::path& out,
                                           const reports::MachineHistory& machine) {
  // Pairs of date and campaign.
  std::set<std::pair<std::string, std::string>> campaigns;
  for (const reports::HistorySeries& s : machine.series)
    for (const reports::HistoryPoint& p : s.points) campaigns.emplace(p.date, p.campaign);
  std::vector<reports::ErrorCurve> curves;
  dom::parser parser;
  for (const auto& [date, campaign] : campaigns)
    read_curves(storage::results_folder(out, campaign) / evaluation::results_name, campaign, date,
                parser, curves);
  return curves;
}

}  // namespace nonio::assessment
