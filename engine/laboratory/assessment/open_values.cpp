// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/open_values.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "laboratory/assessment/describe.h"
#include "nonio/sdk/withheld.h"

namespace nonio::assessment {

using store::LimitWithoutValue;
using store::StoredMachine;
using store::StoredResult;

namespace {

bool is_open(const StoredResult& r) { return !r.decision.empty() && r.decision != conforms; }

std::map<std::string, std::size_t> newest_of_axes(const StoredMachine& m) {
  std::map<std::string, std::size_t> out;
  for (const StoredResult& r : m.results)
    // Results are sorted by date, so the last one remains.
    if (!r.axis.empty()) out[r.axis] = r.campaign;
  return out;
}

bool has_value(const StoredMachine& m, const LimitWithoutValue& limit) {
  return std::any_of(m.results.begin(), m.results.end(), [&](const StoredResult& r) {
    return !r.followed && r.campaign == limit.campaign && r.axis == limit.axis &&
           r.quantity == limit.quantity &&
           (!limit.axis.empty() || r.measurement == limit.measurement);
  });
}

std::string axis_of_measurement(const StoredMachine& m, std::size_t campaign,
                                const std::string& measurement) {
  for (const StoredResult& r : m.results)
    if (r.campaign == campaign && r.measurement == measurement && !r.axis.empty()) return r.axis;
  return {};
}

/// Whether a later campaign measured `axis`; if `axis` is empty, all axes of the campaign.
bool is_measured_later(const StoredMachine& m, const std::map<std::string, std::size_t>& newest,
                       std::size_t campaign, const std::string& axis) {
  if (!axis.empty()) {
    const auto found = newest.find(axis);
    return found != newest.end() && found->second > campaign;
  }
  std::set<std::string> axes;
  for (const StoredResult& r : m.results)
    if (r.campaign == campaign && !r.axis.empty()) axes.insert(r.axis);
  return !axes.empty() && std::all_of(axes.begin(), axes.end(), [&](const std::string& one) {
    return newest.at(one) > campaign;
  });
}

}  // namespace

std::vector<Judged> open_results(const StoredMachine& m, const ShownSeries& s) {
  // A campaign without a limit makes no decision, so previous decisions remain valid.
  std::map<std::string, std::vector<std::size_t>> groups;
  for (const std::size_t i : s.results)
    if (const StoredResult& r = m.results[i]; !r.decision.empty())
      groups[s.axis.empty() ? r.measurement : std::string()].push_back(i);
  std::vector<Judged> out;
  for (const auto& [measurement, results] : groups) {
    const auto day_of = [&](std::size_t i) { return m.campaigns[m.results[i].campaign].day; };
    const std::string newest = day_of(results.back());
    const bool left = std::any_of(results.begin(), results.end(), [&](std::size_t i) {
      return day_of(i) == newest && m.results[i].state == "as-left";
    });
    for (const std::size_t i : results) {
      const bool replaced = day_of(i) != newest || (left && m.results[i].state == "as-found");
      if (!replaced && is_open(m.results[i])) out.push_back({&s, i});
    }
  }
  return out;
}

std::vector<const LimitWithoutValue*> open_limits(const StoredMachine& m) {
  const auto newest = newest_of_axes(m);
  std::vector<const LimitWithoutValue*> out;
  for (const LimitWithoutValue& limit : m.without_value) {
    if (has_value(m, limit)) continue;
    const auto found = newest.find(limit.axis);
    const bool counts = limit.axis.empty()
                            ? !is_measured_later(m, newest, limit.campaign, {})
                            : found != newest.end() && found->second == limit.campaign;
    if (counts) out.push_back(&limit);
  }
  return out;
}

reports::OpenValue open_value(const StoredMachine& m, std::size_t result) {
  const StoredResult& r = m.results[result];
  const Quantity q = quantity_of_unit(r.unit);
  reports::OpenValue out{r.axis, r.quantity, m.campaigns[r.campaign].id, r.measurement};
  out.unit = q;
  out.value = si(r.value, q);
  if (r.expanded) out.u = si(*r.expanded / r.k.value_or(2.0), q);
  out.limit = si(r.tolerance.value_or(0.0), q);
  out.undecided = r.decision != does_not_conform;
  out.state = r.state;
  return out;
}

reports::OpenValue open_value(const StoredMachine& m, const LimitWithoutValue& limit) {
  reports::OpenValue out{limit.axis, limit.quantity, m.campaigns[limit.campaign].id,
                         limit.measurement};
  out.unit = quantity_of_unit(limit.unit);
  out.limit = si(limit.tolerance, out.unit);
  out.undecided = true;
  return out;
}

bool is_calibration(std::string_view finding) { return finding.starts_with("traceability."); }

std::vector<Withheld> withheld(const StoredMachine& m) {
  const auto newest = newest_of_axes(m);
  std::map<std::tuple<std::size_t, std::string, std::string>, std::set<std::string>> found;
  for (std::size_t i = 0; i < m.asked.size(); ++i)
    for (const store::FindingRow& f : m.asked[i]) {
      const bool is_table = f.id.starts_with("table.");
      const bool is_of_axis = is_table || f.id == "reading.suspect" || is_failed_compensation(f.id);
      const std::string axis =
          is_of_axis ? axis_of_measurement(m, i, f.measurement) : std::string();
      if (is_of_axis && is_measured_later(m, newest, i, axis)) continue;
      if ((is_calibration(f.id) || (!is_table && is_refusal(f.id))) &&
          is_measured_later(m, newest, i, {}))
        continue;
      found[{i, axis, f.id}].insert(f.source);
    }
  std::vector<Withheld> out;
  for (const auto& [key, outputs] : found)
    out.push_back(
        {std::get<0>(key), std::get<1>(key), std::get<2>(key), {outputs.begin(), outputs.end()}});
  return out;
}

}  // namespace nonio::assessment
