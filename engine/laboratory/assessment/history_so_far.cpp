// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/history_so_far.h"

#include <algorithm>
#include <map>
#include <set>

#include "laboratory/assessment/changes.h"
#include "laboratory/assessment/days.h"
#include "laboratory/assessment/describe.h"
#include "laboratory/statistics/difference.h"
#include "laboratory/store/reader.h"
#include "platform/storage/digest.h"
#include "platform/storage/json_values.h"

namespace nonio::assessment {
namespace fs = std::filesystem;
namespace kernel = nonio::statistics;

namespace {

std::string digest_of_basis(const HistoryBasis& b) {
  storage::Json events = storage::Json::array();
  for (const config::Event& e : b.events) events.push_back({e.date, e.axis, e.kind, e.text});
  const storage::Json json = {b.campaign,  b.day,  b.machine.name, b.aliases,
                              b.campaigns, events, b.months};
  return storage::sha256(json.dump(-1, ' ', false, storage::Json::error_handler_t::replace));
}

class BasisMachine {
 public:
  BasisMachine(const std::vector<store::MachineState>& machines, const std::string& name,
               const store::StoredLogs& logs, const MachineEvents& events) {
    const auto at = std::find_if(machines.begin(), machines.end(),
                                 [&](const auto& m) { return m.machine.name == name; });
    if (at == machines.end()) return;
    basis_.machine = at->machine;
    events_ = events.of(name);
    for (const auto& [alias, machine] : logs.aliases)
      if (machine == name) basis_.aliases.push_back(alias);
    auto rule = logs.due.find(name);
    if (rule == logs.due.end()) rule = logs.due.find("");
    if (rule != logs.due.end()) basis_.months = rule->second;
  }

  HistoryBasis basis(const store::CountedCampaign& of,
                     const std::vector<const store::CountedCampaign*>& all) const {
    HistoryBasis out = basis_;
    out.campaign = of.campaign, out.day = of.day;
    const bool placed = !out.machine.name.empty() && day_number(of.day);
    for (const store::CountedCampaign* c : all)
      if (placed && c->campaign != of.campaign && day_number(c->day) && c->day <= of.day)
        out.campaigns.emplace_back(c->campaign, c->sha256);
    for (const config::Event& e : events_)
      if (placed && e.date <= of.day) out.events.push_back(e);
    out.sha256 = digest_of_basis(out);
    return out;
  }

 private:
  HistoryBasis basis_{};
  std::vector<config::Event> events_{};
};

}  // namespace

Expected<std::vector<HistoryBasis>> history_bases(const fs::path& out,
                                                  const std::vector<std::string>& campaigns) {
  auto store = store::StoreReader::open(out);
  if (!store) return fail(store.error());
  NONIO_TRY(const auto logs, store->logs());
  NONIO_TRY(const auto machines, store->machines());
  NONIO_TRY(const auto counted, store->counted_campaigns());
  const std::set<std::string> wanted(campaigns.begin(), campaigns.end());
  const MachineEvents events(machines, logs);
  std::map<std::string, std::vector<const store::CountedCampaign*>> by_machine;
  for (const store::CountedCampaign& c : counted) by_machine[c.machine].push_back(&c);
  std::vector<HistoryBasis> bases;
  for (const auto& [name, of_machine] : by_machine) {
    if (std::none_of(of_machine.begin(), of_machine.end(),
                     [&](const auto* c) { return wanted.contains(c->campaign); }))
      continue;
    const BasisMachine machine(machines, name, logs, events);
    for (const store::CountedCampaign* c : of_machine)
      if (wanted.contains(c->campaign)) bases.push_back(machine.basis(*c, of_machine));
  }
  return bases;
}

namespace {

/// Returns the campaigns of the basis and its own campaign. All have run 0, because the history
/// does not depend on runs.
store::StoredMachine campaigns_up_to(const store::StoredMachine& all, const HistoryBasis& basis) {
  std::set<std::string> wanted{basis.campaign};
  for (const auto& [campaign, digest] : basis.campaigns) wanted.insert(campaign);
  store::StoredMachine out;
  std::map<std::size_t, std::size_t> place;
  for (std::size_t i = 0; i < all.campaigns.size(); ++i) {
    if (!wanted.contains(all.campaigns[i].id)) continue;
    place[i] = out.campaigns.size();
    out.campaigns.push_back(all.campaigns[i]);
    out.campaigns.back().run = 0;
    out.findings.push_back(all.findings[i]);
  }
  const auto take = [&](const std::vector<store::StoredResult>& from,
                        std::vector<store::StoredResult>& to) {
    for (const store::StoredResult& r : from)
      if (const auto at = place.find(r.campaign); at != place.end()) {
        to.push_back(r);
        to.back().campaign = at->second;
      }
  };
  out.other_targets = all.other_targets;
  take(all.results, out.results);
  take(all.predicted, out.predicted);
  return out;
}

Expected<void> add_steps(const AssessedMachine& m, const FollowedSeries& s,
                         const std::string& campaign, std::size_t series, HistorySoFar& to) {
  const Quantity q = quantity_of_unit(s.unit);
  const std::vector<kernel::Point> points = compared_points(s);
  for (std::size_t k = 1; k < s.results.size(); ++k) {
    const store::StoredResult &before = m.stored.results[s.results[k - 1]],
                              &now = m.stored.results[s.results[k]];
    if (m.stored.campaigns[now.campaign].id != campaign) continue;
    NONIO_TRY(const auto step, kernel::difference(points[k - 1], points[k]));
    const store::StoredCampaign& other = m.stored.campaigns[before.campaign];
    HistoryStep out{s.axis, s.quantity, series, campaign, other.id, other.day};
    out.point = to.series[series].points.size() - s.results.size() + k;
    out.size = si(step.value, q), out.u = si(step.u, q);
    to.steps.push_back(std::move(out));
  }
  return {};
}

bool has_point(const HistorySeries& s, const std::string& campaign) {
  return std::any_of(s.points.begin(), s.points.end(),
                     [&](const HistoryPoint& p) { return p.joined && p.campaign == campaign; });
}

}  // namespace

Expected<HistorySoFar> history_so_far(const fs::path& out, const HistoryBasis& basis) {
  HistorySoFar so_far;
  so_far.machine = basis.machine.name, so_far.day = basis.day, so_far.aliases = basis.aliases;
  so_far.campaigns = basis.campaigns, so_far.sha256 = basis.sha256;
  so_far.months = basis.months;
  for (const config::Event& e : basis.events)
    so_far.events.push_back({e.date, e.axis, e.kind, e.text});
  if (basis.machine.name.empty() || !day_number(basis.day)) return so_far;
  if (basis.months != 0) so_far.due = months_later(basis.day, basis.months);
  NONIO_TRY(auto store, store::StoreReader::open(out));
  NONIO_TRY(const auto all, store.machine(basis.machine.name));
  std::vector<AssessedMachine> one{
      {{basis.machine, 0, {}}, campaigns_up_to(all, basis), basis.events, {}, {}}};
  AssessedMachine& m = one.front();
  m.followed = followed_series(m.stored, m.events);
  m.shown = shown_series(m.stored, m.events);
  Fits fits;
  learn(one, fits);
  find_changes(one, {}, fits, [] {});
  reports::MachineHistory described = describe(m, out, so_far.due, {});
  for (std::size_t i = 0; i < described.series.size(); ++i) {
    HistorySeries& series = described.series[i];
    if (!has_point(series, basis.campaign)) continue;
    for (HistoryPoint& p : series.points) p.link.clear();
    so_far.series.push_back(std::move(series));
    if (i >= m.followed.size()) continue;
    if (auto well = add_steps(m, m.followed[i], basis.campaign, so_far.series.size() - 1, so_far);
        !well)
      return fail(well.error());
  }
  return so_far;
}

}  // namespace nonio::assessment
