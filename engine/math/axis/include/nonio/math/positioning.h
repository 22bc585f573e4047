// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "nonio/math/axis_statistics.h"

/// Rules for the positioning of an axis (standards and usage), all computed from the same
/// statistics. docs/formulas.md contains every formula with its confidence; no text of a standard
/// was available.
namespace nonio::math {

/// Which values a rule computes from the statistics; the formulas are in positioning.cpp.
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
  std::string_view name;   ///< name in [options.positioning] rules: "iso-1988"
  std::string_view title;  ///< title with the edition: "ISO 230-2:1988"
  RuleForm form = RuleForm::iso;
  double k = 0.0;  ///< number of standard deviations on each side of a mean; 0: none are used
  bool systematic = true;       ///< for `iso`: whether the edition defines E and M
  bool without_offset = false;  ///< for `nmtba`: whether a constant is subtracted from the means
  /// readings required at each target from each direction; 0: not known
  std::size_t approaches = 0;
  Confidence confidence = Confidence::inferred;
};

/// Returns all rules, in the order in which documents list them.
std::span<const PositioningRule> positioning_rules();
/// Returns the rule of this name; null if there is none.
const PositioningRule* positioning_rule(std::string_view name);

/// The constant that rules "without offset" subtract: mean of the bidirectional means, the mean of
/// the first target, or the middle between the largest and the smallest mean.
enum class Offset { mean_of_all, first_target, mid_range };
/// Returns the constant that rules "without offset" subtract, m or rad. If only one direction was
/// measured, its means replace the bidirectional ones. NaN if a target that contributes lacks such
/// a mean, or without targets.
double offset_of(const AxisStatistics&, Offset);

/// Composition of the uncertainty of a value: U^2 = S^2 (if systematic) + means U_EVE^2/n +
/// (scatter U_EVE)^2 + band E_VE^2 + (B D_B)^2 + (B_mean D_mean)^2, in the symbols of
/// uncertainty.h. Unless `systematic`, (2 scatter D_s)^2 is added.
struct RuleShare {
  bool systematic = false;  ///< whether the contributions that do not average out are included
  double means = 0.0;       ///< coefficient of the variance of a mean of n readings
  double scatter = 0.0;     ///< half of the number of standard deviations in the value
  double band = 0.0;        ///< coefficient of the squared range of the environment
  /// coefficients of the possible contribution of drift to the reversal (drift.h)
  double B = 0.0, B_mean = 0.0;
};

struct RuleValue {
  std::string_view name;  ///< symbol of the rule: A+, P; "+-" precedes a half range
  double value;           ///< m or rad; NaN if the readings do not determine it
  RuleShare share;
  /// whether this value is an interpretation made for this program, even if the rule itself is not
  bool inferred = false;
};

/// Returns every value of the rule; those not determined are NaN. Range: any statistics. No errors.
std::vector<RuleValue> evaluate_rule(const PositioningRule&, const AxisStatistics&,
                                     Offset = Offset::mean_of_all);

/// Converts a value of R+ or R-, which are 2 k s, from k_from to k_to standard deviations. Returns
/// nothing if one of these numbers is not above 0, and for all other values, because they contain
/// means and cannot be converted without the readings.
std::optional<double> converted(std::string_view name, double value, double k_from, double k_to);

}  // namespace nonio::math
