// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"
#include "campaign_verb.h"

namespace nonio::app {

struct ProbeWish {
  std::string folder, axis, out, control;
  std::vector<std::string> settings;
  double feed = 1000.0;  ///< mm/min or deg/min
};

/// Returns the readings without the effect of active tables. An error if the campaign does not
/// state which tables were active: of `axis`, or of every axis if it is empty.
Expected<std::vector<Observations>> raw_readings(const OpenCampaign& open, const std::string& axis);

/// Returns the sign probe of one measurement. An error if it leaves the travel of the axis.
Expected<tables::SignProbe> probe_of(const OpenCampaign& open, std::size_t measurement,
                                     const std::vector<Observations>& raw);

/// Returns the part program of the probe for `wish.control`, or for the control of the machine.
Expected<Artifact> program_of(const tables::SignProbe& probe, const Machine& machine,
                              const ProbeWish& wish,
                              const std::map<std::string, std::string>& given,
                              const loader::Plugins& plugins);

}  // namespace nonio::app
