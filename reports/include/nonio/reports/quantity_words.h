// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/reports/wording.h"
#include "nonio/sdk/history.h"

namespace nonio::reports {

/// Name of a quantity that is followed over the campaigns: "Scale", "Straightness Z, bow"; its
/// symbol where it has no words. `site`: the words of site.toml.
std::string followed_quantity(const Wording& site, const std::string& quantity);

/// Whether a quantity that is followed is the logarithm of a scatter ("ln_s",
/// "straightness:Z.ln_s"; s in um or arcsec). People read the scatter, and its changes as factors.
bool is_log_of_scatter(const std::string& quantity);

/// "0.48 (0.35 to 0.66)" um or arcsec, both ends with k = 2; `u` is that of the logarithm.
std::string scatter_text(const Wording& site, double log_of_scatter, double u);
/// "1.37", e to the power of a difference of logarithms.
std::string factor_text(const Wording& site, double difference);
/// "a factor of 1.37 (1.22 to 1.53)", both ends with k = 2.
std::string factor_text(const Wording& site, double difference, double u);

/// The numbers of one quantity that is followed, as they are printed, U with k = 2. What they are
/// given is SI or, of a scatter, its logarithm.
class FollowedNumbers {
 public:
  /// `of_angles`: whether the deviations along the axis are angles.
  FollowedNumbers(const std::string& quantity, Quantity unit, bool of_angles, const Wording& site);
  /// `of_machine`: all series of the machine.
  FollowedNumbers(const HistorySeries& series, const std::vector<HistorySeries>& of_machine,
                  const Wording& site);

  /// What the printed unit is of: of a scatter the deviations along its axis.
  Quantity quantity() const { return quantity_; }
  bool is_scatter() const { return is_scatter_; }
  /// In the unit of `quantity()`.
  double in_unit(double value) const;
  /// "-4.35 ± 0.27", "0.48 (0.35 to 0.66)": without the unit. Without U where `u` is 0.
  std::string number(double value, double u) const;
  /// With the unit.
  std::string value(double value, double u) const;
  /// Of a scatter a factor with its interval, otherwise with U and unit.
  std::string difference(double size, double u) const;
  /// The same without U, to three digits: a detection limit.
  std::string size(double size) const;

 private:
  Quantity quantity_;
  bool is_scatter_;
  const Wording& site_;
};

/// "crash: tool hit the vice", as a change of a series has it, with the kind in words.
std::string event_text(const Wording& site, const std::string& event);

}  // namespace nonio::reports
