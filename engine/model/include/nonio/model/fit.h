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

/// Lines for whose groups an effect has values of their own: by "adjustment", "before" and "after".
struct Grouping {
  std::string by;                    ///< "adjustment", "state", "side", "measurement"
  std::vector<std::string> name;     ///< of each group
  std::vector<std::uint32_t> group;  ///< of each line
};

/// An effect on one axis, or of what an effect in space is of (then `axis` has only that name).
struct Term {
  const Effect* effect = nullptr;
  Axis axis;
  std::vector<double> shape{};  ///< empty: searched, if the effect has shapes
  /// A shape that another measurement states, of standard uncertainty u: taken where these readings
  /// show nothing against it, and then no unknown of the fit; it needs no evidence.
  struct Stated {
    std::size_t shape = 0;
    double value = 0.0, u = 0.0;
  };
  std::optional<Stated> stated{};
  /// Linear parameters for each group, in the order of the groups; null: the same for all lines.
  std::shared_ptr<const Grouping> grouping{};
  /// Of the groups but the first, in addition to the same effect without groups.
  bool differences = false;
  /// 2 ln of the odds against it before there are readings: rare causes need more evidence.
  double price = 0.0;
  /// Its value is known: no unknowns, and its prediction is subtracted from the readings.
  bool held = false;
  /// One of very many: a candidate only in the best set, or instead of an effect of it.
  bool library = false;

  /// The effect without groups: "backlash:X".
  std::string of_all() const { return effect->info.name + ":" + axis.name; }
  /// "backlash:X", "backlash:X@adjustment".
  std::string name() const { return grouping ? of_all() + "@" + grouping->by : of_all(); }
};

struct Parameter {
  std::string effect;  ///< "backlash:X"
  std::string name;    ///< "b"
  double value = 0.0;
  double u = 0.0;  ///< standard uncertainty; NaN for a shape that takes only discrete values
  Quantity quantity = Quantity::number;
  bool shape = false;
  std::string group{};  ///< of a grouped term: "before"; also the end of its name
  bool held = false;    ///< stated, not fitted; u = 0
};

/// Correlation of the noise of the readings, as far as their repeats and their order show it.
struct Noise {
  /// The zero of a line, and what the model predicts for it.
  enum class Zero {
    steady,
    walks,    ///< from reading to reading
    of_run,   ///< each run has its own
    of_pass,  ///< each run in one direction
  };
  /// Targets that scatter differently from the others.
  struct Stretch {
    double from = 0.0, to = 0.0;  ///< m or rad
    double inside = 1.0;          ///< its standard deviation over that of a reading in the mean
    double outside = 1.0;         ///< that of the others
  };
  double measured = 0.0;      ///< correlation of neighbours in a pass; NaN: not known
  double p = 1.0;             ///< chance that independent readings show as much
  double in_repeats = 0.0;    ///< the same as search and tests use it: 0 where repeats show none
  double u_neighbours = 0.0;  ///< standard uncertainty of `in_repeats`, where it is used
  double neighbours = 0.0;    ///< as values and u of a fit have it
  Zero zero = Zero::steady;
  double zero_size = 0.0;   ///< of a zero, or a step of the walk, over s, as u has it
  double zero_found = 0.0;  ///< the most likely one
  bool zero_open = false;   ///< these readings leave open how large it may be
  double digit = 0.0;       ///< last digit of the readings, m or rad
  std::optional<Stretch> stretch{};
  std::vector<double> rough{};        ///< of each reading its standard deviation over s; empty: 1
  std::vector<std::uint32_t> pass{};  ///< of each reading
  bool independent() const { return !(neighbours > 0.0) && zero == Zero::steady; }
};

struct Fit {
  std::vector<Term> terms;                       ///< with the shapes that were found
  std::vector<Parameter> parameters;             ///< term by term: linear ones, then shapes
  std::vector<std::vector<double>> correlation;  ///< of `parameters`
  std::vector<double> zero;                      ///< of each line, m or rad
  std::vector<double> residual;                  ///< of each reading, m or rad
  std::vector<double> weight;  ///< of each reading, 0..1: small where it is a suspected misreading
  std::vector<std::vector<double>> part;  ///< prediction of each term for each reading, m or rad
  /// Of each term: columns of a curve that these readings do not separate from the terms before it
  /// (the odd part of a second straightness on two diagonals). They are assigned to those terms.
  std::vector<std::size_t> lost{};
  double rms = 0.0;            ///< of the weighted residuals, m or rad
  double s = 0.0;              ///< standard deviation of a reading, from residuals and redundancy
  double s_noise = 0.0;        ///< the same without what the zeros of `noise` add
  std::size_t redundancy = 0;  ///< readings less unknowns
  Noise noise{};               ///< as the weights and u have it
};

/// Weighted least squares: deviation = zero of its line + sum of columns * parameters + e, by QR
/// with pivoting on columns of unit length. Shapes that are not given are searched on their grids,
/// one after the other until nothing improves, then between the grid's values; their uncertainty is
/// that of the linearised problem. `weight` (0..1 a reading, or empty) is for suspected
/// misreadings. Parameters that the readings do not separate are an error that names them; there is
/// no minimum-norm guess. Source: GUM-6:2020 9 for the covariance. Where repeats show noise that is
/// not independent, generalised least squares: all rows whitened first; what else is known of it is
/// in u only. `thin`: means of neighbours of a long table, if they exist already.
Expected<Fit> fit(const Observations& observations, std::vector<Term> terms,
                  std::vector<double> weight = {}, const Noise& noise = {},
                  const Observations* thin = nullptr);

/// What a term with one parameter predicts for each reading, m or rad.
Expected<std::vector<double>> said_by(const Observations& observations, const Term& term,
                                      double value);

}  // namespace nonio::model
