// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/table_changes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "laboratory/statistics/table_change.h"
#include "platform/storage/json_values.h"

namespace nonio::assessment {

namespace kernel = nonio::statistics;
using storage::Json;
using store::StoredTables;

namespace {

/// Number of latest tables that are tried, because older ones are hardly ever loaded again.
constexpr std::size_t most_known = 8;

std::vector<double> numbers(const Json& of, const char* name, bool rotary, bool position) {
  const std::string key =
      std::string(name) + (position ? (rotary ? "_deg" : "_mm") : (rotary ? "_arcsec" : "_um"));
  std::vector<double> out;
  if (const auto found = of.find(key); found != of.end() && found->is_array())
    for (const Json& one : *found)
      if (one.is_number()) out.push_back(one.get<double>());
  return out;
}

kernel::TableCurve table_of(const Json& of, bool rotary) {
  kernel::TableCurve t{numbers(of, "position", rotary, true), numbers(of, "plus", rotary, false),
                       numbers(of, "minus", rotary, false)};
  const std::size_t n = t.position.size();
  if (t.plus.size() != n || (!t.minus.empty() && t.minus.size() != n)) return {};
  if (rotary) t.repeat_after(360.0);
  return t;
}

struct Known {
  std::string day;
  kernel::TableCurve table;
};

struct Taken {
  std::size_t campaign = 0;
  std::string state, measurement;
  bool rotary = false;
  kernel::MeasuredCurve curve;
  std::optional<kernel::TableCurve> active, written;
  std::vector<Known> recorded;
  std::optional<double> backlash;  ///< active value, m or rad
  /// Standard uncertainty of the slope without contributions of the instrument, um/mm or
  /// arcsec/deg.
  double u_slope = 0.0;
};

std::optional<Taken> taken(const AssessedMachine& m, const StoredTables& stored) {
  const Json json = storage::parse_or_discard(stored.json);
  if (!json.is_object()) return std::nullopt;
  Taken out;
  out.campaign = stored.campaign, out.measurement = stored.measurement;
  out.state = json.value("state", std::string());
  out.rotary = json.contains("position_deg");
  const bool rotary = out.rotary;
  out.curve = {numbers(json, "position", rotary, true), numbers(json, "plus", rotary, false),
               numbers(json, "minus", rotary, false),
               json.value(rotary ? "u_arcsec" : "u_um", 0.0)};
  const std::size_t n = out.curve.position.size();
  for (const auto* of : {&out.curve.plus, &out.curve.minus})
    if (!of->empty() && of->size() != n) return std::nullopt;
  if (n < 3) return std::nullopt;
  if (const auto found = json.find("active"); found != json.end()) {
    out.active = table_of(*found, rotary);
    const Quantity q = deviation_of(rotary);
    const auto backlash = found->find("backlash" + std::string(unit_of(q).suffix));
    if (backlash != found->end() && backlash->is_number())
      out.backlash = backlash->get<double>() / unit_of(q).per_si;
  }
  if (const auto found = json.find("written"); found != json.end())
    out.written = table_of(*found, rotary);
  if (const auto found = json.find("recorded"); found != json.end() && found->is_array())
    for (const Json& one : *found)
      out.recorded.push_back({one.value("since", std::string()), table_of(one, rotary)});
  for (const store::StoredResult& r : m.stored.results) {
    if (!r.followed || r.campaign != stored.campaign || r.measurement != stored.measurement ||
        r.quantity != "scale")
      continue;
    double variance = r.u_repeat.value_or(0.0) * r.u_repeat.value_or(0.0);
    for (const store::CommonPart& c : r.common)
      if (!c.source.starts_with("instrument")) variance += c.u * c.u;
    out.u_slope = std::sqrt(variance) * (rotary ? 1.0 : 1e-3);
  }
  return out;
}

bool is_same(const kernel::TableCurve& a, const kernel::TableCurve& b) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const auto* t : {&a, &b})
    for (const double x : t->position)
      for (const int direction : {1, -1}) {
        const double d = a.at(x, direction) - b.at(x, direction);
        low = std::min(low, d), high = std::max(high, d);
      }
  return high - low < change_resolution;
}

class LoadedOnAxis {
 public:
  LoadedOnAxis(const AssessedMachine& m, std::string axis, std::vector<Taken> all)
      : m_(m), axis_(std::move(axis)), all_(std::move(all)) {
    std::stable_sort(all_.begin(), all_.end(),
                     [&](const Taken& a, const Taken& b) { return key(a) < key(b); });
  }

  std::vector<reports::TableLoaded> find() const {
    std::vector<reports::TableLoaded> out;
    for (std::size_t i = 0; i + 1 < all_.size(); ++i)
      if (auto one = between(all_[i], all_[i + 1], i)) out.push_back(std::move(*one));
    return out;
  }

  std::vector<BacklashChange> backlash_changes() const {
    std::vector<BacklashChange> out;
    for (std::size_t i = 0; i + 1 < all_.size(); ++i) {
      const Taken &before = all_[i], &after = all_[i + 1];
      if (before.backlash && after.backlash && *before.backlash != *after.backlash)
        out.push_back({of_pair(before, after), *after.backlash - *before.backlash});
    }
    return out;
  }

  std::vector<reports::TableLoaded> unstated() const {
    std::vector<reports::TableLoaded> out;
    for (std::size_t i = 0; i + 1 < all_.size(); ++i) {
      const Taken &before = all_[i], &after = all_[i + 1];
      const std::vector<Known> those = known(i, after);
      if (before.active && after.active) continue;
      out.push_back(of_pair(before, after));
      out.back().kind = "unknown";
      if (!those.empty()) out.back().table = those.back().day;
      put_nearest(before, after, those, out.back());
      const Taken& open = after.active ? before : after;
      out.back().before_campaign = m_.stored.campaigns[open.campaign].id;
    }
    return out;
  }

 private:
  /// Stores the table that explains most of the change, if the RMS of the rest is at most half of
  /// the RMS of the change.
  static void put_nearest(const Taken& before, const Taken& after, const std::vector<Known>& those,
                          reports::TableLoaded& out) {
    constexpr double most_left = 0.5;
    std::vector<kernel::TableCurve> curves;
    for (const Known& k : those) curves.push_back(k.table);
    const auto near =
        kernel::nearest(before.curve, after.curve, before.active, curves, change_resolution);
    if (!near || near->left > most_left * near->rms) return;
    out.table = those[near->table].day;
    out.rms = near->rms / unit_of(out.unit).per_si,
    out.left = near->left / unit_of(out.unit).per_si;
  }

  const std::string& day(const Taken& t) const { return m_.stored.campaigns[t.campaign].day; }
  std::tuple<const std::string&, bool, std::size_t> key(const Taken& t) const {
    return {day(t), t.state == "as-left", t.campaign};
  }

  static void add(std::vector<Known>& known, const std::string& day,
                  const std::optional<kernel::TableCurve>& table) {
    if (!table || table->empty()) return;
    for (const Known& k : known)
      if (is_same(k.table, *table)) return;
    known.push_back({day, *table});
  }

  /// Returns the last `most_known` tables: written by earlier campaigns, recorded up to the date of
  /// the later campaign, or active.
  std::vector<Known> known(std::size_t last, const Taken& after) const {
    std::vector<Known> out;
    for (std::size_t k = 0; k <= last; ++k) add(out, day(all_[k]), all_[k].written);
    for (const Taken& t : all_)
      for (const Known& k : t.recorded)
        if (k.day <= day(after)) add(out, k.day, k.table);
    for (std::size_t k = 0; k <= last; ++k)
      if (all_[k].active) add(out, day(all_[k]), all_[k].active);
    if (out.size() > most_known)
      out.erase(out.begin(), out.end() - static_cast<std::ptrdiff_t>(most_known));
    return out;
  }

  std::optional<reports::TableLoaded> between(const Taken& before, const Taken& after,
                                              std::size_t last) const {
    if (before.rotary != after.rotary) return std::nullopt;
    const std::vector<Known> all_known = known(last, after);
    if (all_known.empty()) return std::nullopt;
    std::vector<kernel::TableCurve> curves;
    for (const Known& k : all_known) curves.push_back(k.table);
    const double usual = usual_scale_change(before.rotary);
    const auto found =
        kernel::recognize(before.curve, after.curve, before.active, curves,
                          std::hypot(before.u_slope, after.u_slope, usual), change_resolution);
    if (!found) return stated(before, after, all_known);
    reports::TableLoaded out = of_pair(before, after);
    out.kind = loading_name(found->loading), out.points = found->points;
    const double per = unit_of(out.unit).per_si;
    out.rms = found->rms / per, out.left = found->left / per;
    if (found->loading != kernel::Loading::removed) out.table = all_known[found->table].day;
    out.is_stated = found->loading == kernel::Loading::loaded && after.active &&
                    is_same(*after.active, curves[found->table]);
    if (found->loading == kernel::Loading::removed)
      out.is_stated = after.active && after.active->empty();
    return out;
  }

  /// The RMS is NaN, because the shape of the change does not show the table.
  std::optional<reports::TableLoaded> stated(const Taken& before, const Taken& after,
                                             const std::vector<Known>& all_known) const {
    if (!before.active || !after.active || is_same(*before.active, *after.active))
      return std::nullopt;
    reports::TableLoaded out = of_pair(before, after);
    out.kind = after.active->empty() ? "removed" : "loaded";
    for (const Known& k : all_known)
      if (is_same(k.table, *after.active)) out.table = k.day;
    out.rms = out.left = std::numeric_limits<double>::quiet_NaN();
    out.is_stated = true;
    return out;
  }

  reports::TableLoaded of_pair(const Taken& before, const Taken& after) const {
    reports::TableLoaded out;
    out.axis = axis_;
    out.after = day(before), out.before = day(after);
    out.after_campaign = m_.stored.campaigns[before.campaign].id;
    out.before_campaign = m_.stored.campaigns[after.campaign].id;
    out.unit = before.rotary ? Quantity::angular_deviation : Quantity::deviation;
    return out;
  }

  const AssessedMachine& m_;
  std::string axis_;
  std::vector<Taken> all_;
};

std::map<std::string, std::vector<Taken>> by_axis(const AssessedMachine& m) {
  std::map<std::string, std::vector<Taken>> out;
  for (const StoredTables& s : m.stored.tables)
    if (auto one = taken(m, s)) out[s.axis].push_back(std::move(*one));
  return out;
}

}  // namespace

const char* loading_name(statistics::Loading loading) {
  switch (loading) {
    case kernel::Loading::loaded:
      return "loaded";
    case kernel::Loading::removed:
      return "removed";
    case kernel::Loading::wrong_sign:
      return "wrong-sign";
    case kernel::Loading::twice:
      return "twice";
    case kernel::Loading::in_addition:
      return "in-addition";
    case kernel::Loading::offset:
      break;
  }
  return "offset";
}

double usual_scale_change(bool rotary) { return rotary ? 0.002 : 0.5e-3; }

std::vector<reports::TableLoaded> tables_loaded(const AssessedMachine& m) {
  std::vector<reports::TableLoaded> out;
  for (auto& [axis, all] : by_axis(m))
    for (reports::TableLoaded& one : LoadedOnAxis(m, axis, std::move(all)).find())
      out.push_back(std::move(one));
  return out;
}

std::vector<BacklashChange> backlash_changes(const AssessedMachine& m) {
  std::vector<BacklashChange> out;
  for (auto& [axis, all] : by_axis(m))
    for (BacklashChange& one : LoadedOnAxis(m, axis, std::move(all)).backlash_changes())
      out.push_back(std::move(one));
  return out;
}

std::vector<reports::TableLoaded> tables_unstated(const AssessedMachine& m) {
  std::vector<reports::TableLoaded> out;
  for (auto& [axis, all] : by_axis(m))
    for (reports::TableLoaded& one : LoadedOnAxis(m, axis, std::move(all)).unstated())
      out.push_back(std::move(one));
  return out;
}

}  // namespace nonio::assessment
