// SPDX-License-Identifier: Apache-2.0
#include "pass_zeros.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/distributions.h"

namespace nonio::model {

double degrees_of_passes(const Repeats& repeats) {
  return static_cast<double>(repeats.passes) - static_cast<double>(repeats.sides);
}

namespace {

double share_of(const std::vector<std::uint32_t>& group, std::size_t groups,
                const MatrixXd& columns) {
  const MatrixXd centred = columns.rowwise() - columns.colwise().mean();
  MatrixXd sum = MatrixXd::Zero(static_cast<Index>(groups), columns.cols());
  VectorXd n = VectorXd::Zero(sum.rows());
  for (Index i = 0; i < columns.rows(); ++i) {
    const auto at = static_cast<Index>(group[static_cast<std::size_t>(i)]);
    sum.row(at) += centred.row(i), ++n(at);
  }
  const double all = centred.squaredNorm();
  const double between = (n.cwiseMax(1.0).cwiseInverse().asDiagonal() * sum.cwiseAbs2()).sum();
  return all > 0.0 ? between / all : 0.0;
}

}  // namespace

double share_of_passes(const Repeats& repeats, const MatrixXd& columns) {
  return share_of(repeats.pass, repeats.passes, columns);
}

double share_of_cells(const Repeats& repeats, const MatrixXd& columns) {
  return share_of(repeats.cell, repeats.cells, columns);
}

ZerosOfPasses::ZerosOfPasses(const Part& part, const Repeats& r, const std::vector<double>& weight,
                             const std::vector<double>& residual)
    : sides_(r.sides) {
  std::vector<double> sum(r.passes, 0.0), n(r.passes, 0.0), way(r.passes, 0.0);
  std::vector<std::size_t> order;
  std::vector<std::uint32_t> run(r.passes, 0);
  for (std::size_t i = 0; i < weight.size(); ++i) {
    const std::uint32_t p = r.pass[i];
    if (!(weight[i] > 0.0)) continue;
    if (n[p] == 0.0) order.push_back(p);
    sum[p] += weight[i] * residual[i], n[p] += weight[i];
    run[p] = part.table.run.empty() ? 0 : part.table.run_of(i);
    way[p] = i < part.way.size() ? part.way[i] : 0.0;  // parts made by tests have no direction
  }
  for (const std::size_t p : order)
    zeros_.push_back({sum[p] / n[p], way[p], n[p], r.side[p], run[p]});
  // A pass in which every reading is suspect is not counted.
  std::vector<char> read(sides_, 0);
  for (const Zero& z : zeros_) read[z.side] = 1;
  degrees_ = static_cast<double>(zeros_.size()) -
             static_cast<double>(std::count(read.begin(), read.end(), 1));
}

double ZerosOfPasses::squares() const {
  std::vector<double> sum(sides_, 0.0), n(sides_, 0.0);
  for (const Zero& z : zeros_) sum[z.side] += z.readings * z.value, n[z.side] += z.readings;
  double squares = 0.0;
  for (const Zero& z : zeros_)
    squares += z.readings * std::pow(z.value - sum[z.side] / n[z.side], 2);
  return squares;
}

double ZerosOfPasses::p_of_differences(double s) const {
  if (!(s > 0.0) || !(degrees_ >= 1.0)) return 1.0;
  double all = 0.0;
  for (const Zero& z : zeros_) all += z.readings;
  return math::f_upper(squares() / degrees_ / (s * s), degrees_, std::max(all - degrees_, 1.0));
}

bool ZerosOfPasses::unordered() const {
  // docs/dev/constants.md, M48.
  constexpr double fewest = 4.0, by_chance = 0.005;
  const std::size_t m = zeros_.size();
  if (degrees_ < fewest) return false;
  const double dof = degrees_ - 1.0;
  double least = 1.0, tests = 0.0;
  for (const bool reversal : {false, true}) {
    VectorXd y(static_cast<Index>(m));
    for (std::size_t p = 0; p < m; ++p)
      y(static_cast<Index>(p)) = zeros_[p].value * (reversal ? zeros_[p].way : 1.0);
    centre(y);
    const auto test = [&](const auto& pattern) {
      VectorXd c(y.size());
      for (std::size_t p = 0; p < m; ++p) c(static_cast<Index>(p)) = pattern(p);
      centre(c);
      const double size = c.squaredNorm();
      if (!(size > 1e-9)) return;
      const double fall = std::pow(c.dot(y), 2) / size;
      ++tests;
      least = std::min(
          least, math::f_upper(math::test_ratio(fall, (y.squaredNorm() - fall) / dof), 1.0, dof));
    };
    test([](std::size_t p) { return static_cast<double>(p); });
    for (std::size_t step = 1; step < m; ++step)
      test([&](std::size_t p) { return p < step ? 0.0 : 1.0; });
    for (std::size_t first = 0; first < m; ++first)
      if (first == 0 || zeros_[first].run != zeros_[first - 1].run)
        test([&](std::size_t p) { return zeros_[p].run == zeros_[first].run ? 1.0 : 0.0; });
  }
  return least * tests > by_chance;
}

/// Subtracts from the value of each pass the mean over the passes of its side.
void ZerosOfPasses::centre(VectorXd& values) const {
  std::vector<double> sum(sides_, 0.0), n(sides_, 0.0);
  for (std::size_t p = 0; p < zeros_.size(); ++p)
    sum[zeros_[p].side] += values(static_cast<Index>(p)), n[zeros_[p].side] += 1.0;
  for (std::size_t p = 0; p < zeros_.size(); ++p)
    values(static_cast<Index>(p)) -= sum[zeros_[p].side] / n[zeros_[p].side];
}

}  // namespace nonio::model
