// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

/// One case: what is done, with which readings, in printed units (um, mm; arcsec, deg).
struct Case {
  std::string analysis;                        ///< first word after `operation`
  std::map<std::string, std::string> options;  ///< name=value after it
  nonio::Campaign campaign;
  nonio::Observations observations;
  std::map<std::string, double> numbers{};                          ///< of a circle: by name
  std::map<std::string, std::vector<std::vector<double>>> lists{};  ///< of heat: lines by name
  bool rotary() const { return options.count("rotary") > 0; }
};

/// What came out, by name and in printed units; NaN is absent.
struct Outcome {
  std::map<std::string, double> values;
  std::map<std::string, std::string> words;
  std::vector<nonio::Finding> findings;
};

Case begin_case(const std::vector<std::string>& operation);
/// `given TARGET DIRECTION x x x ...` or `given KEY VALUE`; empty if understood, else a complaint.
std::string give(Case&, const std::vector<std::string>& words);
Outcome evaluate(const Case&);
