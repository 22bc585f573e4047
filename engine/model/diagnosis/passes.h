// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/compare.h"
#include "search/finding.h"

namespace nonio::model {

/// The zeros of passes in what the best explanation leaves: whether they are a part of the noise,
/// and what that noise leaves of places and effects (docs/model.md, "Verdict").
class PassZeros {
 public:
  explicit PassZeros(const Finding&);

  /// Passes have zeros of their own that differ as if drawn at random.
  bool scatter() const { return left_.has_value(); }
  /// Whole passes are to be drawn again for the rate of false alarms: where the readings of a pass
  /// are no independent noise. Few signs of whole passes are a coarser draw than many of stretches.
  bool drawn_again() const;
  /// What the best explanation leaves of each reading, less what its repeats have in common: with
  /// all that a pass shares.
  std::vector<double> noise() const;
  /// Where they scatter: the places of such a residual. One that is determined by differences between
  /// passes is known as badly as these.
  std::vector<Place> places(const std::vector<double>& residual,
                            const std::optional<NoiseFloor>& floor, double least) const;
  /// Where they scatter: whether an effect of the best explanation is there also next to them. One
  /// that is nearly the same within a pass has no more evidence than there are passes.
  bool shows(const std::string& effect) const;

 private:
  Noise with_passes() const;
  double share_of(const std::string& effect) const;

  const Finding& f_;
  bool unordered_ = false;
  std::optional<PlacesLeft> left_{};
};

}  // namespace nonio::model
