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

/// Reads the campaign and tells on stderr what is wrong. The error is the exit status if the verb
/// cannot go on: 2 for the configuration, 1 for measurements of which none can be read. Errors of
/// single measurements stay in `read.errors` and leave the others.
tl::expected<OpenCampaign, int> open_campaign(
    const char* verb, const std::string& folder, const Common& common,
    host::TemplatesFor what = host::TemplatesFor::documents);

/// "CAMPAIGN", --templates and the common options.
std::vector<Argument> campaign_arguments(std::string& folder, Common& common);

}  // namespace nonio::app
