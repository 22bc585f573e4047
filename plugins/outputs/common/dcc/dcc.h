// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "nonio/sdk/plugin.h"

/// A Digital Calibration Certificate (PTB's schema 3.3.0) as XML, to be signed by the host.
namespace nonio::dcc {

struct About {
  std::string number;                  ///< the unique identifier
  std::vector<std::string> languages;  ///< ISO 639-1
  std::string location;                ///< where it was calibrated: "customer", as the schema says
  std::string software, release;       ///< who writes
  std::map<std::string, std::string> methods{};  ///< the standard of an analysis, by its plugin
};

/// What the schema wants must be there: laboratory, customer, item, dates, at least one result.
std::string write(const OutputInput&, const About&);

/// ISO 3166-1: "IT".
bool is_country(std::string_view);

}  // namespace nonio::dcc
