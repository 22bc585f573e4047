// SPDX-License-Identifier: Apache-2.0
#include "host/morning/site_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "host/morning/describe.h"

namespace nonio::host::morning {

using reports::MonthOfMachine;
using Kind = reports::MorningLine::Kind;

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

std::string name_of(const history::InstrumentAsStated& i) {
  std::string out;
  for (const std::string* part : {&i.maker, &i.model, &i.serial})
    if (!part->empty()) out += (out.empty() ? "" : " ") + *part;
  return out;
}

}  // namespace

std::vector<MonthOfMachine> months_of(const AssessedMachine& m,
                                      const reports::MachineHistory& described) {
  std::vector<MonthOfMachine> out;
  Months months(m.state.machine.name);
  for (const history::StoredCampaign& c : m.stored.campaigns)
    if (c.day.size() == 10) months.at(c.day).measured = true;
  for (const ShownSeries& s : m.shown)
    for (const std::size_t r : s.results) {
      const history::StoredResult& result = m.stored.results[r];
      const std::string& day = m.stored.campaigns[result.campaign].day;
      if (result.decision.empty() || result.decision == "conforms") continue;
      months.grave(day, result.decision == "does not conform" ? Kind::out : Kind::undecided);
    }
  for (const reports::HistorySeries& s : described.series)
    for (const reports::HistoryChange& c : s.changes)
      if (c.cause == "undeclared") months.grave(c.before, Kind::changed);
  for (const config::Event& e : m.events) months.at(e.date).event = true;
  months.append_to(out);
  return out;
}

std::vector<reports::InstrumentUse> instruments_of(const AssessedMachine& m,
                                                   const std::filesystem::path& out) {
  std::map<UseKey, reports::InstrumentUse> all;
  const Links links(out);
  for (const history::StoredCampaign& c : m.stored.campaigns) {
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

const reports::HistoryPoint* compared_point(const reports::HistorySeries& s) {
  if (s.model.empty() || s.ended) return nullptr;
  const auto last = std::find_if(s.points.rbegin(), s.points.rend(), [](const auto& p) {
    return p.joined && p.state != reports::HistoryPoint::State::as_left;
  });
  return last == s.points.rend() ? nullptr : &*last;
}

std::vector<reports::ModelComparison> comparisons_of(
    const std::vector<reports::MachineHistory>& described) {
  std::map<std::tuple<std::string, std::string, std::string, Quantity>, reports::ModelComparison>
      all;
  for (const reports::MachineHistory& m : described) {
    if (m.model.empty()) continue;
    for (const reports::HistorySeries& s : m.series) {
      const reports::HistoryPoint* last = compared_point(s);
      if (last == nullptr) continue;
      reports::ModelComparison& c = all[{m.model, s.axis, s.quantity, s.unit}];
      c.model = m.model, c.axis = s.axis, c.quantity = s.quantity, c.unit = s.unit;
      c.machines.push_back({m.id, last->value, last->u});
    }
  }
  std::vector<reports::ModelComparison> out;
  for (auto& [key, c] : all) {
    if (c.machines.size() < 3) continue;
    std::vector<double> values, distances;
    for (const auto& of : c.machines) values.push_back(of.value);
    const double middle = median(values);
    for (const double v : values) distances.push_back(std::fabs(v - middle));
    const double spread = 1.4826 * median(distances);
    for (auto& of : c.machines) of.z = spread > 0.0 ? (of.value - middle) / spread : 0.0;
    out.push_back(std::move(c));
  }
  return out;
}

}  // namespace nonio::host::morning
