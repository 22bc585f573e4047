// SPDX-License-Identifier: Apache-2.0
#include "whitening.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nonio::model {

namespace {

/// The states of a line are the part correlated between adjacent readings, and the level.
struct Covariance {
  double near = 1.0, both = 0.0, level = 0.0;
  bool begun = false;
  std::uint32_t pass = 0, run = 0;
};

}  // namespace

Noise Whitening::of_repeats(Noise noise) {
  noise.zero = Noise::Zero::steady;
  noise.neighbours = noise.in_repeats;
  return noise;
}

Whitening::Whitening(const Observations& o, const std::vector<double>& weight, const Noise& noise)
    : o_(o), root_(root_weights(o, weight)) {
  for (Index i = 0; i < root_.size() && !noise.rough.empty(); ++i)
    root_(i) /= noise.rough[static_cast<std::size_t>(i)];
  if (!noise.independent()) filter(noise, o);
  zeros_ = (*this)(VectorXd::Ones(root_.size()));
  VectorXd of_line = VectorXd::Zero(static_cast<Index>(lines_of(o)));
  for (Index i = 0; i < root_.size(); ++i)
    of_line(static_cast<Index>(line_of(o, static_cast<std::size_t>(i)))) += zeros_(i) * zeros_(i);
  for (const double x : of_line)
    if (x > 0.0) log_det_ += std::log(x);
}

void Whitening::filter(const Noise& noise, const Observations& o) {
  using Zero = Noise::Zero;
  const double rho = noise.neighbours, size2 = noise.zero_size * noise.zero_size;
  const bool own = noise.zero == Zero::of_run || noise.zero == Zero::of_pass;
  std::vector<Covariance> of_line(lines_of(o));
  step_.resize(o.size());
  for (std::size_t i = 0; i < o.size(); ++i) {
    Covariance& P = of_line[line_of(o, i)];
    Step& s = step_[i];
    const std::uint32_t pass = noise.pass[i], run = o.run.empty() ? 1 : o.run[i];
    const bool other = !P.begun || (noise.zero == Zero::of_run ? P.run != run : P.pass != pass);
    s.keep_near = P.begun ? rho : 0.0;  // the correlation continues from pass to pass
    s.keep_level = P.begun && !(own && other) ? 1.0 : 0.0;
    P.near = s.keep_near * s.keep_near * P.near + 1.0 - s.keep_near * s.keep_near;
    P.both *= s.keep_near * s.keep_level;
    if (s.keep_level == 0.0)
      P.level = own ? size2 : 0.0;
    else if (noise.zero == Zero::walks)
      P.level += size2;
    P.begun = true, P.pass = pass, P.run = run;
    const double h = s.loading = root_(static_cast<Index>(i));
    if (!(h > 0.0)) continue;
    const double to_near = P.near + h * P.both, to_level = P.both + h * P.level;
    const double F = to_near + h * to_level;
    s.gain_near = to_near / F, s.gain_level = to_level / F, s.over_root = 1.0 / std::sqrt(F);
    P.near -= s.gain_near * to_near;
    P.both -= s.gain_near * to_level;
    P.level -= s.gain_level * to_level;
    log_det_ += std::log(F);
  }
}

MatrixXd Whitening::operator()(const MatrixXd& columns) const {
  MatrixXd out = root_.asDiagonal() * columns;
  if (independent()) return out;
  const std::size_t lines = lines_of(o_);
  // Each step waits for the one before, so four columns take about the time of one.
  constexpr Index at_once = 4;
  struct State {
    double near = 0.0, level = 0.0;
  };
  std::vector<std::array<State, at_once>> of_line;
  for (Index first = 0; first < out.cols(); first += at_once) {
    const Index columns_here = std::min(at_once, out.cols() - first);
    of_line.assign(lines, {});
    for (Index i = 0; i < out.rows(); ++i) {
      const Step& s = step_[static_cast<std::size_t>(i)];
      auto& states = of_line[line_of(o_, static_cast<std::size_t>(i))];
      for (Index k = 0; k < columns_here; ++k) {
        auto& [a, l] = states[static_cast<std::size_t>(k)];
        a *= s.keep_near, l *= s.keep_level;
        const double v = out(i, first + k) - a - s.loading * l;
        a += s.gain_near * v, l += s.gain_level * v;
        out(i, first + k) = s.over_root * v;
      }
    }
  }
  return out;
}

void Whitening::take_out_zeros(MatrixXd& whitened) const {
  model::take_out_zeros(o_, zeros_, whitened);
}

MatrixXd covariance_of(const Observations& o, const VectorXd& root, const Noise& noise) {
  using Zero = Noise::Zero;
  const double size2 = noise.zero_size * noise.zero_size;
  const auto run = [&](std::size_t i) { return o.run.empty() ? 1 : o.run[i]; };
  MatrixXd v = MatrixXd::Zero(root.size(), root.size());
  for (Index a = 0; a < root.size(); ++a) {
    double alike = 1.0;
    const auto i = static_cast<std::size_t>(a);
    for (Index b = a; b < root.size() && root(a) > 0.0; ++b) {
      const auto j = static_cast<std::size_t>(b);
      if (line_of(o, i) != line_of(o, j)) continue;
      const bool same = noise.pass[i] == noise.pass[j];
      if (b > a) alike *= noise.neighbours;
      if (!(root(b) > 0.0)) continue;
      v(a, b) = (a == b ? 1.0 : alike) / (root(a) * root(b));
      if (noise.zero == Zero::walks) v(a, b) += size2 * static_cast<double>(a);
      if (noise.zero == Zero::of_run && run(i) == run(j)) v(a, b) += size2;
      if (noise.zero == Zero::of_pass && same) v(a, b) += size2;
      v(b, a) = v(a, b);
    }
  }
  return v;
}

}  // namespace nonio::model
