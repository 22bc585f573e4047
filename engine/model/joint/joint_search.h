// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "joint/system.h"
#include "search/search.h"

namespace nonio::model {

using Choices = std::vector<Choice>;

inline Choices without(Choices choices, std::size_t i) {
  choices.erase(choices.begin() + static_cast<std::ptrdiff_t>(i));
  return choices;
}

// p of differences: docs/dev/constants.md, M47.
inline constexpr double differs_below = 0.001;
inline constexpr Index flipped_copies = 200;  // half by stretches, half by whole passes

/// The effects that the readings of all members support, and how their values vary.
class JointSearch {
 public:
  JointSearch(const std::vector<Member>& members, const JointReadings& readings,
              std::uint64_t seed);

  /// Finds the choices.
  void run();

  struct Scored {
    Choice choice;
    double evidence = -std::numeric_limits<double>::infinity();
  };
  /// The best block, with the best `Holds`, of each effect that is not in `choices`.
  std::map<std::string, Scored> scored(const Choices& choices, const std::string& only = "") const;

  /// -2 ln of the likelihood with the costs of all parameters; infinite if the readings do not
  /// determine the choices.
  double criterion(const Choices& choices) const;

  /// F-test against the noise of the repeats, corrected for the dates of a change only.
  double p_of(const Choices& chosen, std::size_t i) const;

  /// As `Term::weight`.
  double weight_of(const Choice& choice) const;

  /// RMS of what the choice explains beyond the others, m or rad.
  double size_of(const Choices& choices, std::size_t i) const;

  /// Copies of the residuals, one per column, with random signs: of short stretches in even
  /// columns, of whole passes in odd ones. They have the expected size of the noise, because the
  /// fit makes residuals smaller.
  std::vector<MatrixXd> flipped() const;

  const JointSystem& system() const { return system_; }
  const Choices& choices() const { return choices_; }
  /// The readings of each member, as a matrix of one column.
  const std::vector<MatrixXd>& y() const { return y_; }
  double noise2() const { return noise2_; }  ///< mean variance of a reading, m^2 or rad^2
  const Chance& unweighted() const { return unweighted_; }  ///< for printed p

 private:
  /// Among nearly equal effects, returns that with the fewest unknowns.
  Scored simplest(const std::map<std::string, Scored>& all) const;

  void find();

  /// Replaces an effect by one with fewer unknowns that explains the readings equally well.
  void prefer_simpler();

  void prefer_pairs();

  /// Replaces an effect with searched shapes by two others, if they explain the readings better: a
  /// warm-up with its fixed point imitates a growth about one end, which is a growth and a drift.
  bool replace_by_pair(std::size_t i);

  /// Blocks of this curve with more knots that all of its members determine, most first, and the
  /// block itself. What a curve with few knots leaves is the same in all campaigns and must not look
  /// like another effect, or, where campaigns measure other parts of the travel, like a difference.
  std::vector<std::size_t> finer(std::size_t block) const;

  /// The choices with as many knots of curves as the readings determine, except that of effect `i`.
  Choices with_all_knots(Choices choices, std::size_t except) const;

  /// Searches shapes and `holds` of each effect again with the others fixed, at most four times.
  void settle();

  /// Returns whether the shape, `holds` or the date of the effect changed.
  bool settle(std::size_t i);

  /// One change between two campaigns replaces separate values, if it reduces the criterion and
  /// leaves no other significant difference.
  void look_for_date(std::size_t i);

  /// p of the differences between campaigns beyond those that the choice allows.
  double p_same(std::size_t i) const;

  /// The largest number of independent tests that gives the observed median or 5 % quantile of the
  /// smallest p of a copy, with flipped stretches or with flipped passes.
  double trials_of(const JointSystem::Gains& gains, bool weighted) const;

  /// Removes effects that are not significant or too small.
  void prune();

  /// An effect gets one shared value if more than 1 % of the flipped copies reach its differences.
  void settle_differences();

  const std::vector<Member>& of_;
  const JointReadings& r_;
  JointSystem system_;
  std::uint64_t seed_;
  std::vector<MatrixXd> y_;
  double dof_ = 0.0, noise2_ = 0.0;
  Choices choices_;
  Chance chance_, unweighted_;
};

}  // namespace nonio::model
