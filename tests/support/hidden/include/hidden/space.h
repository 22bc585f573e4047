// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"

/// Campaigns of machines with several axes, read on an exact machine (tests/support/machine):
/// homogeneous transforms, errors that are waves and not splines. One error is left out of the
/// model.
namespace nonio::hidden {

enum class Story {
  gantry,         ///< X on two lines, Y, two diagonals
  third,          ///< the same, and a diagonal to half of Y
  single_column,  ///< X on two lines, Y, two diagonals; the carriage follows its bent guide
  straightedge,   ///< X, Y, two diagonals, and straightness lines of both
  volume,         ///< X, Y, Z, each on two lines; two diagonals in each plane
  steps,          ///< X, Y, Z, four step diagonals with a mirror that is not square
  table,          ///< centres of a ball on a rotary axis over a full turn
  swivel,         ///< the same over an arc
};
const char* to_text(Story story);

struct SpaceHidden {
  Story story = Story::gantry;
  Campaign campaign;
  std::vector<Observations> read;  ///< as the csv reader gives them
  std::string effect;              ///< that the model does not have
  std::vector<std::string> model;  ///< all that is there but the set-up
  double noise = 0.0;              ///< standard deviation of a reading, m
};

/// The same for the same seed. `times`: how many times the noise the RMS of what the hidden effect
/// does to the readings that it changes, their lines' means taken out.
SpaceHidden hide_in_space(Story story, std::uint64_t seed, double times);

}  // namespace nonio::hidden
