// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/series.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "laboratory/assessment/days.h"
#include "platform/storage/json_values.h"

namespace nonio::assessment {

namespace {

using storage::Json;

// Largest difference of equal positions, as a fraction of the span.
constexpr double same_place = 0.01;
bool near(double a, double b, double span) { return std::fabs(a - b) <= same_place * span; }

double number_at(const Json& o, const char* key) {
  const auto it = o.find(key);
  return it != o.end() && it->is_number() ? it->get<double>() : 0.0;
}

/// Returns the id of the difference that prevents a common series; empty if there is none. A table
/// that is switched on or off is a known step and no such difference. With `common_stretch`,
/// different ends are none either.
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
  Json json = storage::parse_or_discard(conditions);
  return json.is_object() ? json : Json::object();
}

std::string compensation(const Json& conditions) {
  const auto it = conditions.find("compensation");
  return it != conditions.end() && it->is_string() ? it->get<std::string>() : "";
}

bool stepped_by_table(const std::string& before, const std::string& after) {
  return !before.empty() && !after.empty() && before != after;
}

using store::StoredMachine;
using store::StoredResult;
namespace kernel = nonio::statistics;

/// Smallest part of the longer span that the common stretch must cover.
constexpr double least_in_common = 0.5;

/// Returns the source of uncertainty of the instrument with its certificate, or an empty text.
std::string instrument_in(const StoredResult& r) {
  for (const store::CommonPart& c : r.common)
    if (c.source.starts_with("instrument")) return c.source;
  return {};
}

/// Returns for each result the FNV-1a hash of the campaigns and quantities up to this result, which
/// is the seed of the series up to this point.
std::vector<std::uint64_t> seeds_of(const StoredMachine& m,
                                    const std::vector<std::size_t>& results) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  std::vector<std::uint64_t> out;
  for (const std::size_t i : results) {
    for (const std::string* text : {&m.campaigns[m.results[i].campaign].id, &m.results[i].quantity})
      for (const char c : *text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    out.push_back(hash);
  }
  return out;
}

/// Replaces each variance by its mean with the median of the series, because u is estimated from
/// few runs, and a u that is small by chance would turn noise into a step.
void pool(std::vector<kernel::Point>& points) {
  std::vector<double> variances;
  for (const kernel::Point& p : points) variances.push_back(p.u * p.u);
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  for (kernel::Point& p : points) p.u = std::sqrt((p.u * p.u + *middle) / 2.0);
}

/// Results are ordered by date, as found before as left, campaign and position in the manifest.
bool before(const StoredMachine& m, std::size_t a, std::size_t b) {
  const auto key = [&](std::size_t i) {
    const StoredResult& r = m.results[i];
    const store::StoredCampaign& c = m.campaigns[r.campaign];
    return std::tuple<const std::string&, bool, const std::string&, std::size_t>(
        c.day, r.state == "as-left", c.id, i);
  };
  return key(a) < key(b);
}

bool concerns(const config::Event& e, const FollowedSeries& s) {
  if (e.concerns(s.axis)) return true;
  const auto colon = s.quantity.find(':');  // squareness:XY refers to X and Y
  return colon != std::string::npos &&
         s.quantity.substr(colon + 1).substr(0, s.quantity.find('.', colon)).find(e.axis) !=
             std::string::npos;
}

class Happenings {
 public:
  Happenings(const StoredMachine& m, const std::vector<config::Event>& events, FollowedSeries& s)
      : m_(m), events_(events), s_(s) {}

  void declare() {
    const std::size_t gaps = s_.results.size() - 1;
    std::vector<bool> table(gaps, false);
    for (std::size_t k = 0; k < gaps; ++k)
      if (const std::string what = table_between(k); !what.empty()) {
        table[k] = true;
        put(k, kernel::Declared::Kind::table, "table", what);
      }
    for (std::size_t k = 0; k < gaps; ++k)
      for (const config::Event& e : events_)
        if (!table[k] && is_between(e, k) && !on_day_of_table(e, table)) put_event(k, e);
    for (std::size_t k = 0; k < gaps; ++k) {
      const std::string one = instrument_in(result(k)), other = instrument_in(result(k + 1));
      if (!one.empty() && !other.empty() && one != other)
        put(k, kernel::Declared::Kind::instrument, "instrument", other);
    }
  }

 private:
  const StoredResult& result(std::size_t k) const { return m_.results[s_.results[k]]; }
  const std::string& day(std::size_t k) const { return m_.campaigns[result(k).campaign].day; }

  /// Returns the reason of a known step after point k: an adjustment (as found, as left), a change
  /// within one campaign, or a table that was switched on or off; otherwise empty.
  std::string table_between(std::size_t k) const {
    const StoredResult &a = result(k), &b = result(k + 1);
    if (b.state == "as-left") return "as-left";
    if (a.campaign == b.campaign) return "within the campaign";
    if (a.conditions == b.conditions) return {};
    const std::string one = compensation(parsed(a.conditions)),
                      other = compensation(parsed(b.conditions));
    return stepped_by_table(one, other) ? "compensation " + other : "";
  }

  bool is_between(const config::Event& e, std::size_t k) const {
    return concerns(e, s_) && day(k) <= e.date && e.date <= day(k + 1);
  }

  /// Whether the event has the date of a campaign before or after an adjustment in `table`, which
  /// already represents this event.
  bool on_day_of_table(const config::Event& e, const std::vector<bool>& table) const {
    for (std::size_t k = 0; k < table.size(); ++k)
      if (table[k] && (day(k) == e.date || day(k + 1) == e.date)) return true;
    return false;
  }

  void put_event(std::size_t k, const config::Event& e) {
    put(k,
        e.kind == "compensation" ? kernel::Declared::Kind::table
        : e.kind == "instrument" ? kernel::Declared::Kind::instrument
                                 : kernel::Declared::Kind::event,
        e.kind, e.text);
  }

  void put(std::size_t k, kernel::Declared::Kind kind, std::string name, std::string said) {
    s_.series.declared.push_back({k, kind});
    s_.kinds.push_back(std::move(name));
    s_.said.push_back(std::move(said));
  }

  const StoredMachine& m_;
  const std::vector<config::Event>& events_;
  FollowedSeries& s_;
};

class Joining {
 public:
  Joining(const StoredMachine& m, const std::vector<std::optional<StoredTargets>>& targets,
          std::vector<std::size_t> results)
      : m_(m), targets_(targets) {
    std::sort(results.begin(), results.end(),
              [&](std::size_t a, std::size_t b) { return before(m_, a, b); });
    for (const std::size_t i : results) put(i);
  }

  std::vector<FollowedSeries> take(const std::vector<config::Event>& events) {
    std::vector<FollowedSeries> out;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      FollowedSeries s = series(groups_[g].results);
      for (std::size_t h = 0; h < groups_.size(); ++h) {
        if (h == g) continue;
        const bool earlier = last_day(groups_[h]) < first_day(groups_[g]);
        if (earlier && m_.results[groups_[h].results.front()].unit == s.unit)
          for (const std::size_t i : groups_[h].results)
            s.apart.push_back({i, difference(groups_[g].conditions, groups_[h].conditions,
                                             have_in_common(groups_[g], groups_[h]))});
        if (first_day(groups_[h]) > last_day(groups_[g])) s.ended = true;
      }
      for (FollowedSeries::Apart& a : s.apart)
        if (a.why.empty()) a.why = "other";
      if (s.results.size() > 1) Happenings(m_, events, s).declare();
      out.push_back(std::move(s));
    }
    return out;
  }

 private:
  struct Group {
    Json conditions;
    std::vector<std::size_t> results;
    /// Stretch common to all results; std::nullopt if targets are unknown. `longest` is the longest
    /// span.
    std::optional<kernel::Stretch> common{};
    double longest = 0.0;
  };

  const StoredTargets* targets(std::size_t result) const {
    const StoredResult& r = m_.results[result];
    return r.targets && targets_[*r.targets] ? &*targets_[*r.targets] : nullptr;
  }

  Group group_of(std::size_t result, Json conditions) const {
    Group out{std::move(conditions), {result}};
    if (const StoredTargets* own = targets(result))
      out.common = own->span, out.longest = own->span.length();
    return out;
  }

  static bool have_in_common(const Group& a, const Group& b) {
    return a.common && b.common &&
           kernel::common_stretch(*a.common, *b.common).length() >=
               least_in_common * std::max(a.longest, b.longest);
  }

  static void join(Group& to, const Group& other) {
    to.results.insert(to.results.end(), other.results.begin(), other.results.end());
    if (to.common && other.common)
      to.common = kernel::common_stretch(*to.common, *other.common);
    else
      to.common.reset();
    to.longest = std::max(to.longest, other.longest);
  }

  /// Whether two campaigns have the same readings: one of them was renamed.
  bool is_renamed(std::size_t a, std::size_t b) const {
    const StoredResult &one = m_.results[a], &other = m_.results[b];
    return one.campaign != other.campaign && one.measurement == other.measurement &&
           one.value == other.value && one.u_repeat == other.u_repeat;
  }

  /// Adds a result to a group. Of a campaign that was renamed, only the last evaluation is used.
  void append(Group& g, std::size_t i) const {
    const auto campaign = [&](std::size_t k) -> const store::StoredCampaign& {
      return m_.campaigns[m_.results[k].campaign];
    };
    for (auto k = g.results.rbegin(); k != g.results.rend() && campaign(*k).day == campaign(i).day;
         ++k)
      if (is_renamed(*k, i)) {
        if (campaign(i).evaluation > campaign(*k).evaluation) *k = i;
        return;
      }
    g.results.push_back(i);
  }

  void put(std::size_t i) {
    const StoredResult& r = m_.results[i];
    if (!(r.u_repeat.value_or(0.0) > 0.0) || !std::isfinite(r.value) ||
        !day_number(m_.campaigns[r.campaign].day))
      return;
    // The texts are compared first, because most campaigns state the same conditions.
    for (Group& g : groups_) {
      const StoredResult& first = m_.results[g.results.front()];
      if (first.unit == r.unit && first.conditions == r.conditions) {
        append(g, i);
        if (targets(i) == nullptr) g.common.reset();
        return;
      }
    }
    Group alone = group_of(i, parsed(r.conditions));
    for (Group& g : groups_)
      if (m_.results[g.results.front()].unit == r.unit &&
          difference(g.conditions, alone.conditions, have_in_common(g, alone)).empty()) {
        join(g, alone);
        return;
      }
    groups_.push_back(std::move(alone));
  }

  const std::string& first_day(const Group& g) const {
    return m_.campaigns[m_.results[g.results.front()].campaign].day;
  }
  const std::string& last_day(const Group& g) const {
    return m_.campaigns[m_.results[g.results.back()].campaign].day;
  }

  FollowedSeries series(const std::vector<std::size_t>& results) const {
    const StoredResult& any = m_.results[results.front()];
    FollowedSeries s{.axis = any.axis,
                     .quantity = any.quantity,
                     .unit = any.unit,
                     .results = results,
                     .series = {}};
    for (const std::size_t i : results) {
      const StoredResult& r = m_.results[i];
      const store::StoredCampaign& c = m_.campaigns[r.campaign];
      kernel::Point p{static_cast<double>(*day_number(c.day)) / days_a_year, r.value, *r.u_repeat};
      for (const store::CommonPart& part : r.common) p.common.push_back({part.source, part.u});
      s.stated.push_back(std::move(p));
      if (const StoredTargets* own = targets(i))
        s.targets.push_back(targets_of(*own, s.quantity, r.place));
      s.run = std::max(s.run, c.run);
      s.evaluations.push_back(static_cast<std::uint64_t>(c.evaluation));
    }
    if (s.targets.size() < s.stated.size()) s.targets.clear();
    Compared points = compared(s.stated, s.targets, s.quantity);
    s.series.points = std::move(points.points), s.over = points.over;
    pool(s.series.points);
    s.seeds = seeds_of(m_, results);
    s.series.seed = s.seeds.back();
    s.series.own_slope = true;
    return s;
  }

  const StoredMachine& m_;
  const std::vector<std::optional<StoredTargets>>& targets_;
  std::vector<Group> groups_;
};

/// Followed quantities without a limit have a series already.
bool is_shown(const StoredResult& r) {
  return r.tolerance || !(r.quantity == "B_mean" || r.quantity.starts_with("centre_") ||
                          r.quantity.starts_with("direction_"));
}

std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> by_quantity(
    const StoredMachine& m, bool followed) {
  std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> out;
  for (std::size_t i = 0; i < m.results.size(); ++i)
    if (m.results[i].followed == followed && (followed || is_shown(m.results[i])))
      out[{m.results[i].axis, m.results[i].quantity}].push_back(i);
  return out;
}

/// Results of several measurements of one quantity in one state, such as of two lines of an axis, are
/// a series for each line that most campaigns measured, with its states; else the first of each
/// campaign and state is followed. What follows a space in the id of a measurement is its state,
/// unless most campaigns have two of one state that differ by it only.
std::map<std::string, std::vector<std::size_t>> lines_apart(const StoredMachine& m,
                                                            std::vector<std::size_t> results) {
  using OfState = std::map<std::pair<std::size_t, std::string>, std::set<std::string>>;
  OfState whole, begun;
  const auto beginning = [](const std::string& id) { return id.substr(0, id.find(' ')); };
  std::set<std::size_t> campaigns;
  for (const std::size_t i : results) {
    const StoredResult& r = m.results[i];
    campaigns.insert(r.campaign);
    whole[{r.campaign, r.state}].insert(r.measurement);
    begun[{r.campaign, r.state}].insert(beginning(r.measurement));
  }
  if (std::all_of(whole.begin(), whole.end(), [](const auto& of) { return of.second.size() < 2; }))
    return {{"", std::move(results)}};
  const bool by_beginning = std::all_of(whole.begin(), whole.end(), [&](const auto& of) {
    return begun[of.first].size() == of.second.size();
  });
  const OfState& lines_in = by_beginning ? begun : whole;
  const auto line_of = [&](std::size_t i) {
    const std::string& id = m.results[i].measurement;
    return by_beginning ? beginning(id) : id;
  };
  std::map<std::string, std::set<std::size_t>> campaigns_of;
  for (const std::size_t i : results) campaigns_of[line_of(i)].insert(m.results[i].campaign);
  bool alike = campaigns.size() > 1;
  for (const auto& [line, of] : campaigns_of) alike = alike && 2 * of.size() > campaigns.size();
  for (const auto& [of, lines] : lines_in)  // an adjustment concerns all lines, or is not followed
    alike = alike && (of.second != "as-left" || lines.size() == campaigns_of.size());
  if (!alike && !by_beginning) return {{"", std::move(results)}};
  std::map<std::string, std::vector<std::size_t>> lines;
  for (const std::size_t i : results) {
    const StoredResult& r = m.results[i];
    if (alike)
      lines[line_of(i)].push_back(i);
    else if (line_of(i) == *lines_in.at({r.campaign, r.state}).begin())
      lines[""].push_back(i);
  }
  return lines;
}

}  // namespace

std::vector<FollowedSeries> followed_series(const StoredMachine& machine,
                                            const std::vector<config::Event>& events) {
  std::vector<FollowedSeries> out;
  const auto targets = read_targets(machine.other_targets);
  for (auto& [key, results] : by_quantity(machine, true))
    for (auto& [line, own] : lines_apart(machine, std::move(results)))
      for (FollowedSeries& s : Joining(machine, targets, std::move(own)).take(events)) {
        s.line = line;
        out.push_back(std::move(s));
      }
  return out;
}

namespace {

/// Returns 0 if the result conforms or has no decision, 1 if it is indeterminate, 2 if it does not
/// conform.
int gravity(const StoredResult& r) {
  if (r.decision.empty() || r.decision == "conforms") return 0;
  return r.decision == "does not conform" ? 2 : 1;
}

double share_of_limit(const StoredResult& r) {
  return r.tolerance && *r.tolerance > 0.0 ? std::fabs(r.value) / *r.tolerance : 0.0;
}

/// Returns the deciding result of each campaign with a limit. `results` must be in the order of
/// `before`.
std::vector<std::size_t> deciding(const StoredMachine& m, const std::vector<std::size_t>& results) {
  const auto decides = [&](const StoredResult& a, const StoredResult& b) {
    const auto key = [](const StoredResult& r) {
      return std::tuple(r.state == "as-left", gravity(r), share_of_limit(r));
    };
    return key(a) > key(b);
  };
  std::vector<std::size_t> out;
  for (const std::size_t i : results) {
    if (m.results[i].decision.empty()) continue;
    if (out.empty() || m.results[out.back()].campaign != m.results[i].campaign)
      out.push_back(i);
    else if (decides(m.results[i], m.results[out.back()]))
      out.back() = i;
  }
  return out;
}

/// Of the measurement that was judged last, and of others with its limit. `results` are in the order of
/// `before`.
std::optional<FollowedSeries> course_of(const StoredMachine& m,
                                        const std::vector<std::size_t>& results,
                                        const StoredResult& judged,
                                        const std::vector<config::Event>& events) {
  FollowedSeries s{.axis = judged.axis,
                   .quantity = judged.quantity,
                   .unit = judged.unit,
                   .results = {},
                   .series = {}};
  for (const std::size_t i : results) {
    const StoredResult& r = m.results[i];
    if (r.source != judged.source || r.conditions != judged.conditions ||
        !(r.tolerance == judged.tolerance || r.measurement == judged.measurement) ||
        !std::isfinite(r.value) || !(r.expanded.value_or(0.0) > 0.0) ||
        !day_number(m.campaigns[r.campaign].day))
      continue;
    const StoredResult* same = s.results.empty() ? nullptr : &m.results[s.results.back()];
    if (same == nullptr || same->campaign != r.campaign || same->state != r.state)
      s.results.push_back(i);
    else if (std::fabs(r.value) > std::fabs(same->value))
      s.results.back() = i;
  }
  if (s.results.empty()) return std::nullopt;
  for (const std::size_t i : s.results) {
    const StoredResult& r = m.results[i];
    s.series.points.push_back(
        {static_cast<double>(*day_number(m.campaigns[r.campaign].day)) / days_a_year, r.value,
         *r.expanded / r.k.value_or(2.0)});
  }
  s.seeds = seeds_of(m, s.results);
  s.series.seed = s.seeds.back(), s.series.own_slope = true;
  if (s.results.size() > 1) Happenings(m, events, s).declare();
  auto trend = kernel::trend_of(s.series);
  if (!trend) return std::nullopt;
  s.trend = std::move(*trend);
  // Changes are those of the followed quantities.
  s.significant.assign(s.trend.changes.size(), false);
  return s;
}

}  // namespace

kernel::Series first_points(const FollowedSeries& s, std::size_t count) {
  kernel::Series known = s.series;
  if (count >= known.points.size()) return known;
  known.points.clear();
  std::erase_if(known.declared, [&](const kernel::Declared& d) { return d.after + 1 >= count; });
  if (count == 0) return known;
  const std::vector<kernel::Point> first(s.stated.begin(),
                                         s.stated.begin() + static_cast<std::ptrdiff_t>(count));
  known.points = compared(first, s.targets, s.quantity).points;
  pool(known.points);
  known.seed = s.seeds[count - 1];
  return known;
}

std::vector<kernel::Point> compared_points(const FollowedSeries& s) {
  return compared(s.stated, s.targets, s.quantity).points;
}

std::vector<ShownSeries> shown_series(const StoredMachine& machine,
                                      const std::vector<config::Event>& events) {
  std::vector<ShownSeries> out;
  for (auto& [key, results] : by_quantity(machine, false)) {
    std::sort(results.begin(), results.end(),
              [&](std::size_t a, std::size_t b) { return before(machine, a, b); });
    // Values in um and in arcsec are not comparable: the axis was changed between linear and
    // rotary.
    std::map<std::string, std::vector<std::size_t>> of_unit;
    for (const std::size_t i : results) of_unit[machine.results[i].unit].push_back(i);
    const std::string& last = machine.results[results.back()].unit;
    for (auto& [unit, own] : of_unit) {
      ShownSeries s{key.first, key.second, unit, own, deciding(machine, own)};
      s.ended = unit != last;
      if (!s.ended && !s.judged.empty())
        s.course = course_of(machine, own, machine.results[s.judged.back()], events);
      out.push_back(std::move(s));
    }
  }
  return out;
}

MachineNames::MachineNames(const std::vector<store::MachineState>& all,
                           const store::StoredLogs& logs)
    : logs_(logs) {
  for (const store::MachineState& m : all)
    for (const std::string& serial : m.serials) {
      const auto [at, is_new] = named_.try_emplace(serial, &m.machine.name);
      if (!is_new) at->second = nullptr;
    }
  for (const store::MachineState& m : all) named_[m.machine.name] = &m.machine.name;
}

const std::string* MachineNames::of(const std::string& stated) const {
  const auto alias = logs_.aliases.find(stated);
  const auto found = named_.find(alias == logs_.aliases.end() ? stated : alias->second);
  return found == named_.end() ? nullptr : found->second;
}

MachineEvents::MachineEvents(const std::vector<store::MachineState>& all,
                             const store::StoredLogs& logs) {
  const MachineNames names(all, logs);
  for (const config::Event& e : logs.events)
    if (const std::string* machine = names.of(e.machine))
      by_machine_[*machine].push_back(e);
    else
      of_none_.push_back(e);
}

const std::vector<config::Event>& MachineEvents::of(const std::string& machine) const {
  static const std::vector<config::Event> none;
  const auto found = by_machine_.find(machine);
  return found == by_machine_.end() ? none : found->second;
}

}  // namespace nonio::assessment
