// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "campaign/config/keys.h"
#include "campaign/config/template_files.h"
#include "laboratory/assessment/assess.h"
#include "laboratory/store/place.h"
#include "laboratory/store/query.h"
#include "laboratory/store/store.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/units.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {

namespace {

struct HistoryWords {
  const reports::Wording& words;
  std::size_t width;
};

using reports::HistoryChange;
using reports::HistoryPoint;
using reports::HistorySeries;

constexpr std::size_t least_bar = 15, most_bar = 41;
constexpr double twice = 2.0;

class Numbers {
 public:
  Numbers(const HistorySeries& s, std::string unit, std::string language)
      : quantity_(s.unit),
        is_log_(reports::is_log_of_scatter(s.quantity)),
        unit_(std::move(unit)),
        language_(std::move(language)) {}

  const std::string& unit() const { return unit_; }

  std::string number(double si) const {
    return localised(short_text(is_log_ ? std::exp(si) : si * unit_of(quantity_).per_si),
                     language_);
  }

  /// Returns the value ± U (k = 2), for example "-4.35 ± 0.27", or for a scatter the ends of its
  /// interval, for example "0.48 (0.35 to 0.66)".
  std::string value(double si, double u, const reports::Wording& words) const {
    if (is_log_) return reports::scatter_text(words, si, u);
    const double scale = unit_of(quantity_).per_si;
    const auto rounded = rounded_result(si * scale, twice * u * scale);
    return rounded ? localised(rounded->value + " ± " + rounded->U, language_) : number(si);
  }

  /// Returns U (k = 2) of the comparison of campaigns. Empty for a scatter, because both U are
  /// equal.
  std::string comparison(double si, double u) const {
    const double scale = unit_of(quantity_).per_si;
    const auto rounded = rounded_result(si * scale, twice * u * scale);
    return is_log_ || !rounded ? "" : localised(rounded->U, language_);
  }

  /// For a scatter the difference of the logarithms is printed as a factor.
  std::string difference(double si, double u, const reports::Wording& words) const {
    if (!is_log_) return value(si, u, words) + blank_unit();
    return reports::factor_text(words, si, u);
  }
  std::string size(double si, const reports::Wording& words) const {
    return is_log_ ? "× " + reports::factor_text(words, std::fabs(si)) : number(si) + blank_unit();
  }

  std::string blank_unit() const { return unit_.empty() ? "" : " " + unit_; }

 private:
  Quantity quantity_;
  bool is_log_;
  std::string unit_, language_;
};

/// The scatter is evaluated as a logarithm, which has no unit, but printed in the unit of the
/// deviations of its axis.
std::string unit_of_series(const reports::MachineHistory& machine, const HistorySeries& s) {
  if (!reports::is_log_of_scatter(s.quantity)) return std::string(unit_of(s.unit).symbol);
  bool is_rotary = config::rotary_by_name(s.axis);
  for (const HistorySeries& other : machine.series)
    if (other.axis == s.axis && other.quantity == "B_mean")
      is_rotary = other.unit == Quantity::angular_deviation;
  return std::string(unit_of(is_rotary ? Quantity::angular_deviation : Quantity::deviation).symbol);
}

char mark_of(const HistoryPoint& p) {
  if (!p.joined) return '.';
  switch (p.state) {
    case HistoryPoint::State::as_left:
      return 'x';
    case HistoryPoint::State::check:
      return '+';
    case HistoryPoint::State::as_found:
      break;
  }
  return 'o';
}

const char* name_of(HistoryPoint::State state) {
  constexpr const char* names[] = {"as_found", "as_left", "check"};
  return names[static_cast<std::size_t>(state)];
}

class SeriesChart {
 public:
  SeriesChart(const reports::MachineHistory& machine, const HistorySeries& s,
              const HistoryWords& with)
      : machine_(machine),
        s_(s),
        words_(with.words),
        width_(with.width),
        numbers_(s, unit_of_series(machine, s), with.words.language()),
        points_(s.points) {
    std::stable_sort(points_.begin(), points_.end(),
                     [](const HistoryPoint& a, const HistoryPoint& b) { return a.date < b.date; });
    low_ = high_ = points_.front().value;
    std::size_t longest = 0;
    for (const HistoryPoint& p : points_) {
      low_ = std::min(low_, p.value - twice * p.u);
      high_ = std::max(high_, p.value + twice * p.u);
      states_ = std::max(states_, columns_of(state_of(p)) + 2);
      values_ = std::max(values_, columns_of(value_of(p)) + 2);
      longest = std::max(longest, columns_of(printable(p.campaign)));
    }
    if (!(high_ > low_)) low_ -= 1e-9, high_ += 1e-9;
    const std::size_t used = before_state + states_ + values_ + 2;
    bar_ = std::clamp(width_ > used + longest ? width_ - used - longest : 0, least_bar, most_bar);
  }

  std::string text() {
    std::string out = head();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (i > 0) out += between(points_[i - 1].date, points_[i].date);
      out += row(points_[i]);
      for (const HistoryChange& c : s_.changes)
        if (c.after_campaign == points_[i].campaign && is_last_of(i, c)) out += change(c);
    }
    return out + foot();
  }

 private:
  static constexpr std::size_t before_state = 14;

  std::string line(const std::string& text) const { return wrapped(text, 2, width_, 2); }

  std::string head() const {
    std::string text = printable(s_.axis) + (s_.line.empty() ? "" : " " + printable(s_.line)) +
                       (s_.axis.empty() ? "" : "  ") +
                       printable(reports::followed_quantity(words_, s_.quantity)) + " (" +
                       printable(s_.quantity) + ")" +
                       (numbers_.unit().empty() ? "" : ", " + numbers_.unit());
    if (!s_.model.empty())
      text +=
          ": " +
          words_.get_or("history.model." + s_.model +
                            (s_.model == "level" && !s_.changes.empty() ? "-with-events" : ""),
                        s_.model) +
          (reports::is_log_of_scatter(s_.quantity) ? "" : "; " + words_.get("history.comparison"));
    if (s_.ended) text += " (" + words_.get("history.ended") + ")";
    std::string out = wrapped(text, 0, width_, 2);
    if (const auto& over = s_.compared_over)
      out += line(
          words_.get("site.compared_over", {{"from", position(over->from, s_.position())},
                                            {"to", position(over->to, s_.position())},
                                            {"unit", std::string(unit_of(s_.position()).symbol)}}));
    return out;
  }

  std::string position(double si, Quantity q) const {
    return localised(short_text(si * unit_of(q).per_si), words_.language());
  }

  std::string state_of(const HistoryPoint& p) const {
    return words_.get("site.state." + std::string(name_of(p.state)));
  }

  std::string value_of(const HistoryPoint& p) const {
    std::string shown = numbers_.value(p.value, reports::u_of_value(p), words_);
    if (const std::string U = numbers_.comparison(p.value, p.u); !s_.model.empty() && !U.empty())
      shown += " (" + U + ")";
    return shown;
  }

  std::size_t column(double value) const {
    const double share = (value - low_) / (high_ - low_);
    return static_cast<std::size_t>(
        std::lround(std::clamp(share, 0.0, 1.0) * static_cast<double>(bar_ - 1)));
  }

  std::string row(const HistoryPoint& p) const {
    std::string bar(bar_, ' ');
    if (s_.limit)
      for (const double limit : {-*s_.limit, *s_.limit})
        if (limit >= low_ && limit <= high_) bar[column(limit)] = '!';
    for (std::size_t i = column(p.value - twice * p.u); i <= column(p.value + twice * p.u); ++i)
      bar[i] = '-';
    bar[column(p.value)] = mark_of(p);
    std::string out =
        "  " + p.date + "  " + padded(state_of(p), states_) + padded(value_of(p), values_) + bar;
    const std::string why = p.joined
                                ? ""
                                : " (" + words_.get_or("site.not_joined." + p.why_not, p.why_not) +
                                      ")",
                      campaign = printable(p.campaign) + why;
    if (columns_of(out) + 2 + columns_of(campaign) <= width_) return out + "  " + campaign + "\n";
    out.erase(out.find_last_not_of(' ') + 1);
    return out + "\n" + wrapped(campaign, before_state, width_);
  }

  /// A change within a campaign is printed between its two points, any other change after its last
  /// point.
  bool is_last_of(std::size_t i, const HistoryChange& c) const {
    const bool left_follows = i + 1 < points_.size() && points_[i + 1].campaign == c.after_campaign;
    return (c.before_campaign == c.after_campaign) == left_follows;
  }

  std::string between(const std::string& after, const std::string& before) const {
    std::string out;
    for (const reports::MachineEvent& e : machine_.events)
      if (e.date > after && e.date <= before &&
          (e.axis.empty() || s_.axis.empty() || e.axis == s_.axis))
        out += line(e.date + "  * " + printable(words_.get_or("site.event." + e.kind, e.kind)) +
                    ": " + printable(e.text));
    return out;
  }

  std::string change(const HistoryChange& c) const {
    const std::string p =
        localised(evidence_text({"p", c.p, Quantity::probability}), words_.language());
    const std::string size = numbers_.difference(c.size, c.u, words_) + ", " + p + ": ";
    const std::string why = c.cause == "undeclared"   ? words_.get("history.undeclared")
                            : c.cause == "instrument" ? words_.get("history.instrument")
                            : c.event.empty() ? words_.get_or("history.cause." + c.cause, c.cause)
                                              : reports::event_text(words_, c.event);
    return wrapped("~ " + size + printable(why), before_state, width_, 2);
  }

  std::string foot() const {
    std::string out;
    if (!s_.segments.empty() && s_.segments.back().u_slope > 0.0)
      out += line(words_.get("history.slope",
                             {{"value", numbers_.difference(s_.segments.back().slope,
                                                            s_.segments.back().u_slope, words_)}}));
    const bool changed =
        std::any_of(s_.changes.begin(), s_.changes.end(),
                    [](const HistoryChange& c) { return c.cause == "undeclared"; });
    if (s_.smallest_change && !changed)
      out += line(
          words_.get("history.no_change", {{"size", numbers_.size(*s_.smallest_change, words_)}}));
    return out + forecast();
  }

  std::string forecast() const {
    if (!s_.forecast) return {};
    const reports::HistoryForecast& f = *s_.forecast;
    const std::string act = words_.get("site.forecast.out_now", {{"date", f.date}});
    if (!std::isfinite(f.value) && f.answer != "cannot-say") return line(act);
    const bool asked = s_.limit || f.answer == "cannot-say";
    std::array<char, 32> percent{};
    std::snprintf(percent.data(), percent.size(), "%.1f", 100.0 * f.p_out);
    std::string out =
        words_.get("site.forecast." + (asked ? f.answer : "expected"),
                   {{"date", f.date},
                    {"value", std::isfinite(f.value)
                                  ? numbers_.value(f.value, f.u, words_) + numbers_.blank_unit()
                                  : ""},
                    {"p", localised(percent.data(), words_.language())}});
    if (!asked && f.answer == "act") out += " " + act;
    if (!f.leaves.empty()) out += " " + words_.get("site.leaves", {{"date", f.leaves}});
    return line(out);
  }

  const reports::MachineHistory& machine_;
  const HistorySeries& s_;
  const reports::Wording& words_;
  std::size_t width_;
  Numbers numbers_;
  std::vector<HistoryPoint> points_;
  double low_ = 0.0, high_ = 0.0;
  std::size_t states_ = 0, values_ = 0, bar_ = most_bar;
};

std::size_t count_changes(const reports::MachineHistory& m, bool undeclared) {
  std::size_t n = 0;
  for (const HistorySeries& s : m.series)
    for (const HistoryChange& c : s.changes) n += (c.cause == "undeclared") == undeclared;
  return n;
}

std::string machines_table(const reports::SiteHistory& site, const HistoryWords& with) {
  const reports::Wording& words = with.words;
  std::vector<std::array<std::string, 5>> rows{
      {words.get("site.machine"), words.get("history.series"), words.get("history.changes"),
       words.get("history.with_cause"), words.get("site.next_due")}};
  for (const reports::MachineHistory& m : site.machines)
    rows.push_back({printable(m.id), std::to_string(m.series.size()),
                    std::to_string(count_changes(m, true)), std::to_string(count_changes(m, false)),
                    m.due});
  std::array<std::size_t, 5> widths{};
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i)
      widths[i] = std::max(widths[i], columns_of(row[i]) + 2);
  std::size_t others = 0;
  for (std::size_t i = 1; i < widths.size(); ++i) others += widths[i];
  const std::size_t names = std::min(widths[0], with.width > others ? with.width - others : 0);
  std::string out;
  for (const auto& row : rows) {
    std::string line = padded(row[0], names);
    if (columns_of(row[0]) + 2 > names) line = row[0] + "\n" + padded("", names);
    for (std::size_t i = 1; i < row.size(); ++i) line += padded(row[i], widths[i]);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

std::string machine_chart(const reports::MachineHistory& machine, const HistoryWords& with) {
  std::string name = printable(machine.id);
  for (const std::string* more :
       {&machine.maker, &machine.model, &machine.serial, &machine.customer})
    if (!more->empty()) name += ", " + printable(*more);
  std::string out = wrapped(name, 0, with.width, 2);
  if (!machine.due.empty()) {
    out += wrapped(with.words.get("site.next_due") + ": " + machine.due, 0, with.width, 2);
    if (machine.proposal.why.id == "interval.out-now")
      out += wrapped(with.words.get("site.forecast.out_now", {{"date", machine.due}}), 0,
                     with.width, 2);
  }
  for (const HistorySeries& s : machine.series)
    if (!s.points.empty()) out += "\n" + SeriesChart(machine, s, with).text();
  return out;
}

struct HistoryWish {
  std::string out, machine, axis, quantity;
};

void keep(const HistoryWish& wish, const std::string& machine, reports::SiteHistory& site) {
  if (!machine.empty())
    std::erase_if(site.machines, [&](const auto& m) { return m.id != machine; });
  for (reports::MachineHistory& m : site.machines)
    std::erase_if(m.series, [&](const reports::HistorySeries& s) {
      return (!wish.axis.empty() && s.axis != wish.axis) ||
             (!wish.quantity.empty() && s.quantity != wish.quantity);
    });
}

int history(const HistoryWish& wish, const Common& common) {
  const auto last_run = assessment::last_run_in(wish.out);
  if (!last_run) return complain(last_run.error().message);
  std::string machine;
  if (!wish.machine.empty()) {
    auto known = store::machine_named(wish.out, wish.machine);
    if (!known) return complain(known.error().message);
    machine = std::move(*known);
  }
  if (const auto known = store::known_run(wish.out);
      !known || *known != std::optional(last_run->run))
    complain(store::store_in(wish.out) + " may lack results of run " +
             std::to_string(last_run->run) +
             ", because a run was interrupted. The next `nonio run` enters them.");
  auto site = assessment::assess(wish.out, *last_run, [] {});
  if (!site) return complain(site.error().message);
  keep(wish, machine, *site);
  const auto templates =
      config::read_templates(common.template_folders(), {}, config::words_in(last_run->language));
  if (!templates) return complain(templates.error().message);
  if (common.json) {
    std::cout << assessment::history_json(*site, *last_run, *templates);
    return exit_done;
  }
  const std::string language = templates->tables.contains("words/" + last_run->language + "/site")
                                   ? last_run->language
                                   : "en";
  const reports::Wording words(*templates, language, {"site", "terminal"});
  const HistoryWords with{words, line_width(STDOUT_FILENO)};
  if (machine.empty()) {
    std::cout << machines_table(*site, with);
    return exit_done;
  }
  for (const reports::MachineHistory& m : site->machines) std::cout << machine_chart(m, with);
  return exit_done;
}

}  // namespace

int show_machine(const std::string& out, const std::string& machine, const Common& common) {
  return history({out, machine, {}, {}}, common);
}

Verb history_verb(Common& common) {
  auto wish = std::make_shared<HistoryWish>();
  return {
      .name = "history",
      .summary = "Trends, changes and forecasts of a machine over its campaigns",
      .arguments = joined(
          {required(existing(Argument::Takes::folder,
                             {"OUT", &wish->out, "Output folder of `nonio run`"})),
           {"MACHINE", &wish->machine,
            "Its asset, or maker and serial with a space between them; without it all machines"},
           {"--axis", &wish->axis, "As the control names it: X, or X1 and X2 of a gantry"},
           {"--quantity", &wish->quantity, "scale, B_mean, ln_s, A, R, ... as in results.json"}},
          common_arguments(common)),
      .footer =
          "One line per campaign, in the language of the site: o = as found, x = as left, + = "
          "check, . = not comparable, with U "
          "(k = 2) as in its report and, in brackets, the U of the comparison (scatter of the "
          "readings only, without the contributions that all campaigns with one instrument share). "
          "! = tolerance limit, * = event, ~ = change, with U and adjusted p-value. Smaller "
          "changes cannot be detected; the detection limit is given below each chart. A, E and R "
          "are shown without a fitted line. The scatter (ln_s) is shown as the standard deviation "
          "of a reading with its interval (k = 2), its changes as factors.\n\n--json writes schema "
          "nonio-history/1 (docs/dev/json-records.md).",
      .examples = {"nonio machine history out S-0042 --axis X --quantity B_mean"},
      .run = [wish, &common] { return history(*wish, common); }};
}

}  // namespace nonio::app
