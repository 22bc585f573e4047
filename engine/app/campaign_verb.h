// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common.h"
#include "nonio/host/campaign_model.h"

namespace nonio::app {

/// The campaign that a verb is about.
struct OpenCampaign {
  std::filesystem::path folder;
  std::unique_ptr<host::Workplace> place;
  host::ReadCampaign read;
  const Campaign& campaign() const { return read.manifest->campaign; }
};

/// "campaign.toml:12: ..."
std::string text_of(const Error& error);

/// Reads the campaign and tells on stderr what is wrong. `exit` is set if the verb cannot go on:
/// 2 for the configuration, 1 for measurements of which none can be read. Errors of single
/// measurements stay in `read.errors` and leave the others.
OpenCampaign open_campaign(const char* verb, const std::string& folder, const Common& common,
                           Outcome& exit);

/// "CAMPAIGN", --templates and the common options.
void add_campaign_arguments(CLI::App& verb, std::string& folder, Common& common);

}  // namespace nonio::app
