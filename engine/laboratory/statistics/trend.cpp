// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/trend.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "laboratory/statistics/gls.h"
#include "laboratory/statistics/walk.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/splitmix64.h"

namespace nonio::statistics {
namespace {

constexpr int most_steps = 3;
constexpr int draws = 10000, batch = 100;
constexpr double sharp = 1e-3;  // p below which Bonferroni's bound is nearly exact
// Difference of chi2 below which a line and a step cannot be distinguished.
constexpr double inseparable = 4;
constexpr std::size_t fewest_for_walk = 8;

struct Shape {
  std::vector<Change> changes;
  bool drifts = false;
  bool free = false;  ///< whether the slope is fitted without its prior
};

class Columns {
 public:
  explicit Columns(const Series& s) : s_(s), n_(static_cast<Index>(s.points.size())) {}

  VectorXd ones() const { return VectorXd::Ones(n_); }
  VectorXd step(std::size_t after) const {
    VectorXd out = VectorXd::Zero(n_);
    out.tail(n_ - static_cast<Index>(after) - 1).setOnes();
    return out;
  }
  /// Time since the first point, so that the level is that of the first point.
  VectorXd time() const {
    VectorXd out(n_);
    for (Index i = 0; i < n_; ++i)
      out(i) = s_.points[static_cast<std::size_t>(i)].time - s_.points.front().time;
    return out;
  }
  MatrixXd of(const Shape& shape) const {
    MatrixXd X(n_, 1 + static_cast<Index>(shape.changes.size()) + (shape.drifts ? 1 : 0));
    X.col(0) = ones();
    for (std::size_t k = 0; k < shape.changes.size(); ++k)
      X.col(static_cast<Index>(k) + 1) = step(shape.changes[k].after);
    if (shape.drifts) X.rightCols(1) = time();
    return X;
  }

 private:
  const Series& s_;
  Index n_;
};

class Trending {
 public:
  explicit Trending(const Series& s) : s_(s), columns_(s), w_(s) {}

  Trend run() {
    // A slope with a prior is part of the model without a test.
    shape_.drifts = s_.spread > 0.0 && s_.points.size() >= 3;
    if (shape_.drifts && !fit(shape_)) shape_.drifts = false;
    declare();
    if (s_.steps) know_steps(*s_.steps);
    for (int step = 0; step <= most_steps; ++step)
      if (!improve()) break;
    prefer_steps();
    Trend out = fitted();
    smallest(out);
    walk(out);
    return out;
  }

 private:
  MatrixXd whitened(const Shape& shape) const {
    const MatrixXd X = columns_.of(shape);
    MatrixXd out(w_.y.size(), X.cols());
    for (Index k = 0; k < X.cols(); ++k)
      out.col(k) = shape.drifts && !shape.free && k + 1 == X.cols() ? w_.slope(X.col(k))
                                                                    : w_.column(X.col(k));
    return out;
  }
  std::optional<Gls> fit(const Shape& shape) const {
    auto out = gls(w_, whitened(shape));
    if (out && w_.spread > 0.0 && !(shape.drifts && !shape.free)) out->dof -= 1.0;
    return out;
  }

  /// No step is added at a change of the instrument, because the covariance contains the
  /// uncertainty of the instruments. If a step is found at this point, its cause is the instrument.
  void declare() {
    for (std::size_t d = 0; d < s_.declared.size(); ++d) {
      const Declared& known = s_.declared[d];
      if (known.kind == Declared::Kind::instrument || taken(known.after)) continue;
      Shape more = shape_;
      more.changes.push_back(
          {known.after, 0.0, 0.0, 1.0,
           known.kind == Declared::Kind::table ? Change::Cause::table : Change::Cause::event, d});
      if (fit(more)) shape_ = std::move(more);
    }
  }

  void know_steps(const std::vector<std::size_t>& places) {
    for (const std::size_t after : places) {
      if (taken(after)) continue;
      Shape more = shape_;
      more.changes.push_back({after, 0.0, 0.0, 1.0, cause_at(after), {}});
      if (!fit(more)) continue;
      shape_ = std::move(more);
      ++steps_;
    }
  }

  bool taken(std::size_t after) const {
    return std::any_of(shape_.changes.begin(), shape_.changes.end(),
                       [&](const Change& c) { return c.after == after; });
  }

  /// Columns of a step after each point that has none yet: whitened, orthogonal to the present
  /// model and of unit length. Steps that are not identifiable are omitted.
  struct Places {
    std::vector<std::size_t> after;
    MatrixXd direction;
    VectorXd length;  // 1/u of the size of the step
  };

  Places places(const Gls& base) const {
    Places out;
    std::vector<VectorXd> found;
    std::vector<double> lengths;
    for (std::size_t k = 0; k + 1 < s_.points.size(); ++k) {
      if (taken(k)) continue;
      const VectorXd z = w_.column(columns_.step(k));
      const VectorXd rest = math::orthogonal_part(base.basis, z);
      const double length = rest.norm();
      if (!(length > 1e-9 * z.norm())) continue;
      out.after.push_back(k);
      found.emplace_back(rest / length);
      lengths.push_back(length);
    }
    out.direction.resize(w_.y.size(), static_cast<Index>(found.size()));
    out.length.resize(static_cast<Index>(found.size()));
    for (std::size_t k = 0; k < found.size(); ++k) {
      out.direction.col(static_cast<Index>(k)) = found[k];
      out.length(static_cast<Index>(k)) = lengths[k];
    }
    return out;
  }

  /// P(largest G > G) for a series without a step.
  double p_of_largest(const Places& places, double G) const {
    const auto many = static_cast<double>(places.after.size());
    const double of_one = normal_two_sided(std::sqrt(G));
    const double bound = std::min(1.0, many * of_one);
    if (bound < sharp || of_one >= named_below || places.after.size() == 1) return bound;
    SplitMix64 random(s_.seed);
    int beyond = 0;
    VectorXd noise(w_.y.size() + w_.y.size() % 2);
    for (int draw = 1; draw <= draws; ++draw) {
      for (Index i = 0; i < noise.size(); i += 2) {
        const double r = std::sqrt(-2.0 * std::log1p(-random.uniform()));
        const double angle = 2.0 * std::numbers::pi * random.uniform();
        noise(i) = r * std::cos(angle), noise(i + 1) = r * std::sin(angle);
      }
      beyond +=
          math::transposed_times(places.direction, noise.head(w_.y.size())).cwiseAbs2().maxCoeff() >
          G;
      if ((draw % batch == 0 && is_surely_more(beyond, draw)) ||
          // The first batch will exceed the limit in any case.
          (draw < batch && is_surely_more(beyond, batch)))
        return std::min(bound, (beyond + 1.0) / (draw + 1.0));
    }
    return std::min(bound, (beyond + 1.0) / (draws + 1.0));
  }

  /// Whether more draws would not change the decision: the exceedances are more than 5 standard
  /// deviations above the number expected at the significance level.
  static bool is_surely_more(int beyond, int of) {
    const double expected = named_below * of;
    return beyond > expected + 5.0 * std::sqrt(expected);
  }

  /// Adds the most significant step or a drift; of both the drift, unless its chi2 is more than
  /// `inseparable` larger. Returns false if neither is significant.
  bool improve() {
    const auto base = fit(shape_);
    if (!base || !(base->dof > 0.0)) return false;
    Shape stepped = shape_, drifting = shape_;
    double p_step = 1.0, p_drift = 1.0;
    const Places at = places(*base);
    if (!s_.steps && !at.after.empty() && steps_ < most_steps) {
      Index best = 0;
      const double G = math::transposed_times(at.direction, w_.y).cwiseAbs2().maxCoeff(&best);
      p_step = p_of_largest(at, G);
      stepped.changes.push_back({at.after[static_cast<std::size_t>(best)],
                                 0.0,
                                 0.0,
                                 p_step,
                                 cause_at(at.after[static_cast<std::size_t>(best)]),
                                 {}});
    }
    std::optional<Gls> with_step, with_drift;
    if (p_step < named_below) with_step = fit(stepped);
    if ((!shape_.drifts || (w_.spread > 0.0 && !shape_.free)) && s_.points.size() >= 3) {
      drifting.drifts = drifting.free = true;
      with_drift = fit(drifting);
      if (with_drift)
        p_drift = normal_two_sided(std::sqrt(std::max(0.0, base->chi2 - with_drift->chi2)));
      if (!(p_drift < s_.drift_below)) with_drift.reset();
    }
    if (!with_step && !with_drift) return false;
    const bool line =
        with_drift && (!with_step || with_drift->chi2 <= with_step->chi2 + inseparable);
    line_or_step_ = line_or_step_ || (with_step && with_drift &&
                                      std::fabs(with_drift->chi2 - with_step->chi2) < inseparable);
    shape_ = line ? std::move(drifting) : std::move(stepped);
    steps_ += line ? 0 : 1;
    return true;
  }

  /// A drift with steps against it: steps alone, if they are about as good, because the steps of the
  /// line are then in no two campaigns.
  void prefer_steps() {
    if (!shape_.free || steps_ < 1 || s_.steps) return;
    const auto with_drift = fit(shape_);
    if (!with_drift) return;
    const double slope = with_drift->b(with_drift->b.size() - 1);
    bool against = false;
    for (std::size_t k = 0; k < shape_.changes.size(); ++k)
      against = against || (!shape_.changes[k].declared &&
                            with_drift->b(static_cast<Index>(k) + 1) * slope < 0.0);
    if (!against) return;
    const Shape line = shape_;
    shape_.free = false, shape_.drifts = s_.spread > 0.0;
    if (shape_.drifts && !fit(shape_)) shape_.drifts = false;
    std::erase_if(shape_.changes, [](const Change& c) { return !c.declared; });
    const double enough = with_drift->chi2 + inseparable;
    auto best = fit(shape_);
    int steps = 0;
    while (best && best->chi2 > enough && steps < most_steps) {
      const Places at = places(*best);
      if (at.after.empty()) break;
      Index largest = 0;
      math::transposed_times(at.direction, w_.y).cwiseAbs2().maxCoeff(&largest);
      const std::size_t after = at.after[static_cast<std::size_t>(largest)];
      shape_.changes.push_back({after, 0.0, 0.0, 1.0, cause_at(after), {}});
      best = fit(shape_);
      ++steps;
    }
    if (!best || best->chi2 > enough) {
      shape_ = line;
      return;
    }
    steps_ = steps;
    for (std::size_t k = 0; k < shape_.changes.size(); ++k) {
      Change& c = shape_.changes[k];
      const auto i = static_cast<Index>(k) + 1;
      if (!c.declared)
        c.p = std::min(1.0, static_cast<double>(s_.points.size() - 1) *
                                normal_two_sided(best->b(i) / std::sqrt(best->C(i, i))));
    }
  }

  Change::Cause cause_at(std::size_t after) const {
    for (const Declared& d : s_.declared)
      if (d.kind == Declared::Kind::instrument && d.after == after &&
          !s_.points[after + 1].common.empty())
        return Change::Cause::instrument;
    return Change::Cause::undeclared;
  }

  /// The prior helps to detect steps, but the reported slope must come from the points of this
  /// machine alone.
  void free_slope(Shape& shape) const {
    Shape own = shape;
    own.drifts = own.free = true;
    const bool wanted = shape.drifts || s_.own_slope;
    if (wanted && s_.points.size() >= 3 && fit(own)) shape = std::move(own);
  }

  Trend fitted() const {
    Trend out;
    const auto held = fit(shape_);
    if (!held) return out;
    Shape with_slope = shape_;
    free_slope(with_slope);
    const Gls last = *fit(with_slope);
    const Index p = last.b.size();
    out.chi2 = held->chi2, out.dof = held->dof, out.drifts = with_slope.drifts;
    out.line_or_step = line_or_step_;
    out.coefficients.assign(last.b.begin(), last.b.end());
    for (Index i = 0; i < p; ++i)
      for (Index j = 0; j < p; ++j) out.covariance.push_back(last.C(i, j));
    out.changes = shape_.changes;
    for (std::size_t k = 0; k < out.changes.size(); ++k) {
      const auto i = static_cast<Index>(k) + 1;
      Change& c = out.changes[k];
      c.size = held->b(i), c.u = std::sqrt(held->C(i, i));
      if (c.declared) c.p = normal_two_sided(c.size / c.u);
    }
    segments(last, with_slope, out);
    std::stable_sort(out.changes.begin(), out.changes.end(),
                     [](const Change& a, const Change& b) { return a.after < b.after; });
    const bool undeclared = std::any_of(out.changes.begin(), out.changes.end(),
                                        [](const Change& c) { return !c.declared; });
    out.model = s_.points.size() < 3 ? Model::none
                : undeclared         ? Model::step
                : is_drift(last)     ? Model::drift
                                     : Model::level;
    return out;
  }

  /// A slope that is in the model without a test must be significant.
  bool is_drift(const Gls& last) const {
    const Index i = last.b.size() - 1;
    return shape_.drifts &&
           (shape_.free || normal_two_sided(last.b(i) / std::sqrt(last.C(i, i))) < named_below);
  }

  void segments(const Gls& last, const Shape& with_slope, Trend& out) const {
    std::set<std::size_t> ends{s_.points.size() - 1};
    for (const Change& c : with_slope.changes) ends.insert(c.after);
    const MatrixXd X = columns_.of(with_slope);
    const auto u_of = [&](std::size_t i) {
      const VectorXd x = X.row(static_cast<Index>(i)).transpose();
      return std::sqrt(x.dot(last.C * x));
    };
    std::size_t from = 0;
    for (const std::size_t to : ends) {
      Segment s{from,
                to,
                X.row(static_cast<Index>(from)).dot(last.b),
                X.row(static_cast<Index>(to)).dot(last.b),
                u_of(from),
                u_of(to)};
      if (with_slope.drifts) {
        s.slope = last.b(last.b.size() - 1);
        s.u_slope = std::sqrt(last.C(last.b.size() - 1, last.b.size() - 1));
      }
      out.segments.push_back(s);
      from = to + 1;
    }
  }

  void smallest(Trend& out) const {
    const auto base = fit(shape_);
    if (!base || s_.points.size() < 2) return;
    const Places at = places(*base);
    if (at.after.empty()) return;
    const double critical =
        math::normal_quantile(1.0 - named_below / 2.0 / static_cast<double>(at.after.size()));
    out.smallest_change = (critical + math::normal_quantile(0.8)) / at.length(at.length.size() - 1);
  }

  /// Uses a random walk (local level, variance by maximum likelihood, independent u) for eight
  /// points or more without steps at declared events, if a level does not fit or there are two or
  /// more undeclared steps, and if its likelihood is larger than that of the steps with their
  /// penalty. At the border q = 0 the likelihood ratio is half a chi-square with 1 degree of
  /// freedom.
  void walk(Trend& out) const {
    // 99 % quantile of half a chi-square with 1 degree of freedom.
    constexpr double at_border = 5.412;
    const bool restless = math::chi2_upper(out.chi2, out.dof) < named_below;
    if (s_.steps && !s_.steps->empty()) return;
    if (s_.points.size() < fewest_for_walk || static_cast<int>(shape_.changes.size()) > steps_ ||
        !(steps_ > 1 || (steps_ == 0 && out.model == Model::level && restless)))
      return;
    for (const Change& c : shape_.changes)
      if (c.cause == Change::Cause::instrument) return;
    const Walk walk = likeliest_walk(s_);
    const double better = 2.0 * (walk.log_likelihood - walk_with(s_, 0.0).log_likelihood);
    if (!(better > at_border) || (steps_ > 1 && !(better - 2.0 > gained(out)))) return;
    as_one_segment(out);
    out.model = Model::walk, out.walk = walk.q;
    out.coefficients = {walk.state}, out.covariance = {walk.variance};
    for (Segment& s : out.segments) s.last = walk.state, s.u_last = std::sqrt(walk.variance);
  }

  /// Returns the decrease of chi2 from a constant level minus the penalties: 3 ln n per step and 2
  /// for a slope.
  double gained(const Trend& out) const {
    const auto level = fit(Shape{});
    const double price = 3.0 * std::log(static_cast<double>(s_.points.size()));
    return level ? level->chi2 - out.chi2 - price * steps_ - (shape_.drifts ? 2.0 : 0.0) : 0.0;
  }

  static void as_one_segment(Trend& out) {
    out.changes.clear();
    out.line_or_step = out.drifts = false;
    out.segments.front().to = out.segments.back().to;
    out.segments.resize(1);
    out.segments[0].slope = out.segments[0].u_slope = 0.0;
  }

  const Series& s_;
  Columns columns_;
  Whitened w_;
  Shape shape_;
  int steps_ = 0;
  bool line_or_step_ = false;
};

}  // namespace

std::optional<Slope> slope_with_steps(const Series& given) {
  constexpr double surely = 1e-4;
  Series s = given;
  s.spread = 0.0;
  const auto trend = trend_of(s);
  if (!trend || s.points.size() < 4) return std::nullopt;
  const Columns columns(s);
  const Whitened w(s);
  Shape shape;
  shape.drifts = true;
  for (const Change& c : trend->changes)
    if (c.declared || c.p < surely) shape.changes.push_back(c);
  MatrixXd X = columns.of(shape);
  for (Index k = 0; k < X.cols(); ++k) X.col(k) = w.column(X.col(k));
  const auto fit = gls(w, X);
  if (!fit || !(fit->dof > 0.0)) return std::nullopt;
  const Index i = X.cols() - 1;
  return Slope{fit->b(i), std::sqrt(fit->C(i, i))};
}

double spread_of_slopes(const std::vector<Slope>& slopes) {
  // Bound, mean and variance of min(z^2, 9) for a standard normal z.
  constexpr double most = 9.0, expected = 0.99501, variance = 1.90145;
  if (slopes.size() < 3) return 0.0;
  const auto n = static_cast<double>(slopes.size());
  const auto mean = [&](double sigma) {
    double sum = 0.0;
    for (const Slope& s : slopes) sum += std::min(most, s.b * s.b / (sigma * sigma + s.u * s.u));
    return sum / n;
  };
  if (mean(0.0) <= expected + math::normal_quantile(0.97) * std::sqrt(variance / n)) return 0.0;
  double low = 0.0, high = 0.0;
  for (const Slope& s : slopes) high = std::max(high, 2.0 * std::fabs(s.b));
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2.0;
    (mean(middle) > expected ? low : high) = middle;
  }
  return high;
}

Expected<Trend> trend_of(const Series& s) {
  if (auto sound = check(s); !sound) return fail(sound.error());
  if (s.points.size() < 2) return Trend{};
  return Trending(s).run();
}

}  // namespace nonio::statistics
