// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "campaign/reading/campaign_reader.h"

namespace nonio::reading {

/// The folder, context and stage with which a campaign is read.
struct CampaignSource {
  const std::filesystem::path& folder;
  const Context& context;
  const Stage& stage;
};

/// Reads the measurements of `out.manifest` and adds observations, notes, doubts and errors to
/// `out`.
void read_measurements(const CampaignSource& from, ReadCampaign& out);

/// Adds an error; an error without a line is assigned the first line of its file.
void report_in(ReadCampaign& out, Error error);
/// Returns an error about a key of the manifest, with its line.
Error key_error(const CampaignSource& from, const ReadCampaign& out, std::string key,
                const std::string& message);
/// Records the digest of a file in the inputs, once per file.
void note_input(ReadCampaign& out, const std::string& name, const std::string& digest);

}  // namespace nonio::reading
