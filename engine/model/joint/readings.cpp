// SPDX-License-Identifier: Apache-2.0
#include "joint/readings.h"

#include <algorithm>
#include <cmath>

#include "data/noise.h"
#include "data/repeats.h"
#include "data/whitening.h"
#include "fit/compare.h"
#include "fit/weights.h"
#include "joint/system.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::model {

namespace {

/// Smallest share of a column that remains without the zeros and the own model of the member.
constexpr double shown = 1e-4;

/// Appends a reading at each of these places. If they are the places of all members, the knots of a
/// curve, its missing constant and slope, and the grid of a period are the same in each member.
Observations with_places(const Observations& o, const std::vector<double>& places) {
  Observations out = o;
  for (const double place : places) {
    const std::size_t row = 0;
    const auto again = [&](auto& column) {
      if (!column.empty()) column.push_back(column[row]);
    };
    again(out.deviation), again(out.source_line), again(out.time), again(out.material);
    again(out.air), again(out.pressure), again(out.humidity), again(out.run), again(out.line);
    again(out.u);
    for (auto& axis : out.axes) again(axis.position), again(axis.approach);
    again(out.sense);
    out.axes.front().position.back() = place;
  }
  return out;
}

/// Columns at the places x, from those at evenly spaced places (cubic through the nearest four).
MatrixXd interpolated(const MatrixXd& of_places, const std::vector<double>& places,
                      const std::vector<double>& x) {
  const Index last = of_places.rows() - 1;
  const double step = (places.back() - places.front()) / static_cast<double>(last);
  MatrixXd out(static_cast<Index>(x.size()), of_places.cols());
  for (Index i = 0; i < out.rows(); ++i) {
    const double at = (x[static_cast<std::size_t>(i)] - places.front()) / step;
    const Index first = std::clamp<Index>(static_cast<Index>(at) - 1, 0, last - 3);
    out.row(i).setZero();
    for (Index k = first; k < first + 4; ++k) {
      double weight = 1.0;
      for (Index j = first; j < first + 4; ++j)
        if (j != k) weight *= (at - static_cast<double>(j)) / static_cast<double>(k - j);
      out.row(i) += weight * of_places.row(k);
    }
  }
  return out;
}

bool joins(const Term& t) {
  return !t.grouping && !t.effect->description && !t.effect->is_nuisance && !t.library;
}

/// Whether the columns are constant within each cell, so that they do not depend on time.
bool is_of_place(const MatrixXd& columns, const std::vector<std::uint32_t>& cell) {
  std::map<std::uint32_t, Index> first;
  for (Index i = 0; i < columns.rows(); ++i) {
    const auto [at, is_new] = first.emplace(cell[static_cast<std::size_t>(i)], i);
    if (!is_new && columns.row(i) != columns.row(at->second)) return false;
  }
  return true;
}

/// Whether a shape is known for this member and differs, as for a screw of another pitch.
bool is_of_another(const Observations& o, const Term& term, const std::vector<double>& shape) {
  for (std::size_t k = 0; k < shape.size(); ++k) {
    const std::vector<double> grid = term.effect->shapes[k].grid(o, term.axis);
    if (grid.size() == 1 && std::fabs(grid.front() - shape[k]) > 1e-6 * std::fabs(shape[k]))
      return true;
  }
  return false;
}

class Reader {
 public:
  explicit Reader(const std::vector<Member>& members) : members_(members) {}

  Expected<JointReadings> run() {
    list_places();
    list_blocks();
    for (const Member& member : members_) {
      auto read = of_member(member);
      if (!read) {
        if (read.error().file.empty()) read.error().file = member.campaign;
        return fail(read.error());
      }
      out_.members.push_back(std::move(*read));
    }
    out_.offsets = offsets_of_passes();
    for (std::size_t m = 0; m < members_.size(); ++m)
      if (auto put = put_columns(members_[m], out_.offsets, grounds_[m], out_.members[m]); !put)
        return fail(put.error());
    drop_rare();
    return std::move(out_);
  }

 private:
  /// Places of all members, or evenly spaced ones if these are many.
  void list_places() {
    for (const Member& m : members_) {
      const auto& own = m.part->table.axes.front().position;
      places_.insert(places_.end(), own.begin(), own.end());
      std::sort(places_.begin(), places_.end());
      places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    }
    middle_ = places_.empty() ? 0.0 : (places_.front() + places_.back()) / 2.0;
    for (std::size_t i = 0; i < most && !places_.empty(); ++i)
      even_.push_back(places_.front() + (places_.back() - places_.front()) *
                                            static_cast<double>(i) / static_cast<double>(most - 1));
    if (places_.size() > most) places_ = even_;
  }

  /// Effects that no member has in its model, with the shapes of the member with the most readings.
  void list_blocks() {
    std::map<std::string, std::pair<const Term*, const Member*>> all;
    std::vector<std::string> order;
    for (const Member& m : members_)
      for (const Term& t : m.catalogue) {
        if (!joins(t) || in_a_model(t.of_all())) continue;
        auto& known = all[t.of_all()];
        if (known.first == nullptr) order.push_back(t.of_all());
        if (known.first == nullptr || m.part->table.size() > known.second->part->table.size())
          known = {&t, &m};
      }
    std::vector<Term> terms;
    for (const std::string& name : order) terms.push_back(*all[name].first);
    set_weights(terms);
    for (const Term& one : terms) {
      const std::string name = one.of_all();
      const auto [term, member] = all[name];
      const auto shapes = shapes_of(with_places(member->part->table, places_), *term);
      const auto tried = static_cast<double>(shapes.size());
      const bool curve = term->effect->curve;
      for (const auto& shape : shapes) {
        JointBlock block{name, term->effect, term->axis, shape};
        block.cost = term->price;
        block.weight = one.weight;
        if (tried > 1.0 && !are_usual(*term, shape)) {
          block.cost += 2.0 * std::log(std::max(curve ? tried : tried / 3.0, 2.0));
          if (!curve) block.searched = static_cast<Index>(shape.size());
        }
        out_.blocks.push_back(std::move(block));
      }
    }
  }

  /// The term as this member shows it: a fixed point that is searched, or that does not matter for
  /// one campaign, is the same place of the machine in all of them.
  Term at_common_middle(Term term, const std::vector<double>& shape, const Observations& o) const {
    term.shape = shape;
    if (term.axis.rotary) return term;
    const auto read = readings_of(o, term.axis);
    const double from = read ? middle_ - read->middle : 0.0;
    for (std::size_t k = 0; k < shape.size(); ++k)
      if (term.effect->shapes[k].parameter.name == fixed_point_shape().parameter.name)
        term.shape[k] += from;
    if (!term.axis.fixed_point) term.axis.fixed_point = middle_;
    return term;
  }

  /// Columns of an effect that depends on the place only. The readings of other members decide
  /// where a curve has its knots; with many places, the curve is made once for all members, because
  /// the own places of a member would move the knots.
  Expected<MatrixXd> of_all_places(const Observations& wide, const Term& term, std::size_t b) {
    const JointBlock& block = out_.blocks[b];
    if (places_.size() < most || !block.is->curve) return columns_of(wide, term, block.shape);
    MatrixXd& known = of_places_[b];
    if (known.rows() == 0) {
      Observations even;
      even.angular = wide.angular, even.lines = {{}};
      even.axes = {
          {block.axis.name, block.axis.rotary, places_, std::vector<std::int8_t>(most, 1)}};
      even.deviation.assign(most, 0.0);
      NONIO_TRY(known, columns_of(even, Term{block.is, block.axis}, block.shape));
    }
    return interpolated(known, places_, wide.axes.front().position);
  }

  bool in_a_model(const std::string& effect) const {
    return std::any_of(members_.begin(), members_.end(), [&](const Member& m) {
      return std::any_of(m.model.begin(), m.model.end(),
                         [&](const Term& t) { return t.of_all() == effect; });
    });
  }

  struct Kept {
    GroundworkOf groundwork;
    std::vector<Term> terms;
    const Ground& ground() const { return groundwork->whole; }
  };

  Expected<MemberReadings> of_member(const Member& member) {
    const Observations& o = member.part->table;
    std::vector<Term> terms = member.model;
    terms.insert(terms.end(), member.found.begin(), member.found.end());
    NONIO_TRY(const auto compared, compare(*member.part, terms));
    grounds_.push_back({GroundworkOf(*member.part, terms, nullptr), compared.fit.terms});
    std::erase_if(grounds_.back().terms, [&](const Term& t) {
      return std::any_of(member.found.begin(), member.found.end(),
                         [&](const Term& f) { return f.name() == t.name(); });
    });
    const Ground& ground = grounds_.back().ground();
    MemberReadings out;
    out.pass = ground.repeats.pass, out.cell = ground.repeats.cell;
    out.cells = ground.repeats.cells;
    out.floor = compared.floor;
    const bool floor = compared.floor && compared.floor->dof >= least_dof;
    out.s = floor ? compared.floor->s : compared.fit.s;
    out.dof = floor ? compared.floor->dof : static_cast<double>(compared.fit.redundancy);
    if (!(out.s > 0.0) || !(out.dof >= 1.0))
      return fail("expected readings that scatter, and more of them than the model has unknowns");
    sum_offsets(ground, member.found.empty() ? o.deviation : compared.fit.residual, out.s);
    return out;
  }

  /// Sums, over successive passes of one side with at least three repeated readings each, half the
  /// squared difference of their means in units of s^2, minus the noise of single readings. The
  /// expectation of each summand is the variance of an offset. A slow drift contributes little.
  void sum_offsets(const Ground& ground, const std::vector<double>& y, double s) {
    const Repeats& r = ground.repeats;
    std::vector<double> cell(r.cells, 0.0), in_cell(r.cells, 0.0), mean(r.passes, 0.0),
        n(r.passes, 0.0);
    for (std::size_t i = 0; i < y.size(); ++i)
      if (ground.weight[i] > 0.0) cell[r.cell[i]] += y[i], in_cell[r.cell[i]] += 1.0;
    for (std::size_t i = 0; i < y.size(); ++i)
      if (ground.weight[i] > 0.0 && in_cell[r.cell[i]] > 1.0)
        mean[r.pass[i]] += y[i] - cell[r.cell[i]] / in_cell[r.cell[i]], n[r.pass[i]] += 1.0;
    std::map<std::uint32_t, std::size_t> last;
    for (std::size_t p = 0; p < r.passes; ++p) {
      if (!(n[p] >= 3.0)) continue;
      if (const auto before = last.find(r.side[p]); before != last.end()) {
        const std::size_t q = before->second;
        const double d = mean[p] / n[p] - mean[q] / n[q];
        offsets_ += 0.5 * d * d / (s * s) - 0.5 * (1.0 / n[p] + 1.0 / n[q]);
        differences_ += 1.0;
      }
      last[r.side[p]] = p;
    }
  }

  /// Relative to the variance of a reading; the same for all campaigns.
  double offsets_of_passes() const {
    return differences_ > 0.0 ? std::max(offsets_ / differences_, 0.0) : 0.0;
  }

  /// Generalized least squares with a random offset of each pass: subtracts the fraction of the
  /// mean of a pass that makes its rows independent.
  static void take_out_offsets(const MemberReadings& m, double variance, MatrixXd& columns) {
    if (!(variance > 0.0)) return;
    std::map<std::uint32_t, std::vector<Index>> passes;
    for (Index i = 0; i < columns.rows(); ++i)
      if (m.scale(i) > 0.0) passes[m.pass[static_cast<std::size_t>(i)]].push_back(i);
    for (const auto& [pass, rows] : passes) {
      const auto n = static_cast<double>(rows.size());
      const double share = 1.0 - 1.0 / std::sqrt(1.0 + n * variance);
      const Eigen::RowVectorXd mean = columns(rows, Eigen::all).colwise().sum() * (share / n);
      for (const Index i : rows) columns.row(i) -= mean;
    }
  }

  /// Returns orthonormal columns of the zeros and of the member's own model. A curve has no constant
  /// and no slope over the stretch of all members: over its own, a bow would contain the slope of a
  /// longer one.
  Expected<MatrixXd> of_model(const MemberReadings& m, const Whitening& white,
                              const Observations& o, const std::vector<Term>& terms,
                              double offsets) const {
    std::vector<MatrixXd> parts;
    MatrixXd zeros = MatrixXd::Zero(static_cast<Index>(o.size()), static_cast<Index>(lines_of(o)));
    for (std::size_t i = 0; i < o.size(); ++i)
      zeros(static_cast<Index>(i), static_cast<Index>(line_of(o, i))) = 1.0;
    parts.push_back(std::move(zeros));
    for (const Term& term : terms) {
      const bool curve = term.effect->curve && joins(term);
      NONIO_TRY(const auto columns,
                columns_of(curve ? with_places(o, even_) : o, term, term.shape));
      parts.push_back(columns.topRows(static_cast<Index>(o.size())));
    }
    MatrixXd all(static_cast<Index>(o.size()), 0);
    for (const MatrixXd& part : parts)
      for (Index k = 0; k < part.cols(); ++k) {
        MatrixXd one = white(part.col(k));
        take_out_offsets(m, offsets, one);
        const double before = one.norm();
        math::take_out(all, one), math::take_out(all, one);
        if (!(one.norm() > shown * before)) continue;
        all.conservativeResize(Eigen::NoChange, all.cols() + 1);
        all.rightCols(1) = one / one.norm();
      }
    return all;
  }

  Expected<void> put_columns(const Member& member, double offsets, const Kept& kept,
                             MemberReadings& out) {
    const Observations& o = member.part->table;
    const Ground& ground = kept.ground();
    const Whitening white(o, ground.weight, Whitening::of_repeats(ground.noise));
    out.readings = static_cast<double>((white.root().array() > 0.0).count());
    out.scale = white.root();
    for (double& w : out.scale) w = w > 0.0 ? out.s / w : 0.0;
    NONIO_TRY(const MatrixXd model, of_model(out, white, o, kept.terms, offsets));
    out.unknowns = model.cols();
    const auto whitened = [&](const MatrixXd& columns, VectorXd* before = nullptr) {
      MatrixXd part = white(columns);
      take_out_offsets(out, offsets, part);
      if (before != nullptr) *before = part.colwise().norm().transpose();
      math::take_out(model, part), math::take_out(model, part);
      return part;
    };
    out.y = whitened(Eigen::Map<const VectorXd>(o.deviation.data(), static_cast<Index>(o.size())))
                .col(0) /
            out.s;
    std::vector<MatrixXd> parts;
    Index columns = 0;
    const Observations wide = with_places(o, places_);
    out.first.assign(out_.blocks.size(), -1);
    out.own.resize(out_.blocks.size()), out.rank.resize(out_.blocks.size());
    for (std::size_t b = 0; b < out_.blocks.size(); ++b) {
      JointBlock& block = out_.blocks[b];
      const auto term =
          std::find_if(member.catalogue.begin(), member.catalogue.end(),
                       [&](const Term& t) { return joins(t) && t.of_all() == block.effect; });
      if (term == member.catalogue.end()) continue;
      const Term local = at_common_middle(*term, block.shape, o);
      if (is_of_another(o, *term, local.shape)) continue;
      auto made = columns_of(o, local, local.shape);
      if (made && is_of_place(*made, out.cell)) made = of_all_places(wide, *term, b);
      if (!made || made->cols() == 0 || (block.count > 0 && made->cols() != block.count)) continue;
      VectorXd before;
      MatrixXd part = whitened(made->topRows(static_cast<Index>(o.size())), &before);
      const VectorXd after = part.colwise().norm().transpose();
      for (Index k = 0; k < part.cols(); ++k)
        if (!(after(k) > shown * before(k))) part.col(k).setZero();
      part /= out.s;
      const MatrixXd own = math::transposed_product(part, part);
      const Index rank = ranked_inverse(own, own.diagonal()).rank;
      // Readings of a part of the travel determine some shapes of a curve only.
      if (rank == 0 || (rank < part.cols() && !block.is->curve)) continue;
      block.count = part.cols();
      out.first[b] = columns;
      columns += part.cols();
      out.own[b] = own, out.rank[b] = rank;
      parts.push_back(std::move(part));
    }
    out.x.resize(out.y.size(), columns);
    columns = 0;
    for (const MatrixXd& part : parts) {
      out.x.middleCols(columns, part.cols()) = part;
      columns += part.cols();
    }
    return {};
  }

  /// Removes blocks that fewer than two members can show, because these concern single campaigns.
  void drop_rare() {
    for (std::size_t b = 0; b < out_.blocks.size(); ++b) {
      const auto shows = std::count_if(out_.members.begin(), out_.members.end(),
                                       [&](const MemberReadings& m) { return m.first[b] >= 0; });
      if (shows >= 2) continue;
      for (MemberReadings& m : out_.members) m.first[b] = -1;
      out_.blocks[b].count = 0;
    }
  }

  // smallest degrees of freedom of a noise floor that is used
  static constexpr double least_dof = 8.0;
  static constexpr std::size_t most = 200;  // places that are used, evenly spaced ones if more
  const std::vector<Member>& members_;
  std::vector<double> places_;
  std::vector<double> even_;  // evenly spaced over the stretch of all members
  double middle_ = 0.0;       // of the places of all members, m or rad
  std::map<std::size_t, MatrixXd>
      of_places_;  // columns of curves at evenly spaced places, by block
  std::vector<Kept> grounds_;
  double offsets_ = 0.0, differences_ = 0.0;
  JointReadings out_;
};

}  // namespace

Expected<JointReadings> read_together(const std::vector<Member>& members) {
  if (members.size() < 2) return fail("expected two campaigns or more that measured the same");
  return Reader(members).run();
}

}  // namespace nonio::model
