// SPDX-License-Identifier: Apache-2.0
//
// The mean s and the half difference h of both directions are fitted at equal angles, each with
// noise of its own: a shape that the model does not contain is in s, equally in both directions,
// and is not noise of h.
// Decisions based on the fit: docs/dev/constants.md, A12 (shares of the causes);
// docs/dev/constants.md, A14 (causes that cannot be separated).
#include <algorithm>
#include <cmath>
#include <map>

#include "common/constants.h"
#include "nonio/math/circle.h"
#include "statistics/path_noise.h"

namespace nonio::math {

namespace {

constexpr double bin_width = full_turn / 360.0;
constexpr int bins_of_turn = 360;
constexpr std::size_t at_least = 24;  // fewest bins; more if the number of causes requires it
// Least fraction of the squared norm of a column that is independent of the other columns;
// otherwise the cause is not fitted.
constexpr double singular = 1e-10;

std::size_t index_of(Cause c) { return static_cast<std::size_t>(c); }
double sign_of(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

double within_turn(double t) { return t - full_turn * std::floor(t / full_turn); }

struct Bins {
  struct Bin {
    double n = 0.0, deviation = 0.0, angle = 0.0;
    std::array<double, cause_count> column{};
  };
  std::map<int, std::array<Bin, 2>> of;  ///< key: degree; index 0: counter-clockwise, 1: clockwise

  Bins(std::span<const CircleReading> readings, const CircleModel& model) {
    for (const CircleReading& r : readings) {
      if (model.leaves_out(r.angle)) continue;
      const double t = within_turn(r.angle);
      const int place = static_cast<int>(std::floor(t / bin_width + 1e-6)) % bins_of_turn;
      Bin& bin = of[place][r.direction > 0 ? 0 : 1];
      bin.n += 1.0;
      bin.deviation += r.deviation, bin.angle += t;
      for (std::size_t c = 0; c < cause_count; ++c)
        if (model.wanted[c])
          bin.column[c] += cause_at(static_cast<Cause>(c), model, t, r.direction);
    }
    for (auto& entry : of)
      for (Bin& bin : entry.second) {
        if (bin.n == 0.0) continue;
        bin.deviation /= bin.n, bin.angle /= bin.n;
        for (double& x : bin.column) x /= bin.n;
      }
  }
};

/// Rows of the mean of both directions, of half their difference, or of one direction.
struct Block {
  std::vector<int> place;
  Eigen::MatrixXd X;
  Eigen::VectorXd y;
  PathNoise noise;
  double variance = 1.0;

  Block(std::size_t rows, std::size_t columns) : X(at(rows), at(columns)), y(at(rows)) {}
};

class Fit {
 public:
  Fit(std::span<const CircleReading> readings, const CircleModel& model)
      : readings_(readings), model_(model), bins_(readings, model) {
    for (std::size_t c = 0; c < cause_count; ++c)
      if (model.wanted[c]) columns_.push_back(c);
    std::array<std::size_t, 3> count{};  // number of bins: only ccw, only cw, both
    for (const auto& [place, bin] : bins_.of) {
      const bool plus = bin[0].n > 0.0, minus = bin[1].n > 0.0;
      ++count[plus && minus ? 2 : plus ? 0 : 1];
    }
    both_ = count[2] > 0 && 2 * count[2] >= count[0] + count[1];
    only_ = count[0] >= count[1] ? 0 : 1;
  }

  Expected<CauseFit> done() {
    make_blocks();
    const std::size_t rows = blocks_.empty() ? 0 : blocks_.front().place.size();
    if (rows < std::max(at_least, 2 * columns_.size() / std::max<std::size_t>(1, blocks_.size())))
      return fail("expected readings at " +
                  std::to_string(std::max(at_least, 2 * columns_.size())) +
                  " degrees of the circle or more, found " + std::to_string(rows));
    for (Block& block : blocks_) weigh(block);
    solve();
    return std::move(out_);
  }

 private:
  bool usable(const std::array<Bins::Bin, 2>& bin) const {
    return both_ ? bin[0].n > 0.0 && bin[1].n > 0.0 : bin[only_].n > 0.0;
  }

  void make_blocks() {
    for (const auto& entry : bins_.of)
      if (usable(entry.second)) places_.push_back(entry.first);
    if (places_.empty()) return;
    for (int b = 0; b < (both_ ? 2 : 1); ++b) {
      Block block(places_.size(), columns_.size());
      block.place = places_;
      for (std::size_t i = 0; i < places_.size(); ++i) {
        const auto& bin = bins_.of.at(places_[i]);
        const auto mixed = [&](double plus, double minus) {
          if (!both_) return only_ == 0 ? plus : minus;
          return b == 0 ? (plus + minus) / 2.0 : (plus - minus) / 2.0;
        };
        block.y[at(i)] = mixed(bin[0].deviation, bin[1].deviation);
        for (std::size_t k = 0; k < columns_.size(); ++k)
          block.X(at(i), at(k)) = mixed(bin[0].column[columns_[k]], bin[1].column[columns_[k]]);
      }
      blocks_.push_back(std::move(block));
    }
  }

  void weigh(Block& block) {
    std::vector<Eigen::Index> here;
    for (Eigen::Index k = 0; k < block.X.cols(); ++k) {
      double largest = 0.0;
      for (const Block& other : blocks_) largest = std::max(largest, other.X.col(k).norm());
      // A column that remains only because the angles of both directions differ is omitted.
      if (block.X.col(k).norm() > 0.1 * largest) here.push_back(k);
    }
    Eigen::MatrixXd X(block.X.rows(), at(here.size()));
    for (std::size_t k = 0; k < here.size(); ++k)
      X.col(at(k)) = block.X.col(here[k]) / block.X.col(here[k]).norm();
    const Eigen::VectorXd scaled = block.y * 1e6;
    if (model_.correlated) block.noise = path_noise(X, scaled, block.place);
    Eigen::MatrixXd white = with_column(X, block.y);
    whiten(white, block.place, block.noise);
    const Eigen::MatrixXd W = left_columns(white, X.cols());
    const Eigen::VectorXd v = white.col(X.cols());
    const Eigen::VectorXd beta = least_squares(W, v);
    const double dof = static_cast<double>(std::max<Eigen::Index>(1, X.rows() - X.cols()));
    block.variance = std::max(squared_residual(v, W, beta) / dof, 1e-26);
    const double n = static_cast<double>(X.rows()) / block.noise.slow() -
                     static_cast<double>(X.cols()) / std::max(1.0, block.noise.slow());
    const double effective = std::max(1.0, n);
    out_.dof = out_.dof > 0.0 ? std::min(out_.dof, effective) : effective;
  }

  void solve() {
    Eigen::Index rows = 0;
    for (const Block& b : blocks_) rows += b.X.rows();
    const Eigen::Index k = at(columns_.size());
    Eigen::MatrixXd plain(rows, k), white(rows, k);
    Eigen::VectorXd y(rows);
    // The whitened unit vectors are the matrix of the filter, which the derivatives need.
    std::vector<Eigen::MatrixXd> filters;
    Eigen::Index row = 0;
    for (const Block& b : blocks_) {
      const Eigen::Index n = b.X.rows();
      Eigen::MatrixXd all(n, k + n);
      all << b.X, Eigen::MatrixXd::Identity(n, n);
      whiten(all, b.place, b.noise);
      const double scale = 1.0 / std::sqrt(b.variance);
      white.middleRows(row, n) = all.leftCols(k) * scale;
      plain.middleRows(row, n) = b.X;
      filters.push_back(columns(all, k, n) * scale);
      y.segment(row, n) = times(filters.back(), b.y);
      row += n;
    }
    Eigen::VectorXd norm(k);
    for (Eigen::Index c = 0; c < k; ++c) {
      norm[c] = white.col(c).norm();
      white.col(c) /= norm[c];
    }
    const Eigen::MatrixXd C =
        inverse(Eigen::LDLT<Eigen::MatrixXd>(transposed_product(white, white)));
    const Eigen::MatrixXd G = product_transposed(C, white);
    const Eigen::VectorXd beta = times(G, y).cwiseQuotient(norm);
    put(beta, C, G, norm, filters);
    residuals(beta);
  }

  void put(const Eigen::VectorXd& beta, const Eigen::MatrixXd& C, const Eigen::MatrixXd& G,
           const Eigen::VectorXd& norm, const std::vector<Eigen::MatrixXd>& filters) {
    out_.covariance_of.assign(cause_count * cause_count, 0.0);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      CauseFit::Value& v = out_.of[columns_[i]];
      v.inflation = C(at(i), at(i));
      v.fitted = std::isfinite(v.inflation) && v.inflation > 0.0 && v.inflation < 1.0 / singular;
      v.value = beta[at(i)];
      v.u = std::sqrt(std::max(0.0, v.inflation)) / norm[at(i)];
      v.dof = out_.dof;
      for (std::size_t j = 0; j < columns_.size(); ++j)
        out_.covariance_of[columns_[i] * cause_count + columns_[j]] =
            C(at(i), at(j)) / norm[at(i)] / norm[at(j)];
      by_bins(v, G.row(at(i)) / norm[at(i)], filters);
    }
  }

  /// Converts derivatives by the rows of the blocks to derivatives by the means of each direction:
  /// ccw in the order of travel, then cw.
  void by_bins(CauseFit::Value& v, const Eigen::RowVectorXd& G,
               const std::vector<Eigen::MatrixXd>& filters) const {
    const Eigen::Index n = at(places_.size());
    Eigen::RowVectorXd first = transposed_times(filters[0], G.head(n).transpose()).transpose();
    if (!both_) {
      if (only_ == 1) first.reverseInPlace();
      v.by_bin.assign(first.data(), first.data() + n);
      return;
    }
    const Eigen::RowVectorXd second =
        transposed_times(filters[1], G.tail(n).transpose()).transpose();
    const Eigen::RowVectorXd plus = (first + second) / 2.0;
    Eigen::RowVectorXd minus = (first - second) / 2.0;
    minus.reverseInPlace();
    v.by_bin.assign(plus.data(), plus.data() + n);
    v.by_bin.insert(v.by_bin.end(), minus.data(), minus.data() + n);
  }

  void residuals(const Eigen::VectorXd& beta) {
    const auto add = [&](int place, std::size_t which) {
      const Bins::Bin& bin = bins_.of.at(place)[which];
      double model = 0.0;
      for (std::size_t k = 0; k < columns_.size(); ++k)
        model += beta[at(k)] * bin.column[columns_[k]];
      out_.bins.push_back({bin.angle, bin.deviation, bin.deviation - model, which == 0 ? 1 : -1});
    };
    if (both_ || only_ == 0)
      for (const int place : places_) add(place, 0);
    if (both_ || only_ == 1)
      for (auto place = places_.rbegin(); place != places_.rend(); ++place) add(*place, 1);
    double squares = 0.0, products = 0.0;
    for (std::size_t i = 0; i < out_.bins.size(); ++i) {
      squares += out_.bins[i].residual * out_.bins[i].residual;
      if (i > 0 && out_.bins[i].direction == out_.bins[i - 1].direction)
        products += out_.bins[i].residual * out_.bins[i - 1].residual;
    }
    const double n = static_cast<double>(out_.bins.size());
    out_.s = std::sqrt(squares / std::max(1.0, n - static_cast<double>(columns_.size())));
    out_.correlation = squares > 0.0 ? products / squares : 0.0;
    out_.s_reading = scatter_of_readings();
  }

  double scatter_of_readings() const {
    double squares = 0.0, n = 0.0;
    for (const CircleReading& r : readings_) {
      if (model_.leaves_out(r.angle)) continue;
      if (!both_ && (r.direction > 0) != (only_ == 0)) continue;
      const double off = r.deviation - out_.radius_at(model_, r.angle, r.direction);
      squares += off * off, n += 1.0;
    }
    return std::sqrt(squares / std::max(1.0, n - static_cast<double>(columns_.size())));
  }

  std::span<const CircleReading> readings_;
  const CircleModel& model_;
  Bins bins_;
  bool both_ = false;
  std::size_t only_ = 0;
  std::vector<std::size_t> columns_;
  std::vector<int> places_;
  std::vector<Block> blocks_;
  CauseFit out_;
};

}  // namespace

bool CircleModel::leaves_out(double angle) const {
  constexpr double quarter = full_turn / 4.0;
  return std::fabs(angle - quarter * std::round(angle / quarter)) < leave_out;
}

void all_causes(CircleModel& m, bool both_directions) {
  m.wanted.fill(true);
  const auto leave = [&](Cause c) { m.wanted[index_of(c)] = false; };
  if (!both_directions)
    for (const Cause c : {Cause::zero_change, Cause::centre_change_u, Cause::centre_change_v,
                          Cause::servo_mismatch})
      leave(c);
  if (!(m.pitch[0] > 0.0)) leave(Cause::cyclic_u_sin), leave(Cause::cyclic_u_cos);
  if (!(m.pitch[1] > 0.0)) leave(Cause::cyclic_v_sin), leave(Cause::cyclic_v_cos);
}

double cause_at(Cause cause, const CircleModel& m, double t, int direction) {
  const double c = std::cos(t), s = std::sin(t), d = direction;
  const auto phase = [&](std::size_t k, double along) {
    return full_turn * (m.centre[k] + m.R * along) / m.pitch[k];
  };
  switch (cause) {
    case Cause::centre_u:
      return c;
    case Cause::centre_v:
      return s;
    case Cause::radius:
      return 1.0;
    case Cause::zero_change:
      return d;
    case Cause::centre_change_u:
      return d * c;
    case Cause::centre_change_v:
      return d * s;
    case Cause::scale_mismatch:
      return m.R / 2.0 * (c * c - s * s);
    case Cause::squareness:
      return -m.R * s * c;
    case Cause::servo_mismatch:
      return d * s * c;
    case Cause::reversal_u:
      return -d / 2.0 * sign_of(s) * c;
    case Cause::reversal_v:
      return d / 2.0 * sign_of(c) * s;
    case Cause::lateral_u:
      return -d / 2.0 * std::fabs(s);
    case Cause::lateral_v:
      return d / 2.0 * std::fabs(c);
    case Cause::bow_u:
      return c * c * s;
    case Cause::bow_v:
      return s * s * c;
    case Cause::cyclic_u_sin:
      return std::sin(phase(0, c)) * c;
    case Cause::cyclic_u_cos:
      return std::cos(phase(0, c)) * c;
    case Cause::cyclic_v_sin:
      return std::sin(phase(1, s)) * s;
    case Cause::cyclic_v_cos:
      return std::cos(phase(1, s)) * s;
    case Cause::count:
      break;
  }
  return 0.0;
}

double CauseFit::radius_at(const CircleModel& model, double angle, int direction) const {
  double r = 0.0;
  for (std::size_t c = 0; c < cause_count; ++c)
    if (of[c].value != 0.0)
      r += of[c].value * cause_at(static_cast<Cause>(c), model, angle, direction);
  return r;
}

double CauseFit::u_at(const CircleModel& model, double angle, int direction) const {
  std::array<double, cause_count> column{};
  for (std::size_t c = 0; c < cause_count; ++c)
    if (of[c].fitted) column[c] = cause_at(static_cast<Cause>(c), model, angle, direction);
  double square = 0.0;
  for (std::size_t a = 0; a < cause_count; ++a)
    for (std::size_t b = 0; b < cause_count; ++b)
      if (column[a] != 0.0 && column[b] != 0.0)
        square += column[a] * column[b] * covariance_of[a * cause_count + b];
  return std::sqrt(std::max(0.0, square));
}

double CauseFit::covariance(Cause a, Cause b) const {
  return covariance_of.empty() ? 0.0 : covariance_of[index_of(a) * cause_count + index_of(b)];
}

Expected<CauseFit> fit_causes(std::span<const CircleReading> readings, const CircleModel& model) {
  return Fit(readings, model).done();
}

}  // namespace nonio::math
