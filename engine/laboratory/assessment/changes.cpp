// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/changes.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "laboratory/statistics/families.h"

namespace nonio::assessment {

namespace {

namespace kernel = nonio::statistics;
using Cause = kernel::Change::Cause;

constexpr double excess_step = 0.05;
constexpr double spread_step = 0.1;  // step of the logarithm of the spread

/// A step at a change of the instrument with a p below this value has another cause, because the
/// calibration error would be unusually large for its uncertainty, which the covariance contains.
constexpr double no_instrument_below = 1e-4;

/// Step to which counts are rounded, so that one more series hardly changes the trends of others.
std::uint64_t step_of(std::uint64_t n) {
  constexpr std::uint64_t very_many = 10'000;
  std::uint64_t step = 1;
  while (n >= very_many && n / step >= 100) step *= 10;
  return step;
}
std::uint64_t upwards(std::uint64_t n) { return (n + step_of(n) - 1) / step_of(n) * step_of(n); }

void fit_again(FollowedSeries& s, Fits& fits) {
  s.trend = fits.trend(s.series);
  s.p_adjusted.assign(s.trend.changes.size(), 1.0);
  s.significant.assign(s.trend.changes.size(), false);
  s.mailed.assign(s.trend.changes.size(), false);
}

bool shows_instrument(const FollowedSeries& s, std::size_t gap) {
  const auto& parts = s.series.points[gap + 1].common;
  return std::any_of(parts.begin(), parts.end(),
                     [](const kernel::Common& c) { return !is_targets(c.source); }) &&
         std::any_of(s.series.declared.begin(), s.series.declared.end(),
                     [&](const kernel::Declared& d) {
                       return d.after == gap && d.kind == kernel::Declared::Kind::instrument;
                     });
}

struct Asked {
  double p = 1.0;
  Adjusted* adjusted = nullptr;
};

/// There are `asked` tests; those without a candidate have p = 1.
void adjust(const std::vector<Asked>& tests, std::size_t asked, double Adjusted::*which,
            std::vector<double> by(const std::vector<double>&)) {
  std::vector<double> p(std::max(asked, tests.size()), 1.0);
  for (std::size_t i = 0; i < tests.size(); ++i) p[i] = tests[i].p;
  const auto all = by(p);
  for (std::size_t i = 0; i < tests.size(); ++i) tests[i].adjusted->*which = all[i];
}

struct Place {
  std::string axis;
  std::string after, before;
  bool operator<(const Place& o) const {
    return std::tie(axis, after, before) < std::tie(o.axis, o.after, o.before);
  }
};

const std::string& day_of(const AssessedMachine& m, const FollowedSeries& s, std::size_t point) {
  return m.stored.campaigns[m.stored.results[s.results[point]].campaign].day;
}

std::set<Place> places_of(const AssessedMachine& m) {
  std::set<Place> out;
  for (const FollowedSeries& s : m.followed)
    for (std::size_t i = 0; i < s.trend.changes.size(); ++i)
      if (const kernel::Change& c = s.trend.changes[i];
          s.significant[i] && !c.declared && c.cause != Cause::instrument)
        out.insert({s.axis, day_of(m, s, c.after), day_of(m, s, c.after + 1)});
  return out;
}

std::optional<std::size_t> gap_of(const AssessedMachine& m, const FollowedSeries& s,
                                  const Place& place) {
  for (std::size_t k = 0; k + 1 < s.results.size(); ++k) {
    if (day_of(m, s, k) > place.after || day_of(m, s, k + 1) < place.before) continue;
    const bool taken = std::any_of(s.trend.changes.begin(), s.trend.changes.end(),
                                   [&](const kernel::Change& c) { return c.after == k; });
    return taken ? std::nullopt : std::optional(k);
  }
  return std::nullopt;
}

/// Tests for a step at a significant change of another quantity. p needs no adjustment for the
/// number of positions, because only this position is tested.
void ask_there(FollowedSeries& s, std::size_t gap, double level, Fits& fits) {
  FollowedSeries tried = s;
  tried.series.declared.push_back({gap, kernel::Declared::Kind::event});
  tried.kinds.emplace_back();
  tried.said.emplace_back();
  fit_again(tried, fits);
  const std::size_t last = tried.series.declared.size() - 1;
  for (std::size_t i = 0; i < tried.trend.changes.size(); ++i) {
    kernel::Change& c = tried.trend.changes[i];
    if (c.declared != last || !(c.p < (shows_instrument(s, gap) ? no_instrument_below : level)))
      continue;
    c.cause = Cause::undeclared;
    c.declared.reset();
    tried.significant[i] = true;
    tried.p_adjusted[i] = c.p;
    // The added step does not affect the decisions on the other changes.
    for (std::size_t k = 0; k < s.trend.changes.size(); ++k)
      for (std::size_t j = 0; j < tried.trend.changes.size(); ++j)
        if (tried.trend.changes[j].after == s.trend.changes[k].after) {
          tried.significant[j] = s.significant[k];
          tried.p_adjusted[j] = s.p_adjusted[k];
          tried.mailed[j] = s.mailed[k];
        }
    tried.series.declared.pop_back();
    tried.kinds.pop_back();
    tried.said.pop_back();
    s = std::move(tried);
    return;
  }
}

}  // namespace

std::uint64_t learned_from(std::uint64_t evaluations) {
  return step_of(evaluations) == 1 ? std::numeric_limits<std::uint64_t>::max()
                                   : evaluations / step_of(evaluations) * step_of(evaluations);
}

Lesson lesson_of(const FollowedSeries& s, Fits& fits, std::uint64_t evaluations) {
  const auto later = std::find_if(s.evaluations.begin(), s.evaluations.end(),
                                  [&](std::uint64_t e) { return e > evaluations; });
  const kernel::Series known =
      first_points(s, static_cast<std::size_t>(later - s.evaluations.begin()));
  Lesson out{s.quantity + " " + s.unit, s.series.points.size(), {}, {}};
  if (known.points.empty()) return out;
  out.slope = fits.slope(known);
  for (const kernel::Scatter& one : kernel::scatter_of(known)) out.ratios.push_back(one.ratio);
  return out;
}

Learned learn(const std::vector<const Lesson*>& lessons) {
  std::map<std::string, std::vector<const Lesson*>> all;
  std::uint64_t asked = 0;
  for (const Lesson* lesson : lessons) {
    all[lesson->quantity].push_back(lesson);
    asked += lesson->points >= 3;
  }
  Learned out;
  for (const auto& [quantity, of_quantity] : all) {
    OfQuantity& of = out.of[quantity];
    std::vector<kernel::Slope> slopes;
    std::vector<double> ratios;
    for (const Lesson* lesson : of_quantity) {
      if (lesson->slope) slopes.push_back(*lesson->slope);
      ratios.insert(ratios.end(), lesson->ratios.begin(), lesson->ratios.end());
    }
    of.p = kernel::p_of_ratios(ratios);
    of.excess = std::round(kernel::excess_of_ratios(std::move(ratios)) / excess_step) * excess_step;
    for (kernel::Slope& slope : slopes) slope.u *= of.excess;
    if (const double spread = kernel::spread_of_slopes(slopes); spread > 0.0)
      of.spread = std::exp(std::round(std::log(spread) / spread_step) * spread_step);
  }
  out.drift_below = significant_below / static_cast<double>(upwards(asked));
  return out;
}

Manner manner_of(const std::string& quantity, const Learned& learned) {
  const OfQuantity& of = learned.of.at(quantity);
  return {of.excess, of.spread, std::min(kernel::Series{}.drift_below, learned.drift_below)};
}

void fit(FollowedSeries& s, const Manner& manner, Fits& fits) {
  s.series.excess = manner.excess;
  s.series.spread = manner.spread;
  s.series.drift_below = manner.drift_below;
  s.series.steps.reset();
  fit_again(s, fits);
}

SeriesTests tests_of(const FollowedSeries& s) {
  SeriesTests out{s.run, s.trend.model != kernel::Model::none, {}};
  for (const kernel::Change& c : s.trend.changes)
    out.changes.push_back({c.p, c.declared.has_value(), shows_instrument(s, c.after)});
  return out;
}

/// Changes with and without an event are separate families for `Adjusted::news` and one family for
/// `Adjusted::any`.
std::vector<std::vector<Adjusted>> adjusted_by_run(
    const std::vector<const SeriesTests*>& tests,
    const std::map<std::uint64_t, std::uint64_t>& asked) {
  std::vector<std::vector<Adjusted>> out;
  for (const SeriesTests* s : tests) out.emplace_back(s->changes.size());
  std::map<std::uint64_t, std::vector<Asked>> unsaid, said;
  // Number of series with a model, by run of the last point.
  std::map<std::uint64_t, std::size_t> still;
  for (std::size_t k = 0; k < tests.size(); ++k) {
    const SeriesTests& s = *tests[k];
    still[s.run] += s.has_model;
    for (std::size_t i = 0; i < s.changes.size(); ++i)
      (s.changes[i].declared ? said : unsaid)[s.run].push_back({s.changes[i].p, &out[k][i]});
  }
  for (const auto& [run, open] : still) {
    const auto found = asked.find(run);
    const std::size_t many = std::max(found == asked.end() ? 0 : found->second, open);
    std::vector<Asked> all = unsaid[run];
    adjust(all, many, &Adjusted::news, kernel::benjamini_hochberg);
    adjust(said[run], 0, &Adjusted::news, kernel::benjamini_hochberg);
    all.insert(all.end(), said[run].begin(), said[run].end());
    adjust(all, many + said[run].size(), &Adjusted::any, kernel::holm);
  }
  return out;
}

Verdict verdict_of(const SeriesTests::Of& test, const Adjusted& adjusted) {
  Verdict out;
  out.surely = adjusted.news < no_instrument_below;
  out.significant =
      adjusted.news < significant_below && (!test.declared || test.p < declared_below);
  if (test.shows_instrument && test.declared) out.significant = out.significant && out.surely;
  out.mailed = out.significant && adjusted.any < mailed_below;
  return out;
}

void tell(FollowedSeries& s, const std::vector<Adjusted>& adjusted) {
  const SeriesTests tests = tests_of(s);
  for (std::size_t i = 0; i < s.trend.changes.size(); ++i) {
    kernel::Change& c = s.trend.changes[i];
    const Verdict verdict = verdict_of(tests.changes[i], adjusted[i]);
    s.p_adjusted[i] = adjusted[i].news;
    s.significant[i] = verdict.significant;
    s.mailed[i] = verdict.mailed;
    if (tests.changes[i].shows_instrument && c.cause == Cause::instrument && verdict.surely)
      c.cause = Cause::undeclared;
  }
}

void drop_unstated(FollowedSeries& s, Fits& fits) {
  std::vector<std::size_t> places;
  bool all = true;
  for (std::size_t i = 0; i < s.trend.changes.size(); ++i) {
    if (s.trend.changes[i].declared) continue;
    all = all && s.significant[i];
    if (s.significant[i]) places.push_back(s.trend.changes[i].after);
  }
  if (all) return;
  const FollowedSeries judged = s;
  s.series.steps = std::move(places);
  fit_again(s, fits);
  for (std::size_t j = 0; j < s.trend.changes.size(); ++j)
    for (std::size_t k = 0; k < judged.trend.changes.size(); ++k) {
      kernel::Change& c = s.trend.changes[j];
      const kernel::Change& before = judged.trend.changes[k];
      if (c.after != before.after || c.declared != before.declared) continue;
      c.p = before.p, c.cause = before.cause;
      s.p_adjusted[j] = judged.p_adjusted[k];
      s.significant[j] = judged.significant[k], s.mailed[j] = judged.mailed[k];
    }
}

void ask_others(AssessedMachine& m, Fits& fits) {
  for (const Place& place : places_of(m)) {
    std::vector<std::pair<FollowedSeries*, std::size_t>> others;
    for (FollowedSeries& s : m.followed)
      if (s.axis == place.axis && s.trend.model != kernel::Model::none)
        if (const auto gap = gap_of(m, s, place)) others.emplace_back(&s, *gap);
    for (const auto& [series, gap] : others)
      ask_there(*series, gap, significant_below / static_cast<double>(others.size()), fits);
  }
}

std::map<std::string, OfQuantity> learn(std::vector<AssessedMachine>& machines, Fits& fits) {
  std::vector<Lesson> lessons;
  for (const AssessedMachine& m : machines)
    for (const FollowedSeries& s : m.followed) lessons.push_back(lesson_of(s, fits));
  std::vector<const Lesson*> all;
  for (const Lesson& lesson : lessons) all.push_back(&lesson);
  const Learned learned = learn(all);
  for (AssessedMachine& m : machines)
    for (FollowedSeries& s : m.followed) {
      const Manner manner = manner_of(s.quantity + " " + s.unit, learned);
      s.series.excess = manner.excess;
      s.series.spread = manner.spread;
      s.series.drift_below = manner.drift_below;
    }
  return learned.of;
}

void find_changes(std::vector<AssessedMachine>& machines,
                  const std::map<std::uint64_t, std::uint64_t>& asked, Fits& fits,
                  const std::function<void()>& alive) {
  std::vector<SeriesTests> tests;
  for (AssessedMachine& m : machines) {
    alive();
    for (FollowedSeries& s : m.followed) {
      fit_again(s, fits);
      tests.push_back(tests_of(s));
    }
  }
  std::vector<const SeriesTests*> all;
  for (const SeriesTests& t : tests) all.push_back(&t);
  const auto p = adjusted_by_run(all, asked);
  std::size_t k = 0;
  for (AssessedMachine& m : machines)
    for (FollowedSeries& s : m.followed) {
      tell(s, p[k++]);
      drop_unstated(s, fits);
    }
  for (AssessedMachine& m : machines) ask_others(m, fits);
}

}  // namespace nonio::assessment
