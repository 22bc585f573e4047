// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "nonio/sdk/results.h"
#include "nonio/sdk/units.h"

namespace nonio::math {

/// `rotary` selects the quantities of deviations, positions and slopes.
class FindingBuilder {
 public:
  FindingBuilder(std::string id, bool attention, bool rotary) : rotary_(rotary) {
    finding_.id = std::move(id);
    finding_.attention = attention;
  }
  FindingBuilder& deviation(std::string name, double v) {
    return number(std::move(name), v, deviation_of(rotary_));
  }
  FindingBuilder& position(std::string name, double v) {
    return number(std::move(name), v, position_of(rotary_));
  }
  FindingBuilder& slope(std::string name, double v) {
    return number(std::move(name), v, slope_of(rotary_));
  }
  FindingBuilder& count(std::string name, double v) {
    return number(std::move(name), v, Quantity::count);
  }
  FindingBuilder& number(std::string name, double v, Quantity q) {
    finding_.evidence.push_back({std::move(name), v, q});
    return *this;
  }
  FindingBuilder& text(std::string name, std::string words) {
    finding_.texts.emplace_back(std::move(name), std::move(words));
    return *this;
  }
  Finding done() { return std::move(finding_); }

 private:
  Finding finding_;
  bool rotary_;
};

}  // namespace nonio::math
