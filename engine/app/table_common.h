// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"
#include "campaign_verb.h"
#include "platform/storage/json_values.h"

/// Functions shared by the commands about tables.
namespace nonio::app {

using TableJson = storage::Json;
using Texts = std::map<std::string, std::string>;

/// Adds a number in its printed unit, with the unit appended to the name: "largest_um". A number
/// that is not finite is left out.
void put(TableJson& json, const std::string& name, double si, Quantity q);
TableJson difference_json(const tables::TableDifference& d);
/// Prints a difference. `compared` is false if the argument describes a single file, not a
/// comparison of two.
void print_difference(const tables::TableDifference& d, bool compared = true);

TableJson forecast_json(const tables::TableForecast& f);
void print_forecast(const tables::TableForecast& f);

/// Files of tables, their control, and the tables in them.
struct Loaded {
  const Controller* control = nullptr;
  std::vector<LoadedTable> tables;
  std::vector<Artifact> files;
};

Expected<Loaded> load(const loader::Plugins& plugins, const std::string& files,
                      const std::string& control, const Campaign& campaign, const Texts& settings,
                      const std::function<config::Checked<Settings>(const Info&)>& options_of);

/// Does the same as `load` for files that were read already.
Expected<Loaded> understood(
    const loader::Plugins& plugins, std::vector<Artifact> files, const std::string& control,
    const Campaign& campaign, const Texts& settings,
    const std::function<config::Checked<Settings>(const Info&)>& options_of);

/// Returns the options of a control for a campaign. `settings` take precedence over the statements
/// of the site, the machine record and the manifest.
config::Checked<Settings> campaign_options(const OpenCampaign& open, const Info& info,
                                           const Texts& settings);

/// Returns an error that names the key if it is unknown which table was active while the axis was
/// measured.
Expected<void> knows_active(const Campaign& campaign, const Measurement& m);

/// Prints the findings with severity warning on stderr.
void tell_findings(const OpenCampaign& open, const std::vector<Finding>& findings);

}  // namespace nonio::app
