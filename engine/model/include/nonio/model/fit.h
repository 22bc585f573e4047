// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"

namespace nonio::model {

/// Groups of lines for effects with several values, such as "before" and "after" by "adjustment".
struct Grouping {
  std::string by;  ///< property: "adjustment", "state", "side", "measurement"
  std::vector<std::string> name;
  std::vector<std::uint32_t> group;  ///< group of each line
};

/// An effect of one axis, or an instance of an effect in space, whose `axis` is only a name.
struct Term {
  const Effect* effect = nullptr;
  Axis axis;
  /// values of the shapes; empty: they are searched if the effect has any
  std::vector<double> shape{};
  /// A shape that another measurement states with standard uncertainty u. It is used if the
  /// readings do not contradict it; it is then not an unknown of the fit and needs no evidence.
  struct Stated {
    std::size_t shape = 0;
    double value = 0.0, u = 0.0;
  };
  std::optional<Stated> stated{};
  /// If set, the linear parameters exist once per group; null: they are the same for all lines.
  std::shared_ptr<const Grouping> grouping{};
  /// Whether parameters are differences from the first group, added to an effect without groups.
  bool differences = false;
  /// 2 ln of the prior odds against the effect: rare causes need more evidence.
  double price = 0.0;
  /// Share of earlier campaigns of such machines in which the effect was found, if counted.
  std::optional<double> frequency{};
  /// Median and standard deviation of the RMS that it had there, m or rad; if counted.
  std::optional<std::pair<double, double>> usual_size{};
  /// Weight of a candidate by `frequency` and `usual_size`, set by the search (fit/weights.h).
  double weight = 1.0;
  /// Whether the parameters are given: their prediction is subtracted from the readings.
  bool held = false;
  /// For effects of a large library: candidates only within the best set or as replacements in it.
  bool library = false;

  std::string of_all() const { return effect->info.name + ":" + axis.name; }
  /// For example "backlash:X", with groups "backlash:X@adjustment".
  std::string name() const { return grouping ? of_all() + "@" + grouping->by : of_all(); }
};

struct Parameter {
  std::string effect;  ///< name of the effect: "backlash:X"
  std::string name;    ///< symbol: "b"
  double value = 0.0;
  /// standard uncertainty; NaN if it cannot be determined, and for a shape that is not fitted
  double u = 0.0;
  Quantity quantity = Quantity::number;
  bool shape = false;
  std::string group{};  ///< group of a grouped term, such as "before"
  bool held = false;    ///< whether the value is given and not fitted; u is then 0
};

/// Correlation of the noise of the readings, as estimated from their repeats and their order.
struct Noise {
  enum class Zero {
    steady,
    walks,    ///< random walk from reading to reading
    of_run,   ///< random zero of each run
    of_pass,  ///< random zero of each pass (run in one direction)
  };
  struct Stretch {
    double from = 0.0, to = 0.0;  ///< the range, m or rad
    double inside = 1.0;          ///< standard deviation inside, relative to the mean one
    double outside = 1.0;         ///< standard deviation outside, relative to the mean one
  };
  double measured = 0.0;  ///< correlation of adjacent readings in a pass; NaN: not known
  double p = 1.0;         ///< probability that independent readings show such a correlation
  /// correlation used in the search, in tests and for the values of a fit: 0 if repeats show none
  double in_repeats = 0.0;
  double u_neighbours = 0.0;  ///< standard uncertainty of `in_repeats`, if it is used
  double neighbours = 0.0;    ///< correlation of adjacent readings used for u of a fit
  Zero zero = Zero::steady;
  /// size of a zero, or of a step of the random walk, relative to s; it affects only u
  double zero_size = 0.0;
  double zero_found = 0.0;  ///< most likely value of `zero_size`
  bool zero_open = false;   ///< whether the readings do not bound the size of the zero from above
  double digit = 0.0;  ///< step of the last digit of the readings, m or rad; 0 if none was found
  std::optional<Stretch> stretch{};
  std::vector<double> rough{};  ///< standard deviation of each reading relative to s; empty: 1
  std::vector<std::uint32_t> pass{};  ///< index of the pass of each reading
  bool independent() const { return !(neighbours > 0.0) && zero == Zero::steady; }
};

struct Fit {
  std::vector<Term> terms;
  std::vector<Parameter> parameters;             ///< of each term the linear ones, then the shapes
  std::vector<std::vector<double>> correlation;  ///< correlation matrix of `parameters`
  std::vector<double> zero;
  std::vector<double> residual;
  std::vector<double> weight;             ///< weight of each reading, 0..1: small if it is suspect
  std::vector<std::vector<double>> part;  ///< prediction of each term for each reading, m or rad
  /// For each term: number of columns of a curve that these readings do not separate from earlier
  /// terms, to which their effect is assigned.
  std::vector<std::size_t> lost{};
  double rms = 0.0;  ///< rms of the weighted residuals, m or rad
  double s = 0.0;    ///< standard deviation of a reading, from residuals and redundancy, m or rad
  double s_noise = 0.0;        ///< as s, without the contribution of the zeros of `noise`
  std::size_t redundancy = 0;  ///< number of readings minus unknowns
  Noise noise{};               ///< noise used for the weights and u
};

/// Weighted least squares: deviation = zero of its line + sum of columns * parameters + e, by QR
/// with pivoting. Shapes that are not given are searched on their grids (at most four rounds),
/// continuous ones then between grid values; their u is that of the linearized problem. `weight`:
/// 0..1 per reading, or empty. Errors: too few readings, or the names of parameters that the
/// readings do not separate. If repeats show correlated noise, all rows are whitened (generalized
/// least squares); a random zero, and a correlation only in the residuals, affect only u. `thin`:
/// existing means of adjacent readings of a long table. Source: GUM-6:2020 9 (covariance).
Expected<Fit> fit(const Observations& observations, std::vector<Term> terms,
                  std::vector<double> weight = {}, const Noise& noise = {},
                  const Observations* thin = nullptr);

/// Returns the effects whose linear parameters are all smaller than 2 u, except the set-up.
std::vector<std::string> below_uncertainty(const Fit& fit);

/// Prediction for each reading, m or rad, of a term that has one parameter with this value, SI.
Expected<std::vector<double>> said_by(const Observations& observations, const Term& term,
                                      double value);

}  // namespace nonio::model
