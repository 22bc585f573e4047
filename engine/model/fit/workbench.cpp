// SPDX-License-Identifier: Apache-2.0
#include "workbench.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/weights.h"

namespace nonio::model {

namespace {
// Least squared length of a column of unit length that remains after projection on the others.
constexpr double independent = 1e-7;
// In space, columns are nearly parallel (a step diagonal's mirror and its three axes). For curves,
// this value would admit rounding noise.
constexpr double independent_in_space = 1e-11;
// A weaker combination of a curve in space would imply an impossibly large guideway error.
constexpr double shown_of_curve = weakest_of_curve * weakest_of_curve;
// Usual size, m or rad, of each component of a curve in space: docs/dev/constants.md, M43.
constexpr double usual_curve = 30e-6;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
bool varies_with_target_only(const MatrixXd& columns, const std::vector<std::uint32_t>& target) {
  if (target.empty()) return false;
  std::vector<Index> first(target.size(), -1);
  for (Index i = 0; i < columns.rows(); ++i) {
    Index& row = first[target[static_cast<std::size_t>(i)]];
    if (row < 0)
      row = i;
    else if (columns.row(i) != columns.row(row))
      return false;
  }
  return true;
}

}  // namespace

void Workbench::count_shapes(Instance& instance) const {
  const auto& shapes = instance.term.effect->shapes;
  instance.tried.assign(std::size_t{1} << shapes.size(), 0);
  instance.free.assign(shapes.size(), 0);
  for (const std::size_t b : instance.blocks) {
    const auto& shape = blocks_[b].shape;
    for (std::size_t k = 0; k < shapes.size(); ++k)
      if (shape[k] != blocks_[instance.blocks.front()].shape[k]) instance.free[k] = 1;
    const std::size_t usual = usual_ones(instance.term, shape);
    for (std::size_t of = 0; of < instance.tried.size(); ++of)
      instance.tried[of] += (usual & of) == of;
  }
}

/// Bit k is set if shape k has its usual value.
std::size_t Workbench::usual_ones(const Term& term, const std::vector<double>& shape) {
  std::size_t out = 0;
  for (std::size_t k = 0; k < shape.size(); ++k)
    out |= static_cast<std::size_t>(is_usual(term, shape, k)) << k;
  return out;
}

/// Usual values were chosen only among blocks with these values; others need more evidence.
void Workbench::fill_search(Block& block) const {
  const Instance& instance = instances_[block.effect];
  const auto tried = static_cast<double>(instance.tried[usual_ones(instance.term, block.shape)]);
  block.searched = 0, block.cost_of_shape = 0.0;
  if (!(tried > 1.0)) return;
  // Adjacent grid values are correlated: about a third of the values are independent.
  const bool curve = instance.term.effect->curve;
  block.cost_of_shape = 2.0 * std::log(std::max(curve ? tried : tried / 3.0, 2.0));
  for (std::size_t k = 0; k < instance.free.size() && !curve; ++k)
    block.searched += instance.free[k] != 0 && !is_usual(instance.term, block.shape, k);
}

/// Whether a set with this block would have nearly one free value per target, or the block is a
/// curve outside of the model with about half as many columns as targets. `of_position`: number of
/// other unknowns of position in the set.
bool Workbench::follows_targets(const Block& block, Index of_position) const {
  if (!block.of_position) return false;
  const bool stated = block.effect < stated_;
  if (instances_[block.effect].term.effect->curve && !stated && block.count > most_of_curve_)
    return true;
  return of_position + unknowns_of(block) > (stated ? most_stated_ : most_of_position_);
}

Workbench::Workbench(const Observations& o, const std::vector<Term>& terms,
                     const std::vector<double>& weight, const std::vector<std::uint32_t>& target,
                     std::size_t stated, Made* made, const Noise& noise, double scatter)
    : white_(o, weight, noise),
      noise_(scatter),
      target_(target),
      stated_(stated),
      several_axes_(o.axes.size() > 1) {
  most_of_position_ = most_stated_ = most_of_curve_ = std::numeric_limits<Index>::max();
  if (!target_.empty()) {
    const std::uint32_t targets = *std::max_element(target_.begin(), target_.end()) + 1;
    most_of_position_ = static_cast<Index>(std::ceil(0.6 * (targets - 1.0)));
    most_stated_ = static_cast<Index>(std::ceil(0.8 * (targets - 1.0)));
    most_of_curve_ = static_cast<Index>(targets) / 2 - 1;
    few_ = o.size() <= 40 && static_cast<double>(o.size()) < 2.5 * static_cast<double>(targets);
  }
  used_ = static_cast<double>((root_weight().array() > 0.0).count());
  zeros_ = static_cast<Index>(lines_of(o));
  MatrixXd y = white_(Eigen::Map<const VectorXd>(o.deviation.data(), static_cast<Index>(o.size())));
  white_.take_out_zeros(y);
  y_ = y.col(0);
  Made own;
  std::vector<MatrixXd> parts;
  for (const Term& term : terms) {
    instances_.push_back({term, {}, {}, may_lose(o, term)});
    reducible_ = reducible_ || instances_.back().reducible;
    add(o, instances_.size() - 1, parts, made != nullptr ? *made : own);
  }
  Index columns = 0;
  for (const MatrixXd& part : parts) columns += part.cols();
  x_.resize(y_.size(), columns);
  columns = 0;
  for (const MatrixXd& part : parts) {
    x_.middleCols(columns, part.cols()) = part;
    columns += part.cols();
  }
  products_.resize(blocks_.size());
  xy_ = math::transposed_times(x_, y_);
  yy_ = y_.squaredNorm();
}

MatrixXd Workbench::columns_for(const Observations& o, Instance& instance,
                                const std::vector<double>& shape, bool& of_position,
                                VectorXd& prior, Made& made) const {
  const auto effect = static_cast<std::size_t>(&instance - instances_.data());
  auto at = made.find({effect, shape});
  if (at == made.end())
    at = made.emplace(std::pair{effect, shape}, columns_of(o, instance.term, shape)).first;
  const Expected<MatrixXd>& columns = at->second;
  if (!columns) {
    instance.error = columns.error().message;
    return {};
  }
  MatrixXd part = white_(*columns);
  const VectorXd before = part.colwise().norm().transpose();
  white_.take_out_zeros(part);
  const VectorXd after = part.colwise().norm().transpose();
  if (part.cols() == 0 || !(after.array() > 1e-9 * before.array()).all()) return {};
  of_position = varies_with_target_only(*columns, target_);
  if (several_axes_ && instance.reducible && !instance.term.effect->description)
    prior = (after * usual_curve).cwiseInverse().cwiseAbs2();
  return part * after.cwiseInverse().asDiagonal();
}

void Workbench::add_shape(const Observations& o, std::size_t effect,
                          const std::vector<double>& shape) {
  Block block{effect, shape, x_.cols(), 0, false};
  Made made;
  const MatrixXd part =
      columns_for(o, instances_[effect], shape, block.of_position, block.prior, made);
  if (part.cols() == 0) return;
  const Index columns = x_.cols() + part.cols();
  x_.conservativeResize(Eigen::NoChange, columns);
  x_.rightCols(part.cols()) = part;
  xy_.conservativeResize(columns);
  for (Index k = 0; k < part.cols(); ++k) xy_(columns - part.cols() + k) = part.col(k).dot(y_);
  fill_search(block);
  push(std::move(block), part);
  products_.assign(blocks_.size(), {});
}

void Workbench::push(Block block, const MatrixXd& columns) {
  block.count = columns.cols();
  block.own = math::transposed_product(columns, columns);
  if (block.prior.size() > 0) block.own.diagonal() += noise_ * noise_ * block.prior;
  instances_[block.effect].blocks.push_back(blocks_.size());
  blocks_.push_back(std::move(block));
}

void Workbench::add(const Observations& o, std::size_t effect, std::vector<MatrixXd>& parts,
                    Made& made) {
  Instance& instance = instances_[effect];
  const auto shapes = shapes_of(o, instance.term);
  Index at = parts.empty() ? 0 : blocks_.back().first + blocks_.back().count;
  for (const std::vector<double>& shape : shapes) {
    Block block{effect, shape, at, 0, false};
    MatrixXd part = columns_for(o, instance, shape, block.of_position, block.prior, made);
    if (part.cols() == 0) continue;
    push(std::move(block), part);
    at += part.cols();
    parts.push_back(std::move(part));
  }
  count_shapes(instance);
  for (const std::size_t b : instance.blocks) fill_search(blocks_[b]);
}

double Workbench::price(const Block& block, Index columns) const {
  return static_cast<double>(columns + block.searched) * std::log(used_) + block.cost_of_shape +
         instances_[block.effect].term.price -
         model::evidence_of_weight(instances_[block.effect].term.weight) +
         2.0 * std::log(static_cast<double>(std::max<std::size_t>(instances_.size(), 2)));
}

double Workbench::evidence_of_weight(const State& state, std::size_t effect) const {
  return model::evidence_of_weight(instances_[effect].term.weight) * of_few(state.parameters);
}

double Workbench::of_few(Index parameters) const {
  // With few readings, chance fits a large share of them (Hurvich and Tsai 1989; they use two
  // readings less, but then effects of 5 times the noise are lost in ten readings, as measured).
  const double free = used_ - static_cast<double>(zeros_ + parameters);
  return few_ ? used_ / std::max(free, 0.5) : 1.0;
}

double Workbench::criterion(double squares, double price, Index parameters) const {
  return used_ * std::log(std::max(squares, 1e-300) / used_) + price * of_few(parameters);
}

std::vector<Index> Workbench::columns_of_state(const State& state) const {
  std::vector<Index> columns;
  for (const std::size_t b : state.blocks)
    for (Index k = 0; k < blocks_[b].count; ++k) columns.push_back(blocks_[b].first + k);
  return columns;
}

Workbench::State Workbench::state(std::vector<std::size_t> blocks) const {
  State out;
  out.blocks = std::move(blocks);
  const std::vector<Index> columns = columns_of_state(out);
  for (const std::size_t b : out.blocks) {
    out.price += price(blocks_[b]);
    out.parameters += unknowns_of(blocks_[b]);
  }
  out.squares = yy_;
  if (!columns.empty()) {
    const MatrixXd own = gram(out.blocks);
    const Eigen::LLT<MatrixXd> llt(own);
    if (llt.info() == Eigen::Success &&
        llt.matrixLLT().diagonal().minCoeff() > wholly_independent()) {
      const VectorXd z = math::whitened(llt, VectorXd(xy_(columns)));
      out.squares = z.allFinite() ? std::max(yy_ - z.squaredNorm(), 0.0) : nan;
    } else {
      const Directions d = directions(out.blocks, own);
      const VectorXd z = math::transposed_times(d.of_columns, xy_(columns));
      out.squares = d.sound && z.allFinite() ? std::max(yy_ - z.squaredNorm(), 0.0) : nan;
      out.price = 0.0, out.parameters = 0;
      for (std::size_t i = 0; i < out.blocks.size(); ++i) {
        const Block& block = blocks_[out.blocks[i]];
        out.price += price(block, d.rank[i]);
        out.parameters += unknowns_of(block) - block.count + d.rank[i];
      }
    }
  }
  out.criterion = std::isnan(out.squares) ? std::numeric_limits<double>::infinity()
                                          : criterion(out.squares, out.price, out.parameters);
  return out;
}

namespace {

/// t^T s^-1 t: decrease of the residual sum of squares by one more block. `s`: scalar products of
/// its columns, `t`: their products with the deviations, both without the part that the state
/// explains. NaN if `s` is not safely positive definite.
double fall_of(const MatrixXd& s, const VectorXd& t, double least) {
  const Eigen::LLT<MatrixXd> llt(s);
  if (llt.info() != Eigen::Success || !(llt.matrixLLT().diagonal().minCoeff() > std::sqrt(least)))
    return nan;
  return math::whitened(llt, t).squaredNorm();
}

/// t^T s^-1 t over the independent directions only; `rank`: their number. NaN without any.
double fall_of_some(const MatrixXd& s, const VectorXd& t, double least, Index& rank) {
  const auto [values, vectors] = math::spectrum(s);
  const VectorXd along = math::transposed_times(vectors, t);
  double fall = 0.0;
  rank = 0;
  for (Index k = 0; k < along.size(); ++k) {
    if (!(values(k) > least)) continue;
    fall += along(k) * along(k) / values(k);
    ++rank;
  }
  return rank > 0 ? fall : nan;
}

double fall_of_two(double aa, double ab, double bb, double ta, double tb, double least) {
  if (!(aa > least)) return nan;
  const double l = ab / aa, rest = bb - l * ab;
  if (!(rest > least)) return nan;
  const double second = tb - l * ta;
  return ta * ta / aa + second * second / rest;
}

}  // namespace

const MatrixXd& Workbench::products_of(std::size_t block) const {
  MatrixXd& products = products_[block];
  if (products.size() == 0)
    products.noalias() = x_.transpose() * x_.middleCols(blocks_[block].first, blocks_[block].count);
  return products;
}

Index Workbench::count_of(const std::vector<std::size_t>& blocks) const {
  Index columns = 0;
  for (const std::size_t b : blocks) columns += blocks_[b].count;
  return columns;
}

MatrixXd Workbench::products(const std::vector<std::size_t>& blocks) const {
  MatrixXd out(x_.cols(), count_of(blocks));
  Index columns = 0;
  for (const std::size_t b : blocks) {
    out.middleCols(columns, blocks_[b].count) = products_of(b);
    columns += blocks_[b].count;
  }
  return out;
}

const MatrixXd& Workbench::product_of_pair(std::size_t a, std::size_t b) const {
  MatrixXd& product = pairs_[{a, b}];
  if (product.size() == 0)
    product.noalias() = x_.middleCols(blocks_[a].first, blocks_[a].count).transpose() *
                        x_.middleCols(blocks_[b].first, blocks_[b].count);
  return product;
}

MatrixXd Workbench::gram(const std::vector<std::size_t>& blocks) const {
  return products(blocks, blocks);
}

MatrixXd Workbench::products(const std::vector<std::size_t>& of,
                             const std::vector<std::size_t>& with) const {
  MatrixXd out(count_of(of), count_of(with));
  Index column = 0;
  for (const std::size_t b : with) {
    Index row = 0;
    for (const std::size_t a : of) {
      auto to = out.block(row, column, blocks_[a].count, blocks_[b].count);
      if (a == b) {
        to = blocks_[a].own;
        row += blocks_[a].count;
        continue;
      }
      if (products_[b].size() > 0)
        to = products_[b].middleRows(blocks_[a].first, blocks_[a].count);
      else if (products_[a].size() > 0)
        to = products_[a].middleRows(blocks_[b].first, blocks_[b].count).transpose();
      else
        to = product_of_pair(a, b);
      row += blocks_[a].count;
    }
    column += blocks_[b].count;
  }
  return out;
}

Workbench::Projection Workbench::projection(const State& state, MatrixXd products) const {
  Projection out{std::move(products), {}};
  if (state.blocks.empty()) return out;
  const MatrixXd own = gram(state.blocks);
  const Eigen::LLT<MatrixXd> llt(own);
  if (!reducible_ || (llt.info() == Eigen::Success &&
                      llt.matrixLLT().diagonal().minCoeff() > wholly_independent())) {
    out.z = math::whitened(llt, VectorXd(xy_(columns_of_state(state))));
    llt.matrixU().solveInPlace<Eigen::OnTheRight>(out.products);
    return out;
  }
  const Directions d = directions(state.blocks, own);
  out.z = math::transposed_times(d.of_columns, xy_(columns_of_state(state)));
  out.products = math::product(out.products, d.of_columns);
  return out;
}

double Workbench::least_of(const Block& block) const {
  if (!several_axes_) return independent;
  if (!reducible(block)) return independent_in_space;
  return instances_[block.effect].term.effect->description ? independent : shown_of_curve;
}

/// Least diagonal element of the Cholesky factor for fully independent columns.
double Workbench::wholly_independent() const {
  return several_axes_ && reducible_ ? 3.0 * weakest_of_curve : std::sqrt(independent);
}

bool Workbench::reducible(const Block& block) const { return instances_[block.effect].reducible; }

/// Orthonormalizes the columns block by block, using scalar products only.
Workbench::Directions Workbench::directions(const std::vector<std::size_t>& blocks,
                                            const MatrixXd& gram) const {
  Directions out{MatrixXd(gram.rows(), 0), {}, true};
  Index first = 0;
  for (const std::size_t b : blocks) {
    const Block& block = blocks_[b];
    const Index k = block.count, had = out.of_columns.cols();
    const MatrixXd inside = math::transposed_product(out.of_columns, gram.middleCols(first, k));
    const math::Spectrum own = math::spectrum(block.own - math::transposed_product(inside, inside));
    const Index rank = (own.values.array() > least_of(block)).count();
    out.sound = out.sound && rank > 0 && (rank == k || reducible(block));
    MatrixXd fresh = -out.of_columns * inside;
    fresh.middleRows(first, k) += MatrixXd::Identity(k, k);
    out.of_columns.conservativeResize(Eigen::NoChange, had + rank);
    out.of_columns.rightCols(rank) =
        math::scaled_columns(math::product(fresh, own.vectors.rightCols(rank)),
                             own.values.tail(rank).cwiseSqrt().cwiseInverse());
    out.rank.push_back(rank);
    first += k;
  }
  return out;
}

/// Decrease of the residual sum of squares; NaN if the columns are dependent and not reducible.
/// From `row`, `p.products` are the scalar products of the columns with orthonormal directions of
/// the state. `rank`: number of independent columns that are added.
double Workbench::fall_of_block(const Projection& p, Index row, const Block& block,
                                Index& rank) const {
  rank = block.count;
  const auto w = p.products.middleRows(row, block.count);
  VectorXd left = xy_.segment(block.first, block.count);
  if (p.z.size() > 0) left.noalias() -= w * p.z;
  if (block.count == 1) {
    const double s = 1.0 - w.squaredNorm();
    return s > least_of(block) ? left(0) * left(0) / s : nan;
  }
  if (block.count == 2 && !reducible(block))
    return fall_of_two(1.0 - w.row(0).squaredNorm(), block.own(0, 1) - w.row(0).dot(w.row(1)),
                       1.0 - w.row(1).squaredNorm(), left(0), left(1), least_of(block));
  const MatrixXd s = block.own - w * w.transpose();
  const double fall = fall_of(s, left, least_of(block));
  return std::isnan(fall) && reducible(block) ? fall_of_some(s, left, least_of(block), rank) : fall;
}

void Workbench::put_gain(const Projection& p, Index row, std::size_t block, Gains& out) const {
  out.fall(static_cast<Index>(block)) = fall_of_block(p, row, blocks_[block], out.rank[block]);
}

Workbench::Gains Workbench::no_gains() const {
  return {VectorXd::Constant(static_cast<Index>(blocks_.size()), nan),
          std::vector<Index>(blocks_.size(), 0)};
}

Workbench::Gains Workbench::gains(const State& state) const {
  Gains out = no_gains();
  const Projection p = projection(state, products(state.blocks));
  for (std::size_t b = 0; b < blocks_.size(); ++b) put_gain(p, blocks_[b].first, b, out);
  return out;
}

Workbench::Gains Workbench::gains(const State& state, std::size_t effect) const {
  Gains out = no_gains();
  const std::vector<std::size_t>& own = instances_[effect].blocks;
  const Projection p = projection(state, products(own, state.blocks));
  Index row = 0;
  for (const std::size_t b : own) {
    put_gain(p, row, b, out);
    row += blocks_[b].count;
  }
  return out;
}

Workbench::State Workbench::with(const State& state, const Gains& gains, std::size_t effect) const {
  if (instances_[effect].reducible) return with_curve(state, gains, effect);
  std::size_t best = blocks_.size();
  double least = std::numeric_limits<double>::infinity();
  Index of_position = 0;
  for (const std::size_t b : state.blocks)
    if (blocks_[b].of_position) of_position += unknowns_of(blocks_[b]);
  for (const std::size_t b : instances_[effect].blocks) {
    const double fall = gains(b);
    if (std::isnan(fall)) continue;
    if (follows_targets(blocks_[b], of_position)) continue;
    const double c =
        criterion(std::max(state.squares - fall, 1e-12 * yy_), state.price + price(blocks_[b]),
                  state.parameters + unknowns_of(blocks_[b]));
    if (c < least) least = c, best = b;
  }
  if (best == blocks_.size()) return state;
  State more = state;
  more.blocks.push_back(best);
  more.squares = std::max(state.squares - gains(best), 0.0);
  more.parameters += unknowns_of(blocks_[best]);
  more.price += price(blocks_[best]);
  more.criterion = criterion(more.squares, more.price, more.parameters);
  return more;
}

/// A curve adds only as many parameters as it has directions that are independent of the state.
Workbench::State Workbench::with_curve(const State& state, const Gains& gains,
                                       std::size_t effect) const {
  State best = state;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t b : instances_[effect].blocks) {
    if (std::isnan(gains(b))) continue;
    const Block& block = blocks_[b];
    const double squares = std::max(state.squares - gains(b), 0.0);
    const double price = state.price + this->price(block, gains.rank[b]);
    const Index parameters = state.parameters + unknowns_of(block) - block.count + gains.rank[b];
    const double c = criterion(squares, price, parameters);
    if (!(c < least)) continue;
    least = c;
    best = {state.blocks, squares, parameters, price, c};
    best.blocks.push_back(b);
  }
  return best;
}

Workbench::State Workbench::joined(const State& state, const Gains& gains,
                                   std::size_t effect) const {
  State best = with(state, gains, effect);
  const auto& own = instances_[effect].blocks;
  if (several_axes_ ||
      std::none_of(own.begin(), own.end(), [&](std::size_t b) { return blocks_[b].of_position; }))
    return best;
  for (std::size_t i = 0; i < state.blocks.size(); ++i) {
    const Block& present = blocks_[state.blocks[i]];
    const Instance& curve = instances_[present.effect];
    if (!curve.term.effect->curve || present.effect == effect) continue;
    for (const std::size_t fewer : curve.blocks) {
      if (blocks_[fewer].count >= present.count) continue;
      std::vector<std::size_t> blocks = state.blocks;
      blocks[i] = fewer;
      const State base = this->state(std::move(blocks));
      State more = with(base, this->gains(base, effect), effect);
      if (more.blocks.size() == base.blocks.size()) continue;
      if (best.blocks.size() == state.blocks.size() || more.criterion < best.criterion)
        best = std::move(more);
    }
  }
  return best;
}

bool Workbench::holds(const State& state, std::size_t effect) const {
  return std::any_of(state.blocks.begin(), state.blocks.end(),
                     [&](std::size_t b) { return blocks_[b].effect == effect; });
}

Workbench::State Workbench::without(const State& state, std::size_t effect) const {
  std::vector<std::size_t> blocks;
  for (const std::size_t b : state.blocks)
    if (blocks_[b].effect != effect) blocks.push_back(b);
  return this->state(std::move(blocks));
}

Workbench::State Workbench::settled(State state) const {
  for (int round = 0; round < 4; ++round) {
    bool better = false;
    for (std::size_t i = 0; i < state.blocks.size(); ++i) {
      const std::size_t effect = blocks_[state.blocks[i]].effect;
      if (instances_[effect].blocks.size() < 2) continue;
      const State rest = without(state, effect);
      State again = with(rest, gains(rest, effect), effect);
      if (again.blocks.size() != state.blocks.size()) continue;
      std::rotate(again.blocks.begin() + static_cast<std::ptrdiff_t>(i), again.blocks.end() - 1,
                  again.blocks.end());
      if (!(again.criterion < state.criterion - 1e-9)) continue;
      state = std::move(again);
      better = true;
    }
    if (!better) break;
  }
  return state;
}

Expected<std::vector<std::vector<double>>> Workbench::best_shapes() const {
  State all;
  all.squares = yy_;
  for (std::size_t e = 0; e < instances_.size(); ++e) {
    if (instances_[e].blocks.empty())
      return fail(instances_[e].error.empty()
                      ? "the readings cannot show " + instances_[e].term.name()
                      : instances_[e].error);
    const State next = with(all, gains(all, e), e);
    if (next.blocks.size() == all.blocks.size()) {
      std::string names;
      for (const Instance& i : instances_) names += (names.empty() ? "" : ", ") + i.term.name();
      return fail("not separable with these readings: " + names);
    }
    all = next;
  }
  all = settled(std::move(all));
  std::vector<std::vector<double>> shapes(instances_.size());
  for (const std::size_t b : all.blocks) shapes[blocks_[b].effect] = blocks_[b].shape;
  return shapes;
}

MatrixXd Workbench::basis(const State& state) const {
  const std::vector<Index> columns = columns_of_state(state);
  if (columns.empty()) return MatrixXd(y_.size(), 0);
  if (!reducible_) {
    const Eigen::HouseholderQR<MatrixXd> qr(x_(Eigen::all, columns));
    return math::orthonormal(qr, static_cast<Index>(columns.size()));
  }
  const Directions d = directions(state.blocks, gram(state.blocks));
  const Eigen::HouseholderQR<MatrixXd> qr(math::product(x_(Eigen::all, columns), d.of_columns));
  return math::orthonormal(qr, d.of_columns.cols());
}

}  // namespace nonio::model
