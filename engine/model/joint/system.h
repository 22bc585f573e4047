// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "joint/readings.h"

namespace nonio::model {

/// A block of the joint model, and how its value varies between campaigns.
struct Choice {
  std::size_t block = 0;
  Holds holds = Holds::shared;
  std::size_t after = 0;  ///< for `changed`: the first member with the second value
};

/// Pseudo-inverse without the directions that the readings do not determine, and its rank.
/// `before`: squared lengths of the columns before others were eliminated.
struct RankedInverse {
  MatrixXd inverse;
  Index rank = 0;
};
RankedInverse ranked_inverse(const MatrixXd& left, const VectorXd& before);

/// Normal equations of all members; columns of single members are eliminated member by member.
class JointSystem {
 public:
  explicit JointSystem(const JointReadings& readings) : r_(readings) {}

  struct Solution {
    bool sound = true;     ///< every choice has independent columns
    double squares = 0.0;  ///< residual sum of squares, in units of the variance of a reading
    double price = 0.0;
    Index parameters = 0;
    double criterion() const { return squares + price; }
    VectorXd shared;  ///< values of the shared columns, choice by choice
    MatrixXd covariance;
    std::vector<VectorXd> own;  ///< values of each member's own columns, choice by choice
    std::vector<MatrixXd> own_covariance;
  };
  Solution solve(const std::vector<Choice>& choices) const;

  /// The same, with the covariance of shared values enlarged because the weights of the members
  /// come from noise that each member estimates from few readings: to the first order, from Meier,
  /// Variance of a weighted mean, Biometrics 9 (1953), for several parameters.
  Solution solve_with_estimated_noise(const std::vector<Choice>& choices) const;

  /// `group`: 0 for shared, 0 or 1 for changed, the member for own. Values and their covariance are
  /// empty if the choice is not identifiable.
  std::pair<VectorXd, MatrixXd> values(const std::vector<Choice>& choices, const Solution& s,
                                       std::size_t choice, std::size_t group) const;

  /// Returns the residuals of each member, in units of the standard deviation of a reading.
  std::vector<VectorXd> residuals(const std::vector<Choice>& choices, const Solution& s) const;

  /// Decrease of the squares by one more block, for each block and each column of `y` (one matrix
  /// per member). NaN if the block adds no independent column.
  struct Gains {
    MatrixXd shared, own;
    std::vector<Index> own_parameters;
    std::vector<double> own_price;  ///< cost of separate values in each member
  };
  Gains gains(const std::vector<Choice>& choices, const std::vector<MatrixXd>& y) const;

  /// The most significant decrease of the squares by one block in one member, without other
  /// choices: as a normal deviate, for each column of `y`; which it is for the first column.
  struct Single {
    VectorXd deviate;
    std::size_t block = 0, member = 0;
    double fall = 0.0;  ///< of the squares
  };
  Single single(const std::vector<MatrixXd>& y) const;

  double readings() const;
  double price_of(const JointBlock& block) const;  ///< cost of the shapes and the name of a block
  std::size_t effects() const;
  const JointReadings& all() const { return r_; }

 private:
  struct Place {  // index in a solution (`at`), and in x of a member (`column`)
    bool shared;
    Index at, column, count, rank;
  };
  std::vector<Place> places(const std::vector<Choice>& choices, std::size_t member) const;
  Index shared_columns(const std::vector<Choice>& choices) const;
  struct Split {
    MatrixXd own, shared;   // columns of one member: with own and with shared coefficients
    std::vector<Index> at;  // indices of these shared columns among those of all members
    Index rank;             // number of independent ones of the own columns
  };
  Split split(const std::vector<Choice>& choices, std::size_t member) const;
  struct Information {
    MatrixXd of;            // of the shared values, without the member's own
    std::vector<Index> at;  // indices of these values
  };
  Solution solve(const std::vector<Choice>& choices, std::vector<Information>* members) const;

  const JointReadings& r_;
};

}  // namespace nonio::model
