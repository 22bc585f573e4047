// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"
#include "campaign_verb.h"

/// Options of commands that offer the sign probe of an axis.
namespace nonio::app {

struct ProbeWish {
  std::string folder, axis, out, control;
  std::vector<std::string> settings;
  double feed = 1000.0;  ///< feed of the probe, mm/min or deg/min
};

/// Returns the readings without the effect of the active tables. An error if it is unknown whether
/// tables were active, because the probe's prediction for an axis without a table would be wrong.
/// `axis`: the only axis for which this is checked; empty: all axes.
Expected<std::vector<Observations>> raw_readings(const OpenCampaign& open, const std::string& axis);

/// Returns the sign probe of one measurement, within the travel of its axis.
Expected<tables::SignProbe> probe_of(const OpenCampaign& open, std::size_t measurement,
                                     const std::vector<Observations>& raw);

/// Returns the part program of a probe, made by the output for part programs.
Expected<Artifact> program_of(const tables::SignProbe& probe, const Machine& machine,
                              const ProbeWish& wish,
                              const std::map<std::string, std::string>& given,
                              const loader::Plugins& plugins);

}  // namespace nonio::app
