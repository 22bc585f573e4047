// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/reports/wording.h"
#include "nonio/sdk/history.h"

namespace nonio::reports {

/// Name of a followed quantity, such as "Scale" or "Straightness Z, bow", otherwise its symbol.
/// `site` contains the texts of site.toml.
std::string followed_quantity(const Wording& site, const std::string& quantity);

/// True for "ln_s" and "straightness:Z.ln_s" (s in um or arcsec). Users see the scatter, and its
/// changes as factors.
bool is_log_of_scatter(const std::string& quantity);

/// "0.48 (0.35 to 0.66)", in um or arcsec, for k = 2; `u` is that of the logarithm.
std::string scatter_text(const Wording& site, double log_of_scatter, double u);
/// "1.37": exp(difference of logarithms).
std::string factor_text(const Wording& site, double difference);
/// "a factor of 1.37 (1.22 to 1.53)", for k = 2.
std::string factor_text(const Wording& site, double difference, double u);

/// Formats the values of one followed quantity, U with k = 2. Arguments are SI, or logarithms of a
/// scatter.
class FollowedNumbers {
 public:
  /// `of_angles` is true if deviations along the axis are angles.
  FollowedNumbers(const std::string& quantity, Quantity unit, bool of_angles, const Wording& site);
  /// `of_machine` contains all series of this machine.
  FollowedNumbers(const HistorySeries& series, const std::vector<HistorySeries>& of_machine,
                  const Wording& site);

  /// Quantity of the printed unit; for a scatter, deviations along its axis.
  Quantity quantity() const { return quantity_; }
  bool is_scatter() const { return is_scatter_; }
  /// The value in the printed unit.
  double in_unit(double value) const;
  /// "-4.35 ± 0.27" or "0.48 (0.35 to 0.66)", without unit; without U if `u` is 0.
  std::string number(double value, double u) const;
  /// Like `number`, with the unit.
  std::string value(double value, double u) const;
  /// A factor with interval for a scatter; otherwise the value with U and unit.
  std::string difference(double size, double u) const;
  /// Like `difference` without U, three digits, for detection limits.
  std::string size(double size) const;

 private:
  Quantity quantity_;
  bool is_scatter_;
  const Wording& site_;
};

/// "crash: tool hit the vice", with the kind of event in the language of `site`.
std::string event_text(const Wording& site, const std::string& event);

}  // namespace nonio::reports
