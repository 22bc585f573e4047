// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "data/design.h"
#include "data/whitening.h"

namespace nonio::model {

/// Every effect of a search with every value of its shapes, as columns of unit length from which
/// the zeros of the lines are taken out. Scalar products are kept as they are needed: a set of
/// effects is judged without touching the readings again. Of one thread.
class Workbench {
 public:
  /// Columns first .. first + count of an effect with one value of its shapes.
  struct Block {
    std::size_t effect;
    std::vector<double> shape;
    Index first, count;
    bool of_position;  ///< the same at every reading of a target
    MatrixXd own{};    ///< scalar products of its columns, with the prior of a curve
    /// Of each column of a curve in space 1/(usual size)^2, in the units of its parameter.
    VectorXd prior{};
    Index searched = 0;          ///< of its shapes so many were searched
    double cost_of_shape = 0.0;  ///< 2 ln of the number of independent values they were chosen from
  };
  struct Instance {
    Term term;
    std::vector<std::size_t> blocks;  ///< none: the readings cannot show it
    std::string error;
    bool reducible = false;  ///< may_lose
    /// Values of its shapes of which those have their usual value that a bit stands for.
    std::vector<std::size_t> tried{};
    std::vector<char> free{};  ///< of each shape: it has more than one value
  };
  /// Blocks in the order in which they came in, with what they leave.
  struct State {
    std::vector<std::size_t> blocks;
    double squares = 0.0;  ///< left, weighted
    Index parameters = 0;  ///< linear ones and searched shapes, without zeros
    double price = 0.0;    ///< of parameters, shapes and names
    double criterion =
        0.0;  ///< n ln(squares/n) + price of parameters, shapes and names; small is good
  };

  /// Columns of each term with each shape as its effect gave them: not made again for other
  /// weights.
  using Made = std::map<std::pair<std::size_t, std::vector<double>>, Expected<MatrixXd>>;

  /// `target` of each reading: sets whose columns of position alone come near to one free value per
  /// target are not looked at. Empty: all are. The first `stated` terms are the model's: that they
  /// are there is known, and their curves may follow the targets more closely. `scatter`: of a
  /// reading; with it curves in space have a usual size (ridge).
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

  /// One more value of an effect's shapes, in addition to those of its grid.
  void add_shape(const Observations& o, std::size_t effect, const std::vector<double>& shape);

  State state(std::vector<std::size_t> blocks) const;
  /// For each block the fall of `squares` if it is added, NaN if it adds no independent column, and
  /// how many independent columns it adds.
  struct Gains {
    VectorXd fall;
    std::vector<Index> rank;
    double operator()(std::size_t block) const { return fall(static_cast<Index>(block)); }
  };
  Gains gains(const State& state) const;
  /// The same for the blocks of one effect only; NaN elsewhere.
  Gains gains(const State& state, std::size_t effect) const;
  /// The state with the best block of this effect added, or nothing that can be added (blocks as
  /// before).
  State with(const State& state, const Gains& gains, std::size_t effect) const;
  /// The same, where it is better with curves of fewer knots: a curve that is there adapts to the
  /// new effect, and takes the targets that it would need.
  State joined(const State& state, const Gains& gains, std::size_t effect) const;
  /// Each effect's shapes looked for again while the others stay, until nothing improves.
  State settled(State state) const;
  bool holds(const State& state, std::size_t effect) const;
  std::size_t effect_of(std::size_t block) const { return blocks_[block].effect; }
  /// The state without one effect.
  State without(const State& state, std::size_t effect) const;

  /// Shapes of all effects together, one after the other until nothing improves.
  Expected<std::vector<std::vector<double>>> best_shapes() const;

  /// n x q orthonormal basis of a state's columns (without the zeros).
  MatrixXd basis(const State& state) const;

  /// Columns of a state's blocks in `columns()`.
  std::vector<Index> columns_of_state(const State& state) const;
  /// Scalar products of the columns of blocks with each other, and of all columns with them.
  MatrixXd gram(const std::vector<std::size_t>& blocks) const;
  MatrixXd products(const std::vector<std::size_t>& blocks) const;
  /// Of the columns of some blocks, one behind the other, with those of others.
  MatrixXd products(const std::vector<std::size_t>& of, const std::vector<std::size_t>& with) const;

  /// Price of an effect with these shapes; with so many linear columns of its own.
  double price(const Block& block, Index columns) const;
  double price(const Block& block) const { return price(block, block.count); }
  /// Linear columns and searched shapes.
  static Index unknowns_of(const Block& block) { return block.count + block.searched; }

 private:
  bool follows_targets(const Block& block, Index of_position) const;
  void add(const Observations& o, std::size_t effect, std::vector<MatrixXd>& parts, Made& made);
  /// Columns of unit length without the zeros of lines; none if the readings cannot show them.
  MatrixXd columns_for(const Observations& o, Instance& instance, const std::vector<double>& shape,
                       bool& of_position, VectorXd& prior, Made& made) const;
  struct Projection {
    MatrixXd products;  // of columns with orthonormal directions of the state's
    VectorXd z;         // of the readings with them
  };
  /// Directions of a state one of whose curves is not wholly independent of what came before it.
  struct Directions {
    MatrixXd of_columns;      // X_state * of_columns is orthonormal
    std::vector<Index> rank;  // of each block
    bool sound = true;  // every effect has a direction of its own, and all but curves all of theirs
  };
  Directions directions(const std::vector<std::size_t>& blocks, const MatrixXd& gram) const;
  Gains no_gains() const;
  bool reducible(const Block& block) const;
  double least_of(const Block& block) const;
  double wholly_independent() const;
  State with_curve(const State& state, const Gains& gains, std::size_t effect) const;
  /// `products` of columns with those of the state.
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

  std::vector<Instance> instances_;
  std::vector<Block> blocks_;
  MatrixXd x_;
  mutable std::vector<MatrixXd> products_;  // of all columns with each block's, if requested
  mutable std::map<std::pair<std::size_t, std::size_t>, MatrixXd>
      pairs_;  // of two blocks' columns, likewise
  Whitening white_;
  VectorXd y_, xy_;
  double yy_ = 0.0, used_ = 0.0, noise_ = 0.0;
  std::vector<std::uint32_t> target_;
  std::size_t stated_ = 0;
  // Columns and searched shapes of position: of a set, with stated terms, of a curve not stated.
  Index most_of_position_ = 0, most_stated_ = 0, most_of_curve_ = 0;
  Index zeros_ = 0;
  bool several_axes_ = false, reducible_ = false;
  bool few_ = false;  // readings without repeats
};

}  // namespace nonio::model
