// SPDX-License-Identifier: Apache-2.0
#include "places.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "nonio/math/distributions.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::model {

/// Columns that vary only with one factor, or with the product of two. `repeated`: determined by
/// differences between repeats of a cell (time, run, temperature), otherwise by the cells.
struct FactorColumns {
  Where of;
  MatrixXd columns;
  bool repeated = false;
  std::vector<double> levels{};  // values of indicator columns: target, run
  Quantity quantity = Quantity::number;
  std::string line{};  // line to which the positions belong, in space
};

namespace {

const char* name_of(Factor factor) {
  switch (factor) {
    case Factor::direction:
      return "direction";
    case Factor::position:
      return "position";
    case Factor::screw_phase:
      return "screw-phase";
    case Factor::angle:
      return "angle";
    case Factor::run:
      return "run";
    case Factor::time:
      return "time";
    case Factor::temperature:
      return "temperature";
    case Factor::measurement:
      return "measurement";
    case Factor::channel:
      break;
  }
  return "channel";
}

}  // namespace

std::string to_text(const Where& where) {
  return std::string(name_of(where.first)) +
         (where.second ? std::string(" x ") + name_of(*where.second) : "");
}

namespace {

// docs/dev/constants.md, M23.
constexpr Index most_bins = 40;

MatrixXd dummies(const std::vector<std::size_t>& level, std::size_t levels) {
  MatrixXd out = MatrixXd::Zero(static_cast<Index>(level.size()), static_cast<Index>(levels));
  for (std::size_t i = 0; i < level.size(); ++i)
    out(static_cast<Index>(i), static_cast<Index>(level[i])) = 1.0;
  return out;
}

/// If there are more than `most_bins` distinct values, adjacent values share a bin.
FactorColumns binned(Factor of, const std::vector<double>& value, Quantity quantity) {
  const std::set<double> distinct(value.begin(), value.end());
  const std::size_t in_bin =
      (distinct.size() + most_bins - 1) / static_cast<std::size_t>(most_bins);
  std::map<double, std::size_t> bin;
  FactorColumns f{{of}, {}, false, {}, quantity};
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

/// Factors of the axis that moves or, in space, of the position along each line; products of two.
class Factors {
 public:
  Factors(const Part& part, const Repeats& repeats) {
    const auto read = readings(part);
    if (!read) return;
    const AxisReadings& r = *read;
    const VectorXd d = map(r.d);
    position_ = part.kind == Part::Kind::axis ? VectorXd(map(r.p) / std::max(r.length / 2.0, 1e-12))
                                              : from_the_middle(part);
    both_ways_ = d.minCoeff() < 0.0 && d.maxCoeff() > 0.0;
    add({{Factor::direction}, d, false});
    if (part.kind == Part::Kind::axis) {
      add_axis(part.axes.front(), r, d);
      add_measurements(part.table, d);
    } else {
      add_lines(part, d);
    }
    if (repeats.passes <= repeats.sides) return;  // there are no repeats
    add_repeated(part.table, r, d, repeats);
  }

  const std::vector<FactorColumns>& all() const { return all_; }
  /// Adds the columns of the first factor of a pair and, unless `repeated`, of the second factor.
  MatrixXd whole(const FactorColumns& f) const {
    if (!is_pair(f)) return f.columns;
    // In space positions belong to lines, so there is no factor of all positions.
    MatrixXd main = f.of.first == Factor::direction ? column(Factor::direction) : position_;
    if (!f.repeated) {
      const MatrixXd& second = column(*f.of.second, f.line);
      main.conservativeResize(Eigen::NoChange, main.cols() + second.cols());
      main.rightCols(second.cols()) = second;
    }
    MatrixXd out(f.columns.rows(), f.columns.cols() + main.cols());
    out << main, f.columns;
    return out;
  }
  const MatrixXd& column(Factor of, const std::string& line = {}) const {
    return std::find_if(all_.begin(), all_.end(),
                        [&](const FactorColumns& f) { return f.of == Where{of} && f.line == line; })
        ->columns;
  }
  static bool is_pair(const FactorColumns& f) { return f.of.second.has_value(); }

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

  /// Returns the position along each line, scaled to -1..1.
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
    add(binned(Factor::position, r.theta, position_of(axis.rotary)));
    if (axis.screw_pitch)
      add({{Factor::screw_phase},
           waves(map(r.theta) * (2.0 * std::numbers::pi / *axis.screw_pitch), 2)});
    if (axis.rotary) add({{Factor::angle}, waves(map(r.theta), 3)});
    pair(Factor::direction, Factor::position, times(column(Factor::position), d), false);
    if (axis.screw_pitch)
      pair(Factor::direction, Factor::screw_phase, times(column(Factor::screw_phase), d), false);
    if (axis.rotary) pair(Factor::direction, Factor::angle, times(column(Factor::angle), d), false);
  }

  /// Adds the factor of differences between the lines of one axis, whose zeros are unknown.
  void add_measurements(const Observations& o, const VectorXd& d) {
    const auto lines = static_cast<Index>(lines_of(o));
    if (lines < 2 || lines > most_bins) return;
    std::vector<std::size_t> line;
    for (std::size_t i = 0; i < o.size(); ++i) line.push_back(line_of(o, i));
    FactorColumns f{{Factor::measurement}, dummies(line, lines_of(o))};
    const auto by_line = [&](const MatrixXd& columns) {
      MatrixXd out(columns.rows(), columns.cols() * lines);
      for (Index k = 0; k < lines; ++k)
        out.middleCols(k * columns.cols(), columns.cols()) = times(columns, f.columns.col(k));
      return out;
    };
    pair(Factor::direction, Factor::measurement, by_line(d), false);
    pair(Factor::position, Factor::measurement, by_line(column(Factor::position)), false);
    add(std::move(f));
  }

  /// Equal positions on two diagonals are different places in the machine.
  void add_lines(const Part& part, const VectorXd& d) {
    const Quantity quantity = position_of(part.kind == Part::Kind::balls);
    for (std::uint32_t line = 0; line < lines_of(part.table); ++line) {
      VectorXd here = VectorXd::Zero(d.size());
      for (std::size_t i = 0; i < part.table.size(); ++i)
        if (line_of(part.table, i) == line) here(static_cast<Index>(i)) = 1.0;
      FactorColumns f = binned_where(part.along, here, quantity);
      f.line = part.table.lines[line].name;
      const MatrixXd reversal = times(f.columns, d);
      all_.push_back(f);
      if ((d.array() * here.array()).maxCoeff() > 0.0 &&
          (d.array() * here.array()).minCoeff() < 0.0)
        all_.push_back(
            {{Factor::direction, Factor::position}, reversal, false, {}, Quantity::number, f.line});
    }
  }

  static FactorColumns binned_where(const std::vector<double>& value, const VectorXd& here,
                                    Quantity quantity) {
    std::vector<double> some;
    for (std::size_t i = 0; i < value.size(); ++i)
      if (here(static_cast<Index>(i)) > 0.0) some.push_back(value[i]);
    FactorColumns f = binned(Factor::position, some, quantity);
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
    FactorColumns runs = binned(Factor::run, run, Quantity::count);
    runs.repeated = true;
    add(std::move(runs));
    const auto orders = static_cast<int>(std::min<std::size_t>(2 * repeats.passes, 16));
    MatrixXd slow(d.size(), orders);
    const VectorXd phase = map(r.t) * (std::numbers::pi / std::max(r.duration, 1e-12));
    for (int k = 0; k < orders; ++k) slow.col(k) = (phase * (k + 1)).array().cos();
    add({{Factor::time}, slow, true});
    const MatrixXd slowest = slow.leftCols(std::min(orders, 4));
    pair(Factor::direction, Factor::time, times(slowest, d), true);
    pair(Factor::position, Factor::time, times(slowest, p), true);
    pair(Factor::direction, Factor::run, times(column(Factor::run), d), true);
    pair(Factor::position, Factor::run, times(column(Factor::run), p), true);
    if (!r.temperature) return;
    const VectorXd K = map(r.K);
    MatrixXd warmth(d.size(), 2);
    warmth.col(0) = K;
    warmth.col(1) = K.cwiseAbs2();
    add({{Factor::temperature}, warmth, true});
    pair(Factor::position, Factor::temperature, times(K, p), true);
    pair(Factor::direction, Factor::temperature, times(K, d), true);
  }

  void add(FactorColumns f) { all_.push_back(std::move(f)); }
  void pair(Factor a, Factor b, MatrixXd columns, bool repeated) {
    if (a == Factor::direction && !both_ways_) return;
    all_.push_back({{a, b}, std::move(columns), repeated});
  }
  std::vector<FactorColumns> all_;
  MatrixXd position_;  // position of each reading, -1 to 1
  bool both_ways_ = true;
};

namespace {

MatrixXd orthonormal(MatrixXd columns) {
  const VectorXd norm = columns.colwise().norm().transpose();
  if (columns.cols() == 0 || !(norm.maxCoeff() > 0.0)) return MatrixXd(columns.rows(), 0);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(columns / norm.maxCoeff());
  qr.setThreshold(1e-4);
  return math::orthonormal(qr, qr.rank());
}

/// Removes from whitened columns the part that is constant over all repeats of a cell.
class Cells {
 public:
  Cells(const Repeats& r, const Whitening& white) : r_(r), root_(white.root()) {
    // largest number of cells; above it, the means of the cells are used
    constexpr std::size_t most = 400;
    if (white.independent() || r.cells > most) return;
    columns_ = white(dummies({r.cell.begin(), r.cell.end()}, r.cells));
    MatrixXd products = math::transposed_product(columns_, columns_);
    for (double& x : products.diagonal())
      if (!(x > 0.0)) x = 1.0;  // all readings of this cell are suspect
    products_.compute(products);
  }
  void take_out(MatrixXd& columns) const {
    if (columns_.cols() > 0)
      columns -= math::product(
          columns_, math::solutions(products_, math::transposed_product(columns_, columns)));
    else
      take_out_means(columns);
  }

 private:
  void take_out_means(MatrixXd& columns) const {
    MatrixXd sum = MatrixXd::Zero(static_cast<Index>(r_.cells), columns.cols());
    VectorXd weight = VectorXd::Zero(static_cast<Index>(r_.cells));
    for (Index i = 0; i < columns.rows(); ++i) {
      const auto c = static_cast<Index>(r_.cell[static_cast<std::size_t>(i)]);
      sum.row(c) += root_(i) * columns.row(i);
      weight(c) += root_(i) * root_(i);
    }
    for (Index c = 0; c < sum.rows(); ++c)
      if (weight(c) > 0.0) sum.row(c) /= weight(c);
    for (Index i = 0; i < columns.rows(); ++i)
      columns.row(i) -=
          root_(i) * sum.row(static_cast<Index>(r_.cell[static_cast<std::size_t>(i)]));
  }

  const Repeats& r_;
  const VectorXd& root_;
  MatrixXd columns_{};  // columns of the cells, for correlated noise
  Eigen::LLT<MatrixXd> products_{};
};

/// A structure that recurs in every run belongs to the cells, not to a wave in time.
bool separates_repeats(const Cells& cells, const MatrixXd& basis, const VectorXd& residual) {
  // Least share; a linear trend over two runs has a fifth: docs/dev/constants.md, M19.
  constexpr double least = 0.1;
  MatrixXd said = math::times(basis, math::transposed_times(basis, residual));
  const double all = said.squaredNorm();
  cells.take_out(said);
  return said.squaredNorm() > least * all;
}

/// Orthonormal, without zeros of lines and columns of the model; pairs without single factors.
std::vector<MatrixXd> bases_of(const Factors& factors, const Repeats& repeats,
                               const Whitening& white, const MatrixXd& model) {
  const Cells cells(repeats, white);
  std::vector<MatrixXd> out;
  std::map<std::pair<Factor, std::string>, MatrixXd> single;  // keys are factor and line
  for (const FactorColumns& f : factors.all()) {
    MatrixXd columns = white(f.columns);
    white.take_out_zeros(columns);
    if (f.repeated) cells.take_out(columns);
    const VectorXd before = columns.colwise().norm().transpose();
    if (model.cols() > 0) math::take_out(model, columns);
    if (f.of.second)
      for (const auto& of : {std::pair{f.of.first, std::string()}, std::pair{*f.of.second, f.line}})
        if (const MatrixXd& one = single[of]; one.cols() > 0) math::take_out(one, columns);
    // Of a column that the model predicts, only rounding errors remain, which are no direction.
    for (Index k = 0; k < columns.cols(); ++k)
      if (!(columns.col(k).norm() > 1e-3 * before(k))) columns.col(k).setZero();
    MatrixXd basis = orthonormal(std::move(columns));
    if (!f.of.second) single[{f.of.first, f.line}] = basis;
    out.push_back(std::move(basis));
  }
  return out;
}

/// No columns for a factor with fewer than three levels.
MatrixXd levels_of(const FactorColumns& f, const Whitening& white) {
  return f.levels.size() < 3 ? MatrixXd(f.columns.rows(), 0) : white(f.columns);
}

/// A level (a target, a run) with at least half of the sum of squares becomes `place.at`; p is
/// lowered if one level is more significant than the factor. `s2`: residual variance with `dof`.
void find_level(const FactorColumns& f, const MatrixXd& columns, const VectorXd& residual,
                double s2, double dof, Place& place) {
  if (columns.cols() == 0) return;
  double most = 0.0, total = 0.0, t_most = 0.0;
  for (Index k = 0; k < columns.cols(); ++k) {
    const double norm2 = columns.col(k).squaredNorm(), sum = columns.col(k).dot(residual);
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
  std::vector<MatrixXd> levels;
  double dof;
};

PlaceTests::PlaceTests(const Part& part, const Repeats& repeats, const Whitening& white,
                       const MatrixXd& basis, double dof) {
  Factors factors(part, repeats);
  auto bases = bases_of(factors, repeats, white, basis);
  std::vector<MatrixXd> levels;
  for (const FactorColumns& f : factors.all()) levels.push_back(levels_of(f, white));
  tests_ = std::make_shared<const Tests>(
      Tests{std::move(factors), std::move(bases), std::move(levels), dof});
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
    const double here = math::transposed_times(tests_->bases[f], residual).squaredNorm();
    const double dof = known ? floor->dof : tests_->dof - k;
    if (!(dof >= 3.0)) continue;
    ++tested;
    const double s2 = known ? floor->s * floor->s : (squares - here) / dof;
    const double excess = std::max(here - k * s2, 0.0);
    Place place;
    place.rms = std::sqrt(excess / static_cast<double>(residual.size()));
    if (!(place.rms > least)) continue;
    place.where = tests_->factors.all()[f].of;
    place.line = tests_->factors.all()[f].line;
    place.p = math::f_upper(math::test_ratio(here / k, s2), k, dof);
    place.share = squares > 0.0 ? excess / squares : 0.0;
    find_level(tests_->factors.all()[f], tests_->levels[f], residual, s2,
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
  const Cells cells(left.repeats, left.white);
  const double n = static_cast<double>(left.residual.size());
  const double squares = left.residual.squaredNorm();
  std::vector<MatrixXd> bases;
  for (const FactorColumns& f : factors.all()) {
    MatrixXd columns = left.white(factors.whole(f));
    left.white.take_out_zeros(columns);
    if (left.basis.cols() > 0) math::take_out(left.basis, columns);
    bases.push_back(orthonormal(std::move(columns)));
  }
  VectorXd rest = left.residual;
  std::vector<Place> seats;
  constexpr std::size_t most = 3;
  for (;;) {
    std::size_t best = bases.size();
    double gain = 0.0, fall = 0.0;
    for (std::size_t f = 0; f < bases.size(); ++f) {
      const auto k = static_cast<double>(bases[f].cols());
      if (k == 0.0 || k >= left.dof / 2.0) continue;
      const double here = math::transposed_times(bases[f], rest).squaredNorm();
      const double value = -n * std::log1p(-std::min(here / rest.squaredNorm(), 1.0 - 1e-12)) -
                           k * std::log(n) - 10.0;  // 10: about one place in a hundred by chance
      if (value > gain && (!factors.all()[f].repeated || separates_repeats(cells, bases[f], rest)))
        best = f, gain = value, fall = here;
    }
    if (best == bases.size()) break;
    Place seat;
    seat.where = factors.all()[best].of;
    seat.line = factors.all()[best].line;
    seat.share = fall / squares;
    seat.rms = std::sqrt(fall / n);
    const auto k = static_cast<double>(bases[best].cols());
    const double dof = left.dof - k;
    seat.p = math::f_upper(math::test_ratio(fall / k, (rest.squaredNorm() - fall) / dof), k, dof) *
             static_cast<double>(bases.size());
    find_level(factors.all()[best], levels_of(factors.all()[best], left.white), rest,
               (rest.squaredNorm() - fall) / dof, left.floor ? left.floor->dof : left.dof, seat);
    seats.push_back(std::move(seat));
    if (seats.size() == most) break;
    const MatrixXd chosen = bases[best];
    math::take_out(chosen, rest);
    for (MatrixXd& basis : bases) {
      if (basis.cols() == 0) continue;
      math::take_out(chosen, basis);
      basis = orthonormal(std::move(basis));
    }
  }
  return seats;
}

FactorsOf::FactorsOf(const Part& part, const Repeats& repeats, const Whitening& white) {
  const Factors factors(part, repeats);
  bases_ = bases_of(factors, repeats, white, MatrixXd(white.root().size(), 0));
  for (const FactorColumns& f : factors.all()) of_.push_back(f.of);
}

std::vector<Where> FactorsOf::operator()(const VectorXd& signal) const {
  std::vector<Where> out;
  for (std::size_t f = 0; f < bases_.size(); ++f)
    if (math::transposed_times(bases_[f], signal).squaredNorm() > 0.05 * signal.squaredNorm())
      out.push_back(of_[f]);
  return out;
}

bool same_factor(const Where& a, const Where& b) {
  const auto kin = [](Factor f) {
    if (f == Factor::run) return Factor::time;
    return f == Factor::screw_phase || f == Factor::angle ? Factor::position : f;
  };
  const auto in_b = [&](Factor f) {
    return kin(f) == kin(b.first) || (b.second && kin(f) == kin(*b.second));
  };
  return in_b(a.first) || (a.second && in_b(*a.second));
}

}  // namespace nonio::model
