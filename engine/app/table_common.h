// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "campaign/config/terminal_words.h"
#include "campaign/tables/table_check.h"
#include "campaign_verb.h"
#include "platform/storage/json_values.h"

namespace nonio::app {

using TableJson = storage::Json;
using Texts = std::map<std::string, std::string>;

/// Adds a number in its printed unit, which is appended to the name, such as "largest_um". Omits a
/// number that is not finite.
void put(TableJson& json, const std::string& name, double si, Quantity q);
TableJson difference_json(const tables::TableDifference& d);
/// `compared` is false if `d` describes a single table instead of a difference.
void print_difference(const tables::TableDifference& d, const config::TerminalWords& say,
                      bool compared = true);

TableJson forecast_json(const tables::TableForecast& f);
void print_forecast(const tables::TableForecast& f, const config::TerminalWords& say);

struct Loaded {
  const Controller* control = nullptr;
  std::vector<LoadedTable> tables;
  std::vector<Artifact> files;
};

Expected<Loaded> load(const loader::Plugins& plugins, const std::string& files,
                      const std::string& control, const Campaign& campaign, const Texts& settings,
                      const std::function<config::Checked<Settings>(const Info&)>& options_of);

/// Does the same as `load` for files that were already read.
Expected<Loaded> understood(
    const loader::Plugins& plugins, std::vector<Artifact> files, const std::string& control,
    const Campaign& campaign, const Texts& settings,
    const std::function<config::Checked<Settings>(const Info&)>& options_of);

/// Returns the options of a control. `settings` override site, machine record and manifest.
config::Checked<Settings> campaign_options(const OpenCampaign& open, const Info& info,
                                           const Texts& settings);

/// Returns an error with the name of the key if the campaign does not state which table was active
/// during the measurement.
Expected<void> knows_active(const Campaign& campaign, const Measurement& m);

/// Prints the findings of severity warning on stderr.
void tell_findings(const OpenCampaign& open, const std::vector<Finding>& findings);

}  // namespace nonio::app
