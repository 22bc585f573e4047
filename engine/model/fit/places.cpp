// SPDX-License-Identifier: Apache-2.0
#include "places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "nonio/math/distributions.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::model {

/// Columns that vary with one factor only; `repeated`: told by differences between repeats of one
/// cell (time, run, temperature), else by the cells themselves (position, direction, phase).
struct Factor {
  std::string name;
  MatrixXd columns;
  bool repeated = false;
  std::vector<double> levels{};  // of dummies: target, run
  Quantity quantity = Quantity::number;
  std::string line{};  // in space: the line whose places these are
};

namespace {

constexpr Index most_bins = 40;

MatrixXd dummies(const std::vector<std::size_t>& level, std::size_t levels) {
  MatrixXd out = MatrixXd::Zero(static_cast<Index>(level.size()), static_cast<Index>(levels));
  for (std::size_t i = 0; i < level.size(); ++i)
    out(static_cast<Index>(i), static_cast<Index>(level[i])) = 1.0;
  return out;
}

/// Distinct values, at most `most_bins` of them: beyond, neighbours share a bin.
Factor binned(std::string name, const std::vector<double>& value, Quantity quantity) {
  const std::set<double> distinct(value.begin(), value.end());
  const std::size_t in_bin =
      (distinct.size() + most_bins - 1) / static_cast<std::size_t>(most_bins);
  std::map<double, std::size_t> bin;
  Factor f{std::move(name), {}, false, {}, quantity};
  for (const double v : distinct) {
    const std::size_t b = bin.size() / in_bin;
    bin[v] = b;
    if (b == f.levels.size()) f.levels.push_back(v);
  }
  std::vector<std::size_t> level;
  for (const double v : value) level.push_back(bin[v]);
  f.columns = dummies(level, f.levels.size());
  return f;
}

MatrixXd waves(const VectorXd& angle, Index orders) {
  MatrixXd out(angle.size(), 2 * orders);
  for (Index k = 0; k < orders; ++k) {
    out.col(2 * k) = (angle * static_cast<double>(k + 1)).array().sin();
    out.col(2 * k + 1) = (angle * static_cast<double>(k + 1)).array().cos();
  }
  return out;
}

VectorXd map(const std::vector<double>& v) {
  return Eigen::Map<const VectorXd>(v.data(), static_cast<Index>(v.size()));
}

MatrixXd times(const MatrixXd& columns, const VectorXd& by) { return by.asDiagonal() * columns; }

}  // namespace

/// What readings are split by: the axis that moves or, in space, the way along each line; and the
/// products of two factors.
class Factors {
 public:
  Factors(const Part& part, const Repeats& repeats) {
    const auto read = readings(part);
    if (!read) return;
    const AxisReadings& r = *read;
    const VectorXd d = map(r.d);
    position_ = part.kind == Part::Kind::axis ? VectorXd(map(r.p) / std::max(r.length / 2.0, 1e-12))
                                              : from_the_middle(part);
    add({"direction", d, false});
    if (part.kind == Part::Kind::axis)
      add_axis(part.axes.front(), r, d);
    else
      add_lines(part, d);
    if (repeats.passes <= repeats.sides) return;  // nothing is repeated
    add_repeated(part.table, r, d, repeats);
  }

  const std::vector<Factor>& all() const { return all_; }
  /// A pair with its first factor; of direction and position, the cells, all of both.
  MatrixXd whole(const Factor& f) const {
    if (!is_pair(f)) return f.columns;
    const std::size_t x = f.name.find(" x ");
    // In space places belong to lines: there is no factor of all positions.
    MatrixXd main = f.name.starts_with("direction") ? column("direction") : position_;
    if (!f.repeated) {
      const MatrixXd& second = column(f.name.substr(x + 3), f.line);
      main.conservativeResize(Eigen::NoChange, main.cols() + second.cols());
      main.rightCols(second.cols()) = second;
    }
    MatrixXd out(f.columns.rows(), f.columns.cols() + main.cols());
    out << main, f.columns;
    return out;
  }
  const MatrixXd& column(const std::string& name, const std::string& line = {}) const {
    return std::find_if(all_.begin(), all_.end(),
                        [&](const Factor& f) { return f.name == name && f.line == line; })
        ->columns;
  }
  static bool is_pair(const Factor& f) { return f.name.find(" x ") != std::string::npos; }

 private:
  static Expected<AxisReadings> readings(const Part& part) {
    if (part.axes.empty()) return fail("");
    if (part.kind == Part::Kind::axis) return readings_of(part.table, part.axes.front());
    const std::size_t n = part.table.size();
    AxisReadings r;
    r.moved.assign(n, 1);
    for (auto* values : {&r.p, &r.theta, &r.t, &r.K}) values->assign(n, 0.0);
    r.d.assign(part.way.begin(), part.way.end());
    detail::fill_times(part.table, r);
    detail::fill_temperatures(part.table, r);
    return r;
  }

  /// Of each line, from -1 to 1.
  static VectorXd from_the_middle(const Part& part) {
    const std::size_t lines = lines_of(part.table);
    std::vector<double> low(lines, INFINITY), high(lines, -INFINITY);
    for (std::size_t i = 0; i < part.along.size(); ++i) {
      double &l = low[line_of(part.table, i)], &h = high[line_of(part.table, i)];
      l = std::min(l, part.along[i]), h = std::max(h, part.along[i]);
    }
    VectorXd out(static_cast<Index>(part.along.size()));
    for (std::size_t i = 0; i < part.along.size(); ++i) {
      const double l = low[line_of(part.table, i)], h = high[line_of(part.table, i)];
      out(static_cast<Index>(i)) = h > l ? (2.0 * part.along[i] - l - h) / (h - l) : 0.0;
    }
    return out;
  }

  void add_axis(const Axis& axis, const AxisReadings& r, const VectorXd& d) {
    add(binned("position", r.theta, position_of(axis.rotary)));
    if (axis.screw_pitch)
      add({"screw-phase", waves(map(r.theta) * (2.0 * std::numbers::pi / *axis.screw_pitch), 2)});
    if (axis.rotary) add({"angle", waves(map(r.theta), 3)});
    pair("direction", "position", times(column("position"), d), false);
    if (axis.screw_pitch) pair("direction", "screw-phase", times(column("screw-phase"), d), false);
    if (axis.rotary) pair("direction", "angle", times(column("angle"), d), false);
  }

  /// Each line's own places: what sits at one place of one diagonal sits elsewhere on the other.
  void add_lines(const Part& part, const VectorXd& d) {
    const Quantity quantity = position_of(part.kind == Part::Kind::balls);
    for (std::uint32_t line = 0; line < lines_of(part.table); ++line) {
      VectorXd here = VectorXd::Zero(d.size());
      for (std::size_t i = 0; i < part.table.size(); ++i)
        if (line_of(part.table, i) == line) here(static_cast<Index>(i)) = 1.0;
      Factor f = binned_where(part.along, here, quantity);
      f.line = part.table.lines[line].name;
      const MatrixXd reversal = times(f.columns, d);
      all_.push_back(f);
      if ((d.array() * here.array()).maxCoeff() > 0.0 &&
          (d.array() * here.array()).minCoeff() < 0.0)
        all_.push_back({"direction x position", reversal, false, {}, Quantity::number, f.line});
    }
  }

  static Factor binned_where(const std::vector<double>& value, const VectorXd& here,
                             Quantity quantity) {
    std::vector<double> some;
    for (std::size_t i = 0; i < value.size(); ++i)
      if (here(static_cast<Index>(i)) > 0.0) some.push_back(value[i]);
    Factor f = binned("position", some, quantity);
    MatrixXd wide = MatrixXd::Zero(here.size(), f.columns.cols());
    Index row = 0;
    for (Index i = 0; i < here.size(); ++i)
      if (here(i) > 0.0) wide.row(i) = f.columns.row(row++);
    f.columns = std::move(wide);
    return f;
  }

  void add_repeated(const Observations& o, const AxisReadings& r, const VectorXd& d,
                    const Repeats& repeats) {
    const VectorXd& p = position_;
    std::vector<double> run(o.run.begin(), o.run.end());
    Factor runs = binned("run", run, Quantity::count);
    runs.repeated = true;
    add(std::move(runs));
    const auto orders = static_cast<int>(std::min<std::size_t>(2 * repeats.passes, 16));
    MatrixXd slow(d.size(), orders);
    const VectorXd phase = map(r.t) * (std::numbers::pi / std::max(r.duration, 1e-12));
    for (int k = 0; k < orders; ++k) slow.col(k) = (phase * (k + 1)).array().cos();
    add({"time", slow, true});
    const MatrixXd slowest = slow.leftCols(std::min(orders, 4));
    pair("direction", "time", times(slowest, d), true);
    pair("position", "time", times(slowest, p), true);
    pair("direction", "run", times(column("run"), d), true);
    pair("position", "run", times(column("run"), p), true);
    if (!r.temperature) return;
    const VectorXd K = map(r.K);
    MatrixXd warmth(d.size(), 2);
    warmth.col(0) = K;
    warmth.col(1) = K.cwiseAbs2();
    add({"temperature", warmth, true});
    pair("position", "temperature", times(K, p), true);
    pair("direction", "temperature", times(K, d), true);
  }

  void add(Factor f) { all_.push_back(std::move(f)); }
  void pair(const std::string& a, const std::string& b, MatrixXd columns, bool repeated) {
    all_.push_back({a + " x " + b, std::move(columns), repeated});
  }
  std::vector<Factor> all_;
  MatrixXd position_;  // from -1 to 1
};

namespace {

/// Mean of each cell taken out of each column (rows times root weights).
void take_out_cells(const Repeats& r, const VectorXd& root, MatrixXd& columns) {
  MatrixXd sum = MatrixXd::Zero(static_cast<Index>(r.cells), columns.cols());
  VectorXd weight = VectorXd::Zero(static_cast<Index>(r.cells));
  for (Index i = 0; i < columns.rows(); ++i) {
    const auto c = static_cast<Index>(r.cell[static_cast<std::size_t>(i)]);
    sum.row(c) += root(i) * columns.row(i);
    weight(c) += root(i) * root(i);
  }
  for (Index c = 0; c < sum.rows(); ++c)
    if (weight(c) > 0.0) sum.row(c) /= weight(c);
  for (Index i = 0; i < columns.rows(); ++i)
    columns.row(i) -= root(i) * sum.row(static_cast<Index>(r.cell[static_cast<std::size_t>(i)]));
}

MatrixXd orthonormal(MatrixXd columns) {
  const VectorXd norm = columns.colwise().norm().transpose();
  if (columns.cols() == 0 || !(norm.maxCoeff() > 0.0)) return MatrixXd(columns.rows(), 0);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(columns / norm.maxCoeff());
  qr.setThreshold(1e-4);
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
}

/// Whether what a factor says differs between repeats of a cell: what comes back in every run sits
/// in the cells, even where a wave of time describes it with fewer columns.
bool tells_repeats_apart(const Repeats& r, const VectorXd& root, const MatrixXd& basis,
                         const VectorXd& residual) {
  constexpr double least = 0.1;  // of its squares; of a line in time over two runs, a fifth
  MatrixXd said = basis * (basis.transpose() * residual);
  const double all = said.squaredNorm();
  take_out_cells(r, root, said);
  return said.squaredNorm() > least * all;
}

/// Orthonormal columns of every factor: without zeros of lines, without what the model can say,
/// pairs without their factors.
std::vector<MatrixXd> bases_of(const Factors& factors, const Part& part, const Repeats& repeats,
                               const VectorXd& root, const MatrixXd& model) {
  std::vector<MatrixXd> out;
  std::map<std::string, MatrixXd> single;
  for (const Factor& f : factors.all()) {
    MatrixXd columns = root.asDiagonal() * f.columns;
    take_out_zeros(part.table, root, columns);
    if (f.repeated) take_out_cells(repeats, root, columns);
    const VectorXd before = columns.colwise().norm().transpose();
    if (model.cols() > 0) columns -= model * (model.transpose() * columns);
    if (Factors::is_pair(f))
      for (const std::string& name :
           {f.name.substr(0, f.name.find(" x ")),
            f.name.substr(f.name.find(" x ") + 3) + (f.line.empty() ? "" : ":" + f.line)})
        if (single[name].cols() > 0) columns -= single[name] * (single[name].transpose() * columns);
    // A column that the model says already leaves rounding, not a direction.
    for (Index k = 0; k < columns.cols(); ++k)
      if (!(columns.col(k).norm() > 1e-3 * before(k))) columns.col(k).setZero();
    MatrixXd basis = orthonormal(std::move(columns));
    if (!Factors::is_pair(f)) single[f.name + (f.line.empty() ? "" : ":" + f.line)] = basis;
    out.push_back(std::move(basis));
  }
  return out;
}

/// The level of a factor of dummies that holds most of its sum of squares, if one does; `s2` known
/// from `dof`.
void find_level(const Factor& f, const VectorXd& root, const VectorXd& residual, double s2,
                double dof, Place& place) {
  if (f.levels.size() < 3) return;
  double most = 0.0, total = 0.0, t_most = 0.0;
  for (Index k = 0; k < f.columns.cols(); ++k) {
    double norm2 = 0.0, sum = 0.0;
    for (Index i = 0; i < root.size(); ++i) {
      const double x = root(i) * f.columns(i, k);
      norm2 += x * x;
      sum += x * residual(i);
    }
    if (!(norm2 > 0.0)) continue;
    total += sum * sum / norm2;
    if (sum * sum / norm2 <= most) continue;
    most = sum * sum / norm2;
    place.at = f.levels[static_cast<std::size_t>(k)];
    t_most = math::test_ratio(sum, std::sqrt(norm2 * s2));
  }
  place.at_quantity = f.quantity;
  if (most < 0.5 * total) place.at.reset();
  const double p = math::t_two_sided(t_most, dof) * static_cast<double>(f.levels.size());
  place.p = std::min(place.p, 2.0 * p);
}

}  // namespace

struct PlaceTests::Tests {
  Factors factors;
  std::vector<MatrixXd> bases;
  VectorXd root;
  double dof;
};

PlaceTests::PlaceTests(const Part& part, const Repeats& repeats, const VectorXd& root_weight,
                       const MatrixXd& basis, double dof) {
  Factors factors(part, repeats);
  auto bases = bases_of(factors, part, repeats, root_weight, basis);
  tests_ =
      std::make_shared<const Tests>(Tests{std::move(factors), std::move(bases), root_weight, dof});
}

std::vector<Place> PlaceTests::operator()(const VectorXd& residual,
                                          const std::optional<NoiseFloor>& floor,
                                          double least) const {
  const double squares = residual.squaredNorm();
  const bool known = floor && floor->dof >= 8.0;
  std::vector<Place> places;
  double tested = 0.0;
  for (std::size_t f = 0; f < tests_->bases.size(); ++f) {
    const auto k = static_cast<double>(tests_->bases[f].cols());
    if (k == 0.0) continue;
    const double here = (tests_->bases[f].transpose() * residual).squaredNorm();
    const double dof = known ? floor->dof : tests_->dof - k;
    if (!(dof >= 3.0)) continue;
    ++tested;
    const double s2 = known ? floor->s * floor->s : (squares - here) / dof;
    const double excess = std::max(here - k * s2, 0.0);
    Place place;
    place.rms = std::sqrt(excess / static_cast<double>(residual.size()));
    if (!(place.rms > least)) continue;
    place.where = tests_->factors.all()[f].name;
    place.line = tests_->factors.all()[f].line;
    place.p = math::f_upper(math::test_ratio(here / k, s2), k, dof);
    place.share = squares > 0.0 ? excess / squares : 0.0;
    find_level(tests_->factors.all()[f], tests_->root, residual, s2,
               floor ? floor->dof : tests_->dof, place);
    places.push_back(std::move(place));
  }
  for (Place& place : places) place.p = std::min(1.0, place.p * tested);
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.share > b.share; });
  return places;
}

std::vector<Place> seats_of(const Residuals& left) {
  const Factors factors(left.part, left.repeats);
  const double n = static_cast<double>(left.residual.size());
  const double squares = left.residual.squaredNorm();
  std::vector<MatrixXd> bases;
  for (const Factor& f : factors.all()) {
    MatrixXd columns = left.root_weight.asDiagonal() * factors.whole(f);
    take_out_zeros(left.part.table, left.root_weight, columns);
    if (left.basis.cols() > 0) columns -= left.basis * (left.basis.transpose() * columns);
    bases.push_back(orthonormal(std::move(columns)));
  }
  VectorXd rest = left.residual;
  std::vector<Place> seats;
  while (seats.size() < 3) {
    std::size_t best = bases.size();
    double gain = 0.0, fall = 0.0;
    for (std::size_t f = 0; f < bases.size(); ++f) {
      const auto k = static_cast<double>(bases[f].cols());
      if (k == 0.0 || k >= left.dof / 2.0) continue;
      const double here = (bases[f].transpose() * rest).squaredNorm();
      const double value = -n * std::log1p(-std::min(here / rest.squaredNorm(), 1.0 - 1e-12)) -
                           k * std::log(n) - 10.0;  // 10: one place in a hundred by chance
      if (value > gain && (!factors.all()[f].repeated ||
                           tells_repeats_apart(left.repeats, left.root_weight, bases[f], rest)))
        best = f, gain = value, fall = here;
    }
    if (best == bases.size()) break;
    Place seat;
    seat.where = factors.all()[best].name;
    seat.line = factors.all()[best].line;
    seat.share = fall / squares;
    seat.rms = std::sqrt(fall / n);
    const auto k = static_cast<double>(bases[best].cols());
    const double dof = left.dof - k;
    seat.p = math::f_upper(math::test_ratio(fall / k, (rest.squaredNorm() - fall) / dof), k, dof) *
             static_cast<double>(bases.size());
    find_level(factors.all()[best], left.root_weight, rest, (rest.squaredNorm() - fall) / dof,
               left.floor ? left.floor->dof : left.dof, seat);
    seats.push_back(std::move(seat));
    const MatrixXd chosen = bases[best];
    rest -= chosen * (chosen.transpose() * rest);
    for (MatrixXd& basis : bases) {
      if (basis.cols() == 0) continue;
      basis -= chosen * (chosen.transpose() * basis);
      basis = orthonormal(std::move(basis));
    }
  }
  return seats;
}

std::vector<std::string> factors_of(const Part& part, const Repeats& repeats,
                                    const VectorXd& root_weight, const VectorXd& signal) {
  const Factors factors(part, repeats);
  const auto bases = bases_of(factors, part, repeats, root_weight, MatrixXd(signal.size(), 0));
  std::vector<std::string> out;
  for (std::size_t f = 0; f < bases.size(); ++f)
    if ((bases[f].transpose() * signal).squaredNorm() > 0.05 * signal.squaredNorm())
      out.push_back(factors.all()[f].name);
  return out;
}

}  // namespace nonio::model
