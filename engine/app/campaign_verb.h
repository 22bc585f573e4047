// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common.h"
#include "host/modelling/campaign_model.h"

namespace nonio::app {

/// The campaign that a verb is about.
struct OpenCampaign {
  std::filesystem::path folder;
  std::unique_ptr<host::reading::Workplace> place;
  host::reading::ReadCampaign read;
  const Campaign& campaign() const { return read.manifest->campaign; }
};

/// Reads the campaign and tells on stderr what is wrong. The error is the exit status if the verb
/// cannot go on: 2 for the configuration, 1 for measurements of which none can be read. Errors of
/// single measurements stay in `read.errors` and leave the others.
tl::expected<OpenCampaign, int> open_campaign(
    const char* verb, const std::string& folder, const Common& common,
    host::reading::TemplatesFor what = host::reading::TemplatesFor::documents);

/// "CAMPAIGN", --templates and the common options.
std::vector<Argument> campaign_arguments(std::string& folder, Common& common);

}  // namespace nonio::app
