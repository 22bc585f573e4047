// SPDX-License-Identifier: Apache-2.0
//
// Least squares with a zero for each block of time, on means of bins. Shapes are those that predict
// blocks which are left out best, on their grids and then between the grid's values.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "course.h"
#include "course_pool.h"
#include "nonio/math/golden_section.h"

namespace nonio::model {

namespace {

class CourseFit {
 public:
  CourseFit(const Part& part, std::vector<Term> terms)
      : data_(part), terms_(std::move(terms)), y_(data_.without_zeros(data_.displacements())) {}

  Expected<Fit> made() {
    for (Term& term : terms_) {
      searched_.push_back(term.shape.empty() && !term.effect->shapes.empty());
      auto grid = columns_on_grid(data_, term);
      if (grid.empty())
        return fail("effect \"" + term.name() + "\": these readings cannot show it");
      chosen_.push_back(grid.front());
      term.shape = grid.front().shape;
      grids_.push_back(std::move(grid));
    }
    search();
    refine();
    return fitted();
  }

 private:
  MatrixXd all_but(std::size_t left_out) const {
    MatrixXd out(data_.size(), 0);
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      if (k == left_out) continue;
      const MatrixXd& more = chosen_[k].columns;
      out.conservativeResize(Eigen::NoChange, out.cols() + more.cols());
      out.rightCols(more.cols()) = more;
    }
    return out;
  }

  /// The level of left-out blocks with these shapes, each given by its place in the pool.
  double level_with(const std::vector<std::size_t>& at) const {
    std::vector<Index> columns;
    for (std::size_t k = 0; k < at.size(); ++k)
      columns.insert(columns.end(), places_[k][at[k]].begin(), places_[k][at[k]].end());
    std::sort(columns.begin(), columns.end());
    if (std::adjacent_find(columns.begin(), columns.end()) != columns.end())
      return std::numeric_limits<double>::infinity();
    return level(left_out(*pool_, *sides_, columns));
  }

  /// The shapes with which blocks that are left out are predicted best: one term after the other, from
  /// several beginnings.
  void search() {
    pool_.emplace(data_);
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      places_.emplace_back();
      for (const CourseColumns& one : grids_[k])
        places_.back().push_back(pool_->add(one.columns, terms_[k].effect->linear));
    }
    pool_->finish();
    sides_.emplace(*pool_, y_);
    std::vector<std::size_t> best;
    double least = std::numeric_limits<double>::infinity();
    for (const double share : {0.0, 0.5, 1.0}) {
      std::vector<std::size_t> at;
      for (std::size_t k = 0; k < terms_.size(); ++k)  // neighbours begin apart
        at.push_back(static_cast<std::size_t>((k % 2 == 0 ? share : 1.0 - share) *
                                              static_cast<double>(grids_[k].size() - 1)));
      const double l = descend(at);
      if (best.empty() || l < least) least = l, best = at;
    }
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      chosen_[k] = grids_[k][best[k]];
      chosen_[k].columns = data_.without_zeros(std::move(chosen_[k].columns));
      terms_[k].shape = chosen_[k].shape;
    }
  }

  double descend(std::vector<std::size_t>& at) const {
    constexpr int most_rounds = 8;
    double least = level_with(at);
    for (int round = 0; round < most_rounds; ++round) {
      bool changed = false;
      for (std::size_t k = 0; k < at.size(); ++k)
        for (std::size_t g = 0; g < grids_[k].size(); ++g) {
          std::vector<std::size_t> other = at;
          other[k] = g;
          if (const double l = level_with(other); l < least) least = l, at = other, changed = true;
        }
      if (!changed) break;
    }
    return least;
  }

  /// The same with columns that are in no pool.
  double level_of_chosen(std::size_t k, const MatrixXd& instead) const {
    CoursePool pool(data_);
    std::vector<Index> columns;
    for (std::size_t t = 0; t < terms_.size(); ++t)
      for (const Index at :
           pool.add(t == k ? instead : chosen_[t].columns, terms_[t].effect->linear))
        columns.push_back(at);
    pool.finish();
    return level(left_out(pool, CourseSides(pool, y_), columns));
  }

  MatrixXd columns_at(const Term& term, const std::vector<double>& shape) const {
    const auto columns = term.effect->columns(data_.part().table, term.axis, shape);
    if (!columns || columns->empty()) return chosen_[0].columns * 0.0;
    return data_.without_zeros(data_.means(*columns));
  }

  /// Between the neighbours of a continuous shape on its grid.
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
    const auto with = [&](double value) {
      std::vector<double> at = terms_[k].shape;
      at[s] = value;
      return at;
    };
    const auto f = [&](double v) { return level_of_chosen(k, columns_at(terms_[k], with(v))); };
    constexpr int steps = 12;
    const auto bracket = math::golden_section(f, low, high, steps);
    const double best = 0.5 * (bracket.low + bracket.high);
    if (f(best) < level_of_chosen(k, chosen_[k].columns)) {
      terms_[k].shape = with(best);
      chosen_[k] = {terms_[k].shape, columns_at(terms_[k], terms_[k].shape)};
    }
  }

  Expected<Fit> fitted() {
    const Part& part = data_.part();
    const std::size_t n = part.table.size();
    Fit out;
    MatrixXd a = all_but(terms_.size());
    const VectorXd y = y_.col(0);
    VectorXd x = VectorXd::Zero(a.cols());
    if (a.cols() > 0) {
      const VectorXd length = a.colwise().norm().cwiseMax(1e-300).transpose();
      Eigen::ColPivHouseholderQR<MatrixXd> qr(of_unit_length(a));
      qr.setThreshold(1e-7);
      if (qr.rank() < a.cols()) return fail(cannot_separate(qr));
      x = math::solution(qr, y).cwiseQuotient(length);
    }
    out.residual = part.table.deviation;
    Index at = 0;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const auto columns = terms_[k].effect->columns(part.table, terms_[k].axis, terms_[k].shape);
      if (!columns) return fail(columns.error());
      std::vector<double> says(n, 0.0);
      for (const auto& column : *columns) {
        for (std::size_t i = 0; i < n; ++i) says[i] += x(at) * column[i];
        ++at;
      }
      for (std::size_t i = 0; i < n; ++i) out.residual[i] -= says[i];
      out.part.push_back(std::move(says));
    }
    double zero = 0.0, squares = 0.0;
    for (const double r : out.residual) zero += r / static_cast<double>(n);
    for (double& r : out.residual) r -= zero, squares += r * r;
    out.zero = {zero};
    out.weight.assign(n, 1.0);
    out.rms = std::sqrt(squares / static_cast<double>(n));
    uncertainties(a, x, y, out);
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

  /// Of coefficients and searched shapes, of the linearised problem; the residuals repeat each other
  /// as far as successive ones are alike.
  void uncertainties(const MatrixXd& a, const VectorXd& x, const VectorXd& y, Fit& out) const {
    struct Unknown {
      std::size_t term, shape;
    };
    std::vector<Unknown> shapes;
    MatrixXd j = a;
    Index at = 0;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const Index own = chosen_[k].columns.cols();
      for (std::size_t s = 0; s < terms_[k].shape.size(); ++s) {
        if (searched_[k] == 0 || !terms_[k].effect->shapes[s].continuous) continue;
        const double now = terms_[k].shape[s];
        const double step = std::max(1e-3 * now, 1e-3);
        std::vector<double> near = terms_[k].shape;
        near[s] = now + step;
        j.conservativeResize(Eigen::NoChange, j.cols() + 1);
        j.col(j.cols() - 1) =
            (columns_at(terms_[k], near) - chosen_[k].columns) * x.segment(at, own) / step;
        shapes.push_back({k, s});
      }
      at += own;
    }
    const VectorXd rest = a.cols() > 0 ? VectorXd(y - a * x) : y;
    const double r = successive(rest);
    const double unknowns = static_cast<double>(j.cols() + CourseData::blocks);
    const auto bins = static_cast<double>(data_.size());
    out.redundancy = bins > unknowns ? static_cast<std::size_t>(bins - unknowns) : 0;
    out.s = std::sqrt(rest.squaredNorm() / std::max(bins - unknowns, 1.0));
    out.noise.measured = r;
    out.noise.neighbours = r;
    out.noise.p = 0.0;
    const double s2 = out.s * out.s * repetition(r);
    VectorXd length = j.colwise().norm().cwiseMax(1e-300).transpose();
    const MatrixXd unit = of_unit_length(j);
    MatrixXd covariance = MatrixXd::Zero(j.cols(), j.cols());
    if (j.cols() > 0) {
      const Eigen::LDLT<MatrixXd> normal(math::transposed_product(unit, unit));
      covariance = math::inverse(normal);
    }
    const auto u = [&](Index k) {
      const double v = covariance(k, k);
      return v > 0.0 ? std::sqrt(s2 * v) / length(k) : std::numeric_limits<double>::quiet_NaN();
    };
    at = 0;
    Index of_shapes = a.cols();
    std::vector<Index> places;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const Term& term = terms_[k];
      for (const Effect::Parameter& p : term.effect->linear) {
        out.parameters.push_back({term.name(), p.name, x(at), u(at), p.quantity, false});
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

  CourseData data_;
  std::vector<Term> terms_;
  MatrixXd y_;
  std::vector<char> searched_;
  std::vector<std::vector<CourseColumns>> grids_;
  std::vector<CourseColumns> chosen_;  ///< columns without zeros
  std::optional<CoursePool> pool_;
  std::vector<std::vector<std::vector<Index>>> places_;  ///< in the pool: of each term and shape
  std::optional<CourseSides> sides_;
};

}  // namespace

Expected<Fit> fit_course(const Part& part, const std::vector<Term>& terms) {
  if (part.table.size() == 0) return fail("there are no readings over time");
  return CourseFit(part, terms).made();
}

double left_out_rms(const Part& part, const std::vector<Term>& terms) {
  const CourseData data(part);
  MatrixXd a(data.size(), 0);
  for (const Term& term : terms) {
    const auto columns = term.effect->columns(part.table, term.axis, term.shape);
    if (!columns) continue;
    const MatrixXd more = data.means(*columns);
    a.conservativeResize(Eigen::NoChange, a.cols() + more.cols());
    a.rightCols(more.cols()) = more;
  }
  a = of_unit_length(data.without_zeros(std::move(a)));
  const VectorXd y = data.without_zeros(data.displacements()).col(0);
  const MatrixXd normal = math::transposed_product(a, a);
  const VectorXd right = math::transposed_times(a, y);
  double squares = 0.0;
  for (Index b = 0; b < CourseData::blocks; ++b) {
    const Index from = data.begin_of(b), rows = data.begin_of(b + 1) - from;
    const MatrixXd own = a.middleRows(from, rows);
    const VectorXd here = y.segment(from, rows);
    VectorXd rest = here;
    if (a.cols() > 0) {
      const Eigen::LDLT<MatrixXd> ldlt(MatrixXd(normal - math::transposed_product(own, own)));
      rest -= own * math::solution(ldlt, right - math::transposed_times(own, here));
    }
    squares += rest.squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(data.size()));
}

}  // namespace nonio::model
