// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "data/design.h"
#include "data/whitening.h"

namespace nonio::model {

/// Effects of a search with every value of their shapes, as columns of unit length without the
/// zeros of the lines. Cached scalar products give the evidence of a set of effects without another
/// access to the readings. Not thread-safe.
class Workbench {
 public:
  /// Columns `first` to `first + count - 1`: those of an effect with one combination of its shapes.
  struct Block {
    std::size_t effect;
    std::vector<double> shape;
    Index first, count;
    bool of_position;  ///< constant over all readings of a target
    MatrixXd own{};    ///< scalar products of its columns, plus the prior of a curve
    /// For curves in space: 1/(usual size)^2 of each column, in the units of its parameter.
    VectorXd prior{};
    Index searched = 0;  ///< number of its shapes that were searched
    /// 2 ln of the number of independent values from which its shapes were chosen
    double cost_of_shape = 0.0;
  };
  struct Instance {
    Term term;
    std::vector<std::size_t> blocks;  ///< empty: the effect is not identifiable
    std::string error;
    bool reducible = false;  ///< whether combinations of its columns may be removed (`may_lose`)
    /// By bit mask of shapes: number of combinations in which these shapes have their usual values.
    std::vector<std::size_t> tried{};
    std::vector<char> free{};  ///< for each shape: whether it has more than one value
  };
  /// Blocks in the order in which they were added, and the resulting residual.
  struct State {
    std::vector<std::size_t> blocks;
    double squares = 0.0;  ///< weighted residual sum of squares
    Index parameters = 0;  ///< number of linear parameters and searched shapes, without zeros
    double price = 0.0;    ///< cost of parameters, shapes and names
    /// n ln(squares/n) + price; smaller is better; infinite if some columns are dependent
    double criterion = 0.0;
  };

  /// Columns by term and shape as the effect returned them, reused for other weights.
  using Made = std::map<std::pair<std::size_t, std::vector<double>>, Expected<MatrixXd>>;

  /// `target`: index of the target of each reading; a set may not have nearly one free value per
  /// target (empty: no limit). The first `stated` terms belong to the model, and their curves may
  /// follow the targets more closely. `scatter`: standard deviation of a reading; if it is not 0,
  /// curves in space have a prior of their usual size (ridge).
  Workbench(const Observations& o, const std::vector<Term>& terms,
            const std::vector<double>& weight, const std::vector<std::uint32_t>& target = {},
            std::size_t stated = 0, Made* made = nullptr, const Noise& noise = {},
            double scatter = 0.0);

  const std::vector<Instance>& instances() const { return instances_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  const MatrixXd& columns() const { return x_; }
  const VectorXd& y() const { return y_; }
  const VectorXd& root_weight() const { return white_.root(); }
  const Whitening& white() const { return white_; }
  double readings() const { return used_; }
  Index zeros() const { return zeros_; }
  bool in_space() const { return several_axes_; }

  /// Adds a further combination of an effect's shapes to those of its grid.
  void add_shape(const Observations& o, std::size_t effect, const std::vector<double>& shape);

  State state(std::vector<std::size_t> blocks) const;
  /// For each block, the decrease of `squares` if it is added (NaN if it adds no independent
  /// column), and the number of independent columns that it adds.
  struct Gains {
    VectorXd fall;
    std::vector<Index> rank;
    double operator()(std::size_t block) const { return fall(static_cast<Index>(block)); }
  };
  Gains gains(const State& state) const;
  /// Returns the gains of the blocks of one effect only; NaN for others.
  Gains gains(const State& state, std::size_t effect) const;
  /// Adds the best block of this effect; the state is unchanged if no block can be added.
  State with(const State& state, const Gains& gains, std::size_t effect) const;
  /// Like `with`, but on a single axis also with fewer knots for each curve in `state`, because a
  /// curve may have all the position columns that a set may have.
  State joined(const State& state, const Gains& gains, std::size_t effect) const;
  /// Searches the shapes of each effect again with the others fixed, at most four times.
  State settled(State state) const;
  bool holds(const State& state, std::size_t effect) const;
  std::size_t effect_of(std::size_t block) const { return blocks_[block].effect; }
  State without(const State& state, std::size_t effect) const;

  /// Best shapes of all effects, searched one after the other, at most four times. Error: the
  /// readings do not show an effect, or do not separate the effects.
  Expected<std::vector<std::vector<double>>> best_shapes() const;

  /// Returns an n x q orthonormal basis of a state's columns (without the zeros).
  MatrixXd basis(const State& state) const;

  std::vector<Index> columns_of_state(const State& state) const;
  /// Scalar products of the columns of these blocks with each other, and of all columns with these.
  MatrixXd gram(const std::vector<std::size_t>& blocks) const;
  MatrixXd products(const std::vector<std::size_t>& blocks) const;
  /// Scalar products of the columns of the blocks `of` with those of the blocks `with`.
  MatrixXd products(const std::vector<std::size_t>& of, const std::vector<std::size_t>& with) const;

  /// Returns the cost of an effect with these shapes and this number of linear columns.
  double price(const Block& block, Index columns) const;
  double price(const Block& block) const { return price(block, block.count); }
  /// What the weight of an effect of the state adds to its evidence in the criterion.
  double evidence_of_weight(const State& state, std::size_t effect) const;
  double weight(std::size_t effect) const { return instances_[effect].term.weight; }
  static Index unknowns_of(const Block& block) { return block.count + block.searched; }

 private:
  bool follows_targets(const Block& block, Index of_position) const;
  void add(const Observations& o, std::size_t effect, std::vector<MatrixXd>& parts, Made& made);
  /// Columns of unit length without the zeros of lines; empty if the effect is not identifiable.
  MatrixXd columns_for(const Observations& o, Instance& instance, const std::vector<double>& shape,
                       bool& of_position, VectorXd& prior, Made& made) const;
  struct Projection {
    MatrixXd products;  // scalar products of columns with the orthonormal directions of the state
    VectorXd z;         // scalar products of the readings with these directions
  };
  /// For a state with a curve that is not completely independent of earlier blocks.
  struct Directions {
    MatrixXd of_columns;      // X_state * of_columns is orthonormal
    std::vector<Index> rank;  // number of independent columns of each block
    // every block has an independent direction, and all blocks except curves have full rank
    bool sound = true;
  };
  Directions directions(const std::vector<std::size_t>& blocks, const MatrixXd& gram) const;
  Gains no_gains() const;
  bool reducible(const Block& block) const;
  double least_of(const Block& block) const;
  double wholly_independent() const;
  State with_curve(const State& state, const Gains& gains, std::size_t effect) const;
  /// Converts products with the columns of the state to products with its orthonormal directions.
  Projection projection(const State& state, MatrixXd products) const;
  void put_gain(const Projection& projection, Index row, std::size_t block, Gains& out) const;
  double fall_of_block(const Projection& projection, Index row, const Block& block,
                       Index& rank) const;
  void push(Block block, const MatrixXd& columns);
  void count_shapes(Instance& instance) const;
  void fill_search(Block& block) const;
  static std::size_t usual_ones(const Term& term, const std::vector<double>& shape);
  Index count_of(const std::vector<std::size_t>& blocks) const;
  const MatrixXd& product_of_pair(std::size_t a, std::size_t b) const;
  const MatrixXd& products_of(std::size_t block) const;
  double criterion(double squares, double price, Index parameters) const;
  double of_few(Index parameters) const;  // factor of the price with few readings

  std::vector<Instance> instances_;
  std::vector<Block> blocks_;
  MatrixXd x_;
  // products of all columns with each block's, computed on request
  mutable std::vector<MatrixXd> products_;
  mutable std::map<std::pair<std::size_t, std::size_t>, MatrixXd>
      pairs_;  // products of the columns of two blocks, computed on request
  Whitening white_;
  VectorXd y_, xy_;
  double yy_ = 0.0, used_ = 0.0, noise_ = 0.0;
  std::vector<std::uint32_t> target_;
  std::size_t stated_ = 0;
  // Largest numbers of columns and searched shapes that depend only on position: in a set of
  // effects; in such a set when a term of the model is added; in a curve that is not in the model.
  Index most_of_position_ = 0, most_stated_ = 0, most_of_curve_ = 0;
  Index zeros_ = 0;
  bool several_axes_ = false, reducible_ = false;
  bool few_ = false;  // there are at most 40 readings, and fewer than 2.5 per target
};

}  // namespace nonio::model
