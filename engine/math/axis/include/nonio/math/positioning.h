// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "nonio/math/axis_statistics.h"
#include "nonio/math/drift.h"

/// Rules for the positioning of an axis, computed from the same statistics. docs/formulas.md states
/// the confidence of every formula; the texts of the standards were not available.
namespace nonio::math {

/// Values that a rule computes; positioning.cpp contains the formulas.
enum class RuleForm {
  iso,    ///< ranges of mean +- k s: A, E, M, R, B
  upr,    ///< UPR, the smaller of R+ and R-
  vdi,    ///< P, Pa, Ps, U of VDI/DGQ 3441
  nmtba,  ///< half ranges about the commanded position: |mean| + k s
  raw,    ///< ranges of the readings themselves
  jis,    ///< one pass, and repeatability at both ends and in the middle
};

/// Confidence in the formula (H, M, L of docs/formulas.md).
enum class Confidence {
  proved,    ///< the formula reproduces the numbers of public reports, or a public text states it
  known,     ///< common knowledge of the field, consistent between sources
  inferred,  ///< an interpretation made for this program
};

struct PositioningRule {
  std::string_view name;  ///< name in [options.positioning] rules: "iso-1988"
  std::string_view title;
  RuleForm form = RuleForm::iso;
  double k = 0.0;  ///< number of standard deviations on each side of a mean; 0 if none are used
  bool systematic = true;       ///< for `iso`: whether the edition defines E and M
  bool without_offset = false;  ///< for `nmtba`: whether a constant is subtracted from the means
  std::size_t approaches = 0;   ///< readings per target and direction; 0: not known
  Confidence confidence = Confidence::inferred;
};

std::span<const PositioningRule> positioning_rules();
/// Returns null if no rule has this name.
const PositioningRule* positioning_rule(std::string_view name);

/// The constant that rules "without offset" subtract: mean of the bidirectional means, the mean of
/// the first target, or the middle between the largest and the smallest mean.
enum class Offset { mean_of_all, first_target, mid_range };
/// Returns this constant, m or rad. If only one direction was measured, its means replace the
/// bidirectional ones. NaN without targets, or if a contributing target lacks such a mean.
double offset_of(const AxisStatistics&, Offset);

/// Coefficients of the uncertainty of a value; formula and symbols: uncertainty.h.
struct RuleShare {
  bool systematic = false;  ///< whether the contributions that do not average out are included
  double means = 0.0;       ///< coefficient of the variance of a mean of n readings
  double scatter = 0.0;     ///< half of the number of standard deviations in the value
  double band = 0.0;        ///< coefficient of the squared range of the environment
  double DriftShare::*seen = nullptr;  ///< contribution of drift and repetition, and its factor
  double seen_factor = 1.0;
};

struct RuleValue {
  std::string_view name;  ///< symbol of the rule: A+, P; "+-" precedes a half range
  double value;           ///< m or rad; NaN if the readings do not determine it
  RuleShare share;
  /// whether the formula of this value is an interpretation, even if that of the rule is not
  bool inferred = false;
};

/// Values that the readings do not determine are NaN.
std::vector<RuleValue> evaluate_rule(const PositioningRule&, const AxisStatistics&,
                                     Offset = Offset::mean_of_all);

}  // namespace nonio::math
