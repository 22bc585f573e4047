// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/proposals.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "laboratory/assessment/days.h"
#include "laboratory/assessment/describe.h"
#include "laboratory/assessment/lines.h"
#include "laboratory/assessment/open_values.h"

namespace nonio::assessment {

using nonio::statistics::Found;
using reports::IntervalProposal;
namespace kernel = nonio::statistics;

namespace {

constexpr double days_a_month = days_a_year / 12.0;
constexpr const char *control_chart_name = "control-chart", *staircase_name = "staircase",
                     *fleet_name = "fleet";

void put(IntervalProposal& p, const char* name, double value, Quantity q = Quantity::count) {
  p.why.evidence.push_back({name, value, q});
}

IntervalProposal because(const char* method, const std::string& why) {
  IntervalProposal out;
  out.method = method;
  out.why.id = "interval." + why;
  return out;
}

/// Rounds down to whole months, at least one, so that the interval is supported by the data.
void propose(IntervalProposal& p, double months) {
  constexpr double rounding = 1e-9;
  p.months = std::max(1, static_cast<int>(std::floor(months + rounding)));
}

/// A calibration before this fraction of the interval does not test the interval.
constexpr double early_below = 0.75;

bool is_early(const IntervalFacts& m) { return m.tested < early_below * m.months; }

std::optional<std::pair<Found, std::size_t>> last_found(const AssessedMachine& m) {
  std::optional<std::pair<Found, std::size_t>> worst;
  for (const ShownSeries& s : m.shown) {
    if (s.ended) continue;
    const store::StoredResult* last = nullptr;
    for (const std::size_t i : s.results)
      if (m.stored.results[i].state == "as-found" && !m.stored.results[i].decision.empty())
        last = &m.stored.results[i];
    if (last == nullptr) continue;
    const Found found = last->decision == "conforms"           ? Found::conforms
                        : last->decision == "does not conform" ? Found::fails
                                                               : Found::undecided;
    const std::pair of(found, last->campaign);
    worst = worst ? std::max(*worst, of) : of;
  }
  return worst;
}

using Fleet = std::tuple<std::string, std::string, double>;  // maker, model, interval in months

struct Counted {
  int passed = 0, machines = 0;
};

std::optional<Fleet> fleet_of(const IntervalFacts& m) {
  if (m.model.empty() || !(m.months > 0.0)) return std::nullopt;
  return Fleet(m.maker, m.model, m.months);
}

/// Returns the months since the previous date of measurement; 0 without one.
double tested_until(const AssessedMachine& m, std::size_t campaign) {
  const auto day = day_number(m.stored.campaigns[campaign].day);
  std::optional<std::int64_t> before;
  for (const store::StoredCampaign& c : m.stored.campaigns)
    if (const auto other = day_number(c.day); other && day && *other < *day)
      before = std::max(before.value_or(*other), *other);
  return before ? static_cast<double>(*day - *before) / days_a_month : 0.0;
}

IntervalProposal staircase(const IntervalFacts& m) {
  if (is_early(m) && *m.found == Found::conforms) {
    IntervalProposal out = because(staircase_name, "early");
    propose(out, m.months);
    put(out, "interval", m.months);
    put(out, "tested", std::round(m.tested));
    return out;
  }
  const bool early = is_early(m) && m.tested > 0.0;
  const double tested = early ? std::max(1.0, std::round(m.tested)) : m.months;
  const kernel::Proposal p = kernel::staircase(tested, *m.found, reliability_target);
  IntervalProposal out = because(staircase_name, p.why);
  propose(out, *m.found == Found::undecided ? m.months : p.months.value_or(tested));
  put(out, "interval", tested);
  return out;
}

std::optional<IntervalProposal> fleet(const IntervalFacts& m, const Counted& counted) {
  if (static_cast<std::size_t>(counted.machines) < fewest_of_a_fleet) return std::nullopt;
  const kernel::Proposal p =
      kernel::fleet(m.months, counted.passed, counted.machines, reliability_target);
  if (!p.months || p.why == "fleet-as-it-is") return std::nullopt;
  IntervalProposal out = because(fleet_name, p.why);
  propose(out, *p.months);
  put(out, "interval", m.months);
  put(out, "passed", counted.passed);
  put(out, "machines", counted.machines);
  out.why.texts.emplace_back("model", m.model);
  return out;
}

/// Other changes affect only the uncertainty of the level.
std::optional<std::size_t> last_significant(const FollowedSeries& s) {
  for (std::size_t i = s.trend.changes.size(); i-- > 0;)
    if (s.significant[i]) return s.trend.changes[i].after;
  return std::nullopt;
}

/// Returns the shortest interval after which the forecast of a followed quantity meets its limit;
/// without months if it is shorter than one month. std::nullopt if no forecast meets a limit. Sets
/// `refusal` if the last change of a quantity is not explained.
std::optional<IntervalProposal> chart(const AssessedMachine& m,
                                      std::optional<IntervalProposal>& refusal) {
  std::optional<IntervalProposal> shortest;
  double least = 0.0;
  const auto consider = [&](const FollowedSeries& s, const std::optional<FollowedLimit>& limit) {
    if (s.ended || !limit) return;
    const kernel::Proposal p =
        kernel::control_chart(s.series, s.trend, limit->limit, last_significant(s), limit->beyond);
    const Quantity q = quantity_of_unit(s.unit);
    IntervalProposal one = because(control_chart_name, p.why);
    const bool own = limit->quantity == s.quantity;
    one.axis = s.axis, one.quantity = limit->quantity;
    one.why.texts = {{"what", own ? kind_of(s.quantity) : limit->quantity}, {"axis", s.axis}};
    if (!p.months && p.why == "change-not-explained") refusal = one;
    const bool soon = p.why == "out-already";  // the bound of today is beyond the limit
    if (!soon && (!p.months || p.why != "meets-limit")) return;
    const double months = soon ? 0.0 : *p.months;
    if (shortest && months >= least) return;
    least = months;
    if (least < 1.0) {  // shorter than any interval: measure or repair now
      one.why.id = "interval.out-already";
      one.months.reset();
    } else {
      propose(one, least);
    }
    put(one, "limit", si(limit->limit, q), q);
    shortest = std::move(one);
  };
  for (const FollowedSeries& s : m.followed) consider(s, limit_of(m, s));
  for (const ShownSeries& s : m.shown)
    if (const auto limit = limit_of(m, s); limit && open_results(m.stored, s).empty())
      consider(*s.course, limit);
  return shortest;
}

std::optional<IntervalProposal> out_now(const AssessedMachine& m) {
  std::optional<IntervalProposal> out;
  double worst = 0.0;
  for (const ShownSeries& s : m.shown) {
    if (s.ended) continue;
    for (const Judged& j : open_results(m.stored, s)) {
      const reports::OpenValue v = open_value(m.stored, j.result);
      const double share = v.limit > 0.0 ? std::fabs(*v.value) / v.limit : 0.0;
      if (v.undecided || (out && share <= worst)) continue;
      worst = share;
      out = because(staircase_name, "out-now");
      out->axis = v.axis, out->quantity = v.quantity;
      out->why.texts = {{"place", (v.axis.empty() ? v.measurement : v.axis) + " " + v.quantity}};
      put(*out, "limit", v.limit, v.unit);
    }
  }
  return out;
}

IntervalProposal proposal_of(const IntervalFacts& m, const Counted& counted) {
  constexpr std::uint64_t fewest_campaigns = 2;
  // A machine that is out of tolerance needs a repair instead of an interval.
  if (m.out_now) return *m.out_now;
  if (m.days < fewest_campaigns) {
    IntervalProposal out = because(staircase_name, "few-campaigns");
    put(out, "campaigns", static_cast<double>(m.days));
    return out;
  }
  if (!m.found) return because(staircase_name, "not-judged");
  if (!(m.months > 0.0)) return because(staircase_name, "no-interval");
  IntervalProposal out = staircase(m);
  const auto by_fleet = fleet(m, counted);
  if (by_fleet && (*m.found == Found::conforms || *by_fleet->months < *out.months)) out = *by_fleet;
  if (m.chart && (!m.chart->months || *m.chart->months < *out.months)) out = *m.chart;
  // The duration of an unexplained change is unknown, so no interval is proposed. After a failure,
  // the staircase halves the interval in any case.
  if (m.refusal && *m.found != Found::fails) out = *m.refusal;
  return out;
}

}  // namespace

IntervalFacts interval_facts(const AssessedMachine& machine, std::optional<int> rule) {
  const auto& stated = machine.state.machine.stated;
  IntervalFacts out{stated.maker, stated.model};
  std::set<std::string> days;
  for (const store::StoredCampaign& c : machine.stored.campaigns)
    if (day_number(c.day)) days.insert(c.day);
  out.days = days.size();
  if (rule)
    out.months = *rule;
  else if (const auto usual = usual_interval(machine.stored.campaigns))
    out.months = std::round(static_cast<double>(*usual) / days_a_month);
  if (const auto found = last_found(machine)) {
    out.found = found->first;
    out.tested = tested_until(machine, found->second);
  }
  out.chart = chart(machine, out.refusal);
  out.out_now = out_now(machine);
  return out;
}

std::vector<IntervalProposal> proposals_of(const std::vector<const IntervalFacts*>& machines) {
  std::map<Fleet, Counted> fleets;
  for (const IntervalFacts* m : machines) {
    const auto one = fleet_of(*m);
    if (!one || !m->found || *m->found == Found::undecided || is_early(*m)) continue;
    Counted& counted = fleets[*one];
    ++counted.machines;
    counted.passed += *m->found == Found::conforms;
  }
  std::vector<IntervalProposal> out;
  for (const IntervalFacts* m : machines) {
    const auto one = fleet_of(*m);
    out.push_back(proposal_of(*m, one ? fleets[*one] : Counted{}));
  }
  return out;
}

}  // namespace nonio::assessment
