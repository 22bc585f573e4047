// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "laboratory/statistics/series.h"

/// Random walk of the level (local level model): a_t = a_(t-1) + N(0, q dt), y = a + N(0, u^2) with
/// independent u, started at the first point (exactly diffuse). Source: Kalman filter of J. Durbin,
/// S. J. Koopman, Time Series Analysis by State Space Methods (general knowledge; reference values
/// of the Nile data in tests/unit/history).
namespace nonio::statistics {

struct Walk {
  double q = 0.0;                      ///< variance of the change of the level per year
  double log_likelihood = 0.0;         ///< diffuse log-likelihood of the points after the first
  double state = 0.0, variance = 0.0;  ///< level at the last point and its variance
};

Walk walk_with(const Series&, double q);
/// Maximizes the likelihood over q; q = 0 if no other value is likelier.
Walk likeliest_walk(const Series&);

}  // namespace nonio::statistics
