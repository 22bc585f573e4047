// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/describe.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "campaign/evaluation/record.h"
#include "laboratory/assessment/days.h"
#include "laboratory/assessment/lines.h"
#include "laboratory/assessment/open_values.h"
#include "laboratory/assessment/table_changes.h"
#include "laboratory/assessment/tables_kept.h"
#include "laboratory/statistics/forecast.h"
#include "nonio/sdk/units.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"

namespace nonio::assessment {
namespace fs = std::filesystem;
namespace kernel = nonio::statistics;
using reports::HistoryPoint;
using reports::HistorySeries;
using store::StoredCampaign;
using store::StoredResult;

namespace {

HistoryPoint::State state_of(const std::string& text) {
  if (text == "as-left") return HistoryPoint::State::as_left;
  return text == "check" ? HistoryPoint::State::check : HistoryPoint::State::as_found;
}

const char* name_of(kernel::Model model) {
  switch (model) {
    case kernel::Model::level:
      return "level";
    case kernel::Model::drift:
      return "drift";
    case kernel::Model::step:
      return "step";
    case kernel::Model::walk:
      return "walk";
    case kernel::Model::none:
      break;
  }
  return "none";
}

const char* name_of(kernel::Change::Cause cause) {
  switch (cause) {
    case kernel::Change::Cause::event:
      return "event";
    case kernel::Change::Cause::instrument:
      return "instrument";
    case kernel::Change::Cause::table:
      return "table";
    case kernel::Change::Cause::undeclared:
      break;
  }
  return "undeclared";
}

const char* name_of(kernel::Answer answer) {
  switch (answer) {
    case kernel::Answer::keep:
      return "keep";
    case kernel::Answer::watch:
      return "watch";
    case kernel::Answer::act:
      return "act";
    case kernel::Answer::cannot_say:
      break;
  }
  return "cannot-say";
}

class Describing {
 public:
  Describing(const AssessedMachine& m, const fs::path& out, const std::string& due,
             const std::string& today)
      : m_(m), today_(today) {
    if (const auto day = day_number(due)) {
      ahead_ = day;
      stated_date_ = true;
    } else if (const auto interval = usual_interval(m.stored.campaigns)) {
      ahead_ = day_number(m.stored.campaigns.back().day);
      if (ahead_) *ahead_ += *interval;
    }
    const Links links(out);
    for (const StoredCampaign& c : m.stored.campaigns) links_.push_back(links.of(c.id));
    for (const ShownSeries& s : m.shown) {
      if (s.ended) continue;
      if (!open_results(m.stored, s).empty()) open_now_.insert(s.axis);
    }
    for (std::size_t i = 0; i < m.stored.results.size(); ++i) {
      const StoredResult& r = m.stored.results[i];
      if (!r.followed && r.expanded) stated_[{r.campaign, r.measurement, r.quantity, r.unit}] = i;
    }
  }

  HistorySeries of(const FollowedSeries& s) const {
    const Quantity q = quantity_of_unit(s.unit);
    HistorySeries out{.axis = s.axis,
                      .quantity = s.quantity,
                      .unit = q,
                      .points = {},
                      .model = name_of(s.trend.model)};
    out.ended = s.ended, out.line = s.line;
    if (s.over)
      out.compared_over = {si(s.over->from, out.position()), si(s.over->to, out.position())};
    for (const FollowedSeries::Apart& a : s.apart) {
      out.points.push_back(point(a.result, q));
      out.points.back().joined = false;
      out.points.back().why_not = a.why;
    }
    for (const std::size_t i : s.results) out.points.push_back(point(i, q));
    for (const kernel::Segment& g : s.trend.segments)
      out.segments.push_back({day(s, g.from), day(s, g.to), si(g.first, q), si(g.last, q),
                              si(g.u_first, q), si(g.u_last, q), si(g.slope, q), si(g.u_slope, q),
                              campaign(s, g.from).id, campaign(s, g.to).id});
    for (std::size_t i = 0; i < s.trend.changes.size(); ++i)
      if (s.significant[i]) out.changes.push_back(change(s, i, q));
    if (s.trend.smallest_change) out.smallest_change = si(*s.trend.smallest_change, q);
    const auto limit = s.ended ? std::nullopt : limit_of(m_, s);
    const bool own = limit && limit->quantity == s.quantity;
    if (own) out.limit = si(limit->limit, q);
    if (!s.ended) out.forecast = forecast(s, q, limit);
    // The limit is that of B, so B_mean has no probability of being out of tolerance, and only a
    // value of the axis that is open now requires action.
    if (out.forecast && !own) {
      std::string& answer = out.forecast->answer;
      if (!is_open_now(s.axis, s.quantity) && answer != "overdue" && answer != "cannot-say")
        answer = name_of(kernel::Answer::keep);
      out.forecast->p_out = 0.0, out.forecast->leaves.clear();
    }
    return out;
  }

  HistorySeries of(const ShownSeries& s) const {
    const Quantity q = quantity_of_unit(s.unit);
    HistorySeries out{.axis = s.axis, .quantity = s.quantity, .unit = q, .points = {}, .model = ""};
    out.ended = s.ended;
    // The definitions of A, E and R depend on the edition of the standard, so only results with the
    // conditions of the last result are joined.
    const StoredResult& last = m_.stored.results[s.results.back()];
    for (const std::size_t i : s.results) {
      out.points.push_back(point(i, q));
      const StoredResult& r = m_.stored.results[i];
      if (r.source == last.source && r.conditions != last.conditions)
        out.points.back().joined = false, out.points.back().why_not = "edition";
    }
    if (s.judged.empty()) return out;
    // A campaign without a limit does not change the limit.
    out.limit = si(*m_.stored.results[s.judged.back()].tolerance, q);
    if (s.ended) return out;
    // The forecast is that of a followed quantity of the axis whose limit is the limit of this
    // quantity.
    for (const FollowedSeries& f : m_.followed) {
      if (f.axis != s.axis || f.unit != s.unit || f.ended || f.quantity == s.quantity) continue;
      const auto limit = limit_of(m_, f);
      if (!limit || limit->quantity != s.quantity) continue;
      auto one = forecast(f, q, limit);
      // Of several lines of the axis, the one that may leave its limit first.
      if (!one || (out.forecast && one->p_out <= out.forecast->p_out)) continue;
      one->value = std::fabs(one->value) + si(limit->beyond.value, q);
      one->u = std::hypot(one->u, si(limit->beyond.u, q));
      out.forecast = std::move(one);
    }
    if (const auto limit = limit_of(m_, s); !out.forecast && limit) {
      out.forecast = forecast(*s.course, q, limit);
      if (out.forecast) {
        out.forecast->u = std::hypot(out.forecast->u, si(limit->beyond.u, q));
        out.forecast->of_largest = true;
      }
    }
    return out;
  }

 private:
  bool is_open_now(const std::string& axis, const std::string& quantity) const {
    return open_now_.contains(axis_of(axis, quantity));
  }
  const StoredCampaign& campaign(const FollowedSeries& s, std::size_t point) const {
    return m_.stored.campaigns[m_.stored.results[s.results[point]].campaign];
  }
  const std::string& day(const FollowedSeries& s, std::size_t point) const {
    return campaign(s, point).day;
  }

  HistoryPoint point(std::size_t result, Quantity q) const {
    const StoredResult& r = m_.stored.results[result];
    const StoredCampaign& c = m_.stored.campaigns[r.campaign];
    HistoryPoint p{c.id, c.day, links_[r.campaign], state_of(r.state), si(r.value, q)};
    // The U of an analysis includes the uncertainty that campaigns have in common.
    if (!r.followed) {
      if (r.expanded) p.u = si(*r.expanded / r.k.value_or(2.0), q);
      return p;
    }
    p.u = si(r.u_repeat.value_or(0.0), q);
    double common = 0.0;
    for (const store::CommonPart& part : r.common) common += part.u * part.u;
    p.u_common = si(std::sqrt(common), q);
    const auto stated = stated_.find({r.campaign, r.measurement, r.quantity, r.unit});
    if (stated == stated_.end()) return p;
    // The same value has the same U everywhere, so the U of the analysis is used.
    const StoredResult& same = m_.stored.results[stated->second];
    const double whole = si(*same.expanded / same.k.value_or(2.0), q);
    const double more = whole * whole - p.u * p.u;
    p.u_common = std::copysign(std::sqrt(std::fabs(more)), more);
    return p;
  }

  reports::HistoryChange change(const FollowedSeries& s, std::size_t i, Quantity q) const {
    const kernel::Change& c = s.trend.changes[i];
    reports::HistoryChange out{day(s, c.after), day(s, c.after + 1), si(c.size, q),
                               si(c.u, q),      s.p_adjusted[i],     name_of(c.cause)};
    if (c.declared) {
      const std::string& said = s.said[*c.declared];
      out.event = s.kinds[*c.declared] + (said.empty() ? "" : ": " + said);
    }
    out.after_campaign = campaign(s, c.after).id;
    out.before_campaign = campaign(s, c.after + 1).id;
    out.p_alone = c.p;
    out.mailed = s.mailed[i];
    return out;
  }

  std::optional<reports::HistoryForecast> forecast(const FollowedSeries& s, Quantity q,
                                                   const std::optional<FollowedLimit>& of) const {
    if (!ahead_ || s.series.points.size() < 2) return std::nullopt;
    const kernel::Forecast f =
        kernel::forecast(s.series, s.trend, static_cast<double>(*ahead_) / days_a_year,
                         of ? std::optional(of->limit) : std::nullopt, std::nullopt,
                         of ? of->beyond : kernel::Beyond{});
    reports::HistoryForecast out{day_text(*ahead_), si(f.value, q), si(f.u, q), f.p_out, {},
                                 name_of(f.answer)};
    // Extrapolation by more than half of the observed time span is not reliable.
    const double last = s.series.points.back().time, first = s.series.points.front().time;
    if (f.leaves && *f.leaves <= last + (last - first) / 2.0)
      out.leaves = day_text(static_cast<std::int64_t>(std::floor(*f.leaves * days_a_year)));
    if (f.answer == kernel::Answer::watch && !out.leaves.empty() && out.leaves <= today_)
      out.answer = "watch-now";
    const bool open = is_open_now(s.axis, s.quantity);
    if (!open && out.date < today_ && f.answer != kernel::Answer::cannot_say) {
      if (stated_date_)
        out.answer = "overdue";
      else if (f.answer == kernel::Answer::watch)
        out.answer = "watch-now";
    }
    if (!open) return out;
    // A value that is out of tolerance or indeterminate requires action regardless of the forecast.
    if (f.answer == kernel::Answer::cannot_say)
      out.value = out.u = out.p_out = std::numeric_limits<double>::quiet_NaN();
    out.answer = name_of(kernel::Answer::act);
    return out;
  }

  const AssessedMachine& m_;
  std::vector<std::string> links_;  ///< by campaign
  std::string today_;
  std::set<std::string> open_now_;  ///< axes with a value that is out of tolerance or indeterminate
  /// Index of the result of an analysis by campaign, measurement, quantity and unit.
  std::map<std::tuple<std::size_t, std::string, std::string, std::string>, std::size_t> stated_;
  std::optional<std::int64_t> ahead_{};
  bool stated_date_ = false;  ///< whether `[[due]]` states that day
};

}  // namespace

std::string page_of_machine(const std::string& machine) {
  std::string out;
  for (const char c : machine) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_';
    out += plain ? c : '_';
  }
  if (out != machine) out += "-" + storage::sha256(machine).substr(0, 8);
  return out + ".html";
}

Quantity quantity_of_unit(const std::string& symbol) {
  for (const Quantity q : {Quantity::number,
                           Quantity::deviation,
                           Quantity::deviation_per_length,
                           Quantity::length,
                           Quantity::angular_deviation,
                           Quantity::small_angle,
                           Quantity::angle,
                           Quantity::deviation_per_angle,
                           Quantity::expansion,
                           Quantity::temperature_difference,
                           Quantity::deviation_per_time,
                           Quantity::angle_per_time,
                           Quantity::growth,
                           Quantity::angular_growth,
                           Quantity::angular_expansion,
                           Quantity::deviation_per_reading,
                           Quantity::angle_per_reading,
                           Quantity::growth_per_reading,
                           Quantity::angular_growth_per_reading,
                           Quantity::deviation_per_kelvin,
                           Quantity::angle_per_kelvin,
                           Quantity::time})
    if (unit_of(q).symbol == symbol) return q;
  return Quantity::number;
}

double si(double shown, Quantity quantity) { return shown / unit_of(quantity).per_si; }

Links::Links(const fs::path& out)
    : root_((out / "").native()), hashed_(storage::own_folder(out, "a") != out / "a") {
  std::error_code error;
  packed_ = fs::exists(out / storage::packs_folder / storage::catalogue_name, error) || error;
}

std::string Links::of(const std::string& campaign) const {
  std::string folder = campaign + "/";
  if (hashed_) folder = storage::own_folder(root_, campaign).native().substr(root_.size()) + "/";
  bool report = ::access((root_ + folder + "report.pdf").c_str(), F_OK) == 0;
  if (!report && packed_)
    report =
        storage::is_there(storage::results_folder(root_, campaign) / "report.pdf").value_or(false);
  return folder + (report ? "report.pdf" : evaluation::results_name);
}

std::string link_of(const fs::path& out, const std::string& campaign) {
  return Links(out).of(campaign);
}

std::optional<std::int64_t> usual_interval(const std::vector<StoredCampaign>& campaigns) {
  std::set<std::int64_t> days;
  for (const StoredCampaign& c : campaigns)
    if (const auto day = day_number(c.day)) days.insert(*day);
  if (days.size() < 2) return std::nullopt;
  std::vector<std::int64_t> gaps;
  for (auto it = std::next(days.begin()); it != days.end(); ++it)
    gaps.push_back(*it - *std::prev(it));
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return *middle;
}

namespace {

/// Estimates by how much B exceeded |B_mean| since the last significant change.
std::optional<kernel::Beyond> beyond_mean(const AssessedMachine& m, const FollowedSeries& mean,
                                          const ShownSeries& B) {
  std::size_t first = 0;
  for (std::size_t i = 0; i < mean.trend.changes.size(); ++i)
    if (i < mean.significant.size() && mean.significant[i]) first = mean.trend.changes[i].after + 1;
  std::vector<double> more;
  double u_of_B = 0.0;
  for (std::size_t k = first; k < mean.results.size(); ++k) {
    const StoredResult& f = m.stored.results[mean.results[k]];
    for (const std::size_t i : B.results) {
      const StoredResult& r = m.stored.results[i];
      if (r.campaign != f.campaign || r.measurement != f.measurement) continue;
      more.push_back(std::max(0.0, std::fabs(r.value) - std::fabs(f.value)));
      u_of_B = r.expanded.value_or(0.0) / r.k.value_or(2.0);
    }
  }
  if (more.empty()) return std::nullopt;
  const auto n = static_cast<double>(more.size());
  kernel::Beyond out;
  for (const double x : more) out.value += x / n;
  double squares = 0.0;
  for (const double x : more) squares += (x - out.value) * (x - out.value);
  // With fewer values, the scatter is estimated from U of B.
  constexpr std::size_t fewest_for_scatter = 3;
  out.u =
      more.size() < fewest_for_scatter ? u_of_B : std::sqrt(squares / (n - 1.0) * (1.0 + 1.0 / n));
  return out;
}

}  // namespace

std::optional<FollowedLimit> limit_of(const AssessedMachine& machine,
                                      const FollowedSeries& series) {
  std::optional<FollowedLimit> own, of_B;
  for (const ShownSeries& s : machine.shown) {
    if (s.axis != series.axis || s.unit != series.unit || s.ended || s.judged.empty()) continue;
    const auto tolerance = machine.stored.results[s.judged.back()].tolerance;
    if (s.quantity == series.quantity) own = FollowedLimit{s.quantity, *tolerance};
    if (series.quantity != "B_mean" || s.quantity != "B") continue;
    if (const auto more = beyond_mean(machine, series, s))
      of_B = FollowedLimit{s.quantity, *tolerance, *more};
  }
  return of_B ? of_B : own;
}

std::optional<FollowedLimit> limit_of(const AssessedMachine& machine, const ShownSeries& s) {
  const auto follows = [&](const FollowedSeries& f) {
    const auto limit =
        f.ended || f.axis != s.axis || f.unit != s.unit ? std::nullopt : limit_of(machine, f);
    return limit && limit->quantity == s.quantity;
  };
  if (s.ended || !s.course ||
      std::any_of(machine.followed.begin(), machine.followed.end(), follows))
    return std::nullopt;
  // The mean of several campaigns is not known better than one of them: they share systematic parts.
  return FollowedLimit{s.quantity, *machine.stored.results[s.judged.back()].tolerance,
                       kernel::Beyond{0.0, s.course->series.points.back().u}};
}

/// The date is not kept if another quantity of the axis may leave its limit, or if it is before
/// `day`. The worklist has no line for such a date if it is not stated.
static void decide_date(std::vector<HistorySeries>& all, const std::string& day) {
  std::set<std::string> may_leave;
  for (const HistorySeries& s : all)
    if (s.limit && !s.ended && s.forecast && s.forecast->answer != "keep" &&
        s.forecast->answer != "cannot-say")
      may_leave.insert(axis_of(s.axis, s.quantity));
  for (HistorySeries& s : all) {
    if (!s.forecast || s.forecast->answer != "keep") continue;
    const bool passed = s.forecast->date < day,
               other = s.limit && may_leave.contains(axis_of(s.axis, s.quantity));
    s.forecast->answer = other      ? (passed ? "watch-now" : "other-decides")
                         : passed   ? "passed"
                         : !s.limit ? "expected"
                                    : "keep";
  }
}

bool is_at(const reports::TableLoaded& t, const std::string& axis,
           const reports::HistoryChange& c) {
  return t.axis == axis && c.after <= t.before && c.before >= t.after &&
         (c.after < t.before || c.before == t.before) && (c.before > t.after || c.after == t.after);
}

static void name_cause(const reports::TableLoaded& t, reports::HistoryChange& c) {
  c.cause = "table";
  c.event = "table-" + t.kind + (t.table.empty() ? "" : ": " + t.table);
  if (t.kind == "offset") c.event += (t.points > 0 ? ", +" : ", ") + std::to_string(t.points);
}

/// Whether the mean reversal changed by as much as the active backlash value, up to its uncertainty
/// and a tenth for steps of the control.
static bool explains(const BacklashChange& b, const HistorySeries& s,
                     const reports::HistoryChange& c) {
  return s.quantity == "B_mean" && is_at(b.between, s.axis, c) &&
         std::fabs(c.size - b.change) <= 2.0 * c.u + 0.1 * std::fabs(b.change);
}

reports::MachineHistory describe(const AssessedMachine& machine, const fs::path& out,
                                 const std::string& due, const std::string& why,
                                 const std::string& today) {
  const store::NamedMachine& named = machine.state.machine;
  reports::MachineHistory m;
  m.id = named.name, m.maker = named.stated.maker;
  m.model = named.stated.model, m.serial = named.stated.serial;
  // The customer is that of the last campaign; location and control are the last ones that are
  // stated.
  for (const StoredCampaign& c : machine.stored.campaigns) {
    m.customer = c.customer;
    if (!c.place.empty()) m.place = c.place;
    if (!c.control.empty()) m.control = c.control;
  }
  for (const config::Event& e : machine.events)
    m.events.push_back({e.date, e.axis, e.kind, e.text});
  m.tables = tables_kept(machine);
  m.due = due, m.why_due = why, m.file = page_of_machine(named.name);
  const Describing describing(machine, out, due, today);
  for (const FollowedSeries& s : machine.followed) m.series.push_back(describing.of(s));
  for (const ShownSeries& s : machine.shown) m.series.push_back(describing.of(s));
  decide_date(m.series, today);
  m.tables_loaded = tables_loaded(machine), m.tables_unstated = tables_unstated(machine);
  for (const reports::TableLoaded& t : m.tables_loaded)
    for (HistorySeries& s : m.series)
      for (reports::HistoryChange& c : s.changes)
        if (is_at(t, s.axis, c)) name_cause(t, c);
  for (const BacklashChange& b : backlash_changes(machine))
    for (HistorySeries& s : m.series)
      for (reports::HistoryChange& c : s.changes)
        if (explains(b, s, c)) c.cause = "table", c.event = "table-backlash";
  return m;
}

}  // namespace nonio::assessment
