// SPDX-License-Identifier: Apache-2.0
#include "history_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "nonio/sdk/format.h"
#include "nonio/sdk/units.h"
#include "printable.h"
#include "text_layout.h"

namespace nonio::app {

using reports::HistoryChange;
using reports::HistoryPoint;
using reports::HistorySeries;

namespace {

constexpr std::size_t bar_width = 41;
constexpr double twice = 2.0;  // U is twice the standard uncertainty

std::string number_of(double si, Quantity q) { return short_text(si * unit_of(q).per_si); }

/// "-4.35 ± 0.27 um"
std::string with_U(double value, double u, Quantity q) {
  const double scale = unit_of(q).per_si;
  const auto rounded = rounded_result(value * scale, twice * u * scale);
  const std::string unit(unit_of(q).symbol);
  return (rounded ? rounded->value + " ± " + rounded->U : number_of(value, q)) +
         (unit.empty() ? "" : " " + unit);
}

std::string p_text(double p) { return evidence_text({"p", p, Quantity::probability}); }

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

const char* word_of(const HistoryPoint& p) {
  switch (p.state) {
    case HistoryPoint::State::as_left:
      return "left";
    case HistoryPoint::State::check:
      return "check";
    case HistoryPoint::State::as_found:
      break;
  }
  return "found";
}

class SeriesChart {
 public:
  SeriesChart(const reports::MachineHistory& machine, const HistorySeries& s)
      : machine_(machine), s_(s), points_(s.points) {
    std::stable_sort(points_.begin(), points_.end(),
                     [](const HistoryPoint& a, const HistoryPoint& b) { return a.date < b.date; });
    low_ = high_ = points_.front().value;
    for (const HistoryPoint& p : points_) {
      low_ = std::min(low_, p.value - twice * p.u);
      high_ = std::max(high_, p.value + twice * p.u);
    }
    if (!(high_ > low_)) low_ -= 1e-9, high_ += 1e-9;
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
  std::string head() const {
    const std::string unit(unit_of(s_.unit).symbol);
    return printable(s_.axis) + (s_.axis.empty() ? "" : "  ") + printable(s_.quantity) +
           (unit.empty() ? "" : ", " + unit) + (s_.model.empty() ? "" : ": " + s_.model) +
           (s_.model.empty() ? "" : "; in brackets and as bars U of comparison") + compared_over() +
           (s_.ended ? " (ended: measured otherwise since)" : "") + "\n";
  }

  /// The points are values of their own targets; changes and levels are not.
  std::string compared_over() const {
    if (!s_.compared_over) return {};
    return "; compared over " + number_of(s_.compared_over->from, Quantity::length) + " to " +
           number_of(s_.compared_over->to, Quantity::length) + " " +
           std::string(unit_of(Quantity::length).symbol);
  }

  std::size_t column(double value) const {
    const double share = (value - low_) / (high_ - low_);
    return static_cast<std::size_t>(
        std::lround(std::clamp(share, 0.0, 1.0) * static_cast<double>(bar_width - 1)));
  }

  std::string row(const HistoryPoint& p) const {
    std::string bar(bar_width, ' ');
    if (s_.limit)
      for (const double limit : {-*s_.limit, *s_.limit})
        if (limit >= low_ && limit <= high_) bar[column(limit)] = '!';
    for (std::size_t i = column(p.value - twice * p.u); i <= column(p.value + twice * p.u); ++i)
      bar[i] = '-';
    bar[column(p.value)] = mark_of(p);
    const double scale = unit_of(s_.unit).per_si;
    const auto rounded = rounded_result(p.value * scale, twice * reports::u_of_value(p) * scale);
    std::string shown = rounded ? rounded->value + " ± " + rounded->U : number_of(p.value, s_.unit);
    if (const auto comparison = rounded_result(p.value * scale, twice * p.u * scale);
        !s_.model.empty() && comparison)
      shown += " (" + comparison->U + ")";
    std::string line = "  " + p.date + "  " + padded(word_of(p), 7) + padded(shown, 25) + bar +
                       "  " + printable(p.campaign) +
                       (p.joined ? "" : " (apart: " + p.why_not + ")");
    line.erase(line.find_last_not_of(' ') + 1);
    return line + "\n";
  }

  /// As found and as left are one campaign: a change follows the right one of them.
  bool is_last_of(std::size_t i, const HistoryChange& c) const {
    const bool left_follows = i + 1 < points_.size() && points_[i + 1].campaign == c.after_campaign;
    return (c.before_campaign == c.after_campaign) == left_follows;
  }

  std::string between(const std::string& after, const std::string& before) const {
    std::string out;
    for (const reports::MachineEvent& e : machine_.events)
      if (e.date > after && e.date <= before &&
          (e.axis.empty() || s_.axis.empty() || e.axis == s_.axis))
        out += "  " + e.date + "  * " + printable(e.kind) + ": " + printable(e.text) + "\n";
    return out;
  }

  std::string change(const HistoryChange& c) const {
    std::string out = "              ~ " + with_U(c.size, c.u, s_.unit) + ", " + p_text(c.p) + ": ";
    if (c.cause == "undeclared") return out + "changed; no event is known\n";
    if (c.cause == "instrument") return out + "with the instrument, not the machine's\n";
    return out + printable(c.event.empty() ? c.cause : c.event) + "\n";
  }

  std::string foot() const {
    std::string out;
    if (!s_.segments.empty() && s_.segments.back().u_slope > 0.0)
      out += "  slope " + with_U(s_.segments.back().slope, s_.segments.back().u_slope, s_.unit) +
             " a year\n";
    const bool changed =
        std::any_of(s_.changes.begin(), s_.changes.end(),
                    [](const HistoryChange& c) { return c.cause == "undeclared"; });
    if (s_.smallest_change && !changed)
      out += "  no change without a known event; detection limit " +
             number_of(*s_.smallest_change, s_.unit) + "\n";
    if (!s_.forecast) return out;
    const reports::HistoryForecast& f = *s_.forecast;
    if (f.answer == "cannot-say") return out + "  for " + f.date + " nothing can be said\n";
    const bool sayable = std::isfinite(f.value);
    if (sayable) out += "  on " + f.date + ": " + with_U(f.value, f.u, s_.unit) + " expected";
    if (!sayable || (!s_.limit && f.answer == "act"))
      return out + (sayable ? "\n" : "") +
             "  a value of the axis is beyond its limit or indeterminate: act, do not wait for " +
             f.date + "\n";
    if (s_.limit) {
      std::array<char, 32> percent{};
      std::snprintf(percent.data(), percent.size(), "%.1f", 100.0 * f.p_out);
      out += ", " + std::string(percent.data()) + " % beyond " + number_of(*s_.limit, s_.unit) +
             ": " + f.answer;
      if (!f.leaves.empty()) out += "; may be beyond it from " + f.leaves + " on";
    }
    return out + "\n";
  }

  const reports::MachineHistory& machine_;
  const HistorySeries& s_;
  std::vector<HistoryPoint> points_;
  double low_ = 0.0, high_ = 0.0;
};

std::size_t told_changes(const reports::MachineHistory& m, bool undeclared) {
  std::size_t n = 0;
  for (const HistorySeries& s : m.series)
    for (const HistoryChange& c : s.changes) n += (c.cause == "undeclared") == undeclared;
  return n;
}

}  // namespace

std::string machines_table(const reports::SiteHistory& site) {
  std::size_t width = 8;
  for (const reports::MachineHistory& m : site.machines)
    width = std::max(width, printable(m.id).size() + 2);
  std::string out = padded("machine", width) + "series  changes  with cause  next due\n";
  for (const reports::MachineHistory& m : site.machines) {
    std::string line = padded(printable(m.id), width) + padded(std::to_string(m.series.size()), 8) +
                       padded(std::to_string(told_changes(m, true)), 9) +
                       padded(std::to_string(told_changes(m, false)), 12) + m.due;
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

std::string machine_chart(const reports::MachineHistory& machine) {
  std::string out = printable(machine.id);
  for (const std::string* more :
       {&machine.maker, &machine.model, &machine.serial, &machine.customer})
    if (!more->empty()) out += ", " + printable(*more);
  out += "\n";
  if (!machine.due.empty())
    out += "next calibration " + machine.due +
           (machine.proposal.why.id == "interval.out-now"
                ? "; a value is beyond its limit now: act, do not wait for it"
                : "") +
           "\n";
  for (const HistorySeries& s : machine.series)
    if (!s.points.empty()) out += "\n" + SeriesChart(machine, s).text();
  return out;
}

}  // namespace nonio::app
