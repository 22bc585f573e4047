// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/history.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "nonio/reports/history_value.h"
#include "nonio/reports/number.h"
#include "nonio/reports/quantity_words.h"
#include "nonio/reports/text.h"
#include "report.h"

namespace nonio::pdf_report {

using namespace reports;
using Curve = Plot::Curve;

namespace {

constexpr const char* history_field = "history";

double day_number(const std::string& day) {
  const auto part = [&](std::size_t at, std::size_t n) {
    int value = 0;
    for (const char c : day.substr(std::min(at, day.size()), n)) value = 10 * value + (c - '0');
    return value;
  };
  const std::chrono::year_month_day date{std::chrono::year(part(0, 4)),
                                         std::chrono::month(static_cast<unsigned>(part(5, 2))),
                                         std::chrono::day(static_cast<unsigned>(part(8, 2)))};
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

constexpr double days_a_year = 365.25;

bool is_largest(const HistorySeries& s) { return s.model.empty(); }

/// Order of the page: largest deviations (A, B, R), then the other followed quantities.
int rank(const HistorySeries& s) {
  constexpr const char* first[] = {"A", "B", "R"};
  if (is_largest(s))
    return static_cast<int>(std::find(std::begin(first), std::end(first), s.quantity) -
                            std::begin(first));
  constexpr const char* next[] = {"B_mean", "scale", "ln_s"};
  return 10 + static_cast<int>(std::find(std::begin(next), std::end(next), s.quantity) -
                               std::begin(next));
}

class HistoryPage {
 public:
  HistoryPage(const Source& source, const HistorySoFar& history)
      : source_(source), w_(source.words), h_(history), id_(source.in.campaign.id) {
    for (std::size_t i = 0; i < h_.series.size(); ++i) {
      const HistorySeries& s = h_.series[i];
      if (!is_largest(s) || rank(s) < 3 || s.limit) shown_.push_back(i);
    }
    std::stable_sort(shown_.begin(), shown_.end(), [&](std::size_t a, std::size_t b) {
      const HistorySeries &one = h_.series[a], &other = h_.series[b];
      return std::pair(one.axis, rank(one)) < std::pair(other.axis, rank(other));
    });
  }

  void add(Blocks& blocks) const {
    const auto say = [&](const std::string& text, Paragraph::Look look = Paragraph::Look::body) {
      blocks.push_back({Paragraph{text, look}, history_field});
    };
    if (h_.machine.empty()) return say(w_.get("history.no_machine"));
    if (h_.day.empty()) return say(w_.get("history.no_date"));
    say(made_from());
    if (!h_.campaigns.empty()) say(last_change());
    say(next_due());
    say(events(), Paragraph::Look::small);
    if (h_.campaigns.empty()) return;
    add_table(blocks);
    add_plots(blocks);
    say(w_.get("history.legend"), Paragraph::Look::small);
  }

 private:
  std::string made_from() const {
    std::string machine = visible(h_.machine), aliases;
    for (const std::string& alias : h_.aliases)
      aliases += (aliases.empty() ? "" : ", ") + visible(alias);
    if (!aliases.empty())
      machine = w_.get("history.aliases", {{"machine", machine}, {"aliases", aliases}});
    if (h_.campaigns.empty())
      return w_.get("history.first", {{"machine", machine}, {"date", h_.day}});
    const std::string digest = h_.sha256.substr(0, 16);
    if (h_.campaigns.size() == 1)
      return w_.get("history.made_from_one",
                    {{"machine", machine}, {"date", h_.day}, {"digest", digest}});
    return w_.get("history.made_from", {{"machine", machine},
                                        {"date", h_.day},
                                        {"count", std::to_string(h_.campaigns.size())},
                                        {"digest", digest}});
  }

  /// Replaces characters that the fonts do not contain, because texts from other files must not
  /// stop the report.
  std::string visible(const std::string& text) const { return visible_text(text, source_.fonts); }

  std::string name(const HistorySeries& s) const {
    return is_largest(s) ? symbol(s.quantity) : followed_quantity(source_.site, s.quantity);
  }

  FollowedNumbers numbers(const HistorySeries& s) const { return {s, h_.series, source_.site}; }
  std::string printed(const HistorySeries& s, const HistoryPoint& p) const {
    return numbers(s).number(p.value, reports::u_of_value(p));
  }

  std::string kind(const std::string& kind) const {
    return source_.site.get_or("site.event." + kind, kind);
  }

  std::string cause(const HistoryChange& c) const {
    if (c.cause == "instrument") return w_.get("history.instrument_cause");
    if (c.cause == "table") return w_.get("history.table_cause");
    if (c.cause != "event") return w_.get("history.unknown_cause");
    return kind(c.event.substr(0, c.event.find(": ")));
  }

  std::string change(const HistorySeries& s, const HistoryChange& c) const {
    if (c.cause == "table" && c.after == c.before)
      return w_.get("history.adjusted",
                    {{"size", numbers(s).difference(c.size, c.u)}, {"date", c.before}});
    return w_.get("history.changed", {{"size", numbers(s).difference(c.size, c.u)},
                                      {"after", c.after_text()},
                                      {"before", c.before_text()},
                                      {"cause", cause(c)}});
  }

  std::string statement(const HistorySeries& s) const {
    const std::string limit =
        s.limit ? w_.get("history.limit", {{"limit", numbers(s).size(*s.limit)}}) : "";
    if (is_largest(s)) return limit.empty() ? "–" : limit;
    std::string says;
    if (!s.changes.empty())
      says = change(s, s.changes.back());
    else if (s.model == "drift" && !s.segments.empty())
      says = w_.get(
          "history.drift",
          {{"slope", numbers(s).difference(s.segments.back().slope, s.segments.back().u_slope)}});
    else if (std::count_if(s.points.begin(), s.points.end(),
                           [](const HistoryPoint& p) { return p.joined; }) < 3)
      says = w_.get("history.few");
    else if (s.smallest_change)
      says = w_.get("history.no_change", {{"smallest", numbers(s).size(*s.smallest_change)}});
    else
      says = w_.get(s.model == "none" ? "history.cannot_say" : "history.no_change_said");
    return limit.empty() ? says : says + "; " + limit;
  }

  std::string first_value(const HistorySeries& s) const {
    for (const HistoryPoint& p : s.points)
      if (!p.joined && !p.why_not.empty())
        return w_.get("history.not_joined",
                      {{"why", source_.site.get_or("site.not_joined." + p.why_not, p.why_not)}});
    return w_.get("history.new_value");
  }

  struct Before {
    std::string value = "–", since = "–", difference = "–";
    bool any = false;
  };
  Before before(std::size_t series, std::size_t point) const {
    const HistorySeries& s = h_.series[series];
    if (is_largest(s)) {
      for (std::size_t k = point; k-- > 0;)
        if (const HistoryPoint& p = s.points[k];
            p.campaign != id_ || p.state != s.points[point].state)
          return {printed(s, p), p.date, "–", true};
      return {};
    }
    for (const HistoryStep& step : h_.steps)
      if (step.series == series && step.point == point)
        return {printed(s, s.points[point - 1]), step.before_date, step_text(s, step), true};
    return {};
  }

  std::string step_text(const HistorySeries& s, const HistoryStep& step) const {
    const FollowedNumbers shown = numbers(s);
    return shown.is_scatter() ? "× " + scatter_text(source_.site, step.size, step.u)
                              : shown.number(step.size, step.u);
  }

  void add_table(Blocks& blocks) const {
    constexpr const char* states[] = {"as_found", "as_left", "check"};
    Table table;
    table.columns = {{w_.get("history.axis"), ""},  {w_.get("history.quantity"), ""},
                     {w_.get("history.state"), ""}, {w_.get("history.value"), "", true},
                     {w_.get("history.unit"), ""},  {w_.get("history.before"), "", true},
                     {w_.get("history.since"), ""}, {w_.get("history.difference"), "", true},
                     {w_.get("history.says"), ""}};
    for (const std::size_t i : shown_) {
      const HistorySeries& s = h_.series[i];
      std::vector<std::size_t> own;
      for (std::size_t k = 0; k < s.points.size(); ++k)
        if (s.points[k].campaign == id_) own.push_back(k);
      for (const std::size_t k : own) {
        const Before b = before(i, k);
        const std::string unit = unit_text(numbers(s).quantity());
        const bool last = k == own.back();
        table.rows.push_back(
            {{s.axis.empty() ? "–" : s.axis},
             {name(s)},
             {w_.get("history." + std::string(states[static_cast<int>(s.points[k].state)]))},
             {printed(s, s.points[k]), true},
             {unit.empty() ? "–" : unit},
             {b.value},
             {b.since},
             {b.difference},
             {last ? (b.any || is_largest(s) ? statement(s) : first_value(s)) : "",
              last && !s.changes.empty()}});
      }
    }
    if (!table.rows.empty()) blocks.push_back({std::move(table), history_field});
  }

  struct Time {
    double first = 0.0;
    bool years = false;
    double at(const std::string& day) const {
      const double number = day_number(day);
      return years ? 1970.0 + number / days_a_year : (number - first) / (days_a_year / 12.0);
    }
  };
  Time time() const {
    Time out{day_number(h_.day)};
    for (const std::size_t i : shown_)
      for (const HistoryPoint& p : h_.series[i].points)
        out.first = std::min(out.first, day_number(p.date));
    out.years = day_number(h_.day) - out.first > 2.5 * days_a_year;
    return out;
  }
  std::string first_day(const Time& time) const {
    for (const std::size_t i : shown_)
      for (const HistoryPoint& p : h_.series[i].points)
        if (day_number(p.date) == time.first) return p.date;
    return h_.day;
  }

  Plot plot(const HistorySeries& s, const Time& time, double height) const {
    const Style& style = source_.look.style;
    const FollowedNumbers shown = numbers(s);
    Plot out;
    out.title = (s.axis.empty() ? "" : s.axis + " · ") + name(s);
    out.x_title = time.years ? w_.get("history.year")
                             : w_.get("history.months_since", {{"date", first_day(time)}});
    out.y_title = unit_text(shown.quantity());
    out.language = source_.language();
    out.whole = time.years;
    out.zero_line = false;
    out.height = height;
    Curve bars[2], marks[4];
    double low = INFINITY, high = -INFINITY;
    const auto widen = [&](double y) { low = std::min(low, y), high = std::max(high, y); };
    for (const HistoryPoint& p : s.points) {
      const double x = time.at(p.date), y = shown.in_unit(p.value);
      const double low_end = shown.in_unit(p.value - 2.0 * p.u),
                   high_end = shown.in_unit(p.value + 2.0 * p.u);
      Curve& mark = marks[p.joined ? static_cast<int>(p.state) : 3];
      Curve& bar = bars[p.joined ? 0 : 1];
      mark.x.push_back(x), mark.y.push_back(y);
      bar.x.push_back(x), bar.y.push_back(low_end), bar.y2.push_back(high_end);
      widen(low_end), widen(high_end);
    }
    const double left = time.at(first_day(time)), right = time.at(h_.day);
    const double margin = std::max(0.04 * (right - left), 0.01);
    const auto across = [&](double y) {
      widen(y);
      out.curves.push_back(
          line({left - margin, right + margin}, {y, y}, style.failed, Dash::solid));
    };
    if (s.limit) {
      across(shown.in_unit(*s.limit));
      if (!is_largest(s)) across(-shown.in_unit(*s.limit));
    }
    const double edge = std::max(0.06 * (high - low), 1e-9);
    out.range = {low - edge, high + edge};
    Curve margins = line({left - margin, right + margin}, {low, low}, style.text, Dash::solid);
    margins.kind = Curve::Kind::points;
    out.curves.push_back(std::move(margins));
    for (const MachineEvent& e : h_.events)
      if (const double x = time.at(e.date);
          x >= left && x <= right && (e.axis.empty() || e.axis == s.axis))
        out.curves.push_back(
            line({x, x}, {out.range->first, out.range->second}, style.muted, Dash::dotted));
    for (const HistorySegment& g : s.segments) {
      std::vector<double> x, y;
      const int steps = shown.is_scatter() ? 8 : 1;  // a straight line of logarithms is a curve
      for (int i = 0; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        x.push_back(std::lerp(time.at(g.from), time.at(g.to), t));
        y.push_back(shown.in_unit(std::lerp(g.first, g.last, t)));
      }
      out.curves.push_back(line(std::move(x), std::move(y), style.plus, Dash::solid));
    }
    for (Curve& c : bars) {
      c.kind = Curve::Kind::bars, c.colour = &c == bars ? style.accent : style.rule, c.width = 0.7;
      if (!c.x.empty()) out.curves.push_back(std::move(c));
    }
    constexpr Marker markers[] = {Marker::dot, Marker::ring, Marker::up, Marker::dot};
    for (std::size_t k = 0; k < 4; ++k) {
      Curve& c = marks[k];
      c.kind = Curve::Kind::points, c.marker = markers[k], c.marker_size = 2.2;
      c.colour = k == 3 ? style.rule : style.accent;
      if (!c.x.empty()) out.curves.push_back(std::move(c));
    }
    return out;
  }
  static Curve line(std::vector<double> x, std::vector<double> y, Colour colour, Dash dash) {
    Curve c;
    c.x = std::move(x), c.y = std::move(y), c.colour = colour, c.dash = dash, c.width = 0.8;
    return c;
  }

  std::vector<std::size_t> drawn(double height, std::size_t per_row) const {
    constexpr double line = 8.6, around = 2.4;
    double taken = 150 + line * std::ceil(static_cast<double>(events().size()) / 140.0);
    for (const std::size_t i : shown_) {
      const HistorySeries& s = h_.series[i];
      const double lines = is_largest(s) ? 1 : s.changes.empty() ? 2 : 3;
      const auto own = std::count_if(s.points.begin(), s.points.end(),
                                     [&](const HistoryPoint& p) { return p.campaign == id_; });
      taken += line * lines + around + (line + around) * static_cast<double>(own - 1);
    }
    const double rows = std::floor((page_room(source_.look.style) - taken) / (height + 7));
    const std::size_t most = per_row * static_cast<std::size_t>(std::clamp(rows, 1.0, 6.0));
    std::vector<std::size_t> out = shown_;
    const auto later = [&](std::size_t i) {
      const HistorySeries& s = h_.series[i];
      return s.changes.empty() && (is_largest(s) ? rank(s) > 2 : rank(s) > 12);
    };
    std::stable_partition(out.begin(), out.end(), [&](std::size_t i) { return !later(i); });
    if (out.size() > most) out.resize(most);
    std::vector<std::size_t> in_order;
    for (const std::size_t i : shown_)
      if (std::find(out.begin(), out.end(), i) != out.end()) in_order.push_back(i);
    return in_order;
  }

  void add_plots(Blocks& blocks) const {
    constexpr std::size_t per_row = 3;
    constexpr double height = 92;
    const Time scale = time();
    const std::vector<std::size_t> all = drawn(height, per_row);
    for (std::size_t i = 0; i < all.size(); i += per_row) {
      Columns row;
      for (std::size_t k = i; k < i + per_row; ++k)
        row.parts.push_back(k < all.size()
                                ? Blocks{{plot(h_.series[all[k]], scale, height), history_field}}
                                : Blocks{});
      blocks.push_back({std::move(row), history_field});
    }
  }

  std::string last_change() const {
    const HistorySeries* series = nullptr;
    const HistoryChange* last = nullptr;
    for (const std::size_t i : shown_)
      for (const HistoryChange& c : h_.series[i].changes)
        if (last == nullptr || c.before > last->before ||
            (c.before == last->before && std::fabs(c.size) * last->u > std::fabs(last->size) * c.u))
          series = &h_.series[i], last = &c;
    if (last == nullptr) return w_.get("history.none_changed");
    return without_gaps(w_.get(
        "history.last_change",
        {{"axis", series->axis}, {"quantity", name(*series)}, {"what", change(*series, *last)}}));
  }

  std::string events() const {
    if (h_.events.empty()) return w_.get("history.no_events");
    constexpr std::size_t most = 8;
    std::string all;
    const std::size_t from = h_.events.size() > most ? h_.events.size() - most : 0;
    for (std::size_t i = from; i < h_.events.size(); ++i) {
      const MachineEvent& e = h_.events[i];
      all += (all.empty() ? "" : "; ") + e.date + " " + e.axis + (e.axis.empty() ? "" : " ") +
             kind(e.kind) + (e.text.empty() ? "" : ": " + visible(e.text));
    }
    if (from > 0) all += "; " + w_.get("history.more_events", {{"count", std::to_string(from)}});
    return w_.get("history.events", {{"events", all}});
  }

  std::string next_due() const {
    if (!h_.due.empty())
      return w_.get("history.due", {{"date", h_.due}, {"months", std::to_string(h_.months)}});
    for (const HistorySeries& s : h_.series)
      if (s.forecast) return w_.get("history.expected", {{"date", s.forecast->date}});
    return w_.get("history.no_due");
  }

  const Source& source_;
  const Wording& w_;
  const HistorySoFar& h_;
  const std::string& id_;
  std::vector<std::size_t> shown_{};
};

}  // namespace

void add_history(const Source& source, Blocks& blocks) {
  if (!source.in.options.flag("history")) return;
  if (source.in.history != nullptr && !source.in.history->campaigns.empty())
    blocks.push_back({PageBreak{}});
  blocks.push_back({Heading{source.words.get("history.title"), 1}, history_field});
  if (source.in.history == nullptr)
    blocks.push_back({Paragraph{source.words.get("history.not_yet")}, history_field});
  else
    HistoryPage(source, *source.in.history).add(blocks);
}

}  // namespace nonio::pdf_report
