// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/reading/campaign_reader.h"

namespace nonio::reading {

struct CampaignSource {
  const std::filesystem::path& folder;
  const Context& context;
  const Stage& stage;
};

void read_measurements(const CampaignSource& from, ReadCampaign& out);

/// An error without a line is assigned the first line of its file.
void report_in(ReadCampaign& out, Error error);
Error key_error(const CampaignSource& from, const ReadCampaign& out, std::string key,
                const std::string& message);
void note_input(ReadCampaign& out, const std::string& name, const std::string& digest);

}  // namespace nonio::reading
