// SPDX-License-Identifier: Apache-2.0
#include "plans.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <type_traits>

#include "fit/workbench.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::model {

void fill_measured(Observations& o) {
  for_each_measured_column(
      [&](auto& column) {
        using T = typename std::remove_reference_t<decltype(column)>::value_type;
        if (column.empty() || column.size() >= o.size()) return;
        T value{};
        if constexpr (std::is_floating_point_v<T>) {
          const auto known = std::find_if(column.rbegin(), column.rend(),
                                          [](double x) { return std::isfinite(x); });
          value = known == column.rend() ? std::numeric_limits<T>::quiet_NaN() : *known;
        }
        column.resize(o.size(), value);
      },
      o);
}

namespace {

struct Course {
  std::string id;
  std::vector<double> targets;
  std::size_t runs = 1;
  double pause = 0.0;     // time between the present readings and this measurement, s
  bool pendulum = true;   // true: + pass, then - pass; false: each target from both sides in turn
  bool reversed = false;  // - pass first
};

void append(Observations& o, const Course& course, double interval) {
  auto& axis = o.axes.front();
  const std::uint32_t run = o.run.empty() ? 0 : *std::max_element(o.run.begin(), o.run.end());
  double t = 0.0;
  if (!o.time.empty())
    for (const double x : o.time)
      if (std::isfinite(x)) t = std::max(t, x);
  t += course.pause;
  const auto take = [&](double target, int from, std::size_t r) {
    t += interval;
    axis.position.push_back(target);
    axis.approach.push_back(static_cast<std::int8_t>(from));
    o.deviation.push_back(0.0);
    o.run.push_back(run + static_cast<std::uint32_t>(r) + 1);
    if (!o.line.empty()) o.line.push_back(o.line.back());
    if (!o.time.empty()) o.time.push_back(t);
  };
  std::vector<double> up = course.targets, down(up.rbegin(), up.rend());
  for (std::size_t r = 0; r < course.runs; ++r) {
    if (!course.pendulum) {
      for (const double x : up)
        for (const int from : {1, -1}) take(x, from, r);
      continue;
    }
    for (const int from : course.reversed ? std::vector<int>{-1, 1} : std::vector<int>{1, -1})
      for (const double x : from > 0 ? up : down) take(x, from, r);
  }
  fill_measured(o);
}

/// Fits the prediction of one effect with other effects.
Expected<Fit> imitate(Observations imagined, const VectorXd& said, const std::vector<Term>& terms) {
  imagined.deviation.assign(said.data(),
                            said.data() + static_cast<std::ptrdiff_t>(imagined.size()));
  return fit(imagined, terms);
}

double squares(const Fit& fit) {
  return fit.rms * fit.rms * static_cast<double>(fit.residual.size());
}

/// A prediction for the present readings, and its fit with other effects.
struct Imitation {
  VectorXd said;
  Fit fit;
};

/// Distance, in standard deviations, from the prediction of one effect to the nearest prediction
/// with `other`, as far as the planned readings add to that of the present ones, which precede them
/// in `said`; 0 if a fit fails. Shapes of `other` are searched for the present readings, and for all
/// if the plan is good without. `before`: the fit of the present readings, once it is made.
double distance(const Observations& present, const Further& planned, const std::vector<Term>& model,
                const VectorXd& said, const Term& other, double s,
                std::optional<Imitation>& before) {
  std::vector<Term> terms = model;
  terms.push_back(other);
  terms.back().shape.clear();
  VectorXd here = said.head(static_cast<Index>(present.size()));
  if (!before || before->said != here) {
    auto fitted = imitate(present, said, terms);
    if (!fitted) return 0.0;
    before = Imitation{std::move(here), *std::move(fitted)};
  }
  const auto after_plan = [&](std::vector<Term> all) {
    std::erase_if(all, [&](const Term& t) {
      const auto& known = planned.settled;
      return std::find(known.begin(), known.end(), t.name()) != known.end();
    });
    all.insert(all.end(), planned.set_up.begin(), planned.set_up.end());
    const auto fitted = imitate(planned.table, said, all);
    return fitted ? std::sqrt(std::max(squares(*fitted) - squares(before->fit), 0.0)) / s : 0.0;
  };
  const double same = after_plan(before->fit.terms);
  return other.effect->shapes.empty() || same < enough_power ? same
                                                             : std::min(same, after_plan(terms));
}

std::vector<Course> courses_of(const Observations& o, const AxisReadings& r) {
  std::vector<double> targets(r.theta);
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
  std::vector<double> between;
  for (std::size_t i = 0; i + 1 < targets.size(); ++i)
    // 0.382 is not a simple fraction, so that a period does not repeat
    between.push_back(targets[i] + 0.382 * (targets[i + 1] - targets[i]));
  const double whole = std::max(r.duration, 1.0);
  std::vector<Course> out;
  out.push_back({"another-run", targets, 1});
  out.push_back({"another-run-reversed", targets, 1, 0.0, true, true});
  out.push_back({"both-sides-at-each-target", targets, 1, 0.0, false});
  out.push_back({"other-targets", between, 1});
  if (!o.time.empty()) out.push_back({"run-after-a-pause", targets, 1, whole});
  if (!o.time.empty()) out.push_back({"run-after-a-long-pause", targets, 1, 5.0 * whole});
  out.push_back({"three-more-runs", targets, 3});
  if (!o.time.empty()) out.push_back({"three-runs-after-a-pause", targets, 3, whole});
  return out;
}

}  // namespace

std::vector<Further> further_runs(const Part& part, const Axis& axis) {
  std::vector<Further> out;
  const auto read = readings_of(part.table, axis);
  if (!read) return out;
  const double interval = std::max(read->duration, 1.0) / static_cast<double>(part.table.size());
  for (const Course& course : courses_of(part.table, *read)) {
    Further& f = out.emplace_back(Further{course.id, "", part.table});
    append(f.table, course, interval);
    if (read->timed)
      f.duration =
          course.pause + interval * static_cast<double>(f.table.size() - part.table.size());
  }
  return out;
}

bool is_better(const Plan& a, const Plan& b) {
  if (a.separates() != b.separates()) return a.separates();
  if (!a.separates()) return a.power > b.power;
  if (a.duration.has_value() != b.duration.has_value()) return a.duration.has_value();
  return std::tie(a.duration, a.readings) < std::tie(b.duration, b.readings);
}

namespace {

std::vector<Plan> cheapest(std::vector<Plan> plans) {
  std::stable_sort(plans.begin(), plans.end(), is_better);
  if (plans.size() > 3) plans.resize(3);
  return plans;
}

}  // namespace

namespace {

/// Returns how well a further measurement separates an effect of the machine from the same error of
/// the part.
double from_part(const Part& part, const Further& f, const std::vector<Term>& model,
                 const MatrixXd& columns, const VectorXd& value, double s) {
  const MatrixXd of_part = as_error_of_part(part, f, columns);
  Effect same;
  same.info.name = "part";
  same.linear.resize(static_cast<std::size_t>(of_part.cols()));
  same.columns = [&](const Observations& o, const Axis&,
                     const std::vector<double>&) -> Expected<Effect::Columns> {
    Effect::Columns out;
    for (Index k = 0; k < of_part.cols(); ++k)
      out.emplace_back(of_part.col(k).begin(),
                       of_part.col(k).begin() + static_cast<Index>(o.size()));
    return out;
  };
  same.instances = [](const Observations&) { return std::vector<std::string>{""}; };
  std::optional<Imitation> before;
  return distance(part.table, f, model, columns * value, Term{&same, {}}, s, before);
}

}  // namespace

std::vector<Plan> plans_for(const Part& part, const std::vector<Term>& model,
                            const Candidate& candidate, const std::vector<Term>& catalogue,
                            double s) {
  std::vector<Plan> plans;
  const bool parts_alike = is_of_parts_alike(part);
  if ((candidate.aliases.empty() && !parts_alike) || !(s > 0.0)) return plans;
  VectorXd value(static_cast<Index>(candidate.parameters.size()));
  Index linear = 0;
  for (const Parameter& p : candidate.parameters)
    if (!p.shape) value(linear++) = p.value;
  value.conservativeResize(linear);
  auto further = part.kind == Part::Kind::axis ? further_runs(part, candidate.term.axis)
                                               : further_in_space(part);
  std::map<std::string, std::optional<Imitation>> before;
  for (Further& f : further) {
    add_set_up_of_part(f, model);
    const Observations& o = f.table;
    const auto columns = columns_of(o, candidate.term, candidate.term.shape);
    if (!columns || columns->cols() != linear) continue;
    Plan plan{f.id,      o.size() - part.table.size(), INFINITY, candidate.term.name(), "", f.of,
              f.duration};
    const auto separates = [&](double d, const std::string& other) {
      if (d < plan.power) plan.power = d, plan.other = other;
    };
    for (const std::string& alias : candidate.aliases) {
      const auto other = std::find_if(catalogue.begin(), catalogue.end(),
                                      [&](const Term& t) { return t.name() == alias; });
      if (other == catalogue.end()) continue;
      separates(distance(part.table, f, model, *columns * value, *other, s, before[alias]), alias);
    }
    if (const std::string& same = candidate.term.effect->of_part;
        parts_alike && !same.empty() && o.size() > part.table.size())
      separates(from_part(part, f, model, *columns, value, s),
                same + ":" + candidate.term.axis.name);
    // The same part moved along an axis without effect on this error shows nothing new.
    if (std::isfinite(plan.power) && !(parts_alike && plan.power < 1.0))
      plans.push_back(std::move(plan));
  }
  return cheapest(std::move(plans));
}

std::vector<Plan> plans_for_pair(const Part& part, const std::vector<Term>& model,
                                 const std::vector<Term>& pair, const std::vector<double>& value,
                                 double s) {
  std::vector<Plan> plans;
  if (pair.size() != 2 || !(s > 0.0) || part.kind != Part::Kind::axis) return plans;
  std::array<std::optional<Imitation>, 2> before;
  for (const Further& f : further_runs(part, pair[0].axis)) {
    VectorXd said = VectorXd::Zero(static_cast<Index>(f.table.size()));
    std::size_t at = 0;
    for (const Term& term : pair) {
      const auto columns = columns_of(f.table, term, term.shape);
      if (!columns || at + static_cast<std::size_t>(columns->cols()) > value.size()) return plans;
      for (Index k = 0; k < columns->cols(); ++k) said += value[at++] * columns->col(k);
    }
    const double power = std::min(distance(part.table, f, model, said, pair[0], s, before[0]),
                                  distance(part.table, f, model, said, pair[1], s, before[1]));
    plans.push_back({f.id, f.table.size() - part.table.size(), power, pair[0].name(),
                     pair[1].name(), f.of, f.duration});
  }
  return cheapest(std::move(plans));
}

}  // namespace nonio::model
