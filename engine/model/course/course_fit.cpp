// SPDX-License-Identifier: Apache-2.0
//
// Shapes with the largest evidence, first on their grids and then between grid values.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "course.h"
#include "course_pool.h"
#include "nonio/math/golden_section.h"

namespace nonio::model {

namespace {

class CourseFit {
 public:
  CourseFit(const CourseData& data, std::vector<Term> terms)
      : data_(data), terms_(std::move(terms)), noise_(noise_of_fit(data_)) {}

  Expected<Fit> made() {
    for (Term& term : terms_) {
      searched_.push_back(term.shape.empty() && !term.effect->shapes.empty());
      const auto& grid = data_.on_grid(term);
      if (grid.empty())
        return fail("effect \"" + term.name() + "\": these readings cannot show it");
      chosen_.push_back(grid.front());
      term.shape = grid.front().shape;
      grids_.push_back(&grid);
      of_.push_back(quantities_of(term));
    }
    search();
    const double scatter = most_likely_scatter(data_, noise_, chosen());
    if (scatter != noise_.scatter) {
      noise_.scatter = scatter;
      search();
    }
    refine();
    // Without the lag, the noise of the channel is part of the scatter.
    if (drop_lags()) noise_.scatter = most_likely_scatter(data_, noise_, chosen());
    return fitted();
  }

 private:
  CourseModel chosen() const {
    CourseModel out{MatrixXd(data_.size(), 0)};
    for (std::size_t k = 0; k < terms_.size(); ++k) out.add(chosen_[k].columns, of_[k]);
    return out;
  }

  /// Infinite if two terms have the same column.
  double cost_with(const std::vector<std::size_t>& at) const {
    std::vector<Index> columns;
    for (std::size_t k = 0; k < at.size(); ++k)
      columns.insert(columns.end(), places_[k][at[k]].begin(), places_[k][at[k]].end());
    std::sort(columns.begin(), columns.end());
    if (std::adjacent_find(columns.begin(), columns.end()) != columns.end())
      return std::numeric_limits<double>::infinity();
    return pool_->cost(columns, *sides_).mean();
  }

  /// Finds the shapes with the largest evidence by coordinate descent from three starting points.
  void search() {
    pool_.emplace(data_, noise_);
    places_.clear();
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      places_.emplace_back();
      for (const CourseColumns& one : *grids_[k])
        places_.back().push_back(pool_->add(one.columns, of_[k]));
    }
    pool_->finish();
    sides_.emplace(*pool_, data_.displacements());
    std::vector<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    for (const double share : {0.0, 0.5, 1.0}) {
      std::vector<std::size_t> at;
      for (std::size_t k = 0; k < terms_.size(); ++k)  // start adjacent terms at different shapes
        at.push_back(static_cast<std::size_t>((k % 2 == 0 ? share : 1.0 - share) *
                                              static_cast<double>(grids_[k]->size() - 1)));
      const double cost = descend(at);
      if (best.empty() || cost < least) least = cost, best = at;
    }
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      chosen_[k] = (*grids_[k])[best[k]];
      terms_[k].shape = chosen_[k].shape;
    }
  }

  double descend(std::vector<std::size_t>& at) const {
    constexpr int most_rounds = 8;
    double least = cost_with(at);
    for (int round = 0; round < most_rounds; ++round) {
      bool changed = false;
      for (std::size_t k = 0; k < at.size(); ++k)
        for (std::size_t g = 0; g < grids_[k]->size(); ++g) {
          std::vector<std::size_t> other = at;
          other[k] = g;
          if (const double cost = cost_with(other); cost < least)
            least = cost, at = other, changed = true;
        }
      if (!changed) break;
    }
    return least;
  }

  /// -ln of the evidence with `instead` as the columns of term k.
  double cost_of_chosen(std::size_t k, const MatrixXd& instead) const {
    CoursePool pool(data_, noise_);
    std::vector<Index> columns;
    for (std::size_t t = 0; t < terms_.size(); ++t)
      for (const Index at : pool.add(t == k ? instead : chosen_[t].columns, of_[t]))
        columns.push_back(at);
    pool.finish();
    return pool.cost(columns, CourseSides(pool, data_.displacements())).mean();
  }

  MatrixXd columns_at(const Term& term, const std::vector<double>& shape) const {
    const auto columns = term.effect->columns(data_.part().table, term.axis, shape);
    if (!columns || columns->empty()) return chosen_[0].columns * 0.0;
    return data_.means(*columns);
  }

  /// Two rounds over the continuous shapes of searched terms, between adjacent grid values.
  void refine() {
    for (int round = 0; round < 2; ++round)
      for (std::size_t k = 0; k < terms_.size(); ++k) {
        if (searched_[k] == 0) continue;
        for (std::size_t s = 0; s < terms_[k].shape.size(); ++s) refine(k, s);
      }
  }

  void refine(std::size_t k, std::size_t s) {
    const Effect::Shape& shape = terms_[k].effect->shapes[s];
    if (!shape.continuous) return;
    const std::vector<double> grid = shape.grid(data_.part().table, terms_[k].axis);
    const double now = terms_[k].shape[s];
    double low = now, high = now;
    for (const double g : grid) {
      if (g < now && (low == now || g > low)) low = g;
      if (g > now && (high == now || g < high)) high = g;
    }
    if (!(high > low)) return;
    const auto f = [&](double v) {
      return cost_of_chosen(k, columns_at(terms_[k], with(k, s, v)));
    };
    constexpr int steps = 12;
    const auto bracket = math::golden_section(f, low, high, steps);
    const double best = 0.5 * (bracket.low + bracket.high);
    if (!(f(best) < cost_of_chosen(k, chosen_[k].columns))) return;
    replace(k, with(k, s, best));
  }

  std::vector<double> with(std::size_t k, std::size_t s, double value) const {
    std::vector<double> at = terms_[k].shape;
    at[s] = value;
    return at;
  }

  /// Unless two effects of one channel become equal.
  void replace(std::size_t k, const std::vector<double>& shape) {
    CourseColumns before = std::exchange(chosen_[k], {shape, columns_at(terms_[k], shape)});
    if (const auto qr = decomposed(); qr.rank() < qr.cols())
      chosen_[k] = std::move(before);
    else
      terms_[k].shape = chosen_[k].shape;
  }

  /// A lag smooths the noise of a channel, which generalized least squares rewards even without a
  /// lag of the machine. It is dropped if the RMS of ordinary least squares is clearly smaller.
  bool drop_lags() {
    constexpr double clearly = 1.05 * 1.05;  // docs/dev/constants.md, M52
    bool any = false;
    for (std::size_t k = 0; k < terms_.size(); ++k)
      for (std::size_t s = 0; searched_[k] != 0 && s < terms_[k].shape.size(); ++s) {
        const Effect::Shape& shape = terms_[k].effect->shapes[s];
        const std::vector<double> grid = shape.grid(data_.part().table, terms_[k].axis);
        if (!shape.continuous || grid.empty() || grid.front() != 0.0) continue;
        const std::vector<double> none = with(k, s, 0.0);
        if (terms_[k].shape == none || clearly * squares_with(k, columns_at(terms_[k], none)) >
                                           squares_with(k, chosen_[k].columns))
          continue;
        replace(k, none);
        any = any || terms_[k].shape == none;
      }
    return any;
  }

  /// Sum of squares that ordinary least squares leaves, with `instead` as the columns of term k.
  double squares_with(std::size_t k, const MatrixXd& instead) const {
    MatrixXd all(data_.size(), 0);
    for (std::size_t t = 0; t < terms_.size(); ++t) {
      const MatrixXd& more = t == k ? instead : chosen_[t].columns;
      all.conservativeResize(Eigen::NoChange, all.cols() + more.cols());
      all.rightCols(more.cols()) = more;
    }
    MatrixXd y = data_.displacements();
    data_.centre(all);
    data_.centre(y);
    if (all.cols() == 0) return y.squaredNorm();
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(all);
    return (y - all * qr.solve(y)).squaredNorm();
  }

  /// If the rank is below the number of columns, the terms cannot be separated.
  Eigen::ColPivHouseholderQR<MatrixXd> decomposed() const {
    Eigen::ColPivHouseholderQR<MatrixXd> qr(
        of_unit_length(CourseWhitening(data_, noise_).of(chosen().columns)));
    qr.setThreshold(1e-7);
    return qr;
  }

  Expected<Fit> fitted() {
    const Part& part = data_.part();
    const std::size_t n = part.table.size();
    Fit out;
    const CourseModel model = chosen();
    const MatrixXd& a = model.columns;
    CoursePool pool(data_, noise_);
    const std::vector<Index> places = pool.add(a, model.of);
    pool.finish();
    if (a.cols() > 0)
      if (const auto qr = decomposed(); qr.rank() < a.cols()) return fail(cannot_separate(qr));
    const VectorXd x =
        pool.coefficients(places, CourseSides(pool, data_.displacements().leftCols(1))).col(0);
    out.residual = part.table.deviation;
    Index at = 0;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      NONIO_TRY(const auto columns,
                terms_[k].effect->columns(part.table, terms_[k].axis, terms_[k].shape));
      std::vector<double> says(n, 0.0);
      for (const auto& column : columns) {
        for (std::size_t i = 0; i < n; ++i) says[i] += x(at) * column[i];
        ++at;
      }
      for (std::size_t i = 0; i < n; ++i) out.residual[i] -= says[i];
      out.part.push_back(std::move(says));
    }
    out.zero = without_zeros(out.residual, part.table);
    double squares = 0.0;
    for (const double r : out.residual) squares += r * r;
    out.weight.assign(n, 1.0);
    out.rms = std::sqrt(squares / static_cast<double>(n));
    uncertainties(model, x, out);
    out.terms = terms_;
    out.lost.assign(terms_.size(), 0);
    return out;
  }

  std::string cannot_separate(const Eigen::ColPivHouseholderQR<MatrixXd>& qr) const {
    const Index worst = qr.colsPermutation().indices()(qr.rank());
    Index at = 0;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      at += chosen_[k].columns.cols();
      if (worst < at)
        return "these readings cannot separate \"" + terms_[k].name() +
               "\" from the other effects of the model; remove one of them";
    }
    return "these readings cannot separate the effects of the model";
  }

  void uncertainties(const CourseModel& model, const VectorXd& x, Fit& out) const {
    const MatrixXd& a = model.columns;
    CourseModel linearised = model;
    Index at = 0;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const Index own = chosen_[k].columns.cols();
      for (std::size_t s = 0; s < terms_[k].shape.size(); ++s) {
        if (searched_[k] == 0 || !terms_[k].effect->shapes[s].continuous) continue;
        const double now = terms_[k].shape[s];
        const double step = std::max(1e-3 * now, 1e-3);
        std::vector<double> near = terms_[k].shape;
        near[s] = now + step;
        const MatrixXd change = columns_at(terms_[k], near) - chosen_[k].columns;
        linearised.add(math::times(change, x.segment(at, own)) / step, {Quantity::time});
      }
      at += own;
    }
    MatrixXd left = data_.displacements().leftCols(1);
    if (a.cols() > 0) left.col(0) -= math::times(a, x);
    data_.centre(left);
    const VectorXd rest = left.col(0);
    const auto unknowns =
        static_cast<double>(linearised.columns.cols()) + static_cast<double>(data_.lines().size());
    const auto bins = static_cast<double>(data_.size());
    out.redundancy = bins > unknowns ? static_cast<std::size_t>(bins - unknowns) : 0;
    out.s = std::sqrt(rest.squaredNorm() / std::max(bins - unknowns, 1.0));
    out.noise.measured = out.noise.neighbours = successive(rest);
    out.noise.p = 0.0;
    const MatrixXd covariance = uncertainty_of(data_, linearised).covariance;
    const auto u = [&](Index k) {
      const double v = covariance(k, k);
      return v > 0.0 ? std::sqrt(v) : std::numeric_limits<double>::quiet_NaN();
    };
    at = 0;
    Index of_shapes = a.cols();
    std::vector<Index> places;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const Term& term = terms_[k];
      for (const Effect::Parameter& p : term.effect->linear) {
        out.parameters.push_back(
            {term.name(), p.name, x(at), u(at), quantity_of(p, term.axis), false});
        places.push_back(at++);
      }
      for (std::size_t s = 0; s < term.shape.size(); ++s) {
        const bool free = searched_[k] != 0 && term.effect->shapes[s].continuous;
        const Effect::Parameter& p = term.effect->shapes[s].parameter;
        out.parameters.push_back({term.name(), p.name, term.shape[s],
                                  free ? u(of_shapes) : std::numeric_limits<double>::quiet_NaN(),
                                  p.quantity, true});
        places.push_back(free ? of_shapes++ : -1);
      }
    }
    out.correlation.assign(places.size(), std::vector<double>(places.size(), 0.0));
    for (std::size_t i = 0; i < places.size(); ++i)
      for (std::size_t k = 0; k < places.size(); ++k) {
        if (i == k) out.correlation[i][k] = 1.0;
        if (i == k || places[i] < 0 || places[k] < 0) continue;
        const double both = covariance(places[i], places[i]) * covariance(places[k], places[k]);
        if (both > 0.0) out.correlation[i][k] = covariance(places[i], places[k]) / std::sqrt(both);
      }
  }

  const CourseData& data_;
  std::vector<Term> terms_;
  CourseNoise noise_;
  std::vector<std::vector<Quantity>> of_;  ///< quantities of the coefficients of each term
  std::vector<char> searched_;
  std::vector<const std::vector<CourseColumns>*> grids_;
  std::vector<CourseColumns> chosen_;
  std::optional<CoursePool> pool_;
  /// pool indices of the columns, by term and shape
  std::vector<std::vector<std::vector<Index>>> places_;
  std::optional<CourseSides> sides_;
};

}  // namespace

Expected<Fit> fit_course(const CourseData& data, const std::vector<Term>& terms) {
  if (data.part().table.size() == 0) return fail("there are no readings over time");
  return CourseFit(data, terms).made();
}

Expected<Fit> fit_course(const Part& part, const std::vector<Term>& terms) {
  return fit_course(CourseData(part), terms);
}

std::vector<double> left_out_rms(const CourseData& data, const std::vector<Term>& terms) {
  CoursePool pool(data, noise_of_fit(data));
  std::vector<Index> places;
  for (const Term& term : terms) {
    const auto columns = term.effect->columns(data.part().table, term.axis, term.shape);
    if (!columns) continue;
    for (const Index at : pool.add(data.means(*columns), quantities_of(term))) places.push_back(at);
  }
  pool.finish();
  const CourseSides sides(pool, data.displacements());
  std::vector<double> out;
  for (Index j = 0; j < data.displacements().cols(); ++j)
    out.push_back(pool.left_out(places, sides, j));
  return out;
}

}  // namespace nonio::model
