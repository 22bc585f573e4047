// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "noise.h"
#include "whitening.h"

namespace nonio::model {

namespace {

using Zero = Noise::Zero;

/// Each column has unit length.
MatrixXd columns_of_model(const std::vector<MatrixXd>& blocks, Index rows) {
  MatrixXd out(rows, 0);
  for (const MatrixXd& block : blocks) {
    out.conservativeResize(Eigen::NoChange, out.cols() + block.cols());
    out.rightCols(block.cols()) = block;
  }
  for (Index k = 0; k < out.cols(); ++k) out.col(k) /= std::max(out.col(k).norm(), 1e-300);
  return out;
}

class Likelihood {
 public:
  Likelihood(const Observations& o, const MatrixXd& model, const std::vector<double>& weight)
      : o_(o), model_(model), weight_(weight) {}

  /// Returns -2 ln of the restricted likelihood, up to a constant.
  double operator()(const Noise& noise) const {
    const Whitening white(o_, weight_, noise);
    MatrixXd x = white(model_);
    MatrixXd y = white(Eigen::Map<const VectorXd>(o_.deviation.data(), model_.rows()));
    white.take_out_zeros(x);
    white.take_out_zeros(y);
    double squares = y.squaredNorm(), log_det = white.log_det();
    if (x.cols() > 0) {
      const Eigen::HouseholderQR<MatrixXd> qr(x);
      const VectorXd rotated = math::rotated(qr, y.col(0));
      squares = rotated.tail(rotated.size() - x.cols()).squaredNorm();
      log_det += 2.0 * qr.matrixQR().diagonal().cwiseAbs().array().log().sum();
    }
    const double dof = static_cast<double>((white.root().array() > 0.0).count()) -
                       static_cast<double>(lines_of(o_)) - static_cast<double>(x.cols());
    return dof * std::log(squares / dof) + log_det;
  }

 private:
  const Observations& o_;
  const MatrixXd& model_;
  const std::vector<double>& weight_;
};

/// Score tests, in standard deviations, for another form of the noise, from the residuals of a
/// model. They are cheaper than the likelihood; kinds of noise with a small score are omitted.
class Signs {
 public:
  Signs(const Observations& o, const MatrixXd& model, const std::vector<double>& weight,
        const Noise& noise)
      : white_(o, weight, noise) {
    MatrixXd x = white_(model);
    MatrixXd y = white_(Eigen::Map<const VectorXd>(o.deviation.data(), model.rows()));
    white_.take_out_zeros(x);
    white_.take_out_zeros(y);
    basis_ = x;
    if (x.cols() > 0) basis_ = math::orthonormal(Eigen::HouseholderQR<MatrixXd>(x), x.cols());
    left_ = math::orthogonal_part(basis_, VectorXd(y.col(0)));
    const auto used = static_cast<double>((white_.root().array() > 0.0).count());
    dof_ = used - static_cast<double>(x.cols()) - static_cast<double>(lines_of(o));
    variance_ = left_.squaredNorm() / dof_;
  }

  /// Returns the score of a noise that consists of these columns with random coefficients.
  double of(const MatrixXd& columns) const {
    MatrixXd z = white_(columns);
    white_.take_out_zeros(z);
    math::take_out(basis_, z);
    const MatrixXd products = math::transposed_product(z, z);
    const double trace = products.trace();
    const double spread = 2.0 * (products.squaredNorm() - trace * trace / dof_);
    if (!(spread > 0.0) || !(variance_ > 0.0)) return 0.0;
    return (math::transposed_times(z, left_).squaredNorm() / variance_ - trace) / std::sqrt(spread);
  }

  /// Returns the score of a stronger correlation of adjacent readings.
  double of_neighbours() const {
    double found = 0.0, expected = 0.0, pairs = 0.0;
    for (Index i = 1; i < left_.size(); ++i) {
      found += left_(i) * left_(i - 1);
      expected -= basis_.row(i).dot(basis_.row(i - 1)) + 1.0 / static_cast<double>(left_.size());
      ++pairs;
    }
    if (!(variance_ > 0.0) || pairs < 1.0) return 0.0;
    return (found / variance_ - expected) / std::sqrt(pairs);
  }

 private:
  Whitening white_;
  MatrixXd basis_;
  VectorXd left_;
  double dof_ = 0.0, variance_ = 0.0;
};

/// Returns an indicator column for each group; adjacent groups share one if there are more than 60.
MatrixXd of_groups(const std::vector<std::uint32_t>& group) {
  constexpr Index most = 60;
  std::map<std::uint32_t, Index> number;
  for (const std::uint32_t g : group) number.try_emplace(g, 0);
  Index next = 0;
  for (auto& [g, k] : number) k = next++;
  const Index together = std::max<Index>(1, (next + most - 1) / most);
  MatrixXd out = MatrixXd::Zero(static_cast<Index>(group.size()), (next + together - 1) / together);
  for (std::size_t i = 0; i < group.size(); ++i)
    out(static_cast<Index>(i), number[group[i]] / together) = 1.0;
  return out;
}

/// Returns columns of step functions for a random walk, with steps at up to 24 readings.
MatrixXd steps_of_walk(const Observations& o) {
  constexpr Index most = 24;
  const auto n = static_cast<Index>(o.size());
  const Index steps = std::min(most, n - 1);
  MatrixXd out = MatrixXd::Zero(n, steps);
  for (Index k = 0; k < steps; ++k) {
    const Index from = (k + 1) * n / (steps + 1);
    const std::uint32_t line = line_of(o, static_cast<std::size_t>(from));
    for (Index i = from; i < n; ++i)
      if (line_of(o, static_cast<std::size_t>(i)) == line) out(i, k) = 1.0;
  }
  return out;
}

class Search {
 public:
  Search(const Likelihood& likelihood, const Noise& noise, double worth)
      : likelihood_(likelihood), noise_(noise), best_(noise), least_(likelihood(noise) - worth) {}

  void neighbours() {
    constexpr double less_likely = 2.0;
    double before = std::numeric_limits<double>::infinity();
    for (const double rho : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
      Noise with = noise_;
      with.neighbours = rho;
      // An equally likely random walk is preferred: it gives a larger u of effects in time.
      const double value = likelihood_(with) + less_likely;
      if (value < least_) least_ = value, best_ = with, likely_.clear();
      if (rho > noise_.neighbours && value > before) break;
      before = value;
    }
  }

  void zero(Zero kind, const std::vector<double>& sizes) {
    // difference of -2 ln likelihood beyond which sizes are ignored
    constexpr double unlikely = 12.0;
    std::vector<Tried> tried;
    double least = std::numeric_limits<double>::infinity();
    for (const double size : sizes) {
      Noise with = noise_;
      with.zero = kind, with.zero_size = with.zero_found = size;
      tried.push_back({size, likelihood_(with)});
      const double value = tried.back().value;
      if (value < least_) least_ = value, best_ = with, likely_.clear();
      least = std::min(least, value);
      if (value > least + unlikely) break;  // the minimum has been passed
    }
    if (best_.zero == kind && likely_.empty())
      likely_ = tried, whole_ = tried.size() == sizes.size();
  }

  /// The size of the zero is averaged over all likely sizes, because few runs leave it uncertain: u
  /// then corresponds to GUM-S1 (6.4.9.4) for few values.
  Noise found() const {
    constexpr double open_beyond = 0.02;
    Noise out = best_;
    double weights = 0.0, squares = 0.0, last = 0.0;
    for (const Tried& t : likely_) {
      const double weight = std::exp(-0.5 * (t.value - least_));
      weights += weight, squares += weight * t.size * t.size, last = weight;
    }
    if (weights > 0.0) {
      out.zero_size = std::sqrt(squares / weights);
      out.zero_open = whole_ && last > open_beyond * weights;
    }
    return out;
  }

 private:
  struct Tried {
    double size, value;
  };
  const Likelihood& likelihood_;
  const Noise& noise_;
  Noise best_;
  double least_;
  std::vector<Tried> likely_;  // sizes tried for the kind of zero in `best_`
  bool whole_ = false;
};

}  // namespace

Noise with_zero(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight, const Noise& noise) {
  // Least decrease of -2 ln likelihood for a random zero or a stronger correlation:
  // docs/dev/constants.md, M28.
  constexpr double worth = 1.5;
  constexpr double no_sign = 1.2;  // score below which a gain of `worth` is improbable
  // Above this number of readings, the covariance matrix is too large: docs/dev/constants.md, M31.
  constexpr std::size_t most = 1500;
  if (o.size() > most || o.size() < 10 || noise.pass.empty()) return noise;
  const auto blocks = blocks_of(o, terms, root_weights(o, weight));
  if (!blocks) return noise;
  const MatrixXd model = columns_of_model(*blocks, static_cast<Index>(o.size()));
  if (model.cols() + static_cast<Index>(lines_of(o)) + 3 > model.rows()) return noise;
  const bool runs = !o.run.empty() && std::any_of(o.run.begin(), o.run.end(),
                                                  [&](auto run) { return run != o.run.front(); });
  const auto passes = *std::max_element(noise.pass.begin(), noise.pass.end()) + 1;
  const Signs signs(o, model, weight, noise);
  const bool of_neighbours = signs.of_neighbours() > no_sign;
  const bool walks = o.order_known && signs.of(steps_of_walk(o)) > no_sign;
  const bool of_run = runs && signs.of(of_groups(o.run)) > no_sign;
  const bool of_pass = passes > 2 && signs.of(of_groups(noise.pass)) > no_sign;
  if (!of_neighbours && !walks && !of_run && !of_pass) return noise;
  const Likelihood likelihood(o, model, weight);
  Search search(likelihood, noise, worth);
  if (of_neighbours) search.neighbours();
  if (walks)
    search.zero(Zero::walks, {0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.33, 0.55, 0.9, 1.5, 2.5, 4.0});
  const std::vector<double> sizes = {0.1, 0.18, 0.3, 0.55, 1.0, 1.8, 3.0, 5.5, 10.0, 18.0, 30.0};
  if (of_run) search.zero(Zero::of_run, sizes);
  if (of_pass) search.zero(Zero::of_pass, sizes);
  return search.found();
}

namespace {

/// n ln(squares/n) + ln|V|; the last of the columns contains the readings.
double deviance(const Observations& o, const std::vector<double>& weight, const Noise& noise,
                const MatrixXd& columns) {
  const Whitening white(o, weight, noise);
  MatrixXd whole = white(columns);
  white.take_out_zeros(whole);
  const auto n = static_cast<double>((white.root().array() > 0.0).count());
  const MatrixXd x = whole.leftCols(whole.cols() - 1);
  VectorXd y = whole.rightCols(1);
  double squares = y.squaredNorm();
  if (x.cols() > 0) {
    y = math::rotated(Eigen::HouseholderQR<MatrixXd>(x), y);
    squares = y.tail(y.size() - x.cols()).squaredNorm();
  }
  return n * std::log(squares / n) + white.log_det();
}

}  // namespace

Unsteady walk_with(const Observations& o, const std::vector<double>& weight, Noise noise,
                   const MatrixXd& model) {
  constexpr double beyond_minimum = 12.0;
  MatrixXd columns(model.rows(), model.cols() + 1);
  columns << model, Eigen::Map<const VectorXd>(o.deviation.data(), model.rows());
  noise.zero = Noise::Zero::steady;
  const double none = Whitening(o, weight, noise).log_det();
  double size_of_least = 0.0;
  const auto least_of = [&](Noise::Zero zero, const std::vector<double>& sizes) {
    double least = std::numeric_limits<double>::infinity();
    noise.zero = zero;
    for (const double size : sizes) {
      noise.zero_size = size;
      const double value = deviance(o, weight, noise, columns) - none;
      if (value < least) least = value, size_of_least = size;
      if (value > least + beyond_minimum) break;
    }
    return least;
  };
  std::vector<double> steps;
  for (int k = 0; k <= 12; ++k) steps.push_back(std::pow(10.0, 0.125 * k - 1.0));
  Unsteady out;
  out.walks = least_of(Noise::Zero::walks, steps);
  if (std::any_of(o.run.begin(), o.run.end(),
                  [&](std::uint32_t run) { return run != o.run.front(); }))
    out.of_run = least_of(Noise::Zero::of_run, {0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8});
  if (noise.pass.empty()) return out;
  std::vector<double> sizes;
  for (int k = 0; k <= 14; ++k) sizes.push_back(0.2 * std::pow(2.0, 0.5 * k));
  out.of_pass = least_of(Noise::Zero::of_pass, sizes);
  out.size_of_pass = size_of_least;
  return out;
}

double criterion_of_neighbours(const Observations& o, const std::vector<double>& weight,
                               Noise noise, const MatrixXd& model) {
  MatrixXd columns(model.rows(), model.cols() + 1);
  columns << model, Eigen::Map<const VectorXd>(o.deviation.data(), model.rows());
  noise.zero = Noise::Zero::steady;
  noise.neighbours = 0.0;
  const double none = Whitening(o, weight, noise).log_det();
  double least = std::numeric_limits<double>::infinity();
  // A higher correlation is practically a random walk.
  for (const double rho : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8}) {
    noise.neighbours = rho;
    least = std::min(least, deviance(o, weight, noise, columns) - none);
  }
  return least;
}

}  // namespace nonio::model
