// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "campaign/tables/table_check.h"
#include "campaign_verb.h"
#include "platform/storage/json_values.h"

/// What the verbs about tables share.
namespace nonio::app {

using TableJson = storage::Json;
using Texts = std::map<std::string, std::string>;

/// Numbers with the unit in their name: "largest_um".
void put(TableJson& json, const std::string& name, double si, Quantity q);
TableJson difference_json(const tables::TableDifference& d);
/// `compared`: else of one file alone.
void print_difference(const tables::TableDifference& d, bool compared = true);

TableJson forecast_json(const tables::TableForecast& f);
void print_forecast(const tables::TableForecast& f);

/// Files, the control that they are of, and what it makes of them.
struct Loaded {
  const Controller* control = nullptr;
  std::vector<LoadedTable> tables;
  std::vector<Artifact> files;
};

Expected<Loaded> load(const loader::Plugins& plugins, const std::string& files,
                      const std::string& control, const Campaign& campaign, const Texts& settings,
                      const std::function<config::Checked<Settings>(const Info&)>& options_of);

/// The same of files that were read.
Expected<Loaded> understood(
    const loader::Plugins& plugins, std::vector<Artifact> files, const std::string& control,
    const Campaign& campaign, const Texts& settings,
    const std::function<config::Checked<Settings>(const Info&)>& options_of);

/// Options of a control for a campaign: site, record of the machine, manifest, then `settings`.
config::Checked<Settings> campaign_options(const OpenCampaign& open, const Info& info,
                                           const Texts& settings);

/// An error, which names the key, where it is not known which table was active while an axis was
/// measured.
Expected<void> knows_active(const Campaign& campaign, const Measurement& m);

/// The tables of a control that a campaign gives. The words of a refusal are printed on stderr.
void tell_findings(const OpenCampaign& open, const std::vector<Finding>& findings);

}  // namespace nonio::app
