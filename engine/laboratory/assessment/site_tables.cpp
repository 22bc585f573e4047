// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/site_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "laboratory/assessment/describe.h"
#include "platform/storage/json_values.h"

namespace nonio::assessment {

using reports::MonthOfMachine;
using Kind = reports::WorkItem::Kind;

namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2.0;
}

class Months {
 public:
  explicit Months(const std::string& machine) : machine_(machine) {}

  MonthOfMachine& at(const std::string& day) {
    const std::string month = day.substr(0, 7);
    MonthOfMachine& cell = cells_[month];
    cell.machine = machine_, cell.month = month;
    return cell;
  }
  void grave(const std::string& day, Kind kind) {
    MonthOfMachine& cell = at(day);
    if (!cell.gravest || kind < *cell.gravest) cell.gravest = kind;
  }
  void append_to(std::vector<MonthOfMachine>& out) {
    for (auto& [month, cell] : cells_) out.push_back(std::move(cell));
  }

 private:
  const std::string& machine_;
  std::map<std::string, MonthOfMachine> cells_;
};

using UseKey = std::tuple<std::string, std::string, std::string>;

std::string name_of(const store::InstrumentAsStated& i) {
  std::string out;
  for (const std::string* part : {&i.maker, &i.model, &i.serial})
    if (!part->empty()) out += (out.empty() ? "" : " ") + *part;
  return out;
}

}  // namespace

std::vector<MonthOfMachine> months_of(const AssessedMachine& m,
                                      const reports::MachineHistory& described,
                                      const std::vector<reports::WorkItem>& lines) {
  std::vector<MonthOfMachine> out;
  Months months(m.state.machine.name);
  for (const store::StoredCampaign& c : m.stored.campaigns)
    if (c.day.size() == 10) months.at(c.day).measured = true;
  for (const ShownSeries& s : m.shown)
    for (const std::size_t r : s.results) {
      const store::StoredResult& result = m.stored.results[r];
      const std::string& day = m.stored.campaigns[result.campaign].day;
      if (result.decision.empty() || result.decision == "conforms") continue;
      months.grave(day, result.decision == "does not conform" ? Kind::out : Kind::undecided);
    }
  for (const reports::HistorySeries& s : described.series)
    for (const reports::HistoryChange& c : s.changes)
      if (c.cause == "undeclared") months.grave(c.before, Kind::changed);
  for (const reports::WorkItem& l : lines)
    if (l.since.size() == 10 && (l.kind == Kind::changed || l.kind == Kind::withheld))
      months.grave(l.since, l.kind);
  for (const config::Event& e : m.events) months.at(e.date).event = true;
  months.append_to(out);
  return out;
}

std::vector<reports::InstrumentUse> instruments_of(const AssessedMachine& m,
                                                   const std::filesystem::path& out) {
  std::map<UseKey, reports::InstrumentUse> all;
  const Links links(out);
  for (const store::StoredCampaign& c : m.stored.campaigns) {
    const std::string name = name_of(c.instrument);
    if (name.empty()) continue;
    reports::InstrumentUse& use = all[{name, c.instrument.certificate, c.instrument.valid_until}];
    use.name = name, use.certificate = c.instrument.certificate;
    use.valid_until = c.instrument.valid_until;
    use.results.push_back({c.id, c.day, m.state.machine.name, c.number, links.of(c.id)});
  }
  std::vector<reports::InstrumentUse> list;
  for (auto& [key, use] : all) list.push_back(std::move(use));
  return list;
}

std::vector<reports::InstrumentUse> joined(
    const std::vector<const std::vector<reports::InstrumentUse>*>& of_machines) {
  std::map<UseKey, reports::InstrumentUse> all;
  for (const auto* uses : of_machines)
    for (const reports::InstrumentUse& use : *uses) {
      const auto [at, is_new] = all.try_emplace({use.name, use.certificate, use.valid_until}, use);
      if (!is_new)
        at->second.results.insert(at->second.results.end(), use.results.begin(), use.results.end());
    }
  std::vector<reports::InstrumentUse> list;
  for (auto& [key, use] : all) {
    std::stable_sort(use.results.begin(), use.results.end(), [](const auto& a, const auto& b) {
      return std::tie(a.date, a.campaign) < std::tie(b.date, b.campaign);
    });
    list.push_back(std::move(use));
  }
  return list;
}

std::vector<ComparedValue> compared_of(const AssessedMachine& m,
                                       const reports::MachineHistory& described) {
  std::vector<ComparedValue> out;
  for (const FollowedSeries& s : m.followed) {
    if (s.ended) continue;
    const auto last = std::find_if(s.results.rbegin(), s.results.rend(), [&](std::size_t r) {
      return m.stored.results[r].state != "as-left";
    });
    if (last == s.results.rend()) continue;
    const store::StoredResult& r = m.stored.results[*last];
    const Quantity q = quantity_of_unit(s.unit);
    ComparedValue value{s.axis, s.quantity, q, si(r.value, q), si(r.u_repeat.value_or(0.0), q)};
    for (const reports::HistorySeries& of : described.series)
      for (const reports::HistoryPoint& p : of.points)
        if (of.axis == s.axis && of.quantity == s.quantity && !of.model.empty() &&
            p.campaign == m.stored.campaigns[r.campaign].id && p.value == value.value)
          value.u = reports::u_of_value(p);
    storage::Json json = storage::parse_or_discard(r.conditions);
    if (json.is_object()) {
      value.rotary = std::any_of(described.curves.begin(), described.curves.end(),
                                 [&](const auto& c) { return c.axis == s.axis && c.rotary; });
      if (const auto from = json.find("from"), to = json.find("to");
          from != json.end() && to != json.end() && from->is_number() && to->is_number())
        value.travel = si(to->get<double>() - from->get<double>(),
                          value.rotary ? Quantity::angle : Quantity::length);
      for (const char* key : {"from", "to", "compensation"}) json.erase(key);
      value.conditions = storage::dump_line(json);
    }
    out.push_back(std::move(value));
  }
  return out;
}

namespace {

constexpr double same_travel = 1.1;
constexpr std::size_t most_compared = 60;

struct Candidate {
  const std::string* machine;
  const ComparedValue* of;
  double travel() const { return of->travel.value_or(0.0); }
};

reports::ModelComparison comparison(const std::string& model,
                                    const std::vector<Candidate>& machines) {
  const ComparedValue& first = *machines.front().of;
  reports::ModelComparison c;
  c.model = model, c.axis = first.axis, c.quantity = first.quantity, c.unit = first.unit;
  if (first.travel) c.travel = {machines.front().travel(), machines.back().travel(), first.rotary};
  c.count = machines.size();
  std::vector<double> values, distances;
  for (const Candidate& m : machines) values.push_back(m.of->value);
  c.median = median(values);
  for (const double v : values) distances.push_back(std::fabs(v - c.median));
  c.spread = 1.4826 * median(distances);
  for (const Candidate& m : machines)
    c.machines.push_back({*m.machine, m.of->value, m.of->u,
                          c.spread > 0.0 ? (m.of->value - c.median) / c.spread : 0.0});
  const auto by_name = [](const auto& a, const auto& b) { return a.machine < b.machine; };
  std::stable_sort(c.machines.begin(), c.machines.end(), by_name);
  if (c.machines.size() <= most_compared) return c;
  std::stable_sort(c.machines.begin(), c.machines.end(), [&](const auto& a, const auto& b) {
    return std::fabs(a.value - c.median) > std::fabs(b.value - c.median);
  });
  c.machines.resize(most_compared);
  std::stable_sort(c.machines.begin(), c.machines.end(), by_name);
  return c;
}

}  // namespace

std::vector<reports::ModelComparison> comparisons_of(const std::vector<ComparedMachine>& machines) {
  std::map<std::tuple<std::string, std::string, std::string, Quantity, std::string, bool>,
           std::vector<Candidate>>
      all;
  for (const ComparedMachine& m : machines) {
    if (m.machine->model.empty()) continue;
    for (const ComparedValue& v : *m.values)
      all[{m.machine->model, v.axis, v.quantity, v.unit, v.conditions, v.travel.has_value()}]
          .push_back({&m.machine->id, &v});
  }
  std::vector<reports::ModelComparison> out;
  for (auto& [key, candidates] : all) {
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.travel() < b.travel(); });
    for (auto from = candidates.begin(); from != candidates.end();) {
      const auto to = std::find_if(from, candidates.end(), [&](const Candidate& c) {
        return c.travel() > same_travel * from->travel();
      });
      if (to - from >= 3) out.push_back(comparison(std::get<0>(key), {from, to}));
      from = to;
    }
  }
  return out;
}

}  // namespace nonio::assessment
