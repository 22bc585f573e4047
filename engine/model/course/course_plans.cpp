// SPDX-License-Identifier: Apache-2.0
//
// Further tests over time that would separate two effects, by simulation: a speed or load is chosen
// anew, and temperatures follow it as they did in this test. What else moves them is not known
// beforehand, and separates nothing.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "course.h"
#include "course_pool.h"
#include "nonio/sdk/channels.h"

namespace nonio::model {

namespace {

using Channel = Observations::Channel;

// docs/dev/constants.md, M71.
constexpr std::array shares{1.0, 2.0};  // duration of a further test over that of this
constexpr std::array phases{4, 8, 16};  // of rest and motion in a further test
constexpr std::size_t most_rows = 1500;
constexpr double moves_too = 0.9;  // correlation from which on a load is not chosen independently
// Ratio of the RMS of left-out blocks with and without the sources, below which a temperature
// follows them, and above which it does not.
constexpr double follows = 0.7, does_not_follow = 0.95;
constexpr double clear_rms = 1.1, of_95_percent = 1.645;

/// Values of `c` at the times, interpolated linearly, constant beyond both ends.
std::vector<double> values_at(const Channel& c, const std::vector<double>& time) {
  std::vector<double> out = lagged(c, 0.0, time);
  for (double& v : out) v += c.value.front();
  return out;
}

double correlation(const Channel& a, const Channel& b) {
  const auto about_mean = [&](const Channel& c) {
    const std::vector<double> values = values_at(c, a.time);
    const Eigen::ArrayXd size =
        Eigen::Map<const Eigen::ArrayXd>(values.data(), static_cast<Index>(values.size())).abs();
    return Eigen::ArrayXd(size - size.mean());
  };
  const Eigen::ArrayXd x = about_mean(a), y = about_mean(b);
  const double sizes = std::sqrt(x.square().sum() * y.square().sum());
  return sizes > 0.0 ? (x * y).sum() / sizes : 0.0;
}

/// A speed or load, with its recorded values nearest to 0 and farthest from it.
struct Source {
  const Channel* channel;
  double rest, most;
};

VectorXd predicted(const std::vector<Term>& terms, const std::vector<double>& coefficients,
                   const Observations& o) {
  VectorXd out = VectorXd::Zero(static_cast<Index>(o.size()));
  std::size_t k = 0;
  for (const Term& term : terms) {
    const auto columns = term.effect->columns(o, term.axis, term.shape);
    // A source that stays at rest has no columns.
    for (std::size_t c = 0; c < term.effect->linear.size(); ++c, ++k)
      if (columns && c < columns->size())
        out += coefficients[k] *
               Eigen::Map<const VectorXd>((*columns)[c].data(), static_cast<Index>(o.size()));
  }
  return out;
}

std::vector<double> coefficients_of(const Fit& fit) {
  std::vector<double> out;
  for (const Parameter& p : fit.parameters)
    if (!p.shape) out.push_back(p.value);
  return out;
}

class CoursePlans {
 public:
  CoursePlans(const CourseData& data, const Fit& best, const std::vector<Term>& catalogue)
      : data_(data), o_(data.part().table), best_(best), catalogue_(catalogue) {
    for (const Channel& c : o_.channels) {
      if (c.is_temperature() || c.value.empty()) continue;
      const auto [low, high] =
          std::minmax_element(c.value.begin(), c.value.end(),
                              [](double a, double b) { return std::fabs(a) < std::fabs(b); });
      if (std::fabs(*low) < std::fabs(*high)) sources_.push_back({&c, *low, *high});
    }
    interval_ = data.duration() / static_cast<double>(std::max<std::size_t>(o_.size(), 2) - 1);
    CourseModel model{MatrixXd(data.size(), 0)};
    for (const Term& term : best.terms)
      if (const auto columns = term.effect->columns(o_, term.axis, term.shape); columns)
        model.add(data.means(*columns), quantities_of(term));
    const CourseNoise noise = noise_of_fit(data);
    scatter_ = most_likely_scatter(data, noise, model);
    CoursePool pool(data, {noise.correlation_time, scatter_});
    const std::vector<Index> columns = pool.add(model.columns, model.of);
    pool.finish();
    variance_ = pool.variance(columns, CourseSides(pool, data.displacements().leftCols(1)));
    // Another test is predicted no better than blocks of this one that are left out.
    const double ratio = left_out_rms(data, best.terms).front() / std::max(best.rms, 1e-300);
    variance_ *= std::max(1.0, ratio * ratio);
  }

  /// The shortest test that separates the two, otherwise "none".
  Plan plan(const Term& one, const Term& other) {
    Plan best{sources_.empty() ? "no-source" : "none", 0, 0.0, one.name(), other.name()};
    if (!(variance_ > 0.0) || !is_known(one) || !moves(one) || !is_known(other)) return best;
    for (const Term& term : best_.terms) is_known(term);
    for (Test& test : tests()) {
      const double power = power_of(test, one.name(), other);
      if (power >= enough_power)
        return {"other-speeds", test.readings, power,         one.name(),
                other.name(),   test.of,       test.duration, test.every};
      best.power = std::max(best.power, power);
    }
    return best;
  }

 private:
  struct Test {
    std::string of;
    double duration, every;
    std::size_t readings;
    Part part;
    std::unique_ptr<CourseData> data{};
  };

  std::vector<Test>& tests() {
    if (!tests_.empty() || sources_.empty()) return tests_;
    for (const double share : shares) {
      const double duration = 60.0 * std::ceil(share * data_.duration() / 60.0);
      for (const Source& source : sources_)
        for (const int count : phases) {
          const double every = 60.0 * std::round(duration / count / 60.0);
          constexpr double least = 4.0;  // intervals, as the shortest time constant
          if (every >= std::max(60.0, least * interval_))
            tests_.push_back(made(source, duration, every));
        }
    }
    return tests_;
  }

  enum class Follows { yes, no, unknown };

  /// Fits the sources to a temperature as if it were a displacement, and adds its course to the tests.
  Follows follows_sources(const Channel& c) {
    const auto [place, first] = follows_.try_emplace(c.name, Follows::unknown);
    if (!first) return place->second;
    std::vector<Term> terms;
    for (const Term& term : catalogue_)
      if (const Channel* of = o_.channel(term.axis.name); of != nullptr && !of->is_temperature())
        terms.push_back(term);
    constexpr std::size_t most_terms = 6;
    if (terms.size() > most_terms) terms.resize(most_terms);
    Part part;
    part.kind = Part::Kind::course;
    const std::size_t step = (o_.size() + most_rows - 1) / most_rows;
    for (std::size_t i = 0; i < o_.size(); i += step) part.table.time.push_back(o_.time[i]);
    part.table.deviation = lagged(c, 0.0, part.table.time);
    for (const Source& source : sources_)
      part.table.channels.push_back({source.channel->name, source.channel->unit, part.table.time,
                                     values_at(*source.channel, part.table.time)});
    const CourseData data(part);
    auto fit = fit_course(data, terms);
    for (; !fit && terms.size() > 1; fit = fit_course(data, terms))
      terms.pop_back();  // two loads that always change together
    if (!fit) return Follows::unknown;
    const double ratio = left_out_rms(data, fit->terms).front() / left_out_rms(data, {}).front();
    place->second = ratio < follows           ? Follows::yes
                    : ratio > does_not_follow ? Follows::no
                                              : Follows::unknown;
    for (Test& test : tests()) {
      if (place->second == Follows::unknown) break;
      Observations& t = test.part.table;
      Channel course{c.name, c.unit, t.time, std::vector<double>(t.size(), 0.0)};
      course.role = c.role;
      if (place->second == Follows::yes) {
        const VectorXd warmed = predicted(fit->terms, coefficients_of(*fit), t);
        course.value.assign(warmed.begin(), warmed.end());
      }
      t.channels.push_back(std::move(course));
    }
    return place->second;
  }

  /// Whether all temperatures of an effect have a known course in a further test.
  bool is_known(const Term& term) {
    bool known = !sources_.empty();
    for (const std::string& name : channels_of(term, o_))
      if (const Channel* c = o_.channel(name); known && c->is_temperature())
        known = follows_sources(*c) != Follows::unknown;
    return known;
  }

  /// Whether the effect, which is known, does anything in a further test.
  bool moves(const Term& term) {
    const std::vector<std::string> names = channels_of(term, o_);
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      const Channel& c = *o_.channel(name);
      return !c.is_temperature() || follows_sources(c) == Follows::yes;
    });
  }

  /// `driven` changes between rest and motion, from rest on; the machine is cold before.
  Test made(const Source& driven, double duration, double every) const {
    const auto readings = static_cast<std::size_t>(std::round(duration / interval_));
    Test test{driven.channel->name, duration, every, readings, {}};
    test.part.kind = Part::Kind::course;
    Observations& t = test.part.table;
    const std::size_t rows = std::clamp<std::size_t>(readings, 2, most_rows);
    for (std::size_t i = 0; i < rows; ++i)
      t.time.push_back(duration * (static_cast<double>(i) + 0.5) / static_cast<double>(rows));
    t.deviation.assign(rows, 0.0);
    for (const Source& source : sources_) {
      Channel c{source.channel->name, source.channel->unit, t.time, {}};
      const bool moving = source.channel == driven.channel ||
                          correlation(*driven.channel, *source.channel) > moves_too;
      for (const double s : t.time) {
        const bool now = moving && static_cast<long>(s / every) % 2 == 1;
        c.value.push_back(now ? source.most : source.rest);
      }
      t.channels.push_back(std::move(c));
    }
    return test;
  }

  /// Distance between the prediction of the best set and the nearest one with `other` in place of
  /// `one`, such that at 4 the RMS with `other` is clearly larger in 95 % of tests.
  double power_of(Test& test, const std::string& one, const Term& other) const {
    if (!test.data) test.data = std::make_unique<CourseData>(test.part);
    const CourseData& data = *test.data;
    const auto per_bin = [](const CourseData& d) {
      return static_cast<double>(d.part().table.size()) / static_cast<double>(d.size());
    };
    CourseNoise noise = noise_of_fit(data);
    noise.scatter = scatter_ * per_bin(data_) / per_bin(data);
    const CourseWhitening white(data, noise);
    const VectorXd all = predicted(best_.terms, coefficients_of(best_), test.part.table);
    const MatrixXd y = white.of(data.means(Effect::Columns{{all.begin(), all.end()}}));
    MatrixXd others(data.size(), 0);
    const auto add = [](MatrixXd& to, const MatrixXd& more) {
      to.conservativeResize(more.rows(), to.cols() + more.cols());
      to.rightCols(more.cols()) = more;
    };
    for (const Term& term : best_.terms) {
      if (term.name() == one) continue;
      const auto columns = term.effect->columns(test.part.table, term.axis, term.shape);
      if (columns) add(others, white.of(data.means(*columns)));
    }
    const auto left = [&](const MatrixXd& columns) {
      if (columns.cols() == 0) return y.squaredNorm();
      const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
      return (y - columns * qr.solve(y)).squaredNorm();
    };
    double least = left(others);
    for (const CourseColumns& shape : data.on_grid(other)) {
      MatrixXd columns = others;
      add(columns, white.of(shape.columns));
      least = std::min(least, left(columns));
    }
    const double bins = static_cast<double>(data.size()) - 1.0;
    const double needed = of_95_percent + std::sqrt(of_95_percent * of_95_percent +
                                                    bins * (clear_rms * clear_rms - 1.0));
    return enough_power * std::sqrt(least / variance_) / std::max(needed, enough_power);
  }

  const CourseData& data_;
  const Observations& o_;
  const Fit& best_;
  const std::vector<Term>& catalogue_;
  std::vector<Source> sources_;
  std::map<std::string, Follows> follows_;
  std::vector<Test> tests_;
  double interval_ = 0.0, scatter_ = 0.0, variance_ = 0.0;
};

}  // namespace

std::vector<Plan> plans_of_course(const CourseData& data, const Fit& best,
                                  const std::vector<Candidate>& members,
                                  const std::vector<Term>& catalogue) {
  CoursePlans plans(data, best, catalogue);
  std::vector<Plan> out;
  for (const Candidate& member : members)
    for (const Term& other : catalogue)
      if (std::find(member.aliases.begin(), member.aliases.end(), other.name()) !=
          member.aliases.end())
        out.push_back(plans.plan(member.term, other));
  std::stable_sort(out.begin(), out.end(), is_better);
  return out;
}

}  // namespace nonio::model
