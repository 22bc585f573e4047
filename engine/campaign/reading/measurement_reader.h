// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/reading/campaign_reader.h"

namespace nonio::reading {

/// Where a campaign is read from.
struct CampaignSource {
  const std::filesystem::path& folder;
  const Context& context;
  const Stage& stage;
};

/// The measurements of `out.manifest`: observations, and what is noted, doubted and wrong of them.
void read_measurements(const CampaignSource& from, ReadCampaign& out);

/// An error of a whole file is reported at its first line.
void report_in(ReadCampaign& out, Error error);
/// An error that a key of the manifest is to blame for.
Error key_error(const CampaignSource& from, const ReadCampaign& out, std::string key,
                const std::string& message);
/// Once for each file.
void note_input(ReadCampaign& out, const std::string& name, const std::string& digest);

}  // namespace nonio::reading
