// SPDX-License-Identifier: Apache-2.0
// What noise does: gains of the reference, and uncertainties that cover the truth.
#include <iostream>

#include "workshop.h"

namespace steps::step_noise_test {
namespace {

using namespace nonio::math;

constexpr unsigned seed = 20261122;

const StepCurve& curve(const StepSolution& s, const std::string& name) {
  for (const auto& c : s.curves)
    if (c.name == name) return c;
  throw std::runtime_error(name);
}

TEST(StepNoise, AveragingIsARandomWalk) {
  const Volume v;
  const auto s = average_step_diagonals(empty(v), {true, true, 1.0 * um});
  ASSERT_TRUE(s);
  const auto& c = curve(*s, "EXX");
  const double alpha = 0.8 / std::sqrt(0.8 * 0.8 + 2 * 0.6 * 0.6);
  for (std::size_t i = 0; i <= v.n; ++i)
    EXPECT_NEAR(c.u[i], std::sqrt(2.0 * static_cast<double>(i)) * um / (2.0 * alpha), 1e-3 * um);
  EXPECT_NEAR(c.u.back(), 6.5 * um, 0.05 * um);
}

/// The fit of the reference written down once more, from its formulas: the covariance of the 9n
/// function values for unit noise of all readings and of three axis series. With `zeros`, the
/// reading before the first move and the axis series at the start are as noisy as the others.
Eigen::MatrixXd reference(const Volume& v, bool zeros) {
  const double L = v.travel.norm();
  const auto n = static_cast<int>(v.n);
  const int z = zeros ? 7 : 0, size = 9 * n + 8 + z;
  std::vector<Eigen::VectorXd> rows;
  for (int k = 0; k < 4; ++k) {
    Vector u = v.travel / L;
    for (int c = 0; c < 3; ++c) u[c] *= four()[k][c];
    Eigen::Matrix3d turned = Eigen::Quaterniond::FromTwoVectors(Vector::UnitX(), u).matrix();
    for (int t = zeros ? 0 : 1; t <= 3 * n; ++t) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
      Vector p;
      for (int a = 0; a < 3; ++a) {
        const int moved = (t + 2 - a) / 3;
        p[a] = four()[k][a] * v.travel[a] * moved / n;
        const int start = four()[k][a] > 0 ? 0 : n, here = start + four()[k][a] * moved;
        for (int b = 0; b < 3; ++b) {
          if (here > 0) row[(3 * a + b) * n + here - 1] += u[b];
          if (start > 0) row[(3 * a + b) * n + start - 1] -= u[b];
        }
      }
      for (int c = 0; c < 2; ++c) row[9 * n + 2 * k + c] = turned.col(1 + c).dot(p);
      if (zeros) row[9 * n + 8 + k] = 1.0;
      rows.push_back(row);
    }
  }
  for (int a = 0; a < 3; ++a)
    for (int i = zeros ? 0 : 1; i <= n; ++i) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
      if (i > 0) row[4 * a * n + i - 1] = 1.0;
      if (zeros) row[9 * n + 12 + a] = 1.0;
      rows.push_back(row);
    }
  for (const int f : {1, 2, 5}) {  // EYX, EZX, EZY
    rows.push_back(Eigen::VectorXd::Zero(size));
    rows.back()[f * n + n - 1] = 1e3;  // exact compared with readings
  }
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(size, size);
  for (const auto& row : rows) N += row * row.transpose();
  return N.inverse().topLeftCorner(9 * n, 9 * n);
}

TEST(StepNoise, GainsOfTheReference) {
  struct Case {
    int n;
    double EXX, EYX, EZX, EXY;
  };
  for (const Case& c : {Case{10, .67, 1.8, 1.9, 1.5}, Case{40, .67, 3.7, 3.8, 2.9}}) {
    const Eigen::MatrixXd C = reference({{0.8, 0.6, 0.6}, static_cast<std::size_t>(c.n)}, false);
    const auto gain = [&](int f, int i) {
      const int at = f * c.n + i - 1;
      return std::sqrt(C(at, at));
    };
    EXPECT_NEAR(gain(0, c.n / 2), c.EXX, 0.006);
    EXPECT_NEAR(gain(1, c.n / 2), c.EYX, 0.06);
    EXPECT_NEAR(gain(2, c.n / 2), c.EZX, 0.06);
    EXPECT_NEAR(gain(3, c.n / 2), c.EXY, 0.06);
    EXPECT_NEAR(gain(3, c.n), 0.555, 0.02);  // C0Y Y: 0.54 to 0.57
  }
}

TEST(StepNoise, KernelHasTheReferencesCovariance) {
  const Volume v{{0.8, 0.6, 0.6}, 10};
  const auto s =
      solve_step_diagonals(empty(v), lengths({}, v, "XYZ", 1.0 * um), {false, true, 1.0 * um});
  ASSERT_TRUE(s);
  const Eigen::MatrixXd C = reference(v, true);
  const Eigen::Index n = 10, m = 11;
  Eigen::MatrixXd line(m, 2);
  for (Eigen::Index i = 0; i < m; ++i) line.row(i) << 1.0, static_cast<double>(i);
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(m, m) -
                               line * (line.transpose() * line).inverse() * line.transpose();
  for (Eigen::Index f = 0; f < 9; ++f) {
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(m, m);
    block.bottomRightCorner(n, n) = C.block(f * n, f * n, n, n);
    if (f % 4 != 0) block = (rest * block * rest).eval();
    const auto& curve = s->curves[static_cast<std::size_t>(f)];
    for (Eigen::Index i = 0; i < m; ++i)
      EXPECT_NEAR(curve.u[static_cast<std::size_t>(i)] / um, std::sqrt(std::max(0.0, block(i, i))),
                  1e-6)
          << curve.name << " " << i;
  }
}

/// Adds white noise to every reading, that of the start included.
void shake(StepDiagonals& d, std::mt19937& rng, double u) {
  std::normal_distribution<double> noise(0.0, u);
  for (auto& pass : d.passes) {
    const double start = noise(rng);
    for (double& r : pass.reading) r += noise(rng) - start;
  }
}

/// 2,000 campaigns of each method: noise of a reading stated, or from the residuals.
TEST(StepNoise, UncertaintyCoversTheTruth) {
  const Volume v{{0.8, 0.6, 0.5}, 7};
  const double u = 0.5 * um, u_axis = 0.3 * um;
  constexpr int campaigns = 2000;
  for (const std::string method : {"least squares", "averaging, square set-up", "averaging"})
    for (const bool told : {true, false}) {
      std::mt19937 rng(seed);
      std::normal_distribution<double> noise(0.0, u_axis);
      int held = 0, all = 0, square_held = 0;
      for (int k = 0; k < campaigns; ++k) {
        const auto e = random_errors(rng, v, 20 * um);
        const bool fitted = method == "least squares";
        // Averaging turns a set-up angle into false errors: it requires a mirror that is square.
        auto d = measured(e, v, random_set_up(rng, fitted ? 0.2e-3 : 0.0, true));
        shake(d, rng, u);
        auto axes = lengths(e, v, "XYZ", u_axis);
        for (auto& s : axes)
          for (double& y : s.deviation) y += noise(rng);
        const StepChoices choices{method == "averaging, square set-up", true, told ? u : 0.0};
        const auto s =
            fitted ? solve_step_diagonals(d, axes, choices) : average_step_diagonals(d, choices);
        ASSERT_TRUE(s);
        for (const auto& c : s->curves) {
          const auto wanted = truth(e, v, c);
          const std::size_t last =
              c.known ? wanted.size() : wanted.size() - 1;  // less its end line
          for (std::size_t i = 1; i < last; ++i, ++all)
            held += std::fabs(c.value[i] - wanted[i]) <= 2.0 * c.u[i];
        }
        const auto square = true_squareness(e, v);
        for (std::size_t i = 0; i < 3; ++i)
          square_held += std::fabs(s->squareness[i].value - square[i]) <= 2.0 * s->squareness[i].u;
      }
      const double curves = static_cast<double>(held) / all, square = square_held / 3.0 / campaigns;
      std::cout << "seed " << seed << ", " << method << (told ? ", u told" : ", u from residuals")
                << ": curves " << 100 * curves << " %, squareness " << 100 * square << " %\n";
      for (const double share : {curves, square}) {
        EXPECT_GT(share, 0.93) << method;
        EXPECT_LT(share, 0.97) << method;
      }
    }
}

}  // namespace
}  // namespace steps::step_noise_test
