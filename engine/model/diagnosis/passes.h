// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/compare.h"
#include "search/finding.h"

namespace nonio::model {

/// Decides whether zeros of passes are a part of the noise, and repeats the tests of places and
/// effects with that noise (docs/model.md, "Verdict").
class PassZeros {
 public:
  explicit PassZeros(const Finding&);

  /// Whether each pass has a zero of its own that varies randomly.
  bool scatter() const { return left_.has_value(); }
  /// Whether the rate of false alarms must be determined by flipping the signs of whole passes,
  /// because the readings of a pass are not independent; coarser than with many stretches.
  bool drawn_again() const;
  /// Returns the effects of the best explanation that change mostly between repeats, if passes in
  /// other orders show an effect as clearly as the passes in their own order; otherwise none.
  const std::vector<std::string>& of_any_order() const { return of_any_order_; }
  /// Returns the rate at which passes in other orders would show an effect that is named; 0 if the
  /// readings of a pass are independent.
  double alarms() const { return alarms_; }
  /// Returns the residual of each reading in the best explanation minus the mean of its repeats,
  /// scaled to the variance of a reading; it includes the part that a pass shares. 0 for readings
  /// without repeats.
  std::vector<double> noise() const;
  /// Requires `scatter`, by which places determined by differences between passes are tested.
  std::vector<Place> places(const std::vector<double>& residual,
                            const std::optional<NoiseFloor>& floor, double least) const;
  /// Whether an effect of the best explanation is significant if the zeros of passes scatter; true
  /// if this cannot be tested. An effect that is nearly constant within a pass has only as much
  /// evidence as the number of passes allows.
  bool shows(const std::string& effect) const;

 private:
  void compare_orders();
  bool explains_zeros(const Workbench::State& others) const;
  double share_with_order(const MatrixXd& orders) const;
  MatrixXd in_other_orders(const std::vector<double>& e) const;
  Noise with_passes() const;
  double share_of(const std::string& effect) const;

  const Finding& f_;
  bool unordered_ = false;
  std::vector<std::string> of_any_order_{};
  double alarms_ = 0.0;
  std::optional<PlacesLeft> left_{};
};

}  // namespace nonio::model
