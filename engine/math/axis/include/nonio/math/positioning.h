// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "nonio/math/axis_statistics.h"

/// The rules of the trade for positioning of an axis: rows of one table over one set of statistics.
/// docs/formulas.md gives every formula with its confidence; no text of a standard was available.
namespace nonio::math {

/// The values of a rule from the statistics; the formulas are at the code (positioning.cpp).
enum class RuleForm {
  iso,    ///< ranges of mean +- k s: A, E, M, R, B
  upr,    ///< the smaller of R+ and R-
  vdi,    ///< P, Pa, Ps, U of VDI/DGQ 3441
  nmtba,  ///< +- from the commanded position: |mean| + k s
  raw,    ///< ranges of the readings themselves
  jis,    ///< one pass, and repetition at both ends and in the middle
};

/// How sure the formula is (H, M, L of docs/formulas.md).
enum class Confidence {
  proved,    ///< it reproduces the numbers of public reports, or a public text states it
  known,     ///< common knowledge of the field, consistent between sources
  inferred,  ///< our interpretation
};

struct PositioningRule {
  std::string_view name;   ///< "iso-1988", as [options.positioning] rules has it
  std::string_view title;  ///< "ISO 230-2:1988", with the edition
  RuleForm form = RuleForm::iso;
  double k = 0.0;               ///< standard deviations on each side of a mean; 0: none are used
  bool systematic = true;       ///< iso: whether the edition has E and M
  bool without_offset = false;  ///< nmtba: a constant is taken off first
  std::size_t approaches = 0;   ///< required at each target from each direction; 0: not known
  Confidence confidence = Confidence::inferred;
};

/// In the order of the documents.
std::span<const PositioningRule> positioning_rules();
/// Null if there is none of this name.
const PositioningRule* positioning_rule(std::string_view name);

/// Which constant is taken off without an offset: mean of the bidirectional means, that of the
/// first target, or the middle between the largest and the smallest of them.
enum class Offset { mean_of_all, first_target, mid_range };
/// m or rad; NaN where a target lacks it.
double offset_of(const AxisStatistics&, Offset);

/// What an uncertainty is made of: U^2 = S^2 (if systematic) + means U_EVE^2/n + (scatter U_EVE)^2 +
/// band E_VE^2 + (B D_B)^2 + (B_mean D_mean)^2, in the symbols of uncertainty.h; the scatter has its D_s.
struct RuleShare {
  bool systematic = false;       ///< the parts that do not average out
  double means = 0.0;            ///< variance: so many means of n readings
  double scatter = 0.0;          ///< half of so many standard deviations
  double band = 0.0;             ///< variance: so many ranges of the environment, squared
  double B = 0.0, B_mean = 0.0;  ///< times what drift may make of the reversal (drift.h)
};

struct RuleValue {
  std::string_view
      name;      ///< in the symbols of the rule: A+, P; "+-" before what is half of a range
  double value;  ///< m or rad; NaN where the readings do not give it
  RuleShare share;
  bool inferred = false;  ///< our interpretation, whatever the rule is
};

/// Every value of the rule, absent ones as NaN. Range: any statistics; no errors.
std::vector<RuleValue> evaluate_rule(const PositioningRule&, const AxisStatistics&,
                                     Offset = Offset::mean_of_all);

/// The same figure by another number of standard deviations, where it needs no readings: R+ and R-
/// are 2 k s. Nothing for A, R, P and what else has means in it.
std::optional<double> converted(std::string_view name, double value, double k_from, double k_to);

}  // namespace nonio::math
