// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"
#include "campaign_verb.h"

/// The sign probe of an axis, for the verbs that offer it.
namespace nonio::app {

struct ProbeWish {
  std::string folder, axis, out, control;
  std::vector<std::string> settings;
  double feed = 1000.0;  ///< mm/min or deg/min
};

/// The readings without the tables that were active. An error where it is not known whether there
/// were any: what the probe shows without a table would be wrong by them. `axis`: the only one that
/// has to be known; empty: all.
Expected<std::vector<Observations>> raw_readings(const OpenCampaign& open, const std::string& axis);

/// The probe of one measurement, within the travel of its axis.
Expected<tables::SignProbe> probe_of(const OpenCampaign& open, std::size_t measurement,
                                     const std::vector<Observations>& raw);

/// The part program of a probe, by the writer of all part programs.
Expected<Artifact> program_of(const tables::SignProbe& probe, const Machine& machine,
                              const ProbeWish& wish,
                              const std::map<std::string, std::string>& given,
                              const loader::Plugins& plugins);

}  // namespace nonio::app
